"""How spectra of meshes differ from (A17), the spectrum of a continuous fluid at low temperature.

With n = l (l+1), and energies in units of kBT,

    1/⟨|u_lm|²⟩ = [a κ − (3/4π) ln(√N / l)] n (n−2) / (1 + c n / N) + y N · 3 (n−2) / (3n−2)

- (3/4π) ln(√N / l): undulations of shorter waves soften a membrane, by 1 to 4 % at κ = 20 kBT:
  Peliti and Leibler, doi:10.1103/PhysRevLett.54.1690. It has no parameter.
- c: waves that come near to the spacing of the vertices cost less than those of a continuum. The
  cotangent Laplacian of an even triangular lattice has c = 1.8, an uneven mesh more.
- y: vertices that keep their neighbours resist shear, Y r0² = y N kBT in (A18).
- a: the rigidity that is left, over the one that was put in. It should be 1.
"""

import numpy as np
from scipy.optimize import curve_fit

# c of soft meshes, as `fit_meshes` finds it at full size.
SOFTENING = {"Julicher": 2.3, "GompperKrollBarycentric": 2.6}


def bending_ratio(num_vertices, rigidity, l, c, a=1.0):
    """Bending stiffness of a mode over that of (A17): the first term above."""
    thermal = 3 / (4 * np.pi * rigidity) * np.log(np.sqrt(num_vertices) / l)
    return (a - thermal) / (1 + c * l * (l + 1) / num_vertices)


def shear_ratio(num_vertices, rigidity, l):
    """Stiffness of a mode by shear, the second term above for y = 1, over that of (A17)."""
    n = l * (l + 1)
    return num_vertices * 3 / (3 * n - 2) / (rigidity * n)


def fit_meshes(spectra):
    """What spectra of soft meshes have in common, by least squares to the formula above.

    Parameters
    ----------
    spectra : sequence of tuple
        N, κ / kBT, and the arrays l, ratio of ⟨|u_lm|²⟩ to (A17), and error of the ratio, all of
        one bending scheme. Modes up to √N / 3 are used.

    Returns
    -------
    values, errors : ndarray
        a, c, y and their standard errors, shape (3,).
    float
        χ² per degree of freedom. Errors are scaled with its root where it is above 1.
    """
    columns = []
    for num_vertices, rigidity, l, ratio, error in spectra:
        chosen = l <= num_vertices**0.5 / 3
        l = l[chosen]
        ones = np.ones(len(l))
        columns.append(
            np.stack([num_vertices * ones, rigidity * ones, l, ratio[chosen], error[chosen]])
        )
    num_vertices, rigidity, l, ratio, error = np.concatenate(columns, axis=1)

    def model(_, a, c, y):
        # Logarithms, because what a run fixes is the relative error of a mean square.
        bending = bending_ratio(num_vertices, rigidity, l, c, a)
        return -np.log(bending + y * shear_ratio(num_vertices, rigidity, l))

    found, covariance = curve_fit(
        model, l, np.log(ratio), (1.0, 2.0, 0.1), sigma=error / ratio, absolute_sigma=True
    )
    deviations = (np.log(ratio) - model(l, *found)) / (error / ratio)
    quality = float(deviations @ deviations / (len(l) - len(found)))
    return found, np.sqrt(max(1.0, quality) * np.diag(covariance)), quality


def fit_shear(num_vertices, rigidity, l, ratio, error, c):
    """The y of one mesh, with a = 1 and c given, and its error.

    Parameters
    ----------
    num_vertices, rigidity, l, ratio, error
        As for `fit_meshes`; all l are used.
    c : float
        See the formula; SOFTENING has it for each bending scheme.

    Returns
    -------
    tuple of float
    """
    bending = bending_ratio(num_vertices, rigidity, l, c)
    shear = shear_ratio(num_vertices, rigidity, l)
    # A mean square has the relative error of its inverse, in which the problem is linear.
    weights = (ratio**2 / error) * shear
    rest = (ratio**2 / error) * (1 / ratio - bending)
    return float(weights @ rest / (weights @ weights)), float((weights @ weights) ** -0.5)

"""How spectra of meshes differ from those of a continuous fluid, fitted to many of them at once."""

import numpy as np
from scipy.optimize import curve_fit

# a, c and c' of `fit_meshes` at full size, Ξ = 0.037. a is below 1, as undulations of small wave
# length soften a membrane for longer ones, by some (3/4π) kBT ln(√N / l): Peliti and Leibler,
# doi:10.1103/PhysRevLett.54.1690.
RIGIDITY_SHARE = 0.97
SOFTENING = (2.9, 0.0)


def spectrum_ratio(num_vertices, rigidity, l, young):
    """⟨|u_lm|²⟩ over (A17) of a mesh with the corrections above and Y r0² = `young` N kBT.

    Parameters
    ----------
    num_vertices : int
        N.
    rigidity : float
        κ over kBT.
    l : array_like
        2 or more.
    young : float
        y of `fit_meshes`.

    Returns
    -------
    ndarray
        Shape of l.
    """
    n = l * (l + 1)
    return 1 / (
        RIGIDITY_SHARE / softening(n / num_vertices, *SOFTENING)
        + young * num_vertices * 3 / (3 * n - 2) / (rigidity * n)
    )


def softening(x, c, c2):
    """By how much modes exceed those of a continuum, x = l (l+1) / N."""
    return 1 + c * x + c2 * x**2


def fit_shear(num_vertices, rigidity, l, ratio, error):
    """Y r0² over kBT of one mesh, and its error, by least squares to `spectrum_ratio`.

    Parameters
    ----------
    num_vertices, rigidity
        As for `spectrum_ratio`.
    l, ratio, error : array_like
        ⟨|u_lm|²⟩ over (A17) and its error, for the l that are fitted.

    Returns
    -------
    tuple of float
    """

    def model(modes, young):
        return np.log(np.abs(spectrum_ratio(num_vertices, rigidity, modes, young)))

    found, covariance = curve_fit(
        model, l, np.log(ratio), [0.1], sigma=error / ratio, absolute_sigma=True
    )
    return num_vertices * found[0], num_vertices * np.sqrt(covariance[0, 0])


def fit_meshes(spectra):
    """What spectra of soft meshes have in common, by least squares.

    kBT/⟨|u_lm|²⟩ = a κ (l+2)(l+1) l (l−1) / (1 + c x + c' x²) + y N kBT · 3 (n−2) / (3n−2)

    n = l (l+1) and x = n / N: a fluid of rigidity a κ, softer where waves come near to the spacing
    of the vertices, with a shear modulus Y r0² = y N kBT as in (A18). Modes up to √N / 3 are used.

    Parameters
    ----------
    spectra : sequence of tuple
        N, κ / kBT, and the arrays l, ratio of ⟨|u_lm|²⟩ to (A17), and error of the ratio.

    Returns
    -------
    values, errors : ndarray
        a, c, c', y and their standard errors, shape (4,).
    float
        χ² per degree of freedom. Errors are scaled with its root where it is above 1.
    """
    columns = []
    for num_vertices, rigidity, l, ratio, error in spectra:
        chosen = l <= num_vertices**0.5 / 3
        n = l[chosen] * (l[chosen] + 1)
        shear = num_vertices * 3 / (3 * n - 2) / (rigidity * n)
        x = n / num_vertices
        columns.append(np.stack([x, shear, ratio[chosen], error[chosen] / ratio[chosen]]))
    x, shear, ratio, error = np.concatenate(columns, axis=1)

    def model(_, a, c, c2, y):
        # Logarithms, because what a run fixes is the relative error of a mean square.
        return -np.log(a / softening(x, c, c2) + y * shear)

    found, covariance = curve_fit(
        model, x, np.log(ratio), (1.0, 2.0, 0.0, 0.1), sigma=error, absolute_sigma=True
    )
    deviations = (np.log(ratio) - model(x, *found)) / error
    quality = float(deviations @ deviations / (len(x) - len(found)))
    return found, np.sqrt(max(1.0, quality) * np.diag(covariance)), quality

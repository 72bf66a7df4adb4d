"""How spectra of meshes differ from those of a continuous fluid, fitted to many of them at once."""

import numpy as np
from scipy.optimize import curve_fit


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
        return -np.log(a / (1 + c * x + c2 * x**2) + y * shear)

    found, covariance = curve_fit(
        model, x, np.log(ratio), (1.0, 2.0, 0.0, 0.1), sigma=error, absolute_sigma=True
    )
    deviations = (np.log(ratio) - model(x, *found)) / error
    quality = float(deviations @ deviations / (len(x) - len(found)))
    return found, np.sqrt(max(1.0, quality) * np.diag(covariance)), quality

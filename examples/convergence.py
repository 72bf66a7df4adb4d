"""How fast the bending energy of a sphere converges with the mesh, for every scheme.

A sphere of radius R has E = 8 pi kappa (1 - C0 R / 2)^2, whatever R. The script prints the relative
error on icospheres of N = 162 to 10 242 vertices and the order of convergence p in the edge length,
error ~ N^(-p/2). All schemes but Espriu's are of second order; Espriu's vector is the curvature
vector of equilateral triangles only, and on the icosphere, whose triangles differ, it does not
converge.
"""

from __future__ import annotations

import numpy as np
import openmmhelfrich as helfrich

#: Subdivisions n of the icosphere, N = 10 n^2 + 2.
SUBDIVISIONS = (4, 8, 16, 32)
SCHEMES = ("Julicher", "GompperKroll", "GompperKrollBarycentric", "JulicherVoronoi", "Espriu")


def sphere_errors(scheme: str, reduced_curvature: float) -> np.ndarray:
    """Relative errors of the bending energy on spheres.

    Parameters
    ----------
    scheme : str
        Name of a scheme of `BendingForce`.
    reduced_curvature : float
        C0 R, the spontaneous curvature in units of the sphere's inverse radius.

    Returns
    -------
    ndarray
        Shape (len(SUBDIVISIONS),), E / E_exact - 1.
    """
    radius, rigidity = 100.0, 50.0
    exact = 8 * np.pi * rigidity * (1 - reduced_curvature / 2) ** 2
    errors = []
    for subdivision in SUBDIVISIONS:
        mesh = helfrich.Mesh.icosphere(subdivision, radius)
        force = helfrich.BendingForce(
            mesh,
            rigidity=rigidity,
            spontaneousCurvature=reduced_curvature / radius,
            scheme=getattr(helfrich.BendingForce, scheme),
        )
        errors.append(mesh.energy(force) / exact - 1)
    return np.array(errors)


def orders(errors: np.ndarray) -> np.ndarray:
    """Orders of convergence between neighbouring meshes, whose edge lengths differ by two."""
    return np.log2(np.abs(errors[:-1] / errors[1:]))


def main() -> None:
    """Print the table."""
    counts = [10 * n * n + 2 for n in SUBDIVISIONS]
    print("relative error of E on a sphere, and order of convergence")
    heads = [f"N = {count}" for count in counts] + ["order", "", ""]
    print(f"{'scheme':24}{'C0 R':>6}" + "".join(f"{head:>12}" for head in heads))
    for scheme in SCHEMES:
        for curvature in (0.0, 0.5, -0.7):
            errors = sphere_errors(scheme, curvature)
            row = "".join(f"{error:12.2e}" for error in errors)
            row += "".join(f"{order:12.2f}" for order in orders(errors))
            print(f"{scheme:24}{curvature:6.1f}{row}")


if __name__ == "__main__":
    main()

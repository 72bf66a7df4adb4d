"""Spheres that Fig. 4's scripts deform by u20, their energies, and the same of a smooth surface.

Farnudi, Ejtehadi and Everaers, Phys. Rev. E 108, 015301 (2023), doi:10.1103/PhysRevE.108.015301.
"""

import numpy as np
from _paper import SCHEMES

# The Voronoi model that has the curvature of each barycentric one.
BARYCENTRIC = {"Julicher": "JulicherVoronoi", "GompperKrollBarycentric": "GompperKroll"}
KINDS = ("ordered", "random", "fluctuating ordered", "fluctuating random")
MARKERS = dict(zip(KINDS, "os^v", strict=True))

AREA_MODULUS = 1.3  # kJ/mol/nm²
VOLUME_MODULUS = 0.04  # kJ/mol/nm³
RIGIDITY = 50.0  # kJ/mol
RADIUS = 1000.0  # nm

# Of the runs that make fluctuating meshes: Ξ, see fig04b_bias.py, and their length in τ_h.
SOFTNESS, DURATION = 0.22, 6.5

# A run that folded a triangle over is made again with another seed, so many times at most.
ATTEMPTS = 5


def still_sphere(kind, subdivision, seed):
    """A sphere of 10 n² + 2 vertices, an icosphere if its kind is ordered and else a random one."""
    import openmmhelfrich as helfrich

    if "ordered" in kind:
        return helfrich.Mesh.icosphere(subdivision, RADIUS)
    return helfrich.Mesh.random_sphere(10 * subdivision**2 + 2, RADIUS, seed)


def fluctuating(mesh, softness, seed, duration):
    """A mesh after its run, and how many runs before folded a triangle over, as few do.

    Raises
    ------
    MeshError
        If ATTEMPTS runs did.
    """
    import openmmhelfrich as helfrich

    for attempt in range(ATTEMPTS):
        try:
            return mesh.fluctuating(softness, seed + 1000 * attempt, duration), attempt
        except helfrich.MeshError as error:
            last = error
    raise last


def context_of(mesh):
    """A Context with the terms of a mesh, each in a force group of its own.

    Returns
    -------
    context : openmm.Context
    num_groups : int
        Groups are numbered in the order area, volume, and the models of SCHEMES.
    """
    import openmm
    import openmmhelfrich as helfrich

    forces = [
        helfrich.SurfaceAreaForce(mesh, AREA_MODULUS, mesh.area),
        helfrich.EnclosedVolumeForce(mesh, VOLUME_MODULUS, mesh.volume),
    ]
    for scheme in SCHEMES:
        kind_of_bending = getattr(helfrich.BendingForce, scheme)
        forces.append(helfrich.BendingForce(mesh, RIGIDITY, scheme=kind_of_bending))
    system = openmm.System()
    for _ in range(mesh.num_vertices):
        system.addParticle(1.0)
    for group, force in enumerate(forces):
        force.setForceGroup(group)
        system.addForce(force)
    platform = openmm.Platform.getPlatformByName("Reference")
    context = openmm.Context(system, openmm.VerletIntegrator(0.001), platform)
    return context, len(forces)


def smooth_energies(amplitude):
    """Energies of the smooth surface r = r0 (1 + u Y20), by Gauss quadrature over cos θ.

    With g² = r² + r'² its principal curvatures are (r² + 2 r'² − r r'') / g³ along meridians and
    (1 − r' cot θ / r) / g across them, its element of area is 2π r g d cos θ. Derivatives are those
    by θ. Exact to rounding up to u = 1, so that it shows what (34), (36) and (38) leave out.

    Parameters
    ----------
    amplitude : float or complex
        u20, without unit.

    Returns
    -------
    ndarray
        E_A, E_V and E_b with targets of the sphere, kJ/mol, shape (3,).
    """
    x, weights = np.polynomial.legendre.leggauss(200)
    norm = np.sqrt(5 / (16 * np.pi))
    r = 1 + amplitude * norm * (3 * x**2 - 1)
    slope = -6 * amplitude * norm * x * np.sqrt(1 - x**2)
    slope_cot = -6 * amplitude * norm * x**2
    second = -6 * amplitude * norm * (2 * x**2 - 1)
    g = np.sqrt(r**2 + slope**2)
    curvature = (r**2 + 2 * slope**2 - r * second) / g**3 + (1 - slope_cot / r) / g
    element = 2 * np.pi * weights * r * g
    area, volume = element.sum(), 2 * np.pi / 3 * (weights * r**3).sum()
    sphere_area, sphere_volume = 4 * np.pi, 4 * np.pi / 3
    return np.array(
        [
            AREA_MODULUS * RADIUS**2 * (area - sphere_area) ** 2 / (2 * sphere_area),
            VOLUME_MODULUS * RADIUS**3 * (volume - sphere_volume) ** 2 / (2 * sphere_volume),
            RIGIDITY / 2 * (curvature**2 * element).sum(),
        ]
    )


def smooth_slopes(amplitude):
    """dE_A/du, dE_V/du and dE_b/du of the smooth surface, kJ/mol, shape (3,).

    By a complex step, which has no difference to round.
    """
    step = 1e-30
    return smooth_energies(complex(amplitude, step)).imag / step

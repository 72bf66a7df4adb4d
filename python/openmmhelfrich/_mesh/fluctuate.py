"""Spheres whose vertices have flowed: the fluctuating meshes of the paper.

OpenMM and the forces are imported on first use, so that meshes can be made without them.
"""

from __future__ import annotations

import math

import numpy as np

from .._types import Array
from ..errors import MeshError
from .inputs import integer, not_negative

__all__ = ["fluctuating"]

_TEMPERATURE = 300.0  # K
# The moduli are those of a vesicle of this radius, so the run is made with it, nm.
_RADIUS = 1000.0
# The time step in τ_h, in which triangles collide, and in 1/ω of the sphere's breathing.
_FRACTIONS = 1 / 60, 0.3


def fluctuating(mesh, softness, seed, duration) -> Array:
    """Vertices of a sphere after a short run with U_A, U_V and U_h only, put back on the sphere.

    Parameters
    ----------
    mesh : Mesh
        A sphere about any centre.
    softness : float
        Ξ, above 0.
    seed : int
        Of the velocities, 0 or more.
    duration : float
        Length of the run in relaxation times τ_h = d √(m/ε), 0 or more.

    Returns
    -------
    ndarray
        Shape (num_vertices, 3), nm.

    Raises
    ------
    MeshError
        If an argument is out of range, the mesh is no sphere, or the run failed or folded it.
    """
    import openmm
    from openmm import unit

    from ..mesh import Mesh
    from ..vesicle import Vesicle

    where = "Mesh.fluctuating"
    softness = not_negative(softness, where, "softness")
    duration = not_negative(duration, where, "duration")
    if softness == 0:
        raise MeshError(f"{where}: softness must be above 0, or triangles would collapse")
    seed = integer(seed, where, "seed", 0)
    centre = mesh.vertices.mean(axis=0)
    distances = np.linalg.norm(mesh.vertices - centre, axis=1)
    radius = distances.mean()
    worst = int(np.argmax(abs(distances - radius)))
    # The mean of the vertices of a random mesh is not quite the centre of its sphere.
    if abs(distances[worst] / radius - 1) > 0.02:
        raise MeshError(
            f"{where}: the mesh must be a sphere, but vertex {worst} is {distances[worst]:.6g} nm "
            f"from the centre, where the mean is {radius:.6g} nm"
        )
    radius = math.sqrt(np.mean(distances**2))
    start = Mesh((mesh.vertices - centre) * (_RADIUS / radius), mesh.triangles)
    vesicle = Vesicle(start, rigidity=0, softness=softness)
    step = min(_FRACTIONS[0] * vesicle.tau_heights, _FRACTIONS[1] / _breathing(vesicle))
    integrator = openmm.VerletIntegrator(step)
    # Always this one, so that a seed gives the same mesh: its Verlet steps have Reference's bits.
    platform = openmm.Platform.getPlatformByName("Helfrich")
    context = openmm.Context(vesicle.system(), integrator, platform)
    context.setPositions(start.vertices)
    # OpenMM takes a seed of 0 for "choose one".
    context.setVelocitiesToTemperature(_TEMPERATURE, seed % (2**31 - 1) + 1)
    advice = "take a larger softness or a shorter duration"
    try:
        integrator.step(round(duration * vesicle.tau_heights / step))
    except openmm.OpenMMException as error:
        raise MeshError(f"{where}: the run failed ({error}); {advice}") from None
    positions = context.getState(positions=True).getPositions(asNumpy=True)
    positions = positions.value_in_unit(unit.nanometer)
    if not np.isfinite(positions).all():
        raise MeshError(f"{where}: the run failed; {advice}")
    outward = positions - positions.mean(axis=0)
    vertices = radius * outward / np.linalg.norm(outward, axis=1)[:, np.newaxis]
    a, b, c = (vertices[mesh.triangles[:, corner]] for corner in range(3))
    folded = np.flatnonzero(np.einsum("ij,ij->i", a, np.cross(b, c)) <= 0)
    if len(folded):
        raise MeshError(
            f"{where}: {len(folded)} triangles folded over, the first is {folded[0]}; {advice}"
        )
    return centre + vertices


def _breathing(vesicle) -> float:
    """Frequency with which the radius oscillates, 1/ps: ω² = (16π kA + 12π kV r0) / (N m)."""
    stiffness = 16 * vesicle.area_modulus + 12 * vesicle.volume_modulus * vesicle.radius
    return math.sqrt(math.pi * stiffness / (vesicle.mesh.num_vertices * vesicle.mass))

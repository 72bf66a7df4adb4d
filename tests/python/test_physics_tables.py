"""The tables of physics.md, to every printed digit, from the files that they were made of.

The files are read by `Mesh.read`, which has to turn the triangles: half of those of two of the
files face inward.
"""

from __future__ import annotations

from functools import cache

import numpy as np
import openmm as mm
import openmmhelfrich as helfrich
import pytest
from openmm import unit
from published import (
    LARGE_RED_CELL,
    PRINTED,
    RED_CELL,
    SPHERE,
    Printed,
    folder,
)

MAKERS = {
    "sphere": lambda: _read(SPHERE).scaled(1000),
    "oblate": lambda: _read(SPHERE).scaled(1320).scaled((1, 1, 0.26062)),
    "red cell": lambda: _read(RED_CELL).scaled(1320),
    "deformed": lambda: _read(SPHERE).scaled(1000).deformed(2, 0, 0.3),
    "large red cell": lambda: _read(LARGE_RED_CELL).scaled(2640),
}


def _read(file: str):
    return helfrich.Mesh.read(folder() / "vcm" / file)


@cache
def _mesh(name: str):
    return MAKERS[name]()


def _energy(mesh, force: mm.Force) -> float:
    system = mm.System()
    for _ in range(mesh.num_vertices):
        system.addParticle(50.0)
    system.addForce(force)
    platform = mm.Platform.getPlatformByName("Reference")
    context = mm.Context(system, mm.VerletIntegrator(0.001), platform)
    context.setPositions(mesh.vertices)
    energy = context.getState(getEnergy=True).getPotentialEnergy()
    return energy.value_in_unit(unit.kilojoule_per_mole)


def _present(printed: Printed) -> bool:
    if printed.quantity == "dihedrals":
        return hasattr(helfrich, "DihedralForce")
    if printed.quantity == "bending unsigned":
        return hasattr(helfrich.BendingForce, "setUnsignedSpontaneousCurvature")
    return not printed.scheme or hasattr(helfrich.BendingForce, printed.scheme)


@pytest.mark.usefixtures("shared")
@pytest.mark.parametrize("printed", [*filter(_present, PRINTED)], ids=str)
def test_printed_digits(printed: Printed):
    mesh, arguments = _mesh(printed.mesh), printed.arguments
    if printed.quantity == "area":
        value = mesh.area
    elif printed.quantity == "volume":
        value = mesh.volume
    elif printed.quantity.startswith("heights"):
        value = _energy(mesh, helfrich.TriangleHeightForce(mesh, **arguments))
    elif printed.quantity == "dihedrals":
        value = _energy(mesh, helfrich.DihedralForce(mesh, **arguments))
    elif printed.quantity == "area energy":
        target = _mesh("sphere").area
        value = _energy(mesh, helfrich.SurfaceAreaForce(mesh, modulus=1.3, target=target))
    elif printed.quantity == "volume energy":
        target = _mesh("sphere").volume
        value = _energy(mesh, helfrich.EnclosedVolumeForce(mesh, modulus=0.04, target=target))
    else:
        scheme = getattr(helfrich.BendingForce, printed.scheme)
        force = helfrich.BendingForce(mesh, scheme=scheme, **arguments)
        if printed.quantity.endswith("unsigned"):
            force.setUnsignedSpontaneousCurvature(True)
        value = _energy(mesh, force)
    printed.assert_met_by(value)


@pytest.mark.usefixtures("shared")
@pytest.mark.parametrize("name", ["sphere", "deformed"])
def test_targets_taken_from_the_mesh_are_met(name: str):
    """Mesh.area and Mesh.volume are what the forces measure, up to rounding noise."""
    mesh = _mesh(name)
    area = helfrich.SurfaceAreaForce(mesh, modulus=1.3, target=mesh.area)
    volume = helfrich.EnclosedVolumeForce(mesh, modulus=0.04, target=mesh.volume)
    noise = 1e-13
    assert _energy(mesh, area) <= 0.5 * 1.3 * mesh.area * noise**2
    assert _energy(mesh, volume) <= 0.5 * 0.04 * mesh.volume * noise**2


@pytest.mark.usefixtures("shared")
def test_files_are_really_turned():
    """What the tests above would not notice if the files had been mended before."""
    path = folder() / "vcm" / SPHERE
    lines = path.read_text(encoding="utf-8").splitlines()
    body = lines[lines.index("end_header") + 1 :]
    vertices = np.array([[float(x) for x in line.split()[:3]] for line in body[:1002]])
    triangles = np.array([[int(x) for x in line.split()[1:4]] for line in body[1002:3002]])
    a, b, c = (vertices[column] for column in triangles.T)
    outward = np.einsum("ij,ij->i", a, np.cross(b, c)) > 0
    assert 900 < outward.sum() < 1100
    a, b, c = (_mesh("sphere").vertices[column] for column in _mesh("sphere").triangles.T)
    assert (np.einsum("ij,ij->i", a, np.cross(b, c)) > 0).all()

"""Angles at rest and values of single edges of `DihedralForce`."""

from __future__ import annotations

import numpy as np
import numpy_energies
import openmm as mm
import openmmhelfrich as helfrich
import pytest
from meshes import OPEN_NAMES, Membrane, membrane
from platforms import REFERENCE
from running import Running


def mesh_of(m: Membrane) -> helfrich.Mesh:
    """Without the particles that belong to no triangle."""
    members, corners = np.unique(m.triangles, return_inverse=True)
    return helfrich.Mesh(m.positions[members], corners.reshape(-1, 3))


@pytest.mark.parametrize("where", ["octahedron", *OPEN_NAMES])
def test_angles_of_a_mesh(where):
    mesh = mesh_of(membrane(where))
    geometry = numpy_energies.Geometry(mesh.vertices, mesh.triangles)
    tail, head, _, _ = geometry.half_edges
    angles = {
        (min(a, b), max(a, b)): angle
        for a, b, angle in zip(tail.tolist(), head.tolist(), geometry.angles, strict=True)
    }
    expected = [angles[a, b] for a, b in mesh.edges.tolist()]
    np.testing.assert_allclose(mesh.dihedral_angles, expected, atol=1e-12)


@pytest.mark.parametrize("form", ["Quartic", "Cosine", "Exp", "SmoothExp", "SmoothExp46"])
def test_a_mesh_is_at_rest_at_its_own_angles(form):
    mesh = mesh_of(membrane("octahedron"))
    force = helfrich.DihedralForce(mesh, 40.0, form, mesh.dihedral_angles)
    energy, forces = Running([force], mesh.num_vertices, REFERENCE).evaluate(mesh.vertices)
    assert energy < 1e-24
    assert np.abs(forces).max() < 1e-11


def test_the_angle_comes_behind_the_form():
    m = membrane("octahedron")
    force = helfrich.DihedralForce(m.triangles, 40.0, helfrich.DihedralForce.Exp)
    assert (force.getForm(), force.getRestAngle()) == (helfrich.DihedralForce.Exp, 0.0)
    force = helfrich.DihedralForce(m.triangles, 40.0, "Exp", 0.2)
    assert (force.getForm(), force.getRestAngle()) == (helfrich.DihedralForce.Exp, 0.2)


def test_files_of_before_have_no_angle():
    force = helfrich.DihedralForce(membrane("octahedron").triangles, 40.0, restAngle=0.2)
    lines = mm.XmlSerializer.serialize(force).splitlines()
    older = "\n".join(line for line in lines if "restAngle" not in line)
    assert older != "\n".join(lines)
    read = helfrich.DihedralForce.cast(mm.XmlSerializer.deserialize(older))
    assert (read.getStiffness(), read.getRestAngle()) == (40.0, 0.0)


@pytest.mark.parametrize("argument", ["stiffness", "restAngle"])
def test_values_of_edges_do_not_flip(argument):
    mesh = helfrich.Mesh.random_sphere(92, 100.0, seed=1)
    values = {"stiffness": 40.0, "restAngle": 0.1} | {argument: np.full(len(mesh.edges), 0.1)}
    system = mm.System()
    for _ in range(mesh.num_vertices):
        system.addParticle(50.0)
    system.addForce(helfrich.DihedralForce(mesh, **values))
    system.addForce(helfrich.MonteCarloBondFlip(mesh, 300.0, frequency=1))
    context = REFERENCE.context(system, mm.VerletIntegrator(0.01))
    context.setPositions(mesh.vertices)
    with pytest.raises(mm.OpenMMException, match=f"DihedralForce.*{argument}.*flips make edges"):
        context.getIntegrator().step(1)

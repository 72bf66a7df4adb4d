"""EnclosedVolumeForce on surfaces that face inward: refused when first evaluated, allowed later."""

from __future__ import annotations

import numpy as np
import openmm as mm
import openmmhelfrich as helfrich
import pytest
from platforms import ON_GPU, ON_OPENCL, ON_PROCESSOR, REFERENCE, Target
from running import Running

ALL = [*ON_PROCESSOR, *ON_OPENCL, *ON_GPU]


def sphere(radius: float = 10.0, seed: int = 1) -> helfrich.Mesh:
    mesh = helfrich.Mesh.icosphere(2, radius)
    noise = np.random.default_rng(seed).normal(scale=0.02 * radius, size=mesh.vertices.shape)
    return helfrich.Mesh(mesh.vertices + noise, mesh.triangles)


@pytest.mark.parametrize("target", ALL, ids=str)
@pytest.mark.parametrize("bending_first", [True, False])
def test_clockwise_triangles_are_refused(target: Target, bending_first: bool):
    mesh = sphere()
    clockwise = mesh.triangles[:, [0, 2, 1]]
    forces = [
        helfrich.BendingForce(clockwise, 50.0),
        helfrich.EnclosedVolumeForce(clockwise, 1.0, mesh.volume),
    ]
    run = Running(forces if bending_first else forces[::-1], mesh.num_vertices, target)
    volume = f"{-mesh.volume:.4g}"[:4]
    message = f"^EnclosedVolumeForce: .*clockwise.*{volume}.*swap two corners.*Mesh"
    # Again, too: what has been refused once is not forgotten.
    for _ in range(2):
        with pytest.raises(mm.OpenMMException, match=message):
            run.evaluate(mesh.vertices)


def test_clockwise_triangles_turn_the_sign():
    """Of a spontaneous curvature, an area difference and angles at rest, as the headers say."""
    mesh = sphere()
    clockwise = mesh.triangles[:, [0, 2, 1]]
    for make in (
        lambda corners, sign: helfrich.BendingForce(corners, 50.0, sign * 0.02),
        lambda corners, sign: helfrich.AreaDifferenceForce(corners, 1.0, sign * 120.0),
        lambda corners, sign: helfrich.DihedralForce(corners, 1.0, "Cosine", sign * 0.2),
    ):
        energy = mesh.energy(make(mesh, 1))
        assert mesh.energy(make(clockwise, -1)) == pytest.approx(energy, rel=1e-12)
        assert mesh.energy(make(clockwise, 1)) > 1.1 * energy


def test_a_mesh_turns_them():
    mesh = sphere()
    turned = helfrich.Mesh(mesh.vertices, mesh.triangles[:, [0, 2, 1]])
    for triangles in (turned.triangles, mesh.triangles):
        force = helfrich.EnclosedVolumeForce(triangles, 2.0, 0.9 * mesh.volume)
        energy = Running([force], mesh.num_vertices, REFERENCE).energy(mesh.vertices)
        assert energy == pytest.approx(0.01 * mesh.volume / 0.9, rel=1e-9)


@pytest.mark.parametrize("target", ALL, ids=str)
def test_a_shape_may_turn_inside_out_in_a_run(target: Target):
    """The formula goes on: E = 1/2 k (V - V0)^2 / V0 for a volume below zero."""
    mesh = sphere()
    force = helfrich.EnclosedVolumeForce(mesh, 3.0, mesh.volume)
    run = Running([force], mesh.num_vertices, target)
    assert abs(run.energy(mesh.vertices)) < 1e-6 * mesh.volume
    mirrored = mesh.vertices * [1, 1, -1]
    assert run.energy(mirrored) == pytest.approx(6.0 * mesh.volume, rel=1e-5)


def test_only_the_volume_needs_an_outside():
    mesh = sphere()
    clockwise = mesh.triangles[:, [0, 2, 1]]
    forces = [
        helfrich.SurfaceAreaForce(clockwise, 1.0, 0.9 * mesh.area),
        helfrich.EnclosedVolumeForce(clockwise, 1.0, mesh.volume),
    ]
    run = Running(forces, mesh.num_vertices, REFERENCE)
    # The group of the area alone is computed, before and after the other has been refused.
    first = run.evaluate(mesh.vertices, 0)[0]
    assert first == pytest.approx(0.5 * 0.01 * mesh.area / 0.9, rel=1e-9)
    with pytest.raises(mm.OpenMMException, match="clockwise"):
        run.evaluate(mesh.vertices, 1)
    assert run.evaluate(mesh.vertices, 0)[0] == first


def test_the_inner_wall_of_a_shell_faces_inward():
    outer, inner = sphere(10.0, 1), sphere(6.0, 2)
    vertices = np.concatenate([outer.vertices, inner.vertices])
    walls = [outer.triangles, inner.triangles[:, [0, 2, 1]] + outer.num_vertices]
    between = outer.volume - inner.volume
    force = helfrich.EnclosedVolumeForce(np.concatenate(walls), 2.0, 1.1 * between)
    run = Running([force], len(vertices), REFERENCE)
    assert run.energy(vertices) == pytest.approx(0.01 * between / 1.1, rel=1e-9)


def test_a_flat_surface_may_start():
    """Two sheets in one place enclose nothing, up to rounding of either sign."""
    mesh = sphere()
    flat = mesh.vertices * [1, 1, 0]
    for triangles in (mesh.triangles, mesh.triangles[:, [0, 2, 1]]):
        force = helfrich.EnclosedVolumeForce(triangles, 2.0, mesh.volume)
        energy = Running([force], mesh.num_vertices, REFERENCE).energy(flat)
        assert energy == pytest.approx(mesh.volume, rel=1e-9)


def test_what_is_not_finite_is_named_first():
    mesh = sphere()
    force = helfrich.EnclosedVolumeForce(mesh.triangles[:, [0, 2, 1]], 1.0, mesh.volume)
    run = Running([force], mesh.num_vertices, REFERENCE)
    lost = mesh.vertices.copy()
    lost[3, 1] = np.inf
    with pytest.raises(mm.OpenMMException, match=r"particle 3 .* not finite"):
        run.evaluate(lost)
    with pytest.raises(mm.OpenMMException, match="clockwise"):
        run.evaluate(mesh.vertices)

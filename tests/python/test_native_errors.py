"""What is wrong with a membrane, where OpenMM's GPU platforms evaluate it themselves."""

from __future__ import annotations

import subprocess
import sys

import numpy as np
import openmm as mm
import pytest
from native_vesicle import context_of, forces_of, system_of, vesicle
from platforms import NATIVE, REFERENCE, Target
from running import Running

SINGLE, _, DOUBLE = NATIVE


def test_an_explosion_is_found_without_energies():
    """Steps that nobody asks anything of are looked at now and then."""
    mesh, forces = vesicle()
    integrator = mm.VerletIntegrator(1e3)
    context = context_of(SINGLE, system_of(mesh.num_vertices, 1e-3), forces, integrator)
    context.setPositions(mesh.vertices + np.random.default_rng(1).normal(size=mesh.vertices.shape))
    with pytest.raises(mm.OpenMMException, match=r"particle|position|triangle"):
        integrator.step(1100)


def test_a_triangle_without_area_is_found_without_energies():
    """Its vertices are held, so that no force of theirs spoils any position."""
    mesh, (_, area, _, _) = vesicle()
    system = system_of(mesh.num_vertices)
    for vertex in mesh.triangles[5].tolist():
        system.setParticleMass(vertex, 0)
    integrator = mm.VerletIntegrator(1e-5)
    context = context_of(DOUBLE, system, [area], integrator)
    context.setPositions(mesh.vertices)
    context.getState(energy=True)
    flat = mesh.vertices.copy()
    flat[mesh.triangles[5]] = flat[mesh.triangles[5, 0]] + [[1, 1, 1], [2, 2, 2], [4, 4, 4]]
    context.setPositions(flat)
    with pytest.raises(mm.OpenMMException, match=r"triangle 5 .* has no area"):
        integrator.step(1001)


@pytest.mark.parametrize("target", [SINGLE, DOUBLE], ids=str)
def test_an_energy_that_overflows(target: Target):
    """The processor names it if it overflows there, too; otherwise it is infinite."""
    mesh, (_, area, _, _) = vesicle()
    area.setContextParameter("target", "a target")
    run = Running([area], mesh.num_vertices, target)
    energy, _ = run.evaluate(mesh.vertices)
    run.context.setParameter("a target", 1e-300)
    with pytest.raises(mm.OpenMMException, match="the energy of SurfaceAreaForce is not finite"):
        run.evaluate(mesh.vertices)
    run.context.setParameter("a target", 1e-30)
    huge, _ = run.evaluate(mesh.vertices)
    in_double = 0.5 * 10 * mesh.area**2 / 1e-30
    assert huge == (np.inf if target is SINGLE else pytest.approx(in_double))
    run.context.setParameter("a target", mesh.area)
    assert run.evaluate(mesh.vertices)[0] == energy


OVERFLOW = """
import openmm as mm
import openmmhelfrich as helfrich

mesh = helfrich.Mesh.icosphere(2, 100.0)
force = helfrich.SurfaceAreaForce(mesh, 10, 1e-30)
force.setBackend("native")
system = mm.System()
for _ in mesh.vertices:
    system.addParticle(50)
system.addForce(force)
platform = mm.Platform.getPlatformByName("OpenCL")
context = mm.Context(system, mm.VerletIntegrator(0.01), platform)
context.setPositions(mesh.vertices)
for _ in range(2):
    print(context.getState(energy=True).getPotentialEnergy()._value)
"""


def test_that_an_energy_overflows_is_said_once():
    SINGLE.context(system_of(1))
    result = subprocess.run(
        [sys.executable, "-c", OVERFLOW], capture_output=True, text=True, timeout=300, check=True
    )
    assert result.stdout.splitlines()[-2:] == ["inf", "inf"]
    assert result.stderr.count("an energy of the membrane is beyond 3e38 kJ/mol") == 1


@pytest.mark.parametrize("target", [REFERENCE, *NATIVE], ids=str)
def test_a_surface_inside_out_is_refused_whenever_its_volume_is_asked_for(target: Target):
    """After other terms have been evaluated, and after the triangles have been turned."""
    mesh, _ = vesicle(92)
    turned = mesh.triangles[:, ::-1].copy()

    def forces(triangles):
        bending, _, volume, _ = forces_of(mesh, triangles)
        return [bending, volume]

    run = Running(forces(turned), mesh.num_vertices, target)
    run.evaluate(mesh.vertices, 0)
    with pytest.raises(mm.OpenMMException, match=r"EnclosedVolumeForce: .*clockwise"):
        run.evaluate(mesh.vertices, 1)
    others = forces(mesh)
    run = Running(others, mesh.num_vertices, target)
    run.evaluate(mesh.vertices)
    others[1].setTrianglesInContext(run.context, turned)
    with pytest.raises(mm.OpenMMException, match=r"EnclosedVolumeForce: .*clockwise"):
        run.evaluate(mesh.vertices)

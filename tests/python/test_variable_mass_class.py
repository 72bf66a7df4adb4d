"""Integrators of variable masses as any other: arguments, copies, XML, states, what is refused."""

from __future__ import annotations

import copy
import pickle
import re

import numpy as np
import openmm as mm
import openmmhelfrich as helfrich
import pytest
from flowing import forces_of, mover_of, start
from openmm import unit
from openmmhelfrich import VariableMassLangevinIntegrator, VariableMassVerletIntegrator
from platforms import CPU, HELFRICH, REFERENCE, Target
from test_variable_mass import areas_of, energies, values

AMU_PER_AREA = unit.amu / unit.nanometer**2
KINDS = ["verlet", "langevin"]


def integrator_of(kind, step=0.2, density=0.0, seed=5):
    if kind == "verlet":
        return VariableMassVerletIntegrator(step, density)
    integrator = VariableMassLangevinIntegrator(300, 0.05, step, density)
    integrator.setRandomNumberSeed(seed)
    return integrator


def system_of(*more, mass=50.0, extra=0) -> mm.System:
    mesh = start()
    system = mm.System()
    for _ in range(mesh.num_vertices + extra):
        system.addParticle(mass)
    for force in [*forces_of(mesh), *more]:
        system.addForce(force)
    return system


def context_of(integrator, *more, platform=HELFRICH, system=None) -> mm.Context:
    context = platform.context(system or system_of(*more), integrator)
    context.setPositions(start().vertices)
    context.setVelocitiesToTemperature(300, 3)
    return context


def bits(context) -> tuple[np.ndarray, ...]:
    return tuple(values(context, "positions", "velocities"))


def same(one, other) -> bool:
    return all((a == b).all() for a, b in zip(one, other, strict=True))


# --- arguments, copies, XML ----------------------------------------------------------------------


def langevin_values(integrator) -> tuple:
    return (
        integrator.getTemperature(),
        integrator.getFriction(),
        integrator.getStepSize().value_in_unit(unit.picosecond),
        integrator.getDensity(),
        integrator.getRandomNumberSeed(),
        integrator.getIntegrationForceGroups(),
    )


def special():
    integrator = VariableMassLangevinIntegrator(310.5, 0.25, 0.125, density=0.5)
    integrator.setRandomNumberSeed(-9)
    integrator.setIntegrationForceGroups({0, 3})
    return integrator


def test_arguments_by_place_by_name_and_as_quantities():
    verlet = VariableMassVerletIntegrator(0.25, 0.5)
    assert verlet.getStepSize() == 0.25 * unit.picosecond and verlet.getDensity() == 0.5
    assert VariableMassVerletIntegrator(0.25).getDensity() == 0
    given = VariableMassVerletIntegrator(
        stepSize=250 * unit.femtosecond, density=0.5e-2 * unit.amu / unit.angstrom**2
    )
    assert given.getStepSize() == 0.25 * unit.picosecond
    assert given.getDensity() == pytest.approx(0.5, rel=1e-15)
    langevin = VariableMassLangevinIntegrator(
        300 * unit.kelvin, 5 / unit.nanosecond, 0.2 * unit.picosecond, 3 * AMU_PER_AREA
    )
    assert langevin_values(langevin) == pytest.approx((300, 0.005, 0.2, 3, 0, -1))
    langevin.setFriction(1 / unit.picosecond)
    langevin.setTemperature(310 * unit.kelvin)
    langevin.setDensity(2 * AMU_PER_AREA)
    assert langevin_values(langevin) == pytest.approx((310, 1, 0.2, 2, 0, -1))


def test_the_step_size_has_no_default():
    with pytest.raises(TypeError, match=r"^VariableMassVerletIntegrator.*'stepSize'"):
        VariableMassVerletIntegrator()


@pytest.mark.parametrize(
    ("make", "error", "words"),
    [
        (lambda: VariableMassVerletIntegrator("fast"), TypeError, "stepSize.*fast"),
        (lambda: VariableMassVerletIntegrator(1 * unit.nanometer), TypeError, "stepSize.*units"),
        (lambda: VariableMassVerletIntegrator(float("nan")), mm.OpenMMException, "stepSize.*nan"),
        (lambda: VariableMassVerletIntegrator(-0.1), mm.OpenMMException, "stepSize.*-0.1"),
        (lambda: VariableMassVerletIntegrator(0.1, -1), mm.OpenMMException, "density.*-1"),
        (lambda: VariableMassVerletIntegrator(0.1, float("inf")), mm.OpenMMException, "density"),
        (lambda: VariableMassVerletIntegrator(0.1, 3 * unit.amu), TypeError, "density.*units"),
        (lambda: VariableMassLangevinIntegrator(-1, 1, 0.1), mm.OpenMMException, "temperature"),
        (lambda: VariableMassLangevinIntegrator(300, -1, 0.1), mm.OpenMMException, "friction"),
        (lambda: special().setDensity(-1), mm.OpenMMException, "density.*-1"),
        (lambda: special().setRandomNumberSeed(1.5), TypeError, "randomNumberSeed.*1.5"),
        (lambda: special().getMasses(), mm.OpenMMException, "not bound to a Context"),
        (lambda: special().step(1), mm.OpenMMException, "not bound to a Context"),
    ],
)
def test_what_makes_no_sense_is_refused_by_name(make, error, words):
    with pytest.raises(error, match=rf"(?s)VariableMass\w+Integrator: .*{words}"):
        make()


@pytest.mark.parametrize(
    "make", [copy.copy, copy.deepcopy, lambda i: pickle.loads(pickle.dumps(i))]
)
def test_copies_are_of_the_class_and_independent(make):
    integrator = special()
    duplicate = make(integrator)
    assert type(duplicate) is VariableMassLangevinIntegrator
    assert langevin_values(duplicate) == langevin_values(integrator)
    duplicate.setDensity(7)
    assert integrator.getDensity() == 0.5
    verlet = make(VariableMassVerletIntegrator(0.125, 0.5))
    assert (verlet.getDensity(), verlet.getStepSize() / unit.picosecond) == (0.5, 0.125)


def test_xml_gives_plain_integrators_that_classes_cast():
    text = mm.XmlSerializer.serialize(special())
    plain = mm.XmlSerializer.deserialize(text)
    assert VariableMassLangevinIntegrator.isinstance(plain)
    assert not VariableMassVerletIntegrator.isinstance(plain)
    with pytest.raises(mm.OpenMMException, match="VariableMassVerletIntegrator: cannot cast"):
        VariableMassVerletIntegrator.cast(plain)
    assert langevin_values(VariableMassLangevinIntegrator.cast(plain)) == langevin_values(special())
    # What has a default may be left out.
    for attribute in ("density", "constraintTolerance", "integrationForceGroups", "randomSeed"):
        shorter = re.sub(f'{attribute}="[^"]*"', "", text)
        assert shorter != text
        mm.XmlSerializer.deserialize(shorter)


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ('stepSize=".125"', 'stepSize="soon"', "stepSize.*soon.*not a number"),
        ('stepSize=".125"', "", "lacks.*stepSize"),
        ('density=".5"', 'density="-2"', "density.*-2.*element <Integrator>"),
        ('version="1"', 'version="9"', "version 9"),
        ('randomSeed="-9"', 'randomSeed="-9" colour="red"', "unknown attribute.*colour"),
    ],
)
def test_broken_xml_names_what_is_wrong(old, new, words):
    text = mm.XmlSerializer.serialize(special())
    assert old in text
    with pytest.raises(mm.OpenMMException, match=f"(?s)VariableMassLangevinIntegrator: .*{words}"):
        mm.XmlSerializer.deserialize(text.replace(old, new))


def test_an_integrator_read_from_xml_runs():
    context = context_of(integrator_of("verlet"))
    text = mm.XmlSerializer.serialize(context.getIntegrator())
    plain = context_of(mm.XmlSerializer.deserialize(text))
    for each in (context, plain):
        each.getIntegrator().step(10)
    assert same(bits(context), bits(plain))


# --- states --------------------------------------------------------------------------------------


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("platform", [REFERENCE, HELFRICH], ids=str)
def test_checkpoints_go_on_with_the_same_bits(kind, platform):
    context = context_of(integrator_of(kind), platform=platform)
    context.getIntegrator().step(7)
    checkpoint = context.createCheckpoint()
    context.getIntegrator().step(11)
    expected = bits(context)
    context.loadCheckpoint(checkpoint)
    context.getIntegrator().step(11)
    assert same(bits(context), expected)
    # In another Context, of another seed.
    other = context_of(integrator_of(kind, seed=99), platform=platform)
    other.loadCheckpoint(checkpoint)
    other.getIntegrator().step(11)
    assert same(bits(other), expected)
    assert other.getStepCount() == 18
    assert other.getTime().value_in_unit(unit.picosecond) == pytest.approx(3.6)


@pytest.mark.parametrize("platform", [REFERENCE, HELFRICH], ids=str)
def test_checkpoints_of_other_integrators_are_taken(platform):
    context = context_of(mm.VerletIntegrator(0.2), platform=platform)
    context.getIntegrator().step(3)
    other = context_of(integrator_of("langevin"), platform=platform)
    other.loadCheckpoint(context.createCheckpoint())
    assert same(bits(other), bits(context))
    context.loadCheckpoint(other.createCheckpoint())
    other.getIntegrator().step(1)


def test_states_and_files_hold_positions_and_velocities_which_is_all(tmp_path):
    context = context_of(integrator_of("verlet", density=0.01))
    context.getIntegrator().step(20)
    state = context.getState(positions=True, velocities=True)
    helfrich.save_state(context, tmp_path / "state")
    before = energies(context)
    context.getIntegrator().step(20)
    expected = bits(context)
    for restore in (
        lambda c: c.setState(state),
        lambda c: c.setState(mm.XmlSerializer.deserialize(mm.XmlSerializer.serialize(state))),
        lambda c: helfrich.load_state(c, tmp_path / "state"),
    ):
        other = context_of(integrator_of("verlet", density=0.01))
        restore(other)
        assert energies(other) == before
        other.getIntegrator().step(20)
        assert same(bits(other), expected)


def test_energies_of_groups_between_steps_change_nothing():
    """They overwrite the forces that a step has left."""
    ends = []
    for asks in (False, True):
        context = context_of(integrator_of("verlet"))
        for _ in range(5):
            context.getIntegrator().step(2)
            if asks:
                context.getState(forces=True, groups={3})
                context.getState(energy=True)
        ends.append(bits(context))
    assert same(*ends)


def test_forces_that_have_changed_are_computed_anew():
    """By a parameter, by another value of a force, by other groups, by positions, by triangles."""
    tilt = mm.CustomExternalForce("g*z")
    tilt.addGlobalParameter("g", 0.0)
    for i in range(start().num_vertices):
        tilt.addParticle(i)
    system = system_of(tilt)
    bending = helfrich.BendingForce.cast(system.getForce(0))
    area = helfrich.SurfaceAreaForce.cast(system.getForce(1))
    area.setForceGroup(2)

    def parameter(context):
        context.setParameter("g", 5.0)

    def modulus(context):
        bending.setRigidity(400.0)
        bending.updateParametersInContext(context)

    def groups(context):
        context.getIntegrator().setIntegrationForceGroups({0})

    def positions(context):
        context.setPositions(1.01 * start().vertices)

    def triangles(context):
        (a, b, c), rest = start().triangles[0], start().triangles[1:]
        # Turn the first edge that may be turned.
        for k, row in enumerate(rest):
            if {a, b} <= set(row):
                (d,) = set(row) - {a, b}
                turned = np.array([[a, d, c], [d, b, c]])
                new = np.concatenate([turned[:1], rest[:k], turned[1:], rest[k + 1 :]])
                bending.setTrianglesInContext(context, new)

    for change in (parameter, groups, positions, triangles, modulus):
        ends = []
        for fresh in (False, True):
            bending.setRigidity(45.0)
            context = context_of(integrator_of("verlet"), system=system)
            context.getIntegrator().step(3)
            state = context.getState(positions=True, velocities=True)
            if fresh:
                context = context_of(integrator_of("verlet"), system=system)
                change(context)
            else:
                change(context)
            if change is not positions:
                context.setState(state) if fresh else None
            elif fresh:
                context.setVelocities(state.getVelocities())
            context.getIntegrator().step(3)
            ends.append(bits(context))
        assert same(*ends), change.__name__


def test_in_a_compound_integrator_it_starts_from_what_others_leave():
    compound = mm.CompoundIntegrator()
    compound.addIntegrator(integrator_of("verlet"))
    compound.addIntegrator(mm.BrownianIntegrator(300, 10.0, 0.01))
    context = mm.Context(system_of(), compound)
    assert context.getPlatform().getName() == "Helfrich"
    context.setPositions(start().vertices)
    compound.step(3)
    compound.setCurrentIntegrator(1)
    compound.step(3)
    other = context_of(integrator_of("verlet"))
    positions, velocities = bits(context)
    other.setPositions(positions)
    other.setVelocities(velocities)
    compound.setCurrentIntegrator(0)
    for each in (context, other):
        each.getIntegrator().step(3)
    assert same(bits(context), bits(other))
    inside = VariableMassVerletIntegrator.cast(compound.getIntegrator(0))
    assert inside.getMasses().sum() == pytest.approx(50.0 * start().num_vertices)


def test_reinitialize_and_the_minimizer():
    context = context_of(integrator_of("langevin"))
    context.getIntegrator().step(5)
    before = bits(context)
    context.reinitialize(preserveState=True)
    assert same(bits(context), before)
    energy = energies(context)[1]
    mm.LocalEnergyMinimizer.minimize(context, tolerance=0.1, maxIterations=20)
    assert energies(context)[1] < energy
    context.getIntegrator().step(5)


# --- surfaces ------------------------------------------------------------------------------------


def test_forces_on_the_same_triangles_share_one_surface():
    """Also on a part of them, on several surfaces at once, and in another order."""
    one, other = start(), start().translated([500.0, 0, 0])
    count = one.num_vertices
    corners = np.concatenate([one.triangles, other.triangles + count])
    system = mm.System()
    constant = np.concatenate([np.full(count, 10.0), np.full(count, 30.0)])
    for mass in constant:
        system.addParticle(mass)
    system.addForce(helfrich.BendingForce(one, 20.0))
    system.addForce(helfrich.SurfaceAreaForce(one.triangles[::-1, [1, 2, 0]], 1.0, one.area))
    around = one.triangles[(one.triangles == 5).any(axis=1)]
    system.addForce(helfrich.DihedralForce(around, 1.0))
    system.addForce(helfrich.BendingForce(other, 20.0, offset=count))
    system.addForce(helfrich.SurfaceRepulsionForce(corners, 5.0, 4.0))
    integrator = integrator_of("verlet")
    context = HELFRICH.context(system, integrator)
    positions = np.concatenate([one.vertices, other.vertices * [1.0, 1.1, 1.0]])
    context.setPositions(positions)
    areas = areas_of(positions, corners)
    expected = np.concatenate(
        [
            constant[part].sum() * areas[part] / areas[part].sum()
            for part in np.split(np.arange(2 * count), 2)
        ]
    )
    assert integrator.getMasses() == pytest.approx(expected, rel=1e-13)
    # Both surfaces keep their mass.
    integrator.step(50)
    masses = integrator.getMasses()
    assert masses[:count].sum() == pytest.approx(10.0 * count, rel=1e-12)
    assert masses[count:].sum() == pytest.approx(30.0 * count, rel=1e-12)


def periodic_context(integrator, box, mesh, shift, periodic=True):
    system = mm.System()
    system.setDefaultPeriodicBoxVectors(*np.array(box))
    for _ in range(mesh.num_vertices):
        system.addParticle(50.0)
    for force in (
        helfrich.BendingForce(mesh, 40.0),
        helfrich.SurfaceAreaForce(mesh, 0.5, mesh.area),
        helfrich.TriangleHeightForce(mesh, 4.0, 5.0),
    ):
        force.setUsesPeriodicBoundaryConditions(periodic)
        system.addForce(force)
    context = HELFRICH.context(system, integrator)
    positions = mesh.vertices + shift
    if periodic:
        for axis in (2, 1, 0):
            positions -= np.floor(positions[:, axis] / box[axis, axis])[:, None] * box[axis]
    context.setPositions(positions)
    return context


def test_a_vesicle_across_the_faces_of_the_box_moves_as_one_in_the_middle():
    box = np.array([[400.0, 0, 0], [96.0, 420, 0], [-112.0, 64, 384]])
    velocities = np.random.default_rng(8).normal(0, 0.3, (start().num_vertices, 3))
    ends = []
    for periodic in (False, True):
        integrator = integrator_of("verlet")
        context = periodic_context(integrator, box, start(), [190.0, 10.0, 5.0], periodic)
        context.setVelocities(velocities)
        integrator.step(100)
        ends.append(values(context, "velocities")[0])
        masses = integrator.getMasses()
    assert ends[0] == pytest.approx(ends[1], abs=1e-9)
    assert masses.sum() == pytest.approx(50.0 * len(masses))


def test_a_sheet_that_spans_the_box_and_an_open_disk_conserve_energy():
    sheet = helfrich.Mesh.sheet(8, 8, 30.0, periodic=True)
    disk = helfrich.Mesh.disk(4, 100.0)
    random = np.random.default_rng(2)
    for mesh, box in ((sheet, sheet.box), (disk, 1000.0 * np.eye(3))):
        bent = helfrich.Mesh(
            mesh.vertices + random.normal(0, 2.0, mesh.vertices.shape), mesh.triangles, mesh.box
        )
        spread = []
        for step in (0.2, 0.1):
            integrator = VariableMassVerletIntegrator(step)
            context = periodic_context(integrator, box, bent, 0.0, mesh.box is not None)
            context.setVelocitiesToTemperature(300, 4)
            total = []
            for _ in range(30):
                integrator.step(round(1 / step))
                total.append(sum(energies(context)))
            spread.append(np.std(total))
        assert spread[0] < 1e-3 * 2.5 * mesh.num_vertices
        assert 3 < spread[0] / spread[1] < 5


@pytest.mark.parametrize("kind", KINDS)
def test_bits_are_the_same_on_any_number_of_threads(kind):
    """From 20 000 particles on, threads share a step."""
    mesh = helfrich.Mesh.icosphere(45, 3000.0)
    assert mesh.num_vertices > 20_000
    system = mm.System()
    for _ in range(mesh.num_vertices):
        system.addParticle(50.0)
    system.addForce(helfrich.SurfaceAreaForce(mesh, 1.3, mesh.area))
    system.addForce(helfrich.BendingForce(mesh, 50.0))
    ends = []
    for threads in ("1", "2", "3"):
        target = Target("Helfrich", "Helfrich", 0.0, {"Threads": threads})
        context = target.context(system, integrator_of(kind))
        context.setPositions(mesh.vertices)
        context.setVelocitiesToTemperature(300, 3)
        context.getIntegrator().step(3)
        ends.append(bits(context))
    assert same(ends[0], ends[1]) and same(ends[0], ends[2])


@pytest.mark.parametrize("kind", KINDS)
def test_the_platforms_agree_and_seeds_decide(kind):
    reference = context_of(integrator_of(kind), platform=REFERENCE)
    ours = context_of(integrator_of(kind))
    other = context_of(integrator_of(kind, seed=6))
    for context in (reference, ours, other):
        context.getIntegrator().step(20)
    for one, two in zip(bits(reference), bits(ours), strict=True):
        assert one == pytest.approx(two, abs=1e-9)
    assert same(bits(ours), bits(other)) == (kind == "verlet")


def test_openmm_chooses_helfrich():
    context = mm.Context(system_of(), integrator_of("verlet"))
    assert context.getPlatform().getName() == "Helfrich"
    costly = mm.NonbondedForce()
    for _ in range(start().num_vertices):
        costly.addParticle(0, 1, 0)
    context = mm.Context(system_of(costly), integrator_of("langevin"))
    assert context.getPlatform().getName() == "Helfrich"


def test_virtual_sites_beside_the_membrane_follow():
    system = system_of(extra=1)
    site = start().num_vertices
    system.setParticleMass(site, 0)
    system.setVirtualSite(site, mm.TwoParticleAverageSite(0, 1, 0.25, 0.75))
    integrator = integrator_of("verlet")
    context = HELFRICH.context(system, integrator)
    context.setPositions(np.concatenate([start().vertices, [[0.0, 0, 0]]]))
    context.computeVirtualSites()
    context.setVelocitiesToTemperature(300, 1)
    integrator.step(5)
    (positions,) = values(context, "positions")
    assert positions[site] == pytest.approx(0.25 * positions[0] + 0.75 * positions[1], abs=1e-12)


# --- what is refused -----------------------------------------------------------------------------


def barostat(rigid: bool) -> mm.Force:
    force = mm.MonteCarloBarostat(1.0, 300, 1)
    force.setScaleMoleculesAsRigid(rigid)
    return force


@pytest.mark.parametrize(
    ("force", "words"),
    [
        (lambda: mover_of(start()), "flip.*kinetic"),
        (lambda: helfrich.MonteCarloMembraneTension(300), "kinetic"),
        (lambda: mm.AndersenThermostat(300, 1), "VariableMassLangevinIntegrator"),
        (lambda: mm.CMMotionRemover(), "conserve the momentum"),
        (lambda: barostat(False), "barostat.*setScaleMoleculesAsRigid"),
    ],
)
@pytest.mark.parametrize("platform", [REFERENCE, HELFRICH], ids=str)
def test_what_would_not_be_exact_is_refused_with_the_reason(force, words, platform):
    added = force()
    system = system_of(added)
    if isinstance(added, (mm.MonteCarloBarostat, helfrich.MonteCarloMembraneTension)):
        # These want a box to change.
        system.setDefaultPeriodicBoxVectors(*np.diag([900.0, 900.0, 900.0]))
        for plain in system.getForces():
            for cls in helfrich.MembraneForce.__subclasses__():
                if cls.isinstance(plain):
                    cls.cast(plain).setUsesPeriodicBoundaryConditions(True)
    with pytest.raises(mm.OpenMMException, match=f"(?s)VariableMassVerletIntegrator: .*{words}"):
        platform.context(system, integrator_of("verlet"))


def test_a_barostat_that_moves_molecules_as_a_whole_is_taken():
    """It leaves every area, hence every mass, as it is."""
    system = system_of(barostat(True))
    system.setDefaultPeriodicBoxVectors(*np.diag([900.0, 900.0, 900.0]))
    for plain in system.getForces():
        for cls in helfrich.MembraneForce.__subclasses__():
            if cls.isinstance(plain):
                cls.cast(plain).setUsesPeriodicBoundaryConditions(True)
    integrator = integrator_of("langevin")
    context = context_of(integrator, system=system)
    box = context.getState().getPeriodicBoxVolume()
    integrator.step(10)
    assert context.getState().getPeriodicBoxVolume() != box


def test_an_integrator_that_was_refused_is_free_for_another_context():
    integrator = integrator_of("verlet")
    with pytest.raises(mm.OpenMMException, match="CMMotionRemover"):
        HELFRICH.context(system_of(mm.CMMotionRemover()), integrator)
    with pytest.raises(mm.OpenMMException, match="the platform CPU"):
        CPU.context(system_of(), integrator)
    context = context_of(integrator)
    integrator.step(1)
    assert context.getStepCount() == 1
    with pytest.raises(mm.OpenMMException, match="belongs to another Context"):
        context_of(integrator)


def test_constraints_and_vertices_that_are_virtual_sites_are_refused():
    system = system_of()
    system.addConstraint(0, 1, 1.0)
    with pytest.raises(mm.OpenMMException, match=r"VariableMassVerletIntegrator: .*constraints"):
        HELFRICH.context(system, integrator_of("verlet"))
    system = system_of()
    system.setParticleMass(4, 0)
    system.setVirtualSite(4, mm.TwoParticleAverageSite(0, 1, 0.5, 0.5))
    with pytest.raises(mm.OpenMMException, match="particle 4 is a vertex and a virtual site"):
        HELFRICH.context(system, integrator_of("verlet"))


@pytest.mark.parametrize("kind", KINDS)
def test_other_platforms_are_told_where_to_go(kind):
    with pytest.raises(mm.OpenMMException, match=r"the platform CPU .*platform Helfrich or Refer"):
        CPU.context(system_of(), integrator_of(kind))


def test_a_system_without_membranes_is_refused():
    system = mm.System()
    system.addParticle(1.0)
    with pytest.raises(mm.OpenMMException, match="no membrane force"):
        REFERENCE.context(system, integrator_of("verlet"))


def test_a_surface_inside_of_another_force_is_refused_unless_it_is_outside_too():
    def inside(mesh, offset):
        variable = mm.CustomCVForce("0.1*area")
        variable.addCollectiveVariable(
            "area", helfrich.SurfaceAreaForce(mesh, 1.0, 0.9 * mesh.area, offset=offset)
        )
        return variable

    count = start().num_vertices
    integrator = integrator_of("verlet")
    context = context_of(integrator, inside(start(), 0))
    integrator.step(2)
    assert context.getStepCount() == 2
    system = system_of(inside(helfrich.Mesh.icosphere(1, 20.0), count), extra=12)
    with pytest.raises(mm.OpenMMException, match=rf"particle {count} is a vertex.*CustomCVForce"):
        HELFRICH.context(system, integrator_of("verlet"))


def test_two_triangulations_of_the_same_particles_are_refused():
    other = start().triangles.copy()
    a, b, c = other[0]
    k = next(k for k in range(1, len(other)) if {a, b} <= set(other[k]))
    (d,) = set(other[k]) - {a, b}
    other[0], other[k] = [a, d, c], [d, b, c]
    system = system_of(helfrich.DihedralForce(other, 1.0))
    with pytest.raises(
        mm.OpenMMException, match=r"(?s)VariableMass.*no surface.*the same triangles"
    ):
        HELFRICH.context(system, integrator_of("verlet"))


@pytest.mark.parametrize("platform", [REFERENCE, HELFRICH], ids=str)
def test_a_step_that_is_too_large_says_so_and_changes_nothing(platform):
    context = context_of(integrator_of("langevin"), platform=platform)
    before, time = bits(context), context.getTime()
    context.getIntegrator().setStepSize(500.0)
    with pytest.raises(mm.OpenMMException, match=r"(?s)VariableMassLangevin.*500 ps.*smaller step"):
        context.getIntegrator().step(1)
    assert same(bits(context), before) and context.getTime() == time
    assert context.getStepCount() == 0
    # It goes on with a sensible one, as if nothing had happened.
    context.getIntegrator().setStepSize(0.2)
    context.getIntegrator().step(5)
    other = context_of(integrator_of("langevin"), platform=platform)
    other.getIntegrator().step(5)
    assert same(bits(context), bits(other))


def test_velocities_that_are_no_numbers_name_the_particle():
    context = context_of(integrator_of("verlet"))
    _, velocities = bits(context)
    velocities[17, 1] = np.nan
    context.setVelocities(velocities)
    with pytest.raises(mm.OpenMMException, match="velocity of particle 17"):
        context.getIntegrator().step(1)


def test_velocities_need_positions_first():
    context = HELFRICH.context(system_of(), integrator_of("verlet"))
    with pytest.raises(mm.OpenMMException, match=r"Integrator: triangle .*has no area"):
        context.setVelocitiesToTemperature(300)


# --- constant masses -----------------------------------------------------------------------------


def test_plaquette_masses_of_meshes_and_mean_areas():
    mesh = start()
    areas = areas_of(mesh.vertices, mesh.triangles)
    assert helfrich.plaquette_masses(mesh, 0.25) == pytest.approx(0.25 * areas, rel=1e-12)
    frames = np.stack([areas, 3 * areas])
    for given in (frames, frames * unit.nanometer**2):
        masses = helfrich.plaquette_masses(given, density=0.25 * AMU_PER_AREA)
        assert masses == pytest.approx(0.5 * areas, rel=1e-12)
    masses = helfrich.plaquette_masses(mesh, total_mass=1000 * unit.amu)
    assert masses == pytest.approx(1000 * areas / areas.sum(), rel=1e-12)
    box = np.diag([500.0, 500.0, 500.0])
    wrapped = helfrich.Mesh(mesh.vertices % 500.0, mesh.triangles, box)
    assert helfrich.plaquette_masses(wrapped, 1.0) == pytest.approx(areas, rel=1e-12)


@pytest.mark.parametrize(
    ("arguments", "error", "words"),
    [
        ({}, TypeError, "either a density or a total_mass"),
        ({"density": 1, "total_mass": 1}, TypeError, "either"),
        ({"density": 0}, ValueError, "density.*above zero"),
        ({"total_mass": -3}, ValueError, "total_mass.*-3"),
        ({"density": 3 * unit.amu}, TypeError, "density.*units"),
        ({"areas": [1.0, 0.0], "density": 1}, ValueError, "vertex 1"),
        ({"areas": [[[1.0]]], "density": 1}, ValueError, "shape"),
        ({"areas": ["x"], "density": 1}, ValueError, "numbers"),
    ],
)
def test_plaquette_masses_refuse_by_name(arguments, error, words):
    arguments = {"areas": start()} | arguments
    with pytest.raises(error, match=f"plaquette_masses: .*{words}"):
        helfrich.plaquette_masses(**arguments)

"""`pull`: a constant force on some particles, apart from the energies of the terms."""

import numpy as np
import openmm
import pytest
from meshes import icosphere, moved, rough
from openmm import unit
from openmmhelfrich import Mesh, Vesicle, pull

FORCE = unit.kilojoule_per_mole / unit.nanometer


@pytest.fixture
def mesh():
    surface = moved(icosphere(2), (100, 90, 110))
    return Mesh(*rough(surface, np.random.default_rng(3), 0.1))


def context_of(system, mesh):
    platform = openmm.Platform.getPlatformByName("Reference")
    context = openmm.Context(system, openmm.VerletIntegrator(0.001), platform)
    context.setPositions(mesh.vertices)
    return context


def forces_of(context):
    return context.getState(forces=True).getForces(asNumpy=True).value_in_unit(FORCE)


def test_particles_share_the_force_and_terms_keep_their_energies(mesh):
    vesicle, pulled = Vesicle(mesh), Vesicle(mesh)
    system = pulled.system()
    whole = np.array([1.5, -2.0, 0.25])
    tweezers = pull(system, [3, 1, 7, 5], whole)
    with_pull, without = context_of(system, mesh), context_of(vesicle.system(), mesh)
    expected = np.zeros((mesh.num_vertices, 3))
    expected[[1, 3, 5, 7]] = whole / 4
    assert np.allclose(forces_of(with_pull) - forces_of(without), expected, atol=1e-9)
    assert pulled.energies(with_pull) == pytest.approx(vesicle.energies(without), rel=1e-12)
    groups = [force.getForceGroup() for force in system.getForces()]
    assert groups.count(tweezers.getForceGroup()) == 1


def test_the_components_are_context_parameters(mesh):
    system = Vesicle(mesh).system()
    pull(system, [0], (0, 0, 0))
    number = system.getNumForces() - 1
    context = context_of(system, mesh)
    before = forces_of(context)
    context.setParameter(f"pull_y{number}", 2.5)
    change = forces_of(context) - before
    assert change[0] == pytest.approx([0, 2.5, 0], abs=1e-9)
    assert np.abs(change[1:]).max() < 1e-9


def test_two_of_them_are_independent_and_quantities_will_do(mesh):
    system = Vesicle(mesh).system()
    context = context_of(Vesicle(mesh).system(), mesh)
    newton = unit.AVOGADRO_CONSTANT_NA * unit.newton
    pull(system, np.array([2]), (1, 0, 0) * FORCE)
    pull(system, np.array([4]), np.array([0, 1e-12, 0]) * newton)
    change = forces_of(context_of(system, mesh)) - forces_of(context)
    assert change[2] == pytest.approx([1, 0, 0], abs=1e-9)
    # A piconewton per mole.
    assert change[4] == pytest.approx([0, 0.602214076, 0], rel=1e-7, abs=1e-9)


@pytest.mark.parametrize(
    ("particles", "force", "error", "message"),
    [
        ([], (1, 0, 0), ValueError, "particles need indices"),
        ([0.5], (1, 0, 0), ValueError, "particles need indices"),
        ([[0, 1]], (1, 0, 0), ValueError, "particles need indices"),
        ([[0], [0, 1]], (1, 0, 0), ValueError, "pull: particles need indices"),
        ([1, 1], (1, 0, 0), ValueError, "twice"),
        ([-1], (1, 0, 0), IndexError, "no particle -1"),
        ([10**6], (1, 0, 0), IndexError, "no particle 1000000"),
        ([0], (1, 0), ValueError, "three numbers"),
        ([0], 1.0, ValueError, "three numbers"),
        ([0], (1, (0, 1), 0), ValueError, "pull: force needs three numbers"),
        ([0], (1, 0, np.nan), ValueError, "finite"),
        ([0], (1, 0, 0) * unit.newton, TypeError, "AVOGADRO"),
    ],
)
def test_bad_input_is_named_and_adds_nothing(mesh, particles, force, error, message):
    system = Vesicle(mesh).system()
    count = system.getNumForces()
    with pytest.raises(error, match=message):
        pull(system, particles, force)
    assert system.getNumForces() == count


def test_something_else_than_a_system_is_named(mesh):
    with pytest.raises(TypeError, match=r"openmm\.System, got Vesicle; .*vesicle\.system\(\)"):
        pull(Vesicle(mesh), [0], (1, 0, 0))


def positions(vesicle, integrator, **options):
    simulation = vesicle.simulation(integrator, **options)
    simulation.step(50)
    state = simulation.context.getState(positions=True)
    return state.getPositions(asNumpy=True).value_in_unit(unit.nanometer)


def langevin():
    return openmm.LangevinMiddleIntegrator(300, 0.1, 0.001)


def test_equal_seeds_give_equal_runs(mesh):
    fluid = Vesicle(mesh, volume_modulus=0, flips=0.5, viscosity={"friction": 1.0})
    one, same, other = (positions(fluid, langevin(), seed=seed) for seed in (4, 4, 5))
    assert np.array_equal(one, same)
    assert not np.array_equal(one, other)
    mover = fluid.placement.flips
    assert mover.getRandomNumberSeed() == 5
    assert fluid.placement.viscosity.getRandomNumberSeed() == 5


def test_every_integrator_of_several_has_the_seed(mesh):
    several = openmm.CompoundIntegrator()
    for _ in range(2):
        several.addIntegrator(langevin())
    Vesicle(mesh).simulation(several, seed=6)
    assert [several.getIntegrator(i).getRandomNumberSeed() for i in range(2)] == [6, 6]


def test_a_seed_of_their_own_stays(mesh):
    fluid = Vesicle(mesh, flips={"attemptsPerEdge": 0.1, "randomNumberSeed": 9})
    integrator = langevin()
    fluid.simulation(integrator, seed=3)
    assert fluid.placement.flips.getRandomNumberSeed() == 9
    assert integrator.getRandomNumberSeed() == 3


def test_a_seed_out_of_range_is_named(mesh):
    for seed in (0, -1, 2**31, 1.5):
        with pytest.raises(ValueError, match="Vesicle: seed"):
            Vesicle(mesh).simulation(langevin(), seed=seed)

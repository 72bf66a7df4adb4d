"""Vesicles that start from flattened random spheres: their runs, and what has become of them.

Farnudi, Ejtehadi and Everaers, Phys. Rev. E 108, 015301 (2023), doi:10.1103/PhysRevE.108.015301.
"""

import numpy as np
import openmmhelfrich as helfrich
from _paper import mean_and_error
from _snapshots import along_axes

RADIUS = 1000.0  # nm
RIGIDITY = 50.0  # kJ/mol
SOFTEST = 0.037
FRICTION = 0.01  # 1/ps

# Samples of the energies after the ramp, and how many of them lie between two tests for crossings.
SAMPLES, BETWEEN = 240, 6
# Part of a run that is the ramp of d.
RAMP = 0.2
# Time step over the bound 0.1 √Ξ τ of Fig. 5; a run that fails is made again with a quarter of it.
TIME_STEP, SHORTER = 0.75, 0.25
# The sphere breathes at 0.18 rad/ps for N = 1002, whatever Ξ; ps.
LONGEST_STEP = 2.5

# Heights hold more energy than on the sphere by this share where a mesh is strained.
STRAINED = 0.1
CLASSES = {"green": "settled and intact", "yellow": "intact", "red": "failed or crosses itself"}


def oblate_run(reduced_volume, softness, periods, num_vertices, seed):
    """Run one vesicle from an oblate, with a ramp of the heights and some time after it.

    The mesh is as soft as SOFTEST at the start and during the ramp, so that the time step is that
    of SOFTEST there and that of the softness afterwards. A run that fails is made again with
    shorter steps, so that a failure is one of the mesh and not of the integrator.

    Parameters
    ----------
    reduced_volume : float
        ν of the oblate.
    softness : float
        Ξ at the end of the ramp.
    periods : float
        Length in τ_2, of which RAMP is the ramp.
    num_vertices : int
        N of the random sphere.
    seed : int
        Of the mesh, velocities and noise.

    Returns
    -------
    dict
        "energies" of area, volume, bending and heights at SAMPLES times after the ramp, shape
        (SAMPLES, 4), kJ/mol, fewer if the run failed; "crossings", pairs of triangles that pass
        through each other, at every BETWEEN-th of them; the last "shape", shape (N, 3), nm, and its
        "triangles"; "failed", why the run ended early, or ""; "time_step", ps, after the ramp;
        "attempts", 1 or 2.
    """
    mesh = start_of(reduced_volume, num_vertices, seed)
    result = _run(mesh, softness, periods, TIME_STEP, seed)
    again = bool(result["failed"])
    if again:
        result = _run(mesh, softness, periods, SHORTER * TIME_STEP, seed)
    return {**result, "triangles": mesh.triangles, "attempts": 1 + again}


def start_of(reduced_volume, num_vertices, seed):
    """The oblate that a run starts from; the sphere itself where that is as flat already."""
    mesh = helfrich.Mesh.random_sphere(num_vertices, RADIUS, seed)
    return mesh.oblate(reduced_volume) if reduced_volume < mesh.reduced_volume else mesh


def _run(mesh, softness, periods, share, seed):
    import openmm

    vesicle = helfrich.Vesicle(
        mesh,
        rigidity=RIGIDITY,
        softness=SOFTEST,
        scheme=helfrich.BendingForce.GompperKrollBarycentric,
    )
    slow = share * vesicle.max_time_step
    fast = min(slow * (softness / SOFTEST) ** 0.5, LONGEST_STEP)
    duration = periods * vesicle.tau_2
    integrator = openmm.LangevinMiddleIntegrator(300, FRICTION, slow)
    integrator.setRandomNumberSeed(seed)
    simulation = vesicle.simulation(integrator)
    result = {"shape": mesh.vertices, "failed": "", "time_step": fast}
    energies, crossed = [], []
    try:
        if vesicle.energies(simulation.context)["heights"] > vesicle.epsilon * mesh.num_vertices:
            # The flattest starts have triangles of nearly no height at their rim.
            simulation.minimizeEnergy(maxIterations=200)
        simulation.context.setVelocitiesToTemperature(300, seed)
        steps = round(RAMP * duration / slow)
        target = mesh.min_height(softness)
        helfrich.harden(simulation, vesicle.placement.heights, target, steps)
        integrator.setStepSize(fast)
        for sample in range(SAMPLES):
            simulation.step(round((1 - RAMP) * duration / fast / SAMPLES))
            energies.append(list(vesicle.energies(simulation.context).values()))
            if (sample + 1) % BETWEEN == 0:
                result["shape"] = _positions(simulation.context)
                crossed.append(len(helfrich.analysis.crossings(result["shape"], mesh.triangles)))
    except (openmm.OpenMMException, ValueError) as error:
        result["failed"] = str(error) or type(error).__name__
    result["energies"] = np.array(energies).reshape(-1, 4)
    result["crossings"] = np.array(crossed, dtype=int)
    return result


def _positions(context):
    from openmm import unit

    positions = context.getState(positions=True).getPositions(asNumpy=True)
    return positions.value_in_unit(unit.nanometer)


def late(vesicle, column):
    """The last third of the energies of one term, kJ/mol."""
    return vesicle["energies"][-SAMPLES // 3 :, column]


def slope(series):
    """How far a series at equal intervals drifts over its length, by least squares, and its error.

    Neighbouring values know of each other. So the line goes through the means of twelve blocks, and
    its error comes from how far these lie off it.

    Parameters
    ----------
    series : array_like
        12 values or more.

    Returns
    -------
    float, float
        The change from the beginning to the end, in units of the series, and its standard error.
    """
    blocks = np.array([block.mean() for block in np.array_split(np.asarray(series, float), 12)])
    x = np.linspace(-0.5, 0.5, len(blocks)) * (1 - 1 / len(blocks))
    gradient = x @ blocks / (x @ x)
    rest = blocks - blocks.mean() - gradient * x
    variance = rest @ rest / (len(blocks) - 2)
    return float(gradient), float(np.sqrt(variance / (x @ x)))


def is_settled(vesicle):
    """Whether neither bending nor height energy drifts over the last third.

    A drift is one of more than three standard errors and of more than the energy fluctuates.
    """
    for column in (2, 3):
        change, error = slope(late(vesicle, column))
        if abs(change) > max(3 * error, late(vesicle, column).std()):
            return False
    return True


def class_of(vesicle, sphere):
    """What became of a vesicle: "green", "yellow" or "red".

    Parameters
    ----------
    vesicle : dict
        Of `oblate_run`.
    sphere : float
        Mean height energy of meshes of the same Ξ at the largest ν, kJ/mol.

    Returns
    -------
    str
        "red" if the run failed or the surface passes through itself at one of the tests; "yellow"
        if it still drifts, or its heights hold more than 1 + STRAINED times the energy of those of
        the sphere; else "green".
    """
    if vesicle["failed"] or vesicle["crossings"].any():
        return "red"
    strained = late(vesicle, 3).mean() > (1 + STRAINED) * sphere
    return "yellow" if strained or not is_settled(vesicle) else "green"


def upright(vesicle):
    """The last shape of a vesicle, its axis along z."""
    return along_axes(helfrich.Mesh(vesicle["shape"], vesicle["triangles"]))


def dimple(mesh):
    """Thickness in the middle over the largest one, of a disc whose axis is z; 1 without dimple."""
    rho = np.hypot(mesh.vertices[:, 0], mesh.vertices[:, 1])
    rings = np.minimum((8 * rho / np.percentile(rho, 98)).astype(int), 8)
    z = abs(mesh.vertices[:, 2])
    profile = np.array([z[rings == ring].mean() for ring in range(8)])
    return profile[0] / profile.max()


def over_seeds(vesicles, value):
    """Mean of a value over the vesicles that ran to the end, its standard error, and their number.

    NaN if there are none.
    """
    values = [value(vesicle) for vesicle in vesicles if not vesicle["failed"]]
    if not values:
        return np.nan, np.nan, 0
    mean, error = mean_and_error(values)
    return float(mean), float(error), len(values)


def late_energy(vesicles, column):
    """`over_seeds` of the mean energy of one term over the last third, kJ/mol."""
    return over_seeds(vesicles, lambda vesicle: late(vesicle, column).mean())

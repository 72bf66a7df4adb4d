"""What Verlet dynamics keep while bonds flip: the energy with a demon, the temperature with a bath.

A vesicle comes to equilibrium under LangevinMiddle with flips. Then dynamics without a bath take
over,

- without flips: energy of the System,
- with flips that a demon pays for (ensemble Microcanonical): energy of the System and the demon,
- with flips at a temperature (ensemble Canonical): kinetic temperature,

under OpenMM's VerletIntegrator and under velocity Verlet, which has half a kick at each end of a
step. VerletIntegrator kicks once a step; there the mover changes velocities so that flips come
between two half kicks, too.

A jump is a change of the energy by more than 10 kBT from one frame to the next. Where triangles
fold over until an angle between normals passes through π, the energy of bending is not continuous,
and no time step is short enough: runs with a dihedral potential, which forbids that, are beside.
"""

import numpy as np
import openmm
from fluid_run import MAX_DEGREE, TEMPERATURE, simulated, vesicle_of
from openmm import unit
from openmmhelfrich import MonteCarloBondFlip
from openmmhelfrich.vesicle import KBT
from reports import Report
from settings import SETTINGS

VERSION = 1
NUM_VERTICES = 252
JUMP = 10.0  # kBT

CASES = [
    ("none", "Verlet"),
    ("Microcanonical", "Verlet"),
    ("Microcanonical", "velocity Verlet"),
    ("Canonical", "Verlet"),
]
"""Who pays for flips, or "none" without; the integrator."""


class VelocityVerletIntegrator(openmm.CustomIntegrator):
    """Velocity Verlet, whose velocities are those of the time of the positions."""

    def __init__(self, step_size):
        super().__init__(step_size)
        self.addUpdateContextState()
        self.addComputePerDof("v", "v + 0.5 * dt * f / m")
        self.addComputePerDof("x", "x + dt * v")
        self.addComputePerDof("v", "v + 0.5 * dt * f / m")


INTEGRATORS = {"Verlet": openmm.VerletIntegrator, "velocity Verlet": VelocityVerletIntegrator}


def without_bath(
    vesicle, kind, integrator, time_step, seed, every=10, attempts=0.1, friction=0.01, periods=2
):
    """A Context in equilibrium, whose bath has just been taken away.

    Parameters
    ----------
    vesicle : Vesicle
    kind, integrator : str
        See CASES.
    time_step : float
        ps.
    seed : int
        Of velocities, noise and flips.
    every : int
        Steps between rounds of flips.
    attempts : float
        For each edge and round; with the bath, the usual ones.
    friction : float
        γ of the bath, LangevinMiddle, 1/ps.
    periods : float
        How long it is there, τ_2.

    Returns
    -------
    tuple
        The Context, and its mover or None.
    """

    def mover_of(ensemble, *rate):
        mover = MonteCarloBondFlip(vesicle.mesh, TEMPERATURE, *rate, maxDegree=MAX_DEGREE)
        mover.setRandomNumberSeed(seed)
        mover.setEnsemble(ensemble)
        return mover

    bath = openmm.LangevinMiddleIntegrator(TEMPERATURE, friction, time_step)
    bath.setRandomNumberSeed(seed)
    settling = mover_of(MonteCarloBondFlip.Canonical)
    before = simulated(vesicle, bath, settling)
    before.setVelocitiesToTemperature(TEMPERATURE, seed)
    bath.step(round(periods * vesicle.tau_2 / time_step))

    mover = None
    if kind != "none":
        mover = mover_of(getattr(MonteCarloBondFlip, kind), every, attempts)
    context = simulated(vesicle, INTEGRATORS[integrator](time_step), mover)
    state = before.getState(getPositions=True, getVelocities=True)
    triangles = settling.getTrianglesInContext(before)
    vesicle.placement.forces["bending"].setTrianglesInContext(context, triangles)
    context.setPositions(state.getPositions())
    context.setVelocities(state.getVelocities())
    return context, mover


def conserve(softness, kind, integrator, time_step, periods, frames, seed, dihedrals=0.0):
    """Dynamics without a bath, after equilibrium.

    Parameters
    ----------
    softness : float
        Ξ.
    kind, integrator : str
        See CASES.
    time_step : float
        ps.
    periods : float
        Length, τ_2.
    frames : int
        Number of frames.
    seed : int
        Of everything.
    dihedrals : float
        See `vesicle_of`.

    Returns
    -------
    dict
        "time", τ_2; "energy", that of the System and the demon, kBT, from the start; "temperature",
        K; "demon", kBT; each of shape (frames + 1,), or shorter if the run blew up, which "failed"
        says; "flips", accepted for each edge and τ_2.
    """
    vesicle = vesicle_of(NUM_VERTICES, softness, seed, dihedrals)
    context, mover = without_bath(vesicle, kind, integrator, time_step, seed)
    dynamics = context.getIntegrator()

    stride = round(periods * vesicle.tau_2 / time_step / frames)
    rows, flips, failed = [], 0.0, False
    for frame in range(frames + 1):
        try:
            dynamics.step(stride if frame else 0)
            state = context.getState(getEnergy=True)
        except openmm.OpenMMException:
            failed = True
            break
        kinetic = state.getKineticEnergy().value_in_unit(unit.kilojoule_per_mole)
        potential = state.getPotentialEnergy().value_in_unit(unit.kilojoule_per_mole)
        statistics = mover.getStatistics(context) if mover else {"demonEnergy": 0.0, "rate": 0.0}
        flips = statistics["rate"] * vesicle.tau_2
        rows.append((kinetic, potential, statistics["demonEnergy"]))
    kinetic, potential, demon = np.array(rows).T / KBT
    energy = kinetic + potential + demon
    return {
        "time": np.arange(len(rows)) * stride * time_step / vesicle.tau_2,
        "energy": energy - energy[0],
        "temperature": kinetic / (1.5 * NUM_VERTICES) * TEMPERATURE,
        "demon": demon,
        "flips": float(np.nan_to_num(flips)),
        "failed": failed,
    }


def main():
    report = Report("conservation", __doc__)
    softnesses, seeds, periods = ((0.33,), 1, 1) if report.quick else ((0.33, 0.15, 0.037), 3, 2)
    setups = [(softness, 0.0) for softness in softnesses]
    if not report.quick:
        setups.append((0.037, 2.0))
    rows = []
    for softness, dihedrals in setups:
        for kind, integrator in CASES:
            # A bath of flips is slow to tell its temperature.
            length = 5 * periods if kind == "Canonical" else periods
            points = [
                {
                    "softness": softness,
                    "kind": kind,
                    "integrator": integrator,
                    "time_step": SETTINGS[softness].time_step / 2,
                    "periods": length,
                    "frames": 40 * length,
                    "seed": seed,
                    "dihedrals": dihedrals,
                }
                for seed in range(1, 1 + seeds)
            ]
            runs = report.runs(conserve, points, VERSION)
            if runs:
                about = (softness, dihedrals, kind, integrator, points[0]["time_step"])
                rows.append((*about, *summary(runs, kind != "Canonical")))
    names = "Ξ K flips integrator Δt drift error jumps failed flips/τ_2 T T_error"
    report.table(names.split(), rows)
    print("drift: kBT for each vertex and τ_2, without jumps; jumps: for each vertex and τ_2")


def summary(runs, conserved):
    """Drift and its error, jumps, how many runs failed, flips, temperature and its error."""
    steps = [np.diff(run["energy"]) for run in runs]
    smooth = [each[np.abs(each) < JUMP] for each in steps]
    interval = runs[0]["time"][1]
    drifts = np.array([each.mean() / interval / NUM_VERTICES for each in smooth])
    length = sum(run["time"][-1] for run in runs) * NUM_VERTICES
    jumps = sum(len(each) for each in steps) - sum(len(each) for each in smooth)
    kelvin = np.array([run["temperature"].mean() for run in runs])
    root = len(runs) ** 0.5
    several = len(runs) > 1
    return (
        float(drifts.mean()) if conserved else "",
        float(drifts.std(ddof=1) / root) if several and conserved else "",
        float(jumps / length) if conserved else "",
        sum(run["failed"] for run in runs),
        float(np.mean([run["flips"] for run in runs])),
        float(kelvin.mean()),
        float(kelvin.std(ddof=1) / root) if several else "",
    )


if __name__ == "__main__":
    main()

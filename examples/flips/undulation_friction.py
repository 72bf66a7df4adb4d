"""What flips add to the friction of undulations: damping of u_lm under Newton's equations.

Velocity Verlet and a demon that pays for flips, N = 492, Ξ = 0.33. The damped oscillation
(A35–A37) of doi:10.1103/PhysRevE.108.015301 is fitted to the autocorrelations of u_lm over three
periods of each l, as `../paper/sm09_damping.py` does on meshes with fixed neighbours. Without flips
neighbours are those that flips have left at the start, and u_lm is that about its mean.
"""

import sys
from pathlib import Path

import numpy as np
from conservation import without_bath
from fluid_run import vesicle_of
from openmm import unit
from openmmhelfrich.analysis import fit_damping, mode_amplitudes
from openmmhelfrich.vesicle import KBT
from reports import Report
from settings import SETTINGS

sys.path.append(str(Path(__file__).resolve().parents[1] / "paper"))
from fig09_10_autocorrelation import frequency_of, modes_in

VERSION = 1
SOFTNESS = 0.33
L = range(2, 7)
FIT_PERIODS = 3

SHARES = (0.0, 0.1, 0.3, 1.0)
"""Flips over the usual ones."""

# Between frames, ps: 17 frames in a period of l = 6.
INTERVAL = 80.0


def undulate(num_vertices, share, periods, seed):
    """The modes in time.

    Parameters
    ----------
    num_vertices : int
    share : float
        See SHARES.
    periods : float
        Length, τ_2.
    seed : int
        Of everything.

    Returns
    -------
    dict
        "fit", u_lm of shape (num_frames, (lmax+1)²); "interval", ps between frames; "flips",
        accepted for each edge and τ_2; "temperature", K.
    """
    vesicle = vesicle_of(num_vertices, SOFTNESS, seed)
    setting = SETTINGS[SOFTNESS]
    scale = (1002 / num_vertices) ** 0.5
    time_step = setting.time_step * scale / 2
    context, mover = without_bath(
        vesicle,
        "Microcanonical" if share else "none",
        "velocity Verlet",
        time_step,
        seed,
        # The time step is half of that which the usual flips belong to.
        2 * setting.every,
        share * setting.attempts,
        # Critical damping: l = 2 comes to equilibrium soonest.
        2 * frequency_of(2, num_vertices),
        3,
    )
    stride = round(INTERVAL / scale / time_step)
    num_frames = round(periods * vesicle.tau_2 / (stride * time_step))
    modes = np.empty((num_frames, (max(L) + 1) ** 2), dtype=np.float32)
    kinetic = 0.0
    for frame in range(num_frames):
        context.getIntegrator().step(stride)
        state = context.getState(getPositions=True, getEnergy=True)
        positions = state.getPositions(asNumpy=True).value_in_unit(unit.nanometer)
        triangles = vesicle.placement.forces["bending"].getTrianglesInContext(context)
        modes[frame] = mode_amplitudes(positions, triangles, max(L))
        kinetic += state.getKineticEnergy().value_in_unit(unit.kilojoule_per_mole)
    rate = mover.getStatistics(context)["rate"] if mover else 0.0
    return {
        "fit": modes,
        "interval": stride * time_step,
        "flips": rate * vesicle.tau_2,
        "temperature": kinetic / num_frames / (1.5 * num_vertices * KBT) * 300.0,
    }


def main():
    report = Report("undulation_friction", __doc__)
    num_vertices, periods, seeds = (132, 4, 2) if report.quick else (492, 12, 4)
    rows = []
    for share in (0.0, 1.0) if report.quick else SHARES:
        points = [
            {"num_vertices": num_vertices, "share": share, "periods": periods, "seed": seed}
            for seed in range(1, 1 + seeds)
        ]
        runs = report.runs(undulate, points, VERSION)
        if runs:
            flips = float(np.mean([run["flips"] for run in runs]))
            rows.append((num_vertices, SOFTNESS, flips, *dampings(runs, num_vertices)))
    names = [f"γ_{l}/ω_{l} error ω/ω_{l} error" for l in L]
    report.table(f"N Ξ flips {' '.join(names)}".split(), rows)
    print("flips: for each edge and τ_2; ω_l: (A30)")


def dampings(runs, num_vertices):
    """γ_l and the frequency of the fit over ω_l, each with its error, one l after the other.

    Where a mode is overdamped the frequency is ω_l, with the error 0.
    """
    found = []
    for l in L:
        omega = frequency_of(l, num_vertices)
        lags = int(FIT_PERIODS * 2 * np.pi / omega / runs[0]["interval"]) + 1
        # Of all runs side by side, as they are equally long.
        modes = np.concatenate([modes_in(run, l) for run in runs], axis=1)
        if not runs[0]["flips"]:
            # What flips have left has a shape of its own, which neighbours that stay do not forget.
            modes -= modes.mean(axis=0)
        series = modes, runs[0]["interval"], lags
        try:
            fit = fit_damping(*series)
        except RuntimeError:  # overdamped: one rate alone can be told
            fit = fit_damping(*series, frequency=omega)
        numbers = (fit.friction, fit.friction_error, fit.frequency, fit.frequency_error)
        found += [float(number / omega) for number in numbers]
    return found


if __name__ == "__main__":
    main()

"""One run of a vesicle whose vertices flow along it, at rest or driven, for `viscosity.py`."""

import numpy as np
from fluid_run import in_bath, turn_onto, vesicle_of
from openmm import unit
from openmmhelfrich.analysis import autocorrelation
from rotations import Rotations, directions_of

LMAX = 5
DRIVEN = 2, 0
"""l and m of the rotation that a driven run drives."""

INTERVAL = 600.0  # ps, between frames
SHORTEST = 5000.0  # ps, longer than memories are however often bonds flip
UNDAMPED = 40000.0  # ps, as long as waves of shear last where bonds do not flip

# Frames whose modes are computed at once.
CHUNK = 500

# Count this up when the physics of a run changes, so that stored results are not used any more.
VERSION = 1


def rotate(
    num_vertices,
    softness,
    attempts,
    every,
    time_step,
    periods,
    seed,
    friction,
    acceleration=0.0,
    volume_modulus=0.04,
    settle_periods=5,
):
    """The rotations v_lm in time, under LangevinMiddle.

    Velocities are displacements from frame to frame over the time between: their correlations add
    up to those of the displacements over any longer time, and no vibration is sampled too seldom.
    They are those of an observer who turns with the whole, whose memory of shear would else be lost
    as it turns.

    A driven run adds the acceleration a Φ_20 to all vertices, which turns the two halves of the
    vesicle against each other, as a kick a Φ_20 Δt of the velocities at each frame.

    Parameters
    ----------
    num_vertices : int
    softness : float
        Ξ.
    attempts : float
        Flips that are tried for each edge every `every` steps; 0 for a mesh that keeps its
        neighbours.
    every : int
        Steps.
    time_step : float
        ps.
    periods, settle_periods : float
        Length of the run, and of the time before it that is thrown away, in τ_2.
    seed : int
        Of the mesh, velocities, noise and flips.
    friction : float
        γ, 1/ps.
    acceleration : float
        a, nm/ps².
    volume_modulus : float
        kV, kJ/mol/nm³. A sphere that is held at its volume has little area to spare, and its
        undulations disturb its rotations less.

    Returns
    -------
    dict
        "correlation", (1/(2l+1)) Σ_m ⟨v_lm(0) v_lm(t)⟩, shape (num_lags, LMAX+1), nm²/ps², to four
        times `window_of` the rate; "driven", mean of v_20, nm/ps; "interval", ps between frames;
        "rate", accepted flips for each edge and ps.
    """
    vesicle = vesicle_of(num_vertices, softness, seed, volume_modulus=volume_modulus)
    context, mover = in_bath(vesicle, friction, time_step, attempts, every, seed)
    integrator = context.getIntegrator()
    rotations = Rotations(LMAX)
    stride = round(INTERVAL / time_step)
    interval = stride * time_step

    def advance(last, turn):
        """The next frame about its centre, turned onto the last, and the turn from the lab."""
        if acceleration:
            state = context.getState(getVelocities=True)
            velocities = state.getVelocities(asNumpy=True)
            velocities = velocities.value_in_unit(unit.nanometer / unit.picosecond)
            field = rotations.field(directions_of(last), *DRIVEN) @ turn.T
            context.setVelocities(velocities + acceleration * interval * field)
        integrator.step(stride)
        state = context.getState(getPositions=True)
        positions = state.getPositions(asNumpy=True).value_in_unit(unit.nanometer)
        positions = positions - positions.mean(axis=0)
        turn = turn_onto(positions, last)
        return positions @ turn, turn

    last, turn = vesicle.mesh.vertices, np.eye(3)
    for _ in range(round(settle_periods * vesicle.tau_2 / interval)):
        last, turn = advance(last, turn)
    before = mover.getStatistics(context)["accepted"] if mover else 0
    num_frames = round(periods * vesicle.tau_2 / interval)
    modes = []
    for start in range(0, num_frames, CHUNK):
        frames = [last]
        for _ in range(min(CHUNK, num_frames - start)):
            last, turn = advance(last, turn)
            frames.append(last)
        frames = np.array(frames)
        modes.append(rotations((frames[1:] + frames[:-1]) / 2, np.diff(frames, axis=0) / interval))
    modes = np.concatenate(modes)
    accepted = mover.getStatistics(context)["accepted"] - before if mover else 0
    rate = accepted / (3 * num_vertices - 6) / (num_frames * interval)
    lags = min(num_frames, round(4 * window_of(rate) / interval) + 1)
    each = autocorrelation(modes, lags, normalise=False)
    of_l = [each[:, l**2 : (l + 1) ** 2].mean(axis=1) for l in range(LMAX + 1)]
    l, m = DRIVEN
    return {
        "correlation": np.stack(of_l, axis=1).astype(np.float32),
        "driven": float(modes[:, l**2 + l + m].mean()),
        "interval": interval,
        "rate": rate,
    }


def window_of(rate):
    """A time after which rotations have forgotten, ps, at a rate in accepted flips per edge and ps.

    That of one flip of each edge, some three times what shear takes to relax, or SHORTEST.
    """
    return max(1 / rate, SHORTEST) if rate else UNDAMPED

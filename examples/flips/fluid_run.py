"""One run of a fluctuating vesicle whose bonds flip, which the scripts of this folder share.

A run is a pure function of plain numbers, for `openmmhelfrich.sweep`, which keeps its result. So
the scripts share runs too.
"""

from itertools import pairwise

import numpy as np
import openmm
from openmm import unit
from openmmhelfrich import Mesh, MonteCarloBondFlip
from openmmhelfrich.analysis import mode_amplitudes
from openmmhelfrich.vesicle import KBT, Vesicle

TEMPERATURE = 300.0  # K
RADIUS = 1000.0  # nm
RIGIDITY = 20.0  # kBT
LMAX = 8

MAX_DEGREE = 10

# Degrees are counted from 0 to this; the bound on them is lower.
COUNTED = 16

# Count this up when the physics of a run changes, so that stored results are not used any more.
VERSION = 2


def vesicle_of(num_vertices, softness, seed, dihedrals=0.0, volume_modulus=0.0):
    """The paper's vesicle, Jülicher, on a random mesh.

    Parameters
    ----------
    num_vertices : int
    softness : float
        Ξ.
    seed : int
        Of the mesh.
    dihedrals : float
        K of a quartic potential of the dihedral angles, K (1 − cos φ)², kBT.
    volume_modulus : float
        kV, kJ/mol/nm³; 0 for no constraint.
    """
    return Vesicle(
        Mesh.random_sphere(num_vertices, RADIUS, seed),
        rigidity=RIGIDITY * KBT,
        volume_modulus=volume_modulus,
        softness=softness,
        dihedral_stiffness=dihedrals * KBT,
    )


def simulated(vesicle, integrator, mover=None):
    """A Context of a vesicle, and flips if there is a mover, on one thread of platform Helfrich."""
    system = vesicle.system()
    if mover is not None:
        system.addForce(mover)
    platform = openmm.Platform.getPlatformByName("Helfrich")
    context = openmm.Context(system, integrator, platform, {"Threads": "1"})
    context.setPositions(vesicle.mesh.vertices)
    return context


def in_bath(vesicle, friction, time_step, attempts, every, seed):
    """A Context of a vesicle under LangevinMiddle, and what flips its bonds.

    Parameters
    ----------
    vesicle : Vesicle
    friction : float
        γ, 1/ps.
    time_step : float
        ps.
    attempts : float
        Flips that are tried for each edge every `every` steps; 0 for a mesh that keeps its
        neighbours, and no mover.
    every : int
        Steps.
    seed : int
        Of velocities, noise and flips.

    Returns
    -------
    (openmm.Context, MonteCarloBondFlip or None)
    """
    integrator = openmm.LangevinMiddleIntegrator(TEMPERATURE, friction, time_step)
    integrator.setRandomNumberSeed(seed)
    mover = None
    if attempts:
        mover = MonteCarloBondFlip(vesicle.mesh, TEMPERATURE, every, attempts, maxDegree=MAX_DEGREE)
        mover.setRandomNumberSeed(seed)
    context = simulated(vesicle, integrator, mover)
    context.setVelocitiesToTemperature(TEMPERATURE, seed)
    return context, mover


def flow(
    num_vertices,
    softness,
    attempts,
    every,
    time_step,
    periods,
    seed,
    frames_per_period=10,
    settle_periods=3,
    friction=2.0,
    dihedrals=0.0,
    lmax=LMAX,
):
    """Equilibrium fluctuations under LangevinMiddle.

    Averages in equilibrium depend on neither friction, mass nor time step. So the friction is
    2 ω_2: l = 2, the slowest mode, is damped critically, and forgets soonest.

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
    frames_per_period : int
    friction : float
        γ / ω_2.
    dihedrals : float
        See `vesicle_of`.
    lmax : int
        Of the modes.

    Returns
    -------
    dict
        "modes", u_lm of shape (num_frames, (lmax+1)²); "bending", kJ/mol, "kinetic", K, and
        "degrees", counts of vertices of shape (num_frames, COUNTED + 1), of each frame; "cosine",
        the mean over vertices and frames of the cosine of the angle through which a vertex has
        moved after 0, 1, 2 … frames, with the rotation of the whole removed; "interval", ps between
        frames; "period", τ_2, ps; "rate", accepted flips for each edge and ps, and "acceptance".
    """
    vesicle = vesicle_of(num_vertices, softness, seed, dihedrals)
    friction *= 2 * np.pi / vesicle.tau_2
    context, mover = in_bath(vesicle, friction, time_step, attempts, every, seed)
    integrator = context.getIntegrator()
    integrator.step(round(settle_periods * vesicle.tau_2 / time_step))

    stride = max(1, round(vesicle.tau_2 / frames_per_period / time_step))
    num_frames = round(periods * frames_per_period)
    modes = np.empty((num_frames, (lmax + 1) ** 2), dtype=np.float32)
    bending, kinetic = np.empty((2, num_frames))
    degrees = np.empty((num_frames, COUNTED + 1), dtype=np.int32)
    directions = np.empty((num_frames, num_vertices, 3), dtype=np.float32)
    triangles = vesicle.mesh.triangles
    group = vesicle.placement.forces["bending"].getForceGroup()
    before = mover.getStatistics(context) if attempts else None
    for frame in range(num_frames):
        integrator.step(stride)
        state = context.getState(getPositions=True, getEnergy=True, groups={group})
        positions = state.getPositions(asNumpy=True).value_in_unit(unit.nanometer)
        if attempts:
            triangles = mover.getTrianglesInContext(context)
        modes[frame] = mode_amplitudes(positions, triangles, lmax)
        bending[frame] = state.getPotentialEnergy().value_in_unit(unit.kilojoule_per_mole)
        kinetic[frame] = state.getKineticEnergy().value_in_unit(unit.kilojoule_per_mole)
        degrees[frame] = np.bincount(
            np.bincount(triangles.ravel(), minlength=num_vertices), minlength=COUNTED + 1
        )
        directions[frame] = positions - positions.mean(axis=0)
    result = {
        "modes": modes,
        "bending": bending,
        "kinetic": kinetic / (1.5 * num_vertices * KBT) * TEMPERATURE,
        "degrees": degrees,
        "cosine": cosines(directions, num_frames // 2),
        "interval": stride * time_step,
        "period": vesicle.tau_2,
        "rate": 0.0,
        "acceptance": 0.0,
    }
    if attempts:
        after = mover.getStatistics(context)
        tried, accepted = (after[name] - before[name] for name in ("attempts", "accepted"))
        time = num_frames * stride * time_step
        result["rate"] = accepted / (3 * num_vertices - 6) / time
        result["acceptance"] = accepted / tried
    return result


def turn_onto(frame, last):
    """The rotation R, shape (3, 3), after which frame @ R fits another frame best (Kabsch)."""
    left, _, right = np.linalg.svd(frame.T @ last)
    left[:, 2] *= np.linalg.det(left @ right)
    return left @ right


def cosines(positions, num_lags):
    """⟨r̂(0) · r̂(t)⟩ over vertices and starts for t = 0, 1, … frames, rotation of the whole removed.

    From frame to frame the rotation that fits the vertices best is taken out (Kabsch), so that what
    is left is motion against the mean of all others.

    Parameters
    ----------
    positions : array_like
        Shape (num_frames, num_vertices, 3), about the centre.
    num_lags : int
        Number of lags after 0.

    Returns
    -------
    ndarray
        Shape (num_lags + 1,).
    """
    frames = np.array(positions, dtype=float)
    frames /= np.linalg.norm(frames, axis=2, keepdims=True)
    for last, frame in pairwise(frames):
        frame[:] = frame @ turn_onto(frame, last)
    # Sums over starts of products are what a Fourier transform with as many zeros behind gives.
    length = len(frames)
    spectrum = np.zeros(length + 1)
    for column in frames.reshape(length, -1).T:
        spectrum += np.abs(np.fft.rfft(column, 2 * length)) ** 2
    sums = np.fft.irfft(spectrum, 2 * length)[: num_lags + 1]
    return sums / (length - np.arange(num_lags + 1)) / frames.shape[1]

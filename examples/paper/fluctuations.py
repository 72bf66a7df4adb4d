"""Runs of fluctuating vesicles that the scripts for Figs. 6, 9 and 10 and SM 5, 7 and 9 share.

Farnudi, Ejtehadi and Everaers, Phys. Rev. E 108, 015301 (2023), doi:10.1103/PhysRevE.108.015301.
Each run is a pure function of plain numbers, for `openmmhelfrich.sweep`, which keeps its result. So
the scripts share runs too: what Fig. 6 has simulated, SM 5 and SM 7 find in the cache.
"""

import numpy as np
import openmm
from displacements import Displacements
from openmm import unit
from openmmhelfrich.analysis import mode_amplitudes, triangle_areas
from openmmhelfrich.forces import BendingForce
from openmmhelfrich.mesh import Mesh
from openmmhelfrich.vesicle import KBT, Vesicle

TEMPERATURE = 300.0  # K
SOFTNESS = (0.037, 0.15, 0.33, 0.59)

AREA_MODULUS = 1.3  # kJ/mol/nm²
RADIUS = 1000.0  # nm
RIGIDITY = 20.0  # kBT
MASS = 50.0  # amu, of a vertex

# Count this up when the physics of a run changes, so that stored results are not used any more.
VERSION = 2

# Time step over the bound 0.1 √Ξ τ_fastest of Fig. 5.
TIME_STEP = 0.75

# How often the time step of a run that breaks down is halved.
HALVINGS = 2

# Displacements within the surface are fitted with harmonics up to this l.
DISPLACEMENT_LMAX = 8

# Frames kept whole in the result of a run, for density modes and pictures.
SNAPSHOTS = 20


def parts_of(num_vertices):
    """Return n of the icosphere with N = 10 n² + 2 vertices."""
    parts = round(((num_vertices - 2) / 10) ** 0.5)
    if 10 * parts**2 + 2 != num_vertices:
        raise ValueError(f"{num_vertices} is not 10 n² + 2 for a whole n; try {10 * parts**2 + 2}")
    return parts


def vesicle_of(num_vertices, rigidity, radius, softness, scheme, mesh_seed=None):
    """The paper's vesicle without volume constraint (kV = 0), on an ordered or a random mesh.

    Parameters
    ----------
    num_vertices : int
        N, that of an ordered mesh 10 n² + 2.
    rigidity : float
        κ in units of kBT.
    radius : float
        r0, nm.
    softness : float
        Ξ.
    scheme : str
        Name of a constant of `BendingForce`.
    mesh_seed : int, optional
        Of the random mesh; default: the ordered one.
    """
    if mesh_seed is None:
        mesh = Mesh.icosphere(parts_of(num_vertices), radius)
    else:
        mesh = Mesh.random_sphere(num_vertices, radius, mesh_seed)
    return Vesicle(
        mesh,
        rigidity=rigidity * KBT,
        area_modulus=AREA_MODULUS,
        volume_modulus=0,
        softness=softness,
        scheme=getattr(BendingForce, scheme),
    )


def integrator_of(name, friction, time_step, seed):
    """One of OpenMM's integrators at 300 K: "verlet", "langevin" (LangevinMiddle) or "brownian"."""
    if name == "verlet":
        return openmm.VerletIntegrator(time_step)
    kinds = {
        "langevin": openmm.LangevinMiddleIntegrator,
        "brownian": openmm.BrownianIntegrator,
    }
    integrator = kinds[name](TEMPERATURE, friction, time_step)
    integrator.setRandomNumberSeed(seed)
    return integrator


def fluctuate(
    num_vertices,
    rigidity,
    radius,
    softness,
    scheme,
    lmax,
    periods,
    frames_per_period,
    settle_periods,
    seed,
    random=False,
):
    """Equilibrium fluctuations in one LangevinMiddle run.

    Averages in equilibrium depend on neither friction, mass nor time step. So the friction is
    ω_2, which makes l = 2, the slowest mode, forget soonest, and the time step TIME_STEP of the
    paper's bound 0.1 √Ξ τ_fastest, for κ < 20 kBT of the bound at 20 kBT.

    Parameters
    ----------
    num_vertices, rigidity, radius, softness, scheme
        See `vesicle_of`.
    lmax : int
        Largest l whose amplitudes are kept.
    periods, settle_periods : float
        Length of the run and of the time before it that is thrown away, in τ_2.
    frames_per_period : int
        Samples in a time of τ_2.
    seed : int
        Of velocities and noise, and of a random mesh.
    random : bool
        Whether the mesh is a random one instead of the ordered one.

    Returns
    -------
    dict
        "fit" and "vertices", amplitudes of shape (num_frames, (lmax+1)²) by either quadrature of
        `mode_amplitudes`; "compression" and "rotation", amplitudes of the displacements within the
        surface, see `Displacements`; "area", shape (num_frames,), in 4π r0²; "snapshots", shape
        (SNAPSHOTS, num_vertices, 3), nm; "temperature", K; "interval", ps between frames;
        "time_step", ps.
    """
    mesh_seed = seed if random else None
    vesicle = vesicle_of(num_vertices, rigidity, radius, softness, scheme, mesh_seed)
    # The bound is that of bending waves and grows as κ falls, but the repulsion of the heights does
    # not get any slower: of four runs at 10 kBT with 1.1 ps, one blew up.
    time_step = TIME_STEP * vesicle.max_time_step * min(1, rigidity / RIGIDITY) ** 0.5
    integrator = integrator_of("langevin", 2 * np.pi / vesicle.tau_2, time_step, seed)
    context = vesicle.simulation(integrator).context
    context.setVelocitiesToTemperature(TEMPERATURE, seed)
    integrator.step(round(settle_periods * vesicle.tau_2 / time_step))
    stride = max(1, round(vesicle.tau_2 / frames_per_period / time_step))
    num_frames = round(periods * frames_per_period)
    positions, temperature = frames_of(context, integrator, num_frames, stride)
    triangles = vesicle.mesh.triangles
    displacements = Displacements(vesicle.mesh.vertices, DISPLACEMENT_LMAX)
    positions = displacements.aligned(positions)
    compression, rotation = displacements(positions)
    kept = np.linspace(0, num_frames - 1, min(SNAPSHOTS, num_frames)).astype(int)
    return {
        "fit": mode_amplitudes(positions, triangles, lmax).astype(np.float32),
        "vertices": mode_amplitudes(positions, triangles, lmax, "vertices").astype(np.float32),
        "compression": compression.astype(np.float32),
        "rotation": rotation.astype(np.float32),
        "area": triangle_areas(positions, triangles).sum(axis=1) / (4 * np.pi * radius**2),
        "snapshots": positions[kept].astype(np.float32),
        "temperature": temperature,
        "interval": stride * time_step,
        "time_step": time_step,
    }


def relax(num_vertices, softness, integrator, friction, lmax, periods, interval, time_step, seed):
    """The modes of the paper's vesicle in time, under one of OpenMM's integrators.

    The vesicle is a random mesh with κ = 20 kBT, r0 = 1000 nm, the scheme of Jülicher and kV = 0.
    It comes to equilibrium under LangevinMiddle with γ = ω_2 for 3 τ_2; then the integrator takes
    over.

    A vesicle turns: with the angular momentum of 300 K by some half a radian in 3 τ_2, which mixes
    the modes of one l and looks like damping. So modes are those in the frame of the body, in which
    the vertices do not turn.

    Parameters
    ----------
    num_vertices : int
        N.
    softness : float
        Ξ.
    integrator : str
        "verlet", "langevin" or "brownian".
    friction : float
        γ, 1/ps; of no effect with Verlet.
    lmax : int
        Largest l whose amplitudes are kept.
    periods : float
        Length in τ_2.
    interval : float
        Between frames, ps.
    time_step : float
        ps; a run that breaks down is made again with half of it, up to HALVINGS times.
    seed : int
        Of the mesh, of velocities and noise.

    Returns
    -------
    dict
        "fit", amplitudes of shape (num_frames, (lmax+1)²), and "space", those of the paper's sum
        over vertices in the frame of the laboratory; "interval", ps between frames; "time_step",
        the one with which it lasted, ps; "temperature", K, which means nothing without inertia.
    """
    vesicle = vesicle_of(num_vertices, RIGIDITY, RADIUS, softness, "Julicher", mesh_seed=seed)
    for halvings in range(HALVINGS + 1):
        step = time_step / 2**halvings
        stride = max(1, round(interval / step))
        num_frames = round(periods * vesicle.tau_2 / (stride * step))
        last = integrator_of(integrator, friction, step, seed + 1000)
        try:
            positions, temperature = follow(vesicle, last, num_frames, stride, seed, 2**halvings)
            break
        except openmm.OpenMMException:
            # One run in many meets a triangle that a long step throws about.
            if halvings == HALVINGS:
                raise
    triangles = vesicle.mesh.triangles
    aligned = Displacements(vesicle.mesh.vertices, 1).aligned(positions)
    return {
        # The mean of the vertices is centre enough for motion, and takes a quarter of the time.
        "fit": mode_amplitudes(aligned, triangles, lmax, centre="mass").astype(np.float32),
        "space": mode_amplitudes(positions, triangles, lmax, "vertices").astype(np.float32),
        "interval": stride * step,
        "time_step": step,
        "temperature": temperature,
    }


def follow(vesicle, integrator, num_frames, stride, seed, shorter=1):
    """Frames of an integrator from equilibrium, to which LangevinMiddle brings it in 3 τ_2.

    Parameters
    ----------
    vesicle : Vesicle
    integrator : openmm.Integrator
    num_frames, stride : int
        See `frames_of`.
    seed : int
        Of velocities and noise of the time before.
    shorter : int
        By which its usual time step is divided.

    Returns
    -------
    tuple
        That of `frames_of`.
    """
    step = TIME_STEP * vesicle.max_time_step / shorter
    settling = integrator_of("langevin", 2 * np.pi / vesicle.tau_2, step, seed)
    simulation = vesicle.simulation(settling)
    simulation.context.setVelocitiesToTemperature(TEMPERATURE, seed)
    settling.step(round(3 * vesicle.tau_2 / step))
    state = simulation.context.getState(getPositions=True, getVelocities=True)
    context = vesicle.simulation(integrator).context
    context.setPositions(state.getPositions())
    context.setVelocities(state.getVelocities())
    return frames_of(context, integrator, num_frames, stride)


def frames_of(context, integrator, num_frames, stride):
    """Positions every `stride` steps, shape (num_frames, N, 3), nm, and the mean temperature, K."""
    num_vertices = context.getSystem().getNumParticles()
    positions = np.empty((num_frames, num_vertices, 3), dtype=np.float32)
    kinetic = 0.0
    for frame in range(num_frames):
        integrator.step(stride)
        state = context.getState(getPositions=True, getEnergy=True)
        positions[frame] = state.getPositions(asNumpy=True).value_in_unit(unit.nanometer)
        kinetic += state.getKineticEnergy().value_in_unit(unit.kilojoule_per_mole)
    per_kelvin = 1.5 * num_vertices * KBT / TEMPERATURE
    return positions, kinetic / num_frames / per_kelvin


def heights_virial(vesicle, positions):
    """−Σ h ∂U_h/∂h over all heights of one frame, kJ/mol.

    U = ε (x − ½)² with x = (d/h)⁴ > ½ gives −h ∂U/∂h = 8 ε (x − ½) x.
    """
    a, b, c = (positions[vesicle.mesh.triangles[:, corner]].astype(float) for corner in range(3))
    twice_area = np.linalg.norm(np.cross(b - a, c - a), axis=1)
    sides = np.linalg.norm([b - a, c - b, a - c], axis=2)
    x = (vesicle.min_height * sides / twice_area) ** 4
    return float(np.sum(8 * vesicle.epsilon * np.maximum(x - 0.5, 0) * x))

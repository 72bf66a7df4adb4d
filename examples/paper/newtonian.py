"""Newtonian runs of vesicles until they fail, for Fig. 5.

Farnudi, Ejtehadi and Everaers, Phys. Rev. E 108, 015301 (2023), doi:10.1103/PhysRevE.108.015301.
"""

import numpy as np

RADIUS = 1000.0  # nm

# The paper's two criteria: a run has failed when its energy, potential and kinetic, has risen by
# this share of that at the start, or its kinetic energy by this one.
ENERGY_RISE, KINETIC_RISE = 0.5, 1.0


def vesicle_of(mesh, num_vertices, softness, scheme, seed):
    """The paper's vesicle on an "ordered" or a "random" mesh; N = 10 n² + 2 for an ordered one."""
    import openmmhelfrich as helfrich

    if mesh == "ordered":
        surface = helfrich.Mesh.icosphere(round(((num_vertices - 2) / 10) ** 0.5), RADIUS)
    else:
        surface = helfrich.Mesh.random_sphere(num_vertices, RADIUS, seed)
    scheme = getattr(helfrich.BendingForce, scheme)
    return helfrich.Vesicle(surface, softness=softness, scheme=scheme)


def failing_run(mesh, scheme, softness, fraction, num_vertices, duration, looks, seed):
    """A Verlet run from velocities of 300 K until it fails by both criteria, or breaks.

    Parameters
    ----------
    mesh : str
        "ordered" or "random".
    scheme : str
        Name of a constant of `BendingForce`.
    softness : float
        Ξ.
    fraction : float
        Time step in units of √Ξ τ, τ the period of the fastest mode.
    num_vertices : int
        N.
    duration : float
        When a run that lives is ended, τ_2.
    looks : int
        Looks at the energies in a time of √Ξ τ; at most one a step.
    seed : int
        Of the mesh and the velocities.

    Returns
    -------
    dict
        "energy" and "kinetic", the times at which either criterion was met, τ_2, or None; "broken",
        why the run could not go on, or "" — at a break both are met; "lived", the time that was
        simulated, τ_2; "drift", the relative change of the energy at the last look; "time_step" and
        "unit" (√Ξ τ), ps.
    """
    import openmm

    vesicle = vesicle_of(mesh, num_vertices, softness, scheme, seed)
    unit_of_time = np.sqrt(softness) * vesicle.tau_fastest
    time_step = fraction * unit_of_time
    simulation = vesicle.simulation(openmm.VerletIntegrator(time_step))
    simulation.context.setVelocitiesToTemperature(300, seed)
    steps = max(1, round(duration * vesicle.tau_2 / time_step))
    stride = max(1, round(unit_of_time / looks / time_step))
    met, broken, lived, drift = _until_failed(simulation, steps, stride)
    time_step, unit_of_time = float(time_step), float(unit_of_time)
    scale = time_step / vesicle.tau_2
    return {
        "energy": None if met[0] is None else met[0] * scale,
        "kinetic": None if met[1] is None else met[1] * scale,
        "broken": broken,
        "lived": lived * scale,
        "drift": float(drift),
        "time_step": time_step,
        "unit": unit_of_time,
    }


def _until_failed(simulation, steps, stride):
    """The steps at which the two criteria were met, why it broke, its steps, and its drift."""
    import openmm

    context = simulation.context
    first, kinetic = _energies(context)
    bounds = (first + ENERGY_RISE * abs(first), (1 + KINETIC_RISE) * kinetic)
    met, done, drift = [None, None], 0, 0.0
    while done < steps and None in met:
        count = min(stride, steps - done)
        before = simulation.currentStep
        try:
            simulation.step(count)
            energies = _energies(context)
        except (openmm.OpenMMException, ValueError) as error:
            broken = str(error) or type(error).__name__
            done += simulation.currentStep - before
            return [done if each is None else each for each in met], broken, done, drift
        done += count
        if not np.isfinite(energies).all():
            broken = "an energy is not finite"
            return [done if each is None else each for each in met], broken, done, drift
        drift = energies[0] / first - 1
        for place, (energy, bound) in enumerate(zip(energies, bounds, strict=True)):
            if met[place] is None and energy > bound:
                met[place] = done
    return met, "", done, drift


def _energies(context):
    """The energy, potential and kinetic, and the kinetic energy alone, kJ/mol."""
    from openmm import unit

    state = context.getState(energy=True)
    kinetic = state.getKineticEnergy().value_in_unit(unit.kilojoule_per_mole)
    return kinetic + state.getPotentialEnergy().value_in_unit(unit.kilojoule_per_mole), kinetic

"""``openmm-helfrich info``: what a configuration file would simulate, without doing it.

Without a file it describes the machine.
"""

from __future__ import annotations

import time
from pathlib import Path

import click

from ..errors import MeshError
from .options import platform_option, reader_options, tidy_errors

__all__ = ["info"]

# How long to measure the time per step, s.
_MEASURE_SECONDS = 1.5


@click.command()
@click.argument("config", required=False, type=click.Path(path_type=Path, dir_okay=False))
@platform_option
@click.option("--measure/--no-measure", default=True, help="Measure the time per step.")
@reader_options
def info(config, platform, measure, vcm_compatible, ignore_unknown):
    """Say what CONFIG, of VCM or in TOML, would simulate, or describe this machine.

    Meshes, potentials with their start energies, time scales, the time step beside what is
    stable, the platform with the reason for it, and the time that the run would take. Without
    CONFIG: OpenMM's platforms and which would be used, the GPUs with what they can do, and which of
    processor and GPU computes a membrane, with the timings that decide it.
    """
    if config is None:
        from .machine import machine

        for line in machine():
            click.echo(line)
        return
    with tidy_errors():
        from ..config import read_any

        cfg = read_any(config, vcm_compatible, ignore_unknown=ignore_unknown)
        for line in _general(cfg):
            click.echo(line)
        for membrane in cfg.membranes:
            click.echo()
            for line in _membrane(cfg, membrane):
                click.echo(line)
        click.echo()
        for line in _energies(cfg):
            click.echo(line)
        name, reason = _platform(cfg, platform)
        click.echo(f"\nPlatform: {name}, for {reason}")
        for line in _evaluators(cfg, name):
            click.echo(line)
        if measure:
            click.echo(_duration(cfg, name))


def _general(cfg) -> list[str]:
    general = cfg.general
    lines = [
        f"{cfg.name}: {len(cfg.membranes)} membrane(s), {cfg.num_particles} vertices",
        f"  {general['Integrator']}, {cfg.num_steps} steps of {cfg.step_size:g} ps: "
        f"{general['SimulationTimeInPs']:g} ps at {cfg.temperature:g} K",
    ]
    if general["Integrator"] != "Verlet":
        lines.append(f"  friction {general['FrictionIninvertPs']:g} /ps")
    return lines


def _membrane(cfg, membrane) -> list[str]:
    """The mesh of one membrane, and what its time scales are."""
    from ..vcm.springs import sticky_pairs

    mesh = membrane.mesh
    lines = [
        f"Membrane {membrane.label}: {mesh.num_vertices} vertices, {mesh.num_triangles} triangles",
        f"  area {mesh.area:.8g} nm²" + _enclosed(mesh),
    ]
    if membrane.num_reversed:
        lines.append(
            f"  orientation mended: {membrane.num_reversed} triangles of the file faced the other "
            "way"
        )
    else:
        lines.append("  orientation as in the file")
    if membrane.settings["Sticky"]:
        lines.append(f"  sticky: {len(sticky_pairs(cfg, membrane))} bonds to other membranes")
    return lines + _time_scales(cfg, membrane)


def _enclosed(mesh) -> str:
    """What a mesh encloses, or why it does not."""
    if not mesh.is_closed:
        return f", {len(mesh.border_loops)} border(s)"
    try:
        volume = mesh.volume
    except MeshError:
        return ", spans the periodic box"
    return f", volume {volume:.8g} nm³, reduced volume {mesh.reduced_volume:.4f}"


def _time_scales(cfg, membrane) -> list[str]:
    """Softness, τ_h, τ_2 and the largest stable time step, for what the membrane has.

    The bound is 0.1 √Ξ τ of the fastest mode, Phys. Rev. E 108, 015301 (2023), equations 40 to 43
    and figure 5: a rule of thumb for the paper's moduli.
    """
    vesicle, heights, bends = _as_vesicle(cfg, membrane)
    lines = []
    if heights:
        lines.append(
            f"  softness Ξ = {vesicle.softness:.4g} (d = {vesicle.min_height:.4g} nm), "
            f"triangle heights relax in τ_h = {vesicle.tau_heights:.4g} ps"
        )
    if not bends:
        return lines
    lines.append(
        f"  slowest mode τ_2 = {vesicle.tau_2:.5g} ps, fastest {vesicle.tau_fastest:.4g} ps"
    )
    if heights:
        bound = vesicle.max_time_step
        verdict = "within" if cfg.step_size <= bound else "ABOVE"
        lines.append(
            f"  time step {cfg.step_size:g} ps is {verdict} the bound 0.1 √Ξ τ = {bound:.3g} ps "
            f"(√Ξ τ = {10 * bound:.3g} ps)"
        )
    return lines


def _as_vesicle(cfg, membrane):
    """A `Vesicle` for the time scales, whether heights repel, and whether the membrane bends."""
    from ..config import VesicleMembrane
    from ..vcm.membrane_forces import min_height
    from ..vesicle import Vesicle

    if isinstance(membrane, VesicleMembrane):
        vesicle = membrane.vesicle
        return vesicle, vesicle.min_height > 0 and vesicle.epsilon > 0, vesicle.rigidity > 0
    settings = membrane.settings
    least, rigidity = min_height(cfg, membrane), settings["MeanCurvatureCoeff"]
    epsilon = cfg.general["EpsilonH"] * cfg.kT
    vesicle = Vesicle(
        membrane.mesh,
        rigidity=rigidity,
        softness=membrane.mesh.softness(least),
        epsilon=epsilon,
        mass=settings["NodeMass"],
    )
    bends = settings["MeanCurvatureModel"] is not None and rigidity != 0
    return vesicle, least > 0 and epsilon > 0, bends


def _energies(cfg) -> list[str]:
    """The energy of each term at the start positions, in double precision."""
    import openmm

    from ..platforms import membranes_of

    system = cfg.system()
    for force in membranes_of(system):
        force.setBackend("cpu")
    context = openmm.Context(
        system,
        openmm.VerletIntegrator(0.001),
        openmm.Platform.getPlatformByName("Reference"),
    )
    context.setPositions(cfg.positions)
    terms = cfg.energies(context)
    if not terms:
        return ["No potentials."]
    width = max(map(len, terms))
    rows = [f"  {name:<{width}s} {energy:18.6f}" for name, energy in terms.items()]
    return ["Energies at the start, kJ/mol:", *rows]


def _platform(cfg, asked: str | None) -> tuple[str, str]:
    """What a run would be on, and why."""
    from ..platforms import choose

    if asked:
        return asked, "--platform names it"
    if cfg.platform:
        return cfg.platform, "the file names it"
    try:
        return choose(cfg.system(), cfg.integrator())
    except ValueError as reason:
        raise click.ClickException(str(reason)) from None


def _evaluators(cfg, platform: str) -> list[str]:
    """What would compute which forces of membranes."""
    from ..platforms import evaluators
    from .machine import WORDS

    found = evaluators(cfg.system(), platform)
    lines = []
    for (who, reason), forces in found.items():
        what = "Membranes" if len(found) == 1 else ", ".join(dict.fromkeys(forces))
        lines.append(f"{what}: computed by {WORDS[who]}, for {reason}")
    return lines


def _duration(cfg, platform: str) -> str:
    """How long the run would take, from a few of its steps."""
    import openmm

    try:
        simulation = cfg.unprepared_simulation(platform)
        cfg.prepare(simulation.context)
        # The first step compiles kernels on a GPU.
        simulation.integrator.step(2)
        steps, elapsed = 0, 0.0
        start = time.perf_counter()
        while elapsed < _MEASURE_SECONDS:
            chunk = max(1, min(steps, 1000))
            simulation.integrator.step(chunk)
            # Without a look at the state, a GPU may still be at work.
            simulation.context.getState(getEnergy=True)
            steps += chunk
            elapsed = time.perf_counter() - start
    except openmm.OpenMMException as reason:
        raise click.ClickException(f"cannot measure the time per step: {reason}") from None
    total = elapsed / steps * cfg.num_steps
    return (
        f"Expected run time: {_clock(total)} on {platform} "
        f"({elapsed / steps * 1e3:.3g} ms a step, without outputs)"
    )


def _clock(seconds: float) -> str:
    if seconds < 90:
        return f"{seconds:.1f} s"
    if seconds < 5400:
        return f"{seconds / 60:.1f} min"
    return f"{seconds / 3600:.1f} h"

"""``openmm-helfrich info``: what a configuration file would simulate, without doing it.

Without a file it describes the machine.
"""

from __future__ import annotations

import contextlib
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import click

from ..errors import MeshError
from .options import json_option, platform_option, print_json, reader_options, tidy_errors

__all__ = ["info"]

# How long to measure the time per step, s.
_MEASURE_SECONDS = 1.5


@click.command()
@click.argument("config", required=False, type=click.Path(path_type=Path, dir_okay=False))
@platform_option
@click.option("--measure/--no-measure", default=True, help="Measure the time per step.")
@reader_options
@json_option
def info(config, platform, measure, vcm_compatible, ignore_unknown, as_json):
    """Say what CONFIG, of VCM or in TOML, would simulate, or describe this machine.

    Meshes, potentials with their start energies, time scales, the time step beside what is
    stable, the platform with the reason for it, and the time that the run would take. Without
    CONFIG: OpenMM's platforms and which would be used, the GPUs with what they can do, and which of
    processor and GPU computes a membrane, with the timings that decide it.
    """
    if config is None:
        from .machine import lines_of, machine

        found = machine()
        if as_json:
            print_json(found)
        else:
            for line in lines_of(found):
                click.echo(line)
        return
    found = {}
    with tidy_errors():
        for name, values, lines in _parts(
            config, platform, measure, vcm_compatible, ignore_unknown
        ):
            found[name] = values
            # The text comes as it is found.
            for line in () if as_json else lines:
                click.echo(line)
    if as_json:
        print_json(found)


def _parts(config, platform, measure, vcm_compatible, ignore_unknown):
    """What is found, one part after the other: its name in JSON, the values, and as text."""
    from ..config import read_any

    cfg = read_any(config, vcm_compatible, ignore_unknown=ignore_unknown)
    general = _general(cfg)
    yield "simulation", general, _general_lines(general)
    membranes = [_membrane(cfg, membrane) for membrane in cfg.membranes]
    yield "membranes", membranes, _membrane_lines(general, membranes)
    energies = _energies(cfg)
    yield "energies_kJ_per_mol", energies, _energy_lines(energies)
    name, reason = _platform(cfg, platform)
    yield (
        "platform",
        {"name": name, "reason": reason},
        [f"\nPlatform: {name}, for {reason}"],
    )
    computed = _evaluators(cfg, name)
    yield "computed_by", computed, _evaluator_lines(computed)
    duration, lines = None, []
    if measure:
        duration, lines = _duration(cfg, name)
    yield "duration", duration, lines


def _general(cfg) -> dict[str, Any]:
    general = cfg.general
    is_damped = general["Integrator"] != "Verlet"
    return {
        "name": cfg.name,
        "num_particles": cfg.num_particles,
        "integrator": general["Integrator"],
        "num_steps": cfg.num_steps,
        "time_step_ps": cfg.step_size,
        "time_ps": general["SimulationTimeInPs"],
        "temperature_K": cfg.temperature,
        "friction_per_ps": general["FrictionIninvertPs"] if is_damped else None,
        "num_membranes": len(cfg.membranes),
    }


def _general_lines(found: dict[str, Any]) -> list[str]:
    lines = [
        f"{found['name']}: {found['num_membranes']} membrane(s), {found['num_particles']} vertices",
        f"  {found['integrator']}, {found['num_steps']} steps of {found['time_step_ps']:g} ps: "
        f"{found['time_ps']:g} ps at {found['temperature_K']:g} K",
    ]
    if found["friction_per_ps"] is not None:
        lines.append(f"  friction {found['friction_per_ps']:g} /ps")
    return lines


def _membrane(cfg, membrane) -> dict[str, Any]:
    """The mesh of one membrane, and what its time scales are."""
    from ..vcm.springs import sticky_pairs

    mesh = membrane.mesh
    is_sticky = membrane.settings["Sticky"]
    return {
        "label": membrane.label,
        "num_vertices": mesh.num_vertices,
        "num_triangles": mesh.num_triangles,
        "num_borders": 0 if mesh.is_closed else len(mesh.border_loops),
        "area_nm2": mesh.area,
        **_enclosed(mesh),
        "num_reversed": membrane.num_reversed,
        "num_sticky_bonds": len(sticky_pairs(cfg, membrane)) if is_sticky else None,
        **_time_scales(cfg, membrane),
    }


def _enclosed(mesh) -> dict[str, Any]:
    """What a mesh encloses; None if it has borders or spans the box."""
    volume = reduced = None
    if mesh.is_closed:
        with contextlib.suppress(MeshError):
            volume = mesh.volume
            reduced = mesh.reduced_volume
    return {"volume_nm3": volume, "reduced_volume": reduced}


def _time_scales(cfg, membrane) -> dict[str, Any]:
    """Softness, τ_h, τ_2 and the largest stable time step, None for what the membrane has not.

    The bound is 0.1 √Ξ τ of the fastest mode, Phys. Rev. E 108, 015301 (2023), equations 40 to 43
    and figure 5: a rule of thumb for the paper's moduli.
    """
    vesicle, heights, bends = _as_vesicle(cfg, membrane)
    return {
        "softness": vesicle.softness if heights else None,
        "min_height_nm": vesicle.min_height if heights else None,
        "tau_heights_ps": vesicle.tau_heights if heights else None,
        "tau_2_ps": vesicle.tau_2 if bends else None,
        "tau_fastest_ps": vesicle.tau_fastest if bends else None,
        "max_time_step_ps": vesicle.max_time_step if heights and bends else None,
    }


def _membrane_lines(general: dict[str, Any], membranes: list[dict[str, Any]]) -> Iterator[str]:
    for found in membranes:
        yield ""
        yield (
            f"Membrane {found['label']}: {found['num_vertices']} vertices, "
            f"{found['num_triangles']} triangles"
        )
        yield f"  area {found['area_nm2']:.8g} nm²" + _enclosed_words(found)
        if found["num_reversed"]:
            yield (
                f"  orientation mended: {found['num_reversed']} triangles of the file faced the "
                "other way"
            )
        else:
            yield "  orientation as in the file"
        if found["num_sticky_bonds"] is not None:
            yield f"  sticky: {found['num_sticky_bonds']} bonds to other membranes"
        yield from _time_scale_lines(general["time_step_ps"], found)


def _enclosed_words(found: dict[str, Any]) -> str:
    if found["num_borders"]:
        return f", {found['num_borders']} border(s)"
    if found["volume_nm3"] is None:
        return ", spans the periodic box"
    return f", volume {found['volume_nm3']:.8g} nm³, reduced volume {found['reduced_volume']:.4f}"


def _time_scale_lines(time_step: float, found: dict[str, Any]) -> Iterator[str]:
    if found["softness"] is not None:
        yield (
            f"  softness Ξ = {found['softness']:.4g} (d = {found['min_height_nm']:.4g} nm), "
            f"triangle heights relax in τ_h = {found['tau_heights_ps']:.4g} ps"
        )
    if found["tau_2_ps"] is not None:
        yield (
            f"  slowest mode τ_2 = {found['tau_2_ps']:.5g} ps, "
            f"fastest {found['tau_fastest_ps']:.4g} ps"
        )
    bound = found["max_time_step_ps"]
    if bound is not None:
        verdict = "within" if time_step <= bound else "ABOVE"
        yield (
            f"  time step {time_step:g} ps is {verdict} the bound 0.1 √Ξ τ = {bound:.3g} ps "
            f"(√Ξ τ = {10 * bound:.3g} ps)"
        )


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


def _energies(cfg) -> dict[str, float]:
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
    return cfg.energies(context)


def _energy_lines(terms: dict[str, float]) -> list[str]:
    if not terms:
        return ["", "No potentials."]
    width = max(map(len, terms))
    rows = [f"  {name:<{width}s} {energy:18.6f}" for name, energy in terms.items()]
    return ["", "Energies at the start, kJ/mol:", *rows]


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


def _evaluators(cfg, platform: str) -> list[dict[str, Any]]:
    """What would compute which forces of membranes."""
    from ..platforms import evaluators

    return [
        {"by": who, "reason": reason, "forces": list(dict.fromkeys(forces))}
        for (who, reason), forces in evaluators(cfg.system(), platform).items()
    ]


def _evaluator_lines(found: list[dict[str, Any]]) -> Iterator[str]:
    from .machine import WORDS

    for one in found:
        what = "Membranes" if len(found) == 1 else ", ".join(one["forces"])
        yield f"{what}: computed by {WORDS[one['by']]}, for {one['reason']}"


def _duration(cfg, platform: str) -> tuple[dict[str, Any] | None, list[str]]:
    """How long the run would take, from a few of its steps, and as text; None if they fail."""
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
        click.echo(f"Warning: the first steps fail: {reason}", err=True)
        return None, [f"Expected run time: none, for the first steps fail on {platform}"]
    a_step = elapsed / steps
    found = {"seconds_per_step": a_step, "seconds": a_step * cfg.num_steps}
    line = (
        f"Expected run time: {_clock(found['seconds'])} on {platform} "
        f"({a_step * 1e3:.3g} ms a step, without outputs)"
    )
    return found, [line]


def _clock(seconds: float) -> str:
    if seconds < 90:
        return f"{seconds:.1f} s"
    if seconds < 5400:
        return f"{seconds / 60:.1f} min"
    return f"{seconds / 3600:.1f} h"

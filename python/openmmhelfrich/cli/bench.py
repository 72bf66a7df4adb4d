"""``openmm-helfrich bench``: how fast this machine makes steps."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

import click

from .. import logs
from .options import json_option, print_json

__all__ = ["bench"]

# 10 n² + 2 vertices: N = 252, 1002, 4002, 16 002.
_SIZES = (252, 1002, 4002, 16_002)
# The integrators of `_benchmark`, which need not be imported to print the help.
_INTEGRATORS = ("Verlet", "LangevinMiddle", "Brownian")


def _check_size(context: click.Context, parameter: click.Parameter, sizes):
    for size in sizes:
        if not size >= 12 or 10 * math.isqrt(max(size - 2, 0) // 10) ** 2 + 2 != size:
            near = max(1, round(math.sqrt(max(size - 2, 0) / 10)))
            raise click.BadParameter(
                f"no icosphere has {size} vertices; 10 n² + 2 is possible, such as "
                f"{10 * near * near + 2}"
            )
    return sizes


@click.command()
@click.option(
    "--platform",
    "platforms",
    multiple=True,
    metavar="NAME",
    help="Only this of OpenMM's platforms; may be repeated. Default: all that are installed.",
)
@click.option(
    "--integrator",
    type=click.Choice(_INTEGRATORS),
    default="LangevinMiddle",
    show_default=True,
)
@click.option(
    "--size",
    "sizes",
    type=int,
    multiple=True,
    default=_SIZES,
    show_default=True,
    callback=_check_size,
    help="Vertices, 10 n² + 2; may be repeated.",
)
@click.option(
    "--seconds",
    type=click.FloatRange(min=0, min_open=True),
    default=0.2,
    show_default=True,
    help="Length of one run.",
)
@click.option("--repeats", type=click.IntRange(min=1), default=5, show_default=True)
@json_option
def bench(platforms, integrator, sizes, seconds, repeats, as_json):
    """Measure steps per second of the paper's vesicle on this machine.

    Every platform is raced against its own empty step, that of particles without forces, which is
    what OpenMM takes for itself. The fastest of several runs counts. Takes some ten seconds for
    each platform.
    """
    from .. import _benchmark

    targets, failed = _benchmark.targets(_known(platforms))
    found = _head(integrator, seconds, repeats)
    if not as_json:
        for line in _head_lines(found):
            click.echo(line)
    for name, reason in failed.items():
        logs.logger("bench").warning("platform %s does not start: %s", name, reason)
    if not targets:
        raise click.ClickException("no platform to measure")
    width = max(len(target.label) for target in targets)
    if not as_json:
        click.echo(f"\n{'N':>7s}  {'platform':<{width}s} {'steps/s':>10s} {'µs/step':>10s} "
                   f"{'empty, µs':>10s} {'ratio':>6s}")  # fmt: skip
    rows = []
    for size in sizes:
        for row in _rows(targets, size, integrator, seconds, repeats):
            rows.append(row)
            if not as_json:
                click.echo(f"{size:>7d}  {row['platform']:<{width}s} "
                           f"{row['steps_per_s']:>10.0f} {row['step_us']:>10.1f} "
                           f"{row['empty_step_us']:>10.1f} {row['ratio']:>6.2f}")  # fmt: skip
    if as_json:
        print_json({**found, "failed": failed, "rows": rows})


def _rows(
    targets, size: int, integrator: str, seconds: float, repeats: int
) -> Iterator[dict[str, Any]]:
    """What a step of a vesicle takes on each of the platforms."""
    import openmm

    from .. import _benchmark
    from ..vesicle import Vesicle

    vesicle = Vesicle(_benchmark.sphere(math.isqrt((size - 2) // 10)))
    systems = {"ours": vesicle.system(), "empty": _benchmark.empty_system(vesicle)}
    steppers = {}
    for target in targets:
        for kind, system in systems.items():
            try:
                context = _benchmark.start(system, vesicle, integrator, target)
                context.getIntegrator().step(1)
            except openmm.OpenMMException as reason:
                raise click.ClickException(
                    f"{target.label}, N = {size}: {reason}; leave the platform out with --platform"
                ) from None
            steppers[kind, target.label] = _benchmark.Steps(context)
    cost = _benchmark.fastest(steppers, repeats, seconds)
    for (kind, label), stepper in steppers.items():
        try:
            stepper.check()
        except FloatingPointError as reason:
            raise click.ClickException(f"{label}, {kind}, N = {size}: {reason}") from None
    for target in targets:
        ours, empty = cost["ours", target.label], cost["empty", target.label]
        yield {
            "num_vertices": size,
            "platform": target.label,
            "steps_per_s": 1e6 / ours,
            "step_us": ours,
            "empty_step_us": empty,
            "ratio": ours / empty,
        }


def _known(platforms) -> list[str] | None:
    """The platforms asked for, as OpenMM calls them; None for all."""
    from ..platforms import find

    if not platforms:
        return None
    try:
        return list(dict.fromkeys(map(find, platforms)))
    except ValueError as reason:
        raise click.BadParameter(str(reason), param_hint="--platform") from None


def _head(integrator: str, seconds: float, repeats: int) -> dict[str, Any]:
    from .. import _benchmark

    return {
        "machine": _benchmark.machine(),
        "versions": _benchmark.versions(),
        "integrator": integrator,
        "time_step_ps": _benchmark.TIME_STEP,
        "repeats": repeats,
        "run_s": seconds,
    }


def _head_lines(found: dict[str, Any]) -> list[str]:
    return [
        ", ".join(f"{name}: {value}" for name, value in found["machine"].items()),
        ", ".join(f"{name} {value}" for name, value in found["versions"].items()),
        f"{found['integrator']}, {found['time_step_ps']:g} ps, bending + area + volume + heights, "
        f"best of {found['repeats']} runs of {found['run_s']:g} s",
    ]

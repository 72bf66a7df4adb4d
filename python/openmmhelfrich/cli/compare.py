"""``openmm-helfrich compare``: the same configuration with Custom forces and with ours."""

from __future__ import annotations

import click

from .options import check_platform, config_argument, reader_options, tidy_errors

__all__ = ["compare"]


@click.command()
@config_argument
@click.option(
    "--style",
    type=click.Choice(["sums", "pairs"]),
    default="sums",
    show_default=True,
    help="How the Custom forces write global area and volume: as sums over triangles, O(N), or "
    "over all pairs of triangles, O(N²), as VCM does.",
)
@click.option(
    "--platform",
    metavar="NAME",
    callback=check_platform,
    help="OpenMM platform of both. Default: Helfrich, the fastest one in double precision. Those "
    "of single and mixed precision need a larger tolerance.",
)
@click.option(
    "--seconds",
    type=click.FloatRange(min=0),
    default=2.0,
    show_default=True,
    help="How long to measure the steps of each; 0 to compare only.",
)
@click.option(
    "--tolerance",
    type=click.FloatRange(min=0),
    default=1e-9,
    show_default=True,
    help="Largest relative difference of a term's energy or forces.",
)
@click.option(
    "--strain",
    type=click.FloatRange(0, 0.3),
    default=0.02,
    show_default=True,
    help="Dilation, and random displacement in edge lengths, of the membranes that are compared.",
)
@reader_options
def compare(config, style, platform, seconds, tolerance, strain, vcm_compatible, ignore_unknown):
    """Compare the VCM configuration file CONFIG with Custom forces built from strings.

    Prints each potential's energy in both, the relative differences of energies and forces, and
    the time per step. Exits with status 1 if a difference is above the tolerance.
    """
    with tidy_errors():
        from .. import vcm
        from ..vcm.comparison import compare as compare_forces

        cfg = vcm.read(config, vcm_compatible, ignore_unknown=ignore_unknown)
        result = compare_forces(cfg, style, platform, seconds, strain)
        for line in _table(cfg, result, style):
            click.echo(line)
        if wrong := result.disagreements(tolerance):
            raise click.ClickException(
                f"{', '.join(t.name for t in wrong)}: above the tolerance of {tolerance:g}"
            )
        click.echo(f"All terms agree to {tolerance:g}.")


def _table(cfg, result, style: str) -> list[str]:
    lines = [
        f"{cfg.name}: {cfg.num_particles} vertices, Custom forces ({style}) against ours, "
        f"{result.platform}",
        "",
    ]
    width = max(len("term"), *(len(t.name) for t in result.terms)) if result.terms else 4
    lines.append(
        f"{'term':<{width}}  {'custom, kJ/mol':>18}  {'ours, kJ/mol':>18}  {'energies':>9}  "
        f"{'forces':>9}"
    )
    for t in result.terms:
        theirs, ours = t.energies
        lines.append(
            f"{t.name:<{width}}  {theirs:>18.10g}  {ours:>18.10g}  {t.energy_error:>9.1e}  "
            f"{t.force_error:>9.1e}{_remark(t)}"
        )
    lines += ["", f"set up:    {result.setup[0]:.3g} s custom, {result.setup[1]:.3g} s ours"]
    if result.seconds is not None:
        theirs, ours = result.seconds
        lines.append(
            f"per step:  {_duration(theirs)} custom, {_duration(ours)} ours: "
            f"{theirs / ours:.3g} times as fast"
        )
    return lines


def _remark(term) -> str:
    if not any(term.energies) and not term.largest_force:
        return "  zero in both"
    if not term.ours:
        return "  the same force in both"
    return f"  at {term.shrunk:g} of the size" if term.shrunk != 1 else ""


def _duration(seconds: float) -> str:
    for size, unit in ((1, "s"), (1e-3, "ms")):
        if seconds >= size:
            return f"{seconds / size:.3g} {unit}"
    return f"{seconds / 1e-6:.3g} µs"

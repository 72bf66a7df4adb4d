"""``openmm-helfrich spectrum``: a fluctuation spectrum beside its theory."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from .._writing import write_whole
from .options import json_option, print_json
from .trajectory import open_trajectory

__all__ = ["spectrum"]

_MODES = (".csv", ".h5", ".hdf5")
_COLUMNS = ("l", "mean", "error", "correlation_time_frames", "theory", "ratio")


@click.command()
@click.argument("source", type=click.Path(path_type=Path, dir_okay=False))
@click.option(
    "--mesh",
    "mesh_path",
    type=click.Path(path_type=Path, dir_okay=False),
    help="Mesh whose triangles a trajectory has, for one without NAME.ply beside it. Not for "
    "a file of modes.",
)
@click.option(
    "--membrane",
    type=click.IntRange(0),
    help="Which closed surface of a trajectory with several, from 0 in the order of the particles.",
)
@click.option("--lmax", type=click.IntRange(2), help="Largest mode.  [default: 10, or the file's]")
@click.option(
    "--kappa",
    type=click.FloatRange(min=0, min_open=True),
    default=20.0,
    show_default=True,
    help="Bending rigidity of the theory, kBT.",
)
@click.option(
    "--young",
    type=click.FloatRange(min=0),
    default=0.0,
    help="Young modulus of the theory (A18), kBT/nm².  [default: 0, a fluid (A17)]",
)
@click.option(
    "--radius",
    type=click.FloatRange(min=0, min_open=True),
    help="Radius of the theory, nm; only for --young.  [default: that of a sphere with the volume "
    "of the first frame]",
)
@click.option("--skip", type=click.IntRange(0), default=0, help="Frames to leave out at the start.")
@click.option("--stride", type=click.IntRange(1), default=1, help="Take every so many frames.")
@click.option(
    "--quadrature",
    type=click.Choice(["fit", "vertices", "surface"]),
    default="fit",
    show_default=True,
    help="How modes of a trajectory are measured: mode_amplitudes explains.",
)
@click.option(
    "--centre",
    type=click.Choice(["surface", "mass"]),
    help="Where radii are measured from.  [default: surface for the fit, else mass]",
)
@click.option("--csv", "table_path", type=click.Path(path_type=Path), help="Write the table too.")
@click.option("--plot", type=click.Path(path_type=Path), help="Draw it: .png, .pdf, .svg …")
@json_option
def spectrum(
    source, mesh_path, membrane, lmax, kappa, young, radius, table_path, plot, as_json, **options
):
    """Print the fluctuation spectrum of SOURCE beside the theory.

    SOURCE is a trajectory (.xtc, .dcd, .pdb, .gsd) or what a ModeReporter wrote (.csv, .h5). Where
    bonds flipped, the triangles of each frame of NAME.xtc are those in NAME.triangles beside it;
    else those of NAME.ply, the mesh at the start of a run, or of --mesh. A GSD file has its own.
    The errors account for correlation in time.
    """
    # The package takes a second to load, which --help need not wait for.
    from .. import analysis
    from ..errors import MeshError

    try:
        amplitudes, own_radius = _amplitudes(source, mesh_path, membrane, lmax, **options)
        if young and radius is None:
            if own_radius is None:
                raise click.UsageError("--young needs --radius where SOURCE is a file of modes")
            radius = own_radius
        found = analysis.spectrum(amplitudes)
        l = found.l[2:]
        # A fluid's spectrum knows of no radius.
        theory = analysis.theory.elastic_spectrum(l, kappa, young, radius or 1.0)
        measured = found.mean[2:], found.error[2:], found.correlation_time[2:]
        rows = [_row(*values) for values in zip(l, *measured, theory, strict=True)]
        if not as_json:
            for line in _lines(len(amplitudes), kappa, young, radius, rows):
                click.echo(line)
        if table_path is not None:
            _write(table_path, rows)
        if plot is not None:
            _plot(plot, found, l, theory, kappa, young)
        if as_json:
            of = {
                "kappa_kBT": kappa,
                "young_kBT_per_nm2": young,
                "radius_nm": radius if young else None,
            }
            print_json({"num_frames": len(amplitudes), "theory": of, "modes": rows})
    except (ValueError, TypeError, ImportError, MeshError) as reason:
        raise click.ClickException(str(reason)) from None


def _amplitudes(source, mesh_path, membrane, lmax, skip, stride, quadrature, centre):
    """u_lm of all frames that are asked for, and a radius, nm, or None for a file of modes.

    The radius is that of a sphere with the volume of the first frame.
    """
    import numpy as np

    from .. import analysis
    from .._mesh.geometry import volume_enclosed

    if source.suffix.lower() in _MODES:
        if mesh_path is not None:
            raise click.UsageError("--mesh is for trajectories; a file of modes needs none")
        if membrane is not None:
            raise click.UsageError("--membrane is for trajectories; a file of modes is of one")
        amplitudes = analysis.read_modes(source).amplitudes[skip::stride]
        largest = round(amplitudes.shape[1] ** 0.5) - 1
        if largest < 2:
            raise ValueError(f"{source} has modes up to l = {largest} only; a spectrum starts at 2")
        if lmax is not None and lmax > largest:
            raise ValueError(f"--lmax {lmax}: {source} has modes up to l = {largest} only")
        return amplitudes if lmax is None else amplitudes[:, : (lmax + 1) ** 2], None
    trajectory, triangles, _ = open_trajectory(source, mesh_path, membrane, skip, stride)
    found = analysis.mode_amplitudes(trajectory, triangles, lmax or 10, quadrature, centre)
    # Volumes of later ones hardly differ where there is a spectrum.
    start = next(iter(trajectory))
    corners = getattr(triangles, "triangles", triangles)
    volume = volume_enclosed(start, corners[0] if corners.ndim == 3 else corners)
    return found, float(abs(0.75 / np.pi * volume) ** (1 / 3))


def _row(l, mean, error, time, theory) -> dict[str, Any]:
    """One mode, by the names of the columns of the table."""
    numbers = [float(x) for x in (mean, error, time, theory, mean / theory)]
    return dict(zip(_COLUMNS, [int(l), *numbers], strict=True))


def _lines(num_frames, kappa, young, radius, rows):
    formula = "(A17)"
    if young:
        formula = f"(A18) with Y = {young:g} kBT/nm², R = {radius:.6g} nm"
    yield f"{num_frames} frames; theory {formula}, κ = {kappa:g} kBT"
    yield "   l     ⟨|u_lm|²⟩       error    theory  ratio         correlation time"
    for l, mean, error, time, theory, ratio in map(dict.values, rows):
        yield (
            f"{l:4d}   {mean:.5e}   {error:.2e}  {theory:.2e}  "
            f"{ratio:5.3f} ± {error / theory:.3f}  {time:8.1f} frames"
        )


def _write(path, rows):
    import csv
    import io

    text = io.StringIO(newline="")
    writer = csv.DictWriter(text, _COLUMNS)
    writer.writeheader()
    writer.writerows(rows)
    write_whole(path, text.getvalue().encode())


def _plot(path, found, l, theory, kappa, young):
    import io

    from matplotlib.figure import Figure

    low, high = found.interval()
    mean = found.mean[2:]
    bars = [mean - low[2:], [top - middle for top, middle in zip(high[2:], mean, strict=True)]]
    figure = Figure(figsize=(5, 4), layout="constrained")
    axes = figure.subplots()
    axes.errorbar(l, mean, bars, fmt="o", capsize=3, label="measured, 95 %")
    name = "(A17)" if young == 0 else "(A18)"
    axes.plot(l, theory, "k-", label=f"theory {name}, κ = {kappa:g} kBT")
    axes.set(xscale="log", yscale="log", xlabel="l", ylabel="⟨|u$_{lm}$|²⟩")
    axes.set_xticks(l, [str(number) for number in l])
    axes.minorticks_off()
    axes.legend()
    picture = io.BytesIO()
    path = path if path.suffix else path.with_suffix(".png")
    figure.savefig(picture, format=path.suffix[1:], dpi=150)
    write_whole(path, picture.getvalue())

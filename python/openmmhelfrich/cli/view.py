"""``openmm-helfrich view``: a run or a mesh in the browser."""

from __future__ import annotations

from pathlib import Path

import click

from .. import logs

__all__ = ["view"]

_FILE = click.Path(path_type=Path, exists=True, dir_okay=False)


@click.command()
@click.argument("source", metavar="RUN", type=click.Path(path_type=Path, exists=True))
@click.option(
    "-o",
    "--out",
    type=click.Path(path_type=Path, dir_okay=False),
    help="The page. Default: RUN.html in the folder of the run, or beside the file.",
)
@click.option("--browser/--no-browser", default=True, help="Open the page in the browser.")
@click.option(
    "--every",
    type=click.IntRange(1),
    help="Show every so many frames. Default: all, or as many as make a page of some 30 MB.",
)
@click.option(
    "--mesh",
    "mesh_path",
    type=_FILE,
    help="Mesh of all membranes, for a trajectory without NAME.ply or NAME.triangles beside it.",
)
def view(source, out, browser, every, mesh_path):
    """Show RUN in the browser: the folder of a run, a mesh, or a trajectory.

    Writes one HTML file with everything in it, which needs neither a server nor a network and can
    be sent to others: the surface, coloured by curvature, area, angle or neighbours, with a slider
    over time, and beside it energies, areas, volumes and the spectrum. The key ? shows what keys
    do.
    """
    from tqdm import tqdm

    from ..viewer.sources import scene_of
    from ..viewer.views import check_replaceable, open_in_browser, write_page

    if out is None:
        folder = source if source.is_dir() else source.parent
        out = folder / f"{source.resolve().stem}.html"

    def progress(numbers):
        return tqdm(numbers, unit="frame", disable=True if logs.quiet() else None, leave=False)

    try:
        check_replaceable(out)
        scene = scene_of(source, every=every, mesh=mesh_path, progress=progress)
        size = write_page(out, scene)
    except FileExistsError as reason:
        raise click.ClickException(f"{reason} with --out") from None
    except (ValueError, ImportError) as reason:
        raise click.ClickException(str(reason).removeprefix("view: ")) from None
    count = len(scene.frames)
    click.echo(f"wrote {out}: {count} frame{'s' * (count != 1)}, {size / 1e6:.2g} MB")
    if browser and not open_in_browser(out):
        click.echo("Open it in a browser.")

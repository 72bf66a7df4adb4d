"""``openmm-helfrich frames``: the surfaces of a finished run in one file for ParaView."""

from __future__ import annotations

from pathlib import Path

import click

from .trajectory import open_trajectory

__all__ = ["frames"]


@click.command()
@click.argument("source", type=click.Path(path_type=Path, exists=True))
@click.argument("output", required=False, type=click.Path(path_type=Path, dir_okay=False))
@click.option(
    "--mesh",
    "mesh_path",
    type=click.Path(path_type=Path, exists=True, dir_okay=False),
    help="Mesh of all membranes, for a trajectory without NAME.triangles beside it.",
)
@click.option(
    "--membrane",
    type=click.IntRange(0),
    help="Which closed surface, from 0 in the order of the particles.  [default: all]",
)
@click.option("--skip", type=click.IntRange(0), default=0, help="Frames to leave out at the start.")
@click.option("--stride", type=click.IntRange(1), default=1, help="Take every so many frames.")
@click.option("--force", is_flag=True, help="Overwrite OUTPUT.")
def frames(source, output, mesh_path, membrane, skip, stride, force):
    """Write the surfaces of the trajectory SOURCE to OUTPUT as VTKHDF, which ParaView opens.

    SOURCE is an XTC, DCD or PDB file, or the folder of a run. Where bonds flipped, the triangles of
    each frame are those of NAME.triangles beside NAME.xtc; without that file --mesh has them.
    OUTPUT is NAME.vtkhdf beside it if it is not given. Vertices get mean curvatures, areas and
    numbers of neighbours. A run that is still to come writes the same, in double precision, with
    'run --frames vtkhdf'. Needs h5py.
    """
    from .. import analysis
    from ..errors import MeshError

    source = _trajectory_in(source)
    output = output or source.with_suffix(".vtkhdf")
    if output.exists() and not force:
        raise click.ClickException(f"{output} is there already; overwrite it with --force")
    try:
        found = open_trajectory(source, mesh_path, membrane, skip, stride, several=True)
        count = analysis.write_vtkhdf(output, *found)
    except (ValueError, TypeError, ImportError, MeshError) as reason:
        raise click.ClickException(str(reason)) from None
    click.echo(f"wrote {output}: {count} frames of {found[0].num_vertices} vertices")


def _trajectory_in(source: Path) -> Path:
    """The trajectory of a run's folder; a file is one itself."""
    if not source.is_dir():
        return source
    found = sorted(source.glob("*.xtc"))
    if len(found) != 1:
        raise click.ClickException(
            f"{source} has {len(found) or 'no'} XTC files, not one; name the trajectory itself"
        )
    return found[0]

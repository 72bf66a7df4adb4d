"""``openmm-helfrich frames``: the surfaces of a finished run for ParaView, OVITO or HOOMD."""

from __future__ import annotations

import itertools
from pathlib import Path

import click

from .trajectory import open_trajectory

__all__ = ["frames"]

# By format; the first is that of a name that is not given.
_SUFFIXES = {"vtkhdf": (".vtkhdf",), "gsd": (".gsd",), "xyz": (".extxyz", ".xyz")}
# A file for each frame, in a folder.
_SEQUENCES = ("ply", "obj", "stl", "vtk")


@click.command()
@click.argument("source", type=click.Path(path_type=Path, exists=True))
@click.argument("output", required=False, type=click.Path(path_type=Path))
@click.option(
    "--format",
    "kind",
    type=click.Choice([*_SUFFIXES, *_SEQUENCES]),
    help="What to write.  [default: as OUTPUT ends, or else vtkhdf]",
)
@click.option(
    "--mesh",
    "mesh_path",
    type=click.Path(path_type=Path, exists=True, dir_okay=False),
    help="Mesh of all membranes, for a trajectory without NAME.ply beside it.",
)
@click.option(
    "--membrane",
    type=click.IntRange(0),
    help="Which closed surface, from 0 in the order of the particles.  [default: all]",
)
@click.option("--skip", type=click.IntRange(0), default=0, help="Frames to leave out at the start.")
@click.option("--stride", type=click.IntRange(1), default=1, help="Take every so many frames.")
@click.option("--force", is_flag=True, help="Overwrite OUTPUT.")
def frames(source, output, kind, mesh_path, membrane, skip, stride, force):
    """Write the surfaces of the trajectory SOURCE to OUTPUT, with the triangles of each frame.

    SOURCE is an XTC, DCD, PDB or GSD file, or the folder of a run. Where bonds flipped, the
    triangles of each frame are those of NAME.triangles beside NAME.xtc; else those of NAME.ply,
    the mesh at the start of a run, or of --mesh, which has the periodic box, too. A GSD file has
    its own.

    OUTPUT is beside it if it is not given: NAME.vtkhdf for ParaView (needs h5py), NAME.gsd for
    HOOMD and OVITO (needs gsd), with edges as bonds, or NAME.extxyz, extended XYZ for OVITO, whose
    surfaces are not in it. PLY, OBJ, STL and VTK are files NAME_surface_000000.obj, … in the folder
    OUTPUT, or NAME_obj. Vertices get mean curvatures, areas and numbers of neighbours, but in
    OBJ and STL. A run that is still to come writes all of these itself, with 'run --frames':
    VTKHDF and meshes in double precision, GSD with its masses.
    """
    from .. import analysis
    from ..errors import MeshError
    from ..simulation.run_folder import files_of

    writers = {
        "vtkhdf": analysis.write_vtkhdf,
        "gsd": analysis.write_gsd,
        "xyz": analysis.write_extended_xyz,
    }
    source = _trajectory_in(source)
    kind = kind or _kind_of(output)
    if output is None and kind in _SEQUENCES:
        output = source.with_name(f"{source.stem}_{kind}")
    output = output or source.with_suffix(_SUFFIXES[kind][0])
    if output.exists() and output.is_dir() != (kind in _SEQUENCES):
        wanted = "folder" if kind in _SEQUENCES else "file"
        raise click.ClickException(f"{output} is no {wanted}; give the name of a {wanted}")
    if output.name in files_of(output.parent):
        raise click.ClickException(
            f"{output} is what the run there goes on with; give another name"
        )
    if output.exists() and not force:
        raise click.ClickException(f"{output} is there already; overwrite it with --force")
    try:
        *found, box = open_trajectory(source, mesh_path, membrane, skip, stride, several=True)
        if kind in _SEQUENCES:
            count = _write_sequence(output, kind, source.stem, *found, box)
        else:
            count = writers[kind](output, *found, box=box)
    except (ValueError, TypeError, ImportError, MeshError) as reason:
        raise click.ClickException(str(reason)) from None
    click.echo(f"wrote {output}: {count} frames of {found[0].num_vertices} vertices")


def _write_sequence(folder: Path, kind: str, name: str, trajectory, triangles, box) -> int:
    """A mesh for each frame in a folder, in place of those there; returns how many."""
    from ..analysis._surface_frames import each_surface
    from ..simulation.frames import MeshFrames

    writer, numbers = MeshFrames(folder, name, kind, ["surface"]), itertools.count()
    writer.remove_from(0)

    def add(frame):
        surface = [(frame.vertices, frame.triangles)]
        writer.write(next(numbers), frame.step, frame.time, surface, frame.box)

    return each_surface("frames", add, trajectory, triangles, box=box)


def _kind_of(output: Path | None) -> str:
    """The format that a name ends with; VTKHDF without a name."""
    if output is None:
        return "vtkhdf"
    suffix = output.suffix.lower()
    for kind, ends in _SUFFIXES.items():
        if suffix in ends:
            return kind
    if suffix[1:] in _SEQUENCES:
        raise click.ClickException(
            f"{output}: of {suffix[1:].upper()} there is a file for each frame; give "
            f"--format {suffix[1:]} and the name of a folder"
        )
    known = ", ".join(end for ends in _SUFFIXES.values() for end in ends)
    raise click.ClickException(
        f"{output} does not end with {known}; give such a name, or --format with one of "
        f"{', '.join(_SEQUENCES)} and the name of a folder"
    )


def _trajectory_in(source: Path) -> Path:
    """The trajectory of a run's folder; a file is one itself."""
    if not source.is_dir():
        return source
    found = sorted(source.glob("*.xtc")) or sorted(source.glob("*.gsd"))
    if len(found) == 1:
        return found[0]
    if not found and (made := sorted(source.glob("*.vtkhdf"))):
        raise click.ClickException(
            f"{source} has no XTC file, but its frames are in {made[0].name}, which ParaView and "
            "'openmm-helfrich view' open"
        )
    raise click.ClickException(
        f"{source} has {len(found) or 'no'} XTC or GSD files, not one; name the trajectory itself"
    )

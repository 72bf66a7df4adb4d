"""``openmm-helfrich convert``: a serialized System with our forces in place of Custom forces."""

from __future__ import annotations

from pathlib import Path

import click

from .._writing import write_whole

__all__ = ["convert"]

_FILE = click.Path(path_type=Path, exists=True, dir_okay=False)


@click.command()
@click.argument("system", type=_FILE)
@click.option(
    "-o",
    "--output",
    type=click.Path(path_type=Path, dir_okay=False),
    help="The new System. Default: SYSTEM's name with -helfrich before the extension.",
)
@click.option(
    "--positions",
    type=_FILE,
    help="Positions of all particles: a serialized State (.xml), .pdb or .cif. With them energies "
    "and forces are compared once more, and triangles are oriented outward.",
)
@click.option(
    "--tolerance",
    type=click.FloatRange(min=0),
    default=1e-9,
    show_default=True,
    help="Of that comparison, relative.",
)
@click.option(
    "--freeze",
    multiple=True,
    metavar="NAME",
    help="A global parameter that may become a number, its default in SYSTEM, or follow another "
    "one; can be given several times. What is printed names those that would help.",
)
def convert(system, output, positions, tolerance, freeze):
    """Replace the Custom forces of a membrane in the serialized System SYSTEM (XML).

    Finds the bending energies, area and volume constraints, repulsions and dihedrals that are the
    same as ours, whichever way their expressions are written, and leaves everything else alone.
    The new System needs the plugin: import openmmhelfrich before reading it.
    """
    import openmm

    from .. import vcm

    output = output or system.with_name(f"{system.stem}-helfrich{system.suffix or '.xml'}")
    given = _deserialize(system, openmm.System, "a System")
    where = None if positions is None else _positions(positions)
    try:
        faster, report = vcm.accelerate(given, where, tolerance, freeze)
    except ValueError as reason:
        raise click.ClickException(str(reason)) from None
    click.echo(str(report))
    if not report.replaced:
        raise click.ClickException("nothing to replace, so no file was written")
    write_whole(output, openmm.XmlSerializer.serialize(faster).encode())
    click.echo(f"wrote {output}")


def _deserialize(path: Path, cls: type, what: str):
    import openmm

    try:
        # Some Systems are larger than what is comfortable, but all of them fit in memory.
        result = openmm.XmlSerializer.deserialize(path.read_text(encoding="utf-8"))
    except (openmm.OpenMMException, UnicodeDecodeError, ValueError) as reason:
        raise click.ClickException(f"{path} is not {what} in XML: {reason}") from None
    if not isinstance(result, cls):
        raise click.ClickException(f"{path} holds a {type(result).__name__}, not {what}")
    return result


def _positions(path: Path):
    """Positions of all particles, a Quantity."""
    import openmm
    from openmm import app

    suffix = path.suffix.lower()
    if suffix in (".pdb", ".cif"):
        reader = app.PDBFile if suffix == ".pdb" else app.PDBxFile
        try:
            return reader(str(path)).getPositions(asNumpy=True)
        except Exception as reason:
            raise click.ClickException(f"{path} cannot be read: {reason}") from None
    state = _deserialize(path, openmm.State, "a State")
    try:
        return state.getPositions(asNumpy=True)
    except openmm.OpenMMException:
        raise click.ClickException(f"{path} is a State without positions") from None

"""``openmm-helfrich mesh``: make, inspect, convert and transform meshes."""

from __future__ import annotations

import contextlib
import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import click

from ..errors import MeshError

__all__ = ["mesh"]

_INPUT = click.Path(path_type=Path, dir_okay=False)
_OUTPUT = click.Path(path_type=Path, dir_okay=False)
# Where click keeps the transformations of this command line, in its context.
_STEPS = f"{__name__}.steps"
# Softness of the paper's vesicles, for which `info` says the least height.
_SOFTNESS = 0.037

_force_option = click.option("--force", is_flag=True, help="Overwrite OUTPUT if it is there.")
_radius_option = click.option(
    "--radius", type=float, default=1000.0, show_default=True, help="Radius, nm."
)


def _reading_options(command):
    """How a file that is no valid mesh as it is may be read."""
    for option in (
        click.option("--drop-unused", is_flag=True,
                     help="Leave out vertices that belong to no triangle."),
        click.option("--merge", type=float, metavar="D",
                     help="Join vertices at most D apart, in the numbers of the file."),
        click.option("--triangulate", is_flag=True,
                     help="Split faces of more than three corners along their shortest diagonals."),
    ):  # fmt: skip
        command = option(command)
    return command


@contextlib.contextmanager
def _tidy_errors() -> Iterator[None]:
    """Errors of meshes as one line, without a traceback; those of files are `main`'s."""
    try:
        yield
    except MeshError as reason:
        raise click.ClickException(str(reason)) from None


@click.group()
def mesh() -> None:
    """Make, inspect, convert and transform triangulated surfaces.

    The extension of a file gives its format: PLY, OBJ, STL, OFF, VTK, VTU, or Gmsh (.msh); VTP is
    read only. Numbers are taken as nm.
    """


@mesh.command()
@click.argument("parts", type=int)
@click.argument("output", type=_OUTPUT)
@_radius_option
@_force_option
def icosphere(parts, output, radius, force):
    """Make a regular sphere of 10 PARTS² + 2 vertices.

    Every side of an icosahedron is cut into PARTS: 10 give 1002 vertices.
    """
    from ..mesh import Mesh

    with _tidy_errors():
        _write(Mesh.icosphere(parts, radius), output, force)


@mesh.command()
@click.argument("vertices", type=int)
@click.argument("output", type=_OUTPUT)
@_radius_option
@click.option("--seed", type=int, default=0, show_default=True, help="Equal seeds, equal meshes.")
@_force_option
def random(vertices, output, radius, seed, force):
    """Make an irregular, nearly even sphere of so many VERTICES, with degrees 5 to 7."""
    from ..mesh import Mesh

    with _tidy_errors():
        _write(Mesh.random_sphere(vertices, radius, seed), output, force)


@mesh.command()
@click.argument("input", type=_INPUT)
@click.argument("output", type=_OUTPUT)
@_reading_options
@_force_option
def convert(input, output, force, **reading):
    """Write the mesh of INPUT in the format of OUTPUT, triangles turned outward."""
    from ..mesh import Mesh

    with _tidy_errors():
        _write(Mesh.read(input, **reading), output, force)


def _note(context: click.Context, parameter: click.Parameter, value):
    """Keep a transformation in its turn on the command line."""
    if value:
        if len(value) > 1:
            raise click.BadParameter("give it once; for more, use the command again")
        context.meta.setdefault(_STEPS, []).append((parameter.name, value[0]))
    return value


def _step(name: str, help: str, **options):
    # `multiple`, so that a second use is noticed rather than taking the place of the first.
    return click.option(f"--{name}", callback=_note, multiple=True, help=help, **options)


@mesh.command()
@click.argument("input", type=_INPUT)
@click.argument("output", type=_OUTPUT)
@_step("scale", "Multiply the coordinates by S.", type=float, metavar="S")
@_step("stretch", "Multiply x, y and z by factors of their own.", type=(float, float, float),
       metavar="SX SY SZ")  # fmt: skip
@_step("radius", "Scale to the area of a sphere of this radius, nm.", type=float, metavar="R")
@_step("oblate", "Flatten along z to a reduced volume, at constant area.", type=float, metavar="V")
@_step("prolate", "Stretch along z to a reduced volume, at constant area.", type=float,
       metavar="V")  # fmt: skip
@_step("deform", "Multiply radii by 1 + U Y_lm, real harmonics about the origin.",
       type=(int, int, float), metavar="L M U")  # fmt: skip
@_step("rotate", "Rotate about the origin by a rotation vector in degrees.",
       type=(float, float, float), metavar="X Y Z")  # fmt: skip
@_step("translate", "Move, nm.", type=(float, float, float), metavar="X Y Z")
@_reading_options
@_force_option
@click.pass_context
def transform(context, input, output, force, triangulate, merge, drop_unused, **steps):
    """Transform the mesh of INPUT and write it to OUTPUT.

    Transformations are done in the order in which they are given.
    """
    from ..mesh import Mesh

    asked = context.meta.get(_STEPS, [])
    if not asked:
        raise click.UsageError("nothing to do: give a transformation such as --scale 2")
    with _tidy_errors():
        result = Mesh.read(input, triangulate=triangulate, merge=merge, drop_unused=drop_unused)
        for name, value in asked:
            result = _transformed(result, name, value)
        _write(result, output, force)


def _transformed(given, name: str, value):
    import math

    from scipy.spatial.transform import Rotation

    if name in ("scale", "stretch"):
        return given.scaled(value)
    if name == "radius":
        if not (math.isfinite(value) and value > 0):
            raise click.BadParameter(f"needs a radius above 0, got {value}", param_hint="--radius")
        return given.scaled(value / math.sqrt(given.area / (4 * math.pi)))
    if name == "deform":
        return given.deformed(*value)
    if name == "rotate":
        return given.rotated(Rotation.from_rotvec(value, degrees=True))
    if name == "translate":
        return given.translated(value)
    return getattr(given, name)(value)


@mesh.command()
@click.argument("input", type=_INPUT)
@click.option(
    "--softness",
    type=click.FloatRange(min=0, min_open=True),
    default=_SOFTNESS,
    show_default=True,
    help="Ξ, for which to say the least triangle height d.",
)
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object.")
@_reading_options
def info(input, softness, as_json, **reading):
    """Say what the mesh of INPUT is like: size, shape, degrees, edges, heights."""
    from ..mesh import Mesh

    with _tidy_errors():
        facts = _facts(Mesh.read(input, **reading), softness)
    if as_json:
        click.echo(json.dumps(facts))
        return
    click.echo(f"{input}")
    width = max(map(len, facts))
    for name, value in facts.items():
        click.echo(f"  {name:<{width}s}  {_text(value)}")


def _facts(given, softness: float) -> dict[str, Any]:
    """What `info` says, plain numbers by name."""
    import math

    import numpy as np

    from ..analysis import edge_lengths, triangle_heights

    edges, heights = edge_lengths(given, given), triangle_heights(given, given)
    degrees, counts = np.unique(given.degrees, return_counts=True)
    return {
        "vertices": given.num_vertices,
        "triangles": given.num_triangles,
        "components": given.num_components,
        "Euler characteristic": given.euler_characteristic,
        "vertices by degree": {
            str(d): int(n) for d, n in zip(degrees.tolist(), counts.tolist(), strict=True)
        },
        "area (nm²)": given.area,
        **_closure(given),
        **({} if given.box is None else {"box (nm)": given.box.tolist()}),
        "radius of that area (nm)": math.sqrt(given.area / (4 * math.pi)),
        "centre (nm)": given.vertices.mean(axis=0).tolist(),
        "extent (nm)": np.ptp(given.vertices, axis=0).tolist(),
        "edges, least to largest (nm)": [float(edges.min()), float(edges.max())],
        "heights, least to largest (nm)": [float(heights.min()), float(heights.max())],
        f"least height d at Ξ = {softness:g} (nm)": float(given.min_height(softness)),
    }


def _closure(given) -> dict[str, object]:
    """What it encloses, None if it spans its periodic box; or how many edges its borders have."""
    if given.border_loops:
        return {"edges of borders": [len(border) for border in given.border_loops]}
    try:
        return {"volume (nm³)": given.volume, "reduced volume": given.reduced_volume}
    except MeshError:
        return {"volume (nm³)": None, "reduced volume": None}


def _text(value) -> str:
    if isinstance(value, dict):
        return ", ".join(f"{count} of {degree}" for degree, count in value.items())
    if isinstance(value, list):
        return "  ".join(_text(one) if isinstance(one, list) else f"{one:.6g}" for one in value)
    if value is None:
        return "none"
    return str(value) if isinstance(value, int) else f"{value:.9g}"


def _write(made, output: Path, force: bool) -> None:
    if output.exists() and not force:
        raise click.ClickException(f"{output} is there already; overwrite it with --force")
    made.write(output)
    reduced = _closure(made).get("reduced volume")
    click.echo(
        f"wrote {output}: {made.num_vertices} vertices, {made.num_triangles} triangles, "
        f"area {made.area:.8g} nm²" + ("" if reduced is None else f", reduced volume {reduced:.4f}")
    )

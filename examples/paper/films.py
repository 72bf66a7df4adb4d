"""Six films of membranes in motion, as GIFs of less than 2 MB each.

    python examples/paper/films.py --out out/films

The paper has six movies; these are films of what its figures show: fluctuating vesicles on a soft
and on a hard mesh (Fig. 6), an oblate and a prolate of ν = 0.6 that relax (Figs. 7 and 11), and the
red cell of VCM's files with C0 = 0 and 0.006/nm (Fig. 8), which need the folder that holds them,
see fig08_red_cell.py. --quick makes four frames of each.
"""

import argparse
import sys
from pathlib import Path
from typing import NamedTuple

import numpy as np
import openmm
import openmmhelfrich as helfrich
from _snapshots import extent_of, render
from fig08_red_cell import files_folder
from matplotlib import font_manager
from openmm import unit
from PIL import Image, ImageDraw, ImageFont

MOST_BYTES = 2_000_000
FRAMES, QUICK_FRAMES = 60, 4
SIZE = 280


class Film(NamedTuple):
    """What is shown: a caption, ν, Ξ and start of a vesicle, or a file of VCM, ps and ps a step."""

    caption: str
    reduced_volume: float = 1.0
    softness: float = 0.037
    start: str = "sphere"
    file: str = ""
    duration: float = 20_000.0
    time_step: float = 0.5


FILMS = {
    "soft_sphere": Film("Fig. 6: fluctuations, Ξ = 0.037", duration=40_000),
    "hard_sphere": Film("Fig. 6: fluctuations, Ξ = 0.59", softness=0.59, duration=40_000),
    "oblate": Film("Fig. 7: oblate, ν = 0.6", 0.6, start="oblate"),
    "prolate": Film("Fig. 11: prolate, ν = 0.6", 0.6, start="prolate"),
    "red_cell": Film("Fig. 8: red cell, C0 = 0", file="SM_RBC_C0.txt", time_step=0.2),
    "red_cell_curved": Film(
        "Fig. 8: red cell, C0 = 0.006/nm, |S|", file="SM_RBC_C0.006.txt", time_step=0.2
    ),
}


def vesicle_frames(film, count):
    """Meshes of a vesicle at equal times."""
    mesh = helfrich.Mesh.random_sphere(1002, 1000.0, seed=1)
    if film.start != "sphere":
        mesh = getattr(mesh, film.start)(film.reduced_volume)
    vesicle = helfrich.Vesicle(
        mesh,
        softness=film.softness,
        scheme=helfrich.BendingForce.GompperKrollBarycentric,
        volume_modulus=0.0 if film.start == "sphere" else 0.04,
    )
    simulation = vesicle.simulation(integrator_of(film))
    if vesicle.energies(simulation.context)["heights"] > vesicle.epsilon * mesh.num_vertices:
        # Flat starts have triangles of nearly no height at their rim.
        simulation.minimizeEnergy(maxIterations=200)
    simulation.context.setVelocitiesToTemperature(300, 1)
    yield from frames_of(simulation, mesh, slice(None), film, count)


def cell_frames(film, count, folder):
    """Meshes of the fluid membrane of a configuration of VCM at equal times."""
    config = helfrich.vcm.read(folder / film.file, True, seed=1)
    fluid = config.membranes[0]
    chosen = slice(fluid.particles.start, fluid.particles.stop)
    yield from frames_of(config.simulation(), fluid.mesh, chosen, film, count)


def integrator_of(film):
    """LangevinMiddle of the paper."""
    integrator = openmm.LangevinMiddleIntegrator(300, 0.01, film.time_step)
    integrator.setRandomNumberSeed(1)
    return integrator


def frames_of(simulation, mesh, chosen, film, count):
    """Meshes of some particles of a simulation, the start first."""
    steps = round(film.duration / film.time_step / max(FRAMES - 1, 1))
    for frame in range(count):
        if frame:
            simulation.step(steps)
        state = simulation.context.getState(positions=True)
        positions = state.getPositions(asNumpy=True).value_in_unit(unit.nanometer)[chosen]
        yield frame * steps * film.time_step, helfrich.Mesh(positions, mesh.triangles)


def write(path, film, frames):
    """Write a GIF of frames, each with its time.

    Raises
    ------
    ValueError
        More than MOST_BYTES.
    """
    # Matplotlib's font has Greek letters.
    font = ImageFont.truetype(font_manager.findfont("DejaVu Sans"), 11)
    images, extent = [], None
    for time, mesh in frames:
        extent = extent or 1.1 * extent_of(mesh)
        picture = render(mesh, None, None, "tilted", SIZE, True, extent)
        image = Image.fromarray(np.asarray(picture))
        text = f"{film.caption}, {time / 1000:.1f} ns"
        ImageDraw.Draw(image).text((6, 4), text, fill="black", font=font)
        images.append(image.convert("RGB").quantize(32, dither=Image.Dither.NONE))
    path.parent.mkdir(parents=True, exist_ok=True)
    images[0].save(path, save_all=True, append_images=images[1:], duration=80, loop=0)
    size = path.stat().st_size
    if size >= MOST_BYTES:
        raise ValueError(f"films: {path} has {size} bytes, {MOST_BYTES} at most; take fewer frames")
    return size


def main():
    folder, rest = files_folder()
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--quick", action="store_true", help="four frames of each film")
    parser.add_argument("--only", nargs="+", choices=FILMS, default=list(FILMS), help="which films")
    parser.add_argument("--out", type=Path, default=Path("out/films"), help="folder to write to")
    options = parser.parse_args(rest)
    missing = []
    for name in options.only:
        film = FILMS[name]
        count = QUICK_FRAMES if options.quick else FRAMES
        if not film.file:
            frames = vesicle_frames(film, count)
        elif (folder / film.file).is_file():
            frames = cell_frames(film, count, folder)
        else:
            missing.append(name)
            continue
        path = options.out / f"{name}.gif"
        size = write(path, film, frames)
        print(f"{path}: {count} frames, {size / 1000:.0f} kB", flush=True)
    if missing:
        sys.exit(
            f"films: left out {', '.join(missing)}: VCM's files of the red cell are not in "
            f"{folder}; say with --files FOLDER where they are"
        )


if __name__ == "__main__":
    main()

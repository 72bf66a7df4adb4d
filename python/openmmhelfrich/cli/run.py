"""``openmm-helfrich run``: simulate what a configuration file says."""

from __future__ import annotations

import signal
import sys
from pathlib import Path

import click

from .. import logs
from .options import config_argument, platform_option, reader_options, tidy_errors

__all__ = ["run"]


@click.command()
@config_argument
@click.option(
    "--out",
    type=click.Path(path_type=Path, file_okay=False),
    help="Folder for the outputs. Default: the project's name.",
)
@platform_option
@click.option(
    "--steps",
    type=click.IntRange(min=0),
    help="Step, counted from the start, to end with. Default: what the configuration says.",
)
@click.option("--seed", type=click.IntRange(1, 2**31 - 1), help="Seed in place of the file's.")
@click.option(
    "--resume",
    is_flag=True,
    help="Go on with the run that the folder holds, as it began: options need not be given again, "
    "and others are refused.",
)
@click.option(
    "--resume-previous",
    is_flag=True,
    help="Go on from the checkpoint before the last one, if that is damaged.",
)
@click.option(
    "--xtc/--no-xtc", default=None, help="Write an XTC trajectory. Default: as CONFIG says, or yes."
)
@click.option(
    "--frames",
    type=click.Choice(["none", "ply", "obj", "stl", "vtk", "vtkhdf", "gsd", "extxyz"]),
    help="Write a mesh per membrane and frame, or one file of all: vtkhdf for ParaView (needs "
    "h5py), gsd for HOOMD and OVITO (needs gsd), extxyz for OVITO and ASE. All but OBJ and STL "
    "have curvatures and areas of the vertices; OVITO reads OBJ, STL and VTK. Default: as CONFIG "
    "says, or none.",
)
@click.option("--ply", "frames", flag_value="ply", help="Short for --frames ply.")
@click.option("--no-ply", "frames", flag_value="none", help="Short for --frames none.")
@click.option(
    "--flips",
    type=click.FloatRange(0, 100),
    metavar="RATE",
    help="Make the membranes of a VCM configuration fluid: attempts to flip a bond for each edge "
    "and time step, such as 0.01. TOML has a key of its own.",
)
@click.option(
    "--checkpoint",
    "checkpoint_seconds",
    type=click.FloatRange(min=0),
    default=10.0,
    show_default=True,
    help="Seconds between checkpoints: what a kill can cost.",
)
@click.option(
    "--live",
    is_flag=True,
    help="Show time, temperature and the energies of this moment below the progress.",
)
@click.option(
    "--live-page",
    type=click.Path(path_type=Path, dir_okay=False),
    help="Write a page there that shows the membranes, and updates itself in a browser, every few "
    "seconds. 'openmm-helfrich view' shows finished runs.",
)
@reader_options
def run(config, out, steps, seed, live, live_page, **options):
    """Simulate what CONFIG says: a VCM configuration, or our own in TOML (name.toml).

    The run can be interrupted at any moment, by Ctrl-C or a kill, and goes on with --resume from
    its last checkpoint with nothing lost and nothing doubled.
    """
    if live_page is not None:
        from ..viewer.views import check_replaceable

        check_replaceable(live_page)
    with tidy_errors(), _Stop() as stop:
        # OpenMM and the package take a second to load, which --help need not wait for.
        from ..simulation.runner import Run

        job = Run(
            config,
            folder=out,
            seed=seed or 0,
            **options,
        )
        try:
            last_step = job.cfg.num_steps if steps is None else steps
            done = _simulate(job, last_step, stop, live, live_page)
        finally:
            job.close()
    if not done:
        click.echo(f"Interrupted at step {job.step}. Go on with --resume.", err=True)
        sys.exit(128 + stop.signal)


def _simulate(job, last_step: int, stop: _Stop, live: bool, live_page: Path | None) -> bool:
    """Run with a progress bar; returns whether the last step was reached."""
    from tqdm import tqdm

    from .live import Page, Table

    cfg = job.cfg
    verb = f"resumed at step {job.step}" if job.resumed else f"seed {cfg.seed}"
    click.echo(
        f"{cfg.name}: {len(cfg.membranes)} membrane(s), {cfg.num_particles} vertices, "
        f"platform {job.platform}, {verb}, outputs in {job.folder}"
    )
    # Without a terminal a line per report replaces the bar.
    quiet = logs.quiet()
    disable = True if quiet else None
    bar = tqdm(total=last_step, initial=job.step, unit="step", disable=disable, dynamic_ncols=True)
    page = None if live_page is None else Page(job, live_page)
    with bar, Table(job, live and not bar.disable) as table:

        def progress(step: int) -> None:
            bar.update(step - bar.n)
            table.update()
            if page is not None:
                page.update()

        def report(frame) -> None:
            if not live:
                bar.set_postfix_str(_summary(frame), refresh=False)
            if bar.disable and not quiet:
                speed = f"  {table.speed(frame.step):.4g} steps/s" if live else ""
                click.echo(f"step {frame.step}/{last_step}{speed}  {_summary(frame)}")

        done = job.advance(last_step, progress, report, stop)
        if page is not None:
            page.finish()
    _print_terms(job.frame)
    return done


def _summary(frame) -> str:
    terms = [f"{name} {energy:.5g}" for name, energy in frame.terms.items()]
    return ", ".join([*terms, f"kinetic {frame.kinetic:.5g}"])


def _print_terms(frame) -> None:
    rows = {**frame.terms, "potential": frame.potential, "kinetic": frame.kinetic}
    width = max(map(len, rows))
    click.echo(f"Energies at step {frame.step}, {frame.time:.10g} ps, in kJ/mol:")
    for name, energy in rows.items():
        click.echo(f"  {name:<{width}s} {energy:18.6f}")


class _Stop:
    """Notes Ctrl-C and SIGTERM, so that the run can end with a checkpoint.

    A second Ctrl-C ends at once; the last checkpoint is then where the run goes on. What signals
    did before comes back with the end of the run, for programs that call the command.
    """

    def __init__(self):
        self.signal = 0
        self._before = {}

    def __enter__(self) -> _Stop:
        for number in (signal.SIGINT, signal.SIGTERM):
            self._before[number] = signal.signal(number, self._note)
        return self

    def __exit__(self, *reason: object) -> None:
        for number, handler in self._before.items():
            # What was not set by Python is None, and cannot be set by it.
            signal.signal(number, signal.SIG_DFL if handler is None else handler)

    def _note(self, number: int, frame) -> None:
        self.signal = number
        signal.signal(number, signal.SIG_DFL)

    def __call__(self) -> bool:
        return self.signal != 0

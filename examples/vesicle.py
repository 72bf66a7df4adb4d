"""A fluid vesicle from a random mesh to its fluctuation spectrum.

The vesicle is that of Farnudi, Ejtehadi and Everaers, doi:10.1103/PhysRevE.108.015301: 1002
vertices on a sphere of 1000 nm, bending rigidity 20 kBT at 300 K, softness 0.037, Langevin dynamics
in steps of 0.2 ps. Three stages:

1. **Relax.** The energy of the generated mesh is minimised and velocities are drawn.
2. **Measure the spectrum.** At fixed area *and* fixed volume of a sphere there is nothing left to
   fluctuate: any undulation needs area that the sphere has not got. So this stage switches the
   volume term off, as the paper does for its spectra (Fig. 6): water passes, the vesicle becomes a
   little flaccid, its tension vanishes, and ⟨|u_lm|²⟩ = (kBT/κ) / [(l+2)(l+1) l (l−1)] (A17)
   holds. The friction is 0.001/ps, the lower of the paper's two. It changes no average, but
   mode 2 then forgets its past in about 4 ns, against 33 ns at 0.01/ps, where it creeps.
3. **Run.** The membrane is sealed: the volume it has now becomes the target of a volume term of the
   paper's strength. At the paper's usual friction of 0.01/ps it runs for two periods of its
   slowest mode and writes a trajectory.

The amplitudes u_lm are measured twice: as integrals over the triangulated surface, and as the
paper's sums over vertices, which agree for small l and pick up the roughness of the uneven mesh for
large l. Vertices that keep their neighbours leave the mesh a small shear modulus, which (A18) shows
in l = 2 first: in runs of 1 µs, --spectrum-time 1e6, ⟨|u_lm|²⟩ is 0.83 ± 0.04 of (A17) for l = 2
and 0.99 ± 0.02 for l = 3 … 6. The default is shorter, and its error bars are larger than that.

The output folder then holds

    vesicle.png         the vesicle, coloured by mean curvature, beside its spectrum
    vesicle.psf, .xtc   the trajectory of stage 3 as a wire mesh:  vmd vesicle.psf vesicle.xtc
    vesicle.data        the same wire mesh for OVITO: open it, add "Load trajectory", vesicle.xtc
    vesicle.ply         the last mesh
    vesicle.chk         a checkpoint of the end, for Simulation.loadCheckpoint
    vesicle.csv         energies per term, temperature, area, volume … over stage 3
    spectrum.csv        the spectra with error bars and theory
"""

import argparse
import csv
import math
import sys
import time
from pathlib import Path

import numpy as np
import openmm
from openmm import app, unit
from openmmhelfrich.analysis import mode_amplitudes, spectrum, theory
from openmmhelfrich.mesh import Mesh
from openmmhelfrich.vesicle import KBT, Vesicle
from openmmhelfrich.wireframe import write_lammps_data, write_psf
from tqdm import tqdm
from vesicle_picture import draw

TEMPERATURE = 300.0  # K
FRICTION = 0.01  # 1/ps
SPECTRUM_FRICTION = 0.001  # 1/ps
RADIUS = 1000.0  # nm

# OpenMM's default of 10 kJ/mol/nm is meant for atoms; the forces on these vertices are below it.
FORCE_TOLERANCE = 0.01  # kJ/mol/nm

LMAX = 12
QUADRATURES = ("surface", "vertices")


def main(arguments=None):
    options = parse(arguments)
    try:
        run(options)
    except KeyboardInterrupt:
        sys.exit("vesicle: interrupted; what was written so far is in " + str(options.out))
    except (openmm.OpenMMException, OSError, RuntimeError, ValueError) as error:
        sys.exit(f"vesicle: {error}")


def parse(arguments):
    parser = argparse.ArgumentParser(
        description="Simulate the vesicle of doi:10.1103/PhysRevE.108.015301 and measure its "
        "fluctuation spectrum.",
    )
    length = parser.add_mutually_exclusive_group()
    length.add_argument("--time", type=float, help="length of the run, ps (default: 2 τ_2)")
    length.add_argument("--steps", type=int, help="the same in time steps")
    parser.add_argument(
        "--spectrum-time",
        type=float,
        default=70_000,
        help="length of the measurement of the spectrum, ps (default: %(default)g); "
        "error bars shrink with its square root",
    )
    parser.add_argument(
        "--time-step", type=float, default=0.2, help="ps (default: %(default)g, the paper's)"
    )
    parser.add_argument("--vertices", type=int, default=1002, help="default: %(default)d")
    parser.add_argument("--softness", type=float, default=0.037, help="Ξ (default: %(default)g)")
    parser.add_argument("--seed", type=int, default=1, help="of mesh and noise (default: 1)")
    parser.add_argument("--out", type=Path, default=Path("out/vesicle"), help="output folder")
    parser.add_argument(
        "--platform",
        help="OpenMM platform (default: the fastest one for membranes, which is Helfrich)",
    )
    parser.add_argument("--quick", action="store_true", help="a few seconds, to see that it works")
    options = parser.parse_args(arguments)
    for name in ("time", "steps", "spectrum_time", "time_step", "vertices"):
        value = getattr(options, name)
        if value is not None and not value > 0:
            parser.error(f"--{name.replace('_', '-')}: need more than 0, got {value}")
    if options.quick:
        options.vertices = min(options.vertices, 252)
        options.spectrum_time = min(options.spectrum_time, 2000)
        if options.time is None and options.steps is None:
            options.steps = 2000
    return options


def run(options):
    started = time.perf_counter()
    options.out.mkdir(parents=True, exist_ok=True)
    mesh = Mesh.random_sphere(options.vertices, RADIUS, options.seed)
    vesicle = Vesicle(mesh, softness=options.softness)
    describe(vesicle, options)
    integrator = openmm.LangevinMiddleIntegrator(TEMPERATURE, SPECTRUM_FRICTION, options.time_step)
    integrator.setRandomNumberSeed(options.seed)
    simulation = vesicle.simulation(integrator, options.platform)
    print(f"  on OpenMM's platform {simulation.context.getPlatform().getName()}")

    title("1. Relax the generated mesh")
    show_energies("before", vesicle.energies(simulation.context))
    simulation.minimizeEnergy(tolerance=FORCE_TOLERANCE)
    show_energies("after", vesicle.energies(simulation.context))
    simulation.context.setVelocitiesToTemperature(TEMPERATURE, options.seed)

    title("2. Measure the spectrum: permeable membrane, kV = 0")
    set_volume_term(vesicle, simulation.context, modulus=0, target=vesicle.volume)
    measured = measure_spectrum(vesicle, simulation, options)
    show_spectrum(measured, vesicle)
    write_spectrum(options.out / "spectrum.csv", measured, vesicle)

    title("3. Run: sealed membrane, kV = 0.04 kJ/mol/nm³")
    volume = current_mesh(mesh, simulation.context).volume
    set_volume_term(vesicle, simulation.context, vesicle.volume_modulus, volume)
    integrator.setFriction(FRICTION)
    last = produce(vesicle, simulation, options)

    last.write(options.out / "vesicle.ply")
    simulation.saveCheckpoint(str(options.out / "vesicle.chk"))
    draw(options.out / "vesicle.png", last, measured, vesicle)
    print(f"\nWrote {options.out}/ in {time.perf_counter() - started:.0f} s:")
    for path in sorted(options.out.iterdir()):
        print(f"  {path.name:14s} {path.stat().st_size / 1024:8.0f} KB")


# --- the vesicle -----------------------------------------------------------------------------


def describe(vesicle, options):
    print(f"Vesicle of {vesicle.mesh.num_vertices} vertices, radius {vesicle.radius:.0f} nm")
    print(f"  rigidity {vesicle.rigidity / KBT:.3g} kBT, softness {vesicle.softness:g}, "
          f"least height {vesicle.min_height:.1f} nm")  # fmt: skip
    print(f"  slowest period τ_2 = {vesicle.tau_2:.0f} ps, time step {options.time_step:g} ps "
          f"(limit about {vesicle.max_time_step:.2f} ps)")  # fmt: skip


def set_volume_term(vesicle, context, modulus, target):
    """Change kV and V0 in the running Context."""
    force = vesicle.placement.volume
    force.setModulus(modulus)
    force.setTarget(target)
    force.updateParametersInContext(context)


def positions_of(context):
    state = context.getState(getPositions=True)
    return state.getPositions(asNumpy=True).value_in_unit(unit.nanometer)


def current_mesh(mesh, context):
    return Mesh(positions_of(context), mesh.triangles)


class Observer:
    """Reads energies, temperature and shape, and notices a run that went wrong."""

    COLUMNS = (
        "step",
        "time_ps",
        "area_energy_kJ/mol",
        "volume_energy_kJ/mol",
        "bending_energy_kJ/mol",
        "heights_energy_kJ/mol",
        "kinetic_energy_kJ/mol",
        "temperature_K",
        "area_nm2",
        "volume_nm3",
        "reduced_volume",
        "steps_per_second",
    )

    def __init__(self, vesicle, simulation):
        self.vesicle = vesicle
        self.simulation = simulation
        self.time_step = simulation.integrator.getStepSize().value_in_unit(unit.picosecond)
        self.started = time.perf_counter()
        self.first_step = simulation.currentStep

    def row(self):
        """One value for each of COLUMNS."""
        context = self.simulation.context
        state = context.getState(getEnergy=True)
        kinetic = state.getKineticEnergy().value_in_unit(unit.kilojoule_per_mole)
        mesh = self.vesicle.mesh
        temperature = 2 * kinetic / (3 * mesh.num_vertices * theory.BOLTZMANN)
        # A blown-up mesh may fail to be a mesh at all, so look at the temperature first.
        if not temperature < 2 * TEMPERATURE:
            raise RuntimeError(
                f"the run failed at step {self.simulation.currentStep}: the temperature is "
                f"{temperature:.3g} K in place of {TEMPERATURE:.0f} K. A shorter --time-step "
                f"helps; {self.vesicle.max_time_step:.2f} ps is about the limit."
            )
        now = current_mesh(mesh, context)
        energies = self.vesicle.energies(context)
        steps = self.simulation.currentStep - self.first_step
        return (
            self.simulation.currentStep,
            self.simulation.currentStep * self.time_step,
            *(energies[name] for name in ("area", "volume", "bending", "heights")),
            kinetic,
            temperature,
            now.area,
            now.volume,
            now.reduced_volume,
            steps / (time.perf_counter() - self.started),
        )


def advance(simulation, steps, interval, label):
    """Make `steps` steps under a progress bar, yielding the bar every `interval` steps."""
    with tqdm(total=steps, desc=label, unit=" steps", unit_scale=True, leave=True) as bar:
        done = 0
        while done < steps:
            count = min(interval, steps - done)
            try:
                simulation.step(count)
            except (openmm.OpenMMException, ValueError) as error:
                raise RuntimeError(
                    f"the run failed within {count} steps after step {done} of this stage: "
                    f"{str(error).rstrip('.')}. A shorter --time-step may help."
                ) from error
            done += count
            bar.update(count)
            yield bar


# --- stage 2 ---------------------------------------------------------------------------------


def measure_spectrum(vesicle, simulation, options):
    """The spectrum of the vesicle in its present state, after it has come to equilibrium."""
    observer = Observer(vesicle, simulation)
    # The slow modes start from zero and reach equilibrium within a few times 2/γ.
    settle = int(min(5 * 2 / SPECTRUM_FRICTION, options.spectrum_time / 4) / options.time_step)
    for bar in advance(simulation, settle, 2500, "  settle "):
        bar.set_postfix_str(summary(observer.row()))
    steps = int(options.spectrum_time / options.time_step)
    # 250 ps are short against the memory of the slow modes, which need the samples most.
    interval = max(1, min(int(250 / options.time_step), steps // 20))
    frames, rows = [], []
    for bar in advance(simulation, steps, interval, "  measure"):
        frames.append(positions_of(simulation.context))
        if len(frames) % 4 == 1:
            rows.append(observer.row())
            bar.set_postfix_str(summary(rows[-1]))
    show_means(np.array(rows))
    triangles = vesicle.mesh.triangles
    return {
        name: spectrum(mode_amplitudes(np.array(frames), triangles, LMAX, name))
        for name in QUADRATURES
    }


def show_spectrum(measured, vesicle):
    """The measured spectra over theory, which is 1 ± its error bar if they agree."""
    print("   l   theory (A17)   surface/theory   vertices/theory   (± standard error)")
    for l in range(2, 9):
        expected = theory.fluid_spectrum(l, vesicle.rigidity / KBT)
        ratios = (
            f"{found.mean[l] / expected:.2f} ± {found.error[l] / expected:.2f}"
            for found in (measured[name] for name in QUADRATURES)
        )
        print(f"  {l:2d}      {expected:.3e}      " + "      ".join(ratios))
    print("  (runs of 1 µs have 0.83 ± 0.04 for l = 2: the mesh keeps a small shear modulus)")


def write_spectrum(path, measured, vesicle):
    with path.open("w", newline="", encoding="utf-8") as file:
        rows = csv.writer(file)
        columns = [f"{name}_{what}" for name in QUADRATURES for what in ("mean", "error")]
        rows.writerow(["l", "theory_A17", *columns])
        for l in range(2, LMAX + 1):
            expected = theory.fluid_spectrum(l, vesicle.rigidity / KBT)
            values = [
                values[l]
                for name in QUADRATURES
                for values in (measured[name].mean, measured[name].error)
            ]
            rows.writerow([l, expected, *values])


# --- stage 3 ---------------------------------------------------------------------------------


def produce(vesicle, simulation, options):
    """The run that is written to disk; returns the last mesh."""
    if options.steps is not None:
        steps = options.steps
    else:
        length = 2 * vesicle.tau_2 if options.time is None else options.time
        steps = math.ceil(length / options.time_step)
    interval = max(1, min(int(100 / options.time_step), steps // 20))
    simulation.currentStep = 0
    simulation.context.setTime(0)
    topology, system = simulation.topology, simulation.system
    # Nothing here is periodic, but OVITO refuses a trajectory without a box.
    box = 4 * RADIUS * np.eye(3)
    topology.setPeriodicBoxVectors(box * unit.nanometer)
    simulation.context.setPeriodicBoxVectors(*box)
    write_psf(options.out / "vesicle.psf", topology, system)
    write_lammps_data(
        options.out / "vesicle.data", topology, system, positions_of(simulation.context)
    )
    simulation.reporters.append(
        app.XTCReporter(str(options.out / "vesicle.xtc"), interval, enforcePeriodicBox=False)
    )
    observer = Observer(vesicle, simulation)
    rows = []
    with (options.out / "vesicle.csv").open("w", newline="", encoding="utf-8") as file:
        log = csv.writer(file)
        log.writerow(observer.COLUMNS)
        for bar in advance(simulation, steps, interval, "  run    "):
            rows.append(observer.row())
            log.writerow(rows[-1])
            bar.set_postfix_str(summary(rows[-1]))
    simulation.reporters.clear()
    show_means(np.array(rows))
    return current_mesh(vesicle.mesh, simulation.context)


# --- what is printed -------------------------------------------------------------------------


def title(text):
    print(f"\n{text}")


def summary(row):
    values = dict(zip(Observer.COLUMNS, row, strict=True))
    return f"T = {values['temperature_K']:.0f} K, v = {values['reduced_volume']:.4f}"


def show_energies(label, energies):
    terms = ", ".join(f"{name} {energy:.1f}" for name, energy in energies.items())
    print(f"  {label + ':':8s}{terms} kJ/mol")


def show_means(rows):
    """Mean and spread of every logged quantity."""
    for name, column in zip(Observer.COLUMNS[2:-1], rows.T[2:-1], strict=True):
        quantity, _, dimension = name.rpartition("_")
        if name == "reduced_volume":
            quantity, dimension = name, ""
        dimension = dimension.replace("nm2", "nm²").replace("nm3", "nm³")
        print(f"  {quantity.replace('_', ' '):15s} {column.mean():14.6g} ± {column.std():.2g} "
              f"{dimension}")  # fmt: skip
    print(f"  {'speed':15s} {rows[-1, -1]:14.0f} steps/s")


if __name__ == "__main__":
    main()

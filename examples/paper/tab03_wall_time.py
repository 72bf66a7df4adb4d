"""Table III, Eqs. 47 and 48: run time and energy of 10 τ_2, sampled every τ_2, and how they grow.

The runs are those of `benches/table3.py`, N = 252, 1002 and 4002, with LangevinMiddle and all cores
of this machine; they are not spread by Dask nor stored, because timings belong to the machine and
to the moment. With --quick they are a hundredth as long, and times are extrapolated.

The energy is that of the processor's package, as its counters in /sys/class/powercap have it (RAPL,
which takes the right to read them), or else the run time times --watts, the thermal design power:
for the whole package, however many of its cores are used. The paper's is that of its two cards.

The slowest mode has τ_2, the fastest τ = τ_2 √24 / N, and steps are 0.1 √Ξ τ: so a τ_2 takes
N / (0.1 √24 √Ξ) steps, each a time in proportion to N, and the run time grows with N².
"""

import argparse
import sys
import time
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from _paper import Figure

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "benches"))

POWERCAP = Path("/sys/class/powercap")
CARD_WATTS = (250, 450)
CARDS = ("paper, 3000 cores", "paper, 16 000 cores")
JOULES_PER_KWH = 3.6e6


class Meter:
    """What the packages of the processor take, J, by their RAPL counters or by an assumed power.

    Parameters
    ----------
    watts : float
        Thermal design power, W, where counters cannot be read.
    folder : Path
        Of the counters.
    """

    def __init__(self, watts, folder=POWERCAP):
        self._watts = watts
        # Packages are intel-rapl:0, :1 …, on AMD's processors too; intel-rapl:0:0 is a part of one.
        zones = [zone for zone in folder.glob("*-rapl:*") if zone.name.count(":") == 1]
        self._zones = [zone for zone in sorted(zones) if _counter(zone) is not None]

    @property
    def measures(self):
        """Whether there are counters."""
        return bool(self._zones)

    @property
    def source(self):
        """From what the energy is known, as text."""
        if self.measures:
            return f"measured by the RAPL counters of {len(self._zones)} package(s)"
        return f"at a thermal design power of {self._watts:g} W (no RAPL counter can be read)"

    def start(self):
        """Begin."""
        self._begin = time.perf_counter(), [_counter(zone) for zone in self._zones]

    def watts(self):
        """The mean power since `start`, W; within that time a counter may start anew once."""
        if not self.measures:
            return self._watts
        begin, counters = self._begin
        joules = 0.0
        for zone, before in zip(self._zones, counters, strict=True):
            span = int((zone / "max_energy_range_uj").read_text())
            joules += (_counter(zone) - before) % span * 1e-6
        return joules / (time.perf_counter() - begin)


def _counter(zone):
    """Energy of a zone, µJ, or None if it cannot be read."""
    try:
        return int((zone / "energy_uj").read_text())
    except (OSError, ValueError):
        return None


def watts_given():
    """--watts, and what is left of the command line."""
    parser = argparse.ArgumentParser(add_help=False)
    parser.add_argument("--watts", type=float, default=225.0)
    options, rest = parser.parse_known_args()
    if not options.watts > 0:
        parser.error(f"--watts: need a power above 0, got {options.watts:g}")
    return options.watts, rest


def main():
    import os

    import openmm
    from openmmhelfrich import Mesh, Vesicle
    from openmmhelfrich._benchmark import machine
    from table3 import FRICTION, TABLE, TEMPERATURE, TIME_STEP, clock, platform_named, run

    watts, rest = watts_given()
    figure = Figure("tab03", "Table III", "Run time and energy of 10 τ_2", __doc__, rest)
    if figure.plot_only:
        sys.exit("tab03: timings are not stored; run it without --plot-only")
    meter = Meter(watts)
    platform = platform_named(None)
    threads = str(os.cpu_count() or 1)
    properties = {"Threads": threads} if "Threads" in platform.getPropertyNames() else {}
    figure.parameters(
        f"r0 = 1000 nm, κ = 20 kBT, Ξ = 0.037, Jülicher, LangevinMiddle, γ = {FRICTION:g}/ps, "
        f"Δt = {TIME_STEP:g} ps, {TEMPERATURE:g} K; platform {platform.getName()}, {threads} "
        "threads; " + ", ".join(f"{name}: {value}" for name, value in machine().items()) + ". "
        f"Energy {meter.source}."
    )
    rows = []
    for num_vertices, (parts, cards, _) in TABLE.items():
        integrator = openmm.LangevinMiddleIntegrator(TEMPERATURE, FRICTION, TIME_STEP)
        meter.start()
        seconds, steps, temperature = run(
            num_vertices, integrator, platform, properties, figure.quick
        )
        power = meter.watts()
        vesicle = Vesicle(Mesh.icosphere(parts, 1000.0))
        rows.append(Row(num_vertices, seconds, steps, power, cards, vesicle))
        figure.spent(seconds / (100 if figure.quick else 1))
        figure.claim(
            f"run time, N = {num_vertices}, {steps} steps",
            f"{clock(seconds)}, {1e6 * seconds / steps:.1f} µs a step, {temperature:.0f} K",
            f"less than the {clock(cards[0])} and {clock(cards[1])} of the paper's graphics cards",
            seconds < min(cards),
        )
        papers = [second * w / JOULES_PER_KWH for second, w in zip(cards, CARD_WATTS, strict=True)]
        figure.claim(
            f"energy, N = {num_vertices}",
            f"{rows[-1].kwh:.3g} kWh, {power:.0f} W",
            f"less than the {papers[0]:.3g} and {papers[1]:.3g} kWh of the paper's graphics cards",
            rows[-1].kwh < min(papers),
        )
    scaling(figure, rows)
    draw(figure, rows)
    figure.finish()


class Row:
    """One line of the table."""

    def __init__(self, num_vertices, seconds, steps, power, cards, vesicle):
        self.num_vertices, self.seconds, self.steps, self.cards = (
            num_vertices,
            seconds,
            steps,
            cards,
        )
        self.kwh = seconds * power / JOULES_PER_KWH
        self.step = seconds / steps
        self.vesicle = vesicle


def exponent(sizes, values):
    """Return x of values that grow as N^x, by least squares of logarithms."""
    return float(np.polyfit(np.log(sizes), np.log(values), 1)[0])


def scaling(figure, rows):
    """Eqs. 47 and 48: steps of a τ_2, and how the time of a run grows with N."""
    from openmmhelfrich.analysis import theory

    for row in rows:
        vesicle, count = row.vesicle, row.num_vertices
        fastest = theory.mode_period(
            count**0.5, float(vesicle.rigidity), vesicle.mass, count, vesicle.radius
        )
        figure.check(
            f"τ_2 in periods of l = √N by (A30), over N/√24, N = {count}",
            vesicle.tau_2 / fastest / (count / 24**0.5),
            1,
            0.07,
        )
        figure.check(
            f"steps of 0.1 √Ξ τ in a τ_2, over N, N = {count}",
            vesicle.tau_2 / vesicle.max_time_step / count,
            10 / (24 * vesicle.softness) ** 0.5,
            0.02,
        )
    sizes = [row.num_vertices for row in rows]
    steps = [row.step for row in rows]
    longest = [row.step * row.vesicle.tau_2 / row.vesicle.max_time_step for row in rows]
    fixed = [row.seconds for row in rows]
    for what, values, expected in (
        ("time of a step grows as N^x, x", steps, 1),
        ("wall time of 10 τ_2 at one Δt grows as N^x, x", fixed, 1.5),
        ("wall time of a τ_2 in steps of 0.1 √Ξ τ grows as N^x, x", longest, 2),
    ):
        figure.check(what, exponent(sizes, values), expected, 0.2)


def draw(figure, rows):
    sizes = [row.num_vertices for row in rows]
    here = [[row.seconds for row in rows], [row.kwh for row in rows]]
    papers = [
        [[row.cards[card] * factors[card] for row in rows] for card in (0, 1)]
        for factors in ((1, 1), [watts / JOULES_PER_KWH for watts in CARD_WATTS])
    ]
    page, axes = plt.subplots(1, 2, figsize=(9, 3.6), layout="constrained")
    for axis, ours, theirs, label in zip(
        axes, here, papers, ("run time of 10 τ_2 (s)", "energy of 10 τ_2 (kWh)"), strict=True
    ):
        axis.plot(sizes, ours, "o-", label="this library, on the processor")
        for values, name, marker in zip(theirs, CARDS, "s^", strict=True):
            axis.plot(sizes, values, f"{marker}-", label=name)
        axis.set(xscale="log", yscale="log", xlabel="N", ylabel=label)
        axis.set_xticks(sizes, [f"{size:d}" for size in sizes])
        axis.minorticks_off()
    axes[0].legend(fontsize=8)
    figure.save(page, caption="Run time and energy of 10 τ_2, here and on the paper's cards")


if __name__ == "__main__":
    main()

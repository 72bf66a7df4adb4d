"""Table III: wall time of 10 τ_2, sampled every τ_2, at N = 252, 1002 and 4002.

The runs are those of `benches/table3.py`, with LangevinMiddle and all cores of this machine; they
are not spread by Dask nor stored, because timings belong to the machine and to the moment. With
--quick they are a hundredth as long, and times are extrapolated.
"""

import sys
from pathlib import Path

import matplotlib.pyplot as plt
from _paper import Figure

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "benches"))


def main():
    import os

    import openmm
    from openmmhelfrich._benchmark import machine
    from table3 import FRICTION, TABLE, TEMPERATURE, TIME_STEP, clock, platform_named, run

    figure = Figure("tab03", "Table III", "Wall time of 10 τ_2", __doc__)
    if figure.plot_only:
        sys.exit("tab03: timings are not stored; run it without --plot-only")
    platform = platform_named(None)
    threads = str(os.cpu_count() or 1)
    properties = {"Threads": threads} if "Threads" in platform.getPropertyNames() else {}
    figure.parameters(
        f"r0 = 1000 nm, κ = 20 kBT, Ξ = 0.037, Jülicher, LangevinMiddle, γ = {FRICTION:g}/ps, "
        f"Δt = {TIME_STEP:g} ps, {TEMPERATURE:g} K; platform {platform.getName()}, {threads} "
        "threads; " + ", ".join(f"{name}: {value}" for name, value in machine().items()) + "."
    )
    rows = []
    for num_vertices, (_, cards, _) in TABLE.items():
        integrator = openmm.LangevinMiddleIntegrator(TEMPERATURE, FRICTION, TIME_STEP)
        seconds, steps, temperature = run(
            num_vertices, integrator, platform, properties, figure.quick
        )
        rows.append((num_vertices, seconds, *cards))
        figure.spent(seconds / (100 if figure.quick else 1))
        figure.claim(
            f"N = {num_vertices}, {steps} steps",
            f"{clock(seconds)}, {1e6 * seconds / steps:.1f} µs a step, {temperature:.0f} K",
            f"less than the {clock(cards[0])} and {clock(cards[1])} of the paper's graphics cards",
            seconds < min(cards),
        )
    draw(figure, rows)
    figure.finish()


def draw(figure, rows):
    sizes, *times = zip(*rows, strict=True)
    page, axis = plt.subplots(figsize=(5, 3.6), layout="constrained")
    labels = ("this library, on the processor", "paper, 3000 cores", "paper, 16 000 cores")
    for seconds, label, marker in zip(times, labels, "os^", strict=True):
        axis.plot(sizes, seconds, f"{marker}-", label=label)
    axis.set(xscale="log", yscale="log", xlabel="N", ylabel="wall time of 10 τ_2 (s)")
    axis.set_xticks(sizes, [f"{size:d}" for size in sizes])
    axis.minorticks_off()
    axis.legend()
    figure.save(page, caption="Wall time of 10 τ_2 here and on the paper's graphics cards")


if __name__ == "__main__":
    main()

"""Fig. 5: how long Newtonian dynamics runs before it fails, against the time step.

Verlet dynamics of the four bending models on a hard (Ξ = 0.59) and on a soft mesh (Ξ = 0.037), five
random meshes for each point, and one icosphere as a second curve. Time steps are given in units of
√Ξ τ, where τ is the period of the fastest mode of the mesh. A run fails when its energy has risen
by half, or when its kinetic energy has doubled; both times are recorded. Runs that live are ended
after DURATION, or after a number of steps where these are short.
"""

from typing import NamedTuple

import matplotlib.pyplot as plt
import numpy as np
from _paper import SCHEMES, Figure
from newtonian import failing_run

SOFTNESSES = (0.59, 0.037)
BARYCENTRIC = ("Julicher", "GompperKrollBarycentric")
VORONOI = tuple(scheme for scheme in SCHEMES if scheme not in BARYCENTRIC)
CRITERIA = {"energy": "energy up by half", "kinetic": "kinetic energy doubled"}
ALLOWED = 0.1
# Looks at the energies in a time of √Ξ τ.
LOOKS = 2
COUNT = 1002


class Size(NamedTuple):
    """How much is run."""

    fractions: list  # time steps, √Ξ τ
    seeds: int
    duration: float  # τ_2
    steps: int  # of a run with a time step below ALLOWED
    failing: int  # of one that should fail


FULL = Size([0.001, 0.003, 0.01, 0.03, 0.1, 0.2, 0.3, 0.5, 1.0], 5, 30.0, 60_000, 300_000)
QUICK = Size([0.03, 0.1, 1.0], 1, 1.0, 8_000, 10_000)


def points_of(size):
    """The points of the sweep; τ_2 = τ N / √24."""
    points = []
    for mesh, seeds in (("random", size.seeds), ("ordered", 1)):
        for softness in SOFTNESSES:
            for scheme in SCHEMES:
                for fraction in size.fractions:
                    fails = softness < 0.1 and scheme in VORONOI
                    steps = size.failing if fails else size.steps
                    longest = steps * fraction * softness**0.5 * 24**0.5 / COUNT
                    duration = size.duration
                    if fraction < ALLOWED:
                        duration = min(duration, float(f"{longest:.3g}"))
                    point = {"mesh": mesh, "scheme": scheme, "softness": softness}
                    point |= {"fraction": fraction, "num_vertices": COUNT, "looks": LOOKS}
                    points += [
                        {**point, "duration": duration, "seed": seed}
                        for seed in range(1, seeds + 1)
                    ]
    return points


class Life(NamedTuple):
    """The runs of one point."""

    times: dict  # median time to failure by each criterion, or that simulated, τ_2
    alive: int  # runs that failed by neither
    runs: int
    lived: float  # shortest time that was simulated, τ_2

    @property
    def median(self):
        """The earlier of the two times, τ_2."""
        return min(self.times.values())

    @property
    def all_alive(self):
        """Whether no run failed."""
        return self.alive == self.runs


def life_of(results):
    """What the runs of one point say."""
    times = {
        name: float(np.median([r["lived"] if r[name] is None else r[name] for r in results]))
        for name in CRITERIA
    }
    alive = sum(all(result[name] is None for name in CRITERIA) for result in results)
    return Life(times, alive, len(results), min(result["lived"] for result in results))


def main():
    figure = Figure("fig05", "Fig. 5", "Runtime to failure of Newtonian dynamics", __doc__)
    size = figure.choose(FULL, QUICK)
    points = points_of(size)
    results = figure.sweep(failing_run, points, description="runs")
    lives, units = {}, {}
    for point, result in zip(points, results, strict=True):
        units[point["softness"]] = result["unit"]
        key = point["mesh"], point["scheme"], point["softness"], point["fraction"]
        lives.setdefault(key, []).append(result)
    both = [r for r in results if all(r[name] is not None for name in CRITERIA)]
    lives = {key: life_of(found) for key, found in lives.items()}
    figure.parameters(
        f"{size.seeds} random meshes of N = {COUNT} for each point and one icosphere, κ = 20 kBT, "
        "kA and kV of the paper, Verlet from velocities of 300 K, at most "
        f"{size.duration:g} τ_2 (below {ALLOWED:g} √Ξ τ at most {size.steps} steps, or "
        f"{size.failing} of models that fail); "
        + ", ".join(f"√Ξ τ = {units[xi]:.1f} ps at Ξ = {xi:g}" for xi in SOFTNESSES)
        + "."
    )
    figure.check("√Ξ τ at Ξ = 0.037", units[0.037], 10.8, 0.1, unit=" ps")
    for mesh in ("random", "ordered"):
        check_alive(figure, mesh, lives, size)
        check_failing(figure, mesh, lives, size)
    check_criteria(figure, both)
    tabulate(figure, lives, size)
    draw(figure, lives, size)
    figure.finish()


def check_alive(figure, mesh, lives, size):
    allowed = [fraction for fraction in size.fractions if fraction <= ALLOWED]
    for softness, schemes in ((0.59, SCHEMES), (0.037, BARYCENTRIC)):
        for scheme in schemes:
            found = [lives[mesh, scheme, softness, fraction] for fraction in allowed]
            alive, runs = sum(life.alive for life in found), sum(life.runs for life in found)
            figure.claim(
                f"{mesh}, Ξ = {softness:g}, {SCHEMES[scheme]}: alive at Δt ≤ {ALLOWED:g} √Ξ τ",
                f"{alive} of {runs} runs, {len(allowed)} time steps",
                "all",
                alive == runs,
            )
    for softness in SOFTNESSES:
        largest = max(size.fractions)
        alive = sum(lives[mesh, scheme, softness, largest].alive for scheme in SCHEMES)
        figure.claim(
            f"{mesh}, Ξ = {softness:g}: runs alive at Δt = {largest:g} √Ξ τ",
            f"{alive}",
            "none",
            alive == 0,
        )


def check_failing(figure, mesh, lives, size):
    """Orders of magnitude between the models on soft meshes, at each time step by itself."""
    allowed = [fraction for fraction in size.fractions if fraction <= ALLOWED]
    least = figure.choose(100, 10)
    barycentric = {f: [lives[mesh, one, 0.037, f] for one in BARYCENTRIC] for f in allowed}
    for scheme in VORONOI:
        found = {fraction: lives[mesh, scheme, 0.037, fraction] for fraction in allowed}
        failed = {f: life.median for f, life in found.items() if life.alive == 0}
        # How much longer barycentric models were followed without failing.
        longer = {
            f: min(life.lived if life.all_alive else 0.0 for life in barycentric[f]) / time
            for f, time in failed.items()
        }
        good = [f for f, share in longer.items() if share >= least]
        reasons = []
        if len(failed) < len(allowed):
            alive = ", ".join(f"{f:g}" for f in allowed if f not in failed)
            reasons.append(f"at Δt = {alive} √Ξ τ some were alive after {size.failing} steps")
        if short := [f for f in failed if f not in good]:
            steps = ", ".join(f"{f:g}" for f in short)
            shares = ", ".join(f"{longer[f]:.2g}" for f in short)
            reasons.append(
                f"at Δt = {steps} √Ξ τ barycentric models were followed for {shares} times that "
                "time only"
            )
        figure.claim(
            f"{mesh}, Ξ = 0.037, {SCHEMES[scheme]}: fails at every Δt ≤ {ALLOWED:g} √Ξ τ",
            f"at {len(failed)} of {len(allowed)} time steps" + _range_of(failed, longer),
            f"at all, {least} times sooner or more",
            len(good) == len(allowed),
            "runs are short: " + "; ".join(reasons),
        )


def _range_of(failed, longer):
    """Times to failure and by how much longer others lived, in words."""
    if not failed:
        return ""
    times, shares = sorted(failed.values()), sorted(longer.values())
    return (
        f", after {times[0]:.2g} to {times[-1]:.2g} τ_2; barycentric models were followed there "
        f"for {shares[0]:.2g} to {shares[-1]:.0f} times that time without failing"
    )


def check_criteria(figure, both):
    """Whether the two criteria tell the same story."""
    ratios = [max(r["energy"], r["kinetic"]) / min(r["energy"], r["kinetic"]) for r in both]
    figure.claim(
        f"times by the two criteria, larger over smaller, of {len(ratios)} runs that failed",
        f"median {np.median(ratios):.2f}, nine tenths up to {np.percentile(ratios, 90):.2f}",
        "nine tenths within a factor of two",
        np.percentile(ratios, 90) < 2,
    )


def tabulate(figure, lives, size):
    for mesh in ("random", "ordered"):
        rows = []
        for softness in SOFTNESSES:
            for fraction in size.fractions:
                cells = []
                for scheme in SCHEMES:
                    life = lives[mesh, scheme, softness, fraction]
                    if life.all_alive:
                        cells.append(f"> {life.lived:.3g}")
                    else:
                        times = " / ".join(f"{time:.3g}" for time in life.times.values())
                        cells.append(times + (f" ({life.alive} alive)" if life.alive else ""))
                rows.append([f"{softness:g}", f"{fraction:g}", *cells])
        figure.table(
            f"Median time to failure, τ_2, {mesh} meshes: {' / '.join(CRITERIA.values())}:",
            ["Ξ", "Δt / √Ξ τ", *SCHEMES.values()],
            rows,
        )


def draw(figure, lives, size):
    graph, axes = plt.subplots(1, 2, figsize=(9, 3.8), sharey=True, layout="constrained")
    for axis, softness in zip(axes, SOFTNESSES, strict=True):
        for place, (scheme, label) in enumerate(SCHEMES.items()):
            for mesh, style in (("random", "-"), ("ordered", ":")):
                found = [lives[mesh, scheme, softness, fraction] for fraction in size.fractions]
                # Curves that coincide are moved apart a little.
                x = np.array(size.fractions) * 1.05**place
                named = label if mesh == "random" else None
                color = f"C{place}"
                axis.loglog(x, [life.median for life in found], style, color=color, label=named)
                for here, life in zip(x, found, strict=True):
                    axis.plot(here, life.median, "^" if life.all_alive else "x", color=color, ms=4)
        axis.axvline(ALLOWED, color="gray", lw=0.8, ls=":")
        axis.set(xlabel="Δt / √Ξ τ", title=f"Ξ = {softness:g}")
    axes[0].set_ylabel("runtime to failure / τ_2")
    axes[0].legend(fontsize=7)
    caption = "Median time to failure; lines: random meshes, dotted: icosphere; triangles: alive."
    figure.save(graph, "", caption)


if __name__ == "__main__":
    main()

"""Cost of a time step: our platforms and integrators against everything else, as meshes grow.

All sides have the vesicle of the paper (doi:10.1103/PhysRevE.108.015301): Jülicher bending, global
area, global volume, triangle heights, on icospheres whose triangles have always the same size. They
are raced against the cheapest x, y, z string forces that we know, against jax-md where it is
installed, and against OpenMM's empty step, which is what OpenMM takes for itself. Every figure is
the minimum of several runs, taken in turns so that a slow spell of the machine does not hit one
side alone. What `cargo bench` has measured before (`make bench` does) is printed with it.

    python benches/steps.py [--quick] [--output docs/benchmarks.md] [--jax-python PYTHON]
"""

import argparse
import os
from pathlib import Path

import memory
import report
from competitors import with_jax, with_rust
from openmmhelfrich._benchmark import targets
from race import MOST_VERTICES, Results, race
from turns import add_options

# Parts of a side of the icosahedron: N = 252, 1002, 4002, 10 242, 40 962, 163 842, 998 562.
PARTS = (5, 10, 20, 32, 64, 128, 316)


def main(arguments=None):
    """Measure, print, and write what was asked for."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument(
        "--parts", type=int, nargs="+", default=PARTS,
        help="parts of a side of the icosahedron, N = 10 n² + 2 (default: %(default)s)",
    )  # fmt: skip
    add_options(parser, repeats=5)
    parser.add_argument(
        "--platform", action="append", help="only these of OpenMM's platforms; may be repeated"
    )
    parser.add_argument("--no-memory", action="store_true", help="do not measure memory")
    parser.add_argument("--output", type=Path, help="a Markdown file; a plot goes beside it")
    parser.add_argument(
        "--quick", action="store_true", help="two short runs each of two small meshes: a smoke test"
    )
    options = parser.parse_args(arguments)
    options.most_vertices = MOST_VERTICES
    options.load = os.getloadavg()[0]
    if options.quick:
        options.parts, options.repeats, options.seconds = PARTS[:2], 2, 0.03
        options.most_vertices = dict.fromkeys(MOST_VERTICES, 252)
    jax = with_jax.jax_versions(options.jax_python)
    if jax is None:
        options.jax_python = None

    found, failed = targets(options.platform)
    if not found:
        parser.error("; ".join(f"{name}: {reason}" for name, reason in failed.items()))
    results = Results()
    for parts in sorted(options.parts):
        race(parts, found, results, options)
    used = None
    if not options.no_memory:
        # The fastest of our platforms, on the largest mesh.
        n = results.sizes[-1]
        _, row = results.best("ours", "Verlet", n)
        target = next(target for target in found if target.label == row.place)
        used = memory.measure(max(options.parts), target), n, target.label
    text = report.compose(results, options, failed, jax, used, with_rust.read())
    print(text)
    if options.output:
        report.save(text, results, options.output)
        print(f"wrote {options.output} and {options.output.with_suffix('.png')}")


if __name__ == "__main__":
    main()

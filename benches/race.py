"""Steps of all sides on one mesh: what `steps.py` calls for each size."""

from dataclasses import dataclass, field

import openmm
from competitors import with_jax, with_strings
from openmmhelfrich import Vesicle
from openmmhelfrich._benchmark import INTEGRATORS, empty_system, sphere, start
from turns import energy, measure, say

# The sides of the race, as tables call them.
SIDES = {
    "empty": "OpenMM's empty step",
    "ours": "openmm-helfrich",
    "strings": "x, y, z string forces",
    "jax": "jax-md",
}
# Largest N at which a side takes part: above, a run of enough steps would take many minutes, and
# the cost per vertex is known. Tables say where a side is left out.
MOST_VERTICES = {"strings": 10_242, "jax": 40_962}
# Up to here all Contexts live at once and take turns; larger ones come one after another.
TOGETHER = 20_000


@dataclass(frozen=True, order=True)
class Row:
    """One line of a table: a side on a platform, under an integrator."""

    side: str  # "empty", "ours", "strings" or "jax"
    place: str  # the platform, or the form of jax
    integrator: str

    @property
    def label(self):
        """As tables call it."""
        return f"{SIDES[self.side]}, {self.place}"

    def __str__(self):
        return f"{self.label}, {self.integrator}"


@dataclass
class Results:
    """Least µs per step by row and N, and why there is none."""

    cost: dict = field(default_factory=dict)
    missing: dict = field(default_factory=dict)

    def rows(self, integrator):
        """The rows of one integrator, in the order in which they were measured."""
        found = dict.fromkeys(row for row, _ in [*self.cost, *self.missing])
        order = list(SIDES)
        rows = [row for row in found if row.integrator == integrator]
        return sorted(rows, key=lambda row: order.index(row.side))

    @property
    def sizes(self):
        """All N, ascending."""
        return sorted({n for _, n in self.cost})

    def best(self, side, integrator, n, place=None):
        """The row of a side that is fastest at N, with its µs; None if there is none.

        Parameters
        ----------
        place : str, optional
            Only rows whose platform starts so.
        """
        found = [
            (cost, row)
            for (row, size), cost in self.cost.items()
            if (row.side, row.integrator, size) == (side, integrator, n)
            and row.place.startswith(place or "")
        ]
        return min(found) if found else None


def race(parts, targets, results, options):
    """Measure every side on the icosphere of 10 parts² + 2 vertices.

    Parameters
    ----------
    parts : int
    targets : list of Target
    results : Results
        Takes what is measured.
    options : argparse.Namespace
        With `repeats`, `seconds`, `most_vertices`, and `jax_python` (None for none).
    """
    vesicle = Vesicle(sphere(parts))
    systems = {"empty": empty_system(vesicle), "ours": vesicle.system()}
    n = vesicle.mesh.num_vertices
    plan = [
        (Row(side, target.label, integrator), target)
        for integrator in INTEGRATORS
        for side in systems
        for target in targets
    ]
    plan += _strings(vesicle, systems, targets, results, options.most_vertices)
    least = 5 if n <= TOGETHER else 3
    energies, contexts = {}, {}
    for row, target in plan:
        say(f"{n}: starting {row}")
        try:
            context = start(systems[row.side], vesicle, row.integrator, target)
            # Platforms may refuse what they cannot do only with the first step.
            context.getIntegrator().step(1)
        except openmm.OpenMMException as reason:
            results.missing[row, n] = str(reason)
            continue
        energies[row.side] = energy(context, vesicle)
        contexts[row] = context
        if n > TOGETHER:
            _time(contexts, n, results, options, least)
            contexts.clear()
            del context
    if contexts:
        say(f"{n}: {len(contexts)} Contexts in turns")
        _time(contexts, n, results, options, least)
        contexts.clear()
    if "strings" in energies:
        with_strings.check_agreement(energies["ours"], energies["strings"], "the string forces")
    _jax(vesicle, energies["ours"], results, options)
    say("")


def _strings(vesicle, systems, targets, results, most):
    """The rows of the string forces, and their System, unless the mesh is too large."""
    n = vesicle.mesh.num_vertices
    plan = []
    for target in targets:
        if target.platform == "Helfrich":
            # Custom forces run on Reference's kernels there.
            continue
        row = Row("strings", target.label, "Verlet")
        if n > most["strings"]:
            results.missing[row, n] = f"left out above N = {most['strings']}"
        else:
            plan.append((row, target))
    if plan:
        systems["strings"] = with_strings.string_system(vesicle)
    return plan


def _jax(vesicle, ours, results, options):
    n = vesicle.mesh.num_vertices
    for form in with_jax.FORMS:
        row = Row("jax", form, "Verlet")
        if options.jax_python is None:
            results.missing[row, n] = "jax and jax-md are not installed"
        elif n > options.most_vertices["jax"]:
            results.missing[row, n] = f"left out above N = {options.most_vertices['jax']}"
        else:
            say(f"{n}: {row.label}")
            cost, theirs = with_jax.measure(
                vesicle, options.jax_python, form, options.repeats, options.seconds
            )
            with_strings.check_agreement(ours, theirs, row.label)
            results.cost[row, n] = cost


def _time(contexts, n, results, options, least):
    for row, cost in measure(contexts, n, options, least).items():
        results.cost[row, n] = cost

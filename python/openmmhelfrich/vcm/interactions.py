"""The interaction table: how the vertices of two membranes, or of one, repel and attract.

With r the distance, r1 and r2 the radii of two vertices (`NodeRadius`):

- ``0``: nothing
- ``LJ``: 4 ε [(σ/r)¹² − (σ/r)⁶] up to 3σ, σ = r1 + r2, ε = kBT
- ``EV``: 100 kJ/mol [(σ/r)¹² − (σ/r)⁶ + ¼] up to 2^⅙ σ, σ = (r1 + r2)/2
- ``WCA``: 4 kBT [(σ/r)¹² − (σ/r)⁶ + ¼] up to 2^⅙ σ, σ = r1 + r2
- ``WCAFC``: WCA, continued as a straight line below σ/1.48, so that its force stays finite
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np
import openmm

from .._types import Array
from .grammar import Section, nearest
from .springs import edge_lengths

if TYPE_CHECKING:
    from .config import Config, Membrane

__all__ = ["INTERACTIONS", "makers", "node_radii", "read_table"]

INTERACTIONS = ("0", "LJ", "EV", "WCA", "WCAFC")

_TWELVE_SIX = "((sigma/r)^12-(sigma/r)^6"
_REPULSION = f"{_TWELVE_SIX}+0.25)*step({2 ** (1 / 6)!r}*sigma-r)"
# Where the force of WCAFC ceases to grow, in units of 1/σ, and its energy and slope there.
_CAP = 1.48
_CAP_ENERGY = _CAP**12 - _CAP**6 + 0.25
_CAP_SLOPE = -12 * _CAP**13 + 6 * _CAP**7

# Expression, with {kT} for kBT, and the cutoff in units of r1 + r2.
_POTENTIALS = {
    "LJ": (
        f"4*sqrt(epsilon1*epsilon2)*{_TWELVE_SIX})*step(3*sigma-r);sigma=radius1+radius2",
        3.0,
    ),
    "EV": (f"100*{_REPULSION};sigma=0.5*(radius1+radius2)", 2 ** (1 / 6) / 2),
    "WCA": (f"4*{{kT!r}}*{_REPULSION};sigma=radius1+radius2", 2 ** (1 / 6)),
    "WCAFC": (
        f"4*{{kT!r}}*select(step(r-sigma/{_CAP}),{_REPULSION},"
        f"{_CAP_ENERGY!r}+({_CAP_SLOPE!r})*(r/sigma-{1 / _CAP!r}));sigma=radius1+radius2",
        2 ** (1 / 6),
    ),
}


def read_table(section: Section | None, num_membranes: int) -> list[list[str]]:
    """The interaction of each pair of membranes, lower triangular; all ``0`` without a table.

    Parameters
    ----------
    section : Section or None
        Each row is a label, which is not looked at, and one word per membrane up to its own.
    num_membranes : int
        How many rows there must be.

    Raises
    ------
    ConfigError
        If the shape is another, or a word unknown.
    """
    if section is None:
        return [["0"] * (row + 1) for row in range(num_membranes)]
    rows = section.rows
    if len(rows) != num_membranes:
        at = rows[num_membranes] if len(rows) > num_membranes else section
        raise at.error(f"the table needs one row per membrane, {num_membranes}; it has {len(rows)}")
    for number, row in enumerate(rows):
        if len(row.words) != number + 1:
            raise row.error(
                f"row {number + 1} of the table needs {number + 1} words after its label, one per "
                f"membrane up to its own; got {len(row.words)}"
            )
        for word in row.words:
            if word not in INTERACTIONS:
                raise row.error(f"there is no interaction {word!r}; {nearest(word, INTERACTIONS)}")
    return [list(row.words) for row in rows]


def node_radii(membrane: Membrane) -> Array:
    """The radius of every vertex for the interactions, nm."""
    value, mesh, lengths = membrane.settings["NodeRadius"], membrane.mesh, edge_lengths(membrane)
    if value == "Av":
        return np.full(mesh.num_vertices, lengths.mean() / 2)
    if value == "Au":
        sums = np.bincount(mesh.edges.ravel(), np.repeat(lengths, 2), mesh.num_vertices)
        return sums / mesh.degrees / 2
    return np.full(mesh.num_vertices, value)


def _parameters(cfg: Config, kind: str) -> Array:
    """Radius, nm, and ε, kJ/mol, of every particle; shape (num_particles, 2)."""
    rows = []
    for membrane in cfg.membranes:
        radius, epsilon = node_radii(membrane), cfg.kT
        # VCM reads both keys and then takes the radius and kBT.
        if kind == "LJ" and not cfg.vcm_compatible:
            settings = membrane.settings
            if settings["LJsigma"] != "NodeRadius":
                radius = np.full_like(radius, settings["LJsigma"])
            if settings["LJepsilon"] != "kbt":
                epsilon = settings["LJepsilon"]
        rows.append(np.stack([radius, np.full_like(radius, epsilon)], axis=1))
    return np.concatenate(rows)


def makers(cfg: Config) -> dict[str, Callable[[], openmm.Force]]:
    """One force for each kind of interaction that the table has, by its word."""
    pairs: dict[str, list[tuple[int, int]]] = {}
    for i, row in enumerate(cfg.table):
        for j, word in enumerate(row):
            if word != "0":
                pairs.setdefault(word, []).append((j, i))
    return {
        word: lambda word=word, members=members: _force(cfg, word, members)
        for word, members in pairs.items()
    }


def _force(cfg: Config, word: str, pairs: list[tuple[int, int]]) -> openmm.Force:
    expression, reach = _POTENTIALS[word]
    expression = expression.format(kT=cfg.kT)
    parameters = _parameters(cfg, word)[:, : 1 + (word == "LJ")]
    interacts = np.zeros((len(cfg.membranes),) * 2)
    for i, j in pairs:
        interacts[i, j] = interacts[j, i] = 1
    # With interaction groups OpenMM goes through all pairs, without neighbour lists. Membranes that
    # do not see each other may lie in one place, though, where a distance of 0 spoils any factor.
    grouped = not interacts[~np.eye(len(interacts), dtype=bool)].all()
    named = not grouped and not interacts.all()
    if named:
        energy, *definitions = expression.split(";")
        energy = f"select(interacts(membrane1,membrane2),{energy},0)"
        expression = ";".join([energy, *definitions])
        sizes = [len(membrane.particles) for membrane in cfg.membranes]
        owners = np.repeat(np.arange(len(sizes)), sizes)
        parameters = np.column_stack([parameters, owners])
    force = openmm.CustomNonbondedForce(expression)
    force.addPerParticleParameter("radius")
    if word == "LJ":
        force.addPerParticleParameter("epsilon")
    if named:
        force.addPerParticleParameter("membrane")
        table = openmm.Discrete2DFunction(*interacts.shape, interacts.ravel().tolist())
        force.addTabulatedFunction("interacts", table)
    for row in parameters.tolist():
        force.addParticle(row)
    longest = 0.0
    for pair in pairs:
        members = [cfg.membranes[number].particles for number in pair]
        if grouped:
            force.addInteractionGroup(*map(list, members))
        largest = sum(parameters[list(particles), 0].max() for particles in members)
        longest = max(longest, reach * largest)
    periodic = cfg.general["SimulationBoxLength"] > 0
    force.setNonbondedMethod(force.CutoffPeriodic if periodic else force.CutoffNonPeriodic)
    force.setCutoffDistance(longest)
    if cfg.general["bondCutoff"]:
        bonds = np.concatenate([m.mesh.edges + m.offset for m in cfg.membranes]).tolist()
        force.createExclusionsFromBonds(bonds, cfg.general["bondCutoff"])
    return force

"""The bonds of a Custom force as arrays, whichever class of force it is."""

from __future__ import annotations

from dataclasses import dataclass
from math import pi

import numpy as np
import openmm as mm

from ... import forces as our_forces
from ..._types import Array
from ..expressions import Expression, ExpressionError
from .fixed import Fixed, formulas, remaining

__all__ = [
    "BondList",
    "Bonds",
    "Unreadable",
    "all_parameters",
    "derivatives",
    "global_parameters",
    "list_bonds",
    "read_bonds",
    "trials_of",
]

# OpenMM has no constant for π, so expressions get it as a global parameter.
_PI_ERROR = 1e-12
_NUM_TRIALS = 4
_CHUNK = 2_000_000


class Unreadable(ValueError):
    """A force whose bonds cannot be read here, with the reason."""


@dataclass
class Bonds:
    """The bonds of one force, and what their energy depends on.

    particles: shape (num_bonds, num_points); rows: the distinct sets of per-bond values, shape
    (num_rows, num_names); row_of: the row of each bond.
    """

    force: mm.Force
    expression: Expression
    particles: Array
    names: tuple[str, ...]
    rows: Array
    row_of: Array
    globals: dict[str, float]

    @property
    def num_points(self) -> int:
        """The number of particles of a bond."""
        return self.particles.shape[1]

    def energies(self, points: Array, row: int, globals_: dict[str, float]) -> Array:
        """The expression's values.

        Parameters
        ----------
        points : ndarray, shape (num_samples, num_points, 3)
            Places of the particles of a bond, nm.
        row : int
            Which per-bond values.
        globals_ : dict
            The values of global parameters.
        """
        variables = {**globals_, **dict(zip(self.names, self.rows[row], strict=True))}
        variables |= _coordinates(points)
        return np.broadcast_to(self.expression.evaluate(variables), (len(points),))

    def forces(self, positions: Array, weight: float = 1.0) -> tuple[float, Array, float, Array]:
        """Energy and forces, and both once more as sums of the absolute values of all bonds.

        Parameters
        ----------
        positions : ndarray, shape (num_particles, 3)
            nm.
        weight : float
            Multiplies everything.
        """
        energy = magnitude = 0.0
        forces, magnitudes = np.zeros_like(positions), np.zeros_like(positions)
        step = max(1, _CHUNK // max(1, self.expression.size))
        for start in range(0, len(self.particles), step):
            index = self.particles[start : start + step]
            values = self.rows[self.row_of[start : start + step]]
            variables = {**self.globals, **dict(zip(self.names, values.T, strict=True))}
            variables |= _coordinates(positions[index])
            part, slopes = self.expression.gradient(variables)
            part = np.broadcast_to(part, (len(index),)) * weight
            energy += float(part.sum())
            magnitude += float(np.abs(part).sum())
            for point in range(self.num_points):
                for axis, letter in enumerate("xyz"):
                    slope = slopes.get(f"{letter}{point + 1}")
                    if slope is not None:
                        slope = np.broadcast_to(slope, (len(index),)) * weight
                        np.add.at(forces[:, axis], index[:, point], -slope)
                        np.add.at(magnitudes[:, axis], index[:, point], np.abs(slope))
        return energy, forces, magnitude, magnitudes


def _coordinates(points: Array) -> dict[str, Array]:
    return {
        f"{letter}{point + 1}": points[:, point, axis]
        for point in range(points.shape[1])
        for axis, letter in enumerate("xyz")
    }


def global_parameters(force: mm.Force) -> dict[str, float]:
    """The global parameters of a Custom force with their defaults; empty for other forces."""
    if not hasattr(force, "getNumGlobalParameters"):
        return {}
    return {
        force.getGlobalParameterName(i): force.getGlobalParameterDefaultValue(i)
        for i in range(force.getNumGlobalParameters())
    }


def all_parameters(force: mm.Force) -> dict[str, float]:
    """The parameters that a force gives the Context, with their defaults.

    Those of a CustomCVForce's variables are among them, and those of our forces.
    """
    result = global_parameters(force)
    if isinstance(force, mm.CustomCVForce):
        for index in range(force.getNumCollectiveVariables()):
            result = all_parameters(force.getCollectiveVariable(index)) | result
    for cls in our_forces.MembraneForce.__subclasses__():
        if cls.isinstance(force):
            ours = cls.cast(force)
            for index in range(ours.getNumParameters()):
                key = ours.getParameterName(index)
                if ours.getContextParameter(key):
                    result[ours.getContextParameter(key)] = ours.getParameterValue(key)
    return result


def derivatives(force: mm.Force) -> list[str]:
    """The parameters by which a Custom force's energy is to be differentiated."""
    if not hasattr(force, "getNumEnergyParameterDerivatives"):
        return []
    return [
        force.getEnergyParameterDerivativeName(i)
        for i in range(force.getNumEnergyParameterDerivatives())
    ]


def is_pi(value: float) -> bool:
    """Whether a global parameter is there for lack of a constant."""
    return abs(value - pi) <= _PI_ERROR


def trials_of(system: mm.System) -> list[dict[str, float]]:
    """Values of all global parameters of a System: the defaults, then random ones.

    A parameter that is π stays π.
    """
    defaults: dict[str, float] = {}
    for force in system.getForces():
        defaults |= global_parameters(force)
    rng = np.random.default_rng(11)
    trials = [defaults]
    if any(not is_pi(value) for value in defaults.values()):
        for _ in range(_NUM_TRIALS - 1):
            factors = rng.uniform(0.6, 1.6, len(defaults))
            trials.append(
                {
                    name: value if is_pi(value) else factor * (value if value != 0 else 0.01)
                    for (name, value), factor in zip(defaults.items(), factors, strict=True)
                }
            )
    return trials


@dataclass
class BondList:
    """The bonds of a force as OpenMM has them, which are long to ask for and read but once.

    particles: shape (num_bonds, num_points); names: of the per-bond values, shape
    (num_bonds, num_names); points: names that stand for a function of the particles.
    """

    force: mm.Force
    particles: Array
    names: tuple[str, ...]
    values: Array
    points: dict[str, str]


def list_bonds(force: mm.Force) -> BondList:
    """The bonds of a force that OpenMM evaluates from an expression, bond by bond.

    Raises
    ------
    Unreadable
        If it is of another class, periodic, empty, or has tabulated functions.
    """
    if isinstance(force, mm.CustomCompoundBondForce):
        num_points, points = force.getNumParticlesPerBond(), {}
        read, count, kind = force.getBondParameters, force.getNumBonds(), "Bond"
    elif isinstance(force, mm.CustomTorsionForce):
        num_points, points = 4, {"theta": "dihedral(p1,p2,p3,p4)"}
        count, kind = force.getNumTorsions(), "Torsion"

        def read(index):
            *particles, values = force.getTorsionParameters(index)
            return particles, values
    else:
        raise Unreadable("it is not a force that we replace")
    if force.usesPeriodicBoundaryConditions():
        raise Unreadable("it uses periodic boundary conditions, which are not looked for")
    if count == 0:
        raise Unreadable("it has no bonds")
    if getattr(force, "getNumTabulatedFunctions", lambda: 0)():
        raise Unreadable("its expression has tabulated functions")
    names = tuple(
        getattr(force, f"getPer{kind}ParameterName")(i)
        for i in range(getattr(force, f"getNumPer{kind}Parameters")())
    )
    particles = np.empty((count, num_points), dtype=np.int64)
    values = np.empty((count, len(names)))
    for index in range(count):
        particles[index], values[index] = read(index)
    return BondList(force, particles, names, values, points)


def read_bonds(bonds: BondList, fixed: dict[str, Fixed]) -> Bonds:
    """What the energies of bonds depend on.

    Parameters
    ----------
    bonds : BondList
        Of a force.
    fixed : dict
        What its global parameters are that do not vary by themselves.

    Raises
    ------
    Unreadable
        If the expression is not understood.
    """
    force, num_points = bonds.force, bonds.particles.shape[1]
    coordinates = {f"{axis}{i + 1}" for axis in "xyz" for i in range(num_points)}
    # Where names are given twice these go before global parameters.
    fixed = {n: f for n, f in fixed.items() if n not in coordinates and n not in bonds.names}
    try:
        given = {**formulas(fixed), **bonds.points}
        expression = Expression(force.getEnergyFunction(), num_points, given)
    except ExpressionError as reason:
        raise Unreadable(f"its expression is not understood: {reason}") from None
    # A parameter that the energy does not depend on would only make the bonds look different.
    used = [i for i, name in enumerate(bonds.names) if name in expression.variables]
    rows, row_of = np.unique(bonds.values[:, used], axis=0, return_inverse=True)
    names = tuple(bonds.names[i] for i in used)
    globals_ = remaining(global_parameters(force), fixed)
    unknown = expression.variables - coordinates - set(names) - set(globals_)
    if unknown:
        raise Unreadable(f"its expression has the unknown variable {min(unknown)!r}")
    return Bonds(force, expression, bonds.particles, names, rows, row_of.ravel(), globals_)

"""One of our forces in place of Custom forces, before and after it is built."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
import openmm as mm

from ... import forces as our_forces
from .fit import Scalar
from .surface import Component

__all__ = ["Offset", "Refused", "Term", "common_name"]


class Refused(ValueError):
    """Forces that are nearly one of our potentials, with the reason why they are left alone."""


@dataclass(frozen=True)
class Offset:
    """A constant energy, kJ/mol: value, or factor times a parameter of the Context."""

    value: float
    context: str = ""
    factor: float = 0.0

    def force(self, default: float, derivative: bool) -> mm.Force:
        """A force that is nothing but this energy."""
        text = f"{self.factor!r}*{self.context}" if self.context else repr(self.value)
        result = mm.CustomCompoundBondForce(1, text)
        if self.context:
            result.addGlobalParameter(self.context, default)
            if derivative:
                result.addEnergyParameterDerivative(self.context)
        result.addBond([0], [])
        result.setName("constant energy")
        return result


@dataclass
class Term:
    """One of our forces.

    sources: the indices of the forces whose place it takes; scalars: in the order of the class's
    constructor. `values` of a scalar are by vertex, ascending, or by triangle in the order of
    ascending particles within each component.
    """

    sources: list[int]
    force_class: str
    components: list[Component]
    scalars: dict[str, Scalar]
    form: str = ""
    unsigned: bool = False
    offset: Offset | None = None
    notes: list[str] = field(default_factory=list)

    def build(self, name: str, group: int, derivatives: set[str]) -> list[mm.Force]:
        """Our force, and a constant energy if one is needed.

        Raises
        ------
        Refused
            If a value is impossible for our force, such as a negative modulus.
        """
        cls = getattr(our_forces, self.force_class)
        triangles = np.concatenate([component.outward() for component in self.components])
        arguments = {
            key: s.value if s.values is None else s.values for key, s in self.scalars.items()
        }
        try:
            if self.form:
                force = cls(triangles, *arguments.values(), getattr(cls, self.form))
            else:
                force = cls(triangles, *arguments.values())
        except (mm.OpenMMException, TypeError, ValueError) as reason:
            raise Refused(str(reason)) from None
        if self.unsigned:
            force.setUnsignedSpontaneousCurvature(True)
        result = [force]
        for key, scalar in self.scalars.items():
            if scalar.context:
                force.setContextParameter(key, scalar.context)
                if scalar.context in derivatives:
                    force.addEnergyParameterDerivative(scalar.context)
        if name:
            force.setName(name)
        if self.offset is not None:
            defaults = {s.context: s.value for s in self.scalars.values() if s.context}
            default = defaults.get(self.offset.context, 0.0)
            result.append(self.offset.force(default, self.offset.context in derivatives))
        for part in result:
            part.setForceGroup(group)
        return result

    @property
    def contexts(self) -> set[str]:
        """The parameters of the Context that it has."""
        return {s.context for s in self.scalars.values() if s.context}

    def describe(self) -> str:
        """The scalars, in words."""
        parts = [self.form] if self.form else []
        for key, scalar in self.scalars.items():
            if scalar.context:
                parts.append(f"{key} = Context parameter {scalar.context} ({scalar.value:.6g})")
            elif scalar.values is not None:
                low, high = scalar.values.min(), scalar.values.max()
                parts.append(f"{key} from {low:.6g} to {high:.6g}")
            else:
                parts.append(f"{key} = {scalar.value:.6g}")
        if self.unsigned:
            parts.append("spontaneous curvature without sign")
        if self.offset is not None:
            shown = self.offset.factor if self.offset.context else self.offset.value
            per = f" per {self.offset.context}" if self.offset.context else ""
            parts.append(f"a constant {shown:.6g} kJ/mol{per} kept as a force of its own")
        return "; ".join(parts + self.notes)


def common_name(forces: list[mm.Force]) -> str:
    """The name that the forces have in common, empty if they have OpenMM's."""
    names = {"" if force.getName() == type(force).__name__ else force.getName() for force in forces}
    return names.pop() if len(names) == 1 else ""

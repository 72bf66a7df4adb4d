"""What a `Vesicle` was made with, as its properties."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from ._types import Array
from .mesh import Mesh

__all__ = ["Parameters"]


class Parameters:
    """Properties of what derived classes keep under the same names with an underscore."""

    _mesh: Mesh
    _rigidity: float | Array
    _area_modulus: float
    _volume_modulus: float
    _softness: float
    _min_height: float
    _epsilon: float
    _mass: float
    _scheme: int
    _spontaneous_curvature: float | Array
    _flips: Mapping[str, Any] | None
    _viscosity: Mapping[str, Any] | None
    _area: float
    _volume: float | None

    @property
    def mesh(self) -> Mesh:
        """The Mesh with which the vesicle starts."""
        return self._mesh

    @property
    def rigidity(self) -> float | Array:
        """Bending rigidity κ, kJ/mol, a number or one for each vertex."""
        return self._rigidity

    @property
    def area_modulus(self) -> float:
        """kA, kJ/mol/nm²."""
        return self._area_modulus

    @property
    def volume_modulus(self) -> float:
        """kV, kJ/mol/nm³."""
        return self._volume_modulus

    @property
    def softness(self) -> float:
        """Softness Ξ of the mesh."""
        return self._softness

    @property
    def min_height(self) -> float:
        """Least triangle height d, nm."""
        return self._min_height

    @property
    def epsilon(self) -> float:
        """ε of the triangle heights, kJ/mol."""
        return self._epsilon

    @property
    def mass(self) -> float:
        """Mass of one vertex, amu."""
        return self._mass

    @property
    def scheme(self) -> int:
        """Bending scheme of `BendingForce`."""
        return self._scheme

    @property
    def spontaneous_curvature(self) -> float | Array:
        """C0, 1/nm, a number or one for each vertex."""
        return self._spontaneous_curvature

    @property
    def flips(self) -> dict[str, Any] | None:
        """Arguments of the `MonteCarloBondFlip` by name, or None."""
        return None if self._flips is None else dict(self._flips)

    @property
    def viscosity(self) -> dict[str, Any] | None:
        """Arguments of the `SurfaceViscosityThermostat` by name, or None."""
        return None if self._viscosity is None else dict(self._viscosity)

    @property
    def area(self) -> float:
        """Target area A0, nm²."""
        return self._area

    @property
    def volume(self) -> float | None:
        """Target volume V0, nm³, or None."""
        return self._volume

    @property
    def reduced_volume(self) -> float | None:
        """V0 over the volume of the sphere of area A0, or None."""
        if self._volume is None:
            return None
        return self._volume / (4 / 3 * math.pi * self.radius**3)

    @property
    def radius(self) -> float:
        """Radius of the sphere of area A0, nm."""
        return math.sqrt(self._area / (4 * math.pi))

"""The parameters of area-difference elasticity in the literature's terms."""

from __future__ import annotations

import math

from openmm import unit

from ._numbers import checked_number
from ._types import Scalar

__all__ = ["area_difference_parameters"]

_ENERGY = unit.kilojoule_per_mole


def area_difference_parameters(
    rigidity: Scalar, alpha: float, area: Scalar, delta_a0: float
) -> tuple[float, float]:
    """Modulus and target of an `AreaDifferenceForce`, from those of the ADE model.

    E = α κ π (ΔA − ΔA0)² / (2 A D²) of Miao, Seifert, Wortis and Döbereiner, Phys. Rev. E 49, 5389
    (1994), doi:10.1103/PhysRevE.49.5389, with ΔA = 2 D M, is ½ m (M − M0)² with m = 4π α κ / A and
    M0 = 4π R_A Δa0. D, the distance of the monolayers' neutral surfaces, drops out.

    Parameters
    ----------
    rigidity : float or Quantity
        Bending rigidity κ, kJ/mol.
    alpha : float
        α, the ratio of the non-local to the local bending rigidity, about 1 for lipid bilayers;
        3/π for two homogeneous sheets that slide on each other. 0 or more.
    area : float or Quantity
        Area A of the relaxed membrane, nm²; 4πR_A² by the definition of R_A.
    delta_a0 : float
        Reduced difference Δa0 = ΔA0 / 8πD R_A of the relaxed monolayers' areas, 1 for those of a
        sphere of area A.

    Returns
    -------
    modulus, target : float
        m, kJ/mol/nm², and M0, nm.

    Raises
    ------
    TypeError
        Something else than a number, or a Quantity of another dimension.
    ValueError
        A number that is not finite, a negative κ or α, or an area that is not above zero.

    Examples
    --------
    >>> parameters = area_difference_parameters(50, alpha=1.4, area=mesh.area, delta_a0=1.1)
    >>> system.addForce(AreaDifferenceForce(mesh, *parameters))
    """
    caller = "area_difference_parameters"
    rigidity = checked_number("rigidity", rigidity, _ENERGY, caller=caller)
    alpha = checked_number("alpha", alpha, unit.dimensionless, caller=caller)
    area = checked_number("area", area, unit.nanometer**2, zero=False, caller=caller)
    delta_a0 = checked_number(
        "delta_a0", delta_a0, unit.dimensionless, negative=True, caller=caller
    )
    return 4 * math.pi * alpha * rigidity / area, math.sqrt(4 * math.pi * area) * delta_a0

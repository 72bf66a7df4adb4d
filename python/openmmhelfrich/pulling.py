"""A constant force on some particles, as of optical tweezers, with energies by term left apart."""

from __future__ import annotations

import numpy as np
import openmm
from numpy.typing import ArrayLike
from openmm import unit

from ._numbers import checked_number
from ._placement import NUM_GROUPS
from ._types import Values

__all__ = ["pull"]

_FORCE = unit.kilojoule_per_mole / unit.nanometer


def pull(system: openmm.System, particles: ArrayLike, force: Values) -> openmm.CustomExternalForce:
    """Pull at particles with a constant force, which they share equally.

    The energy is −Σ F·r / n over the n particles. It gets the lowest force group that the System
    does not use, or if all are used the last one, so that energies by term stay those of the terms.

    Parameters
    ----------
    system : openmm.System
        Before a Context is made of it.
    particles : array_like of int
        Indices, shape (n,).
    force : array_like or Quantity
        The whole force F, shape (3,), kJ/mol/nm; 1 pN is 0.6022 kJ/mol/nm.

    Returns
    -------
    openmm.CustomExternalForce
        The force that was added; its Context parameters ``pull_x``, ``pull_y`` and ``pull_z``, with
        the index of the force in the System behind them, are the components of F.

    Raises
    ------
    IndexError
        A particle that the System does not have.
    TypeError
        No System; or a force that is no numbers, or a Quantity that is no force per mole.
    ValueError
        No particles, some twice, or a force that is not three finite numbers.

    Examples
    --------
    >>> cell = RedCell("amoudruz", 502)
    >>> system = cell.system()
    >>> by_x = cell.mesh.vertices[:, 0].argsort()
    >>> tweezers = pull(system, by_x[-10:], (60.2, 0, 0))
    """
    if not isinstance(system, openmm.System):
        raise TypeError(
            f"pull: system needs an openmm.System, got {type(system).__name__}; that of a Vesicle "
            "is vesicle.system(), which is to be pulled before its Context is made"
        )
    chosen = _particles(particles, system.getNumParticles())
    components = _components(force)
    index = system.getNumForces()
    names = [f"pull_{axis}{index}" for axis in "xyz"]
    terms = (f"{name}*{axis}" for name, axis in zip(names, "xyz", strict=True))
    made = openmm.CustomExternalForce(f"-({' + '.join(terms)})/{len(chosen)}")
    for name, component in zip(names, components, strict=True):
        made.addGlobalParameter(name, component)
    for particle in chosen:
        made.addParticle(particle, [])
    used = {other.getForceGroup() for other in system.getForces()}
    free = (group for group in range(NUM_GROUPS) if group not in used)
    made.setForceGroup(next(free, NUM_GROUPS - 1))
    made.setName("pull")
    system.addForce(made)
    # It lives as long as the System, so whoever holds it holds that too.
    made._system = system
    return made


def _particles(particles: ArrayLike, count: int) -> list[int]:
    """Checked indices."""
    try:
        array = np.asarray(particles)
    except ValueError:
        # Lists of unequal length.
        array = np.empty((0, 0))
    if array.ndim != 1 or array.size == 0 or array.dtype.kind not in "iu":
        raise ValueError(f"pull: particles need indices of shape (n,), got {particles!r}")
    if len(np.unique(array)) != len(array):
        raise ValueError("pull: particles has an index twice; each is pulled once")
    for index in array.tolist():
        if not 0 <= index < count:
            raise IndexError(f"pull: there is no particle {index}; the System has {count}")
    return array.tolist()


def _components(force: Values) -> list[float]:
    """Three numbers in kJ/mol/nm."""
    if unit.is_quantity(force):
        if not force.unit.is_compatible(_FORCE):
            raise TypeError(
                f"pull: force needs the unit {_FORCE}, got {force.unit}; multiply a force by "
                "unit.AVOGADRO_CONSTANT_NA to have it per mole"
            )
        force = force.value_in_unit(_FORCE)
    try:
        three = np.shape(force) == (3,)
    except ValueError:
        three = False
    if not three:
        raise ValueError(f"pull: force needs three numbers, got {force!r}")
    return [checked_number("force", part, _FORCE, negative=True, caller="pull") for part in force]

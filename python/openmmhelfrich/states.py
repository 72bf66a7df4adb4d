"""The whole state of a Context in a file: what OpenMM's State holds, and the connectivity.

Bond flips change which particles are neighbours, and exchanges what they are. OpenMM's State, and
its checkpoints on other platforms than Helfrich, do not know that; these files do, and they can be
read on any platform.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from openmm import unit

from . import _blocks, _writing
from ._mesh.inputs import box_array
from ._present import context_of, surfaces_of
from ._snapshots import all_of, tensions_of, thermostats_of
from ._types import File
from .forces import MonteCarloMembraneTension, SurfaceViscosityThermostat

__all__ = ["load_state", "save_state"]

_KIND = "state"
#: Newest versions of the blocks of a file.
_KNOWN = {
    "positions": 1,
    "velocities": 1,
    "box": 1,
    "parameters": 1,
    "clock": 1,
    "connectivity": 1,
    "tension": 1,
    "viscosity": 1,
}
_NEEDED = sorted(_KNOWN.keys() - {"connectivity", "tension", "viscosity"})


def save_state(context: Any, path: File) -> None:
    """Save positions, velocities, parameters, time and connectivity of a Context.

    `load_state` restores them to the last bit of what OpenMM hands out: of all digits on the
    platforms Reference, CPU and Helfrich, and elsewhere in the precision of the platform. What
    bond flips, a `MonteCarloDomainSwap`, a `MonteCarloMembraneTension` and a
    `SurfaceViscosityThermostat` have come to, with their random numbers and their statistics, is
    among it; the random numbers of integrators are not, so a run under LangevinMiddle goes on along
    another path of the same ensemble, where one from a checkpoint of platform Helfrich goes on with
    the same bits.

    Parameters
    ----------
    context : openmm.Context or openmm.app.Simulation
    path : str or path-like
        The file; it is replaced in one go, so that there is always a whole one. It has a checksum
        and a version.

    Raises
    ------
    OSError
        If the file cannot be written.
    """
    context = context_of("save_state", context)
    state = context.getState(getPositions=True, getVelocities=True, getParameters=True)
    arrays = {
        "positions": state.getPositions(asNumpy=True),
        "velocities": state.getVelocities(asNumpy=True),
        "box": state.getPeriodicBoxVectors(asNumpy=True),
    }
    blocks = {
        name: _blocks.Block(np.array(array.value_in_unit_system(unit.md_unit_system), np.float64))
        for name, array in arrays.items()
    }
    blocks["parameters"] = _blocks.Block(
        {name: float(value).hex() for name, value in sorted(state.getParameters().items())}
    )
    clock = {
        "time": state.getTime().value_in_unit(unit.picosecond).hex(),
        "step": context.getStepCount(),
    }
    blocks["clock"] = _blocks.Block(clock)
    for number, force in enumerate(surfaces_of(context)):
        blocks[f"connectivity/{number}"] = _blocks.Block(force._saveConnectivity(context))
    for number, force in enumerate(tensions_of(context)):
        blocks[f"tension/{number}"] = _blocks.Block(force._saveState(context))
    for number, force in enumerate(thermostats_of(context)):
        blocks[f"viscosity/{number}"] = _blocks.Block(force._saveState(context))
    _writing.write_whole(path, _blocks.pack(_KIND, blocks))


def load_state(context: Any, path: File) -> None:
    """Restore what `save_state` has saved, the connectivity too.

    Under integrators that draw random numbers, as LangevinMiddle, the run does not go on with the
    same bits, as it does from a checkpoint of platform Helfrich.

    Parameters
    ----------
    context : openmm.Context or openmm.app.Simulation
        With as many particles, with forces on the same surfaces, and with all parameters that were
        saved; on any platform.
    path : str or path-like
        The file.

    Raises
    ------
    OSError
        If the file cannot be read.
    ValueError
        If the file is damaged, of another kind or of a newer version, or belongs to a Context with
        other particles, surfaces or parameters. Nothing has changed then.
    openmm.OpenMMException
        If the connectivity is not one of these particles, or is not allowed by a
        MonteCarloBondFlip. Nothing has changed then.
    """
    context, name = context_of("load_state", context), Path(path)
    try:
        blocks = _blocks.unpack(name.read_bytes(), _KIND, _KNOWN)
    except _blocks.BlockError as reason:
        raise ValueError(f"load_state: {name} {reason}") from None
    values = {key: block.value for key, block in blocks.items()}
    _check_values(name, values)
    parameters = {key: float.fromhex(text) for key, text in values["parameters"].items()}
    surfaces = surfaces_of(context)
    connectivity = _in_order(values, "connectivity")
    stateful = []
    for block, cls in (
        ("tension", MonteCarloMembraneTension),
        ("viscosity", SurfaceViscosityThermostat),
    ):
        states, movers = _in_order(values, block), all_of(context, cls)
        if states and len(states) != len(movers):
            raise ValueError(
                f"load_state: {name} has {len(states)} {cls.__name__}, but the Context has "
                f"{len(movers)}"
            )
        # Files from before there was a mover leave it as it is.
        stateful += zip(movers, states, strict=False)
    _check(context, name, values["positions"], parameters, surfaces, connectivity)
    # First what may be refused.
    _restore(context, surfaces, connectivity, stateful)
    present = context.getParameters()
    for key, value in parameters.items():
        # Connectivity has set its own.
        own = key.startswith(("BondFlipConnectivity", "DomainSwapPermutation"))
        if not own and present[key] != value:
            context.setParameter(key, value)
    context.setPeriodicBoxVectors(*values["box"])
    context.setPositions(values["positions"])
    context.setVelocities(values["velocities"])
    context.setTime(float.fromhex(values["clock"]["time"]))
    context.setStepCount(values["clock"]["step"])


def _restore(context, surfaces: list[Any], connectivity: list[bytes], stateful: list[Any]) -> None:
    """Restore the connectivity of all surfaces and the states of all movers, or of none."""
    steps = [
        (force._restoreConnectivity, force._saveConnectivity, saved)
        for force, saved in zip(surfaces, connectivity, strict=True)
    ]
    steps += [(force._restoreState, force._saveState, saved) for force, saved in stateful]
    before = [save(context) for _, save, _ in steps]
    done = []
    try:
        for (restore, _, saved), old in zip(steps, before, strict=True):
            restore(context, saved)
            done.append((restore, old))
    except Exception:
        for restore, old in done:
            restore(context, old)
        raise


def _check_values(name, values: dict[str, Any]) -> None:
    """Refuse blocks that are not what `save_state` writes, before anything is changed.

    Raises
    ------
    ValueError
        Names the block.
    """
    missing = [needed for needed in _NEEDED if needed not in values]
    if missing:
        raise ValueError(f"load_state: {name} has no {', '.join(missing)}")
    for key, value in values.items():
        try:
            right = _is_right(key.partition("/")[0], value)
        except (AttributeError, LookupError, TypeError, ValueError, OverflowError):
            right = False
        if not right:
            raise ValueError(
                f"load_state: {name} has a block {key} that is not as save_state writes it; save "
                "the state again"
            )
    box_array(values["box"], f"load_state: {name}")
    if len(values["velocities"]) != len(values["positions"]):
        raise ValueError(
            f"load_state: {name} has {len(values['positions'])} positions, but "
            f"{len(values['velocities'])} velocities"
        )


def _is_right(block: str, value) -> bool:
    """Whether a block has the type that it should; some errors say that it has not, too."""
    if block in ("positions", "velocities", "box"):
        return value.dtype == np.float64 and value.ndim == 2 and value.shape[1] == 3
    if block == "parameters":
        return all(isinstance(float.fromhex(text), float) for text in value.values())
    if block == "clock":
        float.fromhex(value["time"])
        return type(value["step"]) is int and abs(value["step"]) < 2**63
    return isinstance(value, bytes)


def _in_order(values: dict[str, Any], block: str) -> list[bytes]:
    """What was saved of surfaces, or of movers, in their order."""
    found = []
    while (key := f"{block}/{len(found)}") in values:
        found.append(values[key])
    return found


def _check(context, name, positions, parameters, surfaces, connectivity) -> None:
    count = context.getSystem().getNumParticles()
    if len(positions) != count:
        raise ValueError(
            f"load_state: {name} has {len(positions)} particles, but the Context has {count}"
        )
    unknown = sorted(parameters.keys() - set(context.getParameters().keys()))
    if unknown:
        raise ValueError(
            f"load_state: {name} has the parameter {unknown[0]}, which the Context has not; "
            "make it with the same forces"
        )
    if len(connectivity) != len(surfaces):
        raise ValueError(
            f"load_state: {name} has {len(connectivity)} triangulated surfaces, but the forces of "
            f"the Context have {len(surfaces)}"
        )

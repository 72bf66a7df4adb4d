"""What arguments may be and arrays are, for type checkers."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any, Protocol, TypeAlias, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = ["Array", "Doubles", "File", "Integers", "Quantity", "Scalar", "Values"]

if TYPE_CHECKING:

    class Quantity(Protocol):
        """What checkers have to know of ``openmm.unit.Quantity``, for OpenMM has no types."""

        unit: Any

        def value_in_unit(self, unit: Any) -> Any: ...

else:
    from openmm.unit import Quantity

File: TypeAlias = Union[str, "os.PathLike[str]"]
#: A number, in OpenMM's units if it is plain.
Scalar: TypeAlias = float | Quantity
#: Numbers in an array, in OpenMM's units if they are plain.
Values: TypeAlias = ArrayLike | Quantity
#: Whatever its numbers are.
Array: TypeAlias = NDArray[Any]
Doubles: TypeAlias = NDArray[np.float64]
Integers: TypeAlias = NDArray[np.int64]

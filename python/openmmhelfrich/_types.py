"""What arguments may be and arrays are, for type checkers."""

from __future__ import annotations

import os
from typing import TypeAlias, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray
from openmm.unit import Quantity

__all__ = ["Doubles", "File", "Integers", "Scalar", "Values"]

File: TypeAlias = Union[str, "os.PathLike[str]"]
#: A number, in OpenMM's units if it is plain.
Scalar: TypeAlias = float | Quantity
#: Numbers in an array, in OpenMM's units if they are plain.
Values: TypeAlias = ArrayLike | Quantity
Doubles: TypeAlias = NDArray[np.float64]
Integers: TypeAlias = NDArray[np.int64]

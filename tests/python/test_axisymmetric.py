"""The reference for shapes of vesicles, `examples/flips/axisymmetric.py`, against what is known."""

from __future__ import annotations

import numpy as np
import pytest
from running import ROOT

axisymmetric = None

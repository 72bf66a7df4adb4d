"""Checks of numbers: what passes, and that errors name the function, the argument and the value."""

from fractions import Fraction

import numpy as np
import pytest
from openmmhelfrich._numbers import finite_array, positive_number, whole_number


@pytest.mark.parametrize(
    "value", [3, 3.0, np.int32(3), np.uint8(3), np.float32(3), np.array(3), np.array(3.0)]
)
def test_whole_numbers_of_any_type_are_ints(value):
    found = whole_number(value, "f", "n", 0, 3)
    assert type(found) is int
    assert found == 3


@pytest.mark.parametrize(
    "value",
    [1.5, np.nan, -np.inf, np.inf, Fraction(3, 2), True, None, "3", 2j, [3], np.array([3]), 1, 6],
)
def test_other_numbers_are_named(value):
    with pytest.raises(ValueError, match="f: n needs a whole number from 2 to 5, got ") as caught:
        whole_number(value, "f", "n", 2, 5)
    assert repr(value) in str(caught.value)


def test_whole_numbers_need_no_upper_limit():
    assert whole_number(10**30, "f", "n", 0) == 10**30
    with pytest.raises(ValueError, match="f: n needs a whole number of 1 or more, got 0"):
        whole_number(0, "f", "n", 1)


def test_positive_numbers():
    assert positive_number(np.float32(0.5), "f", "x") == 0.5
    for value in (0, -1, np.nan, np.inf, None, "x", [1, 2]):
        with pytest.raises(ValueError, match="f: x needs a positive, finite number, got ") as error:
            positive_number(value, "f", "x")
        assert repr(value) in str(error.value)


def test_arrays_of_finite_numbers():
    np.testing.assert_array_equal(finite_array([[1, 2]], "f", "x"), [[1.0, 2.0]])
    for value, culprit in (
        (np.nan, "f: x is nan"),
        ([0, np.inf], r"f: x\[1\] is inf"),
        ([[0, 1], [2, -np.inf]], r"f: x\[1, 1\] is -inf"),
    ):
        with pytest.raises(ValueError, match=culprit):
            finite_array(value, "f", "x")

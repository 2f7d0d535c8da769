# SPDX-License-Identifier: BSD-3-Clause
"""Refuses arguments of a wrong type before anything is planned, in one line that names them.

What a value of the right type may be is said where it is read, in C++.
"""
from __future__ import annotations

import collections.abc
import math
import operator
import os

import numpy as np

from . import _swivel


def _is_whole(value):
    try:
        operator.index(value)
    except TypeError:
        return False
    return True


def _is_number(value):
    try:
        math.isnan(value)
    except (TypeError, OverflowError):  # the latter of whole numbers that no float can be
        return False
    return not isinstance(value, complex)  # numpy's complex numbers lose a part, and only warn


def _is_truth(value):
    return isinstance(value, (int, np.bool_)) and value in (0, 1)


def _is_text(value):
    return isinstance(value, str)


def _is_mapping(value):
    return isinstance(value, collections.abc.Mapping)


def _is_list(value, is_item):
    """Returns whether a value is a sequence or an array of such items."""
    listed = hasattr(value, "__len__") and hasattr(value, "__getitem__")
    return listed and not _is_text(value) and not _is_mapping(value) and all(map(is_item, value))


def _is_range(value):
    return _is_number(value) or (_is_list(value, _is_number) and len(value) in (2, 3))


def _is_ranges(value):
    return _is_mapping(value) and all(_is_text(k) and _is_range(v) for k, v in value.items())


def _is_criteria(value):
    return _is_text(value) or _is_list(value, _is_text)


def _is_rows(value):
    kinds = (str, os.PathLike, dict, _swivel.Answer, _swivel.Motion, _swivel.Trajectory)
    return isinstance(value, kinds) or _is_list(value, lambda one: isinstance(one, _swivel.Part))


def _is_client(value):
    return all(callable(getattr(value, name, None)) for name in ("submit", "cancel", "nthreads"))


# What an argument must be, what is said of one that is not, and what is allowed. None is allowed
# where the words end in it.
_WHOLE = "{value}: not a whole number"
_NUMBER = "{value}: not a number"
_TIMEOUT = _is_number, _NUMBER, "are values above 0, or None"
_TRUTH = _is_truth, "{value}: neither True nor False", "are True and False"
_FUNCTION = callable, "not callable", "is a function, or None"
_RANGE = _is_range, "{value}", "is a number, (from, to, step), or (from, to) with sample, or None"
_RULES = {
    "threads": (_is_whole, _WHOLE, "are 0 (all cores) to 1024"),
    "episodes": (_is_whole, _WHOLE, "are 1 to 10000000"),
    "sample": (_is_whole, _WHOLE, "are 1 to 1000000, or None"),
    "seed": (_is_whole, _WHOLE, f"are 0 to {2**64 - 1}"),
    "speed": (_is_number, _NUMBER, "are values above 0, m/s, or None"),
    "turn_speed": (_is_number, _NUMBER, "are values above 0, rad/s, or None"),
    "chord": (_is_number, _NUMBER, "are values above 0, m, or None"),
    "rate": (_is_number, _NUMBER, "are numbers > 0, at most 100000, or None"),
    "client": (_is_client, "{type}", "is a dask.distributed.Client, or None"),
    "object": (_is_text, "{value}", "is a name of a scene object, or None"),
    "arm": (_is_text, "{value}", "is a name of an arm of the workcell, or None"),
    "best": (_is_criteria, "{value}", "are clearance, cost, margin, slide, speed"),
    "hold": (_is_ranges, "{value}", "is a mapping of names of joints to what x may be, or None"),
    "poses": (_is_mapping, "{type}", "is a mapping of names of scene objects, or None"),
    "rows": (
        _is_rows, "{type}",
        "are an Answer, a Motion, a Trajectory, a list of Parts, a dict of arms, or a file"
    ),
    **dict.fromkeys(("timeout", "timeout_each"), _TIMEOUT),
    **dict.fromkeys("prove explain evidence refine refine_grid path base".split(), _TRUTH),
    **dict.fromkeys("progress check check_motions cost".split(), _FUNCTION),
    **dict.fromkeys("x y z roll pitch yaw".split(), _RANGE),
}
# Shapes of arrays of poses and of joints.
POSES = "(n, 7) and (n, 4, 4)"
JOINTS = "(n, 7), rad"
# The least and the greatest of whole numbers.
_ENDS = {"threads": (0, 1024), "episodes": (1, 10**7), "sample": (1, 10**6), "seed": (0, 2**64 - 1)}


def _shown(value):
    """Returns a value in words of one short line, or else its type."""
    text = repr(value)
    return text if len(text) <= 40 and "\n" not in text else type(value).__name__


def require(**given):
    """Raises TypeError for the first of these arguments that is of a wrong type.

    Raises InvalidArgument for a whole number out of its range. Arguments of other names are left
    to what reads them.
    """
    for name, value in given.items():
        if name not in _RULES:
            continue
        is_right, fault, allowed = _RULES[name]
        if value is None and allowed.endswith("or None"):
            continue
        if not is_right(value):
            fault = fault.format(value=_shown(value), type=type(value).__name__)
            raise TypeError(f"{name}: {fault}: allowed {allowed}")
        if name in _ENDS and not _ENDS[name][0] <= value <= _ENDS[name][1]:
            raise _swivel.InvalidArgument(f"{name}: {_shown(value)}: allowed {allowed}")


def numbers_of(name, given, allowed=POSES):
    """Returns an argument as an array of numbers.

    Raises InvalidArgument for what is none, and for numbers of which a part would be lost: masks
    and imaginary parts. What an object's own __array__ raises is the cause of the exception.
    """
    parts = given if isinstance(given, (list, tuple)) else ()
    if any(map(np.ma.is_masked, (given, *parts))):
        raise _swivel.InvalidArgument(
            f"{name}: has masked numbers: allowed are {allowed}, none of them masked"
        )
    fault = f"{name}: not an array of numbers"
    try:
        array = np.asarray(given)
    except Exception as error:
        raise _swivel.InvalidArgument(f"{fault}: allowed are {allowed}") from error
    if array.dtype.kind not in "biuf":
        raise _swivel.InvalidArgument(f"{fault} but of {array.dtype.name}: allowed are {allowed}")
    return array


def paths_of(given):
    """Returns an array of waypoints for each path. Raises as numbers_of() does."""
    allowed = "(n, m, 7), (n, m, 4, 4), or a sequence of (m, 7) or (m, 4, 4)"
    if hasattr(given, "__array__"):
        given = numbers_of("paths", given, allowed)
    try:
        rows = list(given)
    except TypeError as error:
        raise _swivel.InvalidArgument(f"paths: not a sequence: allowed are {allowed}") from error
    rows = [numbers_of(f"paths: row {k}", row) for k, row in enumerate(rows)]
    if rows and rows[0].shape in ((7,), (4, 4)):
        raise _swivel.InvalidArgument(
            f"paths: one path, of shape {(len(rows), *rows[0].shape)}: allowed are {allowed}; "
            "[path] for one alone"
        )
    return rows

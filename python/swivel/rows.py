# SPDX-License-Identifier: BSD-3-Clause
"""Trajectories and motions as sequences of rows, as arrays and as data frames."""
from __future__ import annotations

import collections.abc
import operator

import numpy as np

from . import _swivel


class TrajectoryRow(tuple):
    """One row of a trajectory or motion: numbers in the order of its columns, with names.

    Columns are attributes (row.s, row.joint_1) and keys (row["joint-1"]); `joints` has all joints,
    (7,), rad. pandas takes the names for those of its columns.
    """

    def __new__(cls, names, values, joints):
        self = super().__new__(cls, values)
        self._fields, self._joints = tuple(names), joints
        return self

    @property
    def joints(self) -> _Array:
        """(7,), rad, base to tip; a read-only view of the rows."""
        return self._joints

    def __getitem__(self, key):
        if isinstance(key, str):
            if key not in self._fields:
                raise KeyError(f"no column {key!r}: allowed are {', '.join(self._fields)}")
            return super().__getitem__(self._fields.index(key))
        return super().__getitem__(key)

    def __getattr__(self, name: str) -> float:
        fields = self.__dict__.get("_fields", ())
        if name in fields:
            return super().__getitem__(fields.index(name))
        raise AttributeError(f"a row has no {name!r}: allowed are {', '.join(fields)}, joints")

    def __reduce__(self):
        return TrajectoryRow, (self._fields, tuple(self), self.joints)

    def __repr__(self):
        return f"TrajectoryRow({', '.join(f'{n}={v!r}' for n, v in zip(self._fields, self))})"


def _columns(rows):
    """Returns name -> (n,) array of all columns, in the order in which files have them."""
    names = list(rows.joint_names)
    leading = ["t"] if hasattr(rows, "t") else []
    leading += ["part", "process"] if hasattr(rows, "part") else []
    # Arms of six joints have their roll as their last joint.
    leading += ["s", "phi", "branch"] + ([] if "roll" in names else ["roll"])
    columns = {name: getattr(rows, name) for name in leading}
    columns.update(zip(names, rows.joints.T))
    for ending, member in (("_v", "velocities"), ("_a", "accelerations")):
        if hasattr(rows, member):
            columns.update((name + ending, c) for name, c in zip(names, getattr(rows, member).T))
    return columns


def _array(self, dtype: DTypeLike = None, copy: bool | None = None) -> NDArray[Any]:
    """Returns the joints, (n, 7), rad: what numpy.asarray() makes of the rows."""
    joints = self.joints
    if dtype is not None and np.dtype(dtype) != joints.dtype:
        if copy is False:
            raise ValueError(f"dtype {np.dtype(dtype)}: needs a copy: allowed with copy=False is "
                             f"{joints.dtype}")
        return joints.astype(dtype)
    return joints.copy() if copy else joints


def _row(rows, columns, k):
    return TrajectoryRow(columns, (column[k].item() for column in columns.values()), rows.joints[k])


def _getitem(self, k: SupportsIndex) -> TrajectoryRow:
    """Returns the k-th row, a TrajectoryRow. Trajectories also have slices, which are trajectories.

    Raises IndexError.
    """
    if isinstance(k, slice):
        if not isinstance(self, _swivel.Trajectory):
            raise TypeError(f"a slice of a {type(self).__name__}: allowed is the number of a row")
        names = self.joint_names
        return _swivel.Trajectory(
            self.joints[k], self.s[k], self.phi[k], self.branch[k], names,
            None if "roll" in names else self.roll[k]
        )
    index = operator.index(k)
    if not -len(self) <= index < len(self):
        raise IndexError(f"row {index} of {len(self)}")
    return _row(self, _columns(self), index)


def _iter(self) -> Iterator[TrajectoryRow]:
    """Iterates over the rows, TrajectoryRows."""
    columns = _columns(self)
    return (_row(self, columns, k) for k in range(len(self)))


def _to_dataframe(self) -> Any:
    """Returns a pandas.DataFrame with one row for each row and the columns that files have.

    Lengths are in m, angles in rad and times in s. Needs pandas.
    """
    import pandas

    return pandas.DataFrame({name: np.array(column) for name, column in _columns(self).items()})


def _table(self) -> Any:
    """Returns a pandas.DataFrame with the rows and columns of to_csv().

    Lengths are in m, angles in rad and times in s; what is empty in the file is NaN. Needs pandas.
    """
    import io

    import pandas

    return pandas.read_csv(io.StringIO(self.to_csv()), float_precision="round_trip")


def extend():
    """Gives the classes of the module what is written in this file."""
    for kind in (_swivel.Trajectory, _swivel.Motion):
        for name, method in (
            ("__array__", _array),
            ("__getitem__", _getitem),
            ("__iter__", _iter),
            ("to_dataframe", _to_dataframe),
        ):
            setattr(kind, name, method)
        # Without this, pandas would take the array and lose the names of the columns.
        collections.abc.Sequence.register(kind)
    for kind in (_swivel.Answer, _swivel.Placements, _swivel.Episodes, _swivel.Plans):
        kind.to_dataframe = _table

# SPDX-License-Identifier: BSD-3-Clause
"""Plans joint trajectories along tool paths for arms with a degree of freedom to spare.

Units are metres, radians and seconds. Arguments that are poses may be (4, 4) arrays or
[x y z qw qx qy qz], w first; results are (4, 4) arrays. Joints are (n, 7) float64 arrays, base to
tip. Arrays in results are read-only views, which keep alive what they show. Trajectories and
motions are sequences of rows; numpy.asarray() takes their joints, and pandas.DataFrame() all
columns.

    problem = swivel.load("problem.yaml")
    plan = swivel.plan(problem)
    if plan.solved:
        print(plan.joints)
    else:
        print(plan.diagnosis.cause)

A problem has one path, many strokes, or two arms. load() reads every kind, and plan(), check(),
time(), place(), campaign(), plan_many(), report() and certificate() take every kind.
"""
from __future__ import annotations as _annotations

import functools as _functools
import os as _os

import numpy as _np

from . import _swivel
from ._swivel import *  # noqa: F401,F403
from ._swivel import __version__  # noqa: F401
from . import drawings as _drawings
from . import rows as _rows
from .arguments import require as _require
from .drawings import (  # noqa: F401
    certificate,
    check_certificate,
    load_certificate,
    map_svg,
    report,
)
from .rows import TrajectoryRow  # noqa: F401
from .runs import _loaded, campaign, place, plan_many  # noqa: F401

__all__ = [name for name in vars(_swivel) if not name.startswith("_")]


def _restore(kind, state):
    """Returns an unpickled object, or raises.

    pickle's own way leaves an object without contents if its last step is damaged.
    """
    thing = kind.__new__(kind)
    thing.__setstate__(state)
    return thing


for _name in __all__:
    _thing = getattr(_swivel, _name)
    _thing.__module__ = __name__
    if hasattr(_thing, "__members__"):
        _thing.__reduce__ = lambda member: (getattr, (type(member), member.name))
    elif hasattr(_thing, "__setstate__") and not issubclass(_thing, Exception):
        _thing.__reduce__ = lambda thing: (_restore, (type(thing), thing.__getstate__()))
for _thing in (
    TrajectoryRow, campaign, certificate, check_certificate, load_certificate, map_svg, place,
    plan_many, report
):
    _thing.__module__ = __name__
_rows.extend()

# Words of a Problem -> the kinds of problems that have them; the others are of all kinds.
_OF_KINDS = {name: ("one path", "strokes") for name in vars(Robot)}  # noqa: F405
_OF_KINDS.update(
    dict.fromkeys("scene robot limits resolution cost refinement".split(), ("one path", "strokes"))
)
_OF_KINDS.update(
    dict.fromkeys(
        "task waypoints frame smooth start start_at start_tolerance end closed".split(),
        ("one path",),
    )
)
_OF_KINDS.update(
    dict.fromkeys(
        "strokes home order approach retract process_speed approach_speed rapid lift".split(),
        ("strokes",),
    )
)


def _require_word(problem, name):
    """Raises AttributeError for a word that problems of another kind have."""
    kinds = _OF_KINDS.get(name, ()) if not name.startswith("_") else ()
    if kinds and problem._kind() not in kinds:
        raise AttributeError(
            f"{name}: of a problem of {problem._kind()}: allowed with {' or '.join(kinds)}"
        )


def _get_word(self, name):
    _require_word(self, name)
    return object.__getattribute__(self, name)


def _set_word(self, name, value):
    _require_word(self, name)
    object.__setattr__(self, name, value)


Problem.__getattribute__, Problem.__setattr__ = _get_word, _set_word  # noqa: F405


def _requiring(method):
    """Returns a method of the module that refuses keywords of a wrong type by their names."""

    @_functools.wraps(method)
    def required(self, *values, **keywords):
        _require(**keywords)
        return method(self, *values, **keywords)

    return required


for _name in ("plan", "clearance", "refine", "time", "advise"):
    setattr(Planner, _name, _requiring(getattr(Planner, _name)))  # noqa: F405
_drawings.extend()
# A planner is its problem: what it remembers of earlier plans only saves time.
Planner.__reduce__ = lambda planner: (Planner, (planner.problem,))  # noqa: F405
__all__ += [
    "TrajectoryRow",
    "advise",
    "campaign",
    "certificate",
    "check",
    "check_certificate",
    "compute_cartesian_path",
    "load_certificate",
    "load_trajectory",
    "map_svg",
    "measure",
    "place",
    "plan",
    "plan_many",
    "refine",
    "report",
    "time",
]


def _planner(problem):
    problem = _loaded(problem)
    kind = problem._kind()
    if kind != "one path":
        words = "of two arms" if kind == "two arms" else "with strokes"
        raise InvalidArgument(  # noqa: F405
            f"a problem {words}: allowed are problems of one path"
        )
    return Planner(problem)  # noqa: F405


def _refuse(problem, kinds, **given):
    """Raises InvalidArgument for a keyword that was given and that only these kinds have."""
    for name, value in given.items():
        if value is not None and value is not False and problem._kind() not in kinds:
            raise InvalidArgument(  # noqa: F405
                f"{name}: of a problem of {problem._kind()}: allowed with {' or '.join(kinds)}"
            )


def plan(
    problem: Problem | _File,
    *,
    planner: _PlannerKind = "parallel",
    threads: int = 0,
    timeout: float | None = None,
    prove: bool = True,
    evidence: bool = False,
    check: _Check | None = None,
    check_motions: _MotionCheck | None = None,
    cost: _Check | None = None,
    progress: _Progress | None = None,
    refine: bool = False,
    speed: float | None = None,
    turn_speed: float | None = None,
    rate: float | None = None,
    chord: float | None = None,
) -> Answer:
    """Plans one problem, once.

    problem: a Problem, or the name of its file. The others are those of Planner.plan(); check,
    check_motions and cost are not of two arms; of strokes check is also asked about states along
    transitions, at most 0.05 rad (or m) of a joint apart, and cost about rows of runs. With speed,
    turn_speed, rate or chord strokes have a motion in time; speed holds instead of their speeds and
    feeds. Two arms have one with speed, that of the faster tool (a follower's on its leader's), by
    one clock.

    Returns an Answer; no answer is one, not an exception. Raises InputError and InvalidArgument for
    a problem that makes no sense, and what a function raised.
    """
    problem = _loaded(problem)
    own = dict(check=check, check_motions=check_motions, cost=cost)
    _refuse(problem, ("one path", "strokes"), **own)
    _require(threads=threads, timeout=timeout, prove=prove, evidence=evidence, refine=refine)
    _require(progress=progress, speed=speed, turn_speed=turn_speed, rate=rate, chord=chord, **own)
    return _swivel._plan(
        problem, planner, threads, timeout, prove, evidence, *own.values(), progress, refine,
        speed, turn_speed, rate, chord
    )


def check(
    problem: Problem | _File, rows: _Rows, *, speed: float | None = None
) -> Check:
    """Proves rows from the problem alone, or says what is wrong with them.

    problem: a Problem, or the name of its file. rows: what plan() or time() returned, or the name
    of a file of a trajectory or a motion, of any format; of one path also a Trajectory, of strokes
    a list of Parts, of two arms name -> Trajectory or name -> Motion. speed: m/s along all strokes,
    where a motion was made with it.

    Returns a Check. Raises InputError and InvalidArgument.
    """
    problem = _loaded(problem)
    _refuse(problem, ("strokes",), speed=speed)
    _require(rows=rows, speed=speed)
    return _swivel._check(problem, rows, speed)


def load_trajectory(
    file: _File, joint_names: Sequence[str] | None = None, problem: Problem | _File | None = None
) -> Any:
    """Loads rows from any file that `swivel check` reads: CSV, JSON, YAML or MCAP.

    problem: a Problem, or the name of its file, from which what the file does not state (s, phi,
    branch, roll, of motions speeds and accelerations) is worked out; needed for strokes and two
    arms. joint_names: those of the file; None: those of the problem.

    Returns a Motion where the file has times, else a Trajectory, of strokes a list of Parts, of two
    arms name -> Trajectory. Raises InputError.
    """
    if problem is None:
        return _swivel._load_stated(file, list(joint_names or ()))
    return _swivel._load_trajectory(file, _loaded(problem), list(joint_names or ()))


def measure(problem: Problem | _File, trajectory: Trajectory) -> Measures:
    """Measures what a trajectory comes near to and how well it follows its path.

    Arguments and result are those of Planner.measure(). problem: a Problem of one path, or the name
    of its file.
    """
    return _planner(problem).measure(trajectory)


def refine(
    problem: Problem | _File, trajectory: Trajectory, *, timeout: float | None = None
) -> Refined:
    """Moves the arm angles of a trajectory off the grid, as Planner.refine() does.

    problem: a Problem of one path, or the name of its file. timeout: s, or None.
    """
    return _planner(problem).refine(trajectory, timeout=timeout)


def time(
    problem: Problem | _File, rows: _Rows, *, speed: float | None = None,
    turn_speed: float | None = None, rate: float = 250.0, chord: float | None = None,
    refine: bool = False, timeout: float | None = None
) -> Motion:
    """Makes rows a motion in time, and proves it.

    problem: a Problem, or the name of its file. rows: as of check(); the times of a motion are left
    aside. speed: m/s of the tool; without it those of the problem's strokes and limits hold.
    turn_speed: rad/s. rate: samples a second. chord: m; slower where a
    tool would leave its path by more between samples. refine: refine the rows first. timeout: s, or
    None. plan() with a speed plans rows that are sure to keep what
    motions keep.

    Returns a Motion. Raises InputError, InvalidArgument and TimeoutError.
    """
    problem = _loaded(problem)
    _require(rows=rows, speed=speed, turn_speed=turn_speed, chord=chord)
    _require(rate=rate, refine=refine, timeout=timeout)
    return _swivel._time(problem, rows, speed, turn_speed, rate, chord, refine, timeout)


def advise(problem: Problem | _File, plan: Answer, *, timeout: float = 1.0) -> AdviceList:
    """Finds changes that would help a problem that has no answer, each planned alone.

    problem: a Problem, or the name of its file. plan: what plan() returned. timeout: s, for all of
    them.

    Returns an AdviceList.
    """
    problem = _loaded(problem)
    _require(timeout=timeout)
    return _swivel._advise(problem, plan, timeout)


def compute_cartesian_path(
    robot: Robot, scene: Iterable[SceneObject], waypoints: ArrayLike, start: ArrayLike | None, *,
    max_step: float = 0.005, limits: Limits | None = None, **options: Any
) -> tuple[float, Trajectory]:
    """Follows straight lines through waypoints from a given posture, as far as possible.

    robot: Robot. scene: Scene, or any sequence of SceneObjects. waypoints: poses of the tool in the
    base frame, which follow that of the start: (n, 7) rows x y z qw qx qy qz, (n, 4, 4), or a list
    of either; m. start: (7,) joints, rad; if None, the path begins at the first waypoint, in the
    posture that suits it best. max_step: largest distance between rows, m. limits: Limits, or None
    for the defaults. options: those of Planner.plan().

    Returns (fraction, trajectory). If there is a path, these are 1.0 and the whole Trajectory;
    otherwise the share of the rows that can be reached, and these rows. A start in collision gives
    0.0. Raises InputError and InvalidArgument for values that no problem may have.
    """
    task = Task(  # noqa: F405
        waypoints,
        limits=limits if limits is not None else Limits(),  # noqa: F405
        resolution=Resolution(ds=max_step),  # noqa: F405
        start=start,
    )
    if start is not None:
        here = _np.array([robot.tool_pose(start)])
        task.waypoints = here
        ahead = Task(waypoints).waypoints  # noqa: F405
        first = _np.concatenate(
            [task.waypoints[0], ahead[0][7:] if len(ahead) else []]
        )  # with the window of the roll, if any
        if (
            len(ahead)
            and _np.abs(ahead[0][:3] - first[:3]).max() < 1e-6
            and 1 - abs(ahead[0][3:7] @ first[3:7]) < 5e-13
        ):
            ahead = ahead[1:]  # the start itself
        task.waypoints = _np.vstack([first[None], ahead])
    planner = Planner(robot, task, scene)  # noqa: F405
    result = planner.plan(**options)
    if result.solved:
        return 1.0, result.trajectory
    reached = result.partial
    return max(0, len(reached) - 1) / max(1, planner._rows_of_path() - 1), reached

# SPDX-License-Identifier: BSD-3-Clause
"""Plans joint trajectories along tool paths for arms with a degree of freedom to spare.

Units are metres, radians and seconds. Arguments that are poses may be (4, 4) arrays or
[x y z qw qx qy qz], w first; results are (4, 4) arrays. Joints are (n, 7) float64 arrays, base to
tip. Arrays in results are read-only views, which keep alive what they show. Trajectories and
motions are sequences of rows; numpy.asarray() takes their joints, and pandas.DataFrame() all
columns.

    problem = swivel.load_problem("problem.yaml")
    plan = swivel.plan(problem)
    if plan.solved:
        print(plan.joints)
    else:
        print(plan.diagnosis.cause)

A job of many strokes is loaded by load_job() and planned by plan_job(); Two arms are loaded by
load_workcell() and planned by plan_workcell(). place() and campaign() take all three.
"""
from __future__ import annotations as _annotations

import os as _os

import numpy as _np

from . import _swivel
from ._swivel import *  # noqa: F401,F403
from ._swivel import __version__  # noqa: F401
from . import drawings as _drawings
from . import rows as _rows
from .drawings import certificate, check_certificate, map_svg, report  # noqa: F401
from .rows import TrajectoryRow  # noqa: F401
from .runs import campaign, place  # noqa: F401

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
for _thing in (TrajectoryRow, campaign, certificate, check_certificate, map_svg, place, report):
    _thing.__module__ = __name__
_rows.extend()
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
    "map_svg",
    "measure",
    "place",
    "plan",
    "refine",
    "report",
    "time",
]


def _planner(problem):
    if isinstance(problem, (str, _os.PathLike)):
        problem = load_problem(problem)  # noqa: F405
    return Planner(problem)  # noqa: F405


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
) -> Plan:
    """Plans one problem, once.

    problem: a Problem, or the name of its file. The others are those of Planner.plan().

    Returns a Plan. Raises InputError and InvalidArgument for a problem that makes no sense.
    """
    return _planner(problem).plan(
        planner=planner,
        threads=threads,
        timeout=timeout,
        prove=prove,
        evidence=evidence,
        check=check,
        check_motions=check_motions,
        cost=cost,
        progress=progress,
        refine=refine,
        speed=speed,
        turn_speed=turn_speed,
        rate=rate,
        chord=chord,
    )


def check(problem: Problem | _File, trajectory: Trajectory | Motion) -> Check:
    """Proves a Trajectory or a Motion from the problem alone, as Planner.check() does.

    problem: a Problem, or the name of its file.
    """
    return _planner(problem).check(trajectory)


def measure(problem: Problem | _File, trajectory: Trajectory) -> Measures:
    """Measures what a trajectory comes near to and how well it follows its path.

    Arguments and result are those of Planner.measure(). problem: a Problem, or the name of its
    file.
    """
    return _planner(problem).measure(trajectory)


def refine(
    problem: Problem | _File, trajectory: Trajectory, *, timeout: float | None = None
) -> Refined:
    """Moves the arm angles of a trajectory off the grid, as Planner.refine() does.

    problem: a Problem, or the name of its file. timeout: s, or None.
    """
    return _planner(problem).refine(trajectory, timeout=timeout)


def time(
    problem: Problem | _File, trajectory: Trajectory, *, speed: float | None = None,
    turn_speed: float | None = None, rate: float = 250.0, chord: float | None = None,
    timeout: float | None = None
) -> Motion:
    """Makes a trajectory a motion in time, as Planner.time() does.

    problem: a Problem, or the name of its file. speed: of the tool, m/s; turn_speed: rad/s; without
    them those of the problem's limits hold. rate: samples a second. chord: m. timeout: s, or None.
    """
    return _planner(problem).time(
        trajectory, speed=speed, turn_speed=turn_speed, rate=rate, chord=chord, timeout=timeout
    )


def advise(problem: Problem | _File, plan: Plan, *, timeout: float = 1.0) -> list[Advice]:
    """Finds changes that would help a problem that has no path, as Planner.advise() does.

    problem: a Problem, or the name of its file. plan: its Plan. timeout: s.
    """
    return _planner(problem).advise(plan, timeout=timeout)


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

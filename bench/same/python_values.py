# SPDX-License-Identifier: BSD-3-Clause
"""Plans a problem with the Python module and prints its answer as JSON. It is the only place of
bench/same_answers that knows names of the module: where these change, this file follows, and what
it prints stays, so that it can be compared with what an earlier module printed.

python_values.py KIND FILE   KIND is `path`, `job` or `workcell`"""
import json
import math
import pathlib
import sys

import swivel


def plain(value):
    """The value as JSON can have it: arrays as lists, members of enums as their names."""
    if value is None or isinstance(value, (bool, int, float, str)):
        return value
    if isinstance(value, dict):
        return {str(key): plain(member) for key, member in value.items()}
    if hasattr(value, "tolist"):
        return value.tolist()
    if isinstance(value, (list, tuple)):
        return [plain(element) for element in value]
    return str(value)


def rows(trajectory):
    """Rows of one arm."""
    return plain(
        {name: getattr(trajectory, name) for name in ("s", "phi", "branch", "roll", "joints")}
    )


def cause(value):
    """What stops paths."""
    names = ("kind", "side", "joint", "bodies", "object", "value", "limit", "over", "unit", "check")
    return plain({name: getattr(value, name) for name in names})


def diagnosis(value):
    """Why there is no path, or nothing."""
    if value is None:
        return None
    names = ("reached_layer", "reached_s", "at_s", "waypoints", "without_it", "holds", "complete")
    found = {name: getattr(value, name) for name in names}
    return plain({**found, "cause": cause(value.cause), "together": [*map(cause, value.together)]})


def measures(value):
    """What was measured along rows."""
    names = ("min_clearance", "min_clearance_status", "min_manipulability", "arm_angle")
    found = {name: getattr(value, name) for name in names}
    least, limit = value.min_margin, value.nearest_limit
    found["min_margin"] = least and [least.margin, least.required, least.bodies, least.row]
    found["nearest_limit"] = limit and [limit.margin, limit.joint, limit.side, limit.row]
    return plain(found)


def motion(value):
    """A motion in time, or nothing."""
    if value is None or not value.executable:
        return value and [value.reason, value.at_s]
    names = ("t", "joints", "velocities", "accelerations", "duration", "warnings")
    return plain({name: getattr(value, name) for name in names})


def saved(problem):
    """The problem as it is written into a file beside its own."""
    place = pathlib.Path("made/saved.yaml")
    place.parent.mkdir(exist_ok=True)
    problem.save(place)
    text = place.read_text()
    place.unlink()
    return text


def check(value):
    """Whether a check passed, and what failed."""
    return plain({"passed": value.passed, "failures": value.failures})


def path(file):
    """The answer to a problem with one path."""
    problem = swivel.load(file)
    planner = swivel.Planner(problem)
    plan = planner.plan(planner="lazy", threads=1, speed=0.05, rate=25.0)
    found = {
        name: getattr(plan, name)
        for name in ("status", "solved", "cost", "counters", "joint_names", "held", "warnings")
    }
    found.update(
        waypoints=problem.waypoints, lattice=plan.lattice.nodes, rows=rows(plan.trajectory)
    )
    found.update(partial=rows(plan.partial), diagnosis=diagnosis(plan.diagnosis))
    found.update(measures=measures(plan.measures), motion=motion(plan.motion))
    again = swivel.Planner(swivel.Problem(problem.robot, problem.task, problem.scene))
    found["from_memory"] = again.plan(planner="lazy", threads=1).cost
    found["saved"] = saved(problem)
    if plan.solved:
        found["check"] = check(planner.check(plan.trajectory))
        found["refined"] = planner.refine(plan.trajectory).cost
    return found


def parts(values):
    """Strokes and transitions of a job."""
    names = ("stroke", "reversed", "begin", "cost", "joints", "process")
    return [plain({name: getattr(part, name) for name in names}) for part in values]


def job(file):
    """The answer to a job."""
    plan = swivel.plan(file, planner="lazy", threads=1, speed=0.05, rate=25.0)
    names = (
        "status",
        "solved",
        "cost",
        "bound",
        "bound_any",
        "bound_orders",
        "gap",
        "no_transition",
        "barred_by",
        "counters",
        "transition_counters",
        "joint_names",
        "held",
        "warnings",
    )
    found = {name: getattr(plan, name) for name in names}
    if not plan.solved:
        raise ValueError(f"the plan has no job: {plan.status}")
    found.update(parts=parts(plan.parts), partial=parts(plan.partial_parts), csv=plan.to_csv())
    found["runs"] = [
        [
            run.stroke,
            run.reversed,
            run.status,
            run.least_cost,
            run.cost,
            diagnosis(run.diagnosis),
            measures(run.measures),
        ]
        for run in plan.runs
    ]
    found["lift_offs"] = [
        [lift.stroke, lift.end, lift.resumed, lift.reached] for lift in plan.lift_offs
    ]
    found["saved"] = saved(swivel.load(file))
    timed = plan.motion
    found["motion"] = motion(timed)
    if timed is not None and timed.executable:
        found["events"] = [[event.t, event.stroke, event.s, event.on] for event in timed.events]
    if plan.solved:
        found["check"] = check(swivel.check(file, plan))
    return found


def workcell(file):
    """The answer to a workcell."""
    plan = swivel.plan(file, planner="lazy", threads=1, speed=0.05, rate=25.0)
    arms, timed = plan.arms, plan.motion
    found = {
        "status": plan.status,
        "solved": plan.solved,
        "names": list(arms),
        "given": next((name for name, arm in arms.items() if arm.given), None),
        "cost": plan.cost or 0.0,
        "bound": math.inf if plan.bound is None else plan.bound,
        "least_costs": [
            math.inf if arm.least_cost is None else arm.least_cost for arm in arms.values()
        ],
    }
    names = ("decided_by", "conflict", "clearance", "clearance_status", "warnings")
    found.update({name: getattr(plan, name) for name in names})
    found["not_executable"] = timed and timed.reason
    found["rows"] = {name: rows(arm.trajectory) for name, arm in arms.items() if plan.solved}
    found["diagnoses"] = {name: diagnosis(arm.diagnosis) for name, arm in arms.items()}
    made = timed.arms if timed and timed.executable else {}
    found["motions"] = {name: motion(value) for name, value in made.items()}
    if plan.solved:
        found["check"] = check(swivel.check(file, plan))
    return found


def main():
    """Prints the answer, or the error by its class."""
    try:
        found = {"path": path, "job": job, "workcell": workcell}[sys.argv[1]](sys.argv[2])
    except (ValueError, RuntimeError) as error:
        found = {"error": type(error).__name__, "message": str(error)}
    json.dump(plain(found), sys.stdout, indent=0)


main()

#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Verifies motions knowing only the problem's files and the CSV that the program wrote: nothing of
Swivel's code, numpy alone.

motions.py SWIVEL PROBLEM [--episodes N] [--seed S] [--speeds V ...] [--between 10] [--keep FOLDER]

Each of N random poses (without --episodes: the problem as it is) is planned, refined and timed at
each speed, at 1000 and at 250 samples a second. Then, of the files alone:
  rates      largest speed, acceleration and jerk of any joint by differences at 1000 Hz, at rest
             before and after, over the limits (URDF, else the problem's, else 10 rad/s^2 and
             100 rad/s^3)
  over ideal duration at 1000 Hz, times the speed, over the length of the path
  clearance  least distance of any two bodies, at the samples of 250 Hz and at --between
             points of the straight line of joints from each to the next
  off path   largest distance of the tool from the polyline and its turn away from it, at all of
             these points
  chord      largest distance of the tool between samples from its curve, which is a cubic through
             the tool at four samples
One line a motion; below, the worst, and in how many all holds. Ends with 1 where one does not.
"""
import argparse
import itertools
import json
import pathlib
import subprocess
import sys
import tempfile

import numpy as np

from moving_bodies import Cell
from problem_files import load_columns, load_problem, load_waypoints, rotation

BAND = 0.05e-3  # m: a clearance may be missed by so much
# How far motions may round corners, m and rad, where path.smooth is not given.
ALLOWED_POSITION, ALLOWED_ANGLE = 0.1e-3, 1e-3


def limits_of(problem, robot):
    """Speed, acceleration and jerk of the seven joints."""
    given = problem.get("limits") or {}

    def of(key, attribute, default):
        if key in given:
            return np.broadcast_to(np.array(given[key], float), 7)
        return np.array([robot.joints[name]["limit"].get(attribute, default) for name in robot.arm])

    return (
        of("joint_speed", "velocity", 0), of("joint_acceleration", "acceleration", 10),
        of("joint_jerk", "jerk", 100)
    )


def rate_ratios(t, q, limits):
    """Largest differences of the first three orders over the limits; the motion rests before and
    after."""
    dt = (t[-1] - t[0]) / (len(t) - 1)
    if np.abs(np.diff(t) - dt).max() > 1e-9:
        raise ValueError("samples are not evenly spaced")
    padded = np.concatenate([np.repeat(q[:1], 3, 0), q, np.repeat(q[-1:], 3, 0)])
    return [
        float((np.abs(np.diff(padded, order, axis=0)).max(0) / dt**order / limit).max())
        for order, limit in enumerate(limits, 1)
    ]


def densified(q, between):
    """Points on the straight lines from row to row besides the rows: (N - 1) (between + 1) + 1 of
    them."""
    t = np.arange(between + 1)[None, :, None] / (between + 1)
    lines = q[:-1, None] + t * (q[1:] - q[:-1])[:, None]
    return np.concatenate([lines.reshape(-1, q.shape[1]), q[-1:]])


def turn_between(A, B):
    """Angle from rotations A to B, (N, 3, 3); accurate for small ones."""
    return 2 * np.arcsin(
        np.minimum(1, np.linalg.norm((A - B).reshape(len(A), -1), axis=-1) / np.sqrt(8))
    )


def axis_angle(R):
    sine = np.array([R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]]) / 2
    size = np.linalg.norm(sine)
    return (sine / size if size > 0 else np.array([0, 0, 1.0])), np.arctan2(
        size, (np.trace(R) - 1) / 2
    )


def off_path(positions, rotations, waypoints):
    """Largest distance from the polyline of waypoints, and largest turn away from the orientation
    at the nearest point."""
    at, turned = waypoints
    nearest, turn = np.full(len(positions), np.inf), np.zeros(len(positions))
    for k in range(len(at) - 1):
        way = at[k + 1] - at[k]
        share = np.clip((positions - at[k]) @ way / (way @ way), 0, 1)
        away = np.linalg.norm(positions - at[k] - share[:, None] * way, axis=-1)
        axis, angle = axis_angle(turned[k].T @ turned[k + 1])
        closer = away < nearest
        nearest[closer] = away[closer]
        turn[closer] = turn_between(
            rotations[closer], turned[k] @ rotation(axis, share[closer] * angle)
        )
    return float(nearest.max()), float(turn.max())


def chord_error(tools, between):
    """tools: (N - 1) (between + 1) + 1 positions of the tool, the rows' own among them. Away from a
    cubic through four rows, not along it."""
    step = between + 1
    rows = tools[::step]
    n = len(rows) - 1
    first = np.clip(np.arange(n) - 1, 0, n - 3)
    worst = 0.0
    for part in range(1, step):
        x = np.arange(n) - first + part / step
        curve = np.zeros((n, 3))
        for i in range(4):
            weight = np.prod([(x - j) / (i - j) for j in range(4) if j != i], axis=0)
            curve += weight[:, None] * rows[first + i]
        off = tools[part::step] - curve
        way = rows[1:] - rows[:-1]
        length = np.maximum((way * way).sum(-1), 1e-24)
        off -= ((off * way).sum(-1) / length)[:, None] * way
        worst = max(worst, float(np.linalg.norm(off, axis=-1).max()))
    return worst


def joints_of(columns, robot):
    return np.stack([columns[name] for name in robot.arm], -1)


def waypoints_in_base(problem, cell):
    at, turned = load_waypoints(problem)
    frame = cell.frames.get(problem["path"].get("frame", cell.robot.base), np.eye(4))
    return at @ frame[:3, :3].T + frame[:3, 3], frame[:3, :3] @ turned


def examine(problem, cell, fast, slow, speed, between):
    """What is measured of a motion. fast, slow: columns of its CSV at 1000 and 250 samples a
    second."""
    limits = problem.get("limits") or {}
    robot = cell.robot
    waypoints = waypoints_in_base(problem, cell)
    length = float(np.linalg.norm(np.diff(waypoints[0], axis=0), axis=-1).sum())
    found = dict(
        zip(
            ("speed", "acceleration", "jerk"),
            rate_ratios(fast["t"], joints_of(fast, robot), limits_of(problem, robot)),
        )
    )
    found["over_ideal"] = float(fast["t"][-1] * speed / length)
    q = joints_of(slow, robot)
    dense = densified(q, between)
    links = robot.forward(dense)
    rotations, positions = robot.tool_pose(links)
    found["off_position"], found["off_angle"] = off_path(positions, rotations, waypoints)
    found["chord"] = chord_error(positions, between)
    found["inside"] = cell.in_contact_inside(q[0])
    found["clearance_at_samples"], _ = cell.least_clearance(q)
    found["clearance"], found["pair"] = cell.least_clearance(dense)
    asked = limits.get("clearance", 0.005)
    smooth = problem["path"].get("smooth") or {}
    rounding = smooth.get("position", ALLOWED_POSITION), smooth.get("angle", ALLOWED_ANGLE)
    micrometre = 1e-5  # m and rad: what straight lines of joints add to the rounding
    found["holds"] = {
        "rates": max(found[rate] for rate in ("speed", "acceleration", "jerk")) <= 1,
        "clearance": not found["inside"]
        and min(found["clearance"], found["clearance_at_samples"]) >= asked - BAND,
        "path": found["off_position"] <= rounding[0] + micrometre
        and found["off_angle"] <= rounding[1] + micrometre,
        "ends": bool(
            np.allclose(
                robot.tool_pose(robot.forward(q[[0, -1]]))[1], waypoints[0][[0, -1]], atol=1e-6
            )
        ),
    }
    return found


def run(command, allowed=(0,)):
    done = subprocess.run([str(part) for part in command], capture_output=True, text=True)
    if done.returncode not in allowed:
        sys.exit(f"{' '.join(map(str, command))}: ended with {done.returncode}\n{done.stderr}")
    return done.returncode


def episodes_of(swivel, file, count, seed, folder):
    """Number and moved objects of each pose that has a path; how many have none."""
    if not count:
        return [(None, {})], 0
    table = folder / "episodes.csv"
    run(
        [
            swivel, "campaign", file, "--episodes", count, "--seed", seed, "--planner", "lazy",
            "--out", table
        ]
    )
    lines = [line.split(",") for line in table.read_text().splitlines()]
    names, coordinates = lines[0], ("x", "y", "z", "roll", "pitch", "yaw")
    solved = []
    for line in lines[1:]:
        # The columns after `reason`, where commas may be, count from the end.
        row = dict(zip(names, line))
        if row["status"] != "solved":
            continue
        moved = {}
        for name in names:
            if "." in name:
                thing, coordinate = name.rsplit(".", 1)
                moved.setdefault(thing, np.zeros(6))[coordinates.index(coordinate)] = float(
                    line[names.index(name) - len(names)]
                )
        solved.append((int(row["episode"]), moved))
    return solved, len(lines) - 1 - len(solved)


def planned(swivel, file, seed, number, speed, rate, folder):
    """Columns of a motion that the program makes, and its JSON."""
    out, result = (
        folder / f"motion_{number}_{speed:g}_{rate}.csv",
        folder / f"motion_{number}_{speed:g}_{rate}.json",
    )
    choice = [] if number is None else ["--seed", seed, "--episode", number]
    code = run(
        [
            swivel, "plan", file, *choice, "--planner", "lazy", "--refine", "--speed", speed,
            "--rate", rate, "--quiet", "--out", out, "--json", result
        ],
        (0, 1),
    )
    return (load_columns(out) if code == 0 else None), json.loads(result.read_text()), out


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("swivel")
    parser.add_argument("problem")
    parser.add_argument("--episodes", type=int, default=0)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--speeds", type=float, nargs="+", default=[0.05, 0.25], help="m/s")
    parser.add_argument("--between", type=int, default=10, help="points between samples")
    parser.add_argument(
        "--keep", type=pathlib.Path, help="folder for the motions, and measured.json"
    )
    arguments = parser.parse_args()
    problem = load_problem(arguments.problem)
    temporary = tempfile.TemporaryDirectory()
    folder = arguments.keep or pathlib.Path(temporary.name)
    folder.mkdir(parents=True, exist_ok=True)
    poses, without = episodes_of(
        arguments.swivel, arguments.problem, arguments.episodes, arguments.seed, folder
    )
    measured, failed = [], 0
    for (number, moved), speed in itertools.product(poses, arguments.speeds):
        name = f"{'' if number is None else number:>4} at {1e3 * speed:3.0f} mm/s"
        fast, _, _ = planned(
            arguments.swivel, arguments.problem, arguments.seed, number, speed, 1000, folder
        )
        slow, result, file = planned(
            arguments.swivel, arguments.problem, arguments.seed, number, speed, 250, folder
        )
        if fast is None or slow is None:
            failed += 1
            print(
                f"{name}: not executable: {(result.get('motion') or {}).get('reason')}", flush=True
            )
            continue
        found = examine(problem, Cell(problem, moved), fast, slow, speed, arguments.between)
        choice = [] if number is None else ["--seed", arguments.seed, "--episode", number]
        found["holds"]["check"] = (
            run([arguments.swivel, "check", arguments.problem, *choice, file], (0, 1)) == 0
        )
        found.update(
            episode=number, asked_speed=speed, time_ms=result["time_ms"],
            stated_between=result["motion"]["between_samples"]
        )
        wrong = [key for key, holds in found["holds"].items() if not holds]
        failed += bool(wrong)
        measured.append(found)
        print(
            f"{name}: rates {found['speed']:.4f} {found['acceleration']:.4f} {found['jerk']:.4f}, "
            f"{found['over_ideal']:.4f} of ideal, "
            f"clearance {1e3 * found['clearance_at_samples']:.4f} {1e3 * found['clearance']:.4f} "
            f"mm ({' - '.join(found['pair'][:2])}), "
            f"off path {1e6 * found['off_position']:.2f} um {1e6 * found['off_angle']:.1f} urad, "
            f"chord {1e6 * found['chord']:.3f} um"
            + (f": {', '.join(wrong).upper()} DO NOT HOLD" if wrong else ""),
            flush=True,
        )
    (folder / "measured.json").write_text(json.dumps(measured, indent=1))
    print(
        f"{len(poses)} poses with a path, {without} without; {len(poses) * len(arguments.speeds)} "
        f"motions, {failed} where not all holds"
    )
    for speed in arguments.speeds:
        of_speed = [found for found in measured if found["asked_speed"] == speed]
        if not of_speed:
            continue
        column = lambda key: np.array([found[key] for found in of_speed])
        print(
            f"{1e3 * speed:.0f} mm/s, {len(of_speed)} motions: most rate "
            f"{max(column(key).max() for key in ('speed', 'acceleration', 'jerk')):.6f}; "
            f"over ideal {np.median(column('over_ideal')):.4f} (median) "
            f"{np.percentile(column('over_ideal'), 95):.4f} (95 %) "
            f"{column('over_ideal').max():.4f} (most); least clearance "
            f"{1e3 * column('clearance_at_samples').min():.4f} mm at samples, "
            f"{1e3 * column('clearance').min():.4f} mm between; off path "
            f"{1e6 * column('off_position').max():.2f} um, "
            f"{1e6 * column('off_angle').max():.1f} urad; chord "
            f"{1e6 * np.median(column('chord')):.3f} um (median) {1e6 * column('chord').max():.3f} "
            "um (most)"
        )
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())

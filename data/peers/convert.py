#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Makes the paths and problems of this folder from clones of the repositories that publish them:

  data/peers/convert.py --cppflow DIR --iklink DIR OUT

writes OUT/paths and OUT/problems. The robots and the straight lines are not made here: README.md
says how they were made. Needs PyYAML.
"""
import argparse
import csv
import math
import pathlib

import yaml

# The thirteen problems for which CppFlow states lengths of TORM.
NAMES = [
    *(
        f"{robot}__{path}"
        for robot in ("fetch_arm", "fetch")
        for path in ("circle", "hello", "rot_yz2", "s", "square")
    ), "panda__1cube", "panda__2cubes", "panda__flappy_bird"
]
# The files of a robot, its base and its tip, and the origins of the frames of paths, all joints at
# zero, in the base. None of these frames is turned.
ROBOTS = {
    "fetch": ("fetch", "base_link", "gripper_link", {"torso_lift_link": (-0.086875, 0, 0.37743)}),
    "panda": ("panda", "panda_link0", "panda_hand", {"world": (0, 0, 0)}),
}
# One step from waypoint to waypoint turns no joint further: 7 degrees, rounded down.
JOINT_STEP = 0.1221
# Paths that turn the tool alone have no length. Rows then lie where CppFlow's waypoints are.
TURNS = {"rot_yz2": 0.0254}
IKLINK = "panda_2023-08-25_11-37-55.csv"
IKLINK_PROBLEM = """\
# One waypoint every 1/30 s: the slowest joint (2.175 rad/s) turns by 0.0725 rad.
robot: {urdf: ../robots/panda.urdf, srdf: ../robots/panda.srdf, base_link: panda_link0, \
tip_link: panda_hand}
path: {frame: panda_link0, file: ../paths/iklink_panda.csv}
lift: {allowed: true, cost: 1.0, overlap: 0}
limits: {clearance: 0, self_clearance: 0, edges: nodes, joint_step: 0.0725}
"""


def quaternion(matrix):
    """w, x, y, z of a rotation by less than half a turn."""
    (a, b, c), (d, e, f), (g, h, i) = matrix
    w = math.sqrt(max(0.0, 1 + a + e + i)) / 2
    if w < 1e-3:
        raise ValueError("a rotation by half a turn")
    return w, (h - f) / (4 * w), (c - g) / (4 * w), (d - b) / (4 * w)


def product(p, q):
    """p q, of length 1."""
    (a, b, c, d), (w, x, y, z) = p, q
    result = (
        a * w - b * x - c * y - d * z, a * x + b * w + c * z - d * y,
        a * y - b * z + c * w + d * x, a * z + b * y - c * x + d * w
    )
    length = math.hypot(*result)
    return [value / length for value in result]


def rows(file):
    with open(file) as lines:
        return [[float(value) for value in row] for row in list(csv.reader(lines))[1:]]


def write_path(file, waypoints):
    """x, y, z, qw, qx, qy, qz, with nine digits and without minus zeros."""
    text = ["x,y,z,qw,qx,qy,qz"]
    for waypoint in waypoints:
        text.append(",".join(f"{value + 0.0:.9g}" for value in waypoint))
    file.write_text("\n".join(text) + "\n")


def placed(robot, problem, waypoints):
    """The waypoints in the robot's base: each is moved, and turned about itself."""
    offset = [
        a + b for a, b in zip(
            ROBOTS[robot][3][problem["path_offset_frame"]], problem["path_xyz_offset"]
        )
    ]
    turn = quaternion(problem["path_R_offset"])
    for _, x, y, z, *q in waypoints:
        yield [*(round(a + b, 9) for a, b in zip((x, y, z), offset)), *product(q, turn)]


def scene(problem):
    """The boxes, one a line. None of them is turned."""
    lines = []
    by = problem.get("obstacle_xyz_offset", (0, 0, 0))
    for number, entry in enumerate(problem.get("obstacles", [])):
        box = {key: value for part in entry for key, value in part.items()}
        if any(box[key] for key in ("roll", "pitch", "yaw")):
            raise ValueError("a box that is turned")
        size = ", ".join(f"{box[f'size_{axis}']:g}" for axis in "xyz")
        at = ", ".join(f"{box[axis] + b:g}" for axis, b in zip("xyz", by))
        lines.append(f"  - {{name: box_{number}, box: [{size}], xyz: [{at}]}}\n")
    return "".join(["scene:\n", *lines]) if lines else ""


def convert_cppflow(source, out):
    for name in NAMES:
        # A path lies in the same place for the arm with the torso and for the arm alone.
        robot = name.split("__")[0].removesuffix("_arm")
        problem = yaml.safe_load((source / f"cppflow/problems/{name}.yaml").read_text())
        path = problem["path_name"]
        write_path(
            out / f"paths/{robot}_{path}.csv",
            placed(robot, problem, rows(source / f"cppflow/paths/{path}.csv")),
        )
        files, base, tip, _ = ROBOTS[robot]
        hold = ", hold: {torso_lift_joint: 0}" if name.startswith("fetch_arm") else ""
        turns = f"resolution: {{dalpha: {TURNS[path]}}}\n" if path in TURNS else ""
        (out / f"problems/{name}.yaml").write_text(
            f"robot: {{urdf: ../robots/{files}.urdf, srdf: ../robots/{files}.srdf, "
            f"base_link: {base}, tip_link: {tip}{hold}}}\n"
            f"path: {{frame: {base}, file: ../paths/{robot}_{path}.csv}}\n"
            f"{scene(problem)}{turns}"
            f"limits: {{clearance: 0, self_clearance: 0, edges: nodes, joint_step: {JOINT_STEP}}}\n"
        )


def convert_iklink(source, out):
    write_path(
        out / "paths/iklink_panda.csv",
        ([x, y, z, qw, qx, qy, qz]
         for _, x, y, z, qx, qy, qz, qw in rows(source / "input_trajectories" / IKLINK)),
    )
    (out / "problems/iklink_panda.yaml").write_text(IKLINK_PROBLEM)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("--cppflow", type=pathlib.Path, help="a clone of jstmn/cppflow")
    parser.add_argument("--iklink", type=pathlib.Path, help="a clone of uwgraphics/IKLink")
    parser.add_argument("out", type=pathlib.Path)
    arguments = parser.parse_args()
    for folder in ("paths", "problems"):
        (arguments.out / folder).mkdir(parents=True, exist_ok=True)
    if arguments.cppflow:
        convert_cppflow(arguments.cppflow, arguments.out)
    if arguments.iklink:
        convert_iklink(arguments.iklink, arguments.out)


if __name__ == "__main__":
    main()

#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Verifies a trajectory knowing only URDF, tool path and CSV: nothing of Swivel's code, no library
but Python's own.

verify.py URDF BASE TIP PATH.csv TRAJ.csv [--tool X Y Z] [--frame X Y Z R P Y] [--hold JOINT=Q ...]
[--cost C]

PATH.csv has x,y,z,qw,qx,qy,qz of the tool in the path's frame, which --frame places in BASE (rpy =
Rz Ry Rx).
Checks: tool within 1e-6 m and rad of the path at every row's s, s from 0 to the end without going
back, joints inside the URDF's limits, and the sum of Euclidean joint moves equal to --cost within
1e-9. Prints one line; exit 0 when all hold.
"""
import argparse
import csv
import math
import sys
import xml.etree.ElementTree as ET


def mul(A, B):
    return [[sum(A[i][k] * B[k][j] for k in range(4)) for j in range(4)] for i in range(4)]


def rotation(axis, angle):
    n = math.sqrt(sum(a * a for a in axis))
    x, y, z = (a / n for a in axis)
    c, s, t = math.cos(angle), math.sin(angle), 1 - math.cos(angle)
    return [
        [t * x * x + c, t * x * y - s * z, t * x * z + s * y, 0.0],
        [t * x * y + s * z, t * y * y + c, t * y * z - s * x, 0.0],
        [t * x * z - s * y, t * y * z + s * x, t * z * z + c, 0.0],
        [0.0, 0.0, 0.0, 1.0],
    ]


def translation(p):
    return [
        [1.0, 0.0, 0.0, p[0]],
        [0.0, 1.0, 0.0, p[1]],
        [0.0, 0.0, 1.0, p[2]],
        [0.0, 0.0, 0.0, 1.0],
    ]


def pose(xyz, rpy):
    R = mul(
        rotation((0, 0, 1), rpy[2]), mul(rotation((0, 1, 0), rpy[1]), rotation((1, 0, 0), rpy[0]))
    )
    return mul(translation(xyz), R)


def from_quaternion(p, q):
    n = math.sqrt(sum(x * x for x in q))
    w, x, y, z = (v / n for v in q)
    return [
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y), p[0]],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x), p[1]],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y), p[2]],
        [0.0, 0.0, 0.0, 1.0],
    ]


def numbers(text, default):
    return [float(x) for x in text.split()] if text else default


class Robot:
    def __init__(self, file):
        self.joints = {}
        self.parent_of = {}
        for j in ET.parse(file).getroot().findall("joint"):
            origin, axis, limit = j.find("origin"), j.find("axis"), j.find("limit")
            entry = {
                "name": j.get("name"),
                "type": j.get("type"),
                "parent": j.find("parent").get("link"),
                "origin": pose(
                    numbers(origin.get("xyz") if origin is not None else None, [0, 0, 0]),
                    numbers(origin.get("rpy") if origin is not None else None, [0, 0, 0]),
                ),
                "axis": numbers(axis.get("xyz") if axis is not None else None, [1, 0, 0]),
                "limit": (float(limit.get("lower", 0)), float(limit.get("upper", 0)))
                if limit is not None
                else None,
            }
            self.joints[entry["name"]] = entry
            self.parent_of[j.find("child").get("link")] = entry

    def chain(self, base, tip):
        chain = []
        while tip != base:
            chain.append(self.parent_of[tip])
            tip = chain[-1]["parent"]
        return chain[::-1]


def forward(chain, q):
    X = translation([0, 0, 0])
    for joint in chain:
        X = mul(X, joint["origin"])
        if joint["type"] in ("revolute", "continuous"):
            X = mul(X, rotation(joint["axis"], q.get(joint["name"], 0.0)))
        elif joint["type"] == "prismatic":
            X = mul(X, translation([a * q.get(joint["name"], 0.0) for a in joint["axis"]]))
    return X


def slerp(a, b, t):
    dot = sum(x * y for x, y in zip(a, b))
    if dot < 0:
        b, dot = [-x for x in b], -dot
    omega = math.atan2(math.sqrt(sum((y - dot * x) ** 2 for x, y in zip(a, b))), dot)
    if omega < 1e-12:
        return a
    return [
        (math.sin((1 - t) * omega) * x + math.sin(t * omega) * y) / math.sin(omega)
        for x, y in zip(a, b)
    ]


def distances(A, B):
    d = math.sqrt(sum((A[i][3] - B[i][3]) ** 2 for i in range(3)))
    # |R_A - R_B| (Frobenius) = 2 sqrt(2) sin(angle / 2): accurate for small angles, where acos is
    # not.
    f = math.sqrt(sum((A[i][j] - B[i][j]) ** 2 for i in range(3) for j in range(3)))
    return d, 2 * math.asin(min(1.0, f / (2 * math.sqrt(2))))


def main():
    parser = argparse.ArgumentParser()
    for name in ("urdf", "base", "tip", "path", "trajectory"):
        parser.add_argument(name)
    parser.add_argument("--tool", type=float, nargs=3, default=[0, 0, 0])
    parser.add_argument("--frame", type=float, nargs=6, default=[0] * 6)
    parser.add_argument("--hold", nargs="*", default=[])
    parser.add_argument("--cost", type=float)
    arguments = parser.parse_args()

    robot = Robot(arguments.urdf)
    chain = robot.chain(arguments.base, arguments.tip)
    held = {item.split("=")[0]: float(item.split("=")[1]) for item in arguments.hold}
    frame = pose(arguments.frame[:3], arguments.frame[3:])
    with open(arguments.path) as file:
        points = [
            [float(row[k]) for k in ("x", "y", "z", "qw", "qx", "qy", "qz")]
            for row in csv.DictReader(file)
        ]
    lengths = [math.dist(a[:3], b[:3]) for a, b in zip(points, points[1:])]
    starts = [sum(lengths[:k]) for k in range(len(lengths))]

    with open(arguments.trajectory) as file:
        rows = list(csv.DictReader(file))
    names = [n for n in rows[0] if n not in ("s", "phi", "branch")]
    failures, worst_p, worst_r, cost, previous, segment = [], 0.0, 0.0, 0.0, None, 0
    for number, row in enumerate(rows):
        s, q = float(row["s"]), {n: float(row[n]) for n in names}
        for n in names:
            joint = robot.joints[n]
            if (
                joint["type"] == "revolute"
                and not joint["limit"][0] - 1e-9 <= q[n] <= joint["limit"][1] + 1e-9
            ):
                failures.append(f"row {number}: {n} = {q[n]} outside {joint['limit']}")
        X = mul(forward(chain, {**held, **q}), translation(arguments.tool))
        best = (9.0, 9.0, segment)
        # Never back; where the path only turns, s fits several places.
        for k in range(segment, len(lengths)):
            if starts[k] - 1e-9 > s:
                break
            if starts[k] + lengths[k] < s - 1e-9:
                continue
            samples = (
                [(s - starts[k]) / lengths[k]]
                if lengths[k] > 1e-9
                else [i / 1000 for i in range(1001)]
            )
            for t in samples:
                t = min(1.0, max(0.0, t))
                p = [(1 - t) * a + t * b for a, b in zip(points[k][:3], points[k + 1][:3])]
                d, r = distances(
                    X, mul(frame, from_quaternion(p, slerp(points[k][3:], points[k + 1][3:], t)))
                )
                if max(d, r) < max(best[:2]):
                    best = (d, r, k)
        worst_p, worst_r, segment = max(worst_p, best[0]), max(worst_r, best[1]), best[2]
        if previous:
            cost += math.sqrt(sum((q[n] - previous[n]) ** 2 for n in names))
        previous = q
    if worst_p > 1e-6 or worst_r > 1e-6:
        failures.append("tool leaves the path")
    if (
        float(rows[0]["s"]) != 0
        or abs(float(rows[-1]["s"]) - sum(lengths)) > 1e-9
        or any(float(b["s"]) < float(a["s"]) for a, b in zip(rows, rows[1:]))
    ):
        failures.append("s does not run from 0 to the end")
    if arguments.cost is not None and abs(cost - arguments.cost) > 1e-9:
        failures.append(f"cost {cost} is not the stated {arguments.cost}")
    for failure in failures[:10]:
        print(failure)
    print(
        f"{'failed' if failures else 'passed'}: {len(rows)} rows, worst {worst_p:.2e} m "
        f"{worst_r:.2e} rad, length {sum(lengths):.6f} m, cost {cost:.12g}"
    )
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())

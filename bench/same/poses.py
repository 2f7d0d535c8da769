# SPDX-License-Identifier: BSD-3-Clause
"""Poses as pairs of a position (m) and a unit quaternion [w, x, y, z], for generated paths."""
import math


def times(a, b):
    """The product of two quaternions: the rotation `b`, then `a`."""
    aw, ax, ay, az = a
    bw, bx, by, bz = b
    return [
        aw * bw - ax * bx - ay * by - az * bz,
        aw * bx + ax * bw + ay * bz - az * by,
        aw * by - ax * bz + ay * bw + az * bx,
        aw * bz + ax * by - ay * bx + az * bw,
    ]


def about(axis, angle):
    """The rotation by `angle` (rad) about an axis of any length."""
    length = math.sqrt(sum(x * x for x in axis))
    return [math.cos(angle / 2), *(math.sin(angle / 2) * x / length for x in axis)]


def of_rpy(roll, pitch, yaw):
    """The rotation of roll, pitch and yaw (rad), as a URDF counts them."""
    turned = times(about([0, 1, 0], pitch), about([1, 0, 0], roll))
    return times(about([0, 0, 1], yaw), turned)


def turned(q, v):
    """The vector `v` turned by the quaternion `q`."""
    return times(times(q, [0, *v]), [q[0], -q[1], -q[2], -q[3]])[1:]


def plus(a, b):
    """The sum of two vectors."""
    return [x + y for x, y in zip(a, b)]


def compose(a, b):
    """The pose `b`, which is given in the frame of the pose `a`, in the frame that `a` is in."""
    return plus(a[0], turned(a[1], b[0])), times(a[1], b[1])


def inverse(a):
    """The pose of the outer frame as it is seen from the pose `a`."""
    back = [a[1][0], -a[1][1], -a[1][2], -a[1][3]]
    return [-x for x in turned(back, a[0])], back


def rounded(numbers, digits=9):
    """Numbers as they are written into files."""
    return [round(x, digits) + 0.0 for x in numbers]


def waypoint(pose):
    """The pose as a waypoint of a problem file."""
    return {"xyz": rounded(pose[0]), "quat": rounded(pose[1], 12)}

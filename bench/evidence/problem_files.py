# SPDX-License-Identifier: BSD-3-Clause
"""Problem, robot, mesh and motion files, read without Swivel's own readers. Metres, radians,
seconds."""
import csv
import json
import pathlib
import re
import struct
import xml.etree.ElementTree as ET

import numpy as np


def flow(text):
    """A value of YAML on one line: a number, a word, [..] or {..}."""

    def quoted(match):
        word = match[0]
        if word in ("true", "false", "null"):
            return word
        try:
            return repr(float(word))
        except ValueError:
            return json.dumps(word)

    return json.loads(re.sub(r"[^\s,:{}\[\]]+", quoted, text))


def nested(lines):
    """Maps and lists by indentation, the part of YAML that the problems in data/problems are
    written in."""
    depth = lines[0][0]
    if lines[0][1].startswith("- "):
        return [flow(text[2:]) for _, text in lines]
    value = {}
    for number, (indent, text) in enumerate(lines):
        if indent != depth:
            continue
        key, rest = text.split(":", 1)
        inner = []
        for line in lines[number + 1 :]:
            if line[0] <= depth and not (line[0] == depth and line[1].startswith("- ")):
                break
            inner.append(line)
        value[key] = flow(rest.strip()) if rest.strip() else nested(inner)
    return value


def load_problem(file):
    lines = [
        re.sub(r"(^|\s)#.*", "", line).rstrip()
        for line in pathlib.Path(file).read_text().splitlines()
    ]
    problem = nested(
        [(len(line) - len(line.lstrip()), line.strip()) for line in lines if line.strip()]
    )
    problem["folder"] = pathlib.Path(file).resolve().parent
    return problem


def rotation(axis, angle):
    """About a unit axis; angles of shape (N,) give (N, 3, 3)."""
    x, y, z = axis
    K = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    a = np.asarray(angle, float)[..., None, None]
    return np.eye(3) + np.sin(a) * K + (1 - np.cos(a)) * (K @ K)


def pose(xyz=(0, 0, 0), rpy=(0, 0, 0)):
    """4 x 4; R = Rz Ry Rx."""
    X = np.eye(4)
    X[:3, :3] = (
        rotation((0, 0, 1), rpy[2]) @ rotation((0, 1, 0), rpy[1]) @ rotation((1, 0, 0), rpy[0])
    )
    X[:3, 3] = xyz
    return X


def pose_of(entry):
    """Of a map with xyz and rpy, each of which may be missing."""
    return pose(entry.get("xyz", (0, 0, 0)), entry.get("rpy", (0, 0, 0)))


def of_quaternion(q):
    """q: w, x, y, z, of shape (..., 4); gives (..., 3, 3)."""
    w, x, y, z = np.moveaxis(q / np.linalg.norm(q, axis=-1, keepdims=True), -1, 0)
    return np.stack(
        [
            1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y), 2 * (x * y + w * z),
            1 - 2 * (x * x + z * z), 2 * (y * z - w * x), 2 * (x * z - w * y), 2 * (y * z + w * x),
            1 - 2 * (x * x + y * y)
        ],
        -1,
    ).reshape(q.shape[:-1] + (3, 3))


def numbers(text):
    return [float(value) for value in text.split()]


def origin_of(element):
    origin = element.find("origin")
    if origin is None:
        return pose()
    return pose(numbers(origin.get("xyz", "0 0 0")), numbers(origin.get("rpy", "0 0 0")))


def load_urdf(file):
    """Joints by name, and for each link the list of its collision shapes."""
    joints, shapes = {}, {}
    root = ET.parse(file).getroot()
    for joint in root.findall("joint"):
        axis, limit = joint.find("axis"), joint.find("limit")
        joints[joint.get("name")] = {
            "name": joint.get("name"),
            "type": joint.get("type"),
            "parent": joint.find("parent").get("link"),
            "child": joint.find("child").get("link"),
            "origin": origin_of(joint),
            "axis": numbers(axis.get("xyz")) if axis is not None else [1, 0, 0],
            "limit": {key: float(value) for key, value in limit.attrib.items()}
            if limit is not None
            else {},
        }
    for link in root.findall("link"):
        shapes[link.get("name")] = []
        for collision in link.findall("collision"):
            geometry = collision.find("geometry")[0]
            sizes = {
                key: numbers(value) if key == "size" else float(value)
                for key, value in geometry.attrib.items()
            }
            shapes[link.get("name")].append(
                {"kind": geometry.tag, "pose": origin_of(collision), **sizes}
            )
    return joints, shapes


def load_disabled_pairs(file):
    """Pairs of links that the SRDF leaves out."""
    return {
        frozenset((entry.get("link1"), entry.get("link2")))
        for entry in ET.parse(file).getroot().findall("disable_collisions")
    }


def load_stl(file):
    """Corners of the triangles of a binary STL, (T, 3, 3)."""
    data = pathlib.Path(file).read_bytes()
    (count,) = struct.unpack_from("<I", data, 80)
    triangles = np.frombuffer(
        data, np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("flags", "<u2")]), count,
        84
    )
    return triangles["corners"].astype(float)


def load_columns(file):
    """A CSV file: arrays by the name of their column."""
    with open(file) as lines:
        rows = list(csv.reader(lines))
    return {name: np.array([float(row[k]) for row in rows[1:]]) for k, name in enumerate(rows[0])}


def load_waypoints(problem):
    """Positions (W, 3) and rotations (W, 3, 3) in the path's frame."""
    path = problem["path"]
    if "file" in path:
        columns = load_columns(problem["folder"] / path["file"])
        return (
            np.stack([columns[k] for k in "xyz"], -1),
            of_quaternion(np.stack([columns[k] for k in ("qw", "qx", "qy", "qz")], -1)),
        )
    poses = np.array([pose_of(waypoint) for waypoint in path["waypoints"]])
    return poses[:, :3, 3], poses[:, :3, :3]

# SPDX-License-Identifier: BSD-3-Clause
"""Where the bodies of a robot and of its scene are, and how near they come, for many postures at
once. Base frame of the problem."""
import numpy as np

import distances
from problem_files import load_disabled_pairs, load_stl, load_urdf, pose, pose_of, rotation

MOVING = ("revolute", "continuous", "prismatic")


class Robot:
    """The links that a problem's joints move, and those that stand."""

    def __init__(self, problem):
        robot = problem["robot"]
        self.joints, self.shapes = load_urdf(problem["folder"] / robot["urdf"])
        self.parent = {joint["child"]: joint for joint in self.joints.values()}
        self.base, self.tip = robot["base_link"], robot["tip_link"]
        self.held = robot.get("hold") or {}
        self.tool = pose_of(robot.get("tool") or {})
        self.attached = robot.get("attached") or []
        movable = [joint["name"] for joint in self.chain(self.tip) if joint["type"] in MOVING]
        self.arm = movable[-7:]
        self.disabled = (
            load_disabled_pairs(problem["folder"] / robot["srdf"]) if "srdf" in robot else set()
        )

    def chain(self, link):
        """Joints from the base to a link, those of the base's own parents left out."""
        joints = []
        while link in self.parent and link != self.base:
            joints.append(self.parent[link])
            link = joints[-1]["parent"]
        return joints[::-1]

    def forward(self, q):
        """Poses of all links: rotations (N, 3, 3) and positions (N, 3), for q of shape (N, 7)."""
        at = {self.base: (np.broadcast_to(np.eye(3), (len(q), 3, 3)), np.zeros((len(q), 3)))}

        def place(link):
            if link not in at:
                joint = self.parent[link]
                R, p = place(joint["parent"])
                p = p + R @ joint["origin"][:3, 3]
                R = R @ joint["origin"][:3, :3]
                name = joint["name"]
                value = (
                    q[:, self.arm.index(name)]
                    if name in self.arm
                    else np.full(len(q), self.held.get(name, 0.0))
                )
                if joint["type"] == "prismatic":
                    p = p + value[:, None] * (R @ np.array(joint["axis"]))
                elif joint["type"] in MOVING:
                    R = R @ rotation(joint["axis"], value)
                at[link] = (R, p)
            return at[link]

        for link in self.shapes:
            if link == self.base or self.chain(link) and self.chain(link)[0]["parent"] == self.base:
                place(link)
        return at

    def tool_pose(self, links):
        R, p = links[self.tip]
        return R @ self.tool[:3, :3], p + R @ self.tool[:3, 3]

    def group(self, link):
        """How many of the arm's joints move a link: two links of one group never move against each
        other."""
        return sum(joint["name"] in self.arm for joint in self.chain(link))


class Body:
    """A shape fixed to a link, or to the base where the link is None. Round shapes are a segment
    and a radius."""

    def __init__(self, name, link, X, kind, **sizes):
        self.name, self.link, self.X, self.kind = name, link, X, kind
        self.radius = sizes.get("radius", 0.0) if kind in ("sphere", "capsule") else 0.0
        self.round = kind in ("sphere", "capsule")
        half = sizes.get("length", 0.0) / 2 if kind == "capsule" else 0.0
        self.ends = [X @ (0, 0, z, 1) for z in (-half, half)]
        if kind == "box":
            half_box = np.array(sizes["size"]) / 2
            self.point = lambda p: distances.point_box(p, half_box)
        elif kind == "cylinder":
            self.point = lambda p: distances.point_cylinder(p, sizes["radius"], sizes["length"] / 2)
        elif kind == "mesh":
            corners = sizes["triangles"]
            self.mesh = distances.Mesh(corners @ X[:3, :3].T + X[:3, 3])
        elif not self.round:
            raise ValueError(f"{name}: a {kind} is not understood")

    def segment(self, links):
        """Ends of the core, (N, 3) each."""
        if self.link is None:
            return [end[:3] for end in self.ends]
        R, p = links[self.link]
        return [p + R @ end[:3] for end in self.ends]


def merged_capsules(shapes):
    """Cylinders with a sphere of their radius at each end are capsules."""
    rest, found = list(shapes), []
    for cylinder in [shape for shape in shapes if shape["kind"] == "cylinder"]:
        ends = [cylinder["pose"] @ (0, 0, z * cylinder["length"] / 2, 1) for z in (-1, 1)]
        spheres = [
            next(
                (
                    shape
                    for shape in rest
                    if shape["kind"] == "sphere"
                    and abs(shape["radius"] - cylinder["radius"]) < 1e-12
                    and np.linalg.norm(shape["pose"][:, 3] - end) < 1e-9
                ),
                None,
            )
            for end in ends
        ]
        if None in spheres:
            continue
        rest = [shape for shape in rest if not any(shape is one for one in (cylinder, *spheres))]
        found.append({**cylinder, "kind": "capsule"})
    return found + rest


def sizes_of(shape):
    return {
        key: value
        for key, value in shape.items()
        if key in ("radius", "length", "size", "triangles")
    }


def scene_shape(entry, folder):
    kind = next(kind for kind in ("sphere", "capsule", "cylinder", "box", "mesh") if kind in entry)
    if kind == "mesh":
        return kind, {"triangles": load_stl(folder / entry["mesh"])}
    return kind, entry[kind]


class Cell:
    """A robot among the objects of a problem's scene; `moved` maps an object to the offset (x, y,
    z, roll, pitch, yaw) of an episode."""

    def __init__(self, problem, moved=None):
        self.robot = robot = Robot(problem)
        moved = moved or {}
        bodies, objects = [], []
        for link, shapes in robot.shapes.items():
            bodies += [
                Body(link, link, shape["pose"], shape["kind"], **sizes_of(shape))
                for shape in merged_capsules(shapes)
            ]
        for entry in robot.attached:
            kind, sizes = scene_shape(entry, problem["folder"])
            bodies.append(Body(entry["name"], entry["link"], pose_of(entry), kind, **sizes))
        self.frames = {}
        for entry in problem.get("scene") or []:
            X, offset = pose_of(entry), moved.get(entry["name"], np.zeros(6))
            turn = pose(rpy=offset[3:])[:3, :3]
            X[:3, :3] = turn @ X[:3, :3]
            X[:3, 3] += offset[:3]
            self.frames[entry["name"]] = X
            kind, sizes = scene_shape(entry, problem["folder"])
            objects.append(Body(entry["name"], None, X, kind, **sizes))
        self.pairs = [(a, b) for a in bodies for b in objects if robot.group(a.link) > 0]
        for number, a in enumerate(bodies):
            for b in bodies[:number]:
                if (
                    robot.group(a.link) != robot.group(b.link)
                    and frozenset((a.name, b.name)) not in robot.disabled
                ):
                    self.pairs.append((a, b))

    def in_contact_inside(self, q):
        """Names of meshes that an end of a round body's core lies inside of, at one posture
        (7,)."""
        links = self.robot.forward(q[None])
        return sorted(
            {
                b.name
                for a, b in self.pairs
                if b.kind == "mesh" and b.mesh.contains(a.segment(links)[0][0])
            }
        )

    def least_clearance(self, q):
        """Of all pairs over all postures q (N, 7) in their order: distance, names of the two
        bodies, number of the posture.

        Exact: an interval of postures is left out only where the distance at its middle, less what
        the two bodies move, is more than the least found.
        """
        links = self.robot.forward(q)
        pairs = [_Pair(*pair, links, self.robot) for pair in self.pairs]
        least, which = np.inf, None
        low, high = np.array([0]), np.array([len(q) - 1])
        at_middle = [pair.distance((low + high) // 2)[0] for pair in pairs]
        # The nearest first, so that little is left of the others.
        for number in np.argsort(at_middle):
            pair, low, high = pairs[number], np.array([0]), np.array([len(q) - 1])
            while len(low):
                middle = (low + high) // 2
                d = pair.distance(middle)
                best = int(d.argmin())
                if d[best] < least:
                    least, which = float(d[best]), (pair.a.name, pair.b.name, int(middle[best]))
                reach = np.maximum(
                    pair.travel[middle] - pair.travel[low], pair.travel[high] - pair.travel[middle]
                )
                open_ = (d - reach < least) & (high > low)
                low, middle, high = low[open_], middle[open_], high[open_]
                low, high = np.concatenate([low, middle + 1]), np.concatenate([middle - 1, high])
                kept = low <= high
                low, high = low[kept], high[kept]
        return least, which


class _Pair:
    """Two bodies over a sequence of postures; the first is round."""

    def __init__(self, a, b, links, robot):
        if not a.round:
            a, b = b, a
        still = [body.link is None or robot.group(body.link) == 0 for body in (a, b)]
        if not a.round or not (b.round or still[1]) or b.kind == "mesh" and b.link is not None:
            raise ValueError(f"{a.name} and {b.name}: this pair is not understood")
        if still[0] and b.round:
            a, b, still = b, a, still[::-1]
        self.a, self.b, self.still = a, b, still[1]
        one = {link: (R[:1], p[:1]) for link, (R, p) in links.items()}
        self.ends = a.segment(links)
        self.travel = _travel(self.ends)
        if b.round:
            self.other = np.atleast_3d(np.array(b.segment(one if self.still else links))).reshape(
                2, -1, 3
            )
            if not self.still:
                self.travel = self.travel + _travel(self.other)
        elif b.kind != "mesh":
            self.frame = b.X if b.link is None else _matrix(one[b.link]) @ b.X

    def distance(self, at):
        a, b = self.a, self.b
        p, q = self.ends[0][at], self.ends[1][at]
        if b.round:
            other = 0 * at if self.still else at
            return (
                distances.segment_segment(p, q, self.other[0][other], self.other[1][other])
                - a.radius
                - b.radius
            )
        if b.kind == "mesh":
            return b.mesh.distance(p, q) - a.radius
        p, q = ((end - self.frame[:3, 3]) @ self.frame[:3, :3] for end in (p, q))
        return distances.segment_convex(p, q, b.point) - a.radius


def _travel(ends):
    """How far the faster end of a core has come, added up over the postures."""
    steps = np.max([np.linalg.norm(np.diff(end, axis=0), axis=-1) for end in ends], axis=0)
    return np.concatenate([[0], np.cumsum(steps)])


def _matrix(placed):
    X = np.eye(4)
    X[:3, :3], X[:3, 3] = placed[0][0], placed[1][0]
    return X

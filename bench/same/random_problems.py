# SPDX-License-Identifier: BSD-3-Clause
"""Random problems with one path, jobs and workcells: small, coarse and quick, about a third of them
without a solution, for different reasons. Each depends on the seed and its number alone."""
import math
import random

from same import arms, poses, text

KINDS_OF_OBSTACLES = ("box", "sphere", "cylinder", "capsule")


def shape(draw, size):
    """A shape of about this size (m)."""
    kind = draw.choice(KINDS_OF_OBSTACLES)
    size = round(size * draw.uniform(0.6, 1.4), 4)
    if kind == "box":
        return {"box": [round(size * draw.uniform(0.4, 1.6), 4) for _ in range(3)]}
    if kind == "sphere":
        return {"sphere": {"radius": size / 2}} if draw.random() < 0.5 else {"sphere": size / 2}
    return {kind: {"radius": round(size / 3, 4), "length": size}}


def direction(draw):
    """A random vector of length 1."""
    while True:
        v = [draw.uniform(-1, 1) for _ in range(3)]
        length = math.sqrt(sum(x * x for x in v))
        if 0.1 < length < 1:
            return [x / length for x in v]


def obstacles(draw, about, least=0.15, most=0.7, count=4):
    """Up to three bodies at a distance from `about` (m); some are in the arm's way."""
    bodies = []
    for k in range(draw.randrange(count)):
        away = draw.uniform(least, most)
        bodies.append(
            {
                "name": f"body {k}" if draw.random() < 0.3 else f"body_{k}",
                **shape(draw, draw.uniform(0.04, 0.15)),
                "xyz": poses.rounded(poses.plus(about, [away * x for x in direction(draw)]), 4),
            }
        )
        if draw.random() < 0.5:
            bodies[-1]["rpy"] = [round(draw.uniform(-1.5, 1.5), 3) for _ in range(3)]
    return bodies


def begin(draw, pose, spread):
    """A pose about `pose`, at most `spread` (m) off along each axis and tilted a little."""
    xyz = [x + draw.uniform(-s, s) for x, s in zip(pose[0], spread)]
    tilt = poses.about(direction(draw), draw.uniform(0, 0.25))
    return xyz, poses.times(tilt, pose[1])


def line(draw, first):
    """A straight stroke, which may turn the tool a little."""
    along = poses.turned(first[1], [math.cos(a := draw.uniform(-3, 3)), math.sin(a), 0])
    length = draw.uniform(0.05, 0.16)
    turn = poses.about(direction(draw), draw.choice([0, 0, draw.uniform(0.05, 0.4)]))
    return [first, (poses.plus(first[0], [length * x for x in along]), poses.times(turn, first[1]))]


def polyline(draw, first):
    """A stroke with corners, across the tool."""
    path = [first]
    for _ in range(draw.randrange(2, 5)):
        path.append(line(draw, path[-1])[1])
    return path


def arc(draw, first, turns=None, points=8, follow=0.0):
    """A part of a circle in the tool's plane; the tool turns by the share `follow` of the angle."""
    radius, turns = draw.uniform(0.03, 0.06), turns or draw.uniform(0.2, 0.7)
    path = []
    for k in range(points + 1):
        a = 2 * math.pi * turns * k / points
        place = [radius * (math.cos(a) - 1), radius * math.sin(a), 0]
        path.append(poses.compose(first, (place, poses.about([0, 0, 1], follow * a))))
    return path


def ring(draw, first):
    """A closed stroke: the last pose is the first."""
    path = arc(draw, first, turns=1.0, points=draw.choice([4, 8, 12]))
    path[-1] = path[0]
    return path


def stroke_path(draw, arm, files, name, flaw=None, closed=False):
    """The section `path` of a stroke, without its frame, and its poses in the base link. Its
    waypoints may be in a file, which is put among `files`."""
    first = begin(draw, arm.pose, arm.spread)
    if flaw == "reach":
        first = (
            poses.plus(first[0], [draw.uniform(0.5, 0.9), 0.0, draw.uniform(0.2, 0.6)]),
            first[1],
        )
    make = ring if closed else draw.choice([line, line, line, polyline, arc])
    path = make(draw, first)
    if flaw == "not_closed":
        path = arc(draw, first, turns=1.0, points=10, follow=1.0)
        path[-1] = path[0]
    section = {"waypoints": [poses.waypoint(pose) for pose in path]}
    if closed:
        section["closed"] = True
    if arm.roll and arm.kind == "roll":
        section["roll"] = arm.roll[0]
    if draw.random() < 0.25:
        section = in_a_file(draw, section, files, name)
    if not closed and draw.random() < 0.15:
        section["smooth"] = draw.choice(
            [None, {"position": 0.0005}, {"position": 0.001, "angle": 0.01}]
        )
    return section, path


def in_a_file(draw, section, files, name):
    """The same path with its waypoints in a CSV file."""
    unit = draw.choice(["", "mm"])
    scale = 1000 if unit else 1
    rows = [
        [*poses.rounded([scale * x for x in point["xyz"]]), *point["quat"]]
        for point in section.pop("waypoints")
    ]
    columns = [f"{axis} [mm]" if unit == "mm" else axis for axis in "xyz"]
    columns += ["qw", "qx", "qy", "qz"]
    if draw.random() < 0.2:
        columns, rows = ["index", *columns], [[k, *row] for k, row in enumerate(rows)]
    files[f"made/{name}.csv"] = text.csv(columns, rows)
    return {**section, "file": f"{name}.csv"}


def limits(draw, flaw=None):
    """Limits, of which `flaw` is one that no path keeps, or few do."""
    out = {"clearance": draw.choice([0.005, 0.005, 0.002, 0.01]), "tool_path_error": 0.002}
    if draw.random() < 0.2:
        out["edges"] = "nodes"
    if draw.random() < 0.2:
        out["joint_margin"] = draw.choice([0.01, 0.05])
    if draw.random() < 0.15:
        out["tool_speed"] = draw.choice([0.1, 0.2])
    if draw.random() < 0.1:
        out["self_clearance"] = 0.002
    if draw.random() < 0.1:
        out["tool_angle_error"] = 0.05
    out.update(
        {
            "joint_step": {"joint_step": draw.choice([0.003, 0.01])},
            "speed": {"tool_speed": draw.choice([4.0, 8.0])},
            "limit": {"joint_margin": draw.choice([1.0, 1.4])},
            "manipulability": {"manipulability": draw.choice([0.2, 0.5])},
            "path_error": {"tool_path_error": 1e-7},
            "clearance": {"clearance": draw.choice([0.06, 0.12])},
        }.get(flaw, {})
    )
    return out


def cost(draw):
    """A section `cost`, or none."""
    if draw.random() < 0.65:
        return {}
    out = {"metric": draw.choice(["l2", "max", "time"])}
    return {"cost": out}


def in_frame(draw, arm, problem, sections):
    """Half of the time, puts an object under the paths and the paths into its frame."""
    if draw.random() < 0.5:
        return
    yaw = round(draw.uniform(-3, 3), 3)
    middle = problem["scene"][0]["xyz"] if problem["scene"] and draw.random() < 0.2 else None
    place = [round(x + d, 4) for x, d in zip(sections[0][1][0][0], (0.02, 0.03, -arm.part_below))]
    part = (middle or place, poses.of_rpy(0, 0, yaw))
    body = {"name": "part", "box": [0.05, 0.05, 0.02], "xyz": part[0], "rpy": [0, 0, yaw]}
    if draw.random() < 0.3:
        body["allow"] = draw.choice([["nozzle"], {"nozzle": 0.003}])
        if problem["robot"]["attached"][0]["name"] != "nozzle":
            body.pop("allow")
    problem["scene"].append(body)
    for section, path in sections:
        if "waypoints" in section:
            section["frame"] = "part"
            section["waypoints"] = [
                poses.waypoint(poses.compose(poses.inverse(part), pose)) for pose in path
            ]


def vary(draw, problem):
    """Lets an object move in campaigns, sometimes."""
    if problem["scene"] and draw.random() < 0.4:
        name = problem["scene"][-1]["name"]
        problem["vary"] = [{"object": name, "xyz": [0.03, 0.03, 0.02], "rpy": [0, 0, 0.2]}]


def barred(draw, problem, path, flaw):
    """Puts a body where the path goes, if that is the flaw."""
    if flaw == "collision":
        pose = path[len(path) // 2]
        back = poses.turned(pose[1], [0, 0, -draw.uniform(0.05, 0.1)])
        problem["scene"].append(
            {
                "name": "ball",
                "sphere": {"radius": 0.05},
                "xyz": poses.rounded(poses.plus(pose[0], back), 4),
            }
        )


PATH_FLAWS = (
    "reach",
    "collision",
    "joint_step",
    "speed",
    "limit",
    "manipulability",
    "path_error",
    "clearance",
    "not_closed",
)
JOB_FLAWS = (*PATH_FLAWS, "home", "wall")


def path_problem(seed, number):
    """A problem with one path, its other files, and the flaw that it was given, or nothing."""
    draw = random.Random(f"{seed} path {number}")
    arm = arms.ARMS[draw.choice(list(arms.ARMS))]
    flaw = draw.choice(PATH_FLAWS) if draw.random() < 0.3 else None
    files = {}
    closed = flaw == "not_closed" or (arm.kind != "S-R-S and a roll" and draw.random() < 0.12)
    section, path = stroke_path(draw, arm, files, "path", flaw, closed)
    if arm.kind == "S-R-S and a roll":
        section["roll"] = draw.choice(arm.roll)
        section.pop("closed", None)
    elif arm.roll:
        section["roll"] = draw.choice(arm.roll)
    problem = {
        "robot": arm.robot,
        "path": section,
        "scene": obstacles(draw, path[0][0]),
        "resolution": arm.resolution,
        "limits": limits(draw, flaw),
        **cost(draw),
    }
    in_frame(draw, arm, problem, [(section, path)])
    barred(draw, problem, path, flaw)
    if draw.random() < 0.2:
        problem["refine"] = {"smoothing": draw.choice([0, 0.01, 0.05])}
    if not closed and arm.kind != "S-R-S and a roll" and draw.random() < 0.08:
        problem["lift"] = {"allowed": True, "cost": 0.5}
    if arm.kind == "S-R-S" and draw.random() < 0.2:
        problem["resolution"] = {**arm.resolution, "arcs": True}
    vary(draw, problem)
    files["made/problem.yaml"] = text.yaml(problem)
    return files, flaw


def strokes_of(draw, arm, files, flaw):
    """The strokes of a job, and their paths. The flaw is that of one of them."""
    count = draw.choice([1, 2, 2, 3, 3, 4])
    faulty = draw.randrange(count)
    strokes, sections = [], []
    roll = draw.choice(arm.roll) if arm.roll else None
    for k in range(count):
        its = flaw if k == faulty else None
        closed = its == "not_closed" or (arm.kind != "S-R-S and a roll" and draw.random() < 0.08)
        section, path = stroke_path(draw, arm, files, f"stroke_{k}", its, closed)
        if roll:
            section["roll"] = roll
        if arm.kind == "S-R-S and a roll":
            section.pop("closed", None)
        stroke = {"name": f"stroke_{k}" if draw.random() < 0.8 else f"row {k}", "path": section}
        if draw.random() < 0.5 and not section.get("closed"):
            stroke["reversible"] = True
        if section.get("closed"):
            stroke.update(approach=0, retract=0)
        elif draw.random() < 0.2:
            stroke[draw.choice(["approach", "retract"])] = draw.choice(
                [0, 0.03, {"xyz": [0.01, 0, -0.03]}]
            )
        if draw.random() < 0.2:
            stroke["process_speed"] = draw.choice([0.03, 0.08])
        if its in ("joint_step", "speed", "limit", "manipulability", "path_error", "clearance"):
            stroke["limits"] = limits(draw, its)
        elif draw.random() < 0.1:
            stroke["limits"] = {"clearance": 0.003}
        strokes.append(stroke)
        sections.append((section, path))
    return strokes, sections, faulty


def ring_job(draw):
    """A job of one stroke with more of a turn than the wrist has, so that the tool lifts off."""
    arm = arms.ARMS["iiwa"]
    first = begin(draw, ([0.55, -0.05, 0.25], arm.pose[1]), (0.03, 0.03, 0.03))
    turns = arc(draw, first, turns=draw.uniform(1.05, 1.6), points=24, follow=1.0)
    path = {"waypoints": [poses.waypoint(pose) for pose in turns]}
    return {
        "robot": arm.robot,
        "approach": 0.03,
        "retract": 0.03,
        "lift": {"allowed": True, "cost": draw.choice([0, 1.0]), "overlap": draw.choice([0, 0.01])},
        "strokes": [{"name": "ring", "path": path, "reversible": draw.random() < 0.5}],
        "resolution": {"ds": 0.02, "dphi": 0.3},
        "limits": {"clearance": 0.005, "tool_path_error": 0.005},
        **cost(draw),
    }


def tight_job(draw):
    """A job whose stroke comes nearer to a plate than transitions may."""
    arm = arms.ARMS["iiwa"]
    first = begin(draw, arm.pose, (0.03, 0.05, 0.05))
    path = {"waypoints": [poses.waypoint(pose) for pose in line(draw, (first[0], arm.pose[1]))[:2]]}
    # The nozzle's body ends 25 mm before the tool's tip.
    top = poses.plus(first[0], [0, 0, 0.025 - draw.uniform(0.003, 0.006) - 0.01])
    limits_near = {"clearance": 0.001, "edge_clearance": 0.0005}
    return {
        "robot": arm.robot,
        "home": {"joints": arm.home},
        "strokes": [{"name": "near", "path": path, "limits": limits_near}],
        "scene": [{"name": "plate", "box": [0.3, 0.3, 0.02], "xyz": poses.rounded(top, 5)}],
        "resolution": arm.resolution,
        "limits": {"clearance": 0.01, "self_clearance": 0.002, "tool_path_error": 0.002},
    }


def job(seed, number):
    """A job, its other files, and the flaw that it was given, or nothing."""
    draw = random.Random(f"{seed} job {number}")
    special = {4: ring_job, 7: tight_job, 23: tight_job}.get(number % 32)
    if special:
        return {"made/problem.yaml": text.yaml(special(draw))}, special.__name__
    arm = arms.ARMS[draw.choice(list(arms.ARMS))]
    flaw = draw.choice(JOB_FLAWS) if draw.random() < 0.15 else None
    files = {}
    strokes, sections, faulty = strokes_of(draw, arm, files, flaw)
    problem = {"robot": arm.robot}
    if flaw == "home" or draw.random() < 0.5:
        problem["home"] = {"joints": [round(x + draw.uniform(-0.1, 0.1), 3) for x in arm.home]}
    if draw.random() < 0.6:
        problem["approach"] = problem["retract"] = draw.choice([0.02, 0.04])
    if draw.random() < 0.6:
        problem["process_speed"] = draw.choice([0.04, 0.06])
    if draw.random() < 0.3:
        problem.update(process_speed=0.05, approach_speed=0.1)
    if draw.random() < 0.5:
        problem["rapid"] = draw.choice([0.3, 0.5])
    may_lift = arm.kind != "S-R-S and a roll" and not any("closed" in s["path"] for s in strokes)
    if may_lift and draw.random() < 0.2:
        problem["lift"] = {"allowed": True, "cost": 1.0, "overlap": draw.choice([0, 0.01])}
    elif draw.random() < 0.45:
        problem["order"] = "best"
    scene = obstacles(draw, sections[0][1][0][0])
    problem.update(strokes=strokes, scene=scene, resolution=arm.resolution, limits=limits(draw))
    problem.update(cost(draw))
    in_frame(draw, arm, problem, sections)
    barred(draw, problem, sections[faulty][1], flaw)
    middle = sections[0][1][0][0]
    if flaw == "home":  # a ball so big that it is about where the flange is at home
        place = poses.rounded(poses.plus(middle, [0, 0, 0.45]), 4)
        scene.append({"name": "cage", "sphere": 0.25, "xyz": place})
    if flaw == "wall":
        place = poses.rounded(poses.plus(middle, [0, 0.1, 0.1]), 4)
        scene.append({"name": "wall", "box": [0.6, 0.02, 0.8], "xyz": place})
    vary(draw, problem)
    files["made/problem.yaml"] = text.yaml(problem)
    return files, flaw


def passing(draw, arm, pose, count):
    """The path of arm 0 or 1 past the middle between both arms, against the other's direction."""
    along = 1 - 2 * arm
    middle = [0.65, 0.0, 0.36] if abs(pose[0][1]) < 0.1 else [0.68, 0.0, 1.0]
    away = draw.uniform(-0.03, 0.03)
    offset = [-along * away, 0, 0] if abs(pose[0][1]) < 0.1 else [0, along * away, 0]
    path = []
    for j in range(count):
        way = along * 0.15 * (j / (count - 1) - 0.5)
        step = [0, way, 0] if abs(pose[0][1]) < 0.1 else [0, 0, way]
        path.append((poses.plus(poses.plus(middle, offset), step), pose[1]))
    return path


CELL_FLAWS = ("reach", "collision", "joint_step", "limit", "speed", *3 * ["conflict", "passing"])


def workcell(seed, number):
    """A workcell, its other files, and the flaw that it was given, or nothing."""
    draw = random.Random(f"{seed} workcell {number}")
    robot, sides = arms.CELLS[draw.choice(list(arms.CELLS))]
    flaw = draw.choice(CELL_FLAWS) if draw.random() < 0.4 else None
    leads = robot["urdf"].endswith("sda10f.urdf") and draw.random() < 0.35 and flaw != "conflict"
    parts, problem_limits, faulty = [], limits(draw), draw.randrange(2)
    count = draw.choice([2, 2, 3])
    scene = []
    for k, (part, pose) in enumerate(sides):
        its = flaw if k == faulty else None
        first = begin(draw, pose, (0.02, 0.05, 0.04))
        path = [first]
        while len(path) < count:
            path.append(line(draw, path[-1])[1])
        if its == "reach":
            path = [(poses.plus(p[0], [0.1, 0, 1.2]), p[1]) for p in path]
        if flaw == "conflict":  # both tools in one place, at one time
            path = [(poses.plus(sides[0][1][0], [0, 0.1 * j, 0]), pose[1]) for j in range(count)]
        if flaw == "passing":  # the tools pass each other, at a small distance
            path = passing(draw, k, pose, count)
        part = {**part, "path": {"waypoints": [poses.waypoint(p) for p in path]}}
        if its in ("joint_step", "limit", "speed"):
            part["limits"] = limits(draw, its)
        elif draw.random() < 0.15:
            part["limits"] = {"clearance": 0.003}
        if its == "collision":
            back = poses.turned(path[0][1], [0, 0, -0.08])
            place = poses.rounded(poses.plus(path[0][0], back), 4)
            scene.append({"name": "ball", "sphere": 0.05, "xyz": place})
        parts.append(part)
    if leads:
        plate = {
            "name": "plate",
            "box": [0.2, 0.2, 0.01],
            "xyz": [0, 0, 0.1],
            "allow": ["hand_right"],
        }
        parts[0]["attached"] = [plate]
        y = -0.115 + draw.uniform(-0.01, 0.01)
        parts[1]["path"] = {
            "frame": "left",
            "waypoints": [
                poses.waypoint(([x, y, 0.0], poses.of_rpy(-1.5708, 0, 0)))
                for x in (-0.08, 0.08, 0.02)[:count]
            ],
        }
    problem = {
        "robot": robot,
        "arms": parts,
        "scene": scene + obstacles(draw, sides[0][1][0], 0.4, 0.9, 3),
        "resolution": {"ds": 0.03, "dphi": 0.4 if flaw == "passing" else draw.choice([0.2, 0.3])},
        "limits": problem_limits,
        **cost(draw),
    }
    vary(draw, problem)
    return {"made/problem.yaml": text.yaml(problem)}, flaw

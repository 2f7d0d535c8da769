# SPDX-License-Identifier: BSD-3-Clause
"""Files of every kind with one mistake each: unknown keys, wrong types, units and ranges, missing
files, values that are no numbers, names that stand twice, and broken text."""
import copy

from same import arms, poses, text
from same.answers import Case, Step
from same.steps import LAZY

MADE = "made/problem.yaml"
GONE = object()  # in place of a value: the key is left out


def waypoints(pose, along, length=0.1):
    """A straight path from a pose, along a direction of the base (m)."""
    end = poses.plus(pose[0], [length * x for x in along])
    return [poses.waypoint(pose), poses.waypoint((end, pose[1]))]


def good_path():
    """A problem with one path, which has a solution."""
    arm = arms.ARMS["iiwa"]
    return {
        "robot": copy.deepcopy(arm.robot),
        "path": {"frame": "part", "waypoints": waypoints(([0, 0, 0.1], [0, 1, 0, 0]), [0, 1, 0])},
        "scene": [
            {"name": "part", "box": [0.1, 0.1, 0.1], "xyz": [0.55, 0, 0.1]},
            {"name": "post", "cylinder": {"radius": 0.03, "length": 0.5}, "xyz": [0.2, 0.5, 0.3]},
        ],
        "resolution": dict(arm.resolution),
        "limits": {"clearance": 0.005, "tool_path_error": 0.001},
        "cost": {"metric": "l2"},
        "vary": [{"object": "part", "xyz": [0.01, 0.01, 0]}],
    }


def good_job():
    """A job of two strokes, which has a solution."""
    problem = good_path()
    path = problem.pop("path")
    across = {"frame": "part", "waypoints": waypoints(([0.05, 0, 0.1], [0, 1, 0, 0]), [0, 1, 0])}
    return {
        "robot": problem.pop("robot"),
        "home": {"joints": arms.ARMS["iiwa"].home},
        "approach": 0.03,
        "process_speed": 0.05,
        "strokes": [
            {"name": "first", "path": path, "reversible": True},
            {"name": "second", "path": across, "retract": 0.02},
        ],
        **problem,
    }


def good_workcell():
    """A workcell, which has a solution."""
    robot, sides = arms.CELLS["sda10f"]
    parts = [
        {**copy.deepcopy(part), "path": {"waypoints": waypoints(pose, [0, 0, 1])}}
        for part, pose in sides
    ]
    return {
        "robot": copy.deepcopy(robot),
        "arms": parts,
        "scene": [{"name": "post", "sphere": 0.1, "xyz": [0.3, 1.2, 0.3]}],
        "resolution": {"ds": 0.03, "dphi": 0.3},
        "limits": {"clearance": 0.005, "tool_path_error": 0.002},
    }


# Of all three kinds: the keys that lead to a value, and what it is changed to.
EVERYWHERE = [
    (["colour"], "red"),
    (["robot"], GONE),
    (["robot", "urdf"], GONE),
    (["robot", "urdf"], "nowhere.urdf"),
    (["robot", "urdf"], 7),
    (["robot", "srdf"], "nowhere.srdf"),
    (["robot", "base_link"], "nowhere"),
    (["robot", "hold"], {"no_joint": 0.0}),
    (["robot", "colour"], "red"),
    (["scene"], 3),
    (["scene", 0, "name"], GONE),
    (["scene", 0, "xyz"], [0.1, 0.2]),
    (["scene", 0, "xyz"], [550.0, 0, 100.0]),
    (["scene", 0, "xyz"], [5500.0, 0, 100.0]),
    (["scene", 0, "sphere"], {"radius": -0.1}),
    (["scene", 0, "mesh"], "nowhere.stl"),
    (["scene", 0, "allow"], ["nobody"]),
    (["scene", 0, "frame"], "nowhere"),
    (["scene", 0, "name"], "a\u202eb"),
    (["resolution", "ds"], 0),
    (["resolution", "ds"], "0.01"),
    (["resolution", "dphi"], 100.0),
    (["resolution", "arc"], 0.2),
    (["limits", "clearance"], 5.0),
    (["limits", "clearance"], -0.001),
    (["limits", "clearance"], "NAN"),
    (["limits", "tool_path_error"], 1.0),
    (["limits", "tool_angle_error"], 30.0),
    (["limits", "joint_speed"], [1.0, 2.0]),
    (["limits", "joint_margin"], {"no_joint": 0.1}),
    (["limits", "edges"], "some"),
    (["limits", "speed"], 1.0),
    (["cost"], {"metric": "l3"}),
    (["cost"], {"weights": [1, 2]}),
    (["refine"], {"smoothing": -1}),
    (["vary"], [{"object": "nobody", "xyz": [0, 0, 0]}]),
]
OF_A_PATH = [
    (["path"], GONE),
    (["path", "waypoints"], GONE),
    (["path", "waypoints"], []),
    (["path", "waypoints", 1], GONE),
    (["path", "waypoints", 0, "xyz"], [0.1, 0.2, "NAN"]),
    (["path", "waypoints", 0, "xyz"], [0, 0, 100.0]),
    (["path", "waypoints", 0, "quat"], [0, 2, 0, 0]),
    (["path", "waypoints", 0, "quat"], [0, 0, 0, 0]),
    (["path", "waypoints", 0, "roll"], [-1, 1]),
    (["path", "waypoints", 1, "quat"], [0, 0, 1, 0]),
    (["path", "frame"], "nowhere"),
    (["path", "file"], "nowhere.csv"),
    (["path", "roll"], [1, -1]),
    (["path", "roll"], "fixed"),
    (["path", "closed"], True),
    (["path", "closed"], "yes"),
    (["path", "end"], {"joints": [0, 0, 0, 0, 0, 0, 0]}),
    (["path", "smooth"], {"position": 1.0}),
    (["path", "units"], "mm"),
    (["path", "speed"], 0.1),
]
ONLY = {
    "path": [
        *OF_A_PATH,
        (["start"], {"joints": [0, 0, 0, 0, 0, 0, 0]}),
        (["start"], {"joints": [0, 0]}),
        (["start_at"], 0.05),
        (["home"], {"joints": [0, 0, 0, 0, 0, 0, 0]}),
        (["order"], "best"),
        (["lift"], {"allowed": True, "cost": -1}),
        (["lift"], {"cost": 1}),
        (["strokes"], []),
        (["arms"], []),
    ],
    "job": [
        (["strokes"], []),
        (["strokes"], {}),
        (["strokes", 1, "name"], "first"),
        (["strokes", 1, "name"], "a,b"),
        (["strokes", 1, "name"], GONE),
        (["strokes", 1, "path"], GONE),
        (["strokes", 1, "colour"], "red"),
        (["strokes", 1, "approach"], -0.1),
        (["strokes", 1, "retract"], {"xyz": [0, 0]}),
        (["strokes", 1, "retract"], 50.0),
        (["strokes", 1, "limits"], {"soft_limits": False}),
        (["strokes", 1, "limits"], {"clearance": 5.0}),
        (["strokes", 1, "process_speed"], 0),
        (["strokes", 1, "path", "roll"], "free"),
        (["strokes", 0, "path", "end"], {"joints": [0, 0, 0, 0, 0, 0, 0]}),
        *((["strokes", 1, *keys], value) for keys, value in OF_A_PATH[1:12]),
        (["home"], {"joints": [0, 0, 0]}),
        (["home"], {"joints": [0, 0, 0, 9, 0, 0, 0]}),
        (["home"], {"joints": [0, 0, 0, "NAN", 0, 0, 0]}),
        (["order"], "cheapest"),
        (["rapid"], 1.5),
        (["process_speed"], -1),
        (["start"], {"joints": [0, 0, 0, 0, 0, 0, 0]}),
        (["lift"], {"allowed": True, "overlap": -1}),
        (["path"], {"waypoints": []}),
    ],
    "workcell": [
        (["arms", 1], GONE),
        (["arms", 1, "name"], "left"),
        (["arms", 1, "name"], GONE),
        (["arms", 1, "tip_link"], "arm_left_link_tool0"),
        (["arms", 1, "tip_link"], "nowhere"),
        (["arms", 1, "path"], GONE),
        (["arms", 1, "path", "waypoints", 1], GONE),
        (["arms", 1, "path", "frame"], "right"),
        (["arms", 1, "path", "frame"], "nowhere"),
        (["arms", 1, "trajectory"], "nowhere.csv"),
        (["arms", 1, "at_rows"], [0, 1]),
        (["arms", 1, "start"], {"joints": [0, 0]}),
        (["arms", 1, "limits"], {"clearance": -1}),
        (["arms", 1, "colour"], "red"),
        (["arms", 1, "path", "closed"], True),
        (["arms", 1, "attached", 0, "name"], "hand_left"),
        (["robot", "tip_link"], "arm_left_link_tool0"),
        (["home"], {"joints": [0]}),
        (["strokes"], []),
    ],
}
GOOD = {"path": good_path, "job": good_job, "workcell": good_workcell}


def changed(problem, keys, value):
    """The problem with the value that these keys lead to changed."""
    problem = copy.deepcopy(problem)
    section = problem
    for key in keys[:-1]:
        section = section.setdefault(key, {}) if isinstance(section, dict) else section[key]
    if value is GONE:
        del section[keys[-1]]
    else:
        section[keys[-1]] = value
    return problem


def broken(problem):
    """Texts that are no problem file, by names."""
    good = text.yaml(problem)
    return {
        "empty": "",
        "half": good[: len(good) // 2],
        "tab": good.replace("  - ", "\t- ", 1),
        "twice": good + f"limits: {{clearance: 0.01}}\n",
        "list": "- 1\n- 2\n",
        "two documents": good + "---\n" + good,
        "no number": good.replace("0.005", "0.0.5"),
        "comma": good.replace("0.005", "0,005"),
        "binary": good.encode() + b"\xff\xfe\x00",
    }


def asked(kind, number):
    """What is asked of a bad file, of every sixth by the Python module besides."""
    module = [Step("module", (kind, MADE), python=True)] if number % 6 == 0 else []
    return [
        Step("plan", ("plan", MADE, *LAZY)),
        Step("check", ("check", MADE, "rows.csv")),
        *module,
    ]


TABLES = {
    "no column": "x,y\n0,0\n1,1\n",
    "one row": "x,y,z,qw,qx,qy,qz\n0,0,0.1,0,1,0,0\n",
    "header alone": "x,y,z,qw,qx,qy,qz\n",
    "empty": "",
    "nan": "x,y,z,qw,qx,qy,qz\n0,0,0.1,0,1,0,0\n0,nan,0.1,0,1,0,0\n",
    "text": "x,y,z,qw,qx,qy,qz\n0,0,0.1,0,1,0,0\n0,one,0.1,0,1,0,0\n",
    "short row": "x,y,z,qw,qx,qy,qz\n0,0,0.1,0,1,0,0\n0,0.1,0.1,0,1\n",
    "long row": "x,y,z,qw,qx,qy,qz\n0,0,0.1,0,1,0,0\n0,0.1,0.1,0,1,0,0,5\n",
    "millimetres": "x,y,z,qw,qx,qy,qz\n0,0,100,0,1,0,0\n0,100,100,0,1,0,0\n",
    "two units": "x [mm],y [m],z,qw,qx,qy,qz\n0,0,0.1,0,1,0,0\n0,0.1,0.1,0,1,0,0\n",
    "column twice": "x,x,y,z,qw,qx,qy,qz\n0,0,0,0.1,0,1,0,0\n0,0,0.1,0.1,0,1,0,0\n",
    "unknown column": "x,y,z,qw,qx,qy,qz,colour\n0,0,0.1,0,1,0,0,1\n0,0.1,0.1,0,1,0,0,1\n",
    "feed": "x,y,z,qw,qx,qy,qz,feed\n0,0,0.1,0,1,0,0,0.1\n0,0.1,0.1,0,1,0,0,0.1\n",
    "normals": "x,y,z,nx,ny,nz\n0,0,0.1,0,0,1\n0,0.1,0.1,0,0,1\n",
    "opposite normals": "x,y,z,nx,ny,nz\n0,0,0.1,0,0,1\n0,0.1,0.1,0,0,-1\n",
    "tangents": "x;y;z;nx;ny;nz;tx;ty;tz\n0;0;0,1;0;0;1;0;1;0\n0;0,1;0,1;0;0;1;0;1;0\n",
}
CUTTER = {
    "one cut": "UNITS/MM\nGOTO/0,0,100,0,0,1\nGOTO/0,100,100\nFINI\n",
    "two cuts": "UNITS/MM\nGOTO/0,0,100,0,0,1\nGOTO/0,50,100\nRAPID\nGOTO/20,0,100\n"
    "GOTO/20,50,100\n",
    "no unit": "GOTO/0,0,100,0,0,1\nGOTO/0,100,100\nFINI\n",
    "circle": "UNITS/MM\nGOTO/0,0,100,0,0,1\nCIRCLE/0,0,0,0,0,1,50\nGOTO/0,100,100\n",
    "after the end": "UNITS/MM\nGOTO/0,0,100,0,0,1\nGOTO/0,90,100\nFINI\nGOTO/0,100,100\n",
}


def tables():
    """Problems whose path is in a file, good or bad."""
    for number, (name, content) in enumerate([*TABLES.items(), *CUTTER.items()]):
        file = "path.csv" if name in TABLES else "path.apt"
        for kind in ("path", "job"):
            problem = GOOD[kind]()
            section = problem["path"] if kind == "path" else problem["strokes"][0]["path"]
            del section["waypoints"]
            section["file"] = file
            files = {MADE: text.yaml(problem), f"made/{file}": content}
            yield Case(f"bad table/{name} of a {kind}", files, asked(kind, number))


def cases():
    """A case for each mistake; the first of each kind has none."""
    for kind, make in GOOD.items():
        problem = make()
        yield Case(f"bad {kind}/none", {MADE: text.yaml(problem)}, asked(kind, 0))
        for number, (keys, value) in enumerate([*EVERYWHERE, *ONLY[kind]]):
            try:
                content = text.yaml(changed(problem, keys, value)).replace('"NAN"', ".nan")
            except (KeyError, IndexError):
                continue  # a key that this kind does not have
            name = "-".join(map(str, keys))
            yield Case(f"bad {kind}/{number:02} {name}", {MADE: content}, asked(kind, number))
        for number, (name, content) in enumerate(broken(problem).items()):
            yield Case(f"bad {kind}/{name}", {MADE: content}, asked(kind, number))
    yield from tables()

# SPDX-License-Identifier: BSD-3-Clause
"""The problem files in data/ are what the schema of problems allows, and results of real plans what
that of results says: all of its keys, and no others. Needs SWIVEL (the program) and SWIVEL_SOURCE
(the clone).

Types and values are judged by python3-jsonschema; without it the keys are compared alone."""
import json
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

try:
    import jsonschema
except ImportError:
    jsonschema = None
try:
    import yaml
except ImportError:
    yaml = None

PROGRAM, PROBLEMS = (
    os.environ["SWIVEL"],
    pathlib.Path(os.environ["SWIVEL_SOURCE"]) / "data" / "problems",
)


def swivel(*arguments):
    return subprocess.run(
        [PROGRAM, *map(str, arguments)], capture_output=True, text=True, timeout=300
    )


def schema(name):
    return json.loads(swivel("schema", name).stdout)


def validator(of):
    jsonschema.Draft7Validator.check_schema(of)
    return jsonschema.Draft7Validator(of)


def keys_of_schema(one, at=""):
    """The names of all keys, "motion.slow[].s"; of maps with free keys "diagnosis.removed.*"."""
    for option in one.get("anyOf", [one]):
        for key, value in option.get("properties", {}).items():
            yield f"{at}.{key}"
            yield from keys_of_schema(value, f"{at}.{key}")
        if option.get("type") == "array":
            yield from keys_of_schema(option["items"], at + "[]")


def keys_of(value, free, at=""):
    """The same of a document; `free`: where keys are free."""
    if isinstance(value, list):
        for item in value:
            yield from keys_of(item, free, at + "[]")
    elif isinstance(value, dict) and at not in free:
        for key, item in value.items():
            yield f"{at}.{key}"
            yield from keys_of(item, free, f"{at}.{key}")


@unittest.skipUnless(jsonschema and yaml, "python3-jsonschema or python3-yaml is missing")
class Problems(unittest.TestCase):
    def setUp(self):
        self.judge = validator(schema("problem"))

    def test_files_of_data_are_allowed(self):
        files = sorted(PROBLEMS.glob("*.yaml"))
        for file in files:
            with self.subTest(file.name):
                self.assertEqual(
                    [
                        error.message
                        for error in self.judge.iter_errors(yaml.safe_load(file.read_text()))
                    ],
                    [],
                )
        self.assertGreaterEqual(len(files), 11)

    def test_what_the_reader_refuses_is_not(self):
        changes = {
            "an unknown key": lambda p: p["limits"].update(clearence=1),
            "no robot": lambda p: p.pop("robot"),
            "a word for a number": lambda p: p["limits"].update(clearance="wide"),
            "a number that is too small": lambda p: p["resolution"].update(ds=0),
            "two shapes": lambda p: p["scene"][0].update(sphere=1),
            "no shape": lambda p: p["scene"].append({"name": "nothing"}),
            "both rotations": lambda p: p["scene"][0].update(rpy=[0, 0, 0], quat=[1, 0, 0, 0]),
            "waypoints and a file": lambda p: p["path"].update(file="path.csv"),
            "five weights": lambda p: p.update(cost={"weights": [1] * 5}),
            "another metric": lambda p: p.update(cost={"metric": "l3"}),
        }
        self.refuse(made_problem(walls=["wall"]) | {"limits": {}, "resolution": {}}, changes)

    def test_nor_what_it_refuses_of_jobs(self):
        stroke = {"path": made_problem()["path"], "limits": {}}
        good = made_problem() | {"strokes": [{"name": name, **stroke} for name in "ab"]}
        del good["path"]
        good |= {"home": {"joints": [0] * 7}, "approach": {"xyz": [0, 0, -0.1]}, "retract": 0.1}
        changes = {
            "a path besides": lambda p: p.update(path=stroke["path"]),
            "neither": lambda p: p.pop("strokes"),
            "a start": lambda p: p.update(start=p["home"]),
            "a home of five joints": lambda p: p["home"].update(joints=[0] * 5),
            "another order": lambda p: p.update(order="fastest"),
            "no speed": lambda p: p.update(process_speed=0),
            "more than all of the speed": lambda p: p.update(rapid=1.5),
            "a word for a length": lambda p: p.update(approach="near"),
            "a stroke without a name": lambda p: p["strokes"][0].pop("name"),
            "a stroke without a path": lambda p: p["strokes"][1].pop("path"),
            "a misspelt key": lambda p: p["strokes"][0].update(reversable=True),
            "a word for true": lambda p: p["strokes"][0].update(reversible="yes"),
            "soft limits of one": lambda p: p["strokes"][0]["limits"].update(soft_limits="false"),
            "a negative cost": lambda p: p.update(lift={"allowed": True, "cost": -1}),
            "lift-offs neither allowed nor not": lambda p: p.update(lift={"cost": 1}),
        }
        self.refuse(good, changes)
        problem = made_problem()
        for key in ("home", "order", "approach", "retract", "process_speed", "rapid"):
            with self.subTest(key):
                value = {"order": "best", "home": good["home"]}.get(key, 0.5)
                self.assertFalse(self.judge.is_valid(problem | {key: value}))

    def refuse(self, good, changes):
        """Expects that schema and reader refuse every change of a good problem or job."""
        self.assertTrue(self.judge.is_valid(good))
        with tempfile.TemporaryDirectory() as folder:
            for name, change in changes.items():
                with self.subTest(name):
                    problem = json.loads(json.dumps(good))
                    change(problem)
                    self.assertFalse(self.judge.is_valid(problem))
                    file = pathlib.Path(folder) / "problem.yaml"
                    file.write_text(json.dumps(problem))
                    done = swivel("plan", file)
                    self.assertEqual(done.returncode, 2, done.stdout)
                    self.assertRegex(done.stderr, "problem.yaml:1: .*allowed")


def made_problem(attached=(), walls=(), touched=(), arm="iiwa14", resolution=None, **path):
    """An arm, by default an iiwa 14, along two lines at right angles."""
    down = [0, 3.14159265358979, 0]
    corners = [[0.5, -0.2, 0.4], [0.5, 0.2, 0.4], [0.6, 0.2, 0.4]]
    robot = {
        "urdf": str(PROBLEMS.parent / "robots" / f"{arm}.urdf"), "base_link": "base_link",
        "tip_link": "tool0" if arm == "iiwa14" else "flange", "attached": list(attached)
    }
    scene = [{"name": name, "box": [0.3, 0.02, 1], "xyz": [0.5, 0, 0.5]} for name in walls]
    scene += list(touched)
    if path.get("frame") == "far":  # out of reach
        scene.append({"name": "far", "box": [0.1, 0.1, 0.1], "xyz": [2, 0, 0]})
    return {
        "robot": robot,
        "path": {"waypoints": [{"xyz": corner, "rpy": down} for corner in corners], **path},
        "scene": scene, "resolution": resolution or {},
    }


def made_workcell(gap, up=1.0):
    """Two arms whose tools move 0.1 m up, so far from each other (m)."""
    arms = [
        {
            "name": name, "tip_link": f"arm_{name}_link_tool0", "tool": {"xyz": [0, 0, 0.1]},
            "path": {
                "waypoints": [
                    {"xyz": [0.72, y, z], "rpy": [0, 1.5707963, 0]} for z in (up, up + 0.1)
                ]
            }
        } for name, y in (("left", gap / 2), ("right", -gap / 2))
    ]
    robots = PROBLEMS.parent / "robots"
    robot = {
        "urdf": str(robots / "sda10f.urdf"), "srdf": str(robots / "sda10f.srdf"),
        "base_link": "base_link", "hold": {"torso_joint_b1": 0}
    }
    return {"robot": robot, "arms": arms, "resolution": {"ds": 0.02, "dphi": 0.2}}


class Results(unittest.TestCase):
    # Every key appears: an answer, none, motions with slow stretches and stops, advice, proofs,
    # robots that touch themselves.
    RUNS = [
        ("experiment_c.yaml", "--refine", "--speed", "0.4", "--turn-speed", "2"),
        ("experiment_c.yaml", "--no-check"),
        ("experiment_c.yaml", "--timeout", "1e-6"),
        ("experiment_a_start.yaml", "--advise", "1", "--certificate", "cut.json"),
        ("kr6_weld_pipe.yaml", "--speed", "0.2"),
        ("torch_door.yaml", "--refine"),
        ("ur10e_rail_seam.yaml", "--ds", "0.1"),
        (made_problem(smooth=None), "--speed", "0.1"),
        (made_problem(walls=["one", "two"]),),
        (made_problem(walls=["one"], roll=[0.3, 0.6]),),
        (made_problem(frame="far"),),
        (made_problem(arm="panda_like", resolution={"knot": 0.06}),),
        # The nib, 0.1 m below the flange, is pressed 10 mm deep into the bed.
        (
            made_problem(
                attached=[{"name": "nib", "sphere": 0.02, "xyz": [0, 0, 0.1]}],
                touched=[
                    {
                        "name": "bed", "box": [0.4, 0.8, 0.1], "xyz": [0.6, 0, 0.24],
                        "allow": {"nib": 0.015}
                    }
                ],
            ),
        ),
        # The ball touches link_5 in every posture, and is always 4 mm from link_4.
        (made_problem(attached=[{"name": "ball", "sphere": 0.211, "xyz": [0, 0, -0.126]}]),),
    ]

    def setUp(self):
        self.schema = schema("result")
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)

    def results(self):
        folder = pathlib.Path(self.folder.name)
        for problem, *more in self.RUNS:
            name = problem if isinstance(problem, str) else "made.yaml"
            if isinstance(problem, dict):
                (folder / name).write_text(json.dumps(problem))
            more = [folder / word if word == "cut.json" else word for word in more]
            place = PROBLEMS / name if isinstance(problem, str) else folder / name
            done = swivel(
                "plan", place, "--planner", "lazy", *more, "--quiet",
                "--json", folder / "result.json"
            )
            self.assertIn(done.returncode, (0, 1, 3), done.stderr)
            yield f"{name} {more}", json.loads((folder / "result.json").read_text())

    def test_results_have_the_keys_of_the_schema_and_no_others(self):
        free = {".diagnosis.removed", ".time_ms.stages"}
        # Those of jobs are compared in tests/io/job_result_test.cpp, those of workcells below.
        of_plans = {
            "anyOf": [
                one for one in self.schema["anyOf"]
                if not {"parts", "decided_by"} & set(one["properties"])
            ]
        }
        known, seen, statuses = set(keys_of_schema(of_plans)), {".message"}, set()
        for problem, result in self.results():
            with self.subTest(problem):
                self.assertEqual(result["schema_version"], 1)
                statuses.add(result["status"])
                seen |= set(keys_of(result, free))
                if jsonschema:
                    errors = [
                        f"{list(error.absolute_path)}: {error.message}"
                        for error in validator(self.schema).iter_errors(result)
                    ]
                    self.assertEqual(errors, [])
        self.assertEqual(seen - known, set())
        self.assertEqual(known - seen, set())
        self.assertGreaterEqual(len(known), 150)
        self.assertGreaterEqual(statuses, {"solved", "infeasible", "timeout"})
        print(
            len(known),
            "keys of results seen"
            + ("" if jsonschema else "; values not judged: python3-jsonschema is missing"),
            file=sys.stderr,
        )

    def test_results_of_workcells_too(self):
        (of_workcells,) = [
            one for one in self.schema["anyOf"] if "decided_by" in one["properties"]
        ]
        known, seen, statuses = set(keys_of_schema(of_workcells)), set(), set()
        plate = PROBLEMS / "sda10f_plate_workcell.yaml"
        folder = pathlib.Path(self.folder.name)
        for cell, *more in (
            (plate, "--refine", "--speed", "0.05"), (plate,), (plate, "--timeout", "1e-9"),
            (made_workcell(gap=0.02), "--advise", "20"),
            (made_workcell(gap=0.5, up=3), "--advise", "20"),
        ):
            if isinstance(cell, dict):
                (folder / "cell.yaml").write_text(json.dumps(cell))
                cell = folder / "cell.yaml"
            done = swivel("plan", cell, *more, "--quiet", "--json", folder / "result.json")
            self.assertIn(done.returncode, (0, 1, 3), done.stderr)
            result = json.loads((folder / "result.json").read_text())
            statuses.add((result["status"], result["decided_by"]))
            free = {".arms[].diagnosis.removed", ".time_ms.stages"}
            seen |= set(keys_of(result, free))
            if jsonschema:
                validator(of_workcells).validate(result)
                validator(self.schema).validate(result)
        self.assertEqual(seen - known, set())
        # What arms have as plans have it need not appear here once more.
        alike = (
            ".arms[].diagnosis.", ".arms[].deepest_contact.", ".arms[].lattice.",
            ".arms[].partial[].", ".arms[].robot_pairs.", ".arms[].trajectory[].roll",
            ".motion.arms[].slow[]", ".motion.arms[].corners.stops[]",
            ".advice.arms[].advice[].", ".arms[].summary.slide_limit.",
        )
        self.assertEqual({key for key in known - seen if not key.startswith(alike)}, set())
        self.assertEqual(len(statuses), 4, statuses)

    def test_summaries_of_campaigns_too(self):
        of_campaigns = schema("campaign")
        # Planned, then read again.
        for out in (self.folder.name + "/rows.csv", self.folder.name + "/rows.csv"):
            done = swivel(
                "campaign", PROBLEMS / "experiment_c.yaml", "--episodes", 3, "--ds", 0.02,
                "--dphi", 0.2, "--out", out, "--json", "-"
            )
            self.assertEqual(done.returncode, 0, done.stderr)
            summary = json.loads(done.stdout)
            self.assertEqual((summary["schema_version"], summary["answered"]), (1, 3))
            self.assertEqual(set(keys_of(summary, set())), set(keys_of_schema(of_campaigns)))
            if jsonschema:
                validator(of_campaigns).validate(summary)


if __name__ == "__main__":
    unittest.main()

#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Jobs from outside: what `plan` says and writes of them, and who refuses them."""
import csv
import json
import os
import pathlib
import subprocess
import tempfile
import unittest

SWIVEL = os.environ["SWIVEL"]
DATA = pathlib.Path(os.environ["SWIVEL_DATA"])
JOB = DATA / "problems" / "door_job.yaml"


def run(*arguments):
    return subprocess.run(
        [SWIVEL, *map(str, arguments)], capture_output=True, text=True, timeout=300
    )


def one_job(**changes):
    """Two strokes of an iiwa 14 in free space, the first with lines before and after it."""
    def stroke(name, y, **more):
        corners = [[0.5, y - 0.05, 0.4], [0.5, y + 0.05, 0.4]]
        down = [0, 3.14159265358979, 0]
        return {
            "name": name, "path": {"waypoints": [{"xyz": at, "rpy": down} for at in corners]},
            **more
        }

    return {
        "robot": {
            "urdf": str(DATA / "robots" / "iiwa14.urdf"), "base_link": "base_link",
            "tip_link": "tool0"
        },
        "home": {"joints": [0, 0.5, 0, -1.4, 0, 1.2, 0]},
        "strokes": [stroke("left", 0.1, approach=0.05, retract=0.04), stroke("right", -0.1)],
        "resolution": {"ds": 0.02, "dphi": 0.2},
        **changes,
    }


class WithFolder(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def file(self, job):
        file = self.folder / "job.yaml"
        file.write_text(json.dumps(job))
        return file


class Jobs(WithFolder):
    def plan(self, job, *options):
        out, result = self.folder / "t.csv", self.folder / "r.json"
        done = run("plan", self.file(job), "--out", out, "--json", result, *options)
        return done, out, json.loads(result.read_text()) if result.exists() else None

    def test_answer_rows_and_result(self):
        done, out, result = self.plan(one_job())
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        lines = done.stdout.splitlines()
        self.assertRegex(lines[0], r"^solved: 2 strokes, cost [0-9.]+ \| bound [0-9.]+: ")
        self.assertRegex(lines[1], r"^  stroke +layers +cost +least +clearance mm +tool off mm$")
        self.assertRegex(lines[2], r"^  left +[0-9]+ +[0-9.]+ +[0-9.]+ +")
        self.assertRegex(lines[3], r"^  right +[0-9]+ +[0-9.]+ +[0-9.]+ +")
        self.assertEqual(len({len(line) for line in lines[1:4]}), 1)
        self.assertRegex(lines[4], r"^  3 transitions, [0-3] of them straight, cost ")
        self.assertEqual(result["status"], "solved")
        self.assertEqual([one["stroke"] for one in result["order"]], ["left", "right"])
        self.assertAlmostEqual(result["gap"], result["cost"] / result["bound"] - 1)
        self.assertLessEqual(result["bound_any"], result["bound"] * (1 + 1e-12))
        self.assertTrue(result["checked"])
        self.assertAlmostEqual(sum(part["cost"] for part in result["parts"]), result["cost"])
        self.assertEqual(
            [(one["from"], one["to"]) for one in result["transitions"]],
            [(None, "left"), ("left", "right"), ("right", None)]
        )
        with open(out) as file:
            rows = list(csv.DictReader(file))
        written = [
            (part["stroke"] or "", row) for part in result["parts"] for row in part["rows"]
        ]
        self.assertEqual(len(rows), len(written))
        for row, (stroke, told) in zip(rows, written):
            self.assertEqual(row["stroke"], stroke)
            self.assertEqual(row["process"], str(int(told["process"])))
            self.assertEqual(
                [float(row[joint]) for joint in result["joint_names"]], told["joints"]
            )
            self.assertEqual(row["s"] == "", stroke == "")
        # From home and back, without a jump from part to part.
        for end in (0, -1):
            self.assertEqual(written[end][1]["joints"], one_job()["home"]["joints"])
        for before, after in zip(result["parts"], result["parts"][1:]):
            for a, b in zip(before["rows"][-1]["joints"], after["rows"][0]["joints"]):
                self.assertAlmostEqual(a, b)
        # The lines before and after the first stroke are none of it.
        left = [row for row in rows if row["stroke"] == "left"]
        on = [float(row["s"]) for row in left if row["process"] == "1"]
        self.assertAlmostEqual(on[0], 0.05)
        self.assertAlmostEqual(on[-1], 0.15)
        self.assertAlmostEqual(float(left[-1]["s"]), 0.19)
        self.assertEqual({row["process"] for row in rows if row["stroke"] == "right"}, {"1"})

    def test_quiet_and_standard_output(self):
        done = run("plan", self.file(one_job()), "--quiet")
        self.assertEqual((done.returncode, done.stdout, done.stderr), (0, "", ""))
        done = run("plan", self.file(one_job()), "--json", "-")
        self.assertEqual(json.loads(done.stdout)["status"], "solved")

    def test_a_stroke_without_a_path(self):
        job = one_job()
        for waypoint in job["strokes"][1]["path"]["waypoints"]:
            waypoint["xyz"][0] = 3
        (self.folder / "t.csv").write_text("earlier")
        done, out, result = self.plan(job)
        self.assertEqual(done.returncode, 1, done.stdout + done.stderr)
        self.assertTrue(
            done.stdout.startswith("no job: 1 of 2 strokes has no path by itself\n"), done.stdout
        )
        self.assertIn("  stroke 'right': no path ", done.stdout)
        self.assertFalse(out.exists())
        self.assertIn("there is no job now", done.stderr)
        self.assertEqual(result["status"], "infeasible")
        self.assertEqual(
            [run["diagnosis"] is not None for run in result["runs"]], [False, True]
        )

    def test_options_that_jobs_do_not_take(self):
        file = self.file(one_job())
        options = [
            ("--refine",), ("--speed", 0.1), ("--turn-speed", 1), ("--rate", 100), ("--chord", 1),
            ("--advise", 1), ("--report", "r.html"), ("--certificate", "c.json"),
            ("--trace", "t.json"), ("--map",), ("--map-svg", "m.svg"), ("--full-map",),
            ("--base", "--x", 0.1)
        ]
        for option in options:
            with self.subTest(option[0]):
                done = run("plan", file, *option)
                self.assertEqual((done.returncode, done.stdout), (2, ""))
                self.assertRegex(
                    done.stderr, rf"^swivel: .*{option[0]}.*: is not supported yet for jobs, as "
                    r".*job.yaml is one: allowed are problems with one path\n$"
                )
        for planner in ("eager", "eager_dp"):
            done = run("plan", file, "--planner", planner)
            self.assertEqual(done.returncode, 2)
            self.assertRegex(done.stderr, "^swivel: --planner: .* allowed are lazy, parallel\n$")
        done = run("plan", file, "--out", "motion.json")
        self.assertEqual(done.returncode, 2)
        self.assertRegex(done.stderr, "^swivel: --out: motion.json: a job without times")

    def test_bad_jobs(self):
        for key, value in (("order", "fastest"), ("lift", {"allowed": True}), ("rapid", 2)):
            with self.subTest(key):
                done = run("plan", self.file(one_job(**{key: value})))
                self.assertEqual((done.returncode, done.stdout), (2, ""))
                self.assertRegex(done.stderr, rf"^swivel: .*job.yaml:1: {key}: .*allowed.*\n$")


class CheckedJobs(WithFolder):
    def setUp(self):
        super().setUp()
        self.job = self.file(one_job())
        self.out = self.folder / "t.csv"
        done = run("plan", self.job, "--out", self.out)
        self.assertEqual(done.returncode, 0, done.stderr)
        with self.out.open() as file:
            self.rows = list(csv.DictReader(file))

    def check(self, rows):
        with self.out.open("w", newline="") as file:
            writer = csv.DictWriter(file, self.rows[0].keys(), lineterminator="\n")
            writer.writeheader()
            writer.writerows(rows)
        return run("check", self.job, self.out)

    def test_passes(self):
        done = self.check(self.rows)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertRegex(
            done.stdout, r"^passed: \d+ rows in 2 strokes and 3 transitions; cost \d"
        )

    def test_refuses_what_was_changed(self):
        def rows_of(name):
            return [k for k, row in enumerate(self.rows) if row["stroke"] == name]

        left, right, moves = rows_of("left"), rows_of("right"), rows_of("")
        joint = next(key for key in self.rows[0] if key not in ("s", "phi", "branch"))

        def change(row, **values):
            def apply(rows):
                rows[row].update(values)
            return apply

        def cut(first, last):
            def apply(rows):
                del rows[first:last]
            return apply

        def move(row, by):
            def apply(rows):
                rows[row][joint] = repr(float(rows[row][joint]) + by)
            return apply

        middle = left[len(left) // 2]
        changes = {
            "process off in a stroke": change(middle, process="0"),
            "process on in an approach": change(left[0], process="1"),
            "process on in a transition": change(moves[0], process="1"),
            "a stroke of another name": lambda rows: [rows[k].update(stroke="up") for k in left],
            "a jump in a stroke": move(middle, 0.01),
            "a transition ends elsewhere": move(left[0] - 1, 0.01),
            "a transition begins elsewhere": move(left[-1] + 1, 1e-6),
            "no retract": cut(left[-1], left[-1] + 1),
            "no approach": cut(left[0], left[0] + 1),
            "no transition": cut(left[-1] + 1, right[0]),
            "no second stroke": cut(right[0], right[-1] + 1),
            "strokes swapped": lambda rows: rows.__setitem__(
                slice(None),
                [{**row, "stroke": {"left": "right", "right": "left"}.get(row["stroke"], "")}
                 for row in rows]
            ),
            "not home": move(len(self.rows) - 1, 0.01),
        }
        for name, apply in changes.items():
            with self.subTest(name):
                rows = [dict(row) for row in self.rows]
                apply(rows)
                done = self.check(rows)
                self.assertIn(done.returncode, (1, 2), done.stdout)
                if done.returncode == 1:
                    self.assertRegex(done.stdout, r"^failed: .* failure")
                else:
                    self.assertRegex(done.stderr, r"^swivel: .*\n$")


class Refused(WithFolder):
    def test_other_commands_refuse_jobs(self):
        rows = self.folder / "rows.csv"
        rows.write_text("")
        commands = [
            ("time", JOB, rows, "--out", self.folder / "t.csv"),
            ("campaign", JOB, "--episodes", 1, "--out", self.folder / "c.csv"),
            ("place", JOB, "--base", "--x", "0:1:0.5", "--out", self.folder / "p.csv"),
            ("info", JOB, "--pairs"),
        ]
        for command in commands:
            with self.subTest(command[0]):
                done = run(*command)
                self.assertEqual(done.returncode, 2, done.stdout)
                self.assertRegex(
                    done.stderr, r"^swivel: .*door_job.yaml:16: strokes: makes this file a job, "
                    r"which `plan`, `check` and io::load_job\(\) take: allowed is a `path` here\n$"
                )
                self.assertEqual(done.stdout, "")


if __name__ == "__main__":
    unittest.main()

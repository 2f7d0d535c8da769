#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""What `plan` and `time` write of one path, of a job and of two arms, `check` and `time` read, in
every format; tables with their columns in any order and without those that can be worked out."""
import csv
import json
import os
import pathlib
import random
import re
import subprocess
import tempfile
import unittest

from job_test import one_job
from workcell_test import cell

SWIVEL = os.environ["SWIVEL"]
DATA = pathlib.Path(os.environ["SWIVEL_DATA"])
ENDINGS = ("csv", "json", "yaml", "mcap")
SPEED = ("--speed", "0.1", "--rate", "50")


def run(*arguments):
    return subprocess.run(
        [SWIVEL, *map(str, arguments)], capture_output=True, text=True, timeout=120
    )


def one_path():
    job = one_job()
    return {
        "robot": job["robot"], "path": job["strokes"][0]["path"], "resolution": job["resolution"]
    }


def job_without_home():
    job = one_job()
    del job["home"]
    return job


def six_joints():
    """A job of an arm of six joints, whose tool may turn about its axis."""
    text = (DATA / "problems" / "ur5e_deburr_plate_job.yaml").read_text().replace("../", f"{DATA}/")
    text = re.sub(r"(?m)^order: best\n", "", text)
    first, last = text.index("  - name: right"), text.index("scene:")
    return text[:first] + text[last:].replace("ds: 0.005", "ds: 0.01")


def lift_off():
    """A ring that is done in two runs."""
    text = (DATA / "problems" / "iiwa14_ring_job.yaml").read_text().replace("../", f"{DATA}/")
    return text.replace("ds: 0.005, dphi: 0.05", "ds: 0.01, dphi: 0.1")


def led():
    """Two arms, of which the left one carries the path of the right one."""
    problem = cell()
    problem["arms"][1]["path"] = {
        "frame": "left", "waypoints": [{"xyz": [0, -0.45, 0]}, {"xyz": [0.02, -0.45, 0]}]
    }
    return problem


def arms_of_six_joints():
    problem = cell(resolution={"ds": 0.02})
    for arm in problem["arms"]:
        problem["robot"]["hold"][f"arm_{arm['name']}_joint_3_e"] = 0
        arm["path"]["roll"] = [-0.3, 0.3]
    return problem


KINDS = {
    "path": one_path, "job": one_job, "job without home": job_without_home,
    "job of six joints": six_joints, "job in runs": lift_off, "two arms": cell, "leader": led,
    "arms of six joints": arms_of_six_joints
}


def table(file):
    with open(file) as lines:
        return list(csv.DictReader(lines))


def write(file, rows, columns):
    with open(file, "w", newline="") as out:
        writer = csv.DictWriter(out, columns, extrasaction="ignore")
        writer.writeheader()
        writer.writerows(rows)


class TrajectoryFiles(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.folder = pathlib.Path(folder.name)
        cls.problems = {}
        for kind, make in KINDS.items():
            problem = make()
            file = cls.problems[kind] = cls.folder / f"{kind}.yaml"
            file.write_text(problem if isinstance(problem, str) else json.dumps(problem))
            for name, options in (("rows", ()), ("motion", SPEED)):
                endings = ENDINGS if options else ["csv"]
                outs = [cls.folder / f"{kind} {name}.{ending}" for ending in endings]
                words = [word for out in outs for word in ("--out", out)]
                done = run("plan", file, *options, *words, "--quiet")
                assert done.returncode == 0, (kind, name, done.stdout, done.stderr)

    def file(self, kind, name, ending="csv"):
        return self.folder / f"{kind} {name}.{ending}"

    def check(self, kind, file):
        speed = SPEED[:2] if "job" in kind and "rows" not in file.name else ()
        return run("check", self.problems[kind], file, *speed)

    def passes(self, kind, file):
        done = self.check(kind, file)
        self.assertEqual((done.returncode, done.stderr), (0, ""), (kind, file, done.stdout))
        self.assertTrue(done.stdout.startswith("passed: "), done.stdout)
        return done.stdout

    def costs(self, kind, file):
        return [float(cost) for cost in re.findall(r"cost ([0-9.]+)", self.passes(kind, file))]

    def timed(self, kind, file):
        """The motion that is made of a file; None where its rows jump, which no motion can."""
        out = self.folder / "timed.csv"
        done = run("time", self.problems[kind], file, *SPEED, "--out", out, "--quiet")
        if "rows" in file.name and done.returncode == 1:
            self.assertIn("not executable: ", done.stdout, done.stderr)
            return None
        self.assertEqual((done.returncode, done.stderr), (0, ""), (kind, file))
        self.passes(kind, out)
        return table(out)

    def assert_same(self, rows, others):
        """Joints and times are the same but for the rounding of messages."""
        if rows is None or others is None:
            return self.assertEqual(rows, others)
        self.assertEqual(len(rows), len(others))
        for row, other in zip(rows, others):
            for key, value in row.items():
                if key in ("stroke", "process"):
                    self.assertEqual(value, other[key], key)
                elif key == "roll" and row.get("s") == "":
                    pass  # turns freely in transitions
                elif not key.endswith("_a") and not key.endswith("_v") and value != "":
                    self.assertAlmostEqual(float(value), float(other[key]), 6, key)

    def test_every_format_is_checked_and_timed(self):
        for kind in KINDS:
            whole = self.timed(kind, self.file(kind, "motion"))
            costs = self.costs(kind, self.file(kind, "motion"))
            for ending in ENDINGS[1:]:
                with self.subTest(kind=kind, ending=ending):
                    file = self.file(kind, "motion", ending)
                    for is_now, was in zip(self.costs(kind, file), costs, strict=True):
                        self.assertAlmostEqual(is_now, was, 6)
                    self.assert_same(whole, self.timed(kind, file))

    def test_motions_are_timed_as_their_rows_are(self):
        """A motion that is timed again at the speed that it has is what it was."""
        for kind in KINDS:
            with self.subTest(kind=kind):
                file = self.file(kind, "motion")
                self.assertAlmostEqual(len(self.timed(kind, file)), len(table(file)), delta=2)

    def test_tables_in_any_order_and_without_what_can_be_worked_out(self):
        draw = random.Random(1)
        for kind in KINDS:
            for name in ("rows", "motion"):
                rows = table(self.file(kind, name))
                places = [key for key in rows[0] if re.match(r"(s|phi|branch)(_|$)", key)]
                if kind == "job in runs":
                    places.remove("s")
                rates = [key for key in rows[0] if key.endswith(("_v", "_a"))]
                whole = self.timed(kind, self.file(kind, name))
                rolls = [key for key in rows[0] if key.startswith("roll")]
                for left_out in ([], places, rates + places + rolls):
                    with self.subTest(kind=kind, name=name, left_out=left_out):
                        columns = [key for key in rows[0] if key not in left_out]
                        draw.shuffle(columns)
                        file = self.folder / f"shuffled {name}.csv"
                        write(file, rows, columns)
                        self.passes(kind, file)
                        self.assert_same(whole, self.timed(kind, file))

    def test_times_may_begin_anywhere(self):
        for kind in KINDS:
            with self.subTest(kind=kind):
                rows = table(self.file(kind, "motion"))
                late = self.folder / "late motion.csv"
                write(late, [{**row, "t": float(row["t"]) + 16} for row in rows], rows[0])
                self.passes(kind, late)
                whole = self.timed(kind, self.file(kind, "motion"))
                self.assert_same(whole, self.timed(kind, late))

    def refused(self, kind, name, text, *words):
        file = self.folder / name
        file.write_bytes(text if isinstance(text, bytes) else text.encode())
        for command in (("check", self.problems[kind], file),
                        ("time", self.problems[kind], file, *SPEED)):
            done = run(*command)
            self.assertEqual((done.returncode, done.stdout), (2, ""), (kind, name, done.stderr))
            self.assertEqual(len(done.stderr.splitlines()), 1, done.stderr)
            for word in (name, *words):
                self.assertIn(word, done.stderr, kind)

    def test_broken_files(self):
        for kind in ("path", "job", "two arms"):
            header = self.file(kind, "motion").read_text().splitlines()[0]
            name = next(key[:-2] for key in header.split(",") if key.endswith("_v")).encode()
            for ending in ENDINGS:
                text = self.file(kind, "motion", ending).read_bytes()
                with self.subTest(kind=kind, ending=ending):
                    self.refused(kind, f"cut.{ending}", text[:2 * len(text) // 3])
                    other = name[:-1] + b"#"
                    self.refused(
                        kind, f"renamed.{ending}", text.replace(name, other), other.decode()
                    )
            self.refused(kind, "empty.csv", "", "is empty")
            self.refused(kind, "header.csv", header + "\n", "0 data row(s)")
            rows = table(self.file(kind, "motion"))
            spoilt = self.folder / "spoilt.csv"
            for column, value, words in (("t", "-1", ("data row 9", ": t: ", "ascend")),
                                         ("q", "nan", ("data row 9", "is not a number"))):
                column = column if column in rows[0] else [key[:-2] for key in rows[0]
                                                           if key.endswith("_v")][3]
                changed = [dict(row) for row in rows]
                changed[8][column] = value
                write(spoilt, changed, rows[0])
                self.refused(kind, "spoilt.csv", spoilt.read_text(), *words)
            write(spoilt, [{**row, "more": 0} for row in rows], [*rows[0], "more"])
            self.refused(kind, "spoilt.csv", spoilt.read_text(), "column 'more' is unknown")

    def test_broken_events(self):
        """The events of a job say which rows are those of which stroke."""
        message = json.loads(self.file("job", "motion", "json").read_text())
        first = message["events"][0]
        bench = [
            (None, "has no events"),
            ([], "has no row of a stroke"),
            ([3], "events[0]: is no map"),
            (message["events"][:1], "events[0]: does not belong to the one that follows"),
            (message["events"][::-1], "events[0]: does not belong"),
            ([{**first, "t": 0.0001}, *message["events"][1:]], "is the time of a row"),
            ([{**first, "stroke": "lfet"}, {**message["events"][1], "stroke": "lfet"}],
             "'lfet' is no stroke"),
            ([{**first, "process": 1}], "process: is no text"),
            ([{key: first[key] for key in first if key != "run"}], "lacks the key run"),
            ([{**first, "run": {"t": [0], "s": [0, 1]}}], "run: t: is no list of two numbers"),
            ([{**first, "more": 1}], "key 'more' is unknown"),
            (message["events"][:2] * 2, "events[2]: its times are not in order"),
        ]
        for events, words in bench:
            with self.subTest(words=words):
                spoilt = {key: value for key, value in message.items() if key != "events"}
                if events is not None:
                    spoilt["events"] = events
                words = words.replace("is the time", "allowed is the time")
                self.refused("job", "events.json", json.dumps(spoilt), words)
        swapped = json.loads(json.dumps(message))
        for event in swapped["events"]:
            if event["process"] == "on":
                event["s"] += 0.001
        file = self.folder / "events.json"
        file.write_text(json.dumps(swapped))
        done = self.check("job", file)
        self.assertEqual(done.returncode, 1, done.stdout + done.stderr)
        self.assertIn("event 1: allowed is process on of stroke 'left'", done.stdout)
        log = self.file("job", "motion", "mcap").read_bytes()
        self.refused(
            "job", "events.mcap", log.replace(b'"process": "on"', b'"process": #on"', 1),
            "message 0 of '/process': is not JSON"
        )
        path = self.file("path", "motion", "json").read_text()
        self.refused("job", "path.json", path, "has no events of a process")
        path = self.file("path", "motion").read_text()
        self.refused("job", "path.csv", path, "column 'stroke' is missing")
        self.refused("two arms", "path.csv", path, "is unknown, or no joint of the two arms")

    def test_a_stroke_in_runs_needs_its_places(self):
        rows = table(self.file("job in runs", "motion"))
        file = self.folder / "places.csv"
        write(file, rows, [key for key in rows[0] if key != "s"])
        self.refused("job in runs", "places.csv", file.read_text(), "lacks the column s")


class SeveralOutputs(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def test_all_or_none(self):
        for kind, make in (("path", one_path), ("job", one_job), ("two arms", cell)):
            problem = self.folder / "problem.yaml"
            problem.write_text(json.dumps(make()))
            rows = [self.folder / f"rows{k}.csv" for k in range(2)]
            done = run("plan", problem, "--out", rows[0], "--out", rows[1], "--quiet")
            self.assertEqual(done.returncode, 0, (kind, done.stderr))
            self.assertEqual(*(file.read_text() for file in rows))
            outs = [self.folder / f"m.{ending}" for ending in ENDINGS]
            words = [word for out in outs for word in ("--out", out)]
            for command in ("plan", problem), ("time", problem, rows[0]):
                for out in outs:
                    out.unlink(missing_ok=True)
                done = run(*command, *SPEED, *words, "--quiet")
                self.assertEqual((done.returncode, done.stderr), (0, ""), kind)
                begins = [out.read_bytes()[:5] for out in outs]
                self.assertEqual(begins[0][:2], b"t,")
                self.assertEqual(begins[1][:2], b'{"')
                self.assertEqual(begins[2], b"heade")
                self.assertEqual(begins[3], b"\x89MCAP")

                kept = [out.read_bytes() for out in outs]
                bad = (("--out", self.folder / "none" / "m.csv"), "none/m.csv"), (
                    ("--out", self.folder / "." / "m.csv"), "m.csv: is the file of --out as well"
                ), (("--out", self.folder / "m.txt"), "unknown format"), (
                    ("--out", problem), "problem.yaml: "
                )
                for more, said in bad:
                    done = run(*command, *SPEED, *words, *more)
                    self.assertEqual((done.returncode, done.stdout), (2, ""), (kind, more))
                    self.assertEqual(len(done.stderr.splitlines()), 1, done.stderr)
                    self.assertIn(said, done.stderr)
                    self.assertEqual([out.read_bytes() for out in outs], kept)
            # A path without times is CSV, whatever else is asked for.
            done = run("plan", problem, "--out", rows[0], "--out", outs[1])
            self.assertEqual((done.returncode, done.stdout), (2, ""), kind)
            self.assertIn("m.json: ", done.stderr)

    def test_where_there_is_no_plan_earlier_files_go(self):
        problem = self.folder / "problem.yaml"
        barred = [{"name": "plate", "box": [0.4, 0.02, 0.04], "xyz": [0.5, 0.1, 0.4]}]
        problem.write_text(json.dumps({**one_path(), "scene": barred}))
        outs = [self.folder / f"m.{ending}" for ending in ENDINGS]
        for out in outs:
            out.write_text("of an earlier run\n")
        words = [word for out in outs for word in ("--out", out)]
        done = run("plan", problem, *SPEED, *words)
        self.assertEqual(done.returncode, 1, done.stderr)
        self.assertEqual([out.exists() for out in outs], [False] * 4)


if __name__ == "__main__":
    unittest.main()

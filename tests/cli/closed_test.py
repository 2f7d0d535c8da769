#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Closed paths on the command line: laps, refining, timing, and what is refused."""
import csv
import json
import unittest

from cli_test import DATA, PROBLEMS, WithFolder, run

COVERS = "panda_polish_covers_job.yaml"


class Closed(WithFolder):
    def problem(self, name, *changes, closed=True):
        text = (PROBLEMS / name).read_text().replace("../", f"{DATA}/")
        for before, after in changes:
            self.assertIn(before, text)
            text = text.replace(before, after, 1)
        if closed:
            text = text.replace("path:\n", "path:\n  closed: true\n", 1)
        file = self.folder / name
        file.write_text(text)
        return file

    def lap(self, closed=True):
        """A lap round the lid of iiwa14_bench.yaml."""
        side = "    - {xyz: [0.085, -0.105, 0.065], rpy: [3.141592653589793, 0, 0]}\n"
        back = "    - {xyz: [0.085, 0.105, 0.065], rpy: [3.141592653589793, 0, 0]}\n"
        return self.problem("iiwa14_bench.yaml", (side, side + back), closed=closed)

    def ends(self, file):
        with open(file, newline="") as opened:
            rows = [row for row in csv.reader(opened) if row and not row[0].startswith("#")]
        columns = [
            k for k, name in enumerate(rows[0]) if name.startswith("joint_") and "_" not in name[6:]
        ]
        self.assertGreaterEqual(len(columns), 6, rows[0])
        return [[float(row[k]) for k in columns] for row in (rows[1], rows[-1])]

    def assertRefused(self, done, *words):
        self.assertEqual((done.returncode, done.stdout, len(done.stderr.splitlines())), (2, "", 1))
        for word in words:
            self.assertIn(word, done.stderr)

    def test_a_lap_ends_where_it_begins(self):
        problem, out = self.lap(), self.folder / "out.csv"
        for options in ((), ("--refine",), ("--refine", "--speed", "0.02"), ("--planner", "eager")):
            with self.subTest(options=options):
                done = run("plan", problem, *options, "--out", out)
                self.assertEqual(done.returncode, 0, done.stderr)
                first, last = self.ends(out)
                for a, b in zip(first, last):
                    self.assertAlmostEqual(a, b, delta=1e-9)
                done = run("check", problem, out)
                self.assertEqual(done.returncode, 0, done.stdout + done.stderr)

    def test_strokes_of_a_job_close(self):
        lines = ("approach: 0.05\nretract: 0.05\n", "approach: 0\nretract: 0\n")
        out, told = self.folder / "out.csv", self.folder / "out.json"
        for changes in ((), (lines,)):
            with self.subTest(changes=changes):
                job = self.problem(COVERS, *changes, closed=False)
                done = run("plan", job, "--out", out, "--json", told)
                self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
                strokes = {}
                for part in json.loads(told.read_text())["parts"]:
                    if part["stroke"] is not None:
                        rows = part["rows"]
                        strokes[part["stroke"]] = (rows[0]["joints"], rows[-1]["joints"])
                self.assertEqual(set(strokes), {"left", "right"})
                for first, last in strokes.values():
                    self.assertLess(max(abs(a - b) for a, b in zip(first, last)), 1e-9)
                done = run("check", job, out)
                self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        opened = self.problem(COVERS, *2 * (("closed: true, ", ""),), closed=False)
        self.assertEqual(run("plan", opened, "--out", out).returncode, 0)
        done = run("check", self.problem(COVERS, closed=False), out)
        self.assertEqual(done.returncode, 1)
        self.assertIn("the path is closed", done.stdout)

    def test_the_stroke_that_does_not_close_is_named(self):
        # a seam all round a pipe on a table, which turns on
        path = "strokes:\n  - name: seam\n    path:\n      closed: true\n      frame: pipe\n"
        job = self.problem(
            "kr6_turntable_pipe.yaml",
            ("path:\n  frame: pipe\n", path),
            ("\n  file:", "\n      file:"),
            ("ds: 0.005", "ds: 0.01, arc: 0.6, knot: 0"),
            closed=False,
        )
        out = self.folder / "out.json"
        done = run("plan", job, "--json", out)
        self.assertEqual(done.returncode, 1, done.stdout + done.stderr)
        self.assertIn("seam", done.stdout)
        self.assertIn("path.closed", done.stdout)
        cause = json.loads(out.read_text())["runs"][0]["diagnosis"]["cause"]["cause"]
        self.assertEqual(cause, "not_closed")

    def test_check_refuses_rows_that_do_not_close(self):
        out = self.folder / "out.csv"
        self.assertEqual(run("plan", self.lap(closed=False), "--out", out).returncode, 0)
        first, last = self.ends(out)
        self.assertGreater(max(abs(a - b) for a, b in zip(first, last)), 1e-6)
        done = run("check", self.lap(), out)
        self.assertEqual(done.returncode, 1)
        self.assertIn("the path is closed", done.stdout)

    def test_a_table_that_must_turn_on_closes_no_path(self):
        problem, out = self.problem(
            "kr6_turntable_pipe.yaml", ("ds: 0.005", "ds: 0.01, arc: 0.6, knot: 0")
        ), self.folder / "out.json"
        done = run("plan", problem, "--json", out)
        self.assertEqual(done.returncode, 1, done.stdout + done.stderr)
        self.assertEqual(json.loads(out.read_text())["diagnosis"]["cause"]["cause"], "not_closed")

    def test_laps_that_run_backwards_pass_their_check(self):
        backwards = 0
        for closed in (True, False):
            changes = [("closed: true, ", "closed: true, " if closed else "")] * 2
            job = self.problem(
                COVERS, *changes, ("name: left", "name: left, reversible: true"),
                ("name: right", "name: right, reversible: true"), closed=False
            )
            for options in ((), ("--speed", "0.05"), ("--knot", "0")):
                out, result = self.folder / "laps.csv", self.folder / "laps.json"
                done = run("plan", job, *options, "--out", out, "--json", result)
                self.assertEqual(done.returncode, 0, done.stderr)
                backwards += sum(r["reversed"] for r in json.loads(result.read_text())["runs"])
                knots = options if "--knot" in options else ()
                done = run("check", job, out, *knots)
                self.assertEqual(done.returncode, 0, (options, done.stdout))
        self.assertGreater(backwards, 3)

    def test_refused(self):
        kr6 = "kr6_weld_pipe.yaml"
        line = self.problem("iiwa14_bench.yaml")
        self.assertRefused(run("plan", line), "path.closed", "from the first")
        start = ("resolution:", "start: {joints: [0, -1, 1, 0, 1, 0, 0]}\nresolution:")
        self.assertRefused(run("plan", self.problem(kr6, start)), "path.closed", "start")
        certificate = ("--certificate", self.folder / "c.json")
        no_path = self.problem(kr6, ("ds: 0.005", "ds: 0.005, knot: 0"))
        self.assertRefused(run("plan", no_path, *certificate), "closed")
        for name in ("kr6_weld_pipe_job.yaml", "door_job.yaml"):
            job = self.problem(name, ("path: {", "path: {closed: true, "), closed=False)
            self.assertRefused(run("plan", job), "strokes[0].path.closed", "from the first")
        job = self.problem(COVERS, ("retract: 0.05", "retract: 0.04"), closed=False)
        self.assertRefused(run("plan", job), "strokes[0].path.closed", "`approach`", "`retract`")
        job = self.problem(COVERS, ("order: best", "lift: {allowed: true}"), closed=False)
        self.assertRefused(run("plan", job), "lift", "'left'", "closed")
        closed = ("    path:\n", "    path:\n      closed: true\n")
        cell = self.problem("sda10f_plate_workcell.yaml", closed, closed=False)
        self.assertRefused(run("plan", cell), "closed", "not supported yet")


if __name__ == "__main__":
    unittest.main(verbosity=1)

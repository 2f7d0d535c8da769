#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""What files and command lines say and is not honoured is refused or warned of: keys and options
that the arm does not use, options that exclude each other, degrees, and speeds of millimetres."""
import json
import re
import unittest

from cli_test import DATA, PROBLEMS, WithFolder, run

BENCH = PROBLEMS / "iiwa14_bench.yaml"
BENCH_JOB = PROBLEMS / "iiwa14_bench_job.yaml"
ARCS = PROBLEMS / "ur5e_deburr_edge.yaml"
ARCS_JOB = PROBLEMS / "ur5e_deburr_plate_job.yaml"
CELL = PROBLEMS / "sda10f_plate_workcell.yaml"


class InVain(WithFolder):
    def refused(self, words, *arguments):
        done = run(*arguments)
        self.assertEqual(done.returncode, 2, (arguments, done.stdout, done.stderr))
        self.assertEqual(len(done.stderr.splitlines()), 1, done.stderr)
        for word in words:
            self.assertIn(word, done.stderr)

    def file(self, problem, *changes):
        """A copy of a problem with changes, in the folder."""
        text = problem.read_text().replace("../", f"{DATA}/")
        for before, after in changes:
            self.assertIn(before, text)
            text = text.replace(before, after, 1)
        file = self.folder / "p.yaml"
        file.write_text(text)
        return file

    def test_options_of_an_arm_angle(self):
        for problem in (ARCS, ARCS_JOB):
            for options in (("--dphi", "0.1"), ("--arcs",)):
                self.refused((f"swivel: {options[0]}: ", "no arm angle"), "plan", problem, *options)
            self.refused(
                ("--dphi: ", "no arm angle"), "campaign", problem, "--episodes", "1", "--dphi", "1"
            )
        self.refused(("--no-arcs", "--arcs"), "plan", BENCH, "--arcs", "--no-arcs")

    def test_keys_of_a_file(self):
        arc = "resolution: {ds: 0.005, dphi: 0.05"
        for problem in (BENCH, BENCH_JOB, CELL):
            line = problem.read_text().split("resolution:")[0].count("\n") + 1
            self.refused(
                (f"p.yaml:{line}: resolution.arc: is given, but the arm is S-R-S",), "plan",
                self.file(problem, (arc, arc + ", arc: 0.1"))
            )

    def test_episodes_where_nothing_varies(self):
        for problem in (BENCH, BENCH_JOB, CELL):
            self.refused(
                ("--seed, --episode", "no `vary`"), "plan", problem, "--seed", "1", "--episode", "0"
            )

    def test_steps_of_a_sample(self):
        sample = ("place", BENCH, "--path", "--sample", "3")
        self.refused(("--x: ", "--sample", "FROM:TO"), *sample, "--x", "-0.1:0.1:0.05")
        self.refused(
            ("--hold lift: ", "--sample"), *sample, "--x", "-0.1:0.1", "--hold", "lift=0:1:0.1"
        )

    def test_a_path_beside_a_trajectory(self):
        cell = self.file(CELL, ("  - name: left\n", "  - name: left\n    trajectory: rows.csv\n"))
        self.refused(("p.yaml:", "arms[0].path: is given for an arm whose motion is given"),
                     "plan", cell)

    def test_speeds_of_millimetres(self):
        words = ("speed: is 50 m/s, and the arm reaches", "millimetres", "at most ")
        for problem in (BENCH, BENCH_JOB, CELL):
            self.refused(words, "plan", problem, "--speed", "50")
        for problem in (BENCH, BENCH_JOB):
            rows = self.folder / "rows.csv"
            self.assertEqual(run("plan", problem, "--out", rows).returncode, 0)
            self.refused(words, "time", problem, rows, "--speed", "50")

    def test_the_speed_of_a_job(self):
        done = run("plan", BENCH_JOB, "--speed", "0.1")
        self.assertIn(" s of it on strokes at 100 mm/s and ", done.stdout)
        limit = ("limits: {clearance: 0.005,", "limits: {tool_speed: 0.05, clearance: 0.005,")
        for more in ((), (("approach: 0.05\n", "approach: 0.05\napproach_speed: 0.02\n"),)):
            done = run("plan", self.file(BENCH_JOB, limit, *more), "--speed", "0.1")
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertIn(" s of it on strokes at 50 mm/s and ", done.stdout)
            self.assertIn(
                "stroke 'bead_0': a tool speed of 0.1 m/s is asked for: limits.tool_speed allows "
                "0.05 m/s, which is kept\n", done.stderr
            )

    def test_home_is_not_blamed_for_a_margin(self):
        door = self.file(
            PROBLEMS / "door_job.yaml",
            ("limits: {clearance", "limits: {joint_margin: 3.2, clearance")
        )
        self.refused(("limits.joint_margin: leaves no range for joint",), "plan", door)

    def test_times_and_lengths(self):
        told = self.folder / "r.json"
        self.assertEqual(run("plan", CELL, "--json", told).returncode, 0)
        self.assertGreater(json.loads(told.read_text())["time_ms"]["plan"], 0)
        rows = self.folder / "rows.csv"
        planned = run("plan", BENCH, "--speed", "0.07", "--out", rows)
        checked = run("check", BENCH, rows)
        length = r"^motion: ([0-9.]+) s"
        self.assertEqual(
            *(re.search(length, done.stdout, re.M)[1] for done in (planned, checked))
        )

    def test_joints_in_degrees(self):
        urdf = (DATA / "robots/iiwa14.urdf").read_text()
        robot = self.folder / "iiwa14.urdf"
        robot.write_text(
            re.sub(r'velocity="([0-9.]+)"', lambda v: f'velocity="{57.3 * float(v[1]):.0f}"', urdf)
        )
        line = urdf.split('name="joint_a1"')[0].count("\n") + 1
        words = (
            f"iiwa14.urdf:{line}: joint 'joint_a1' may turn at 85 rad/s, and 6 more joints: are "
            "these degrees? Angles are read as radians\n"
        )
        for problem in (BENCH, BENCH_JOB):
            file = self.file(problem, (f"{DATA}/robots/iiwa14.urdf", str(robot)))
            done = run("plan", file)
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertEqual(done.stderr.count(words), 1, done.stderr)
        self.assertIn(words, run("info", robot).stdout)

    def test_an_object_that_is_fixed_to_a_link(self):
        pipe = PROBLEMS / "kr6_turntable_pipe.yaml"
        self.refused(
            ("--object: 'post' is fixed to link 'room'",), "place", pipe, "--object", "post", "--x",
            "0:0.1:0.1"
        )


if __name__ == "__main__":
    unittest.main()

#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Tool paths in the dialects of CAM programs, spreadsheets and scripts, planned to motions that
`check` passes. The files are in tests/data/cam."""
import csv
import json
import pathlib
import unittest

from cli_test import DATA, WithFolder, run

FILES = pathlib.Path(__file__).parent.parent / "data/cam"
# Name, keys of the path beside it, and how long the way is, mm.
PATHS = [
    ("curve_multax.aptsource", {"units": "mm"}, 130),
    ("contour_tlaxis.apt", {"units": "mm"}, 380),
    ("streamline.cls", {"units": "mm"}, 123),
    ("trajectory.ncl", {}, 160),
    ("swarf_inch.CL", {}, 150),
    ("flow.apt", {}, 150),
    ("spreadsheet_normals.csv", {}, 120),
    ("savetxt.csv", {}, 120),
    ("raster_tangents.txt", {"units": "mm", "roll": "free"}, 280),
]
ARMS = {"iiwa14": "tool0", "kr6_like": "flange"}


class Cam(WithFolder):
    def ok(self, *arguments):
        done = run(*arguments)
        self.assertEqual(done.returncode, 0, done.stderr)
        return done.stdout

    def problem(self, robot, **keys):
        file = self.folder / "problem.yaml"
        file.write_text(
            json.dumps(
                {
                    "robot": {
                        "urdf": str(DATA / f"robots/{robot}.urdf"),
                        "srdf": str(DATA / f"robots/{robot}.srdf"),
                        "base_link": "base_link",
                        "tip_link": ARMS[robot],
                        "tool": {"xyz": [0, 0, 0.15]},
                    },
                    **keys,
                }
            )
        )
        return file

    def test_every_file_becomes_a_motion(self):
        self.assertEqual(
            {path.name for path in FILES.iterdir()},
            {name for name, _, _ in PATHS} | {"two_lines.cls"},
        )
        for name, keys, length in PATHS:
            for robot in ARMS:
                with self.subTest(file=name, robot=robot):
                    problem = self.problem(robot, path={"file": str(FILES / name), **keys})
                    motion = self.folder / "motion.csv"
                    self.ok(
                        "plan", problem, "--planner", "lazy", "--speed", "0.04", "--rate", "100",
                        "--out", motion
                    )
                    self.assertIn("passed", self.ok("check", problem, motion))
                    with open(motion, newline="") as rows:
                        last = list(csv.DictReader(rows))[-1]
                    self.assertAlmostEqual(1000 * float(last["s"]), length, delta=2)

    def test_tangents_without_a_free_roll(self):
        problem = self.problem(
            "iiwa14", path={"file": str(FILES / "raster_tangents.txt"), "units": "mm"}
        )
        self.ok("plan", problem, "--planner", "lazy", "--out", self.folder / "p.csv")

    def test_cuts_are_strokes_at_the_feed_of_the_file(self):
        cuts = [
            {
                "name": f"line_{cut}",
                "path": {
                    "file": str(FILES / "two_lines.cls"), "units": "mm", "cut": cut, "roll": "free"
                },
            }
            for cut in (1, 2)
        ]
        problem = self.problem("kr6_like", strokes=cuts)
        motion = self.folder / "motion.csv"
        self.ok("plan", problem, "--planner", "lazy", "--rate", "50", "--out", motion)
        self.assertIn("passed", self.ok("check", problem, motion))
        with open(motion, newline="") as file:
            rows = list(csv.DictReader(file))
        for cut in (1, 2):
            at = [float(row["t"]) for row in rows if row["stroke"] == f"line_{cut}"]
            # 3 mm down and 120 mm along the dome at 250 mm/min
            self.assertAlmostEqual(at[-1] - at[0], 123.2 / 250 * 60, delta=0.5)

    def test_a_file_with_two_cuts_is_no_path(self):
        path = {"file": str(FILES / "two_lines.cls"), "units": "mm"}
        refused = run("plan", self.problem("kr6_like", path=path))
        self.assertEqual(refused.returncode, 2)
        self.assertRegex(refused.stderr, r"two_lines\.cls:34: begins the second of 2 cuts")
        self.assertEqual(refused.stderr.count("\n"), 1)

    def test_arms_whose_roll_cannot_be_free_refuse_normals_alone(self):
        ARMS["panda_like"] = "flange"
        self.addCleanup(ARMS.pop, "panda_like")
        refused = run("plan", self.problem("panda_like", path={"file": str(FILES / "flow.apt")}))
        self.assertEqual(refused.returncode, 2)
        self.assertRegex(
            refused.stderr, r"problem\.yaml:\d+: path\.file: has the tool's axis alone.*S-R-S"
        )


if __name__ == "__main__":
    unittest.main()

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


class Refused(WithFolder):
    def test_other_commands_refuse_jobs(self):
        rows = self.folder / "rows.csv"
        rows.write_text("")
        commands = [
            ("check", JOB, rows),
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
                    done.stderr, r"^swivel: .*door_job.yaml:15: strokes: makes this file a job, "
                    r"which `swivel plan` and io::load_job\(\) take: allowed is a `path` here\n$"
                )
                self.assertEqual(done.stdout, "")


if __name__ == "__main__":
    unittest.main()

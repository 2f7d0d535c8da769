#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Several files of one answer of `plan` and `time`, in every format."""
import json
import os
import pathlib
import subprocess
import tempfile
import unittest

from job_test import one_job
from workcell_test import cell

SWIVEL = os.environ["SWIVEL"]
ENDINGS = ("csv", "json", "yaml", "mcap")
SPEED = ("--speed", "0.1", "--rate", "100")


def run(*arguments):
    return subprocess.run(
        [SWIVEL, *map(str, arguments)], capture_output=True, text=True, timeout=120
    )


def one_path():
    job = one_job()
    return {
        "robot": job["robot"], "path": job["strokes"][0]["path"], "resolution": job["resolution"]
    }


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

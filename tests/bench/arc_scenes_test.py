#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""The scenes of bench/arc_scenes: the same for the same seed, each a problem that loads; and what
it says of two tables that differ."""
import contextlib
import csv
import importlib.machinery
import importlib.util
import io
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

try:
    import yaml
except ImportError:
    sys.exit(4)  # python3-yaml is not installed

SWIVEL = os.environ["SWIVEL"]
SCRIPT = pathlib.Path(os.environ["SWIVEL_DATA"]).parent / "bench" / "arc_scenes"


def loaded():
    sys.dont_write_bytecode = True
    loader = importlib.machinery.SourceFileLoader("arc_scenes", str(SCRIPT))
    module = importlib.util.module_from_spec(importlib.util.spec_from_loader("arc_scenes", loader))
    loader.exec_module(module)
    return module


scenes = loaded()


class ArcScenes(unittest.TestCase):
    def test_seeds_and_kinds(self):
        for name in scenes.NAMES:
            for number in range(4):
                kind, problem = scenes.scene_of(name, number, 1)
                self.assertEqual((kind, problem), scenes.scene_of(name, number, 1))
                if number > 0:
                    self.assertNotEqual(problem, scenes.scene_of(name, number, 2)[1], kind)
                    self.assertNotEqual(problem["scene"], scenes.scene_of(name, 0, 1)[1]["scene"])
            self.assertEqual({scenes.scene_of(name, k, 1)[0] for k in range(4)},
                             {"file", *scenes.KINDS})

    def test_scenes_load(self):
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder) / "scene.yaml"
            for number, name in enumerate(scenes.NAMES):
                problem = scenes.with_paths(scenes.scene_of(name, 1 + number // 2, 1)[1])
                file.write_text(yaml.safe_dump(problem))
                done = subprocess.run([SWIVEL, "info", "--pairs", file], capture_output=True)
                self.assertEqual(done.returncode, 0, (name, done.stderr))

    def test_tables(self):
        with tempfile.TemporaryDirectory() as folder:
            table = pathlib.Path(folder) / "table.csv"
            command = [sys.executable, SCRIPT, SWIVEL, "--only", "ur5e_deburr_edge", "--count", "2"]
            done = subprocess.run([*command, "--out", table], capture_output=True, text=True)
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertRegex(done.stdout, r"^ur5e_deburr_edge: 3 scenes, \d solved; [\d,]+ pairs")
            with table.open() as file:
                rows = list(csv.DictReader(file))
            self.assertEqual([row["kind"] for row in rows], ["file", "gap", "ball"])
            done = subprocess.run([*command, "--against", table], capture_output=True, text=True)
            self.assertIn("3 scenes in both tables, 0 with another verdict", done.stdout)
            self.assertIn("pairs over those of before: sum 1.0000", done.stdout)
            now = [{**row, "scene": int(row["scene"])} for row in rows]
            now[0] = {**now[0], "status": "infeasible", "cost": ""}
            with contextlib.redirect_stdout(io.StringIO()) as told:
                scenes.compare(now, rows)
            self.assertIn("1 with another verdict\n  ur5e_deburr_edge 0 (file): solved, now "
                          "infeasible\n", told.getvalue())


if __name__ == "__main__":
    unittest.main()

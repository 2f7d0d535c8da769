#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Plans that time ends, of every kind of problem: what leaves the program as an answer is proved,
and nothing else is written."""
import functools
import json
import os
import pathlib
import random
import subprocess
import tempfile
import time
import unittest

from trials import at_least, seed, trials

SWIVEL = os.environ["SWIVEL"]
PROBLEMS = pathlib.Path(os.environ["SWIVEL_DATA"]) / "problems"
WHOLE = 60  # s that a plan may take at most


def run(*arguments):
    return subprocess.run(
        [SWIVEL, *map(str, arguments)], capture_output=True, text=True, timeout=4 * WHOLE
    )


def rows_of(result):
    """The rows of an answer and those that are not proved, by stroke or arm."""
    if "arms" in result:
        arms = result["arms"]
        return [arm["trajectory"] or [] for arm in arms], [arm["partial"] for arm in arms]
    if "parts" in result:
        return [result["parts"]], [result["partial"]]
    return [result["trajectory"] or []], [result["partial"]]


class Stopped(unittest.TestCase):
    """Every job, every pair of arms, and some single paths; with a motion every other time, and
    some refined."""

    FILES = sorted(
        [*PROBLEMS.glob("*_job.yaml"), *PROBLEMS.glob("*_workcell.yaml")]
        + [PROBLEMS / f"{name}.yaml" for name in ("experiment_a", "kr6_weld_pipe", "torch_door")]
    )

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    @staticmethod
    @functools.lru_cache(None)
    def whole(problem, options):
        """How long the whole command takes, s, so that time-outs fall into all of its stages."""
        begun = time.monotonic()
        if run("plan", problem, "--quiet", *options).returncode != 0:
            raise AssertionError(f"{problem} {options}: no plan")
        return time.monotonic() - begun

    def test_no_answer_is_unproved(self):
        draw = random.Random(seed(20261128))
        stopped = solved = 0
        count = trials(3 * len(self.FILES))
        for trial in range(count):
            problem = self.FILES[trial % len(self.FILES)]
            options = ("--speed", "0.05") if trial // len(self.FILES) % 2 else ()
            if not problem.name.endswith("_job.yaml") and draw.random() < 0.5:
                options += ("--refine",)
            timeout = draw.uniform(0.05, 1.05) * self.whole(problem, options)
            with self.subTest(trial=trial, problem=problem.name, timeout=timeout):
                answered = self.examine(problem, timeout, options)
                solved += answered
                stopped += not answered
        print(f"{count} plans with a time-out: {solved} answered, {stopped} stopped")
        self.assertGreaterEqual(stopped, at_least(8))
        self.assertGreaterEqual(solved, at_least(1))

    def examine(self, problem, timeout, options):
        out, json_file = self.folder / "rows.csv", self.folder / "result.json"
        out.write_text("of an earlier run\n")
        done = run(
            "plan", problem, "--timeout", f"{timeout:.4f}", "--out", out, "--json", json_file,
            *options
        )
        self.assertIn(done.returncode, (0, 3), done.stdout + done.stderr)
        result = json.loads(json_file.read_text())
        rows, partial = rows_of(result)
        solved = result["status"] == "solved"
        self.assertEqual(result["checked"], True if solved else None)
        self.assertEqual(any(rows), solved)
        self.assertFalse(solved and any(partial))
        if done.returncode == 3:
            # An answer may be known whose motion is not: that is no answer to what was asked.
            if solved:
                self.assertIn("--speed", options)
                motion = result["motion"]
                self.assertEqual((motion["executable"], motion["reason"]), (False, "stopped"))
            self.assertFalse(out.exists())
            return False
        self.assertTrue(solved)
        checked = run("check", problem, out)
        self.assertEqual(checked.returncode, 0, checked.stdout + checked.stderr)
        return True


class NoCheck(unittest.TestCase):
    def test_rows_say_whether_they_were_proved(self):
        """`--no-check` of plans, campaigns and placements."""
        with tempfile.TemporaryDirectory() as folder:
            rows = pathlib.Path(folder) / "rows.csv"
            quick = ("--ds", "0.02", "--dphi", "0.2")
            asked = (
                ("campaign", PROBLEMS / "experiment_c.yaml", "--episodes", "4"),
                ("campaign", PROBLEMS / "door_job.yaml", "--episodes", "2"),
                ("place", PROBLEMS / "experiment_c.yaml", "--base", "--x", "0:0.02:0.01"),
            )
            for words in asked:
                for option, checked in ((), "true"), (("--no-check",), "false"):
                    done = run(*words, *quick, *option, "--out", rows)
                    self.assertEqual(done.returncode, 0, done.stderr)
                    lines = [
                        line.split(",") for line in rows.read_text().splitlines()
                        if not line.startswith("#")
                    ]
                    column, status = lines[0].index("checked"), lines[0].index("status")
                    said = {line[column] for line in lines[1:] if line[status] == "solved"}
                    self.assertEqual(said, {checked}, words)


if __name__ == "__main__":
    unittest.main()

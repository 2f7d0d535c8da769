#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""What many plans by two threads make of the system: how often threads sleep, how often files are
written. Counts alone, which hold whatever else the machine does."""
import os
import pathlib
import sys
import time
import unittest

from cli_test import PROBLEMS, SWIVEL
from workcell_study_test import with_fixture
from workcell_test import WithWorkcells

QUICK = ("--planner", "lazy", "--ds", "0.02", "--dphi", "0.2", "--edges", "nodes")
# Threads that take memory from one heap slept one to six times a plan of C.
SLEEPS_PER_PLAN = 0.1
WRITES_PER_SECOND = 10  # of rows; decision 0184
FEW = 12  # beside those: opening, header, table, summary, threads that begin and end
# The sanitizers have an allocator of their own.
SANITIZED = "SWIVEL_FAULT" in os.environ and not os.environ["SWIVEL_FAULT"]


def used_by(*arguments):
    """Runs the program; returns its exit code, how often it slept and wrote, and seconds."""
    begun = time.monotonic()
    process = os.posix_spawn(
        SWIVEL, [SWIVEL, *map(str, arguments)], os.environ,
        file_actions=[(os.POSIX_SPAWN_OPEN, 1, os.devnull, os.O_WRONLY, 0)]
    )
    os.waitid(os.P_PID, process, os.WEXITED | os.WNOWAIT)
    seconds = time.monotonic() - begun
    counts = dict(
        line.split(": ") for line in pathlib.Path(f"/proc/{process}/io").read_text().splitlines()
    )
    _, status, usage = os.wait4(process, 0)
    return os.waitstatus_to_exitcode(status), usage.ru_nvcsw, int(counts["syscw"]), seconds


@unittest.skipUnless(sys.platform == "linux", "counts are read from /proc")
class Throughput(WithWorkcells):
    def expect_few_sleeps(self, plans, sleeps, writes):
        """A write may wait for the disk."""
        if not SANITIZED:
            self.assertLessEqual(sleeps, FEW + writes + SLEEPS_PER_PLAN * plans)

    def expect_few(self, kind, problem, episodes, *options):
        """A campaign by two threads sleeps and writes seldom."""
        out = self.folder / "rows.csv"
        code, sleeps, writes, seconds = used_by(
            "campaign", problem, "--episodes", episodes, "--threads", 2, "--out", out, *options
        )
        self.assertEqual(code, 0)
        print(f"{kind}: {episodes} plans, {sleeps} sleeps, {writes} writes, {seconds:.2f} s")
        self.expect_few_sleeps(episodes, sleeps, writes)
        self.assertLessEqual(writes, FEW + WRITES_PER_SECOND * seconds)
        self.assertEqual(len(out.read_text().splitlines()), 1 + episodes)

    def test_campaigns_of_a_path(self):
        self.expect_few("path", PROBLEMS / "experiment_c.yaml", 400, *QUICK)

    def test_campaigns_of_a_job(self):
        self.expect_few("job", PROBLEMS / "door_job.yaml", 100, *QUICK)

    def test_campaigns_of_two_arms(self):
        problem = with_fixture()
        problem["vary"] = [{"object": "fixture", "xyz": [0.3, 0.2, 0.05]}]
        self.expect_few("two arms", self.file(problem), 400)

    def test_placements(self):
        code, sleeps, writes, _ = used_by(
            "place", PROBLEMS / "experiment_c.yaml", *QUICK, "--object", "door",
            "--x=-0.1:0.1:0.01", "--y=-0.1:0.1:0.01", "--threads", 2,
            "--out", self.folder / "cells.csv"
        )
        self.assertEqual(code, 0)
        plans = len((self.folder / "cells.csv").read_text().splitlines()) - 1
        self.assertEqual(plans, 441)
        print(f"placements: {sleeps} sleeps, {plans} plans")
        self.expect_few_sleeps(plans, sleeps, writes)


if __name__ == "__main__":
    unittest.main()

#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Placements and campaigns over a Dask scheduler with two workers, each a process, one of which is
killed in the middle.

SWIVEL_DATA is the data folder, SWIVEL_EXAMPLES that of examples. Exit code 77: not tried.
"""
import os
import subprocess
import sys
import tempfile
import time
import unittest
from pathlib import Path

import numpy as np

import swivel

try:
    from dask.distributed import Client
except ImportError as error:
    print(f"skipped: {error} (Debian: python3-distributed)")
    sys.exit(77)

PROBLEM = Path(os.environ["SWIVEL_DATA"]) / "problems/experiment_c.yaml"


def quick():
    problem = swivel.load(PROBLEM)
    problem.resolution = swivel.Resolution(ds=0.02, dphi=0.2)
    return problem


def bits(rows, without=()):
    columns = {
        name: getattr(rows, name)
        for name in dir(type(rows))
        if isinstance(getattr(type(rows), name), property) and name not in without
    }
    return {
        name: column.tobytes() if isinstance(column, np.ndarray) else column
        for name, column in columns.items()
    }


class Cluster(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder, self.processes = Path(folder.name), []
        self.start("dask_scheduler", "--host", "127.0.0.1", "--port", "0", "--no-dashboard")
        self.workers = [self.worker() for _ in range(2)]
        self.client = Client(scheduler_file=str(self.folder / "scheduler.json"), timeout=60)
        self.addCleanup(self.client.close)
        self.client.wait_for_workers(2, timeout=60)

    def start(self, module, *arguments):
        with (self.folder / f"{len(self.processes)}.log").open("wb") as log:
            process = subprocess.Popen(
                [
                    sys.executable, "-m", f"distributed.cli.{module}",
                    "--scheduler-file", self.folder / "scheduler.json", *arguments
                ],
                stdin=subprocess.DEVNULL,
                stdout=log,
                stderr=log,
                cwd=self.folder,
            )
        self.processes.append(process)
        self.addCleanup(process.wait, 30)
        self.addCleanup(process.kill)
        return process

    def worker(self):
        return self.start(
            "dask_worker", "--nthreads", "1", "--no-nanny", "--no-dashboard",
            "--local-directory", self.folder
        )

    GRID = {"object": "door", "x": (-0.1, 0.1, 0.01), "y": (-0.1, 0.1, 0.01), "planner": "lazy"}

    def test_rows_are_those_of_one_process(self):
        problem = quick()
        count = 0
        for keywords in (
            self.GRID,
            {**self.GRID, "refine_grid": True, "best": ["clearance", "cost"]},
            {"base": True, "x": (-0.1, 0.1), "yaw": (-0.2, 0.2), "sample": 50, "seed": 3},
        ):
            there, here = swivel.place(problem, client=self.client, **keywords), swivel.place(
                problem, **keywords
            )
            self.assertEqual(bits(there), bits(here))
            count += len(there)
        there, here = swivel.campaign(
            problem, episodes=101, seed=5, client=self.client
        ), swivel.campaign(problem, episodes=101, seed=5)
        self.assertEqual(bits(there, {"plan_ms"}), bits(here, {"plan_ms"}))
        self.assertEqual(there.episode.tolist(), list(range(101)))
        print(count, "placements and", len(there), "episodes compared")
        self.assertGreater(count, 441 + 50)
        used = self.client.run(lambda: "swivel" in sys.modules)
        self.assertEqual(sorted(used.values()), [True, True])

    def test_rows_of_jobs_are_those_of_one_process(self):
        job = swivel.load(PROBLEM.with_name("door_job.yaml"))
        job.resolution = swivel.Resolution(ds=0.02, dphi=0.1)
        grid = {"base": True, "x": (-0.1, 0.1, 0.1), "y": (0, 0.1, 0.1)}
        there, here = swivel.place(job, client=self.client, **grid), swivel.place(job, **grid)
        self.assertEqual(bits(there), bits(here))
        self.assertEqual(len(there), 6)
        there, here = swivel.campaign(
            job, episodes=20, seed=2, client=self.client
        ), swivel.campaign(job, episodes=20, seed=2)
        self.assertEqual(bits(there, {"plan_ms"}), bits(here, {"plan_ms"}))
        self.assertTrue(0 < there.solved.sum() < 20)

    def test_a_worker_is_killed(self):
        problem = quick()
        here = swivel.place(problem, **self.GRID)
        came = []

        def progress(rows, done, of):
            came.append((len(rows), done, of))
            if len(came) == 5:
                self.workers[0].kill()

        there = swivel.place(problem, client=self.client, progress=progress, **self.GRID)
        self.assertEqual(bits(there), bits(here))
        self.assertIsNotNone(self.workers[0].wait(30))
        self.assertIsNone(self.workers[1].poll())
        self.assertLess(came[4][1], len(here) // 2)
        self.assertEqual(came[-1][1:], (441, 441))
        self.assertEqual(sum(rows for rows, _, _ in came), 441)
        self.assertEqual(len(self.client.nthreads()), 1)
        # The last one that was there at the beginning goes too, when another has come.
        came.clear()

        def replace(rows, done, of):
            came.append(done)
            if len(came) == 3:
                self.worker()
                self.client.wait_for_workers(2, timeout=60)
                self.workers[1].kill()

        episodes = swivel.campaign(problem, episodes=200, client=self.client, progress=replace)
        self.assertEqual(
            bits(episodes, {"plan_ms"}), bits(swivel.campaign(problem, episodes=200), {"plan_ms"})
        )
        self.assertIsNotNone(self.workers[1].wait(30))
        print(f"killed after {came[2]} of 200 episodes")

    def test_problems_and_answers_travel(self):
        problem = swivel.load(PROBLEM)
        plans = self.client.map(swivel.plan, [problem, str(PROBLEM)], planner="lazy", pure=False)
        here = swivel.plan(problem, planner="lazy")
        for plan in self.client.gather(plans):
            self.assertEqual((plan.joints.tobytes(), plan.cost), (here.joints.tobytes(), here.cost))

    def test_what_goes_wrong_is_told(self):
        problem = quick()

        def broken(*_):
            raise KeyError("mine")

        with self.assertRaisesRegex(KeyError, "mine"):
            swivel.place(problem, client=self.client, progress=broken, **self.GRID)
        with self.assertRaisesRegex(swivel.InvalidArgument, "exactly one"):
            swivel.place(problem, client=self.client, x=0.0)
        with self.assertRaisesRegex(ValueError, "vary"):
            swivel.campaign(PROBLEM.with_name("experiment_a.yaml"), client=self.client)
        begin = time.monotonic()
        rows = swivel.place(
            problem, client=self.client, timeout=20, object="door", x=(-0.1, 0.1, 0.0005),
            y=(-0.1, 0.1, 0.0005)
        )
        self.assertTrue(0 < len(rows) < 160801)
        self.assertLess(time.monotonic() - begin, 120)
        # Nothing is in its way.
        self.assertEqual(len(swivel.place(problem, client=self.client, object="door", x=0.01)), 1)


if __name__ == "__main__":
    unittest.main(verbosity=2)

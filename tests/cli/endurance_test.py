#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""A long campaign of experiment C in one process: its memory does not grow, and its answers pass
`swivel check`.
SWIVEL_TEST_TRIALS is the number of episodes (1600 unless given, whatever the scale: fewer show no
growth); of them up to 200 are checked, spread over all, SWIVEL_TEST_SCALE of them where it is
given."""
import csv
import os
import pathlib
import random
import subprocess
import time
import unittest

from cli_test import PROBLEMS, SWIVEL, WithFolder, run
from trials import trials

PROBLEM = PROBLEMS / "experiment_c.yaml"
EPISODES = int(os.environ.get("SWIVEL_TEST_TRIALS", 1600))
SEED = os.environ.get("SWIVEL_TEST_SEED") or "20260701"
SAMPLE = min(200, trials(200))
WARM_UP = 0.25  # of the episodes
# What is kept on purpose are the rows of --out, some 200 bytes each; a trajectory that stayed would
# be 8,000. The heap of a short campaign has not yet its size, and comes in pages of 2 MB.
MOST_PER_EPISODE, MOST_AT_ALL = 1000, 6 << 20


def resident(pid):
    """Bytes."""
    status = pathlib.Path(f"/proc/{pid}/status").read_text()
    return 1024 * next(
        (int(line.split()[1]) for line in status.splitlines() if line.startswith("VmRSS:")), 0
    )


def slope(points):
    """Of the line of least squares."""
    x, y = [sum(values) / len(points) for values in zip(*points)]
    return sum((a - x) * (b - y) for a, b in points) / sum((a - x) ** 2 for a, _ in points)


class Endurance(WithFolder):
    def campaign(self):
        """The rows, and (rows done, bytes resident) all along."""
        out, folder = self.folder / "rows.csv", self.folder / "trajectories"
        part = self.folder / "rows.csv.part"
        command = [
            SWIVEL, "campaign", PROBLEM, "--planner", "lazy", "--threads", "1", "--seed", SEED,
            "--episodes", EPISODES, "--out", out, "--trajectories", folder
        ]
        samples = []
        with subprocess.Popen(
            list(map(str, command)), stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True
        ) as process:
            while process.poll() is None:
                try:
                    memory = resident(process.pid)
                    with part.open("rb") as file:
                        done = sum(1 for _ in file) - 2  # the settings, the header
                    if memory and (not samples or done > samples[-1][0]):
                        samples.append((done, memory))
                except FileNotFoundError:  # not begun, or ended between the two lines
                    pass
                time.sleep(0.005 if EPISODES < 1000 else 0.05)
            self.assertEqual(process.returncode, 0, process.stderr.read())
        with out.open(newline="") as file:
            return list(csv.DictReader(file)), samples

    def test_memory_and_answers(self):
        rows, samples = self.campaign()
        self.assertEqual(len(rows), EPISODES)
        warm = [sample for sample in samples if sample[0] >= WARM_UP * EPISODES]
        self.assertGreater(len(warm), 5)
        growth = slope(warm)
        print(
            f"{EPISODES} episodes, {len(samples)} samples of memory: {samples[0][1] >> 20} MiB at "
            f"first, {warm[0][1] / 2**20:.1f} after {warm[0][0]}, "
            f"{warm[-1][1] / 2**20:.1f} at the end: {growth:.0f} bytes an episode"
        )

        random.Random(SEED).shuffle(rows)
        passed = {"solved": 0, "infeasible": 0}
        for row in rows[:SAMPLE]:
            episode = ("--seed", SEED, "--episode", row["episode"])
            if row["status"] == "solved":
                done = run(
                    "check", PROBLEM,
                    self.folder / "trajectories" / f"episode_{row['episode']}.csv", *episode
                )
            else:
                certificate = self.folder / "none.json"
                self.assertEqual(
                    run(
                        "plan", PROBLEM, "--planner", "lazy", "--certificate", certificate, *episode
                    ).returncode,
                    1,
                    row,
                )
                done = run("check", PROBLEM, "--certificate", certificate, *episode)
            self.assertEqual(done.returncode, 0, f"{row}\n{done.stdout}{done.stderr}")
            passed[row["status"]] += 1
        print(
            f"checked: {passed['solved']} trajectories, {passed['infeasible']} certificates, all "
            "passed"
        )
        self.assertGreater(passed["solved"], passed["infeasible"])
        grown_over = warm[-1][0] - warm[0][0]
        self.assertLess(growth * grown_over, MOST_PER_EPISODE * grown_over + MOST_AT_ALL)


if __name__ == "__main__":
    unittest.main()

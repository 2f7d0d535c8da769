#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Campaigns and placements of jobs from outside: each row is what `plan` says of its job alone,
shards join to the whole, and what jobs do not take is refused."""
import csv
import json
import shlex
import unittest

from job_test import JOB, WithFolder, run

COARSE = ("--ds", 0.02, "--dphi", 0.1)


def rows_of(file):
    with open(file, newline="") as table:
        return list(csv.DictReader(table))


def without_time(rows):
    return [{key: value for key, value in row.items() if key != "plan_ms"} for row in rows]


class Studies(WithFolder):
    def planned(self, *arguments):
        """The result of `plan`."""
        result = self.folder / "one.json"
        done = run("plan", *arguments, "--quiet", "--json", result)
        self.assertIn(done.returncode, (0, 1), done.stderr)
        return json.loads(result.read_text())

    def expect_answer(self, row, said):
        """The row has the status, the cost and the cause of a result."""
        self.assertEqual(row["status"], said["status"])
        self.assertEqual(float(row["cost"]) if row["cost"] else None, said["cost"])
        if said["status"] == "solved":
            return
        self.assertTrue(row["reason"])
        if row["cause"] == "transition":
            self.assertIsNotNone(said["no_transition"])
            self.assertEqual(row["failed_s"], "")
            return
        first = next(run for run in said["runs"] if run["status"] == "infeasible")
        self.assertEqual(
            row["reason"], f"stroke '{first['stroke']}': {first['diagnosis']['reason']}"
        )
        self.assertEqual(row["cause"], first["diagnosis"]["cause"]["cause"])
        self.assertEqual(
            float(row["failed_s"]) if row["failed_s"] else None, first["diagnosis"]["reached_s"]
        )

    def expect_refused(self, *arguments, message):
        done = run(*arguments)
        self.assertEqual((done.returncode, done.stdout), (2, ""), done.stdout + done.stderr)
        self.assertRegex(done.stderr, message)
        self.assertEqual(done.stderr.count("\n"), 1)


class JobCampaigns(Studies):
    def campaign(self, name, *options, code=0):
        out = self.folder / name
        # Of these episodes three are solved.
        done = run("campaign", JOB, *COARSE, "--episodes", 6, "--seed", 2, "--out", out, *options)
        self.assertEqual(done.returncode, code, done.stdout + done.stderr)
        return done, out

    def test_rows_are_what_plan_says(self):
        paths, summary = self.folder / "paths", self.folder / "s.json"
        paths.mkdir()
        for episode in range(6):
            (paths / f"episode_{episode}.csv").write_text("earlier")
        done, out = self.campaign(
            "one.csv", "--threads", 1, "--trajectories", paths, "--json", summary
        )
        self.assertRegex(done.stdout, "^6 of 6 episodes answered: ")
        rows = rows_of(out)
        self.assertEqual([int(row["episode"]) for row in rows], list(range(6)))
        self.assertEqual(
            without_time(rows), without_time(rows_of(self.campaign("many.csv", "--threads", 3)[1]))
        )
        for row in rows:
            episode = ("--seed", 2, "--episode", row["episode"])
            self.expect_answer(row, self.planned(JOB, *COARSE, *episode))
            path = paths / f"episode_{row['episode']}.csv"
            self.assertEqual(path.exists(), row["status"] == "solved")
            if path.exists():
                self.assertEqual(run("check", JOB, path, *COARSE, *episode).returncode, 0)
                worst = float(row["tool_path_error_mm_max"])
                self.assertTrue(0 < float(row["tool_path_error_mm_mean"]) < worst <= 1)
        solved = sum(row["status"] == "solved" for row in rows)
        self.assertTrue(0 < solved < 6, rows)
        self.assertIn(
            f"removed {6 - solved} earlier trajectories in {paths}: there is no job now\n",
            done.stderr
        )
        self.assertEqual(json.loads(summary.read_text())["solved"], solved)

    def test_shards_and_pages(self):
        whole = rows_of(self.campaign("whole.csv")[1])
        shards = [self.campaign(f"{k}.csv", "--shard", f"{k}/2")[1] for k in range(2)]
        merged, page = self.folder / "merged.csv", self.folder / "page.html"
        done = run("merge", merged, *shards)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(without_time(rows_of(merged)), without_time(whole))
        done, _ = self.campaign("again.csv", "--rows", merged)
        self.assertIn("6 of 6 episodes answered", done.stdout)
        done = run("merge", merged, *shards, "--report", page)
        if "built without reports" not in done.stderr:
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertIn("door_job.yaml", page.read_text())

    def test_refused(self):
        out = self.folder / "c.csv"
        still = self.folder / "job.yaml"
        still.write_text(
            JOB.read_text().split("vary:")[0].replace("../", str(JOB.parent.parent) + "/")
        )
        self.expect_refused(
            "campaign", still, "--episodes", 2, "--out", out, message="job.yaml: vary: missing"
        )
        self.assertFalse(out.exists())


class JobPlacements(Studies):
    GRID = ("--base", "--x", "-0.1:0.1:0.1", "--y", "0:0.1:0.1")

    def place(self, name, *options, code=0):
        out = self.folder / name
        done = run("place", JOB, *COARSE, *self.GRID, "--out", out, *options)
        self.assertEqual(done.returncode, code, done.stdout + done.stderr)
        return done, out

    def test_cells_are_what_plan_says(self):
        done, out = self.place("cells.csv")
        self.assertRegex(done.stdout, "^6 of 6 placements planned, ")
        rows = rows_of(out)
        self.assertEqual(rows, rows_of(self.place("one.csv", "--threads", 1)[1]))
        self.assertEqual([int(row["cell"]) for row in rows], list(range(6)))
        met = set()
        for row in rows:
            said = self.planned(JOB, *COARSE, "--base", f"--x={row['x']}", f"--y={row['y']}")
            self.expect_answer(row, said)
            met.add(row["status"])
            if row["status"] == "solved":
                margins = [run["min_margin"] for run in said["runs"]]
                least = min(margins, key=lambda one: one["margin"])
                self.assertEqual(float(row["clearance"]), least["clearance"])
                self.assertEqual(float(row["clearance_margin"]), least["margin"])
                self.assertEqual(
                    float(row["tool_speed"]),
                    min(run["summary"]["top_tool_speed"]["speed"] for run in said["runs"])
                )
        self.assertEqual(met, {"solved", "infeasible"})
        # The commands that are printed plan the best cells.
        commands = [line.strip() for line in done.stdout.splitlines() if "swivel plan " in line]
        said = self.planned(*shlex.split(commands[0])[2:])
        self.assertEqual(said["cost"], min(float(row["cost"]) for row in rows if row["cost"]))

    def test_shards_page_and_the_best(self):
        rows = rows_of(self.place("whole.csv")[1])
        shards = [self.place(f"{k}.csv", "--shard", f"{k}/2")[1] for k in range(2)]
        merged = self.folder / "merged.csv"
        self.assertEqual(run("merge", merged, *shards).returncode, 0)
        self.assertEqual(rows_of(merged), rows)
        page = self.folder / "page.html"
        done = run("merge", merged, *shards, "--report", page)
        if "built without reports" not in done.stderr:
            self.assertEqual(done.returncode, 0, done.stderr)
            self.place("paged.csv", "--report", page)
            self.assertIn("door_job.yaml", page.read_text())

        job = self.folder / "job.yaml"
        job.write_text(JOB.read_text().replace("../", str(JOB.parent.parent) + "/"))
        best = self.folder / "best.yaml"
        done = run("place", job, *COARSE, *self.GRID, "--write", best)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(
            self.planned(best, *COARSE)["cost"],
            min(float(row["cost"]) for row in rows if row["cost"])
        )
        self.expect_refused(
            "place", job, "--path", "--x", "0:0.1:0.1", "--write", best,
            message="--write: .*job.yaml: stroke 'row_0': the path has moved"
        )

    def test_check_and_time_take_placements(self):
        rows, motion = self.folder / "rows.csv", self.folder / "motion.csv"
        moved = ("--object", "post", "--x", 0.05)
        done = run("plan", JOB, *COARSE, *moved, "--out", rows)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertEqual(run("check", JOB, rows, *COARSE, *moved).returncode, 0)
        done = run("time", JOB, rows, *COARSE, *moved, "--out", motion)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)

    def test_refused(self):
        out = self.folder / "p.csv"
        self.expect_refused(
            "place", JOB, "--object", "poste", "--x", "0:1:1", "--out", out,
            message="^swivel: --object: unknown object 'poste', nearest is 'post'"
        )
        self.expect_refused(
            "plan", JOB, "--base", "--x", "0:1:1", message="--x: '0:1:1': allowed is one number"
        )
        self.assertFalse(out.exists())


if __name__ == "__main__":
    unittest.main()

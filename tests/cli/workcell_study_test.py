#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Placements and campaigns of workcells from outside: each row is what `plan` says of a file that
was changed by hand, and what workcells do not take is refused."""
import copy
import csv
import json
import math
import shlex
import unittest

from workcell_test import WithWorkcells, arm, cell, run


def rows_of(file):
    with open(file, newline="") as table:
        return list(csv.DictReader(table))


def without_time(rows):
    return [{key: value for key, value in row.items() if key != "plan_ms"} for row in rows]


def with_fixture(**changes):
    """Two arms before a torso: the left path is on a fixture, and a post stands beside them."""
    scene = [
        {"name": "fixture", "box": [0.04, 0.04, 0.04], "xyz": [1.1, 0.2, 0.8]},
        {"name": "post", "cylinder": {"radius": 0.03, "length": 0.5}, "xyz": [0.5, -0.7, 1.0]},
    ]
    problem = cell(scene=scene, **changes)
    path = problem["arms"][0]["path"]
    path["frame"] = "fixture"
    for waypoint in path["waypoints"]:
        waypoint["xyz"] = [a - b for a, b in zip(waypoint["xyz"], scene[0]["xyz"])]
    return problem


def follower():
    """The right tool beside the left one, which leads it."""
    on_tool = [{"xyz": [0, -0.45, 0]}, {"xyz": [0.02, -0.45, 0]}]
    return cell(arms=[arm("left", 0.25), arm("right", 0, path={"frame": "left",
                                                             "waypoints": on_tool})])


class Studies(WithWorkcells):
    def planned(self, file, *options):
        """The result of `plan`."""
        result = self.folder / "one.json"
        done = run("plan", file, *options, "--quiet", "--json", result)
        self.assertIn(done.returncode, (0, 1), done.stderr)
        return json.loads(result.read_text())

    def place(self, file, *options, code=0):
        out = self.folder / "cells.csv"
        done = run("place", file, *options, "--out", out)
        self.assertEqual(done.returncode, code, done.stdout + done.stderr)
        return done, rows_of(out)

    def expect_answer(self, row, said, places=None):
        """The row has the status, the cost and the cause of a result."""
        self.assertEqual(row["status"], said["status"])
        if said["status"] == "solved":
            if places:
                return self.assertAlmostEqual(float(row["cost"]), said["cost"], places)
            self.assertEqual(float(row["cost"]), said["cost"])
            margins = [one["min_margin"]["margin"] for one in said["arms"]]
            margins.append(1e-3 * said["between_arms"]["margin_mm"])
            self.assertAlmostEqual(float(row["clearance_margin"]), min(margins), 12)
            summaries = [one["summary"] for one in said["arms"]]
            self.assertEqual(
                float(row["tool_speed"]), min(one["top_tool_speed"]["speed"] for one in summaries)
            )
            return None
        if said["conflict"]:
            self.assertEqual(row["cause"], "conflict")
            self.assertEqual(row["failed_s"], "")
            self.assertEqual(row["by"], " - ".join(said["conflict"]["bodies"]))
            return None
        first = next(one for one in said["arms"] if one["least_cost"] is None)
        self.assertEqual(row["cause"], first["diagnosis"]["cause"]["cause"])
        self.assertEqual(row["reason"], f"arm '{first['name']}': {first['diagnosis']['reason']}")
        return None

    def expect_refused(self, *arguments, message):
        done = run(*arguments)
        self.assertEqual((done.returncode, done.stdout), (2, ""), done.stdout + done.stderr)
        self.assertRegex(done.stderr, message)
        self.assertEqual(done.stderr.count("\n"), 1)


class WorkcellPlacements(Studies):
    def expect_cells(self, problem, options, changed):
        """Each cell is what `plan` says of it, and of the file that changed(x, y) returns."""
        file = self.file(problem)
        done, rows = self.place(file, *options, "--x", "-0.1:0.4:0.25", "--y", "-0.3:0.3:0.3")
        self.assertRegex(done.stdout, "^9 of 9 placements planned, ")
        self.assertEqual([int(row["cell"]) for row in rows], list(range(9)))
        met = set()
        for row in rows:
            moved = (*options, f"--x={row['x']}", f"--y={row['y']}")
            self.expect_answer(row, self.planned(file, *moved))
            other = self.folder / "changed.yaml"
            other.write_text(json.dumps(changed(float(row["x"]), float(row["y"]))))
            self.expect_answer(row, self.planned(other), places=6)
            met.add(row["status"])
        self.assertEqual(met, {"solved", "infeasible"})
        # The commands that are printed plan the best cells.
        commands = [line.strip() for line in done.stdout.splitlines() if "swivel plan " in line]
        said = self.planned(*shlex.split(commands[0])[2:])
        self.assertEqual(said["cost"], min(float(row["cost"]) for row in rows if row["cost"]))

    def test_both_paths(self):
        problem = cell()

        def changed(x, y):
            other = copy.deepcopy(problem)
            for one in other["arms"]:
                for waypoint in one["path"]["waypoints"]:
                    waypoint["xyz"][0] += x
                    waypoint["xyz"][1] += y
            return other

        self.expect_cells(problem, ["--path"], changed)

    def test_the_path_of_a_leader(self):
        problem = follower()

        def changed(x, y):
            other = copy.deepcopy(problem)
            for waypoint in other["arms"][0]["path"]["waypoints"]:
                waypoint["xyz"][0] += x
                waypoint["xyz"][1] += y
            return other

        self.expect_cells(problem, ["--path"], changed)

    def test_the_path_of_one_arm(self):
        for problem, arm in ((cell(), 0), (follower(), 0), (follower(), 1)):
            name = problem["arms"][arm]["name"]
            file = self.file(problem)
            options = ("--path", "--arm", name)
            done, rows = self.place(file, *options, "--x", "-0.05:0.2:0.25", "--y", "-0.1:0.1:0.1")
            for row in rows:
                moved = (f"--x={row['x']}", f"--y={row['y']}")
                self.expect_answer(row, self.planned(file, *options, *moved))
                other = copy.deepcopy(problem)
                for waypoint in other["arms"][arm]["path"]["waypoints"]:
                    waypoint["xyz"][0] += float(row["x"])
                    waypoint["xyz"][1] += float(row["y"])
                changed = self.folder / "changed.yaml"
                changed.write_text(json.dumps(other))
                self.expect_answer(row, self.planned(changed), places=6)
            self.assertIn("solved", {row["status"] for row in rows})
            self.assertIn(f"--path --arm {name}", done.stdout)
        self.expect_refused(
            "place", file, "--path", "--arm", "middle", "--x", "0.1",
            message="--arm: unknown arm 'middle': allowed are 'left' and 'right'"
        )
        self.expect_refused(
            "place", file, "--base", "--arm", "left", "--x", "0.1", message="--arm: .*--path"
        )

    def test_an_object_and_the_path_on_it(self):
        problem = with_fixture()

        def changed(x, y):
            other = copy.deepcopy(problem)
            at = other["scene"][0]["xyz"]
            at[0] += x
            at[1] += y
            return other

        self.expect_cells(problem, ["--object", "fixture"], changed)

    def test_the_base(self):
        problem = with_fixture()

        def changed(x, y):
            other = copy.deepcopy(problem)
            moving = other["scene"] + other["arms"][1]["path"]["waypoints"]
            for one in moving:
                one["xyz"] = [one["xyz"][0] - x, one["xyz"][1] - y, one["xyz"][2]]
            return other

        self.expect_cells(problem, ["--base"], changed)

    def test_turned_paths(self):
        problem = cell()
        file = self.file(problem)
        _, rows = self.place(file, "--path", "--yaw", "-0.3:0.3:0.3")
        self.assertEqual(len(rows), 3)
        for row in rows:
            yaw = float(row["yaw"])
            other = copy.deepcopy(problem)
            for one in other["arms"]:
                for waypoint in one["path"]["waypoints"]:
                    x, y, z = waypoint["xyz"]
                    waypoint["xyz"] = [
                        math.cos(yaw) * x - math.sin(yaw) * y,
                        math.sin(yaw) * x + math.cos(yaw) * y, z
                    ]
                    waypoint["rpy"] = [0, math.pi / 2, yaw]
            changed = self.folder / "changed.yaml"
            changed.write_text(json.dumps(other))
            # rpy of the file is a pitch of 1.5707963
            self.expect_answer(row, self.planned(changed), places=5)
            self.expect_answer(row, self.planned(file, "--path", f"--yaw={yaw}"))

    def test_arms_that_meet(self):
        _, rows = self.place(self.file(cell(gap=0.02)), "--path", "--x", "0:0.05:0.05", code=1)
        for row in rows:
            self.assertEqual((row["status"], row["cause"]), ("infeasible", "conflict"))
            self.assertRegex(
                row["reason"],
                "^each arm has a path by itself, and no two of them keep clear: the cheapest meet "
                r"at s = [0-9.]+ m of 'left' and [0-9.]+ m of 'right'(, on the way on)?: .* and "
            )

    def test_a_given_motion_that_is_barred(self):
        both = self.folder / "rows.csv"
        self.assertEqual(run("plan", self.file(with_fixture()), "--out", both).returncode, 0)
        problem = with_fixture()
        del problem["arms"][0]["path"]
        problem["arms"][0]["trajectory"] = "rows.csv"
        problem["scene"][1].update(xyz=[0.6, 0.7, 1.05])
        file = self.file(problem)
        _, rows = self.place(file, "--object", "post", "--y", "-0.45:0:0.45")
        self.assertEqual([row["status"] for row in rows], ["infeasible", "solved"])
        self.assertEqual(rows[0]["cause"], "given_motion")
        self.assertEqual(rows[0]["by"], "given motion of 'left'")
        self.assertRegex(rows[0]["reason"], "^given motion of 'left': row 0: .*post")
        self.expect_refused(
            "plan", file, "--object", "post", "--y", "-0.45",
            message="given motion: row 0: .*post"
        )
        self.expect_answer(rows[1], self.planned(file, "--object", "post"))

    def test_the_best_and_its_page(self):
        file, best = self.file(with_fixture()), self.folder / "best.yaml"
        grid = ("--object", "fixture", "--x", "-0.05:0.05:0.05", "--y", "0:0.1:0.05")
        _, rows = self.place(file, *grid, "--write", best)
        self.assertEqual(
            self.planned(best)["cost"], min(float(row["cost"]) for row in rows if row["cost"])
        )
        shards = []
        for k in range(2):
            shards.append(self.folder / f"{k}.csv")
            done = run("place", file, *grid, "--shard", f"{k}/2", "--out", shards[-1])
            self.assertEqual(done.returncode, 0, done.stderr)
        merged, page = self.folder / "merged.csv", self.folder / "page.html"
        self.assertEqual(run("merge", merged, *shards).returncode, 0)
        self.assertEqual(rows_of(merged), rows)
        done = run("place", file, *grid, "--report", page)
        if "built without reports" not in done.stderr:
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertIn("cell.yaml", page.read_text())

    def test_check_and_time_take_placements(self):
        rows, motion = self.folder / "rows.csv", self.folder / "motion.csv"
        file, moved = self.file(with_fixture()), ("--object", "fixture", "--x", 0.05)
        done = run("plan", file, *moved, "--out", rows)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertEqual(run("check", file, rows, *moved).returncode, 0)
        self.assertEqual(run("check", file, rows).returncode, 1)
        done = run("time", file, rows, *moved, "--speed", 0.05, "--out", motion)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertEqual(run("check", file, motion, *moved).returncode, 0)

    def test_refused(self):
        file, out = self.file(with_fixture()), self.folder / "p.csv"
        for command in ("plan", "place"):
            self.expect_refused(
                command, file, "--path", "--yaw", "0.1", "--out", out,
                message="^swivel: --path: roll, pitch and yaw turn paths about the origin of their "
                "frame, and those of 'left' and 'right' are in 'fixture' and 'base_link': allowed "
            )
        self.expect_refused(
            "place", file, "--object", "fixtures", "--x", "0:1:1", "--out", out,
            message="unknown object 'fixtures', nearest is 'fixture'"
        )
        self.expect_refused(
            "place", file, "--object", "left", "--x", "0:1:1", message="unknown object 'left'"
        )
        self.expect_refused(
            "place", file, "--path", "--x", "0:1:1", "--write", self.folder / "b.yaml",
            message="--write: .*: the path has moved"
        )
        rows = self.folder / "rows.csv"
        self.assertEqual(run("plan", self.file(follower()), "--out", rows).returncode, 0)
        given = follower()
        del given["arms"][0]["path"]
        given["arms"][0]["trajectory"] = "rows.csv"
        self.expect_refused(
            "place", self.file(given), "--path", "--x", "0:0.1:0.1",
            message="^swivel: --path: that of 'right' is on the tool of 'left', whose motion is "
            "given: allowed is"
        )
        self.assertFalse(out.exists())


class WorkcellCampaigns(Studies):
    def campaign(self, name, *options, code=0):
        problem = with_fixture()
        problem["vary"] = [
            {"object": "fixture", "xyz": [0.3, 0.2, 0.05]}, {"object": "post", "xyz": [0, 0.2, 0]}
        ]
        out = self.folder / name
        done = run(
            "campaign", self.file(problem), "--episodes", 8, "--seed", 3, "--out", out, *options
        )
        self.assertEqual(done.returncode, code, done.stdout + done.stderr)
        return done, out

    def test_rows_are_what_plan_says(self):
        paths, summary = self.folder / "paths", self.folder / "s.json"
        done, out = self.campaign(
            "one.csv", "--threads", 1, "--trajectories", paths, "--json", summary
        )
        self.assertRegex(done.stdout, "^8 of 8 episodes answered: ")
        rows = rows_of(out)
        self.assertEqual(
            without_time(rows), without_time(rows_of(self.campaign("many.csv", "--threads", 3)[1]))
        )
        file = self.folder / "cell.yaml"
        met = {}
        for row in rows:
            episode = ("--seed", 3, "--episode", row["episode"])
            said = self.planned(file, *episode)
            self.assertEqual(row["status"], said["status"])
            met[row["status"]] = met.get(row["status"], 0) + 1
            if row["status"] != "solved":
                self.expect_answer(row, said)
                self.assertFalse((paths / f"episode_{row['episode']}.csv").exists())
                continue
            self.assertEqual(float(row["cost"]), said["cost"])
            errors = [one["tool_path_error_mm"] for one in said["arms"]]
            self.assertEqual(
                float(row["tool_path_error_mm_max"]), max(one["max"] for one in errors)
            )
            path = paths / f"episode_{row['episode']}.csv"
            planned = self.folder / "planned.csv"
            self.assertEqual(run("plan", file, *episode, "--out", planned).returncode, 0)
            self.assertEqual(path.read_text(), planned.read_text())
            self.assertEqual(run("check", file, path, *episode).returncode, 0)
        self.assertEqual(set(met), {"solved", "infeasible"})
        self.assertEqual(json.loads(summary.read_text())["solved"], met["solved"])

    def test_goes_on_and_is_split(self):
        whole = rows_of(self.campaign("whole.csv")[1])
        shards = [self.campaign(f"{k}.csv", "--shard", f"{k}/2")[1] for k in range(2)]
        merged = self.folder / "merged.csv"
        self.assertEqual(run("merge", merged, *shards).returncode, 0)
        self.assertEqual(without_time(rows_of(merged)), without_time(whole))
        done, _ = self.campaign("again.csv", "--rows", merged)
        self.assertIn("8 of 8 episodes answered", done.stdout)

    def test_refused(self):
        out = self.folder / "c.csv"
        self.expect_refused(
            "campaign", self.file(with_fixture()), "--episodes", 2, "--out", out,
            message="cell.yaml: vary: missing"
        )
        self.assertFalse(out.exists())


if __name__ == "__main__":
    unittest.main()

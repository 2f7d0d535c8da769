#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Joints that are held from outside: swivel place over their positions against swivel plan of files
that say so, and what answers say of a joint that slides."""
import csv
import json
import re
import shlex
import unittest

from cli_test import DATA, PROBLEMS, WithFolder, run
from pages import data_of

PROBLEM = PROBLEMS / "experiment_c.yaml"
QUICK = ("--planner", "lazy", "--ds", "0.02", "--dphi", "0.2", "--edges", "nodes")
TORSO = "torso_joint_b1"


def rows_of(file):
    with open(file, newline="") as table:
        return list(csv.DictReader(line for line in table if not line.startswith("#")))


class HeldJoints(WithFolder):
    def place(self, *options, problem=PROBLEM, code=0, quick=QUICK):
        out = self.folder / "cells.csv"
        done = run("place", problem, *quick, "--out", out, *options)
        self.assertEqual(done.returncode, code, done.stdout + done.stderr)
        return done, rows_of(out) if code < 2 else []

    def planned(self, problem, *options, quick=QUICK):
        done, out, result = self.plan(problem, *quick, "--quiet", *options)
        self.assertIn(done.returncode, (0, 1), done.stderr)
        return out, result

    def file_with(self, position, text=None):
        """The problem file with the torso held there."""
        text = text or PROBLEM.read_text()
        held = self.folder / "held.yaml"
        held.write_text(
            text.replace("../", f"{DATA}/").replace(f"{TORSO}: 0.0", f"{TORSO}: {position}")
        )
        return held

    def test_rows_are_plans_of_files_that_hold_the_joint(self):
        grid = ("--hold", f"{TORSO}=-0.6:0.6:0.3", "--object", "door", "--x", "0:0.15:0.15")
        done, rows = self.place(*grid, "--threads", "1")
        table = (self.folder / "cells.csv").read_bytes()
        self.assertEqual(self.place(*grid, "--threads", "3")[1], rows)
        self.assertEqual((self.folder / "cells.csv").read_bytes(), table)
        # The joint is the outer loop.
        self.assertEqual(
            [(row[f"hold.{TORSO}"], row["x"]) for row in rows[:3]],
            [("-0.6", "0"), ("-0.6", "0.15"), ("-0.3", "0")],
        )
        self.assertEqual(len(rows), 10)
        met = set()
        for row in rows:
            met.add(row["status"])
            x = ("--object", "door", "--x", row["x"])
            out, said = self.planned(self.file_with(row[f"hold.{TORSO}"]), *x)
            _, again = self.planned(PROBLEM, *x, "--hold", f"{TORSO}={row[f'hold.{TORSO}']}")
            self.assertEqual(said["status"], row["status"])
            for key in ("status", "cost", "trajectory", "min_margin", "held"):
                self.assertEqual(again[key], said[key], key)
            if row["status"] == "infeasible":
                self.assertEqual(row["reason"], said["diagnosis"]["reason"])
                continue
            self.assertEqual(
                (float(row["cost"]), float(row["clearance"])),
                (said["cost"], said["min_margin"]["clearance"]),
            )
            place = (*x, "--hold", f"{TORSO}={row[f'hold.{TORSO}']}")
            check = run("check", PROBLEM, out, *QUICK[2:], *place)
            self.assertEqual(check.returncode, 0, check.stdout)
        self.assertEqual(met, {"solved", "infeasible"})
        commands = [line.strip() for line in done.stdout.splitlines() if "swivel plan" in line]
        best = min(
            (row for row in rows if row["cost"]),
            key=lambda row: (round(float(row["cost"]), 9), int(row["cell"])),
        )
        self.assertIn(f" --hold {TORSO}={best[f'hold.{TORSO}']}", commands[0])
        _, said = self.planned(shlex.split(commands[0])[2], *shlex.split(commands[0])[3:], quick=())
        self.assertEqual(said["cost"], float(best["cost"]))
        self.assertNotIn("held:", done.stdout)  # in no row it stands as the file says
        self.assertIn(f"{TORSO} -0.6 to 0.6 rad", done.stdout)

    def test_a_joint_alone_on_map_and_page_and_in_a_file(self):
        page, drawing, winner = (self.folder / name for name in ("p.html", "m.svg", "w.yaml"))
        problem = self.folder / "problem.yaml"
        problem.write_text(PROBLEM.read_text().replace("../", f"{DATA}/"))
        without = run("campaign", problem, "--episodes", "1", *QUICK, "--report", page)
        report = () if without.returncode == 2 else ("--report", page)
        done, rows = self.place(
            "--hold", f"{TORSO}=-0.1:0.1:0.1", *report, "--write", winner, problem=problem
        )
        self.assertEqual([row[f"hold.{TORSO}"] for row in rows], ["-0.1", "0", "0.1"])
        best = min((row for row in rows if row["cost"]), key=lambda row: float(row["cost"]))
        text = problem.read_text()
        self.assertEqual(
            winner.read_text(),
            text.replace(f"{TORSO}: 0.0", f"{TORSO}: {best[f'hold.{TORSO}']}")
            if best[f"hold.{TORSO}"] != "0" else text,
        )
        _, said = self.planned(winner)
        self.assertEqual(said["cost"], float(best["cost"]))
        if report:
            data = data_of(page)
            self.assertEqual(
                data["axes"], [{"name": TORSO, "values": [-0.1, 0, 0.1], "unit": "rad"}]
            )
            self.assertEqual(data["thing"], TORSO)
            chains = [
                json.dumps(plan["robot"]["chain"]["joints"][0]["point"]) +
                json.dumps(plan["robot"]["chain"]["joints"][0]["axis"])
                for plan in data["scene"]["plans"]
            ]
            self.assertEqual(len(set(chains)), len(chains))
        self.place(
            "--hold", f"{TORSO}=-0.1:0.1:0.1", "--base", "--z", "0:0.02:0.02", "--svg", drawing
        )
        self.assertIn(f"{TORSO} (rad)", drawing.read_text())

    def test_samples_and_shards(self):
        sample = (
            "--hold", f"{TORSO}=-0.2:0.2", "--path", "--y", "-0.02:0.02", "--sample", "7",
            "--seed", "3",
        )
        _, rows = self.place(*sample)
        whole = (self.folder / "cells.csv").read_bytes()
        self.assertEqual(len({row[f"hold.{TORSO}"] for row in rows}), 7)
        shards = [self.folder / f"s{k}.csv" for k in range(2)]
        for k, shard in enumerate(shards):
            run("place", PROBLEM, *QUICK, *sample, "--shard", f"{k}/2", "--out", shard)
        joined = self.folder / "joined.csv"
        done = run("merge", joined, *shards)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(joined.read_bytes(), whole)
        self.assertIn(f" --hold {TORSO}=", done.stdout)
        other = self.folder / "other.csv"
        run("place", PROBLEM, *QUICK, *sample[2:], "--shard", "1/2", "--out", other)
        done = run("merge", joined, shards[0], other)
        self.assertEqual(done.returncode, 2)
        self.assertIn(f"hold {TORSO}", done.stderr)

    def test_refuses_by_line(self):
        for words, options in (
            (("--hold", "'arm_left_joint_1_s' is planned"), ("arm_left_joint_1_s=0",)),
            (("--hold", "unknown joint 'torso'", f"nearest is '{TORSO}'"), ("torso=0:1:0.5",)),
            (("--hold", "outside its limits", "rad"), (f"{TORSO}=0:9:0.5",)),
            (("--hold", "JOINT=FROM:TO:STEP"), (TORSO,)),
            (("--hold", "FROM:TO:STEP"), (f"{TORSO}=1:0:0.1",)),
            (("--hold", "again"), (f"{TORSO}=0", "--hold", f"{TORSO}=0.1")),
            (("without a step",), (f"{TORSO}=0:1",)),
            (("--object, --path, --base",), (f"{TORSO}=0", "--x", "0.1")),
            (("--arm", "--path"), (f"{TORSO}=0", "--arm", "left")),
            (("--arm", "workcell"), (f"{TORSO}=0", "--path", "--arm", "left")),
        ):
            done, _ = self.place("--hold", *options, code=2)
            self.assertEqual(len(done.stderr.splitlines()), 1, done.stderr)
            for word in (*words, "allowed"):
                self.assertIn(word, done.stderr)
        done = run("plan", PROBLEM, *QUICK, "--hold", f"{TORSO}=0:1:0.1")
        self.assertEqual(done.returncode, 2)
        self.assertIn("one number", done.stderr)

    def test_answers_name_the_slide_in_mm(self):
        rail = self.folder / "rail.yaml"
        text = (PROBLEMS / "ur10e_rail_seam.yaml").read_text().replace("../", f"{DATA}/")
        rail.write_text(text)
        done, out, said = self.plan(rail, "--ds", "0.1")
        self.assertEqual(done.returncode, 0, done.stderr)
        slide, turn = said["summary"]["slide_limit"], said["summary"]["joint_limit"]
        column = [row["rail"] for row in rows_of(out)]
        room = [min(float(q) + 1.8, 1.8 - float(q)) for q in column]
        self.assertEqual(slide["joint"], "rail")
        self.assertAlmostEqual(slide["margin_mm"], 1e3 * min(room), 6)
        self.assertIn(
            f" | rail {slide['margin_mm']:.1f} mm from its limit at s {slide['s']:.3f}", done.stdout
        )
        self.assertIn(f" | {turn['joint']} {turn['margin_deg']:.1f} deg from its", done.stdout)
        check = run("check", rail, out, "--ds", "0.1")
        self.assertRegex(
            check.stdout, rf"'rail' {slide['margin_mm']:.2f} mm from its limit at row \d+"
        )
        done, rows = self.place(
            "--base", "--x", "-0.1:0.1:0.1", "--best", "slide,cost", problem=rail,
            quick=("--ds", "0.1")
        )
        margins = {row["x"]: float(row["slide_margin"]) for row in rows if row["slide_margin"]}
        self.assertGreaterEqual(len(margins), 2)
        self.assertEqual(1e3 * margins["0"], slide["margin_mm"])
        best = max(margins.values())
        first = re.search(r"best by slide:\n  (.*):\n    (.*)\n", done.stdout)
        self.assertIn(f", {1e3 * best:.1f} mm from a slide's limit", first[1])

    def test_a_slide_that_is_held_is_varied_in_metres(self):
        urdf, lift = self.folder / "lift.urdf", self.folder / "lift.yaml"
        robot = (DATA / "robots/iiwa14.urdf").read_text()
        root = re.search(r'<link name="(\w+)"', robot)[1]
        lifted = (
            '<link name="floor"/><joint name="lift" type="prismatic"><parent link="floor"/>'
            f'<child link="{root}"/><axis xyz="0 0 1"/>'
            '<limit lower="-0.1" upper="0.3" velocity="0.2" effort="1"/></joint></robot>'
        )
        urdf.write_text(robot.replace("</robot>", lifted))
        text = (PROBLEMS / "iiwa14_bench.yaml").read_text().replace("../", f"{DATA}/")
        text = re.sub(r"urdf: \S+iiwa14.urdf", f"urdf: {urdf}", text)
        lift.write_text(text.replace(f"base_link: {root}", "base_link: floor"))
        quick = ("--ds", "0.05", "--dphi", "0.2")
        done, rows = self.place(
            "--hold", "lift=-0.05:0.05:0.05", "--base", "--x", "0:0.05:0.05", problem=lift,
            quick=quick
        )
        self.assertIn("lift -0.05 to 0.05 m", done.stdout)
        # The base is lifted as --base --z lifts it, but for what rounding does.
        self.assertGreaterEqual(sum(row["status"] == "solved" for row in rows), 3)
        for row in rows:
            _, said = self.planned(
                PROBLEMS / "iiwa14_bench.yaml", "--base", "--x", row["x"], "--z", row["hold.lift"],
                quick=quick
            )
            self.assertEqual(said["status"], row["status"])
            if row["cost"]:
                self.assertAlmostEqual(said["cost"], float(row["cost"]), 6)


if __name__ == "__main__":
    unittest.main()

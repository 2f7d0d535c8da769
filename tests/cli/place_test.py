#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""swivel place from outside: its table against swivel plan, its commands, what it writes, and what
it refuses."""
import csv
import json
import math
import random
import re
import shlex
import shutil
import signal
import subprocess
import time
import unittest
import xml.etree.ElementTree as tree

from cli_test import DATA, PROBLEMS, SHARED, SWIVEL, WithFolder, run
from trials import seed

PROBLEM = PROBLEMS / "experiment_c.yaml"
QUICK = ("--planner", "lazy", "--ds", "0.02", "--dphi", "0.2", "--edges", "nodes")
DOOR = ("--object", "door")


class Place(WithFolder):
    def place(self, *options, code=0, problem=PROBLEM, quick=QUICK):
        out = self.folder / "cells.csv"
        done = run("place", problem, *quick, "--out", out, *options)
        self.assertEqual(done.returncode, code, done.stdout + done.stderr)
        return done, out

    def rows(self, *options, **more):
        with self.place(*options, **more)[1].open(newline="") as file:
            return list(csv.DictReader(file))

    def commands(self, text):
        return [
            line.strip() for line in text.splitlines() if line.strip().startswith("swivel plan ")
        ]

    def planned(self, command):
        """What the command says, run as a shell would."""
        result = self.folder / "one.json"
        done = run(*shlex.split(command)[1:], "--quiet", "--json", result)
        self.assertIn(done.returncode, (0, 1), done.stderr)
        return json.loads(result.read_text())

    def test_cells_are_what_plan_says(self):
        draw = random.Random(seed(20260701))
        met = {"solved": 0, "infeasible": 0}
        for thing in (DOOR, ("--object", "post"), ("--path",), ("--base",)):
            rows = self.rows(
                *thing, "--sample", "12", "--seed", "3", "--x", "-0.2:0.2", "--y", "-0.2:0.2",
                "--yaw", "-0.6:0.6"
            )
            self.assertEqual([int(row["cell"]) for row in rows], list(range(12)))
            for row in draw.sample(rows, 5):
                self.assertEqual((row["z"], row["roll"], row["pitch"]), ("0", "0", "0"))
                words = [f"--{key}={row[key]}" for key in ("x", "y", "yaw")]
                result = self.folder / "r.json"
                out = self.folder / "t.csv"
                done = run("plan", PROBLEM, *QUICK, *thing, *words, "--json", result, "--out", out)
                self.assertIn(done.returncode, (0, 1), done.stderr)
                said = json.loads(result.read_text())
                self.assertEqual(said["status"], row["status"])
                met[row["status"]] += 1
                if row["status"] == "infeasible":
                    self.assertEqual(
                        (float(row["failed_s"]) if row["failed_s"] else None, row["reason"]),
                        (said["diagnosis"]["reached_s"], said["diagnosis"]["reason"]),
                    )
                    self.assertEqual(row["cause"], said["diagnosis"]["cause"]["cause"])
                    continue
                limit = said["summary"]["joint_limit"]
                self.assertEqual(
                    [
                        float(row[key])
                        for key in ("cost", "clearance", "clearance_margin", "tool_speed")
                    ],
                    [
                        said["cost"], said["min_margin"]["clearance"], said["min_margin"]["margin"],
                        said["summary"]["top_tool_speed"]["speed"]
                    ],
                )
                self.assertAlmostEqual(
                    math.degrees(float(row["joint_margin"])), limit["margin_deg"], 9
                )
                check = run("check", PROBLEM, out, *QUICK[2:], *thing, *words)
                self.assertEqual(check.returncode, 0, check.stdout)
        self.assertGreaterEqual(min(met.values()), 3, met)

    def test_the_table_does_not_depend_on_threads(self):
        grid = (*DOOR, "--x", "-0.1:0.1:0.02", "--y", "0:0.1:0.025", "--roll", "0.1")
        one = self.place(*grid, "--threads", "1")[1].read_bytes()
        self.assertEqual(one.count(b"\n"), 1 + 11 * 5)
        self.assertEqual(self.place(*grid, "--threads", "2")[1].read_bytes(), one)
        fine = (*DOOR, "--x", "-0.1:0.1:0.01", "--y", "0:0.1:0.01", "--refine-grid")
        some = self.place(*fine, "--threads", "1")[1].read_bytes()
        self.assertLessEqual(some.count(b"\n") - 1, 21 * 11 // 3)
        self.assertEqual(self.place(*fine, "--threads", "2")[1].read_bytes(), some)
        whole = set(self.place(*fine[:-1])[1].read_bytes().splitlines())
        self.assertTrue(set(some.splitlines()) <= whole)

    def test_the_best_are_the_best(self):
        grid = (*DOOR, "--x", "-0.1:0.1:0.05", "--y", "-0.1:0.1:0.05")
        keys = {
            "cost": ("cost", 1), "clearance": ("clearance_margin", -1),
            "margin": ("joint_margin", -1), "speed": ("tool_speed", -1)
        }
        for criterion, (key, sign) in keys.items():
            done, out = self.place(*grid, "--best", criterion, "--top", "3")
            with out.open(newline="") as file:
                solved = [row for row in csv.DictReader(file) if row["status"] == "solved"]
            solved.sort(key=lambda row: (round(sign * float(row[key]), 9), int(row["cell"])))
            said = self.commands(done.stdout)
            self.assertEqual(len(said), 3)
            for command, row in zip(said, solved):
                offsets = dict(re.findall(r"--(x|y) (\S+)", command))
                self.assertEqual(
                    [float(offsets.get(name, 0)) for name in ("x", "y")],
                    [float(row["x"]), float(row["y"])],
                    criterion,
                )
            self.assertEqual(self.planned(said[0])["cost"], float(solved[0]["cost"]))
        # The door's own distance from the polisher is the least of many: ties, which the next
        # criterion settles.
        done = run("place", *grid, *QUICK, "--top", "2", "--best", "clearance,cost", PROBLEM)
        self.assertEqual(done.returncode, 0, done.stderr)
        costs = [float(cost) for cost in re.findall(r"cost ([0-9.]+), clearance", done.stdout)]
        self.assertLess(costs[0], costs[1])

    def test_the_winner_as_a_problem_file(self):
        for folder in ("robots", "meshes", "paths", "problems"):
            shutil.copytree(DATA / folder, self.folder / folder)
        problem, winner = (
            self.folder / "problems/experiment_c.yaml",
            self.folder / "problems/placed.yaml",
        )
        text = problem.read_text()
        for more in ((), ("--yaw", "0.1:0.2:0.1", "--pitch", "-0.05")):
            done, out = self.place(
                *DOOR, "--x", "0.02:0.1:0.04", "--z", "0:0.02:0.02", *more, "--write", winner,
                problem=problem
            )
            best = self.planned(self.commands(done.stdout)[0])
            plain = run(
                "plan", winner, *QUICK, "--quiet", "--json", self.folder / "w.json",
                "--out", self.folder / "w.csv"
            )
            self.assertEqual(plain.returncode, 0, plain.stderr)
            written = json.loads((self.folder / "w.json").read_text())
            self.assertEqual(
                (written["cost"], written["trajectory"]), (best["cost"], best["trajectory"])
            )
            unlike = [
                (a, b) for a, b in zip(text.splitlines(), winner.read_text().splitlines()) if a != b
            ]
            self.assertEqual(len(unlike), 1, unlike)
            self.assertIn("name: door", unlike[0][1])
        self.assertEqual(problem.read_text(), text)
        for words, options in (
            (("--write", "another folder"), ("--write", self.folder / "placed.yaml")),
            (("--write", "one of the files"), ("--write", problem)),
            (("--write", "path"), ("--path", "--write", winner)),
        ):
            winner.unlink(missing_ok=True)
            thing = () if "--path" in options else DOOR
            done, _ = self.place(*thing, "--x", "0:0.1:0.1", *options, problem=problem, code=2)
            self.assertEqual(len(done.stderr.splitlines()), 1, done.stderr)
            for word in (*words, "allowed"):
                self.assertIn(word, done.stderr)
            self.assertFalse(winner.exists())

    def test_the_robot_may_move_instead(self):
        rows = self.rows("--base", "--x", "-0.05:0.05:0.05", "--y", "0:0.1:0.1")
        text = PROBLEM.read_text().replace("../", str(DATA) + "/")
        for row in rows:
            moved = re.sub(
                r"(- \{name: \w+, .*?xyz: \[)([^]]*)\]",
                lambda m: m[1]
                + ", ".join(
                    repr(round(float(value) - float(row[key]), 12))
                    for value, key in zip(m[2].split(","), "xyz")
                )
                + "]",
                text,
            )
            problem = self.folder / "moved.yaml"
            problem.write_text(moved)
            run("plan", problem, *QUICK, "--json", self.folder / "m.json", "--quiet")
            said = json.loads((self.folder / "m.json").read_text())
            self.assertEqual(
                (said["status"], said["cost"]),
                (row["status"], float(row["cost"]) if row["cost"] else None),
            )

    def best_base(self, problem, *options, ds="0.02", least_solved):
        """The best place for the robot's base, by its command, by check and as a file."""
        winner, drawing = problem.with_name("placed.yaml"), self.folder / "map.svg"
        quick = [ds if word == "0.02" else word for word in QUICK]
        if problem.name != "iiwa14_bench.yaml":  # others may have no arm angle
            at = quick.index("--dphi")
            del quick[at : at + 2]
        done, out = self.place(
            "--base",
            *options,
            "--svg",
            drawing,
            *(() if problem.parent == PROBLEMS else ("--write", winner)),
            problem=problem,
            quick=quick,
        )
        with out.open(newline="") as file:
            solved = [row for row in csv.DictReader(file) if row["status"] == "solved"]
        self.assertGreaterEqual(len(solved), least_solved)
        self.assertTrue(tree.parse(drawing).getroot().tag.endswith("svg"))
        command = self.commands(done.stdout)[0]
        trajectory, words = self.folder / "best.csv", shlex.split(command)[1:]
        best = min(solved, key=lambda row: (round(float(row["cost"]), 9), int(row["cell"])))
        self.assertEqual(run(*words, "--quiet", "--out", trajectory).returncode, 0)
        self.assertEqual(self.planned(command)["cost"], float(best["cost"]))
        placement = ["--base", *(f"--{key}={best[key]}" for key in ("x", "y", "yaw"))]
        check = run("check", problem, trajectory, *quick[2:], *placement)
        self.assertEqual(check.returncode, 0, check.stdout)
        other = run("check", problem, trajectory, *quick[2:])  # where the base does not stand
        self.assertEqual(
            other.returncode,
            0 if all(float(best[key]) == 0 for key in ("x", "y", "yaw")) else 1,
            other.stdout,
        )
        if winner.exists():
            self.assertEqual(run("check", winner, trajectory, *quick[2:]).returncode, 0)

    def test_where_the_base_may_stand(self):
        for folder in ("robots", "meshes", "paths", "problems"):
            shutil.copytree(DATA / folder, self.folder / folder)
        self.best_base(
            self.folder / "problems/iiwa14_bench.yaml", "--x", "-0.3:0.2:0.1",
            "--y", "-0.2:0.2:0.1", "--yaw", "0:0.4:0.4", least_solved=8
        )
        self.best_base(
            PROBLEMS / "panda_weld_seam.yaml", "--x", "-0.1:0.1:0.1", "--y", "-0.1:0.1:0.1",
            ds="0.05", least_solved=2
        )

    def test_where_the_base_of_a_real_arm_may_stand(self):
        real = SHARED / "data/real"
        if not real.exists():
            self.skipTest("real robot files are not here")
        bench = (PROBLEMS / "iiwa14_bench.yaml").read_text()
        count = 0
        for urdf, srdf, base, tip, tool, moves in (
            (
                real / "iiwa7/iiwa7.urdf",
                real / "iiwa7/iiwa7.srdf",
                "link_0",
                "link_ee",
                "0.15",
                ("--x", "-0.1:0.2:0.1", "--y", "-0.1:0.2:0.1"),
            ),
            (
                real / "panda/moveit_resources_panda_description/urdf/panda.urdf",
                real / "panda/panda.srdf",
                "panda_link0",
                "panda_link8",
                "0.17",
                ("--x", "-0.1:0.2:0.15", "--y", "0:0.2:0.2"),
            ),
        ):
            text = bench.replace("../robots/iiwa14.urdf", str(urdf)).replace(
                "../robots/iiwa14.srdf", str(srdf)
            )
            text = (
                text.replace("base_link: base_link", f"base_link: {base}")
                .replace("tool0", tip)
                .replace("[0, 0, 0.15]", f"[0, 0, {tool}]")
            )
            problem = self.folder / "bench.yaml"
            problem.write_text(text)
            self.best_base(problem, *moves, ds="0.05", least_solved=2)
            count += 1
        self.assertEqual(count, 2)

    def test_the_map(self):
        drawing = self.folder / "map.svg"
        done, out = self.place(
            *DOOR, "--x", "-0.1:0.1:0.02", "--y", "-0.1:0.1:0.02", "--z", "0:0.02:0.02",
            "--svg", drawing
        )
        lines = [
            line
            for line in done.stdout.splitlines()
            if re.match(r" +-?[0-9.]+  [0-9a-z.]{11}$", line)
        ]
        self.assertEqual(len(lines), 11, done.stdout)
        with out.open(newline="") as file:
            solved = {
                (row["x"], row["y"]) for row in csv.DictReader(file) if row["status"] == "solved"
            }
        self.assertEqual(
            sum(symbol.isdigit() for line in lines for symbol in line.split()[1]), len(solved)
        )
        self.assertIn("no path: post", done.stdout)
        self.assertIn("best over the other", done.stdout)
        root = tree.parse(drawing).getroot()
        self.assertTrue(root.tag.endswith("svg"))
        self.assertIn("no path: post", drawing.read_text())

    def test_stopped_it_keeps_what_is_known(self):
        many = ("--x", "-0.1:0.1:0.0005", "--y", "-0.1:0.1:0.0005")
        done, out = self.place(*DOOR, *many, "--timeout", "1.5", code=3)
        known = out.read_text().splitlines()[1:]
        self.assertIn(f"{len(known)} of 160801 placements planned", done.stdout)
        self.assertGreater(len(known), 5)
        process = subprocess.Popen(
            [SWIVEL, "place", PROBLEM, *QUICK, *DOOR, *many, "--out", out],
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        )
        time.sleep(1.5)
        process.send_signal(signal.SIGINT)
        said, errors = process.communicate(timeout=60)
        self.assertEqual(process.returncode, 3, errors)
        rows = out.read_text().splitlines()[1:]
        self.assertIn(f"{len(rows)} of 160801", said)
        both = dict(line.split(",", 1) for line in known)
        self.assertTrue(
            all(
                both.get(cell, rest) == rest for cell, rest in (line.split(",", 1) for line in rows)
            )
        )

    def test_no_placement_has_a_path(self):
        done, out = self.place(*DOOR, "--x", "5:6:1", "--best", "cost", code=1)
        self.assertIn("0 with a path, 2 without: no IK 2", done.stdout)
        self.assertEqual(len(out.read_text().splitlines()), 3)

    def test_bad_input(self):
        grid = ("--x", "0:0.1:0.1")
        cases = [
            (("--object", "dor", *grid), ("--object", "dor", "nearest is 'door'")),
            (grid, ("--object", "--path", "--base")),
            ((*DOOR, "--base", *grid), ("--base", "exactly one")),
            (DOOR, ("--x", "--yaw", "--hold", "one or more")),
            ((*DOOR, "--x", "0:0.1"), ("--x", "without a step")),
            ((*DOOR, "--x", "0.1:0:0.1"), ("--x", "FROM <= TO")),
            ((*DOOR, "--x", "0:0.1:0"), ("--x", "STEP > 0")),
            ((*DOOR, "--x", "0:0.1:-1"), ("--x", "STEP > 0")),
            ((*DOOR, "--x", "0:0.1:0.1:1"), ("--x", "FROM:TO:STEP")),
            ((*DOOR, "--x", "nan"), ("--x", "nan")),
            ((*DOOR, "--x", "a:b:c"), ("--x", "a:b:c")),
            ((*DOOR, "--x", "0:1:1e-300"), ("--x", "too many")),
            ((*DOOR, "--x", "0:1:1e-4", "--y", "0:1:1e-4"), ("the grid", "1000000")),
            ((*DOOR, *grid, "--sample", "0"), ("--sample", "1 to 1000000")),
            ((*DOOR, *grid, "--sample", "3", "--refine-grid"), ("--refine-grid",)),
            ((*DOOR, *grid, "--best", "fastest"),
             ("--best", "clearance, cost, margin, slide, speed")),
            ((*DOOR, *grid, "--svg", self.folder / "m.svg"), ("--svg", "fewer than two")),
            ((*DOOR, *grid, "--timeout", "0"), ("--timeout",)),
            ((*DOOR, *grid, "--out", PROBLEM), ("--out",)),
        ]
        for options, words in cases:
            done = run("place", PROBLEM, *QUICK, *options)
            with self.subTest(options=options):
                self.assertEqual(done.returncode, 2, done.stdout + done.stderr)
                self.assertEqual(done.stdout, "")
                self.assertEqual(len(done.stderr.splitlines()), 1, done.stderr)
                for word in words:
                    self.assertIn(word, done.stderr)
        # The start does not move along.
        done = run("place", PROBLEMS / "experiment_a_start.yaml", "--path", *grid)
        self.assertEqual((done.returncode, len(done.stderr.splitlines())), (2, 1), done.stderr)
        self.assertIn("moved by x 0.1", done.stderr)
        for command in (("plan", PROBLEM), ("check", PROBLEM, self.folder / "none.csv")):
            for options, words in (
                ((*DOOR, "--x", "0:1:1"), ("--x", "one number")),
                (("--x", "1"), ("--object",)),
                (("--object", "dor"), ("nearest",)),
            ):
                done = run(*command, *options)
                self.assertEqual(
                    (done.returncode, len(done.stderr.splitlines())), (2, 1), done.stderr
                )
                for word in words:
                    self.assertIn(word, done.stderr)


if __name__ == "__main__":
    unittest.main(verbosity=2)

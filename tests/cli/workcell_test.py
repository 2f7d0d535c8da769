#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Workcells from outside: what `plan` and `check` say and write of two arms, and who refuses
them."""
import copy
import csv
import json
import os
import pathlib
import re
import subprocess
import tempfile
import unittest

from pages import data_of
from trials import trials

SWIVEL = os.environ["SWIVEL"]
DATA = pathlib.Path(os.environ["SWIVEL_DATA"])


def run(*arguments):
    return subprocess.run(
        [SWIVEL, *map(str, arguments)], capture_output=True, text=True, timeout=300
    )


def arm(name, y, **more):
    """An arm whose tool moves 0.1 m up in front of the torso, pointing forward."""
    corners = [[0.72, y, 1.0], [0.72, y, 1.1]]
    return {
        "name": name, "tip_link": f"arm_{name}_link_tool0", "tool": {"xyz": [0, 0, 0.1]},
        "path": {"waypoints": [{"xyz": at, "rpy": [0, 1.5707963, 0]} for at in corners]},
        **more
    }


def cell(gap=0.5, **changes):
    """Two arms whose tools are so far from each other, m."""
    return {
        "robot": {
            "urdf": str(DATA / "robots" / "sda10f.urdf"),
            "srdf": str(DATA / "robots" / "sda10f.srdf"), "base_link": "base_link",
            "hold": {"torso_joint_b1": 0}
        },
        "arms": [arm("left", gap / 2), arm("right", -gap / 2)],
        "resolution": {"ds": 0.02, "dphi": 0.2},
        **changes,
    }


class WithWorkcells(unittest.TestCase):
    """Has a folder for the file of a workcell."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.out, self.result = self.folder / "t.csv", self.folder / "r.json"

    def file(self, problem):
        file = self.folder / "cell.yaml"
        file.write_text(json.dumps(problem))
        return file


class Workcells(WithWorkcells):
    def plan(self, problem, *options):
        return run(
            "plan", self.file(problem), "--out", self.out, "--json", self.result, *options
        )

    def refused(self, problem, words, *options):
        done = self.plan(problem, *options)
        self.assertEqual(done.returncode, 2, done.stdout + done.stderr)
        self.assertEqual(len(done.stderr.splitlines()), 1)
        self.assertIn(words, done.stderr)
        self.assertIn("allowed is", done.stderr.replace("allowed are", "allowed is"))
        self.assertFalse(self.out.exists())

    def test_arms_that_do_not_meet(self):
        done = self.plan(cell())
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertRegex(
            done.stdout.splitlines()[0],
            r"^two arms, 6 layers, cost [0-9.]+: that of both arms alone, which do not meet; "
            r"nearest to each other [0-9.]+ mm: "
        )
        result = json.loads(self.result.read_text())
        self.assertEqual(result["status"], "solved")
        self.assertEqual(result["decided_by"], "arms alone")
        self.assertEqual([one["name"] for one in result["arms"]], ["left", "right"])
        self.assertAlmostEqual(result["cost"], sum(one["cost"] for one in result["arms"]))
        rows = list(csv.DictReader(self.out.read_text().splitlines()))
        self.assertEqual(len(rows), 6)
        for k, one in enumerate(result["arms"]):
            for name, q in zip(one["joint_names"], one["trajectory"][3]["joints"]):
                self.assertEqual(float(rows[3][name]), q)
        checked = run("check", self.folder / "cell.yaml", self.out)
        self.assertEqual(checked.returncode, 0, checked.stdout)
        self.assertTrue(checked.stdout.startswith("passed: two arms, 6 rows; "))

    def test_arms_that_cannot_keep_clear(self):
        done = self.plan(cell(gap=0.02))
        self.assertEqual(done.returncode, 1, done.stdout + done.stderr)
        lines = done.stdout.splitlines()
        self.assertTrue(lines[0].startswith("no plan: each arm has a path by itself, and no two "))
        self.assertRegex(lines[1], "the cheapest paths meet at s = 0.[0-9]+ m of 'left' and ")
        result = json.loads(self.result.read_text())
        self.assertEqual(result["status"], "infeasible")
        self.assertIsNone(result["cost"])
        self.assertEqual(len(result["conflict"]["bodies"]), 2)
        self.assertFalse(self.out.exists())

    def test_advice(self):
        near = cell(gap=0.11)
        self.assertIsNone(self.advised(near)["advice"])
        done = self.plan(near, "--advise", "60")
        self.assertEqual(done.returncode, 1, done.stdout + done.stderr)
        advice = json.loads(self.result.read_text())["advice"]
        self.assertEqual(advice["arms"], [])
        outcomes = [one["outcome"] for one in advice["cell"]]
        self.assertEqual(outcomes, sorted(outcomes, key=["solved", "no_help"].index))
        for one in advice["cell"]:
            words = "would help" if one["outcome"] == "solved" else "no help"
            self.assertIn(f"  {words}: {one['words']}", done.stdout)
        best = advice["cell"][0]
        self.assertEqual((best["change"], best["outcome"]), ("move_paths", "solved"))
        self.assertEqual(best["words"], "'left': path moved by 20 mm along +y")
        for waypoint in near["arms"][0]["path"]["waypoints"]:
            waypoint["xyz"] = [a + b for a, b in zip(waypoint["xyz"], best["offset"])]
        self.assertEqual(self.plan(near).returncode, 0)
        self.assertEqual(json.loads(self.result.read_text())["cost"], best["cost"])

    def test_advice_where_arms_have_no_path(self):
        strict = cell(limits={"clearance": 0.1})
        advice = self.advised(strict, "--advise", "60")["advice"]
        best = advice["cell"][0]
        self.assertEqual((best["change"], best["arm"]), ("clearance", None))
        self.assertEqual(best["outcome"], "solved")
        self.assertEqual([one["arm"] for one in advice["arms"]], ["left", "right"])
        for one in advice["arms"]:
            self.assertEqual(one["advice"][0]["outcome"], "solved")
        strict["limits"]["clearance"] = best["to"]
        self.assertEqual(self.plan(strict).returncode, 0)
        self.assertEqual(json.loads(self.result.read_text())["cost"], best["cost"])

    def advised(self, problem, *options):
        """Returns the result of a workcell that has no plan."""
        done = self.plan(problem, *options)
        self.assertEqual(done.returncode, 1, done.stdout + done.stderr)
        return json.loads(self.result.read_text())

    def test_certificate(self):
        proof = self.folder / "proof.json"
        done = self.plan(cell(gap=0.02), "--certificate", proof)
        self.assertEqual(done.returncode, 1, done.stdout + done.stderr)
        self.assertRegex(done.stdout, r"\ncertificate: [0-9]+ bytes\n$")
        file = self.folder / "cell.yaml"
        checked = run("check", file, "--certificate", proof)
        self.assertEqual(checked.returncode, 0, checked.stdout + checked.stderr)
        self.assertRegex(
            checked.stdout, "^passed: no two paths without conflict at this resolution: [0-9]+ "
            "regions? of conflict, [0-9]+ cuts; [0-9]+ pairs of nodes or motions of both arms, "
        )
        told = json.loads(proof.read_text())
        self.assertEqual(told["format"], "swivel certificate of a workcell 1")
        divided = [one for one in told["sets"] if "region" in one]
        self.assertEqual(len(told["sets"]), 2 * len(divided) + 1)
        for change, words in (
            (lambda c: c["sets"].pop(), "it is divided, and has"),
            (lambda c: c["sets"][0]["region"].update(bodies=["nobody", "else"]), "are no pair"),
            (lambda c: c["sets"][-1].update(layers=[]), "the cut of "),
        ):
            forged = copy.deepcopy(told)
            change(forged)
            other = self.folder / "forged.json"
            other.write_text(json.dumps(forged))
            done = run("check", file, "--certificate", other)
            self.assertEqual(done.returncode, 1, done.stdout)
            self.assertIn(words, done.stdout)
            self.assertTrue(
                done.stdout.startswith("failed: this certificate proves nothing\n  "), done.stdout
            )
        for change, words in (
            (lambda c: c.update(format="swivel certificate 1"), "format: is another"),
            (lambda c: c["sets"][0].update(region=3), "sets[0].region."),
            (lambda c: c["sets"][1].update(arm=2), "sets[1].arm"),
            (lambda c: c["arms"].pop(), "arms: is no list of 2"),
            (lambda c: c["arms"][0]["resolution"].update(ds=0.01), "resolution"),
        ):
            forged = copy.deepcopy(told)
            change(forged)
            other.write_text(json.dumps(forged))
            done = run("check", file, "--certificate", other)
            self.assertEqual(done.returncode, 2, done.stdout)
            self.assertIn(words, done.stderr)
        done = self.plan(cell(), "--certificate", proof)  # there is a plan now
        self.assertEqual(done.returncode, 0)
        self.assertFalse(proof.exists())

    def test_an_arm_without_a_path(self):
        problem = cell()
        problem["arms"][1] = arm("right", -2.5)
        done = self.plan(problem)
        self.assertEqual(done.returncode, 1)
        self.assertIn("no plan: an arm has no path by itself\n  right:\n", done.stdout)
        self.assertIn("no IK", done.stdout)
        result = json.loads(self.result.read_text())
        self.assertIsNone(result["arms"][1]["least_cost"])
        self.assertIsNotNone(result["arms"][1]["diagnosis"])
        self.assertIsNone(result["arms"][0]["diagnosis"])

    def test_pages(self):
        page = self.folder / "cell.html"
        done = self.plan(cell(), "--report", page)
        if "built without reports" in done.stderr:
            self.skipTest("built without reports")
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        data = data_of(page)
        result = json.loads(self.result.read_text())
        for key in ("arms", "between_arms", "cost", "decided_by"):
            self.assertEqual(data["result"][key], result[key])
        self.assertEqual(len(data["between"]), 6)
        for one, found in zip(data["arms"], result["arms"]):
            self.assertEqual(
                [row["q"] for row in one["rows"]], [row["joints"] for row in found["trajectory"]]
            )
        # Without an answer there is a page as well, but none where time was up.
        self.assertEqual(self.plan(cell(gap=0.02), "--report", page).returncode, 1)
        self.assertIn("no two of them keep clear", page.read_text())
        done = self.plan(cell(), "--report", page, "--timeout", "1e-9")
        self.assertEqual(done.returncode, 3, done.stdout + done.stderr)
        self.assertFalse(page.exists())
        # A timed plan has its times on the page, and a refined one the rows that are run.
        done = run("plan", self.file(cell()), "--report", page, "--speed", "0.1", "--refine",
                   "--json", self.result)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        data = data_of(page)
        result = json.loads(self.result.read_text())
        for one, found in zip(data["arms"], result["arms"]):
            self.assertTrue(one["refined"])
            self.assertEqual(len(one["beside"]), len(found["trajectory"]))
            self.assertEqual(
                [row["q"] for row in one["rows"]], [row["joints"] for row in found["trajectory"]]
            )
            self.assertEqual(one["motion"]["t"], data["arms"][0]["motion"]["t"])
            self.assertAlmostEqual(one["motion"]["t"][-1], result["motion"]["duration"], 2)
            self.assertEqual(one["motion"]["layers"][0], 0)
            self.assertEqual(one["motion"]["layers"], sorted(one["motion"]["layers"]))
            self.assertAlmostEqual(one["motion"]["layers"][-1], len(one["rows"]) - 1)

    def test_check_refuses_spoilt_rows(self):
        self.assertEqual(self.plan(cell()).returncode, 0)
        rows = [line.split(",") for line in self.out.read_text().splitlines()]
        spoilt = copy.deepcopy(rows)
        spoilt[3][10] = str(float(spoilt[3][10]) + 0.01)
        for other, words in (
            (spoilt, "tool"), (rows[:4] + rows[5:], "allowed is one at each layer"),
        ):
            self.out.write_text("\n".join(",".join(row) for row in other) + "\n")
            done = run("check", self.folder / "cell.yaml", self.out)
            self.assertEqual(done.returncode, 1, done.stdout)
            self.assertTrue(done.stdout.startswith("failed: two arms"))
            self.assertIn(words, done.stdout)
        for column, value, words in ((4, "9", "branch_left"), (6, "x", "not a")):
            other = copy.deepcopy(rows)
            other[2][column] = value
            self.out.write_text("\n".join(",".join(row) for row in other) + "\n")
            done = run("check", self.folder / "cell.yaml", self.out)
            self.assertEqual(done.returncode, 2)
            self.assertIn(words, done.stderr)

    def test_bad_input(self):
        self.refused(cell(path={"waypoints": []}), "path")
        self.refused(cell(arms=[arm("left", 0.2)]), "arms")
        self.refused(cell(strokes=[]), "strokes")
        self.refused(cell(home={"joints": [0] * 7}), "home")
        self.refused(cell(start={"joints": [0] * 7}), "start")
        for key in ("tip_link", "tool", "attached"):
            problem = cell()
            problem["robot"][key] = {"xyz": [0, 0, 0]} if key == "tool" else (
                "arm_left_link_tool0" if key == "tip_link" else [
                    {"name": "x", "sphere": 0.1, "link": "arm_left_link_tool0"}
                ]
            )
            self.refused(problem, "is of one arm, and this file has two")

        def changed(index, **keys):
            problem = cell()
            problem["arms"][index].update(keys)
            return problem

        self.refused(changed(1, name="left"), "name of the other arm")
        self.refused(changed(0, name="base_link"), "is the base link")
        self.refused(changed(0, tip_link="nowhere"), "unknown link 'nowhere'")
        self.refused(
            changed(1, trajectory="x.csv"), "arms[1].path: is given for an arm whose motion"
        )
        self.refused(changed(1, axes={}), "axes")
        self.refused(changed(1, wait=True), "robot.hold")
        self.refused(changed(1, tip_link="arm_left_link_7_t"), "moves with both arms")
        body = {"name": "tool", "sphere": 0.02, "xyz": [0, 0, 0.05]}
        self.refused(changed(0, attached=[{**body, "allow": ["nobody"]}]), "unknown body 'nobody'")
        both = changed(0, attached=[body])
        both["arms"][1]["attached"] = [body]
        self.refused(both, "attached twice")
        path = copy.deepcopy(cell()["arms"][0]["path"])
        self.refused(changed(0, path={**path, "frame": "nowhere"}), "unknown frame 'nowhere'")
        smooth = {**path, "frame": "left", "smooth": {"position": 0.001}}
        self.refused(changed(1, path=smooth), "is given for a follower")
        longer = copy.deepcopy(path)
        longer["waypoints"].append({"xyz": [0.72, 0.25, 1.2], "rpy": [0, 1.5707963, 0]})
        self.refused(changed(1, path=longer), "has 3 waypoints, and that of 'left' 2")
        twice = copy.deepcopy(path)
        twice["waypoints"][1] = twice["waypoints"][0]
        self.refused(changed(0, path=twice), "is where the one before it is")

    def given(self, name="rows.csv", **changes):
        """The workcell in which the left arm's motion is given by a file beside it."""
        problem = cell(**changes)
        del problem["arms"][0]["path"]
        problem["arms"][0]["trajectory"] = name
        return problem

    def test_an_arm_whose_motion_is_given(self):
        self.assertEqual(self.plan(cell()).returncode, 0)
        both = list(csv.DictReader(self.out.read_text().splitlines()))
        rows = self.folder / "rows.csv"
        rows.write_text(self.out.read_text())
        names = [f"arm_left_joint_{k}" for k in ("1_s", "2_l", "3_e", "4_u", "5_r", "6_b", "7_t")]
        alone = [",".join(reversed(names))]
        alone += [",".join(row[name] for name in reversed(names)) for row in both]
        problem = self.given()
        for text in (None, "\n".join(alone) + "\n"):
            if text is not None:
                rows.write_text(text)
            done = self.plan(problem)
            self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
            lines = done.stdout.splitlines()
            self.assertRegex(
                lines[0], r"^'right' beside the given motion of 'left', 6 layers, cost [0-9.]+: "
                r"that of 'right' alone, which keeps clear of it; nearest to each other "
            )
            self.assertEqual(lines[1], "  left (given):")
            again = list(csv.DictReader(self.out.read_text().splitlines()))
            for old, new in zip(both, again, strict=True):
                for name in old:
                    if "joint" in name:
                        self.assertEqual(old[name], new[name])
            result = json.loads(self.result.read_text())
            self.assertEqual([one["given"] for one in result["arms"]], [True, False])
            checked = run("check", self.folder / "cell.yaml", self.out)
            self.assertEqual(checked.returncode, 0, checked.stdout)
        spoilt = [dict(row) for row in again]
        spoilt[2][names[6]] = str(float(spoilt[2][names[6]]) + 1e-7)
        self.out.write_text(
            "\n".join([",".join(spoilt[0])] + [",".join(row.values()) for row in spoilt]) + "\n"
        )
        done = run("check", self.folder / "cell.yaml", self.out)
        self.assertEqual(done.returncode, 1)
        self.assertIn("row 2: a joint of 'left' is 1e-07 rad from the given motion", done.stdout)

    def test_a_leader_of_six_joints(self):
        """Its tool may turn, and takes the follower's path along: so its motion must be given."""
        six = cell()
        six["robot"]["hold"]["arm_left_joint_3_e"] = 0
        left = six["arms"][0]
        left["path"]["roll"] = [0.2, 0.3]
        alone = {
            "robot": {**six["robot"], "tip_link": left["tip_link"], "tool": left["tool"]},
            "resolution": {"ds": six["resolution"]["ds"]}
        }
        single = self.folder / "left.yaml"
        single.write_text(json.dumps({**alone, "path": left["path"]}))
        rows = self.folder / "left.csv"
        done = run("plan", single, "--out", rows)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        right = six["arms"][1]
        right["path"]["frame"] = "left"
        for waypoint in right["path"]["waypoints"]:  # half a metre beside the left tool
            waypoint.update(xyz=[-0.124, -0.484, 0], rpy=[0, 0, -0.25])
        self.refused(six, "lets the tool turn that carries the path of 'right'")
        self.refused(six, "cell.yaml:")
        del left["path"]
        left["trajectory"] = str(rows)
        table = list(csv.reader(rows.read_text().splitlines()))
        roll = table[0].index("roll")
        self.assertTrue(any(abs(float(row[roll])) > 1e-3 for row in table[1:]))
        costs = []
        for without in (False, True):
            if without:  # as controllers write it
                rows.write_text(
                    "\n".join(",".join(row[:roll] + row[roll + 1:]) for row in table) + "\n"
                )
            done = self.plan(six)
            self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
            costs.append(json.loads(self.result.read_text())["arms"][1]["cost"])
            done = run("check", self.folder / "cell.yaml", self.out)
            self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertAlmostEqual(*costs, places=6)

    def test_no_path_beside_a_given_motion(self):
        apart = cell(arms=[arm("left", 0.02), arm("right", -0.4)])
        self.assertEqual(self.plan(apart).returncode, 0)
        (self.folder / "rows.csv").write_text(self.out.read_text())
        problem = self.given(arms=[arm("left", 0.02), arm("right", -0.01)])
        done = self.plan(problem)
        self.assertEqual(done.returncode, 1, done.stdout + done.stderr)
        self.assertTrue(
            done.stdout.startswith(
                "no plan: 'right' has a path by itself, and none keeps clear of the given motion "
                "of 'left' ("
            )
        )

    def test_bad_given_motions(self):
        self.assertEqual(self.plan(cell()).returncode, 0)
        both = self.out.read_text()
        rows = self.folder / "rows.csv"
        rows.write_text(both)
        self.out.unlink()

        def refused(words, text=both, index=1, **keys):
            rows.write_text(text)
            problem = self.given()
            problem["arms"][index].update(keys)
            self.refused(problem, words)

        refused("No such file", index=0, trajectory="nowhere.csv")
        refused("is given, as is that of the other arm", trajectory="rows.csv", path=None)
        refused("is given for an arm whose motion is given", index=0, start={"joints": [0] * 7})
        refused("is given for an arm whose motion is given", index=0, at_rows=[0, 5])
        refused("column 'phi' is unknown", text=both.replace("phi_left", "phi"))
        names = ",".join(both.splitlines()[0].split(",")[6:13])
        joints = [",".join(line.split(",")[6:13]) for line in both.splitlines()[1:]]
        timed = [f"t,{names}"] + [f"{k},{line}" for k, line in enumerate(joints)]
        refused("has times", text="\n".join(timed) + "\n")
        refused("row 1: the tool is where it is", "\n".join([names, joints[0], *joints]) + "\n")
        refused("given motion: row 0: ", limits={"joint_margin": 1.5}, index=0)
        path = copy.deepcopy(cell()["arms"][1]["path"])
        path["waypoints"].insert(1, {"xyz": [0.72, -0.25, 1.05], "rpy": [0, 1.5707963, 0]})
        refused("has 3 waypoints, and the given motion of 'left' 6 rows", path=path)
        for at, words in (
            ([0, 5], "has 2 rows from 0 to 5"), ([0, 2, 4], "has 3 rows from 0 to 4"),
            ([0, 3, 3], "is 3, after 3"), ([0, 2.5, 5], "is 2.5"), ([0, 2, 9], "is 9"),
            ([], "has 0 rows"),
        ):
            refused(words, path=path, at_rows=at)
        rows.write_text(both)
        problem = self.given()
        problem["arms"][1].update(path=path, at_rows=[0, 2, 5])
        self.assertEqual(self.plan(problem).returncode, 0)
        self.out.unlink()
        problem = cell()
        problem["arms"][1]["at_rows"] = [0, 5]
        self.refused(problem, "no arm has a `trajectory`")

    def test_who_refuses_workcells(self):
        file = self.file(cell())
        done = run("info", "--pairs", file)
        self.assertEqual(done.returncode, 2)
        self.assertIn("workcell", done.stderr)

    def test_a_motion_in_time(self):
        file, motion = self.file(cell()), self.folder / "m.csv"
        done = run("plan", file, "--speed", "0.1", "--out", motion, "--json", self.result)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertRegex(done.stdout, r"\nmotion: [0-9.]+ s at 100 mm/s \(1\.000 s with the ")
        rows = list(csv.DictReader(motion.read_text().splitlines()))
        result = json.loads(self.result.read_text())
        moved = result["motion"]
        self.assertTrue(moved["executable"])
        self.assertEqual(moved["samples"], len(rows))
        names = [name for one in result["arms"] for name in one["joint_names"]]
        self.assertEqual(len(set(names)), 14)
        self.assertEqual(len(rows[0]), 1 + 6 + 3 * 14)
        step = 1 / moved["rate"]
        for name in names:
            q = [float(row[name]) for row in rows]
            self.assertLess(abs(q[1] - q[0]), 1e-5)  # from rest
            self.assertLess(abs(q[-1] - q[-2]), 1e-5)
            for before, row, after in zip(q, rows[1:], q[2:]):
                self.assertAlmostEqual(float(row[name + "_v"]), (after - before) / (2 * step), 6)
        for one in moved["arms"]:
            for rate in ("speed", "acceleration", "jerk"):
                self.assertLessEqual(max(peak["ratio"] for peak in one["peaks"][rate]), 1)
        checked = run("check", file, motion)
        self.assertEqual(checked.returncode, 0, checked.stdout + checked.stderr)
        self.assertRegex(checked.stdout, rf"^passed: two arms, {len(rows)} rows, [0-9.]+ s; ")
        spoilt = [dict(row) for row in rows]
        spoilt[len(rows) // 2][names[9]] = str(float(spoilt[len(rows) // 2][names[9]]) + 1e-3)
        with motion.open("w", newline="") as out:
            writer = csv.DictWriter(out, rows[0].keys())
            writer.writeheader()
            writer.writerows(spoilt)
        self.assertEqual(run("check", file, motion).returncode, 1)

    def test_refined_paths(self):
        file = self.file(cell())
        done = self.plan(cell())
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        before = json.loads(self.result.read_text())
        self.assertIsNone(before["refinement"])
        done = self.plan(cell(), "--refine")
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        result = json.loads(self.result.read_text())
        refined = result["refinement"]
        self.assertAlmostEqual(refined["cost_before"], before["cost"], 9)
        self.assertLess(refined["cost"], before["cost"])
        self.assertEqual(result["cost"], refined["cost"])
        self.assertTrue(result["checked"])
        self.assertEqual([one["name"] for one in refined["arms"]], ["left", "right"])
        for one, arm in zip(refined["arms"], result["arms"]):
            self.assertTrue(one["refined"])
            self.assertEqual(one["cost"], arm["cost"])
            self.assertEqual(one["cost_before"], arm["lattice"]["cost"])
            self.assertIsNotNone(arm["min_clearance"])
        self.assertRegex(done.stdout, r"cost [0-9.]+: before refining that of both arms alone")
        self.assertRegex(done.stdout, r"\nrefined: cost [0-9.]+ before, [0-9.]+ now, in 1 turn")
        self.assertRegex(done.stdout, r"\n  left: joints bend by at most ")
        checked = run("check", file, self.out)
        self.assertEqual(checked.returncode, 0, checked.stdout + checked.stderr)
        # Refined and timed, it passes as a motion does.
        motion = self.folder / "m.csv"
        done = run("plan", file, "--refine", "--speed", "0.1", "--out", motion, "--json",
                   self.result)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        result = json.loads(self.result.read_text())
        self.assertTrue(result["motion"]["executable"])
        self.assertLess(result["refinement"]["cost"], result["refinement"]["cost_before"])
        checked = run("check", file, motion)
        self.assertEqual(checked.returncode, 0, checked.stdout + checked.stderr)
        for more in (("--refine",), ("--speed", "0.1")):
            done = run("plan", file, "--certificate", self.folder / "c.json", *more)
            self.assertEqual(done.returncode, 2)
            self.assertRegex(done.stderr, "^swivel: --certificate: .*: allowed without --refine")
        (self.folder / "rows.csv").write_text(self.out.read_text())
        done = self.plan(self.given(), "--refine")
        self.assertEqual(done.returncode, 2, done.stdout)
        self.assertIn("beside which nothing is refined yet", done.stderr)

    def test_time_is_up(self):
        """What is known stays: the plan, with the reason why it is not refined or timed."""
        file, seen, count = self.file(cell()), set(), max(6, trials(40))
        for k in range(count):
            asked = (("--refine",), ("--speed", "0.05"), ("--speed", "0.05", "--refine"))[k % 3]
            self.out.unlink(missing_ok=True)
            done = run(
                "plan", file, *asked, "--timeout", 2e-3 * 1.25 ** (30 * k / (count - 1)),
                "--json", self.result, "--out", self.out
            )
            told = json.loads(self.result.read_text())
            motion, planned = told["motion"], told["status"] == "solved"
            if planned and "--speed" in asked and not motion["executable"]:
                self.assertEqual((motion["reason"], motion["arm"]), ("stopped", None))
                self.assertEqual(done.returncode, 3)
                seen.add("plan alone")
            else:
                self.assertEqual(motion is not None, planned and "--speed" in asked)
                self.assertEqual(done.returncode, 0 if planned else 3)
                seen.add("answer" if planned else "nothing")
            self.assertEqual(self.out.exists(), done.returncode == 0)
        self.assertIn("answer", seen)

    def test_time_refines(self):
        """Rows of a plan without rounded corners are refined and timed as `plan` does it."""
        cornered = cell()
        for one, y in zip(cornered["arms"], (0.33, -0.35)):
            one["path"]["waypoints"].append({"xyz": [0.70, y, 1.12], "rpy": [0, 1.5707963, 0]})
        led = cell()
        led["arms"][1]["path"] = {
            "frame": "left", "waypoints": [{"xyz": [0, -0.45, 0]}, {"xyz": [0.02, -0.45, 0]}]
        }
        for problem in (cell(), cornered, led):
            file, motion = self.file(problem), self.folder / "m.csv"
            self.assertEqual(self.plan(problem).returncode, 0)
            done = run("time", file, self.out, "--speed", "0.1", "--refine", "--out", motion)
            self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
            refined = re.match(r"refined: cost ([0-9.]+) before, ([0-9.]+) now, in ", done.stdout)
            self.assertLess(float(refined[2]), float(refined[1]))
            self.assertRegex(done.stdout, r"\n  left: joints bend by at most .*\n  right: joints ")
            self.assertRegex(done.stdout, r"\nmotion: [0-9.]+ s at 100 mm/s ")
            checked = run("check", file, motion)
            self.assertEqual(checked.returncode, 0, checked.stdout + checked.stderr)
            planned = run("plan", file, "--speed", "0.1", "--refine", "--out", motion)
            self.assertEqual(planned.returncode, 0, planned.stdout + planned.stderr)
            as_planned = re.search(r"\nrefined: cost [0-9.]+ before, ([0-9.]+) now", planned.stdout)
            self.assertAlmostEqual(float(refined[2]), float(as_planned[1]), places=2)
            plain = run("time", file, self.out, "--speed", "0.1")
            self.assertNotIn("refined", plain.stdout)
        self.assertEqual(self.plan(cell()).returncode, 0)
        (self.folder / "rows.csv").write_text(self.out.read_text())
        done = run("time", self.file(self.given()), self.out, "--speed", "0.1", "--refine")
        self.assertEqual(done.returncode, 2, done.stdout)
        self.assertIn("its motion is given", done.stderr)

    def test_formats_of_motions(self):
        file = self.file(cell())
        self.assertEqual(self.plan(cell()).returncode, 0)
        joints = [
            name for one in json.loads(self.result.read_text())["arms"]
            for name in one["joint_names"]
        ]
        message = self.folder / "m.json"
        timed = run("time", file, self.out, "--speed", "0.1", "--out", message)
        self.assertEqual(timed.returncode, 0, timed.stdout + timed.stderr)
        text = json.loads(message.read_text())
        self.assertEqual(text["joint_names"], joints)
        self.assertEqual({len(point["positions"]) for point in text["points"]}, {14})
        for ending, begin in ((".yaml", b"header:"), (".mcap", b"\x89MCAP")):
            other = self.folder / f"m{ending}"
            done = run("plan", file, "--speed", "0.1", "--out", other, "--quiet")
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertTrue(other.read_bytes().startswith(begin))
            self.assertIn(joints[13].encode(), other.read_bytes())
        for options, words in ((("plan", file, "--speed", "0.1", "--out", "m.txt"), ".mcap"),
                               (("plan", file, "--rate", "100"), "allowed with --speed"),
                               (("plan", file, "--speed", "0"), "--speed"),
                               (("time", file, self.out), "--speed: is not given")):
            done = run(*options)
            self.assertEqual(done.returncode, 2, (options, done.stdout, done.stderr))
            self.assertEqual(len(done.stderr.splitlines()), 1)
            self.assertIn(words, done.stderr)

    def test_threads_and_planners_agree(self):
        texts = set()
        for options in (("--planner", "lazy"), ("--threads", "1"), ("--threads", "2")):
            self.assertEqual(self.plan(cell(gap=0.25), *options).returncode, 0)
            texts.add(self.out.read_text())
        self.assertEqual(len(texts), 1)


if __name__ == "__main__":
    unittest.main()

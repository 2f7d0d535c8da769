# SPDX-License-Identifier: BSD-3-Clause
# Workcells in the Python package. Usage: workcell_test.py CASE; SWIVEL is the program, SWIVEL_DATA
# the data folder.
import json
import os
import pickle
import re
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path
from unittest import mock

import numpy as np
import swivel
from pages import data_of

PROGRAM, DATA = os.environ["SWIVEL"], Path(os.environ["SWIVEL_DATA"])
BAR = DATA / "problems" / "sda10f_bar_workcell.yaml"
PLATE = DATA / "problems" / "sda10f_plate_workcell.yaml"


def rows_of(answer):
    """Name -> Trajectory of both arms; nothing where there is no answer."""
    return {name: arm.trajectory for name, arm in answer.arms.items()} if answer.solved else {}


def refinements_of(answer):
    """Name -> Refined of both arms, where rows were refined."""
    return {name: arm.refinement for name, arm in answer.arms.items() if arm.refinement}


class Workcells(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def test_plans_as_the_program_does(self):
        csv = self.folder / "both.csv"
        subprocess.run([PROGRAM, "plan", PLATE, "--out", csv, "--quiet"], check=True)
        cell = swivel.load(PLATE)
        self.assertEqual(list(cell.arms), ["left", "right"])
        plan = swivel.plan(cell, planner="lazy", evidence=True)
        self.assertTrue(plan.solved)
        self.assertEqual(plan.decided_by, "arms alone")
        self.assertAlmostEqual(plan.cost, sum(arm.least_cost for arm in plan.arms.values()))
        self.assertGreater(plan.clearance, 0.005)
        self.assertIsNone(plan.conflict)
        saved = self.folder / "saved.csv"
        plan.save(saved)
        self.assertEqual(saved.read_text(), csv.read_text())
        left = plan.arms["left"].trajectory
        self.assertEqual(left.joints.shape, (33, 7))
        self.assertEqual(left.joint_names[0], "arm_left_joint_1_s")
        result = json.loads(plan.to_json())
        self.assertEqual(result["arms"][0]["trajectory"][5]["joints"], list(left.joints[5]))
        for rows in (plan, rows_of(plan), csv):
            check = swivel.check(PLATE, rows)
            self.assertTrue(check, check.failures)

    def test_every_example_has_a_plan_that_passes_its_check(self):
        examples = sorted((DATA / "problems").glob("*_workcell.yaml"))
        self.assertGreaterEqual(len(examples), 3)
        for example in examples:
            with self.subTest(example.name):
                plan = swivel.plan(example)
                self.assertTrue(plan.solved)
                check = swivel.check(example, plan)
                self.assertTrue(check, check.failures)

    def test_check_finds_what_is_wrong(self):
        plan = swivel.plan(PLATE)
        rows = rows_of(plan)
        joints = np.array(rows["right"].joints)
        joints[7, 3] += 0.01
        right = rows["right"]
        rows["right"] = swivel.Trajectory(
            joints, right.s, right.phi, right.branch, right.joint_names
        )
        check = swivel.check(PLATE, rows)
        self.assertFalse(check.passed)
        self.assertIn("row 7", check.failures[0])
        with self.assertRaises(KeyError):
            swivel.check(PLATE, {"left": plan.arms["left"].trajectory})

    def arms(self, gap, torso=0):
        """Two problems of one robot, whose tools move up side by side."""
        forward = [np.sqrt(0.5), 0, np.sqrt(0.5), 0]
        arms = {}
        for name, y in (("left", gap / 2), ("right", -gap / 2)):
            robot = swivel.Robot(
                DATA / "robots" / "sda10f.urdf", DATA / "robots" / "sda10f.srdf",
                base="base_link", tip=f"arm_{name}_link_tool0", hold={"torso_joint_b1": torso}
            )
            task = swivel.Task([[0.72, y, z, *forward] for z in (1.0, 1.1)])
            task.resolution = swivel.Resolution(ds=0.02, dphi=0.2)
            arms[name] = swivel.Problem(robot, task)
        return arms

    def test_advice_is_planned(self):
        arms = self.arms(0.11)
        cell = swivel.Problem(arms)
        advice = swivel.advise(cell, swivel.plan(cell), timeout=60)
        self.assertEqual(advice.alone, {})
        best = advice[0]
        self.assertEqual((best.change, best.arm), (swivel.Change.MOVE_PATHS, "left"))
        self.assertEqual(best.outcome, swivel.Outcome.SOLVED)
        self.assertIn("would help: 'left': path moved by 20 mm along +y", str(advice))
        self.assertIn("path moved by 20 mm", repr(best))
        self.assertIsNone(best.object)
        self.assertEqual(list(best.offset), [0, 0.02, 0])
        with self.assertRaisesRegex(ValueError, "timeout"):
            swivel.advise(cell, swivel.plan(cell), timeout=0)

    def test_advice_tells_what_helps_an_arm_by_itself(self):
        arms = self.arms(0.5)
        limits = arms["right"].task.limits
        limits.joint_margin = 0.9
        task = arms["right"].task
        task.limits = limits
        cell = swivel.Problem(
            {"left": arms["left"], "right": swivel.Problem(arms["right"].robot, task)}
        )
        plan = swivel.plan(cell)
        self.assertEqual(plan.status, "infeasible")
        self.assertIsNone(plan.arms["right"].least_cost)
        advice = swivel.advise(cell, plan, timeout=60)
        self.assertEqual(list(advice.alone), ["right"])
        alone = {one.change: one.outcome for one in advice.alone["right"]}
        self.assertEqual(alone[swivel.Change.JOINT_MARGIN], swivel.Outcome.SOLVED)
        best = advice[0]
        self.assertEqual((best.change, best.arm), (swivel.Change.JOINT_MARGIN, "right"))
        self.assertEqual(best.asked, 0.9)
        limits.joint_margin = best.changed_to
        task.limits = limits
        relaxed = swivel.Problem(
            {"left": arms["left"], "right": swivel.Problem(arms["right"].robot, task)}
        )
        self.assertEqual(swivel.plan(relaxed).cost, best.cost)

    def test_is_made_of_two_problems(self):
        cell = swivel.Problem(self.arms(0.5))
        self.assertRegex(repr(cell), "<Problem of 'left' and 'right', 2 waypoints>")
        plan = swivel.plan(cell)
        self.assertTrue(plan.solved)
        self.assertEqual({len(rows) for rows in rows_of(plan).values()}, {6})
        self.assertTrue(swivel.check(cell, plan))
        barred = swivel.plan(swivel.Problem(self.arms(0.02)))
        self.assertEqual(barred.status, "infeasible")
        self.assertEqual(len(barred.conflict), 2)
        for arm in barred.arms.values():
            self.assertEqual((len(arm.trajectory), arm.diagnosis, arm.parts), (0, None, []))
        for word in ("trajectory", "diagnosis", "lattice", "counters", "joints"):
            with self.assertRaisesRegex(AttributeError, rf"answer.arms\[name\].{word}"):
                getattr(barred, word)
        self.assertEqual(len(swivel.advise(cell, plan)), 0)
        with self.assertRaisesRegex(ValueError, "there are no rows"):
            barred.save(self.folder / "none.csv")

    def test_plans_beside_a_given_motion(self):
        arms = self.arms(0.5)
        plan = swivel.plan(swivel.Problem(arms))
        self.assertEqual([arm.given for arm in plan.arms.values()], [False, False])
        left = plan.arms["left"].trajectory
        cell = swivel.Problem({"left": (arms["left"].robot, left), "right": arms["right"]})
        self.assertRegex(repr(cell), "<Problem of 'left' and 'right', 2 waypoints>")
        beside = swivel.plan(cell)
        self.assertEqual([arm.given for arm in beside.arms.values()], [True, False])
        self.assertTrue(np.array_equal(beside.arms["left"].trajectory.joints, left.joints))
        self.assertTrue(
            np.array_equal(
                beside.arms["right"].trajectory.joints, plan.arms["right"].trajectory.joints
            )
        )
        self.assertTrue(swivel.check(cell, beside))
        given = {"left": (arms["left"].robot, left), "right": arms["right"]}
        self.assertTrue(swivel.plan(swivel.Problem(given, at_rows=[0, 5])).solved)
        with self.assertRaises(swivel.InvalidArgument):
            swivel.Problem(given, at_rows=[0, 2, 5])
        with self.assertRaisesRegex(ValueError, "ascending rows from 0"):
            swivel.Problem(given, at_rows=[1, 5])
        with self.assertRaisesRegex(ValueError, "both motions are given"):
            swivel.Problem({"left": given["left"], "right": given["left"]})
        with self.assertRaisesRegex(ValueError, "has other joints"):
            swivel.Problem({"left": arms["left"], "right": (arms["right"].robot, left)})

    def test_a_leader_of_six_joints(self):
        arms = self.arms(0.5)
        robots = {
            name: swivel.Robot(
                DATA / "robots" / "sda10f.urdf", DATA / "robots" / "sda10f.srdf",
                base="base_link", tip=f"arm_{name}_link_tool0",
                hold={"torso_joint_b1": 0, "arm_left_joint_3_e": 0},
                **({"roll": swivel.Roll()} if name == "left" else {})
            ) for name in arms
        }
        alone = swivel.Problem(robots["left"], arms["left"].task)
        plan = swivel.plan(alone)
        self.assertTrue(plan.solved)
        turned = plan.trajectory.joints[:, -1]

        def real_tool(row):
            c, s = np.cos(turned[row]), np.sin(turned[row])
            roll = np.array([[c, -s, 0, 0], [s, c, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]])
            return robots["left"].tool_pose(plan.trajectory.joints[row]) @ roll

        task = arms["right"].task
        places = [
            (np.linalg.inv(real_tool(row)) @ [*at[:3], 1])[:3]
            for row, at in zip((0, len(turned) - 1), task.waypoints)
        ]
        on_tool = swivel.Task([[*at, 1, 0, 0, 0] for at in places], frame="left")
        on_tool.resolution = task.resolution
        right = swivel.Problem(robots["right"], on_tool)
        with self.assertRaisesRegex(ValueError, "whose path would turn with its tool"):
            swivel.plan(swivel.Problem({"left": alone, "right": right}))
        cell = swivel.Problem({"left": (robots["left"], plan.trajectory), "right": right})
        both = swivel.plan(cell)
        self.assertTrue(both.solved)
        self.assertTrue(swivel.check(cell, both))
        joints = both.arms["left"].trajectory.joints
        self.assertTrue(np.array_equal(joints[:, -1], turned))
        for row in range(len(joints)):
            pose = robots["right"].tool_pose(both.arms["right"].trajectory.joints[row])
            there = (np.linalg.inv(real_tool(row)) @ pose[:, 3])[:3]
            share = row / (len(joints) - 1)
            asked = places[0] + share * (places[1] - places[0])
            self.assertLess(np.abs(there - asked).max(), 1e-5)

    def test_a_motion_in_time(self):
        cell = swivel.Problem(self.arms(0.5))
        plan = swivel.plan(cell, speed=0.1, rate=125)
        self.assertTrue(plan.motion.executable)
        left, right = plan.motion.arms["left"], plan.motion.arms["right"]
        np.testing.assert_array_equal(left.t, right.t)
        self.assertEqual(left.rate, 125)
        self.assertAlmostEqual(left.ideal, 1)
        for motion in (left, right):
            for rate in motion.peaks.values():
                self.assertLessEqual(np.max(rate), 1)
        self.assertTrue(swivel.check(cell, plan.motion))
        file = self.folder / "motion.csv"
        plan.motion.save(file)
        self.assertTrue(swivel.check(cell, file))
        self.assertTrue(json.loads(plan.to_json())["motion"]["executable"])
        spoilt = {"left": left, "right": swivel.plan(cell, speed=0.05).motion.arms["right"]}
        self.assertFalse(swivel.check(cell, spoilt))
        untimed = swivel.plan(cell)
        self.assertIsNone(untimed.motion)
        with self.assertRaisesRegex(ValueError, "allowed with speed"):
            swivel.plan(cell, rate=100)
        with self.assertRaisesRegex(ValueError, "allowed are two alike"):
            swivel.check(cell, {"left": left, "right": untimed.arms["right"].trajectory})

    def test_refines(self):
        cell = swivel.Problem(self.arms(0.5))
        plain = swivel.plan(cell)
        self.assertEqual(refinements_of(plain), {})
        plan = swivel.plan(cell, refine=True)
        self.assertEqual(list(refinements_of(plan)), ["left", "right"])
        self.assertLess(plan.cost, plain.cost)
        self.assertFalse(plan.stopped)
        for name, arm in refinements_of(plan).items():
            self.assertTrue(arm.refined)
            self.assertLess(arm.cost, arm.cost_before)
            np.testing.assert_array_equal(
                arm.trajectory.joints, plan.arms[name].trajectory.joints
            )
            np.testing.assert_array_equal(
                plan.arms[name].lattice_path.joints, plain.arms[name].trajectory.joints
            )
        self.assertTrue(swivel.check(cell, plan))
        self.assertAlmostEqual(json.loads(plan.to_json())["refinement"]["cost"], plan.cost)
        timed = swivel.plan(cell, refine=True, speed=0.1)
        self.assertTrue(swivel.check(cell, timed.motion))

    def test_time_is_up_before_the_motion(self):
        cell = swivel.Problem(self.arms(0.5))
        for k in range(60):
            plan = swivel.plan(cell, speed=0.05, refine=k % 2 == 1, timeout=2e-3 * 1.2**k)
            told = json.loads(plan.to_json())["motion"]
            if not plan.solved:
                self.assertEqual((told, plan.motion), (None, None))
            elif plan.stopped:
                self.assertEqual((told["executable"], told["reason"]), (False, "stopped"))
                self.assertFalse(plan.motion and plan.motion.executable)
            else:
                break
        self.assertTrue(told["executable"])
        self.assertTrue(plan.motion.executable)

    def barred(self):
        """A workcell file whose tools would move up at one place."""
        robot = {
            "urdf": str(DATA / "robots" / "sda10f.urdf"),
            "srdf": str(DATA / "robots" / "sda10f.srdf"),
            "base_link": "base_link",
            "hold": {"torso_joint_b1": 0},
        }
        arms = []
        for name, y in (("left", 0.01), ("right", -0.01)):
            path = [{"xyz": [0.72, y, z], "rpy": [0, 1.5707963, 0]} for z in (1.0, 1.1)]
            arms.append({
                "name": name, "tip_link": f"arm_{name}_link_tool0", "tool": {"xyz": [0, 0, 0.1]},
                "path": {"waypoints": path}
            })
        file = self.folder / "barred.yaml"
        cell = {"robot": robot, "arms": arms, "resolution": {"ds": 0.02, "dphi": 0.2}}
        file.write_text(json.dumps(cell))
        return file

    def drawn(self):
        """The file of the plate, of a robot that has visual shapes as well."""
        urdf = (DATA / "robots" / "sda10f.urdf").read_text()
        for link in ("arm_left_link_2_l", "arm_right_link_3_e"):
            shape = '<visual><geometry><sphere radius="0.1"/></geometry></visual>'
            urdf = urdf.replace(f'<link name="{link}">', f'<link name="{link}">{shape}')
        (self.folder / "drawn.urdf").write_text(urdf)
        text = PLATE.read_text().replace("../robots/sda10f.urdf", "drawn.urdf")
        file = self.folder / "drawn.yaml"
        file.write_text(text.replace("../", f"{DATA}/"))
        return file

    def test_certificates(self):
        file, proof = self.barred(), self.folder / "proof.json"
        done = subprocess.run(
            [PROGRAM, "plan", file, "--quiet", "--certificate", proof], capture_output=True
        )
        self.assertEqual(done.returncode, 1, done.stderr)
        cell = swivel.load(file)
        plan = swivel.plan(cell)
        self.assertEqual(plan.status, "infeasible")
        self.assertIsNotNone(plan.conflict)
        certificate = plan.certificate()
        self.assertEqual(certificate.to_json(), proof.read_text())
        self.assertGreater(certificate.regions, 0)
        self.assertEqual(certificate.cuts, certificate.regions + 1)
        self.assertRegex(repr(certificate), "^<WorkcellCertificate: no plan, [0-9]+ regions, ")
        saved = self.folder / "saved.json"
        certificate.save(saved)
        self.assertEqual(saved.read_text(), proof.read_text())
        self.assertEqual(swivel.load_certificate(proof), certificate)
        self.assertEqual(pickle.loads(pickle.dumps(certificate)), certificate)
        for of in (cell, file):
            for what in (certificate, proof):
                check = swivel.check_certificate(of, what)
                self.assertTrue(check, check.failure)
        self.assertIsNone(check.failure)
        self.assertEqual((check.regions, check.cuts), (certificate.regions, certificate.cuts))
        self.assertGreater(check.pairs, 0)
        self.assertTrue(pickle.loads(pickle.dumps(check)).passed)
        self.assertEqual(
            subprocess.run(
                [PROGRAM, "check", file, "--certificate", saved], capture_output=True
            ).returncode, 0
        )
        forged = json.loads(proof.read_text())
        forged["sets"][-1].update(layers=[])
        saved.write_text(json.dumps(forged))
        check = swivel.check_certificate(cell, saved)
        self.assertFalse(check.passed)
        self.assertIn("failed", repr(check))
        with self.assertRaises(swivel.InputError):
            swivel.check_certificate(PLATE, proof)
        with self.assertRaises(TimeoutError):
            plan.certificate(timeout=1e-9)
        with self.assertRaisesRegex(ValueError, "'solved': allowed is one that is infeasible"):
            swivel.plan(PLATE).certificate()
        with self.assertRaisesRegex(ValueError, "without refine, speed"):
            swivel.plan(cell, speed=0.1).certificate()

    @unittest.skipUnless(swivel._swivel._page_available(), "built without pages")
    def test_pages(self):
        for file, keywords, options in (
            (self.drawn(), {}, ()),
            (self.barred(), {}, ()),
            (PLATE, {"speed": 0.05, "refine": True}, ("--speed", "0.05", "--refine")),
        ):
            page = self.folder / "page.html"
            done = subprocess.run([PROGRAM, "plan", file, "--report", page, "--quiet", *options])
            plan = swivel.plan(file, **keywords)
            self.assertEqual(done.returncode, 0 if plan.solved else 1)
            other = self.folder / "other.html"
            self.assertIsNone(plan.report(other))
            program, here = data_of(page), data_of(other)
            shown = sorted(body["name"] for body in here["visual"])
            drawn = file.name == "drawn.yaml"
            self.assertEqual(shown, ["arm_left_link_2_l", "arm_right_link_3_e"] if drawn else [])
            for data in (program, here):
                data["result"]["time_ms"] = None
            self.assertEqual(here, program)
        with mock.patch("webbrowser.open") as opened:
            plan.show()
        opened.assert_called_once()
        shown = Path(opened.call_args[0][0].removeprefix("file://"))
        self.addCleanup(shown.unlink)
        self.assertEqual(data_of(shown)["result"]["cost"], here["result"]["cost"])

    def test_trajectories_are_timed_as_the_program_does(self):
        csv, theirs, own = (self.folder / name for name in ("both.csv", "theirs.csv", "own.csv"))
        cell = swivel.load(PLATE)
        plan = swivel.plan(cell)
        plan.save(csv)
        for keywords, options in (({}, ()), ({"refine": True}, ("--refine", ))):
            words = ["time", PLATE, csv, "--speed", "0.05", "--out", theirs, "--quiet", *options]
            subprocess.run([PROGRAM, *words], check=True)
            for rows in (plan, rows_of(plan), csv):
                motion = swivel.time(cell, rows, speed=0.05, **keywords)
                motion.save(own)
                self.assertEqual(own.read_bytes(), theirs.read_bytes())
            self.assertTrue(motion.executable)
            self.assertIsNone(motion.reason)
            self.assertEqual(
                [arm.refinement is not None for arm in motion.arms.values()], [bool(keywords)] * 2
            )
            rest = motion.arms["left"].t[-1] - motion.duration  # of the last sample
            self.assertTrue(0 <= rest < 1 / 250)
            self.assertTrue(swivel.check(cell, motion))
            self.assertTrue(swivel.check(cell, motion.arms))
            again = pickle.loads(pickle.dumps(motion))
            again.save(own)
            self.assertEqual(own.read_bytes(), theirs.read_bytes())
            self.assertEqual(repr(again), repr(motion))
        again = swivel.time(cell, own, speed=0.05)  # its times are left aside
        with tempfile.TemporaryDirectory() as folder:
            for ending in ("json", "yaml", "mcap"):
                file = Path(folder) / f"m.{ending}"
                motion.save(file)
                self.assertTrue(swivel.check(cell, file))
                timed = swivel.time(cell, file, speed=0.05)
                for arm in ("left", "right"):
                    np.testing.assert_allclose(
                        timed.arms[arm].joints, again.arms[arm].joints, atol=1e-6
                    )
        for rows in (again, again.arms):  # in memory alike
            timed = swivel.time(cell, rows, speed=0.05)
            np.testing.assert_allclose(
                timed.arms["left"].joints, again.arms["left"].joints, atol=1e-6
            )
        with self.assertRaisesRegex(ValueError, "speed: is not given"):
            swivel.time(cell, plan)
        with self.assertRaisesRegex(ValueError, "rate"):
            swivel.time(cell, plan, speed=0.05, rate=0)
        with self.assertRaises(TimeoutError):
            swivel.time(cell, plan, speed=0.05, timeout=1e-6)
        with self.assertRaisesRegex(ValueError, "rows: there are none: the answer is 'infeasible'"):
            swivel.time(self.barred(), swivel.plan(self.barred()), speed=0.05)

    def test_plans_are_pickled(self):
        cell = swivel.Problem(self.arms(0.5))
        for plan in (
            swivel.plan(cell, evidence=True),
            swivel.plan(cell, speed=0.1, refine=True),
            swivel.plan(swivel.Problem(self.arms(0.02))),
        ):
            again = pickle.loads(pickle.dumps(plan))
            self.assertEqual(again.to_json(), plan.to_json())
            self.assertEqual(repr(again), repr(plan))
            for name, rows in rows_of(plan).items():
                np.testing.assert_array_equal(again.arms[name].trajectory.joints, rows.joints)
            self.assertEqual(again.motion is None, plan.motion is None)
            self.assertEqual(list(refinements_of(again)), list(refinements_of(plan)))
            self.assertLess(len(pickle.dumps(plan)), len(pickle.dumps(cell)) + 1_000_000)
        with self.assertRaisesRegex(ValueError, "unpickled has none"):
            again.certificate()
        self.assertEqual(
            again.certificate(swivel.Problem(self.arms(0.02))), plan.certificate()
        )
        if swivel._swivel._page_available():
            again = pickle.loads(pickle.dumps(swivel.plan(cell)))
            with self.assertRaisesRegex(ValueError, "unpickled has none"):
                again.report()
            self.assertGreater(len(swivel.report(cell, again)), 100_000)
            with self.assertRaisesRegex(ValueError, "another answer"):
                swivel.report(swivel.Problem(self.arms(0.4)), again)

    def test_bad_input(self):
        path = swivel.plan(DATA / "problems" / "experiment_c.yaml")
        for rows in (path, path.trajectory, path.parts):
            with self.assertRaisesRegex(swivel.InvalidArgument, "rows: .*those of two arms"):
                swivel.check(PLATE, rows)
        with self.assertRaisesRegex(swivel.InvalidArgument, "rows: .*those of one path"):
            swivel.check(DATA / "problems" / "experiment_c.yaml", swivel.plan(PLATE))
        cell = swivel.load(PLATE)
        for call in (
            lambda: swivel.measure(cell, None), lambda: cell.stretch(0),
            lambda: cell.save("a.yaml"),
            lambda: swivel.plan(cell, check=len), lambda: swivel.plan(cell, cost=len),
            lambda: swivel.check(cell, None, speed=1)
        ):
            with self.assertRaisesRegex(swivel.InvalidArgument, "a problem of two arms: allowed"):
                call()
        for word in ("name", "tool_pose", "scene", "limits", "waypoints", "strokes"):
            with self.assertRaisesRegex(AttributeError, f"{word}: of a problem of two arms"):
                getattr(cell, word)
        with self.assertRaisesRegex(AttributeError, "limits: of a problem of two arms"):
            cell.limits = swivel.Limits()
        for name, arm in cell.arms.items():
            self.assertEqual((len(arm.waypoints), list(arm.arms)), (2, [""]), name)
        with self.assertRaisesRegex(ValueError, "has 0 entries"):
            swivel.Problem({})
        arms = self.arms(0.5)
        arms["right"] = self.arms(0.5, torso=0.2)["right"]
        with self.assertRaisesRegex(swivel.InvalidArgument, "hold"):
            swivel.Problem(arms)
        with self.assertRaises(ValueError):
            swivel.plan(PLATE, threads=-1)


class WorkcellStudies(unittest.TestCase):
    """Placements and campaigns of workcells: rows are those of the program, and of plans."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)
        # the bar's workcell on a coarse lattice, with things that vary
        text = BAR.read_text().replace("../", f"{DATA}/")
        text = re.sub(r"^resolution:.*$", "resolution: {ds: 0.02, dphi: 0.2}", text, flags=re.M)
        self.assertIn("ds: 0.02", text)
        text += (
            "scene:\n  - {name: post, cylinder: {radius: 0.03, length: 0.6}, "
            "xyz: [0.55, 0.5, 1.0]}\nvary:\n  - {object: post, xyz: [0.1, 0.5, 0]}\n"
        )
        self.file = self.folder / "cell.yaml"
        self.file.write_text(text)

    def table(self, command, *arguments):
        out = self.folder / "out.csv"
        done = subprocess.run(
            [PROGRAM, command, self.file, *arguments, "--out", out], capture_output=True, text=True
        )
        self.assertIn(done.returncode, (0, 1), done.stderr)
        return out.read_text()

    def saved(self, table):
        table.save(self.folder / "saved.csv")
        return (self.folder / "saved.csv").read_text()

    @staticmethod
    def without_time(text):
        return [[*line.split(",")[:3], *line.split(",")[4:]] for line in text.splitlines()]

    def test_placements(self):
        cell = swivel.load(self.file)
        for arguments, keywords in (
            (("--path", "--x", "-0.1:0.2:0.15", "--y", "-0.2:0.2:0.2"),
             {"path": True, "x": (-0.1, 0.2, 0.15), "y": (-0.2, 0.2, 0.2)}),
            (("--base", "--x", "-1:1", "--sample", "6", "--seed", "4"),
             {"base": True, "x": (-1, 1), "sample": 6, "seed": 4}),
            (("--path", "--arm", "left", "--y", "-0.2:0.4:0.1"),
             {"path": True, "arm": "left", "y": (-0.2, 0.4, 0.1)}),
            (("--hold", "torso_joint_b1=-1:1:0.25", "--path", "--x", "0"),
             {"path": True, "hold": {"torso_joint_b1": (-1, 1, 0.25)}, "x": 0}),
            (("--object", "post", "--y", "-0.6:0:0.1", "--refine-grid"),
             {"object": "post", "y": (-0.6, 0, 0.1), "refine_grid": True}),
        ):
            wanted = self.table("place", *arguments)
            for threads in (1, 2):
                rows = swivel.place(cell, threads=threads, **keywords)
                self.assertEqual(self.saved(rows), wanted)
            self.assertTrue(0 < rows.solved.sum() < len(rows), rows)
            thing, moved = next(iter(keywords.items()))
            for row in rows:
                which = {key: keywords[key] for key in ("arm",) if key in keywords}
                plan = swivel.plan(
                    cell.placed(row.offset, hold=row.hold, **which, **{thing: moved})
                )
                self.assertEqual(plan.status, row.status)
                if row.solved:
                    self.assertEqual(plan.cost, row.cost)
        self.assertEqual(self.saved(swivel.place(self.file, **keywords)), wanted)

    def test_campaigns(self):
        cell = swivel.load(self.file)
        wanted = self.table("campaign", "--episodes", "8", "--seed", "2")
        for what, threads in ((cell, 1), (self.file, 2)):
            rows = swivel.campaign(what, episodes=8, seed=2, threads=threads)
            self.assertEqual(self.without_time(self.saved(rows)), self.without_time(wanted))
        self.assertTrue(0 < rows.solved.sum() < 8)
        for k, row in enumerate(rows):
            plan = swivel.plan(cell.episode(2, k))
            self.assertEqual(plan.status, row.status)
            self.assertEqual(plan.cost if plan.solved else None, row.cost)
            self.assertEqual(bool(row.reason), not row.solved)

    def test_pickled(self):
        cell = swivel.load(self.file)
        again = pickle.loads(pickle.dumps(cell))
        self.assertEqual(repr(again), repr(cell))
        self.assertEqual(again.source, cell.source)
        plan, other = swivel.plan(cell), swivel.plan(again)
        np.testing.assert_array_equal(
            plan.arms["left"].trajectory.joints, other.arms["left"].trajectory.joints
        )
        self.assertEqual(
            self.without_time(self.saved(swivel.campaign(again, episodes=3))),
            self.without_time(self.saved(swivel.campaign(cell, episodes=3))),
        )

    def test_refused(self):
        cell = swivel.load(self.file)
        with self.assertRaisesRegex(swivel.InvalidArgument, "'left': no such object"):
            swivel.place(cell, object="left", x=0.1)
        with self.assertRaisesRegex(swivel.InvalidArgument, "exactly one"):
            cell.placed([0.1, 0, 0, 0, 0, 0])
        with self.assertRaisesRegex(swivel.InvalidArgument, "unknown arm 'middle'"):
            swivel.place(cell, path=True, arm="middle", x=0.1)
        with self.assertRaisesRegex(swivel.InvalidArgument, "is planned"):
            swivel.place(cell, hold={"arm_right_joint_1_s": 0})
        with self.assertRaisesRegex(swivel.InputError, "vary: missing"):
            swivel.campaign(PLATE, episodes=2)


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[1:]])

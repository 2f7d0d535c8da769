# SPDX-License-Identifier: BSD-3-Clause
# Jobs in the Python package, as a user has it. Usage: job_test.py CASE; SWIVEL is the program,
# SWIVEL_DATA the data folder.
import copy
import functools
import json
import os
import pickle
import signal
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import numpy as np
import python_test
import swivel

PROGRAM, DATA = os.environ["SWIVEL"], Path(os.environ["SWIVEL_DATA"])
DOOR = DATA / "problems" / "door_job.yaml"
PATH = DATA / "problems" / "experiment_c.yaml"
PLATE = DATA / "problems" / "sda10f_plate_workcell.yaml"
HOME = [-0.6241, -1.2398, 0.7037, -0.7659, 0.8316, 1.8921, -0.3086]
COARSE = swivel.Resolution(ds=0.02, dphi=0.2)


def program(*arguments):
    return subprocess.run(
        [PROGRAM, *arguments, "--quiet"], check=True, capture_output=True, text=True
    ).stdout


def small(**members):
    """Two strokes on the door, from a home and back, with lines of approach and retract."""
    job = swivel.load(DOOR)
    job.strokes = job.strokes[:2]
    job.resolution = COARSE
    job.approach, job.retract = 0.02, [0, 0, -0.03]
    for name, value in members.items():
        setattr(job, name, value)
    return job


def with_strokes(job, strokes):
    job = copy.copy(job)
    job.strokes = strokes
    return job


def barred(**members):
    """A job whose second stroke is out of reach."""
    job = small(**members)
    job.strokes[1].waypoints = job.strokes[1].waypoints + [0, 2, 0, 0, 0, 0, 0]
    return job


def spoilt(part, row, by=0.01):
    """The part with one joint moved in one row."""
    rows = part.trajectory
    joints = rows.joints.copy()
    joints[row, 2] += by
    return swivel.Part(
        swivel.Trajectory(joints, rows.s, rows.phi, rows.branch, rows.joint_names), part.stroke,
        reversed=part.reversed
    )


class Jobs(unittest.TestCase):
    def test_the_program_gives_the_same_bits(self):
        with tempfile.TemporaryDirectory() as folder:
            rows, motion, out = (Path(folder) / f"{name}.csv" for name in ("rows", "motion", "out"))
            told = json.loads(program("plan", DOOR, "--out", rows, "--json", "-"))
            program("plan", DOOR, "--rate", "50", "--out", motion)
            plan = swivel.plan(DOOR, evidence=True)
            self.assertEqual(plan.to_csv(), rows.read_text())
            plan.save(out)
            self.assertEqual(out.read_bytes(), rows.read_bytes())
            timed = swivel.plan(swivel.load(DOOR), rate=50, planner="lazy")
            timed.motion.save(out)
            self.assertEqual(out.read_bytes(), motion.read_bytes())
        for name in (
            "cost", "bound", "bound_any", "bound_orders", "gap", "transition_counters",
            "joint_names"
        ):
            self.assertEqual(getattr(plan, name), told[name], name)
        self.assertEqual(str(plan.status), told["status"])
        self.assertEqual(
            [(run.stroke, run.reversed, run.cost, run.least_cost) for run in plan.runs],
            [(run["stroke"], run["reversed"], run["cost"], run["least_cost"])
             for run in told["runs"]],
        )
        self.assertEqual(len(plan.parts), len(told["parts"]))
        for part, other in zip(plan.parts, told["parts"]):
            self.assertEqual((part.stroke, part.cost), (other["stroke"], other["cost"]))
            self.assertEqual(part.joints.tolist(), [row["joints"] for row in other["rows"]])
            self.assertEqual(part.process.tolist(), [row["process"] for row in other["rows"]])
        mine = json.loads(plan.to_json())
        self.assertEqual(set(mine), set(told))
        for name in set(told) - {"time_ms", "threads", "checked"}:
            self.assertEqual(mine[name], told[name], name)

    def test_made_in_python(self):
        read = swivel.load(DOOR)
        robot = swivel.Robot(
            DATA / "robots" / "sda5f.urdf", DATA / "robots" / "sda5f.srdf", base="base_link",
            tip="arm_left_link_tool0", tool=swivel.pose([0, 0, 0.10]), hold={"torso_joint_b1": 0.0}
        )
        robot.attach(
            swivel.AttachedBody(
                "polisher", swivel.Capsule(0.025, 0.04), "arm_left_link_tool0", [0, 0, 0.048]
            )
        )
        files = [DATA / "paths" / f"door_stroke_{k}.csv" for k in range(6)]
        strokes = [
            swivel.Stroke(
                f"row_{k}", np.loadtxt(file, delimiter=",", skiprows=1), frame="door",
                smooth=read.strokes[k].smooth
            )
            for k, file in enumerate(files)
        ]
        job = swivel.Problem(
            robot, strokes, read.scene, home=HOME, process_speed=0.05, rapid=0.5,
            limits=swivel.Limits(clearance=0.005, tool_path_error=0.001)
        )
        for name in ("limits", "resolution", "cost", "refinement", "strokes", "order", "rapid",
                     "process_speed", "approach_speed"):
            self.assertEqual(getattr(job, name), getattr(read, name), name)
        np.testing.assert_array_equal(job.home, read.home)
        one, other = swivel.plan(job), swivel.plan(read)
        self.assertTrue(one.solved)
        self.assertEqual((one.cost, one.to_csv()), (other.cost, other.to_csv()))

    def test_what_is_none_is_as_the_job_says(self):
        job = small()
        own, plain = job.strokes
        own.limits = swivel.Limits(clearance=0.009)
        own.approach, own.retract, own.resolution = 0, 0, swivel.Resolution(ds=0.05, dphi=0.2)
        plan = swivel.plan(job, evidence=True)
        self.assertTrue(plan.solved, plan)
        first, second = (run.measures.min_margin.required for run in plan.runs)
        self.assertEqual((first, second), (0.009, 0.005))
        self.assertEqual([part.stroke for part in plan.parts], [None, "row_0", None, "row_1", None])
        self.assertTrue(plan.parts[1].process.all())
        process = plan.parts[3].process
        self.assertFalse(process[0] or process[-1])
        self.assertEqual(process.sum(), np.ptp(np.flatnonzero(process)) + 1)
        heights = plan.parts[3].trajectory.s[[np.argmax(process), -1]]
        self.assertAlmostEqual(heights[0], 0.02)
        along = np.linalg.norm(np.diff(plain.waypoints[:, :3], axis=0), axis=1).sum()
        self.assertAlmostEqual(heights[1], 0.02 + along + 0.03)
        self.assertTrue(swivel.check(job, plan))

    def test_a_stroke_ends_where_it_is_told(self):
        job, told = small(), small()
        job.resolution = swivel.Resolution(ds=0.05, dphi=0.13)
        end = swivel.plan(job).parts[1].joints[-1]
        told.strokes[0].end = end
        plan = swivel.plan(told)
        self.assertTrue(plan.solved, plan)
        np.testing.assert_allclose(plan.parts[1].joints[-1], end, rtol=0, atol=1e-9)
        self.assertTrue(swivel.check(told, plan))
        self.assertEqual(pickle.loads(pickle.dumps(told)).strokes[0], told.strokes[0])
        np.testing.assert_array_equal(told.strokes[0].end, end)
        told.strokes[0].end = end + 1e-5
        self.assertFalse(swivel.check(told, plan))
        told.strokes[0].reversible = True
        with self.assertRaisesRegex(ValueError, "end: allowed in strokes that are not reversible"):
            swivel.plan(told)

    def test_files_are_read_whole(self):
        text = DOOR.read_text().replace("../", f"{DATA}/")
        text = text.replace("rapid:", "approach: 0.02\nrapid:")
        text = text.replace("}}\n  - {name: row_2", "}, limits: {clearance: 0.008}, approach: 0.01,"
                            " reversible: true}\n  - {name: row_2")
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "job.yaml"
            file.write_text(text)
            job = swivel.load(file)
            self.assertEqual(job.source, str(file))
            plan = swivel.plan(job)
            self.assertEqual(plan.to_csv(), swivel.plan(file).to_csv())
        self.assertTrue(plan.solved)
        own, plain = job.strokes[1], job.strokes[2]
        self.assertEqual((own.limits.clearance, plain.limits), (0.008, None))
        self.assertEqual((own.reversible, plain.reversible), (True, False))
        self.assertEqual((own.approach[2], plain.approach[2]), (-0.01, -0.02))
        self.assertEqual((own.resolution, own.retract), (None, None))

    def test_either_way(self):
        job = swivel.load(DATA / "problems" / "iiwa14_bench_job.yaml")
        np.testing.assert_array_equal(job.approach, [0, 0, -0.05])
        self.assertEqual(job.strokes[0].approach, None)
        job.order, job.resolution = "best", COARSE
        plan = swivel.plan(job, rate=50)
        self.assertTrue(plan.solved)
        order = [(run.stroke, run.reversed) for run in plan.runs]
        self.assertEqual({name for name, _ in order}, {stroke.name for stroke in job.strokes})
        backwards = swivel.Problem(
            job.robot, [copy.copy(job.strokes[0])], job.scene, limits=job.limits, resolution=COARSE,
            approach=0.05, retract=0.05, process_speed=0.05
        )
        backwards.strokes[0].waypoints = backwards.strokes[0].waypoints[::-1]
        rows = swivel.plan(backwards).parts[0].trajectory
        for reversed, words in ((True, ""), (False, "row 0")):
            check = swivel.check(
                with_strokes(job, job.strokes[:1]),
                [swivel.Part(rows, job.strokes[0].name, reversed=reversed)],
            )
            self.assertEqual(bool(check), reversed, check)
            self.assertIn(words, "".join(check.failures))
        with tempfile.TemporaryDirectory() as folder:
            for name, what in (("rows", plan), ("motion", plan.motion)):
                what.save(Path(folder) / f"{name}.csv")
                self.assertTrue(swivel.check(job, Path(folder) / f"{name}.csv"), name)
            read = swivel.load_trajectory(Path(folder) / "rows.csv", problem=job)
        self.assertEqual([(p.stroke, p.reversed) for p in read if p.stroke], order)
        print(order)

    def test_jobs_change_in_place(self):
        job = small()
        job.strokes[0].reversible = True
        job.strokes[0].feed = np.full(len(job.strokes[0].waypoints), 0.04)
        job.limits.clearance = 0.006
        job.order = "best"
        for other in (copy.copy(job), copy.deepcopy(job), pickle.loads(pickle.dumps(job))):
            self.assertEqual(other.strokes, job.strokes)
            other.strokes[0].name = "other"
            other.strokes.pop()
            other.limits.clearance = 9
            other.scene.remove("door")
        self.assertEqual([stroke.name for stroke in job.strokes], ["row_0", "row_1"])
        self.assertEqual((job.limits.clearance, job.order), (0.006, swivel.StrokeOrder.BEST))
        self.assertTrue(job.strokes[0].reversible)
        np.testing.assert_array_equal(job.approach, [0, 0, -0.02])
        job.strokes[0].approach = [0.01, 0, -0.01]
        np.testing.assert_array_equal(job.strokes[0].approach, [0.01, 0, -0.01])
        job.strokes.append(copy.copy(job.strokes[0]))
        with self.assertRaisesRegex(swivel.InvalidArgument, "name 'row_0' is taken"):
            job.validate()

    def test_one_path_is_planned_as_a_stroke_of_its_own(self):
        for name in ("experiment_c", "ur5e_deburr_edge", "kr6_weld_pipe"):
            file = DATA / "problems" / f"{name}.yaml"
            path = swivel.load(file)
            stroke = swivel.Stroke(
                "path", path.waypoints, frame=path.frame, smooth=path.smooth, end=path.end
            )
            job = swivel.Problem(
                path.robot, [stroke], path.scene, limits=path.limits, resolution=path.resolution,
                cost=path.cost
            )
            self.assertEqual([stroke.name for stroke in job.strokes], ["path"])
            (part,) = swivel.plan(job).parts
            self.assertEqual(part.stroke, "path")
            np.testing.assert_allclose(part.joints, swivel.plan(file).joints, rtol=0, atol=1e-14)


class JobMotions(unittest.TestCase):
    def setUp(self):
        self.job = small()

    def test_motion(self):
        plan = swivel.plan(self.job, speed=0.1, rate=125)
        motion = plan.motion
        self.assertTrue(motion.executable, motion)
        self.assertEqual(motion.joints.shape, (len(motion), 7))
        self.assertEqual(motion.joints.shape, motion.velocities.shape)
        self.assertEqual(motion.accelerations.shape, motion.velocities.shape)
        self.assertAlmostEqual(motion.t[1] - motion.t[0], 1 / 125)
        self.assertEqual(
            [(event.stroke, event.on) for event in motion.events],
            [("row_0", True), ("row_0", False), ("row_1", True), ("row_1", False)],
        )
        self.assertEqual(set(motion.part), set(range(len(plan.parts))))
        for on, off in zip(motion.events[::2], motion.events[1::2]):
            self.assertLess(on.t, off.t)
            self.assertTrue(0.02 - 1e-9 <= on.s < 0.02 + 0.1 / 125)
            self.assertTrue(motion.process[(motion.t >= on.t) & (motion.t < off.t)].all())
        count = sum(
            ((motion.t >= on.t) & (motion.t < off.t)).sum()
            for on, off in zip(motion.events[::2], motion.events[1::2])
        )
        self.assertEqual(motion.process.sum(), count)
        self.assertTrue(swivel.check(self.job, motion, speed=0.1))
        faster = swivel.check(self.job, motion)  # than the job's process_speed, 0.05
        self.assertFalse(faster)
        self.assertRegex(faster.failures[0], r"^stroke 'row_0': rows \d+-\d+: the tool moves at 0.")
        with self.assertRaisesRegex(ValueError, "speed: not a positive number"):
            swivel.check(self.job, motion, speed=0)
        self.assertTrue(swivel.check(self.job, plan))  # whose rows follow rounded corners
        np.testing.assert_array_equal(motion.joints[0], np.array(HOME))
        with tempfile.TemporaryDirectory() as folder:
            for ending in ("csv", "json", "yaml", "mcap"):
                motion.save(Path(folder) / f"m.{ending}")
                self.assertGreater((Path(folder) / f"m.{ending}").stat().st_size, 1000)
            read = swivel.load_trajectory(Path(folder) / "m.csv", problem=self.job)
            for member in ("t", "joints", "velocities", "accelerations", "part", "process"):
                np.testing.assert_array_equal(getattr(read, member), getattr(motion, member))
            self.assertEqual(
                [(e.t, e.stroke, e.on) for e in read.events],
                [(e.t, e.stroke, e.on) for e in motion.events],
            )
            self.assertTrue(swivel.check(self.job, Path(folder) / "m.csv", speed=0.1))
            again = swivel.time(self.job, Path(folder) / "m.csv", speed=0.1)
            for ending in ("json", "yaml", "mcap"):  # what they do not state is worked out
                file = Path(folder) / f"m.{ending}"
                other = swivel.load_trajectory(file, problem=self.job)
                for member in ("t", "joints", "velocities", "part", "process"):
                    np.testing.assert_allclose(
                        getattr(other, member), getattr(motion, member), atol=1e-9
                    )
                self.assertTrue(swivel.check(self.job, other, speed=0.1))
                self.assertTrue(swivel.check(self.job, file, speed=0.1))
                timed = swivel.time(self.job, file, speed=0.1)
                np.testing.assert_allclose(timed.joints, again.joints, atol=1e-6)
            with self.assertRaisesRegex(swivel.InputError, "unknown format"):
                motion.save(Path(folder) / "m.txt")
        # A job with its strokes in another list is another order.
        turned = small(strokes=self.job.strokes[::-1])
        self.assertIn("given order", swivel.check(turned, motion).failures[0])
        turned.order = "best"
        self.assertTrue(swivel.check(turned, motion, speed=0.1))

    def test_time(self):
        plan = swivel.plan(self.job)
        self.assertIsNone(plan.motion)
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "rows.csv"
            plan.save(file)
            motions = [
                swivel.time(self.job, rows, rate=50)
                for rows in (plan, plan.parts, file)
            ]
        for motion in motions:
            if motion.executable:
                self.assertTrue(swivel.check(self.job, motion))
            else:  # since motions keep more clearance than rows do
                self.assertIn("come", motion.reason)
            self.assertEqual(repr(motion), repr(motions[0]))
        print(motions[0])
        timed = swivel.plan(self.job, speed=0.1)
        slower = swivel.time(self.job, timed, speed=0.05)
        self.assertTrue(swivel.check(self.job, slower))
        self.assertGreater(slower.duration, timed.motion.duration)
        with self.assertRaises(TimeoutError):
            swivel.time(self.job, plan, speed=0.1, timeout=1e-6)
        bad = [plan.parts[0], spoilt(plan.parts[1], 3), *plan.parts[2:]]
        with self.assertRaisesRegex(swivel.InputError, r"row 3.*a job that passes `swivel check`$"):
            swivel.time(self.job, bad, speed=0.1)

    def test_refined(self):
        """Refined jobs cost less, in plans and motions; each run says what refining brought."""
        plain, refined = swivel.plan(self.job), swivel.plan(self.job, refine=True)
        self.assertEqual([run.refinement for run in plain.runs], [None, None])
        self.assertLess(refined.cost, plain.cost)
        for run in refined.runs:
            self.assertTrue(run.refinement.refined)
            self.assertLess(run.refinement.cost, run.refinement.cost_before)
            self.assertAlmostEqual(run.refinement.cost, run.cost)
        for part, before in zip(refined.parts, plain.parts, strict=True):
            if part.stroke is None:
                np.testing.assert_array_equal(part.joints, before.joints)
            else:
                np.testing.assert_array_equal(part.joints[[0, -1]], before.joints[[0, -1]])
        self.assertTrue(swivel.check(self.job, refined))
        self.assertIn("| refined: cost ", repr(refined))
        with self.assertRaisesRegex(AttributeError, "^refinement: of one path"):
            refined.refinement
        timed = swivel.plan(self.job, speed=0.1, refine=True, chord=1e-5)
        self.assertTrue(timed.motion.executable, timed)
        self.assertEqual([one.refined for one in timed.motion.refinements], [True, True])
        self.assertTrue(swivel.check(self.job, timed.motion, speed=0.1))
        again = swivel.time(self.job, timed, speed=0.05, refine=True)
        self.assertEqual(len(again.refinements), 2)
        self.assertTrue(swivel.check(self.job, again))
        copied = pickle.loads(pickle.dumps(refined))
        self.assertEqual(
            [run.refinement.cost for run in copied.runs],
            [run.refinement.cost for run in refined.runs],
        )
        cell = swivel.plan(PLATE, refine=True, speed=0.05)
        self.assertEqual(len(cell.motion.refinements), 2)
        self.assertEqual(len(cell.motion.arms["left"].refinements), 1)

    def test_own_functions(self):
        """A check holds along strokes and transitions; a cost counts at the rows of strokes."""
        free, asked, solved = swivel.plan(self.job), [], 0
        for joint in range(7):
            most = max(part.joints[:, joint].max() for part in free.parts) - 0.02

            def low(joints, joint=joint, most=most):
                asked.append(len(joints))
                return joints[:, joint] < most

            plans = [
                swivel.plan(self.job, check=low, planner=planner)
                for planner in ("lazy", "parallel")
            ]
            self.assertEqual(plans[0].cost, plans[1].cost)
            if not plans[0].solved:
                continue
            solved += 1
            self.assertGreater(plans[0].cost, free.cost)
            for part in plans[0].parts:
                self.assertLess(part.joints[:, joint].max(), most)
        print(solved, "of 7 rules kept,", sum(asked), "states asked about")
        self.assertGreaterEqual(solved, 2)
        self.assertGreater(sum(asked), 100)
        costly = swivel.plan(self.job, cost=lambda q: 0.01 * (q**2).sum(axis=1))
        rows = sum(
            0.01 * (part.joints**2).sum() for part in costly.parts if part.stroke is not None
        )
        moves = sum(
            np.linalg.norm(np.diff(part.joints, axis=0), axis=1).sum() for part in costly.parts
        )
        self.assertAlmostEqual(costly.cost, rows + moves, 5)
        none = swivel.plan(self.job, check=lambda joints: np.zeros(len(joints), bool))
        self.assertEqual(none.status, swivel.Status.INFEASIBLE)

    def test_planners_plan_again(self):
        """Plans of a planner after changes are those of a new one, bit for bit."""
        planner = swivel.Planner(self.job)
        self.assertIn("strokes", repr(planner))
        planner.prepare()

        def move(by):
            pose = planner.problem.scene["door"].pose
            pose[0, 3] += by
            planner.move("door", pose)

        ball = swivel.SceneObject("ball", swivel.Sphere(0.05), swivel.pose([0.4, 0.6, 0.4]))
        changes = {
            "as it is": lambda: None,
            "moved": lambda: move(0.01),
            "ball": lambda: planner.add(ball),
            "without": lambda: planner.remove("ball"),
            "without home": lambda: planner.set_problem(small(home=None)),
            "two arms": lambda: planner.set_problem(swivel.load(PLATE)),
            "ball beside two arms": lambda: planner.add(ball),
            "one path": lambda: planner.set_problem(swivel.load(PATH)),
            "strokes again": lambda: planner.set_problem(self.job),
        }
        solved = 0
        for what, change in changes.items():
            change()
            for keywords in ({}, {"refine": True}):
                found = planner.plan(**keywords)
                fresh = swivel.plan(planner.problem, **keywords)
                self.assertEqual(found.to_json().split('"time_ms"')[0].split('"counters"')[0],
                                 fresh.to_json().split('"time_ms"')[0].split('"counters"')[0], what)
                self.assertEqual(found.status, fresh.status, what)
                if found.solved:
                    self.assertEqual(found.to_csv(), fresh.to_csv(), what)
                    solved += 1
        self.assertGreaterEqual(solved, 12)
        other = planner.clone()
        self.assertEqual(other.plan().cost, planner.plan().cost)
        with self.assertRaisesRegex(swivel.InvalidArgument, "'gate': no such object"):
            planner.move("gate", np.eye(4))
        with self.assertRaisesRegex(swivel.InvalidArgument, "this planner is of a problem with"):
            planner.clearance(np.zeros((1, 7)))
        barred_planner = swivel.Planner(barred())
        answer = barred_planner.plan()
        self.assertFalse(answer.solved)
        advice = barred_planner.advise(answer, timeout=2)
        self.assertIsInstance(advice, swivel.AdviceList)

    def test_not_executable(self):
        # With rows as dense as those of transitions there is no clearance to spare between them.
        job = swivel.load(DOOR)
        job.scene = swivel.load(DATA / "problems" / "experiment_c.yaml").episode(1, 3).scene
        motion = swivel.time(job, swivel.plan(job), rate=50)
        self.assertFalse(motion.executable)
        self.assertRegex(motion.reason, "transition .*: rows .* come closer than 5.000 mm")
        self.assertEqual((motion.at_part, motion.at_s, len(motion)), (None, None, 0))
        self.assertEqual((motion.joints.shape, motion.process.shape), ((0, 7), (0, )))
        with self.assertRaisesRegex(ValueError, "not executable: transition .*: rows "):
            print(motion.duration)
        # The joints of this path jump at a singular pose.
        path = swivel.load(DATA / "problems" / "experiment_c.yaml").episode(1, 153)
        motion = swivel.time(path, swivel.plan(path), speed=0.1)
        self.assertFalse(motion.executable)
        self.assertRegex(motion.reason, "the joints would have to jump")
        self.assertGreater(motion.at_s, 0)


class JobChecks(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.job = small()
        cls.plan = swivel.plan(cls.job)

    def test_spoilt_rows(self):
        parts = self.plan.parts
        check = swivel.check(self.job, parts)
        self.assertTrue(check.passed, check)
        self.assertEqual(len(check.runs), 2)
        self.assertAlmostEqual(check.cost, self.plan.cost, places=9)
        self.assertLess(check.runs[0].worst_position, 1e-6)
        check = swivel.check(self.job, [spoilt(parts[0], 0), *parts[1:]])
        self.assertIn("transition to 'row_0': begins", check.failures[0])
        check = swivel.check(self.job, [parts[0], spoilt(parts[1], 3), *parts[2:]])
        self.assertFalse(check)
        self.assertIn("stroke 'row_0': row 3", check.failures[0])
        self.assertIn("failed", repr(check))
        self.assertIn("parts: allowed are", swivel.check(self.job, parts[1:]).failures[0])
        self.assertFalse(swivel.check(self.job, []))

    def test_files(self):
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "rows.csv"
            self.plan.save(file)
            self.assertTrue(swivel.check(self.job, file))
            read = swivel.load_trajectory(file, problem=self.job)
            for part, other in zip(read, self.plan.parts):
                self.assertEqual((part.stroke, part.reversed), (other.stroke, other.reversed))
                np.testing.assert_array_equal(part.joints, other.joints)
                np.testing.assert_array_equal(part.process, other.process)
            lines = file.read_text().splitlines()
            row = next(k for k, line in enumerate(lines) if line.endswith(",row_0,1"))
            lines[row] = lines[row][:-1] + "0"
            file.write_text("\n".join(lines) + "\n")
            check = swivel.check(self.job, file)
            self.assertIn(": process is 0: allowed is 1", check.failures[0])
            self.job.strokes[0].name, before = "other", self.job.strokes[0].name
            with self.assertRaisesRegex(swivel.InputError, "rows.csv:4: .*'row_0' is no stroke"):
                swivel.check(self.job, file)
            self.job.strokes[0].name = before

    def test_parts_by_hand(self):
        made = [
            swivel.Part(part.joints if part.stroke is None else part.trajectory, part.stroke)
            for part in self.plan.parts
        ]
        self.assertIsNone(made[0].process)
        self.assertTrue(swivel.check(self.job, made))
        with self.assertRaisesRegex(swivel.InvalidArgument, "'row_7' is no stroke.*nearest is"):
            swivel.check(self.job, [swivel.Part(made[1].trajectory, "row_7")])
        with self.assertRaisesRegex(ValueError, "of a stroke allowed is a Trajectory"):
            swivel.Part(made[1].joints, "row_0")


class JobAnswers(unittest.TestCase):
    def test_advice(self):
        job = barred()
        plan = swivel.plan(job)
        advice = swivel.advise(job, plan, timeout=30)
        self.assertEqual(
            (advice[0].change, advice[0].strokes, advice[0].outcome),
            (swivel.Change.WITHOUT_STROKES, ["row_1"], swivel.Outcome.SOLVED)
        )
        self.assertEqual(list(advice.alone), ["row_1"])
        self.assertIn("would help: stroke 'row_1' left out", str(advice))
        self.assertEqual(advice[0].cost, swivel.plan(with_strokes(job, job.strokes[:1])).cost)
        with self.assertRaisesRegex(swivel.InvalidArgument, "is of another problem"):
            swivel.advise(DATA / "problems" / "experiment_c.yaml", plan)

    def test_words_of_paths_are_refused(self):
        plan = swivel.plan(small())
        for word in ("trajectory", "joints", "partial", "measures", "diagnosis", "lattice"):
            with self.assertRaisesRegex(AttributeError, f"^{word}: of one path: allowed without"):
                getattr(plan, word)
        self.assertEqual(list(plan.arms), [""])
        self.assertEqual(len(plan.arms[""].parts), len(plan.parts))
        path = swivel.plan(DATA / "problems" / "experiment_c.yaml", speed=0.1)
        self.assertEqual([part.stroke for part in path.parts], [""])
        np.testing.assert_array_equal(path.parts[0].joints, path.joints)
        self.assertEqual((path.runs[0].cost, path.gap, path.bound), (path.cost, 0, path.bound_any))
        for word in ("lift_offs", "no_transition", "transition_counters", "conflict"):
            with self.assertRaisesRegex(AttributeError, f"^{word}: is of a"):
                getattr(path, word)
        for word in ("part", "process", "events"):
            self.assertFalse(hasattr(path.motion, word))

    def test_no_job(self):
        plan = swivel.plan(barred())
        self.assertEqual(plan.status, "infeasible")
        self.assertEqual((plan.cost, plan.gap, plan.parts), (None, None, []))
        self.assertEqual(plan.runs[1].diagnosis.cause.kind, "reach")
        self.assertIsNone(plan.runs[0].diagnosis)
        self.assertRegex(repr(plan), "no job: 1 of 2 strokes has no path by itself; .*'row_1'.*: ")
        with self.assertRaisesRegex(ValueError, "there are no rows: the answer is 'infeasible'"):
            plan.to_csv()
        self.assertEqual(json.loads(plan.to_json())["status"], "infeasible")
        job = small()
        job.scene.add("wall", swivel.Sphere(0.2), job.tool_pose(job.home))
        plan = swivel.plan(job)
        self.assertEqual(plan.barred_where, "home", plan)
        self.assertIn("wall", plan.barred_by)
        self.assertRegex(repr(plan), "at home .*wall come nearer")
        stopped = swivel.plan(DOOR, timeout=1e-3)
        self.assertEqual(stopped.status, "timeout")

    def test_words(self):
        job = small()
        plan = swivel.plan(job, speed=0.1)
        for thing, words in (
            (job, "2 strokes"),
            (job.strokes[0], "Stroke 'row_0': .* waypoints in 'door'"),
            (plan, "solved: 2 strokes, cost .* motion: .* samples"),
            (plan.parts[0], "transition: 2 rows, cost"),
            (plan.parts[1], "stroke 'row_0': .* rows, cost"),
            (plan.runs[0], "stroke 'row_0': solved, at least"),
            (plan.motion, "2 strokes, .* Hz"),
            (plan.motion.events[0], "on at t = .*'row_0'"),
            (swivel.check(job, plan), "passed: cost .*, 2 runs"),
        ):
            self.assertRegex(repr(thing), words)
            self.assertNotIn("\n", repr(thing))

    def test_ctrl_c_stops_a_plan(self):
        job, calls = swivel.load(DOOR), []
        job.resolution = swivel.Resolution(ds=0.001, dphi=0.002)

        def progress(*_):
            calls.append(None)
            if len(calls) == 3:
                os.kill(os.getpid(), signal.SIGINT)

        with self.assertRaises(KeyboardInterrupt):
            swivel.plan(job, progress=progress)

    def test_pickles(self):
        compare = python_test.Pickles("test_parts")
        compare.setUp()
        job = small()
        plan = swivel.plan(job, speed=0.1, evidence=True)
        for thing in (job, job.strokes[0], plan, plan.motion, swivel.check(job, plan),
                      swivel.plan(barred()), swivel.StrokeOrder.BEST):
            compare.through(thing)
        again = pickle.loads(pickle.dumps(plan))
        self.assertEqual(again.to_csv(), plan.to_csv())
        self.assertEqual(again.to_json(), plan.to_json())
        self.assertTrue(swivel.check(pickle.loads(pickle.dumps(job)), again.motion, speed=0.1))
        print(compare.count, "values compared")
        self.assertGreater(compare.count, 500)
        # An answer holds neither robot nor scene.
        self.assertLess(len(pickle.dumps(plan.parts)), len(pickle.dumps(job)))


class JobStudies(unittest.TestCase):
    """Campaigns and placements of jobs."""

    QUICK = ("--ds", "0.02", "--dphi", "0.1")
    GRID = {"base": True, "x": (-0.1, 0.1, 0.1), "y": (0, 0.1, 0.1)}

    @staticmethod
    def job():
        job = swivel.load(DOOR)
        job.resolution = swivel.Resolution(ds=0.02, dphi=0.1)
        return job

    def table(self, command, *arguments):
        with tempfile.TemporaryDirectory() as folder:
            out = Path(folder) / "out.csv"
            done = subprocess.run(
                [PROGRAM, command, DOOR, *arguments, "--out", out], capture_output=True, text=True
            )
            self.assertIn(done.returncode, (0, 1), done.stderr)
            return out.read_text()

    def saved(self, table):
        with tempfile.TemporaryDirectory() as folder:
            table.save(Path(folder) / "out.csv")
            return (Path(folder) / "out.csv").read_text()

    @staticmethod
    def without_time(text):
        return [[*line.split(",")[:3], *line.split(",")[4:]] for line in text.splitlines()]

    def test_campaigns(self):
        job = self.job()
        wanted = self.table("campaign", *self.QUICK, "--episodes", "6", "--seed", "2")
        for threads in (1, 2):
            rows = swivel.campaign(job, episodes=6, seed=2, threads=threads)
            self.assertEqual(self.without_time(self.saved(rows)), self.without_time(wanted))
        self.assertTrue(0 < rows.solved.sum() < 6)
        self.assertEqual(rows.episode.tolist(), list(range(6)))
        for k, row in enumerate(rows):
            plan = swivel.plan(job.episode(2, k))
            self.assertEqual((plan.status, plan.cost), (row.status, row.cost))
            self.assertEqual(bool(row.reason), not row.solved)

    def test_placements(self):
        job = self.job()
        for arguments, keywords in (
            (("--base", "--x", "-0.1:0.1:0.1", "--y", "0:0.1:0.1"), self.GRID),
            (("--path", "--z", "-0.05:0.05", "--sample", "3", "--seed", "4"),
             {"path": True, "z": (-0.05, 0.05), "sample": 3, "seed": 4}),
            (("--object", "post", "--x", "-0.4:0.4:0.1", "--refine-grid"),
             {"object": "post", "x": (-0.4, 0.4, 0.1), "refine_grid": True}),
        ):
            wanted = self.table("place", *self.QUICK, *arguments)
            for threads in (1, 2):
                rows = swivel.place(job, threads=threads, **keywords)
                self.assertEqual(self.saved(rows), wanted)
        rows = swivel.place(job, **self.GRID)
        self.assertTrue(0 < rows.solved.sum() < len(rows))
        for row in rows:
            plan = swivel.plan(job.placed(row.offset, base=True), evidence=True)
            self.assertEqual((plan.status, plan.cost), (row.status, row.cost))
            if row.solved:
                self.assertEqual(
                    row.clearance_margin, min(run.measures.min_margin.margin for run in plan.runs)
                )

    def test_files(self):
        self.assertEqual(
            self.without_time(self.saved(swivel.campaign(DOOR, episodes=2, seed=3))),
            self.without_time(self.table("campaign", "--episodes", "2", "--seed", "3")),
        )
        self.assertEqual(
            self.saved(swivel.place(str(DOOR), object="post", x=0.02)),
            self.table("place", "--object", "post", "--x", "0.02"),
        )

    def test_progress(self):
        seen = []
        rows = swivel.place(
            self.job(), **self.GRID,
            progress=lambda part, done, of: seen.append((part[0].cell, done, of))
        )
        self.assertEqual(sorted(cell for cell, _, _ in seen), rows.cell.tolist())
        self.assertEqual([(done, of) for _, done, of in seen], [(k + 1, 6) for k in range(6)])
        seen.clear()
        swivel.campaign(
            self.job(), episodes=3,
            progress=lambda part, done, of: seen.append((part[0].episode, done, of))
        )
        self.assertEqual(seen, [(k, k + 1, 3) for k in range(3)])

    def test_timeout_and_ctrl_c(self):
        many = {"base": True, "x": (-0.1, 0.1, 0.001), "y": (-0.1, 0.1, 0.001)}
        seen = []
        rows = swivel.place(
            self.job(), timeout=1, progress=lambda part, *_: seen.append(part[0].cell), **many
        )
        self.assertTrue(0 < len(rows) < 201 * 201)
        self.assertEqual(rows.cell.tolist(), sorted(seen))

        def interrupt(*_):
            os.kill(os.getpid(), signal.SIGINT)

        for work in (
            lambda: swivel.place(self.job(), progress=interrupt, **many),
            lambda: swivel.campaign(self.job(), episodes=100000, progress=interrupt),
        ):
            with self.assertRaises(KeyboardInterrupt):
                work()

    def test_workers_plan_what_was_pickled(self):
        # What a worker of a Dask cluster does with the recipe that it gets, without Dask.
        job = self.job()
        rows = swivel.campaign(job, episodes=4, seed=2)
        make = functools.partial(swivel._swivel._Campaigner, job, 4, 2, "parallel", 1, True)
        planners = pickle.loads(pickle.dumps(swivel.runs._Planners(make)))
        parts = [
            planners.plan(swivel.runs._plan_episodes, (index, 2)) for index in reversed(range(2))
        ]
        joined = swivel.Episodes._joined(parts)
        self.assertEqual(
            self.without_time(self.saved(joined)), self.without_time(self.saved(rows))
        )

    def test_refused(self):
        job = self.job()
        still = swivel.Problem(job.robot, job.strokes, job.scene)
        for message, function, of, keywords in (
            ("exactly one", swivel.place, job, {"x": 0}),
            ("'poste'", swivel.place, job, {"object": "poste", "x": 0}),
            ("step", swivel.place, job, {"base": True, "x": (0, 1)}),
            ("episodes: 0", swivel.campaign, job, {"episodes": 0}),
            ("vary", swivel.campaign, still, {}),
            ("rapid: allowed", swivel.campaign, small(rapid=2.0), {}),
            ("exactly one", job.placed, np.zeros(6), {}),
            ("nowhere", swivel.campaign, "nowhere.yaml", {}),
        ):
            with self.subTest(message), self.assertRaisesRegex(ValueError, message) as caught:
                function(of, **keywords)
            self.assertNotIn("\n", str(caught.exception))
        for wrong in (None, 3, job.robot, [job]):
            for study in (lambda of: swivel.place(of, base=True, x=0), swivel.campaign):
                with self.assertRaisesRegex(
                    TypeError, "allowed are a Problem, or its file"
                ):
                    study(wrong)


RING = DATA / "problems" / "iiwa14_ring_job.yaml"


def ring(**members):
    """A ring of one and a half turns, at a coarse resolution, in two runs."""
    job = swivel.load(RING)
    job.resolution = swivel.Resolution(ds=0.02, dphi=0.2)
    job.limits.tool_path_error = 0.005
    for stroke in job.strokes:
        stroke.limits = None
    for name, value in members.items():
        setattr(job, name, value)
    return job


class JobLiftOffs(unittest.TestCase):
    """Strokes that no single run finishes."""

    def test_the_program_gives_the_same_bits(self):
        plan = swivel.plan(RING)
        self.assertEqual([part.stroke for part in plan.parts if part.stroke], ["ring/1", "ring/2"])
        with tempfile.TemporaryDirectory() as folder:
            own, other = Path(folder) / "own.csv", Path(folder) / "other.csv"
            plan.save(own)
            done = json.loads(program("plan", str(RING), "--out", str(other), "--json", "-"))
            self.assertEqual(own.read_text(), other.read_text())
            (place,), (said,) = plan.lift_offs, done["lift_offs"]
            self.assertEqual((place.stroke, place.end), ("ring", said["s"]))
            self.assertEqual(place.resumed, said["resumed_s"])
            self.assertIn("lift-off", repr(plan))
            self.assertIn("of 'ring': ends at s = ", repr(place))
            # Files are read with their runs, and prove the job.
            parts = swivel.load_trajectory(own, problem=RING)
            self.assertEqual([part.begin for part in parts], [part.begin for part in plan.parts])
            self.assertTrue(swivel.check(RING, own))

    def test_plans_are_checked_and_timed(self):
        job = ring()
        self.assertEqual((job.lift.cost, job.lift.overlap), (1, 0.01))
        plan = swivel.plan(job)
        self.assertEqual(len(plan.lift_offs), 1)
        (lift,) = plan.lift_offs
        self.assertLessEqual(lift.resumed, lift.end - 0.01 + 1e-9)
        self.assertLessEqual(lift.end, lift.reached + 1e-9)
        first, second = (part for part in plan.parts if part.stroke)  # s of rows is the same
        at = [[s for s, on in zip(run.begin + run.trajectory.s, run.process) if on]
              for run in (first, second)]
        self.assertAlmostEqual(at[0][-1], lift.end, 9)
        self.assertAlmostEqual(at[1][0], lift.resumed, 9)
        self.assertTrue(swivel.check(job, plan), plan)
        self.assertTrue(swivel.check(job, plan.parts))
        motion = swivel.time(job, plan.parts, speed=0.05)
        self.assertTrue(motion.executable, motion)
        self.assertTrue(swivel.check(job, motion))
        timed = swivel.plan(job, speed=0.05)
        self.assertTrue(swivel.check(job, timed.motion))
        self.assertEqual(len(timed.motion.events), 4)
        copy_of = pickle.loads(pickle.dumps(plan))
        self.assertEqual(repr(copy_of.lift_offs), repr(plan.lift_offs))
        self.assertTrue(swivel.check(pickle.loads(pickle.dumps(job)), copy_of))

    def test_what_is_left_out_is_found(self):
        job = ring()
        parts = swivel.plan(job).parts
        first, move, second = parts
        late = swivel.Part(second.trajectory, "ring/2", begin=second.begin + 0.03)
        with self.assertRaisesRegex(swivel.InvalidArgument, "'ring/2': begins at s = .* at most"):
            swivel.check(job, [first, move, late])
        wrong = swivel.Part(second.trajectory, "ring/3", begin=second.begin)
        with self.assertRaisesRegex(swivel.InvalidArgument, "'ring/3': allowed is 'ring/2'"):
            swivel.check(job, [first, move, wrong])
        for job, rows in ((job, [first]), (ring(lift=None), parts)):
            with self.assertRaisesRegex(swivel.InvalidArgument, "'ring/1' is no stroke"):
                swivel.check(job, rows)

    def test_where_it_is_not_allowed(self):
        plan = swivel.plan(ring(lift=None))
        self.assertFalse(plan.solved)
        self.assertEqual(plan.lift_offs, [])
        with self.assertRaisesRegex(swivel.InvalidArgument, "lift: cost, overlap"):
            ring(lift=swivel.LiftOffs(cost=-1)).validate()


class JobErrors(unittest.TestCase):
    def raises(self, error, message, function, *arguments, **keywords):
        with self.assertRaisesRegex(error, message) as caught:
            function(*arguments, **keywords)
        self.assertNotIn("\n", str(caught.exception))

    def test_problems_are_no_jobs(self):
        for function in (swivel.measure, swivel.refine):
            self.raises(swivel.InvalidArgument, "a problem with strokes: .* of one path",
                        function, swivel.load(DOOR), None)
        self.raises(swivel.InvalidArgument, "this planner is of a problem with strokes or two arms",
                    swivel.Planner(swivel.load(DOOR)).set_task, swivel.load(PATH).task)
        self.raises(swivel.InvalidArgument, "stretch: a problem with strokes",
                    swivel.load(DOOR).stretch, 0.1)
        job = swivel.load(DOOR)
        for word in ("waypoints", "start", "task", "closed"):
            self.raises(AttributeError, f"{word}: of a problem of strokes: .* one path", getattr,
                        job, word)
        self.raises(AttributeError, "waypoints: of a problem of strokes", setattr, job,
                    "waypoints", np.zeros((2, 7)))
        path = swivel.load(DATA / "problems" / "experiment_c.yaml")
        self.raises(AttributeError, "home: of a problem of one path: allowed with strokes",
                    setattr, path, "home", HOME)
        self.assertFalse(hasattr(path, "strokes"))
        self.assertEqual(list(path.arms), [""])
        self.assertEqual(path.arms[""].source, path.source)
        for wrong in (None, 3):
            self.raises(TypeError, "allowed are a Problem, or its file", swivel.plan, wrong)

    def test_values(self):
        job = small()
        stroke = job.strokes[0]
        for message, function, arguments, keywords in (
            ("order|StrokeOrder: 'any': allowed are given, best", setattr, (job, "order", "any"),
             {}),
            ("approach: allowed is a number from 0 on", setattr, (job, "approach", -0.1), {}),
            ("retract: allowed is a number from 0 on", setattr, (stroke, "retract", [1, 2]), {}),
            ("approach: allowed", setattr, (stroke, "approach", "up"), {}),
            (r"home of shape \(2,\): allowed is \(7,\)", setattr, (job, "home", [1, 2]), {}),
            ("feed: allowed is one number", setattr, (stroke, "feed", [[1, 2]]), {}),
            ("speed: not a positive number", swivel.plan, (job,), {"speed": 0}),
            ("turn_speed: not a positive", swivel.plan, (job,), {"turn_speed": -1}),
            ("rate: allowed", swivel.plan, (job,), {"rate": 0}),
            ("timeout: not a positive", swivel.plan, (job,), {"timeout": 0}),
            ("threads: -1", swivel.plan, (job,), {"threads": -1}),
        ):
            self.raises(ValueError, message, function, *arguments, **keywords)
        self.raises(TypeError, "progress: not callable", swivel.plan, job, progress=3)
        self.raises(TypeError, r"strokes\[0\]: str: allowed are Strokes", swivel.Problem, job.robot,
                    ["a"])
        self.raises(swivel.InputError, "nowhere", swivel.plan, "nowhere.yaml")

    def test_what_no_job_may_have(self):
        for members, words in (
            ({"feed": [0.1]}, "stroke 'row_0': feed: allowed is one for each waypoint"),
            ({"process_speed": -1.0}, "stroke 'row_0': process_speed"),
            ({"name": ""}, "name: allowed are non-empty names"),
            ({"frame": "doar"}, "doar"),
        ):
            job = small()
            for name, value in members.items():
                setattr(job.strokes[0], name, value)
            self.raises(ValueError, words, swivel.plan, job)
        for members, words in (
            ({"rapid": 2.0}, "rapid: allowed"),
            ({"strokes": []}, "strokes: allowed is at least one"),
            ({"home": [float("nan")] * 7}, "home: allowed are finite numbers"),
        ):
            self.raises(swivel.InvalidArgument, words, small(**members).validate)
        job = small(process_speed=None)
        self.raises(swivel.InputError, "stroke 'row_0' has no speed", swivel.plan, job, rate=50)


if __name__ == "__main__":
    unittest.main(argv=["job_test"] + sys.argv[1:], verbosity=1)

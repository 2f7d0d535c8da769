# SPDX-License-Identifier: BSD-3-Clause
# Arms of six joints whose tool stands as the waypoints have it: six numbers everywhere. Usage:
# six_joints_test.py CASE; SWIVEL_DATA is the data folder.
import os
import pickle
import tempfile
import unittest
from pathlib import Path

import numpy as np

import swivel

DATA = Path(os.environ["SWIVEL_DATA"])
PROBLEMS, ROBOTS = DATA / "problems", DATA / "robots"
START = [0.0862206377422805, -1.039143829498222, 1.9462897904540333, -4.048738614545604,
         0.21377936225771943, 3.3415926535897933]


def ur5e():
    return swivel.Robot(ROBOTS / "ur5e_like.urdf", ROBOTS / "ur5e_like.srdf")


def job():
    """Two strokes between rests, from memory."""
    robot = ur5e()
    down = [np.pi, 0, 0]
    strokes = [
        swivel.Stroke(name, [swivel.pose([0.42, y, 0.25], down), swivel.pose([0.5, y, 0.25], down)])
        for name, y in (("left", 0.1), ("right", -0.1))
    ]
    return swivel.Problem(robot, strokes=strokes, home=[0, -1.4, 1.6, -1.8, -1.57, 0])


class SixJoints(unittest.TestCase):
    def setUp(self):
        self.problem = swivel.load(PROBLEMS / "ur5e_probe_line.yaml")

    def test_a_path(self):
        problem = self.problem
        self.assertEqual(len(problem.joint_names), 6)
        self.assertEqual(problem.joint_limits.shape, (6, 2))
        np.testing.assert_array_equal(problem.start, START)
        plan = swivel.plan(problem, speed=0.05, evidence=True)
        self.assertEqual(plan.status, "solved")
        self.assertEqual(plan.joint_names, problem.joint_names)
        self.assertEqual(plan.joints.shape[1], 6)
        np.testing.assert_array_equal(plan.trajectory.joints, plan.joints)
        np.testing.assert_array_equal(plan.trajectory.roll, np.zeros(len(plan.joints)))
        for columns in (plan.motion.joints, plan.motion.velocities, plan.motion.accelerations):
            self.assertEqual(columns.shape[1], 6)
        self.assertEqual(plan.motion.peaks["speed"].shape, (6,))
        poses = problem.tool_pose(plan.joints)
        np.testing.assert_allclose(poses[0][:3, 3], problem.waypoints[0][:3], atol=1e-9)
        self.assertTrue(swivel.check(problem, plan.trajectory).passed)
        self.assertTrue(swivel.check(problem, plan.motion).passed)

    def test_rows_of_other_joints(self):
        plan = swivel.plan(self.problem)
        seven = swivel.Trajectory(
            np.hstack([plan.joints, np.zeros((len(plan.joints), 1))]), plan.trajectory.s
        )
        with self.assertRaisesRegex(swivel.InvalidArgument, "rows: of 7 joints: allowed are .* 6"):
            swivel.check(self.problem, seven)
        six = swivel.Trajectory(plan.joints, plan.trajectory.s, joint_names=plan.joint_names)
        self.assertEqual((six.joint_names, six.joints.shape[1]), (plan.joint_names, 6))
        kinematics = swivel.Kinematics(self.problem)
        with self.assertRaisesRegex(ValueError, "at: a pose leaves nothing free"):
            kinematics.ik(self.problem.tool_pose(START), at=[0.0])

    def test_files(self):
        plan = swivel.plan(self.problem, speed=0.05)
        with tempfile.TemporaryDirectory() as folder:
            for rows, ending in ((plan.trajectory, "csv"), (plan.motion, "csv"),
                                 (plan.motion, "json"), (plan.motion, "yaml"),
                                 (plan.motion, "mcap")):
                file = Path(folder) / f"rows.{ending}"
                rows.save(file)
                self.assertTrue(swivel.check(self.problem, file).passed, ending)
                read = swivel.load_trajectory(file, problem=self.problem)
                np.testing.assert_allclose(read.joints, rows.joints, atol=1e-12)
            self.problem.save(Path(folder) / "problem.yaml")
            again = swivel.load(Path(folder) / "problem.yaml")
            np.testing.assert_array_equal(again.start, START)
            self.assertEqual(swivel.plan(again).cost, swivel.plan(self.problem).cost)
        again = pickle.loads(pickle.dumps(plan))
        np.testing.assert_array_equal(again.joints, plan.joints)

    def test_postures(self):
        problem = swivel.load(PROBLEMS / "ur5e_probe_line.yaml")
        cost = swivel.plan(problem).cost
        problem.start = START
        self.assertEqual(swivel.plan(problem).cost, cost)
        problem.start = [*START, 0]
        with self.assertRaisesRegex(swivel.InvalidArgument, "start: 7 numbers: allowed are 6"):
            swivel.plan(problem)
        seven = swivel.load(PROBLEMS / "experiment_a.yaml")
        seven.start = START
        with self.assertRaisesRegex(swivel.InvalidArgument, "start: 6 numbers: allowed are 7"):
            swivel.plan(seven)
        with self.assertRaisesRegex(ValueError, r"start of shape \(5,\)"):
            seven.start = START[:5]
        problem = swivel.load(PROBLEMS / "ur5e_probe_line.yaml")
        problem.cost = swivel.Cost(weights=[4, 1, 1, 1, 1, 1])
        problem.limits.joint_speed = [1] * 6
        self.assertEqual(problem.cost.weights, [4, 1, 1, 1, 1, 1])
        dearer = swivel.plan(problem, speed=0.05)
        self.assertGreater(dearer.cost, cost)
        problem.cost = swivel.Cost(weights=[1] * 7)
        with self.assertRaisesRegex(swivel.InvalidArgument, "weights: 7 numbers: allowed are 6"):
            swivel.plan(problem)
        with self.assertRaisesRegex(ValueError, "weights: 5 numbers"):
            swivel.Cost(weights=[1] * 5)
        planner = swivel.Planner(self.problem)
        np.testing.assert_array_equal(planner.problem.start, START)
        task = planner.problem.task
        task.start = None
        planner.set_task(task)
        self.assertLessEqual(planner.plan().cost, cost)

    def test_hooks_and_states(self):
        shapes = set()

        def near_the_start(joints):
            shapes.add(joints.shape[1])
            return np.abs(joints[:, 0] - START[0]) < 2

        plan = swivel.plan(self.problem, check=near_the_start)
        self.assertEqual((plan.status, shapes), ("solved", {6}))
        kinematics = swivel.Kinematics(self.problem)
        pose = self.problem.tool_pose(START)
        found = kinematics.ik(pose)
        self.assertEqual(found.shape[1], 6)
        self.assertGreater(len(found), 3)
        np.testing.assert_allclose(self.problem.tool_pose(found), [pose] * len(found), atol=1e-8)
        apart = (found - START + np.pi) % (2 * np.pi) - np.pi
        self.assertLess(np.abs(apart).max(axis=1).min(), 1e-6)
        planner = swivel.Planner(self.problem)
        self.assertEqual(len(planner.clearance(plan.joints).distance), len(plan.joints))
        with self.assertRaisesRegex(ValueError, r"allowed are \(6,\) and \(n, 6\)"):
            planner.clearance(np.zeros((2, 7)))

    def test_many(self):
        plan = swivel.plan(self.problem)
        many = swivel.plan_many(self.problem, starts=[START, plan.joints[0]])
        self.assertEqual(list(many.cost), [plan.cost, plan.cost])
        np.testing.assert_array_equal(many[0].joints, plan.joints)
        with self.assertRaisesRegex(swivel.InvalidArgument, r"starts.*\(n, 6\)"):
            swivel.plan_many(self.problem, starts=[[*START, 0]])

    def test_a_job(self):
        problem = job()
        answer = swivel.plan(problem, speed=0.1)
        self.assertEqual(answer.status, "solved")
        self.assertEqual({part.trajectory.joints.shape[1] for part in answer.parts}, {6})
        np.testing.assert_array_equal(answer.parts[0].trajectory.joints[0], problem.home)
        self.assertTrue(swivel.check(problem, answer).passed)
        self.assertEqual(answer.motion.joints.shape[1], 6)
        blocked = job()  # a ball stands where the tool is to rest
        blocked.home = [1.5, -1.4, 1.6, -1.8, -1.57, 0]
        ball = swivel.pose(blocked.tool_pose(blocked.home)[:3, 3])
        blocked.scene.add("ball", swivel.Sphere(0.05), ball)
        none = swivel.plan(blocked)
        self.assertEqual(none.status, "infeasible")
        homes = [one for one in swivel.advise(blocked, none, timeout=10) if one.change == "home"]
        self.assertEqual((len(homes), homes[0].home.shape), (1, (6,)))
        self.assertRegex(str(homes[0]), r"home: \{joints: \[(-?[\d.]+, ){5}-?[\d.]+\]\}")
        blocked.home = homes[0].home
        self.assertEqual(swivel.plan(blocked).status, "solved")
        problem.home = [0] * 7
        with self.assertRaisesRegex(swivel.InvalidArgument, "home: 7 numbers: allowed are 6"):
            swivel.plan(problem)


if __name__ == "__main__":
    unittest.main()

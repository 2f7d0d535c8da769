# SPDX-License-Identifier: BSD-3-Clause
# Inverse kinematics of poses and clearances of states. Usage: states_test.py CASE; SWIVEL_DATA is
# the data folder.
import os
import re
import unittest
from pathlib import Path

import numpy as np

import swivel
from trials import at_least, seed, trials

DATA = Path(os.environ["SWIVEL_DATA"])
PROBLEMS, ROBOTS = DATA / "problems", DATA / "robots"

# Robot, whether its tool may roll, what is free at a pose (None: a joint).
ARMS = [
    ("iiwa14", False, "arm angle"),  # S-R-S
    ("sda5f", False, "arm angle"),
    ("gen3_like", False, None),  # one joint locked
    ("kr6_like", True, "roll"),  # spherical wrist
    ("ur5e_like", True, "roll"),  # three parallel axes
    ("panda_like", False, None),
    ("xarm7_like", False, None),
]

# Joint 4 of S-R-S arms where the arm is straight, rad: solutions are not told there.
STRAIGHT = {"iiwa14": 0, "sda5f": 1.047135}


def robot_of(name, roll=False, **keywords):
    if roll:
        keywords["roll"] = swivel.Roll()
    return swivel.Robot(ROBOTS / f"{name}.urdf", ROBOTS / f"{name}.srdf", **keywords)


def states_within(robot, count, generator):
    limits = robot.joint_limits
    limits[np.isinf(limits[:, 0])] = [-np.pi, np.pi]
    return generator.uniform(*limits.T, (count, 7))


def pose_errors(poses, pose):
    """Largest entry by which poses (n, 4, 4) differ from a pose, m and sines."""
    return np.abs(poses - pose).max(axis=(1, 2))


class InverseKinematics(unittest.TestCase):
    def test_own_state_is_among_the_solutions(self):
        for number, (name, roll, coordinate) in enumerate(ARMS):
            with self.subTest(robot=name):
                robot = robot_of(name, roll, tool=swivel.pose([0.02, 0.01, 0.1], [0.1, 0.2, 0.3]))
                kinematics = swivel.Kinematics(robot)
                if coordinate:
                    self.assertEqual(kinematics.coordinate, coordinate)
                else:
                    self.assertIn(kinematics.coordinate, robot.joint_names)
                states = states_within(
                    robot, trials(10_000), np.random.default_rng([seed(2607), number])
                )
                if name in STRAIGHT:
                    states = states[np.abs(states[:, 3] - STRAIGHT[name]) > 1e-3]
                self.assertGreaterEqual(len(states), 0.99 * trials(10_000))
                poses = robot.tool_pose(states)
                values = kinematics.coordinates(states)
                worst, missed, solutions = 0, 0, 0
                for q, pose, value in zip(states, poses, values):
                    found = kinematics.ik(pose, value, turns=True)
                    solutions += len(found)
                    if len(found):
                        worst = max(worst, pose_errors(robot.tool_pose(found), pose).max())
                    if not len(found) or np.abs(found - q).max(axis=1).min() > 1e-5:
                        missed += 1
                print(
                    f"{name}: {len(states)} states, {solutions} solutions, worst {worst:.2g}, "
                    f"{missed} missed"
                )
                self.assertLessEqual(worst, 1e-9)
                self.assertEqual(missed, 0)
                self.assertGreater(solutions, len(states))

    def test_solutions_keep_limits_and_differ(self):
        generator = np.random.default_rng(seed(2608))
        for name, roll, _ in ARMS:
            with self.subTest(robot=name):
                robot = robot_of(name, roll)
                kinematics, limits = swivel.Kinematics(robot), robot.joint_limits
                some = 0
                for q in states_within(robot, trials(20), generator):
                    pose = robot.tool_pose(q)
                    found = kinematics.ik(pose, step=0.5)
                    free = kinematics.ik(pose, step=0.5, limits=False)
                    self.assertEqual(found.shape[1], 7)
                    self.assertGreaterEqual(len(free), len(found))
                    if not len(found):
                        continue
                    some += 1
                    self.assertTrue((found >= limits[:, 0] - 1e-9).all())
                    self.assertTrue((found <= limits[:, 1] + 1e-9).all())
                    self.assertLessEqual(pose_errors(robot.tool_pose(found), pose).max(), 1e-9)
                    apart = np.abs(found[:, None] - found[None]).max(axis=2)
                    self.assertGreater((apart + np.eye(len(found))).min(), 1e-7)
                self.assertGreater(some, 0)

    def test_a_six_joint_arm_keeps_the_turn_of_the_tool(self):
        robot = robot_of("ur5e_like", True)
        pose = swivel.pose([0.4, 0.2, 0.3], axis=[0, 0.1, -1])
        found = swivel.Kinematics(robot).ik(pose)
        self.assertEqual(len(found), 8)
        self.assertTrue((found[:, 6] == 0).all())
        turned = swivel.Kinematics(robot).ik(pose, [0.3, -0.3])
        self.assertEqual(set(turned[:, 6]), {0.3, -0.3})

    def test_turns(self):
        robot = robot_of("ur5e_like", True)
        pose = robot.tool_pose([0.5, -1, 1.2, -0.6, 1.1, 0.4, 0])
        kinematics = swivel.Kinematics(robot)
        once, each = kinematics.ik(pose), kinematics.ik(pose, turns=True)
        self.assertGreater(len(each), len(once))
        for q in once:
            self.assertIn(0, np.abs(each - q).max(axis=1))

    def test_out_of_reach_and_bad_input(self):
        kinematics = swivel.Kinematics(robot_of("iiwa14"))
        self.assertEqual(kinematics.ik(swivel.pose([5, 0, 0])).shape, (0, 7))
        for words, call in (
            ("step: ", lambda: kinematics.ik(np.eye(4), step=0)),
            ("at: ", lambda: kinematics.ik(np.eye(4), [[1, 2]])),
            ("at: not finite", lambda: kinematics.ik(np.eye(4), np.nan)),
            ("joints", lambda: kinematics.coordinates([1, 2])),
        ):
            with self.assertRaisesRegex(ValueError, words):
                call()

    def test_an_arm_without_a_closed_form_is_refused(self):
        generator = np.random.default_rng(5)

        def moved(words, most):
            return " ".join(str(float(word) + generator.uniform(-most, most)) for word in words)

        def crooked(joint):
            return re.sub(
                r'<origin xyz="([^"]*)" rpy="([^"]*)"',
                lambda at: f'<origin xyz="{moved(at[1].split(), 0.05)}" '
                f'rpy="{moved(at[2].split(), 0.1)}"',
                joint[0],
            )

        text = (ROBOTS / "iiwa14.urdf").read_text()
        robot = swivel.Robot.from_string(
            re.sub(r'<joint name="joint_a.*?</joint>', crooked, text, flags=re.DOTALL)
        )
        self.assertIn("no closed form", robot.method)
        with self.assertRaisesRegex(ValueError, "Kinematics: this arm has no closed form"):
            swivel.Kinematics(robot)

    def test_poses_by_an_axis(self):
        generator = np.random.default_rng(seed(2609))
        for axis, tangent in generator.normal(size=(100, 2, 3)):
            z = axis / np.linalg.norm(axis)
            pose = swivel.pose([1, 2, 3], axis=axis)
            np.testing.assert_allclose(pose[:3, 2], z, atol=1e-12)
            # The smallest turn from the frame's axes, or from these turned down about x.
            turn = pose[:3, :3] * (np.array([1, -1, -1]) if z[2] < 0 else 1)
            np.testing.assert_allclose(np.trace(turn), 1 + 2 * abs(z[2]), atol=1e-12)
            self.assertAlmostEqual(np.linalg.det(turn), 1)
            pose = swivel.pose(axis=axis, tangent=tangent)
            np.testing.assert_allclose(pose[:3, 2], z, atol=1e-12)
            np.testing.assert_allclose(pose[:3, :3].T @ pose[:3, :3], np.eye(3), atol=1e-12)
            self.assertGreater(pose[:3, 0] @ tangent, 0)
            self.assertAlmostEqual(pose[:3, 1] @ tangent, 0)
        for axis in ([0, 0, -2], [1e-9, -1e-9, -1]):
            down = swivel.pose(axis=axis)
            np.testing.assert_allclose(down[:3, :3], np.diag([1, -1, -1]), atol=1e-8)
        for words, keywords in (
            ("axis of length 0", {"axis": [0, 0, 0]}),
            ("more than one of", {"axis": [0, 0, 1], "rpy": [0, 0, 0]}),
            ("tangent beside axis", {"tangent": [0, 0, 1]}),
            ("along the axis", {"axis": [0, 0, 1], "tangent": [0, 0, 2]}),
        ):
            with self.assertRaisesRegex(ValueError, words):
                swivel.pose(**keywords)


class StateClearance(unittest.TestCase):
    def test_rows_of_a_plan_are_those_of_its_measures(self):
        for name in ("experiment_c", "ur5e_deburr_edge"):
            planner = swivel.Planner(swivel.load(PROBLEMS / f"{name}.yaml"))
            plan = planner.plan(evidence=True)
            states = planner.clearance(plan.joints)
            self.assertEqual(len(states), len(plan.joints))
            least = plan.measures.min_margin
            row = int(np.argmin(states.margin))
            self.assertEqual(row, least.row)
            self.assertEqual(states.margin[row], least.margin)
            self.assertEqual(states.distance[row], least.clearance)
            self.assertEqual(states.names(row), tuple(least.bodies))
            self.assertEqual(states.least.min(), plan.measures.min_clearance)
            self.assertTrue((states.margin >= 0).all())

    def test_each_state_by_itself(self):
        problem = swivel.load(PROBLEMS / "experiment_c.yaml")
        planner = swivel.Planner(problem)
        generator = np.random.default_rng(seed(2610))
        states = states_within(problem.robot, trials(400), generator)
        together = planner.clearance(states)
        touching = 0
        for k, q in enumerate(states):
            alone = planner.clearance(q)
            self.assertEqual(alone.distance[0], together.distance[k])
            self.assertEqual(alone.names(0), together.names(k))
            self.assertLessEqual(together.least[k], together.distance[k])
            touching += together.distance[k] == 0
        self.assertGreaterEqual(touching, at_least(20))
        self.assertGreaterEqual(len(states) - touching, at_least(20))
        self.assertTrue((together.pairs[:, 0] < together.pairs[:, 1]).all())
        for a, b in together.pairs[:5]:
            self.assertLess(max(a, b), len(together.bodies))

    def test_a_ball_at_a_known_distance(self):
        robot = robot_of("iiwa14")
        there = np.zeros(7)
        for distance in (0.05, 0.002):
            scene = [swivel.SceneObject("ball", swivel.Sphere(0.1), swivel.pose([0, 0, 1.5]))]
            planner = swivel.Planner(robot, swivel.Task([[0.5, 0, 0.5, 1, 0, 0, 0]] * 2), scene)
            above = planner.clearance(there)
            # The arm stands upright; the ball comes down onto it.
            planner.move("ball", swivel.pose([0, 0, 1.5 - above.distance[0] + distance]))
            below = planner.clearance(there)
            self.assertIn("ball", below.names(0))
            self.assertAlmostEqual(below.distance[0], distance, delta=1e-5)
            self.assertAlmostEqual(below.margin[0], distance - 0.005, delta=1e-5)

    def test_bad_input(self):
        planner = swivel.Planner(swivel.load(PROBLEMS / "experiment_a.yaml"))
        self.assertEqual(len(planner.clearance(np.zeros((0, 7)))), 0)
        with self.assertRaisesRegex(ValueError, "joints of shape"):
            planner.clearance([[0, 0]])
        with self.assertRaisesRegex(ValueError, "row 1 is not finite"):
            planner.clearance([[0] * 7, [np.nan] * 7])
        with self.assertRaises(IndexError):
            planner.clearance(np.zeros(7)).names(1)


if __name__ == "__main__":
    unittest.main()

# SPDX-License-Identifier: BSD-3-Clause
# Trajectories and motions as sequences, arrays and data frames; what objects print; planners that
# are pickled. Usage: rows_test.py CASE; SWIVEL_DATA is the data folder.
import copy
import os
import pickle
import unittest
from pathlib import Path

import numpy as np

import swivel

DATA = Path(os.environ["SWIVEL_DATA"])
PROBLEMS = DATA / "problems"


def plan_of(name, **options):
    plan = swivel.plan(PROBLEMS / f"{name}.yaml", **options)
    assert plan.solved
    return plan


class Rows(unittest.TestCase):
    # Seven joints, seven joints whose tool may turn, six joints and the roll.
    PLANS = ("experiment_c", "iiwa14_deburr_in_hand", "ur5e_deburr_edge")

    def test_arrays(self):
        for rows in (plan_of("experiment_c").trajectory, plan_of("experiment_c", speed=0.1).motion):
            array = np.asarray(rows)
            self.assertEqual((array.shape, array.dtype), ((len(rows), 7), np.float64))
            np.testing.assert_array_equal(array, rows.joints)
            self.assertTrue(np.shares_memory(array, rows.joints))
            self.assertFalse(np.shares_memory(np.array(rows), rows.joints))
            self.assertFalse(np.shares_memory(rows.__array__(copy=True), rows.joints))
            self.assertEqual(np.asarray(rows, dtype=np.float32).dtype, np.float32)
            with self.assertRaisesRegex(ValueError, "needs a copy"):
                rows.__array__(np.float32, copy=False)

    def test_sequences(self):
        for name in self.PLANS:
            with self.subTest(problem=name):
                rows = plan_of(name).trajectory
                every = list(rows)
                self.assertEqual(len(every), len(rows))
                for k in (0, 1, -1, np.int64(2)):
                    row = rows[k]
                    self.assertEqual(row, every[k])
                    self.assertEqual((row.s, row["phi"], row.branch), (
                        rows.s[k], rows.phi[k], rows.branch[k]
                    ))
                    self.assertEqual(row.roll, rows.roll[k])
                    np.testing.assert_array_equal(row.joints, rows.joints[k])
                    self.assertEqual(row[rows.joint_names[2]], rows.joints[k, 2])
                    self.assertEqual(pickle.loads(pickle.dumps(row)), row)
                for part in (slice(2, 5), slice(None, None, 3), slice(3, 3), slice(None, None, -1)):
                    some = rows[part]
                    self.assertEqual(some.joint_names, rows.joint_names)
                    for member in ("joints", "s", "phi", "branch", "roll"):
                        np.testing.assert_array_equal(
                            getattr(some, member), getattr(rows, member)[part]
                        )
                for k in (len(rows), -len(rows) - 1):
                    with self.assertRaises(IndexError):
                        rows[k]
                with self.assertRaises(TypeError):
                    rows[0.5]
                with self.assertRaisesRegex(KeyError, "no column 'x': allowed are s, phi"):
                    rows[0]["x"]
                with self.assertRaisesRegex(AttributeError, "no 'speed'"):
                    rows[0].speed
                self.assertFalse(hasattr(rows[0], "missing"))
        motion = plan_of("experiment_c", speed=0.1).motion
        self.assertEqual(motion[3].t, motion.t[3])
        self.assertEqual(motion[3][motion.joint_names[1] + "_v"], motion.velocities[3, 1])
        with self.assertRaisesRegex(TypeError, "a slice of a Motion"):
            motion[1:3]

    def test_rolls(self):
        for name in self.PLANS:
            plan = plan_of(name)
            rows = plan.trajectory
            self.assertEqual(rows.roll.shape, (len(rows),))
            self.assertEqual(bool(rows.roll.any()), name != "experiment_c", name)
            if name == "iiwa14_deburr_in_hand":
                again = swivel.Trajectory(
                    rows.joints, rows.s, rows.phi, rows.branch, rows.joint_names, rows.roll
                )
                self.assertTrue(swivel.check(PROBLEMS / f"{name}.yaml", again))
                self.assertTrue(swivel.check(PROBLEMS / f"{name}.yaml", rows[:]))
            if name == "ur5e_deburr_edge":
                np.testing.assert_array_equal(rows.roll, rows.joints[:, 6])
                with self.assertRaisesRegex(ValueError, "roll: is the last joint"):
                    swivel.Trajectory(
                        rows.joints, rows.s, joint_names=rows.joint_names, roll=rows.s
                    )
        motion = plan_of("ur5e_deburr_edge", speed=0.05).motion
        np.testing.assert_array_equal(motion.roll, motion.joints[:, 6])

    def test_data_frames(self):
        try:
            import pandas
        except ImportError:
            self.skipTest("pandas (python3-pandas) is not installed")
        for name in self.PLANS:
            rows = plan_of(name).trajectory
            one, other = pandas.DataFrame(rows), rows.to_dataframe()
            self.assertEqual(list(one.columns), list(other.columns))
            self.assertEqual(len(one), len(rows))
            for frame in (one, other):
                for joint, column in zip(rows.joint_names, rows.joints.T):
                    np.testing.assert_array_equal(frame[joint], column)
                np.testing.assert_array_equal(frame["s"], rows.s)
                np.testing.assert_array_equal(frame["roll"], rows.roll)
                self.assertEqual(frame["s"].dtype, np.float64)
        motion = plan_of("experiment_c", speed=0.1).motion
        frame = motion.to_dataframe()
        np.testing.assert_array_equal(frame["t"], motion.t)
        self.assertEqual(list(frame.columns), list(pandas.DataFrame(motion).columns))
        frame.loc[0, "t"] = 5  # a copy, which may be written

    def test_tables_of_answers_and_studies(self):
        try:
            import pandas
        except ImportError:
            self.skipTest("pandas (python3-pandas) is not installed")
        problems = DATA / "problems"
        job = swivel.plan(problems / "door_job.yaml")
        frame = job.to_dataframe()
        self.assertEqual(len(frame), sum(len(part.joints) for part in job.parts))
        self.assertEqual(
            sorted(frame["stroke"].dropna().unique()), sorted(run.stroke for run in job.runs)
        )
        self.assertTrue(frame["s"].isna().any())  # in transitions
        cell = swivel.plan(problems / "sda10f_plate_workcell.yaml")
        frame = cell.to_dataframe()
        np.testing.assert_array_equal(frame["s_left"], cell.arms["left"].trajectory.s)
        path = swivel.plan(problems / "experiment_c.yaml")
        np.testing.assert_array_equal(path.to_dataframe()["s"], path.trajectory.s)
        episodes = swivel.campaign(problems / "door_job.yaml", episodes=3)
        frame = episodes.to_dataframe()
        self.assertEqual(list(frame["episode"]), [0, 1, 2])
        np.testing.assert_allclose(frame["cost"], episodes.cost)
        placements = swivel.place(problems / "experiment_c.yaml", base=True, x=(0, 0.1, 0.05))
        frame = placements.to_dataframe()
        np.testing.assert_array_equal(frame["cell"], placements.cell)
        np.testing.assert_allclose(frame["x"], [0, 0.05, 0.1])
        self.assertIsInstance(frame, pandas.DataFrame)


class HalfTurns(unittest.TestCase):
    """A tool that may turn freely about its z axis passes half turns, as in files."""

    TILT = 0.2

    @staticmethod
    def robot(**range):
        robots = DATA / "robots"
        return swivel.Robot(
            robots / "ur5e_like.urdf", robots / "ur5e_like.srdf", roll=swivel.Roll(**range)
        )

    def waypoints(self, flip, tilt=TILT):
        down = swivel.pose(rpy=[np.pi, 0, 0])[:3, :3]
        poses = []
        for y, turn in ((-0.1, 0), (0.0, flip), (0.1, flip)):
            axes = swivel.pose(rpy=[0, 0, turn]) @ swivel.pose(rpy=[tilt * (turn > 0), 0, 0])
            pose = swivel.pose([0.4, y, 0.3])
            pose[:3, :3] = down @ axes[:3, :3]
            poses.append(pose)
        return poses

    def test_everywhere_that_waypoints_come_in(self):
        robot = self.robot()
        for tilt in (0, self.TILT):
            task, plain = swivel.Task(self.waypoints(np.pi, tilt)), swivel.Task(self.waypoints(0))
            cost = swivel.plan(swivel.Problem(robot, task)).cost
            self.assertIsNotNone(cost)
            changed = swivel.Problem(robot, plain)
            changed.waypoints = task.waypoints
            planner = swivel.Planner(robot, plain)
            planner.set_task(task)
            for plan in (swivel.plan(changed), planner.plan(), swivel.Planner(robot, task).plan()):
                self.assertEqual(plan.cost, cost)
            job = swivel.Problem(robot, [swivel.Stroke("one", task.waypoints)])
            self.assertTrue(swivel.plan(job).solved)

    def test_the_tool_leans_as_it_is_told(self):
        robot, given = self.robot(), self.waypoints(np.pi)
        problem = swivel.Problem(robot, swivel.Task(given))
        plan = swivel.plan(problem)
        self.assertTrue(swivel.check(problem, plan.trajectory))
        reached = robot.tool_pose(plan.joints)
        for pose in given:
            row = np.abs(reached[:, :3, 3] - pose[:3, 3]).max(axis=1).argmin()
            np.testing.assert_allclose(reached[row, :3, 2], pose[:3, 2], atol=1e-6)

    def test_other_waypoints_stay_bit_for_bit(self):
        task = swivel.Task(self.waypoints(1.0))
        np.testing.assert_array_equal(
            swivel.Problem(self.robot(), task).waypoints, task.waypoints
        )

    def test_a_tool_that_may_not_turn_freely(self):
        task = swivel.Task(self.waypoints(np.pi))
        with self.assertRaisesRegex(swivel.InputError, "turns by 180 deg"):
            swivel.plan(swivel.Problem(self.robot(lower=-1, upper=1), task))


class Printed(unittest.TestCase):
    def test_reprs_are_calls_that_make_the_same(self):
        names = {**vars(swivel), "inf": np.inf, "nan": np.nan}
        for thing in (
            swivel.Limits(),
            swivel.Limits(clearance=0.01, edges="nodes", joint_jerk=[1, 2, 3, 4, 5, 6, 7]),
            swivel.Resolution(),
            swivel.Resolution(ds=0.02, arcs=True),
            swivel.Cost(metric="time"),
            swivel.Roll(),
            swivel.Roll(lower=-1 / 3),
            swivel.PathSmoothing(),
            swivel.Refinement(smoothing=0.25),
        ):
            text = repr(thing)
            self.assertEqual(eval(text, names), thing, text)
            kind = type(thing)
            members = [name for name in dir(kind) if isinstance(getattr(kind, name), property)]
            self.assertGreater(len(members), 0)
            for name in members:
                self.assertIn(f"{name}=", text)

    def test_names_of_enums_are_text(self):
        count = 0
        for name in swivel.__all__:
            for label, member in getattr(getattr(swivel, name), "__members__", {}).items():
                self.assertIsInstance(member.name, str)
                self.assertEqual((member.name, str(member)), (label, label.lower()))
                count += 1
        self.assertGreater(count, 40)


class PickledPlanners(unittest.TestCase):
    def test_planners(self):
        problem = swivel.load(PROBLEMS / "experiment_c.yaml")
        planner = swivel.Planner(problem)
        planner.move("rail", problem.scene["rail"].pose)
        planner.remove("post")
        plan = planner.plan()
        for again in (pickle.loads(pickle.dumps(planner)), copy.copy(planner)):
            self.assertNotIn("post", again.problem.scene)
            np.testing.assert_array_equal(again.plan().joints, plan.joints)
            again.remove("rail")
        self.assertIn("rail", planner.problem.scene)


if __name__ == "__main__":
    unittest.main(argv=["rows_test"] + os.sys.argv[1:])

# SPDX-License-Identifier: BSD-3-Clause
# Closed paths: laps that end in the joints in which they begin. Usage: closed_test.py CASE;
# SWIVEL_DATA is the data folder.
import os
import pickle
import sys
import unittest
from pathlib import Path

import numpy as np

import swivel

DATA = Path(os.environ["SWIVEL_DATA"])
COVER = DATA / "problems" / "panda_polish_cover.yaml"
COVERS = DATA / "problems" / "panda_polish_covers_job.yaml"
DOWN = [0, 1, 0, 0]


def square(**keywords):
    """A square of 0.2 m, once round, by an arm whose circles of arm angles come back turned."""
    corners = [(0.45, -0.1), (0.45, 0.1), (0.65, 0.1), (0.65, -0.1), (0.45, -0.1)]
    task = swivel.Task([[x, y, 0.4, *DOWN] for x, y in corners], **keywords)
    robots = DATA / "robots"
    return swivel.Problem(swivel.Robot(robots / "iiwa14.urdf", robots / "iiwa14.srdf"), task)


def gap(joints):
    """By how much the last row differs from the first, rad."""
    return np.abs(joints[-1] - joints[0]).max()


class ClosedPaths(unittest.TestCase):
    def test_a_closed_path_ends_where_it_begins(self):
        for closed, opened in (
            (swivel.load(COVER), swivel.load(COVER)),
            (square(closed=True), square()),
        ):
            opened.closed = False
            self.assertEqual((closed.closed, closed.task.closed), (True, True))
            self.assertIn("closed", repr(closed.task))
            self.assertNotIn("closed", repr(opened.task))
            for planner in ("lazy", "parallel"):
                lap, drifting = (
                    swivel.plan(problem, planner=planner) for problem in (closed, opened)
                )
                self.assertTrue(lap.solved and drifting.solved)
                self.assertEqual(gap(lap.joints), 0)
                self.assertGreater(gap(drifting.joints), 1e-3)
                self.assertGreater(lap.cost, drifting.cost)
                self.assertTrue(swivel.check(closed, lap.trajectory).passed)
                check = swivel.check(closed, drifting.trajectory)
                self.assertFalse(check.passed)
                self.assertIn("the path is closed", check.failures[0])

    def test_ten_laps_repeat(self):
        problem = swivel.load(COVER)
        first = swivel.plan(problem)
        joints = first.joints
        for _ in range(10):
            # A lap that begins in the joints in which the one before ended, as a controller does.
            problem.start = problem.end = joints[-1]
            lap = swivel.plan(problem)
            self.assertEqual(lap.cost, first.cost)
            np.testing.assert_array_equal(lap.joints, first.joints)
            joints = lap.joints

    def test_motions_close(self):
        plan = swivel.plan(COVER, refine=True, speed=0.05)
        self.assertEqual(gap(plan.joints), 0)
        self.assertLess(gap(plan.motion.joints), 1e-9)
        self.assertLess(plan.cost, swivel.plan(COVER).cost)
        self.assertTrue(swivel.check(COVER, plan.motion).passed)

    def test_strokes_of_a_job_close(self):
        job = swivel.load(COVERS)
        self.assertEqual([stroke.closed for stroke in job.strokes], [True, True])
        self.assertIn("closed", repr(job.strokes[0]))
        plan = swivel.plan(job)
        laps = [part.trajectory for part in plan.parts if part.stroke]
        self.assertEqual(len(laps), 2)
        for lap in laps:
            self.assertLess(gap(lap.joints), 1e-9)
        self.assertTrue(swivel.check(job, plan.parts).passed)
        again = pickle.loads(pickle.dumps(job))
        self.assertEqual(list(again.strokes), list(job.strokes))
        opened = pickle.loads(pickle.dumps(job))
        for stroke in opened.strokes:
            stroke.closed = False
        self.assertNotEqual(list(opened.strokes), list(job.strokes))
        drifting = swivel.plan(opened)
        self.assertLess(drifting.cost, plan.cost)
        check = swivel.check(job, drifting.parts)
        self.assertFalse(check.passed)
        self.assertIn("the path is closed", check.failures[0])
        lap = job.strokes[0]
        made = swivel.Stroke(lap.name, lap.waypoints, frame=lap.frame, closed=True)
        self.assertEqual(made, lap)
        job.retract = 0.01
        with self.assertRaisesRegex(ValueError, "'left': closed"):
            swivel.plan(job)

    def test_certificates(self):
        near = square(closed=True)
        self.assertIsNone(swivel.certificate(near))
        up = swivel.Task(near.waypoints + [0, 0, 2, 0, 0, 0, 0], closed=True)
        far = swivel.Problem(near.robot, up)
        proof = swivel.certificate(far)  # no path leads to the end, let alone back
        self.assertTrue(swivel.check_certificate(far, proof).passed)

    def test_pickled(self):
        for problem in (swivel.load(COVER), square(closed=True)):
            for protocol in (2, pickle.HIGHEST_PROTOCOL):
                again = pickle.loads(pickle.dumps(problem, protocol))
                self.assertTrue(again.closed)
                self.assertEqual(again.task, problem.task)
                self.assertTrue(pickle.loads(pickle.dumps(problem.task, protocol)).closed)
            np.testing.assert_array_equal(swivel.plan(again).joints, swivel.plan(problem).joints)
            again.closed = False
            self.assertNotEqual(again.task, problem.task)

    def test_what_makes_no_sense_is_refused(self):
        problem = square(closed=True)
        problem.waypoints = np.array(problem.waypoints)[:-1]
        with self.assertRaisesRegex(swivel.InputError, "path.closed: .* from the first"):
            swivel.plan(problem)
        problem = square(closed=True, start=[0, 0.5, 0, -1.5, 0, 1, 0])
        with self.assertRaisesRegex(swivel.InvalidArgument, "closed: is given beside a start"):
            swivel.plan(problem)

    def test_a_path_that_cannot_close(self):
        """A turntable without limits follows the torch once round; its arm must unwind."""
        problem = swivel.load(DATA / "problems" / "kr6_turntable_pipe.yaml")
        problem.resolution.ds, problem.resolution.arc = 0.01, 0.6
        self.assertTrue(swivel.plan(problem).solved)
        problem.closed = True
        plan = swivel.plan(problem)
        self.assertFalse(plan.solved)
        self.assertEqual(plan.diagnosis.cause.kind, swivel.CauseKind.NOT_CLOSED)
        with self.assertRaisesRegex(swivel.InputError, "path.closed: paths lead to the end"):
            swivel.certificate(problem)


if __name__ == "__main__":
    unittest.main(argv=["closed_test"] + sys.argv[1:], verbosity=1)

# SPDX-License-Identifier: BSD-3-Clause
# Problems that Python changes and saves as files. Usage: saved_test.py CASE; SWIVEL is the program,
# SWIVEL_DATA the data folder.
import copy
import os
import pickle
import random
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import numpy as np
import swivel
from trials import at_least, seed, trials

PROGRAM, DATA = os.environ["SWIVEL"], Path(os.environ["SWIVEL_DATA"])
PROBLEMS = DATA / "problems"
FREE = swivel.Resolution(ds=0.02)


def loadable():
    """The files of problems with one path."""
    for file in sorted(PROBLEMS.glob("*.yaml")):
        problem = swivel.load(file)
        if hasattr(problem, "waypoints"):  # neither strokes nor two arms
            yield file, problem


def pose(draw):
    at = [draw.uniform(-1, 1) for _ in range(3)]
    return swivel.pose(at, rpy=[draw.uniform(-3, 3) for _ in range(3)])


def change_scene(problem, draw):
    kept = {problem.frame, "door"}
    for name in [thing.name for thing in problem.scene]:
        if draw.random() < 0.3:
            problem.scene.move(name, pose(draw))
        elif draw.random() < 0.2 and name not in kept:
            problem.scene.remove(name)
        elif draw.random() < 0.1 and name not in kept:
            thing = problem.scene[name]
            problem.scene.remove(name)
            problem.scene.add(name, thing.shape, thing.pose)
    if draw.random() < 0.3:
        problem.scene.add("new", swivel.Mesh(DATA / "meshes" / "door_2k.stl", 0.5), pose(draw))
    if draw.random() < 0.3:
        problem.attach(swivel.AttachedBody("held", swivel.Sphere(0.02), problem.tip, pose(draw)))


def change_task(problem, draw):
    limits = problem.limits
    limits.clearance = draw.uniform(0.001, 0.01)
    limits.tool_path_error = draw.choice([None, 0.002])
    joints = len(problem.joint_names)
    limits.joint_speed = draw.choice([None, [1.0] * joints, list(np.linspace(1, 2, joints))])
    limits.edges = draw.choice(["nodes", "continuous"])
    problem.resolution.ds = draw.uniform(0.002, 0.02)
    if draw.random() < 0.3:
        problem.tool = pose(draw)
    problem.smooth = draw.choice([problem.smooth, None, swivel.PathSmoothing(angle=0.02)])
    problem.cost.metric = draw.choice(["l2", "l1", "max", "time"])
    problem.refinement.smoothing = draw.uniform(0, 1)
    if problem.closed:
        return
    if draw.random() < 0.3:
        problem.start = [draw.uniform(-0.1, 0.1) for _ in problem.joint_names]
        problem.start_at = draw.choice([None, 0.01])
    if draw.random() < 0.3:
        problem.end = [draw.uniform(-0.1, 0.1) for _ in problem.joint_names]
    waypoints = problem.waypoints
    if draw.random() < 0.3:
        waypoints[0, 0] += 0.001
        problem.waypoints = waypoints
    elif draw.random() < 0.2:
        problem.waypoints = waypoints[: max(2, len(waypoints) - 1)]


def change_job(job, draw):
    job.limits.clearance = draw.uniform(0.001, 0.01)
    job.rapid = draw.uniform(0.1, 1)
    job.home = draw.choice([None, job.home])
    if draw.random() < 0.5:
        job.approach = draw.choice([0, 0.05, [0.01, 0, -0.02]])
    for stroke in job.strokes:
        if draw.random() < 0.3:
            stroke.retract = draw.uniform(0, 0.05)
        if stroke.closed:  # its approach and retract must be equal
            stroke.approach = stroke.retract = draw.uniform(0, 0.05)
        if draw.random() < 0.3:
            stroke.process_speed = draw.uniform(0.01, 0.1)
        if draw.random() < 0.2:
            stroke.limits = swivel.Limits(clearance=0.003, tool_path_error=None)
        if draw.random() < 0.2:
            waypoints = stroke.waypoints
            waypoints[1, 0] += 1e-3
            stroke.waypoints, stroke.feed = waypoints, None
    if draw.random() < 0.3 and len(job.strokes) > 1:
        job.strokes.pop()
    elif draw.random() < 0.3 and len(job.strokes) > 1:
        job.strokes.reverse()
    if job.lift and draw.random() < 0.5:
        job.lift = swivel.LiftOffs(cost=draw.uniform(0, 1))
    for name in [thing.name for thing in job.scene]:
        if draw.random() < 0.3:
            job.scene.move(name, pose(draw))


class SavedProblems(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def same_bodies(self, a, b):
        self.assertEqual([body.name for body in a], [body.name for body in b])
        for one, other in zip(a, b):
            self.assertEqual(repr(one.shape), repr(other.shape))
            np.testing.assert_allclose(one.pose, other.pose, rtol=0, atol=4e-15)
            np.testing.assert_array_equal(one.pose[:3, 3], other.pose[:3, 3])

    def same(self, a, b):
        """Compares all that Python can see of two problems; rotations but for rounding."""
        task = a.task
        task.frame = task.frame or a.base
        if task.start is None:
            task.start_tolerance = b.task.start_tolerance
        self.assertEqual(task, b.task)
        for name in ("base", "tip", "hold", "held", "links", "joint_names", "method"):
            self.assertEqual(getattr(a, name), getattr(b, name))
        np.testing.assert_array_equal(a.joint_limits, b.joint_limits)
        np.testing.assert_allclose(a.tool, b.tool, rtol=0, atol=4e-15)
        self.assertEqual(a.roll, b.roll)
        self.same_bodies(a.scene, b.scene)
        self.assertEqual([o.allow for o in a.scene], [o.allow for o in b.scene])
        self.assertEqual([o.allow_depth for o in a.scene], [o.allow_depth for o in b.scene])
        by_name = {body.name: body for body in b.attached}
        self.same_bodies(a.attached, [by_name[body.name] for body in a.attached])

    def test_random_changes_are_read_back(self):
        first, cases, files = seed(20261128), 0, 0
        for file, loaded in loadable():
            files += 1
            for _ in range(trials(4)):
                draw = random.Random(first + cases)
                problem = copy.copy(loaded)
                change_scene(problem, draw)
                change_task(problem, draw)
                problem = pickle.loads(pickle.dumps(problem)) if draw.random() < 0.3 else problem
                saved = self.folder / str(cases % 3) / "problem.yaml"
                saved.parent.mkdir(exist_ok=True)
                with self.subTest(file=file.name, case=cases):
                    problem.save(saved)
                    self.same(problem, swivel.load(saved))
                cases += 1
        print(cases, "cases of", files, "files")
        self.assertGreaterEqual(cases, at_least(60))

    def test_comments_order_and_layout_stay(self):
        before = (PROBLEMS / "panda_weld_seam.yaml").read_text()
        shutil.copytree(DATA / "robots", self.folder / "robots")
        file = self.folder / "problems" / "mine.yaml"
        file.parent.mkdir()
        file.write_text(before)
        problem = swivel.load(file)
        problem.save(file)
        self.assertEqual(file.read_text(), before)
        problem.limits.clearance = 0.008
        problem.scene.move("post", [0.25, -0.3, 0.35, 1, 0, 0, 0])
        problem.scene.remove("bottle")
        problem.cost.metric = "max"
        problem.save(file)
        after = before.replace("clearance: 0.005", "clearance: 0.008")
        after = after.replace("xyz: [0.2, -0.3, 0.35]", "xyz: [0.25, -0.3, 0.35]")
        after = "".join(l for l in after.splitlines(True) if "bottle, cyl" not in l)
        self.assertEqual(file.read_text(), after + "cost: {metric: max}\n")
        self.same(problem, swivel.load(file))

    def test_problems_made_in_memory_are_written_whole(self):
        robots = DATA / "robots"
        robot = swivel.Robot(
            robots / "sda5f.urdf", robots / "sda5f.srdf", base="base_link",
            tip="arm_left_link_tool0", hold={"torso_joint_b1": 0.1},
            limits={"arm_left_joint_1_s": (-1, 1)}
        )
        task = swivel.Task([[0.6, 0.1, 1.0, 1, 0, 0, 0], [0.6, 0.2, 1.0, 1, 0, 0, 0]])
        task.resolution = FREE
        scene = swivel.Scene()
        scene.add("door", swivel.Mesh(DATA / "meshes" / "door_2k.stl", [1, -1, 1]), [2, 0, 1])
        scene.add("post", swivel.Box([0.1, 0.2, 0.3]), [2, 2, 1], allow={"base_link": 0.01})
        problem = swivel.Problem(robot, task, scene)
        file = self.folder / "whole.yaml"
        problem.save(file)
        self.same(problem, swivel.load(file))
        for absent in ("limits: {clearance", "refine", "cost", "dphi"):
            self.assertNotIn(absent, file.read_text())
        plans = [swivel.plan(problem), swivel.plan(file)]
        self.assertEqual(plans[0].cost, plans[1].cost)
        run = subprocess.run([PROGRAM, "plan", file, "--quiet"])
        self.assertEqual(run.returncode, 0 if plans[0].solved else 1)

    def same_job(self, a, b):
        self.assertEqual([repr(one) for one in a.strokes], [repr(one) for one in b.strokes])
        for one, other in zip(a.strokes, b.strokes):
            self.assertEqual(one.limits or a.limits, other.limits or b.limits)
            for name in ("approach", "retract"):
                mine, read = (
                    getattr(job if getattr(stroke, name) is None else stroke, name)
                    for job, stroke in ((a, one), (b, other))
                )
                np.testing.assert_array_equal(mine, read)
            for name in ("frame", "smooth", "process_speed", "approach_speed", "reversible"):
                self.assertEqual(getattr(one, name), getattr(other, name))
            np.testing.assert_array_equal(one.waypoints, other.waypoints)
        for name in ("limits", "cost", "refinement", "order", "rapid", "process_speed", "lift"):
            self.assertEqual(getattr(a, name), getattr(b, name), name)
        self.assertEqual(
            a.home is None if b.home is None else list(a.home),
            b.home is None or list(b.home)
        )
        self.same_bodies(a.scene, b.scene)

    def test_jobs_are_saved(self):
        first, cases = seed(20261129), 0
        for file in sorted(PROBLEMS.glob("*_job.yaml")):
            loaded = swivel.load(file)
            for _ in range(trials(6)):
                draw = random.Random(first + cases)
                job = copy.copy(loaded)
                change_job(job, draw)
                saved = self.folder / "job.yaml"
                with self.subTest(file=file.name, case=cases):
                    job.save(saved)
                    self.same_job(job, swivel.load(saved))
                cases += 1
        print(cases, "cases")
        self.assertGreaterEqual(cases, at_least(24))
        door = (PROBLEMS / "door_job.yaml").read_text().replace("../", f"{DATA}/")
        mine = self.folder / "door.yaml"
        mine.write_text(door)
        job = swivel.load(mine)
        job.strokes[1].process_speed = 0.1
        job.approach, job.rapid = 0.02, 0.4
        del job.strokes[2]
        job.save(mine)
        after = door.replace("door_stroke_1.csv}}", "door_stroke_1.csv}, process_speed: 0.1}")
        after = after.replace("rapid: 0.5", "rapid: 0.4\napproach: 0.02")
        after = "".join(l for l in after.splitlines(True) if "row_2" not in l)
        self.assertEqual(mine.read_text(), after)
        made = swivel.Problem(job.robot, job.strokes, job.scene, home=job.home, approach=0.01)
        made.save(mine)
        self.same_job(made, swivel.load(mine))
        made.strokes[0].feed = [0.1] * len(made.strokes[0].waypoints)
        with self.assertRaisesRegex(swivel.InputError, "feed of stroke 'row_0'"):
            made.save(mine)

    def test_what_no_file_can_say_is_refused(self):
        file = self.folder / "none.yaml"
        problem = swivel.load(PROBLEMS / "experiment_c.yaml")
        corners = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0]])
        arrays = copy.copy(problem)
        arrays.scene.add("patch", swivel.Mesh.from_arrays(corners, [[0, 1, 2]]))
        text = swivel.Problem(
            swivel.Robot.from_string((DATA / "robots" / "iiwa14.urdf").read_text()),
            swivel.Task([[0, 0, 1, 1, 0, 0, 0], [0, 0.1, 1, 1, 0, 0, 0]])
        )
        varied = copy.copy(problem)
        varied.scene.remove("door")
        varied.frame = ""
        for words, kind, refused in (
            ("mesh of 'patch'", swivel.InputError, arrays),
            ("robot.urdf", swivel.InputError, text),
            ("unknown object 'door'", swivel.InvalidArgument, varied),
        ):
            with self.assertRaisesRegex(kind, words) as caught:
                refused.save(file)
            self.assertNotIn("\n", str(caught.exception))
            self.assertFalse(file.exists())
        with self.assertRaises(swivel.InputError):
            problem.save(self.folder / "no_such_folder" / "a.yaml")
        problem.limits.clearance = -1
        with self.assertRaises(swivel.InvalidArgument):
            problem.save(file)
        self.assertEqual(list(self.folder.iterdir()), [])


if __name__ == "__main__":
    unittest.main(argv=["saved_test"] + sys.argv[1:])

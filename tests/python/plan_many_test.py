# SPDX-License-Identifier: BSD-3-Clause
# Many problems that differ from one, against plans of each of them alone. Usage: plan_many_test.py
# CASE; SWIVEL_DATA is the data folder.
import copy
import functools
import gc
import os
import pickle
import re
import signal
import sys
import tempfile
import time
import unittest
from pathlib import Path

import numpy as np

import swivel

DATA = Path(os.environ["SWIVEL_DATA"])
PROBLEMS = DATA / "problems"
COARSE = swivel.Resolution(ds=0.01, dphi=0.1)


def load(name, resolution=COARSE):
    problem = swivel.load(PROBLEMS / f"{name}.yaml")
    problem.resolution = resolution
    return problem


def doors(problem, count):
    """Poses of the door, (count, 4, 4), every tenth of them out of reach."""
    poses = [problem.episode(1, k).scene["door"].pose for k in range(count)]
    for pose in poses[3::10]:
        pose[2, 3] += 0.6
    return np.array(poses)


def changed(problem, poses=(), **members):
    """A copy with some objects elsewhere and other members."""
    problem = copy.copy(problem)
    for name, pose in dict(poses).items():
        problem.scene.move(name, pose)
    for name, value in members.items():
        setattr(problem, name, value)
    return problem


def product(a, b):
    """The product of a quaternion [w x y z] and each row of (n, 4)."""
    w, v = a[0], np.array(a[1:])
    return np.column_stack([w * b[:, 0] - b[:, 1:] @ v,
                            w * b[:, 1:] + b[:, :1] * v + np.cross(v, b[:, 1:])])


def seen_from(problem, base):
    """The problem as the robot sees it whose base stands at a pose x y z qw qx qy qz."""
    pose = swivel.pose(base[:3], quat=base[3:])
    at, back = pose[:3, 3], pose[:3, :3].T
    turn = base[3:] * [1, -1, -1, -1]
    turn = turn if turn[0] > 0 or turn[3] > 0 else -turn  # the sign that a matrix gives

    def seen(of):
        made = np.eye(4)
        made[:3, :3], made[:3, 3] = back @ of[:3, :3], back @ (of[:3, 3] - at)
        return made

    def waypoints(of):
        return np.hstack([(of[:, :3] - at) @ back.T, product(turn, of[:, 3:])])

    moved = changed(problem, {one.name: seen(one.pose) for one in problem.scene})
    if problem._kind() == "strokes":
        for stroke in moved.strokes:
            if stroke.frame in ("", problem.robot.base):
                stroke.waypoints = waypoints(stroke.waypoints)
    elif problem.frame in ("", problem.robot.base):
        moved.waypoints = waypoints(problem.waypoints)
    return moved


def joints_of(plan):
    """All rows of a plan in the order in which they are run, those of two arms side by side."""
    if len(plan.arms) == 2:
        return np.hstack([arm.trajectory.joints for arm in plan.arms.values()])
    return np.concatenate([np.zeros((0, 7)), *(part.joints for part in plan.parts)])


COLUMNS = "number status solved cost failed_s cause by reason checked joints offsets".split()


def bits(plans):
    """All columns that depend on the problems alone, as bytes."""
    columns = {name: getattr(plans, name) for name in COLUMNS}
    return {
        name: column.tobytes() if isinstance(column, np.ndarray) else column
        for name, column in columns.items()
    }


class Cases(unittest.TestCase):
    def same(self, plans, problems):
        """Each row has the bits of the plan of its problem."""
        self.assertEqual(plans.number.tolist(), list(range(len(problems))))
        rows = np.split(plans.joints, plans.offsets[1:-1])
        for k, problem in enumerate(problems):
            plan, row = swivel.plan(problem), plans[k]
            self.assertEqual((row.number, row.status), (k, plan.status))
            self.assertEqual((row.solved, row.cost), (plan.solved, plan.cost))
            self.assertEqual(row.checked, True if plan.solved else None)
            joints = joints_of(plan)
            for found in (row.joints, rows[k]):
                self.assertEqual(found.shape, joints.shape)
                self.assertEqual(found.tobytes(), joints.tobytes())
            self.assertEqual(bool(row.reason), not row.solved)
            self.assertEqual(
                (plans.status[k], plans.solved[k], plans.reason[k], plans.cause[k], plans.by[k]),
                (row.status, row.solved, row.reason, row.cause, row.by),
            )
            self.assertEqual(plans.checked[k], row.solved)
            np.testing.assert_equal(plans.cost[k], row.cost if row.solved else np.nan)
            if not row.solved and problem._kind() == "one path":
                self.assertEqual(row.failed_s, plan.diagnosis.reached_s)
                self.assertEqual(row.cause or "none", str(plan.diagnosis.cause.kind))


class ManyPlans(Cases):
    """Rows are what plan() finds for each problem alone."""

    def test_objects(self):
        problem = load("experiment_c")
        poses = doors(problem, 20)
        problems = [changed(problem, {"door": pose}) for pose in poses]
        for threads in (1, 2):
            plans = swivel.plan_many(problem, poses={"door": poses}, threads=threads)
            self.assertTrue(0 < plans.solved.sum() < 20, plans)
            self.same(plans, problems)
        again = swivel.plan_many(
            PROBLEMS / "experiment_c.yaml", poses={"door": poses[:2]}, planner="lazy", prove=False
        )
        self.assertEqual(again.checked.tolist(), [False, False])
        for k, row in enumerate(again):
            alone = changed(load("experiment_c"), {"door": poses[k]})
            alone.resolution = swivel.load(PROBLEMS / "experiment_c.yaml").resolution
            self.assertEqual(row.joints.tobytes(), joints_of(swivel.plan(alone)).tobytes())

    def test_rows_of_seven_and_two_objects(self):
        problem = load("experiment_c")
        generator = np.random.default_rng(3)
        turns = -np.pi / 2 + generator.uniform(-0.2, 0.2, 6)
        door = np.column_stack([
            [0.76, 0.27, 0.9] + generator.uniform(-0.05, 0.05, (6, 3)),
            np.cos(turns / 2), np.zeros((6, 2)), np.sin(turns / 2),
        ])
        door[:, 3:] *= 1.0004  # of length 1 within 1e-3
        post = np.array([[0.37, y, 0.8, 1, 0, 0, 0] for y in np.linspace(0.3, 0.7, 6)])
        self.same(
            swivel.plan_many(problem, poses={"door": door, "post": post}),
            [changed(problem, {"door": a, "post": b}) for a, b in zip(door, post)],
        )

    def test_paths(self):
        for name in ("experiment_c", "panda_weld_seam"):
            problem = load(name, swivel.load(PROBLEMS / f"{name}.yaml").resolution)
            given = problem.waypoints
            lifts = np.linspace(0, 0.01, 4)
            rows = [given + [0, 0, lift, 0, 0, 0, 0] for lift in lifts]
            shorter = [path[: len(path) - k] if k < 2 < len(path) else path
                       for k, path in enumerate(rows)]
            matrices = [
                np.array([swivel.pose(row[:3], quat=row[3:]) for row in path]) for path in rows
            ]
            for paths in (np.array(rows), shorter, matrices, np.array(matrices)):
                self.same(
                    swivel.plan_many(problem, paths=paths),
                    [changed(problem, waypoints=path) for path in paths],
                )

    def test_paths_of_a_tool_that_may_turn_pass_half_turns(self):
        robots = DATA / "robots"
        robot = swivel.Robot(
            robots / "ur5e_like.urdf", robots / "ur5e_like.srdf", roll=swivel.Roll()
        )
        paths = []
        for lean in (0.1, 0.3):
            poses = [swivel.pose([0.4, y, 0.3], axis=[0, lean * y, -1]) for y in (-0.1, 0, 0.1)]
            poses[1] = poses[1] @ swivel.pose(rpy=[0, 0, np.pi])
            paths.append(poses)
        problem = swivel.Problem(robot, swivel.Task([]))
        plans = swivel.plan_many(problem, paths=paths)
        self.assertTrue(plans.solved.all())
        self.same(plans, [changed(problem, waypoints=path) for path in paths])

    def test_bases(self):
        # Differences, half turns and their products are exact, in whatever order they are added.
        exact = [[0.125, -0.0625, 0, 1, 0, 0, 0], [0, 0, 0.03125, 1, 0, 0, 0],
                 [0, 0, 0, 0, 0, 0, 1], [1.5, 0, 0, 0, 0, 0, 1]]
        for name in ("experiment_c", "panda_weld_seam"):
            problem = load(name, swivel.load(PROBLEMS / f"{name}.yaml").resolution)
            plans = swivel.plan_many(problem, bases=exact)
            self.assertTrue(plans.solved.any())
            self.same(plans, [seen_from(problem, np.array(base)) for base in exact])
            turned = [[0.02, -0.01, 0.01, np.cos(a / 2), 0, 0, np.sin(a / 2)] for a in (0.1, -0.2)]
            matrices = np.array([swivel.pose(row[:3], quat=row[3:]) for row in turned])
            for bases in (turned, matrices):
                for base, row in zip(turned, swivel.plan_many(problem, bases=bases)):
                    plan = swivel.plan(seen_from(problem, np.array(base)))
                    self.assertEqual(row.status, plan.status)
                    self.assertTrue(row.solved)
                    self.assertAlmostEqual(row.cost, plan.cost, 9)
                    np.testing.assert_allclose(row.joints, joints_of(plan), atol=1e-7)

    def test_a_base_moves_after_objects(self):
        problem = load("experiment_c")
        poses = doors(problem, 3)
        bases = np.array([[0.125 * k, 0, 0, 1, 0, 0, 0] for k in range(3)])
        self.same(
            swivel.plan_many(problem, poses={"door": poses}, bases=bases),
            [seen_from(changed(problem, {"door": a}), b) for a, b in zip(poses, bases)],
        )

    def test_starts_and_ends(self):
        problem = load("experiment_c")
        joints = swivel.plan(problem).joints
        kinematics = swivel.Kinematics(problem.robot)
        for argument, member, row in (("starts", "start", 0), ("ends", "end", -1)):
            found = kinematics.ik(problem.robot.tool_pose(joints[row]), step=0.5)
            given = np.vstack([joints[row], found[:: max(1, len(found) // 6)]])
            plans = swivel.plan_many(problem, **{argument: given})
            self.assertTrue(plans.solved[0])
            self.same(plans, [changed(problem, **{member: one}) for one in given])
        both = {"starts": joints[[0, 0]], "ends": joints[[-1, -1]]}
        self.same(
            swivel.plan_many(problem, **both),
            [changed(problem, start=joints[0], end=joints[-1])] * 2,
        )

    def test_what_is_wrong_with_one_problem_is_its_row(self):
        problem = load("experiment_c")
        start = swivel.plan(problem).joints[0]
        plans = swivel.plan_many(problem, starts=[start, start + 0.3, start])
        self.assertEqual([str(status) for status in plans.status], ["solved", "error", "solved"])
        with self.assertRaises(swivel.InputError) as caught:
            swivel.plan(changed(problem, start=start + 0.3))
        self.assertEqual(plans.reason[1], str(caught.exception))
        self.assertEqual(plans[1].joints.shape, (0, 7))
        self.assertRegex(repr(plans[1]), "^<Planned 1: error, .*start")
        far = doors(problem, 2)
        far[0, 0, 3] = 3000
        plans = swivel.plan_many(problem, poses={"door": far})
        self.assertEqual([str(status) for status in plans.status], ["error", "solved"])
        self.assertIn("too far away", plans.reason[0])

    def test_strokes(self):
        job = load("door_job", swivel.Resolution(ds=0.02, dphi=0.1))
        job.strokes = job.strokes[:2]
        poses = doors(job, 5)
        for threads in (1, 2):
            plans = swivel.plan_many(job, poses={"door": poses}, threads=threads)
            self.assertTrue(0 < plans.solved.sum() < 5, plans)
            self.same(plans, [changed(job, {"door": pose}) for pose in poses])
        for frame in ("door", ""):
            for stroke in job.strokes:
                if not frame:  # the same places, in the base frame
                    door = job.scene["door"].pose
                    stroke.waypoints = door @ [
                        swivel.pose(row[:3], quat=row[3:]) for row in stroke.waypoints
                    ]
                stroke.frame = frame
            bases = np.array([[0, 0, 0, 1, 0, 0, 0], [0.0625, 0, 0, 1, 0, 0, 0]])
            plans = swivel.plan_many(job, bases=bases)
            self.assertTrue(plans.solved.any())
            self.same(plans, [seen_from(job, base) for base in bases])

    def test_two_arms(self):
        text = (PROBLEMS / "sda10f_bar_workcell.yaml").read_text().replace("../", f"{DATA}/")
        text = re.sub(r"^resolution:.*$", "resolution: {ds: 0.02, dphi: 0.2}", text, flags=re.M)
        text += ("scene:\n  - {name: post, cylinder: {radius: 0.03, length: 0.6}, "
                 "xyz: [0.5, 0.5, 1.0]}\n")
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "cell.yaml"
            file.write_text(text)
            cell = swivel.load(file)
        moves = np.array([-0.75, -0.5, -0.25, 0, 0.125])
        post = [[0.5, 0.5 + y, 1, 1, 0, 0, 0] for y in moves]
        for threads in (1, 2):
            plans = swivel.plan_many(cell, poses={"post": post}, threads=threads)
            self.assertEqual(plans.joints.shape[1], 14)
            self.assertTrue(0 < plans.solved.sum() < 5, plans)
            self.same(plans, [cell.placed([0, y, 0, 0, 0, 0], object="post") for y in moves])
        self.assertEqual(plans.padded().shape[2], 14)


class ManyRuns(Cases):
    """Tables, progress, time, shards and workers."""

    @classmethod
    def setUpClass(cls):
        cls.problem = load("experiment_c", swivel.Resolution(ds=0.02, dphi=0.1))
        cls.poses = doors(cls.problem, 21)
        cls.many = functools.partial(swivel.plan_many, cls.problem, poses={"door": cls.poses})
        cls.plans = cls.many()

    def test_arrays(self):
        plans = self.plans
        self.assertEqual((len(plans), plans[-1].number), (21, 20))
        with self.assertRaises(IndexError):
            plans[21]
        self.assertEqual(plans.number.dtype, np.uint64)
        self.assertEqual((plans.offsets.dtype, plans.offsets.shape), (np.int64, (22,)))
        self.assertEqual(plans.offsets[-1], len(plans.joints))
        self.assertEqual((np.diff(plans.offsets) > 0).tolist(), plans.solved.tolist())
        self.assertTrue((plans.plan_ms[plans.solved] > 0).all())
        longest = int(np.diff(plans.offsets).max())
        for fill in (np.nan, -1.0):
            padded = plans.padded() if np.isnan(fill) else plans.padded(fill=fill)
            self.assertEqual(padded.shape, (21, longest, 7))
            for rows, row in zip(padded, plans):
                count = len(row.joints)
                np.testing.assert_array_equal(rows[:count], row.joints)
                np.testing.assert_array_equal(rows[count:], np.full((longest - count, 7), fill))
        for array in (plans.joints, plans.offsets, plans.number, plans[0].joints):
            with self.assertRaises(ValueError):
                array[0] = 0
        self.assertTrue(np.shares_memory(plans.joints, plans.joints[5:]))
        self.assertTrue(np.shares_memory(plans.joints, plans.joints))
        other = self.many()
        kept = other.joints, other.offsets, other.cost, other[0].joints
        before = [array.tobytes() for array in kept]
        del other
        gc.collect()
        self.assertEqual([array.tobytes() for array in kept], before)
        self.assertRegex(
            repr(plans), r"^<Plans: 21, of which %d have a path; cost " % plans.solved.sum()
        )
        self.assertRegex(repr(plans[0]), r"^<Planned 0: cost [0-9.]+, \d+ rows, [0-9.]+ ms>$")
        self.assertRegex(repr(plans[3]), r"^<Planned 3: no path, .* ms>$")

    def test_progress(self):
        seen = []

        def progress(part, done, of):
            seen.append((part.number.tolist(), part.joints.tobytes(), done, of))

        plans = self.many(progress=progress)
        self.assertEqual(bits(plans), bits(self.plans))
        self.assertEqual(
            seen, [([k], row.joints.tobytes(), k + 1, 21) for k, row in enumerate(plans)]
        )

        def broken(*_):
            raise KeyError("mine")

        with self.assertRaisesRegex(KeyError, "mine"):
            self.many(progress=broken)

    def test_ctrl_c_gives_the_rows_so_far(self):
        def progress(plans, done, of):
            if done == 5:
                os.kill(os.getpid(), signal.SIGINT)
            if done >= 5:
                time.sleep(0.5)  # the thread that handles signals looks for them meanwhile

        with self.assertRaises(KeyboardInterrupt) as caught:
            self.many(progress=progress, threads=1)
        rows = caught.exception.rows
        self.assertIs(type(rows), swivel.Plans)
        self.assertTrue(5 <= len(rows) < 21, rows)
        self.assertEqual(rows.number.tolist(), list(range(len(rows))))
        self.assertEqual(rows.joints.tobytes(), self.plans.joints[: rows.offsets[-1]].tobytes())

    def test_causes_are_found_where_they_are_asked_for(self):
        plans = self.many(explain=False)
        without = ~self.plans.solved
        self.assertTrue(without.any())
        self.assertEqual({plans.cause[k] for k in np.flatnonzero(without)}, {"not_asked"})
        self.assertEqual({plans.reason[k] for k in np.flatnonzero(without)}, {"not asked for"})
        np.testing.assert_array_equal(plans.cost, self.plans.cost)
        np.testing.assert_array_equal(plans.failed_s, self.plans.failed_s)
        self.assertEqual(plans.joints.tobytes(), self.plans.joints.tobytes())

    def test_time_for_each(self):
        plans = self.many(timeout_each=1e-6)
        self.assertEqual({str(status) for status in plans.status}, {"timeout"})
        self.assertEqual((len(plans), plans.joints.shape), (21, (0, 7)))
        self.assertEqual(plans.padded().shape, (21, 0, 7))
        self.assertFalse(plans.offsets.any())
        self.assertTrue(np.isnan(plans.cost).all())
        self.assertTrue(all(plans.reason))
        self.assertEqual(bits(self.many(timeout_each=600, timeout=600)), bits(self.plans))

    def test_time_for_all(self):
        poses = np.tile(self.poses, (500, 1, 1))
        fine = load("experiment_c", swivel.Resolution(ds=0.002, dphi=0.02))
        begin = time.monotonic()
        plans = swivel.plan_many(fine, poses={"door": poses}, timeout=1)
        self.assertLess(time.monotonic() - begin, 30)
        self.assertLess(len(plans), len(poses))
        self.assertEqual(plans.number.tolist(), list(range(len(plans))))
        none = swivel.plan_many(fine, poses={"door": poses}, timeout=1e-9)
        self.assertEqual((len(none), none.joints.shape), (0, (0, 7)))
        self.assertEqual(none.offsets.tolist(), [0])
        self.assertEqual(none.padded().shape, (0, 0, 7))

    def test_shards(self):
        parts = [self.many(shard=shard) for shard in ("0/3", (1, 3), "2/3")]
        self.assertEqual([part.number[0] for part in parts], [0, 1, 2])
        self.assertEqual(parts[1].number.tolist(), list(range(1, 21, 3)))
        self.assertEqual(bits(swivel.Plans._joined(parts[::-1])), bits(self.plans))
        self.assertEqual(bits(self.many(shard=(0, 1))), bits(self.plans))
        self.assertEqual(len(self.many(shard=(25, 30))), 0)

    def test_pickles(self):
        for protocol in (2, pickle.HIGHEST_PROTOCOL):
            again = pickle.loads(pickle.dumps(self.plans, protocol))
            self.assertIs(type(again), swivel.Plans)
            self.assertEqual(bits(again), bits(self.plans))
            self.assertEqual(again.plan_ms.tolist(), self.plans.plan_ms.tolist())
            row = pickle.loads(pickle.dumps(self.plans[4], protocol))
            self.assertEqual(repr(row), repr(self.plans[4]))
            self.assertEqual(row.joints.tobytes(), self.plans[4].joints.tobytes())

    def test_files(self):
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "plans.npz"
            self.plans.save(file)
            with np.load(file) as saved:
                self.assertEqual(
                    sorted(saved), sorted("number status cost failed_s cause reason joints "
                                          "offsets".split())
                )
                for name in saved:
                    array = np.array(getattr(self.plans, name))
                    if name == "status":
                        array = np.array([str(status) for status in self.plans.status])
                    np.testing.assert_array_equal(saved[name], array)
            self.plans.save(Path(folder) / "plans.csv")
            text = (Path(folder) / "plans.csv").read_text()
            self.assertEqual(text, self.plans.to_csv())
            self.assertEqual(len(text.splitlines()), 22)
            self.assertRegex(text, r"^episode,status,cost,plan_ms,")
            none = self.many(shard=(25, 30))
            none.save(file)
            with np.load(file) as saved:
                self.assertEqual(saved["joints"].shape, (0, 7))
            for name in ("plans.npz", "plans.csv", "plans.NPZ"):
                with self.assertRaises(swivel.InputError):
                    self.plans.save(Path(folder) / "nowhere" / name)
        try:
            table = self.plans.to_dataframe()
        except ImportError as error:
            self.skipTest(f"{error} (Debian: python3-pandas)")
        self.assertEqual(len(table), 21)
        np.testing.assert_array_equal(table.cost, self.plans.cost)

    def test_the_ending_of_a_file_is_its_format(self):
        with tempfile.TemporaryDirectory() as folder:
            self.plans.save(Path(folder) / "plans.CSV")
            self.assertEqual((Path(folder) / "plans.CSV").read_text(), self.plans.to_csv())
            (Path(folder) / "plans.NPZ").write_text("of before")
            for name in ("plans.NPZ", "new.Npz"):
                self.plans.save(os.path.join(folder, name))
                with np.load(Path(folder) / name) as saved:
                    np.testing.assert_array_equal(saved["joints"], self.plans.joints)
            self.assertEqual(
                sorted(os.listdir(folder)), ["new.Npz", "plans.CSV", "plans.NPZ"]
            )
            for name in ("", "plans", "plans.txt", ".npz", "plans.npz.gz"):
                file = name and os.path.join(folder, name)
                with self.assertRaisesRegex(
                    swivel.InputError, "^file: '.*': unknown format: allowed are .* .npz or .csv$"
                ):
                    self.plans.save(file)
            self.assertEqual(len(os.listdir(folder)), 3)

    def test_workers_plan_what_was_pickled(self):
        # What a worker of a Dask cluster does with what it gets, without Dask.
        still = np.tile([0.0, 0, 0, 1, 0, 0, 0], (len(self.poses), 1))
        varied = swivel._swivel._Varied(
            self.problem, None, {"door": self.poses}, still, None, None
        )
        make = functools.partial(
            swivel._swivel._ManyPlanner, self.problem, "lazy", 1, None, None, True, True
        )
        planners = pickle.loads(pickle.dumps(swivel.runs._Planners(make)))
        parts = [
            planners.plan(
                swivel.runs._plan_varied,
                pickle.loads(pickle.dumps(varied.part(range(first, first + 7)))),
            )
            for first in (14, 0, 7)
        ]
        self.assertEqual(bits(swivel.Plans._joined(parts)), bits(self.many(bases=still)))

    def test_on_dask(self):
        try:
            from dask.distributed import Client
        except ImportError as error:
            self.skipTest(f"{error} (Debian: python3-distributed)")
        with Client(
            n_workers=1, threads_per_worker=2, processes=False, dashboard_address=None
        ) as client:
            self.assertEqual(bits(self.many(client=client)), bits(self.plans))
            shard = self.many(client=client, shard="1/2")
            self.assertEqual(bits(shard), bits(self.many(shard="1/2")))
            poses = {"door": np.tile(self.poses, (500, 1, 1))}
            some = swivel.plan_many(self.problem, poses=poses, client=client, timeout=2)
            self.assertLess(len(some), 10500)


class ManyErrors(unittest.TestCase):
    """What is wrong is said before anything is planned, in one line."""

    def refused(self, words, problem, kind=ValueError, **keywords):
        def never(*_):
            self.fail("something was planned")

        with self.subTest(words), self.assertRaisesRegex(kind, words) as caught:
            swivel.plan_many(problem, **{"progress": never, **keywords})
        self.assertNotIn("\n", str(caught.exception))
        return caught.exception

    @staticmethod
    def spoilt(array, place, value):
        array = np.array(array)
        array[place] = value
        return array

    def test_poses_and_bases(self):
        problem = load("experiment_c")
        rows = np.tile([0.7, 0.2, 0.9, 1, 0, 0, 0], (3, 1))
        matrices = np.tile(np.eye(4), (3, 1, 1))
        refused = functools.partial(self.refused, problem=problem, kind=swivel.InvalidArgument)
        refused("^poses: no object 'dor', nearest is 'door': allowed are", poses={"dor": rows})
        for argument, of in (
            ("poses: 'door'", lambda given: {"poses": {"door": given}}),
            ("bases", lambda given: {"bases": given}),
        ):
            for words, given in (
                (r"of shape \(3, 6\): allowed are \(n, 7\) and \(n, 4, 4\)", rows[:, :6]),
                (r"of shape \(7,\)", rows[0]),
                (r"of shape \(4, 4\)", np.eye(4)),
                (r"of shape \(3, 3, 4\)", matrices[:, :3]),
                (r"of shape \(\)", 3.0),
                ("not an array of numbers", [["a"] * 7]),
                ("not an array of numbers", [rows[0], rows[0][:3]]),
                ("0 rows: allowed are one or more", np.zeros((0, 7))),
                ("row 2: not finite: allowed", self.spoilt(rows, (2, 1), np.nan)),
                ("row 1: not finite: allowed", self.spoilt(rows, (slice(1, 3), 3), np.inf)),
                (r"row 1: pose: quaternion of length 1\.1: allowed is 1 within 1e-3",
                 self.spoilt(rows, (1, 3), 1.1)),
                ("row 0: not finite", self.spoilt(matrices, (0, 1, 3), np.nan)),
                ("row 1: pose is no rigid transform: allowed are",
                 self.spoilt(matrices, (1, 0, 0), 1.1)),
                ("row 2: pose is no rigid transform", self.spoilt(matrices, (2, 3, 0), 1)),
            ):
                refused(f"^{argument}: {words}", **of(given))
        refused("^poses: 'post': 2 rows, but poses: 'door' has 3: allowed are as many rows",
                poses={"door": rows, "post": rows[:2]})
        refused("^bases: 2 rows, but poses: 'door' has 3", poses={"door": rows}, bases=rows[:2])

    def test_paths(self):
        problem = load("experiment_c")
        path = problem.waypoints
        paths = np.array([path, path])
        refused = functools.partial(self.refused, problem=problem, kind=swivel.InvalidArgument)
        for words, given in (
            ("not a sequence", 3),
            ("0 rows", []),
            (r"one path, of shape \(19, 7\): allowed are \(n, m, 7\), .*; \[path\]", path),
            (r"one path, of shape \(19, 7\)", path.tolist()),
            (r"one path, of shape \(3, 4, 4\)", np.tile(np.eye(4), (3, 1, 1))),
            (r"row 1: of shape \(7,\): allowed are \(n, 7\) and \(n, 4, 4\)", [path, path[0]]),
            ("row 0: not an array of numbers but of object", [None]),
            (r"row 1: of shape \(19, 9\)", [path, np.hstack([path, path[:, :2]])]),
            (r"row 1: 1 waypoint\(s\): allowed are at least two", [path, path[:1]]),
            ("row 1: waypoint 5: not finite", self.spoilt(paths, (1, 5, 0), np.nan)),
            ("row 1: waypoint 6: pose: quaternion of length", self.spoilt(paths, (1, 6, 3), 9)),
            ("row 0: not an array of numbers", "ab"),
        ):
            refused(f"^paths: {words}", paths=given)
        self.assertEqual(len(path), 19)
        refused("^starts: 3 rows, but paths has 2", paths=paths, starts=np.zeros((3, 7)))

    def test_arrays_of_other_things_than_numbers(self):
        class Failing:
            def __array__(self, dtype=None, copy=None):
                raise RuntimeError("own failure")

        problem = load("experiment_c")
        refused = functools.partial(self.refused, problem=problem, kind=swivel.InvalidArgument)
        path = problem.waypoints
        for argument, good in (
            ("paths", np.array([path, path])), ("poses: 'door'", path), ("bases", path),
            ("starts", np.zeros((2, 7))), ("ends", np.zeros((2, 7)))
        ):
            mask = np.zeros(good.shape, bool)
            mask[1] = True
            masked = np.ma.masked_array(good, mask)
            for words, given in (
                ("(row 1: )?has masked numbers: allowed are .*, none of them masked", masked),
                ("(row 1: )?has masked numbers", list(masked)),
                ("not an array of numbers but of complex128: allowed are", good + 0j),
                ("(row 0: )?not an array of numbers but of complex128", (good + 0j).tolist()),
                ("not an array of numbers but of object: allowed are", good.astype(object)),
                ("not an array of numbers but of str", good.astype(str)),
                ("not an array of numbers: allowed are", Failing()),
                ("(row 0: )?not an array of numbers: allowed are", [Failing(), Failing()]),
            ):
                name, *of = argument.split(": ")
                error = refused(f"^{argument}: {words}", **{name: {"door": given} if of else given})
                if words.endswith("numbers: allowed are"):
                    self.assertEqual(repr(error.__cause__), "RuntimeError('own failure')")
        whole = np.ma.masked_array(path)  # nothing is masked
        self.assertEqual(len(swivel.plan_many(problem, paths=[whole], explain=False)), 1)

    def test_starts_and_ends(self):
        problem = load("experiment_c")
        refused = functools.partial(self.refused, problem=problem, kind=swivel.InvalidArgument)
        for argument in ("starts", "ends"):
            for words, given in (
                (r"of shape \(7,\): allowed are \(n, 7\), rad", np.zeros(7)),
                (r"of shape \(2, 6\)", np.zeros((2, 6))),
                ("0 rows", np.zeros((0, 7))),
                ("row 1: not finite", self.spoilt(np.zeros((2, 7)), 1, np.nan)),
                ("row 0: not finite", self.spoilt(np.zeros((2, 7)), (0, 6), -np.inf)),
                ("not an array", "joints"),
            ):
                refused(f"^{argument}: {words}", **{argument: given})
        refused("^ends: 2 rows, but starts has 3", starts=np.zeros((3, 7)), ends=np.zeros((2, 7)))

    def test_kinds(self):
        job = swivel.load(PROBLEMS / "door_job.yaml")
        cell = swivel.load(PROBLEMS / "sda10f_plate_workcell.yaml")
        for problem, kind in ((job, "strokes"), (cell, "two arms")):
            for argument, given in (
                ("paths", np.zeros((1, 2, 7))), ("starts", np.zeros((1, 7))),
                ("ends", np.zeros((1, 7)))
            ):
                self.refused(
                    f"^{argument}: of a problem of {kind}: allowed with one path", problem,
                    **{argument: given}
                )
        self.refused("^bases: of a problem of two arms: allowed with one path or strokes", cell,
                     bases=[[0, 0, 0, 1, 0, 0, 0]])
        windows = swivel.load(PROBLEMS / "ur5e_deburr_edge.yaml")
        path = windows.waypoints
        windows.waypoints = np.hstack([path, np.tile([-0.2, 0.2], (len(path), 1))])
        self.refused("^paths: the problem has windows of the roll", windows, paths=[path])

    def test_other_keywords(self):
        problem = load("experiment_c")
        good = {"poses": {"door": doors(problem, 2)}}
        self.refused("^paths, poses, bases, starts, ends: none is given", problem)
        self.refused("^paths, poses, bases, starts, ends: none is given", problem, poses={})
        for words, keywords in (
            ("^timeout: not a positive number", {"timeout": 0}),
            ("^timeout: not a positive number", {"timeout": float("nan")}),
            ("^timeout_each: not a positive number", {"timeout_each": -1}),
            ("^timeout_each: not a positive number", {"timeout_each": float("nan")}),
            ("^threads: -1: allowed are 0", {"threads": -1}),
            ("eager_dp", {"planner": "magic"}),
        ):
            self.refused(words, problem, **good, **keywords)
        for shard in ((3, 3), (-1, 3), "3/3", "1/0", "a/b", "1", "1/2/3", (1,), (0.5, 2), 3):
            self.refused("^shard: .*: allowed are .I, N. and 'I/N'", problem,
                         kind=swivel.InvalidArgument, shard=shard, **good)
        self.refused("nowhere", "nowhere.yaml", kind=swivel.InputError, **good)
        for wrong in (None, 3, problem.robot):
            with self.assertRaisesRegex(TypeError, "allowed are a Problem, or its file"):
                swivel.plan_many(wrong, **good)
        for words, keywords in (
            ("^poses: str: allowed is a mapping", {"poses": "door"}),
            ("^progress: not callable", {"progress": 3, **good}),
        ):
            self.refused(words, problem, kind=TypeError, **keywords)
        with self.assertRaisesRegex(TypeError, "unexpected keyword argument 'pose'"):
            swivel.plan_many(problem, pose={})

    def test_types_of_keywords(self):
        problem = load("experiment_c")
        good = {"poses": {"door": doors(problem, 2)}}
        whole = "not a whole number: allowed are 0 .all cores. to 1024$"
        for words, keywords in (
            (f"^threads: 2.0: {whole}", {"threads": 2.0}),
            (f"^threads: '2': {whole}", {"threads": "2"}),
            (f"^threads: None: {whole}", {"threads": None}),
            (f"^threads: ndarray: {whole}", {"threads": np.zeros((9, 9))}),
            ("^prove: 'no': neither True nor False: allowed are True and False$", {"prove": "no"}),
            ("^prove: None: neither", {"prove": None}),
            ("^explain: 2: neither", {"explain": 2}),
            ("^timeout: '1': not a number: allowed are values above 0, or None$", {"timeout": "1"}),
            ("^timeout: .1.: not a number", {"timeout": [1]}),
            ("^timeout_each: 1j: not a number", {"timeout_each": 1j}),
            ("^client: int: allowed is a dask.distributed.Client, or None$", {"client": 3}),
        ):
            self.refused(words, problem, kind=TypeError, **good, **keywords)
        self.refused("^threads: 1099511627776: allowed are 0", problem, **good, threads=2**40)
        row = {"starts": swivel.plan(problem).joints[:1]}
        swivel.plan_many(problem, **row, threads=np.int64(1), timeout=np.float32(9), prove=1)
        swivel.plan_many(problem, **row, timeout=float("inf"), explain=np.bool_(False))

    def test_a_client_has_a_longest_timeout(self):
        class Client:
            def submit(self, *_, **__):
                raise AssertionError("something was sent")

            cancel = nthreads = submit

        problem = load("experiment_c")
        words = "^timeout: (inf|1e.10): too long for a client: allowed are values above 0, at most"
        for timeout in (float("inf"), 1e10):
            self.refused(words, problem, poses={"door": doors(problem, 2)}, client=Client(),
                         timeout=timeout)
        with self.assertRaisesRegex(ValueError, "^timeout: inf: too long for a client"):
            swivel.place(problem, object="door", x=0, client=Client(), timeout=float("inf"))


class OtherErrors(unittest.TestCase):
    """The other functions name wrongly typed arguments as plan_many() does."""

    def refused(self, cases, function, *values):
        for words, keywords in cases:
            with self.subTest(words), self.assertRaisesRegex(TypeError, words) as caught:
                function(*values, **keywords)
            self.assertNotIn("\n", str(caught.exception))

    def test_plan(self):
        problem = load("experiment_c")
        cases = (
            ("^threads: 2.0: not a whole number: allowed are 0", {"threads": 2.0}),
            ("^timeout: '1': not a number", {"timeout": "1"}),
            ("^prove: 'no': neither True nor False", {"prove": "no"}),
            ("^evidence: 'no': neither", {"evidence": "no"}),
            ("^refine: 3: neither", {"refine": 3}),
            ("^speed: '1': not a number: allowed are values above 0, m/s, or None", {"speed": "1"}),
            ("^turn_speed: .*rad/s", {"turn_speed": "1"}),
            ("^rate: '9': not a number", {"rate": "9"}),
            ("^chord: '1': not a number", {"chord": "1"}),
            ("^check: not callable", {"check": 3}),
        )
        self.refused(cases, swivel.plan, problem)
        self.refused(cases, swivel.Planner(problem).plan)

    def test_check_and_time(self):
        job = load("door_job", swivel.Resolution(ds=0.02, dphi=0.1))
        for rows in (3, None, [3], np.zeros((3, 7))):
            words = f"^rows: {type(rows).__name__}: allowed are an Answer, .*, or a file"
            for function in (swivel.check, swivel.time):
                self.refused([(words, {})], function, job, rows)
        self.refused([("^speed: '1': not a number", {"speed": "1"})], swivel.check, job, [])

    def test_campaign(self):
        self.refused(
            (
                ("^episodes: 2.0: not a whole number: allowed are 1", {"episodes": 2.0}),
                ("^seed: 1.5: not a whole number", {"seed": 1.5}),
                ("^threads: 2.0: not a whole number", {"threads": 2.0}),
                ("^prove: 'no': neither", {"prove": "no"}),
                ("^progress: not callable", {"progress": 3}),
                ("^client: int", {"client": 3}),
            ),
            swivel.campaign, load("experiment_c"),
        )
        for keywords in ({"episodes": -1}, {"seed": -1}, {"seed": 2**64}):
            with self.assertRaisesRegex(swivel.InvalidArgument, "^[a-z]+: -?[0-9]+: allowed are"):
                swivel.campaign(load("experiment_c"), **keywords)

    def test_place(self):
        problem = load("experiment_c")
        place = functools.partial(swivel.place, problem)
        self.refused(
            (
                ("^object: 3: allowed is a name", {"object": 3, "x": 0}),
                ("^path: 'no': neither", {"path": "no", "x": 0}),
                ("^base: 'no': neither", {"base": "no", "x": 0}),
                ("^arm: 3: allowed is a name", {"path": True, "arm": 3, "x": 0}),
                ("^x: 'a': allowed is a number, .from, to, step.", {"base": True, "x": "a"}),
                ("^yaw: .1, 2, 3, 4.: allowed", {"base": True, "yaw": (1, 2, 3, 4)}),
                ("^hold: 3: allowed is a mapping", {"hold": 3}),
                ("^hold: .*: allowed is a mapping", {"hold": {"torso": "up"}}),
                ("^hold: .*: allowed is a mapping", {"hold": {3: 1}}),
                ("^sample: 2.0: not a whole number", {"base": True, "x": (0, 1), "sample": 2.0}),
                ("^refine_grid: 'no': neither", {"base": True, "x": 0, "refine_grid": "no"}),
                ("^best: 3: allowed are clearance", {"base": True, "x": 0, "best": 3}),
                ("^timeout: '1': not a number", {"base": True, "x": 0, "timeout": "1"}),
                ("^progress: not callable", {"base": True, "x": 0, "progress": 3}),
                ("^client: int", {"base": True, "x": 0, "client": 3}),
            ),
            place,
        )
        some = place(object="door", x=np.array([0, 0.01, 0.01]), yaw=np.float64(0))
        self.assertEqual(len(some), 2)


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[1:]])

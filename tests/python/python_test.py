# SPDX-License-Identifier: BSD-3-Clause
# The Python package as a user has it. Usage: python_test.py CASE; SWIVEL is the program,
# SWIVEL_DATA the data folder.
import ast
import base64
import contextlib
import copy
import gc
import hashlib
import io
import os
import pickle
import re
import resource
import shutil
import signal
import subprocess
import sys
import tarfile
import tempfile
import threading
import time
import unittest
import zipfile
from pathlib import Path

import numpy as np

import swivel
from trials import at_least, seed, trials

PROGRAM, DATA = os.environ["SWIVEL"], Path(os.environ["SWIVEL_DATA"])
PROBLEMS, ROBOTS = DATA / "problems", DATA / "robots"
DOWN = [0, 1, 0, 0]


def experiment(letter, **resolution):
    problem = swivel.load(PROBLEMS / f"experiment_{letter}.yaml")
    for name, value in resolution.items():
        setattr(problem.resolution, name, value)
    return problem


def endless():
    """So fine that an answer of LONG takes minutes."""
    return experiment("c", ds=0.001, dphi=0.002)


LONG = "eager_dp"


class Enough(Exception):
    """Ends an endless plan."""


def interrupt():
    os.kill(os.getpid(), signal.SIGINT)


def arm(**keywords):
    return swivel.Robot(ROBOTS / "iiwa14.urdf", ROBOTS / "iiwa14.srdf", **keywords)


def square(**keywords):
    corners = [(0.45, -0.1), (0.45, 0.1), (0.65, 0.1), (0.65, -0.1)]
    return swivel.Task(
        [[x, y, 0.4, *DOWN] for x, y in corners],
        resolution=swivel.Resolution(ds=0.02, dphi=0.1),
        **keywords,
    )


class Plans(unittest.TestCase):
    def program(self, command, problem, *arguments):
        with tempfile.TemporaryDirectory() as folder:
            out = Path(folder) / "out.csv"
            subprocess.run(
                [PROGRAM, command, problem, *arguments, "--out", out, "--quiet"], check=True
            )
            return out.read_bytes()

    def saved(self, what):
        with tempfile.TemporaryDirectory() as folder:
            what.save(Path(folder) / "out.csv")
            return (Path(folder) / "out.csv").read_bytes()

    def test_the_program_gives_the_same_bits(self):
        for name in (
            "experiment_a", "experiment_b", "experiment_c", "panda_weld_seam", "ur5e_deburr_edge"
        ):
            file = PROBLEMS / f"{name}.yaml"
            for planner in ("lazy", "parallel"):
                plan = swivel.plan(file, planner=planner, threads=2)
                self.assertTrue(plan.solved)
                self.assertEqual(
                    self.saved(plan.trajectory), self.program("plan", file, "--planner", planner),
                    name
                )

    def test_motions_are_those_of_the_program(self):
        file = PROBLEMS / "experiment_c.yaml"
        for options, keywords in (
            (["--speed", "0.1"], {}),
            (["--speed", "0.1", "--refine"], {"refine": True}),
        ):
            motion = swivel.plan(file, speed=0.1, **keywords).motion
            self.assertEqual(self.saved(motion), self.program("plan", file, *options))

    def test_plans_after_changes_are_those_of_fresh_planners(self):
        problem = experiment("c", ds=0.02, dphi=0.1)
        planner, statuses = swivel.Planner(problem), set()
        rail = problem.scene["rail"].pose
        for k in range(12):
            rail[0, 3] += 0.004
            planner.move("rail", rail)
            problem.scene.move("rail", rail)
            # Between them plans of another kind, after which the planner holds its own task again.
            planner.plan(refine=k % 3 == 0, speed=0.2 if k % 4 == 0 else None)
            one, other = planner.plan(), swivel.plan(problem)
            self.assertEqual(one.status, other.status)
            np.testing.assert_array_equal(one.joints, other.joints)
            self.assertEqual(planner.problem.limits, problem.limits)
            statuses.add(str(one.status))
        print("verdicts:", statuses)

    def test_how_deep_bodies_may_touch(self):
        plate = swivel.SceneObject(
            "plate", swivel.Box([1, 1, 0.1]), allow={"disc": 0.003, "tool": None}
        )
        self.assertEqual((plate.allow, plate.allow_depth), (["disc", "tool"], {"disc": 0.003}))
        self.assertEqual(pickle.loads(pickle.dumps(plate)).allow_depth, {"disc": 0.003})
        self.assertEqual(swivel.SceneObject("a", swivel.Sphere(1), allow=["disc"]).allow_depth, {})
        problem = swivel.load(DATA / "problems" / "xarm7_polish_raster.yaml")
        problem.waypoints = np.array(problem.waypoints)[:2] - [0, 0, 0.005, 0, 0, 0, 0]
        problem.resolution.ds = 0.02
        plan = swivel.plan(problem, evidence=True)
        self.assertTrue(plan.solved)
        contact = plan.measures.deepest_contact
        self.assertEqual((contact.bodies, contact.allowed), (("disc", "plate"), None))
        self.assertLess(abs(contact.depth - 0.002), 1.2e-3)
        self.assertLessEqual(contact.at_most, contact.depth + 0.51e-3)
        self.assertEqual(plan.measures.deepest_contact_status, "measured")
        self.assertEqual(plan.measures.min_clearance_status, "measured")
        check = swivel.check(problem, plan.trajectory)
        self.assertEqual(check.deepest_contact.bodies, contact.bodies)
        self.assertEqual(check.deepest_contact_status, "measured")
        unasked = swivel.plan(problem).measures
        self.assertEqual(unasked.deepest_contact_status, "not_measured")
        self.assertEqual(unasked.min_clearance_status, "not_measured")
        self.assertNotIn("not measured", repr(unasked))

    def test_refine_time_measure_check_advise(self):
        problem = experiment("c", ds=0.01)
        planner = swivel.Planner(problem)
        plan = planner.plan(evidence=True)
        self.assertTrue(planner.check(plan.trajectory))
        measures = planner.measure(plan.trajectory)
        self.assertEqual(measures.min_clearance, plan.measures.min_clearance)
        self.assertGreaterEqual(measures.min_margin.margin, 0)
        self.assertEqual(measures.arm_angle.shape, (len(plan.trajectory),))
        refined = swivel.refine(problem, plan.trajectory)
        self.assertTrue(refined.refined)
        self.assertLess(refined.cost, plan.cost)
        self.assertTrue(swivel.check(problem, refined.trajectory))
        motion = swivel.time(problem, plan.trajectory, speed=0.1, rate=125)
        self.assertTrue(motion.executable)
        check = planner.check(motion)
        self.assertTrue(check.passed, check)
        self.assertLessEqual(max(check.peaks.values()), 1 + 1e-6)
        self.assertAlmostEqual(motion.t[1] - motion.t[0], 1 / 125)
        self.assertEqual(motion.joints.shape, motion.velocities.shape)
        wrong = swivel.Trajectory(
            np.roll(plan.joints, 1, axis=1), plan.trajectory.s, plan.trajectory.phi,
            plan.trajectory.branch
        )
        self.assertFalse(swivel.check(problem, wrong))
        self.assertFalse(planner.check(plan.trajectory).rounded)
        for refine in (False, True):  # its rows follow the rounded path of its motion
            timed = swivel.plan(problem, speed=0.1, refine=refine)
            check = swivel.check(problem, timed.trajectory)
            self.assertTrue(check.passed, check)
            self.assertTrue(check.rounded)
        barred = swivel.plan(PROBLEMS / "experiment_a_start.yaml")
        self.assertEqual(barred.status, swivel.Status.INFEASIBLE)
        self.assertEqual(barred.diagnosis.cause.kind, swivel.CauseKind.LIMIT)
        advice = swivel.advise(PROBLEMS / "experiment_a_start.yaml", barred)
        self.assertEqual(
            (advice[0].change, advice[0].outcome), (swivel.Change.FREE_START, swivel.Outcome.SOLVED)
        )

    def test_answers_say_what_they_are(self):
        plan = swivel.plan(experiment("c"), evidence=True)
        for text in (repr(plan), str(plan)):
            for part in ("solved", "cost 2.27", "least clearance 9.9 mm"):
                self.assertIn(part, text)
            self.assertLessEqual(text.count("\n"), 1)
        self.assertIn("samples", repr(swivel.plan(experiment("c"), speed=0.1)))
        self.assertIn("arm_left_joint_5_r", repr(swivel.plan(PROBLEMS / "experiment_a_start.yaml")))
        self.assertIn("seven joints", repr(arm()))
        limits = repr(swivel.Limits(clearance=0.01, edges="nodes"))
        for part in ("Limits(clearance=0.01, ", "edges='nodes'", "joint_margin=0.0", "=None"):
            self.assertIn(part, limits)
        count = 0
        for name in swivel.__all__:
            thing = getattr(swivel, name)
            self.assertTrue(thing.__doc__, name)
            self.assertEqual(thing.__module__, "swivel", name)
            count += 1
        self.assertGreater(count, 40)

    def test_the_readme(self):
        text = re.search(
            r"```python\n(.*?)```", (DATA.parent / "README.md").read_text(), re.DOTALL
        ).group(1)
        before = os.getcwd()
        os.chdir(DATA.parent)
        try:
            names = {}
            exec(text, names)
        finally:
            os.chdir(before)
        self.assertTrue(names["motion"].executable)
        self.assertTrue(names["planner"].plan().solved)


class Memory(unittest.TestCase):
    def test_results_outlive_the_planner(self):
        planner = swivel.Planner(experiment("c"))
        plan = planner.plan(refine=True, speed=0.1, evidence=True)
        kept = [
            plan.joints, plan.trajectory.s, plan.motion.joints, plan.motion.velocities,
            plan.lattice_path.joints, plan.refinement.trajectory.phi, plan.measures.arm_angle
        ]
        copies = [array.copy() for array in kept]
        measures, limits = plan.measures.min_margin, planner.problem.limits
        words = repr(measures), repr(limits)
        del planner, plan
        gc.collect()
        swivel.plan(experiment("b"))  # takes the memory that was given back
        for array, copied in zip(kept, copies):
            np.testing.assert_array_equal(array, copied)
        self.assertEqual((repr(measures), repr(limits)), words)

    def test_arrays_are_views_that_cannot_be_written(self):
        plan = swivel.plan(experiment("c"))
        self.assertEqual(plan.joints.dtype, np.float64)
        self.assertEqual(plan.joints.shape, (109, 7))
        self.assertTrue(np.shares_memory(plan.joints, plan.trajectory.joints))
        with self.assertRaises(ValueError):
            plan.joints[0, 0] = 1
        self.assertEqual(swivel.plan(PROBLEMS / "experiment_a_start.yaml").joints.shape, (0, 7))

    def test_no_leak(self):
        planner = swivel.Planner(experiment("c", ds=0.02, dphi=0.1))

        def pages():
            return int(Path("/proc/self/statm").read_text().split()[1])

        def ask():
            plan = planner.plan(check=lambda joints: np.ones(len(joints), bool), threads=1)
            return plan.joints, plan.diagnosis

        for _ in range(50):
            ask()
        before = pages()
        for _ in range(300):
            ask()
        grown = (pages() - before) * os.sysconf("SC_PAGE_SIZE")
        print(f"300 plans more: {grown / 1e6:.2f} MB")
        self.assertLess(grown, 8e6)

    def test_numbers_go_in_and_out_unchanged(self):
        rng = np.random.default_rng(20261122)
        q = rng.normal(size=(50, 4))
        q /= np.linalg.norm(q, axis=1, keepdims=True)
        waypoints = np.hstack([rng.uniform(-1, 1, (50, 3)), q])
        np.testing.assert_array_equal(swivel.Task(waypoints).waypoints, waypoints)
        np.testing.assert_array_equal(swivel.Task(waypoints.tolist()).waypoints, waypoints)
        poses = np.array([swivel.pose(row[:3], quat=row[3:]) for row in waypoints])
        through = swivel.Task(poses).waypoints
        np.testing.assert_array_equal(through[:, :3], waypoints[:, :3])
        np.testing.assert_allclose(np.abs((through[:, 3:] * q).sum(axis=1)), 1, atol=1e-12)
        scene = swivel.Scene([swivel.SceneObject("box", swivel.Box([1, 2, 3]), poses[0])])
        np.testing.assert_array_equal(scene["box"].pose, poses[0])
        plan = swivel.plan(experiment("b"))
        rows = plan.trajectory
        again = swivel.Trajectory(rows.joints, rows.s, rows.phi, rows.branch, rows.joint_names)
        for member in ("joints", "s", "phi", "branch"):
            np.testing.assert_array_equal(getattr(again, member), getattr(rows, member))
        with tempfile.TemporaryDirectory() as folder:
            rows.save(Path(folder) / "t.csv")
            read = swivel.load_trajectory(Path(folder) / "t.csv", rows.joint_names)
            np.testing.assert_array_equal(read.joints, rows.joints)
            motion = swivel.time(
                experiment("c"), swivel.plan(experiment("c")).trajectory, speed=0.1
            )
            for ending in ("csv", "json", "yaml", "mcap"):
                motion.save(Path(folder) / f"m.{ending}")
                self.assertGreater((Path(folder) / f"m.{ending}").stat().st_size, 1000)
                read = swivel.load_trajectory(
                    Path(folder) / f"m.{ending}", motion.joint_names, experiment("c")
                )
                np.testing.assert_array_equal(read.joints, motion.joints)
                np.testing.assert_allclose(read.s, motion.s, atol=1e-6)
                check = swivel.check(experiment("c"), read)
                self.assertTrue(check.passed, check.failures)
            read = swivel.load_trajectory(Path(folder) / "m.csv", motion.joint_names)
            np.testing.assert_array_equal(read.velocities, motion.velocities)
            with self.assertRaisesRegex(swivel.InputError, "m.mcap: does not state"):
                swivel.load_trajectory(Path(folder) / "m.mcap", motion.joint_names)

    def test_parts_of_a_problem_change_in_place(self):
        problem = experiment("c")
        problem.limits.clearance = 0.007
        problem.resolution = swivel.Resolution(ds=0.02)
        problem.cost.metric = "time"
        problem.scene.remove("post")
        self.assertEqual(problem.limits.clearance, 0.007)
        self.assertEqual(problem.resolution, swivel.Resolution(ds=0.02))
        self.assertEqual(problem.cost.metric, swivel.CostMetric.TIME)
        self.assertNotIn("post", problem.scene)
        self.assertEqual([o.name for o in problem.scene], ["door", "rail"])
        task = problem.task
        task.limits.clearance = 1
        self.assertEqual(problem.limits.clearance, 0.007)
        for other in (copy.copy(problem), copy.deepcopy(problem)):
            other.scene.remove("door")
            other.limits.clearance = 9
            other.tool = swivel.pose([0, 0, 1])
        self.assertIn("door", problem.scene)
        self.assertEqual(problem.limits.clearance, 0.007)
        self.assertEqual(problem.tool[2, 3], experiment("c").tool[2, 3])
        self.assertEqual(copy.deepcopy(problem.task), problem.task)
        problem.start = np.arange(7)
        start = problem.start
        start[0] = 5
        np.testing.assert_array_equal(problem.start, np.arange(7.0))
        problem.start = None
        problem.end = np.arange(7)
        end = problem.end
        end[0] = 5
        np.testing.assert_array_equal(problem.end, np.arange(7.0))
        with self.assertRaisesRegex(ValueError, "end of shape"):
            problem.end = np.arange(5)
        problem.end = None
        limits = copy.copy(problem.limits)
        limits.clearance = 3
        self.assertEqual(problem.limits.clearance, 0.007)
        self.assertTrue(swivel.plan(problem).solved)


class Functions(unittest.TestCase):
    def test_a_thousand_states_are_one_call(self):
        problem, sizes = experiment("c", ds=0.05, dphi=0.015), []

        def check(joints):
            self.assertEqual(joints.shape, (len(joints), 7))
            sizes.append(len(joints))
            return np.ones(len(joints), bool)

        plan = swivel.plan(problem, check=check, planner="eager_dp")
        print("eager_dp:", len(sizes), "calls about", sum(sizes), "states, at most", max(sizes))
        self.assertEqual(len(sizes), plan.lattice.layers)  # one for each layer
        self.assertGreaterEqual(max(sizes), 1000)
        for planner in ("lazy", "parallel"):
            sizes.clear()
            other = swivel.plan(problem, check=check, planner=planner)
            np.testing.assert_array_equal(other.joints, plan.joints)
            self.assertLessEqual(len(sizes), sum(sizes) / 4)

    def test_rules_are_kept_by_all_planners(self):
        problem = experiment("c", ds=0.02, dphi=0.1)
        free = swivel.plan(problem)
        twist = np.abs(free.joints[:, 4] + free.joints[:, 6]).max()
        asked = []

        def hose(joints):
            asked.append(joints)
            return np.abs(joints[:, 4] + joints[:, 6]) < 0.9 * twist

        def moves(start, end):
            return np.abs(end - start).max(axis=1) < 0.4

        plans = [
            swivel.plan(problem, check=hose, check_motions=moves, planner=p)
            for p in ("eager", "eager_dp", "lazy", "parallel")
        ]
        states = np.vstack(asked)  # what was given may be kept
        self.assertTrue(np.isfinite(states).all())
        self.assertGreater(len(np.unique(states, axis=0)), 100)
        for plan in plans:
            np.testing.assert_array_equal(plan.joints, plans[0].joints)
        self.assertTrue(plans[0].solved)
        self.assertLess(np.abs(plans[0].joints[:, 4] + plans[0].joints[:, 6]).max(), 0.9 * twist)
        self.assertLess(np.abs(np.diff(plans[0].joints, axis=0)).max(), 0.4)
        none = swivel.plan(problem, check=lambda joints: np.zeros(len(joints), bool))
        self.assertEqual(none.diagnosis.cause.check, "<lambda>")

    def test_costs_are_added(self):
        problem = experiment("a", ds=0.02, dphi=0.1)
        plans = [
            swivel.plan(problem, cost=lambda q: 0.02 * (q**2).sum(axis=1), planner=p)
            for p in ("eager_dp", "lazy", "parallel")
        ]
        for plan in plans:
            np.testing.assert_array_equal(plan.joints, plans[0].joints)
        steps = np.linalg.norm(np.diff(plans[0].joints, axis=0), axis=1).sum()
        self.assertAlmostEqual(plans[0].cost, steps + 0.02 * (plans[0].joints ** 2).sum(), places=6)
        self.assertGreater(plans[0].cost, swivel.plan(problem).cost)

    def test_what_a_function_raises_comes_out(self):
        planner = swivel.Planner(experiment("c", ds=0.02, dphi=0.1))
        before = planner.plan()

        def broken(*_):
            raise KeyError("mine")

        for keyword in ("check", "check_motions", "cost", "progress"):
            with self.assertRaisesRegex(KeyError, "mine"):
                planner.plan(**{keyword: broken})
        for answer, wanted in (
            (lambda q: np.ones(len(q)), "float64 of shape"),
            (lambda q: np.ones((1, 1), bool), r"shape \(1, 1\)"),
            (lambda q: None, "allowed is bool of shape"),
            (lambda q: "yes", "allowed is bool of shape"),
        ):
            with self.assertRaisesRegex(ValueError, wanted):
                planner.plan(check=answer)
        with self.assertRaisesRegex(ValueError, "allowed is a number from 0"):
            planner.plan(cost=lambda q: -np.ones(len(q)))
        with self.assertRaisesRegex(TypeError, "check: not callable"):
            planner.plan(check=3)
        with self.assertRaisesRegex(RuntimeError, "clone"):
            planner.plan(check=lambda q: planner.plan())
        np.testing.assert_array_equal(planner.plan().joints, before.joints)

    def test_progress(self):
        seen = []

        def progress(stage, done, of):
            seen.append((stage, done, of))
            if len(seen) == 20:
                raise Enough

        with self.assertRaises(Enough):
            swivel.plan(endless(), planner=LONG, progress=progress)
        print("stages", sorted({stage for stage, _, _ in seen}))
        self.assertTrue(all(isinstance(stage, str) and done >= 0 for stage, done, _ in seen))


class Interrupts(unittest.TestCase):
    """Signals are sent by functions that a plan calls, so that it is certainly under way; it would
    take minutes."""

    def test_ctrl_c_stops_a_plan(self):
        for after in (1, 2, 3, 5, 10, 20):
            planner, calls = swivel.Planner(endless()), []

            def progress(*_):
                calls.append(None)
                if len(calls) == after:
                    interrupt()

            with self.assertRaises(KeyboardInterrupt):
                planner.plan(planner=LONG, progress=progress)
            planner.set_task(experiment("c", ds=0.02, dphi=0.1).task)
            self.assertTrue(planner.plan().solved)  # it is none the worse for it

    def test_ctrl_c_in_a_check(self):
        calls = []

        def check(joints):
            calls.append(None)
            if len(calls) == 3:
                interrupt()
            return np.ones(len(joints), bool)

        with self.assertRaises(KeyboardInterrupt):
            swivel.plan(endless(), check=check, planner=LONG)

    def test_ctrl_c_gives_the_rows_so_far(self):
        problem = experiment("c", ds=0.02, dphi=0.1)
        for run, whole in (
            (swivel.place, {"object": "rail", "x": (-0.02, 0.02, 0.002), "timeout": 60}),
            (swivel.campaign, {"episodes": 21}),
        ):
            def progress(rows, done, of):
                if done == 5:
                    interrupt()
                if done >= 5:
                    time.sleep(0.5)  # the thread that handles signals looks for them meanwhile

            with self.assertRaises(KeyboardInterrupt) as caught:
                run(problem, **whole, threads=1, progress=progress)
            rows = caught.exception.rows
            self.assertGreaterEqual(len(rows), 5)
            self.assertLess(len(rows), 21)
            every = run(problem, **whole)
            self.assertEqual(len(every), 21)
            self.assertIs(type(rows), type(every))
            number = "cell" if run is swivel.place else "episode"
            chosen = np.isin(getattr(every, number), getattr(rows, number))
            np.testing.assert_array_equal(rows.cost, every.cost[chosen])

    def test_a_handler_that_does_not_raise_does_not_stop(self):
        rung = []
        before = signal.signal(signal.SIGUSR1, lambda *_: rung.append(None))
        self.addCleanup(signal.signal, signal.SIGUSR1, before)

        def progress(*_):
            if len(rung) == 3:
                raise Enough
            os.kill(os.getpid(), signal.SIGUSR1)

        with self.assertRaises(Enough):  # after three handlers have run while it planned
            swivel.plan(endless(), planner=LONG, progress=progress)

    def test_python_ends_while_a_thread_plans(self):
        program = f"""
import sys, threading
sys.path.insert(0, {str(Path(__file__).parent)!r})
from python_test import LONG, endless, np, swivel
def forever(planning, **keywords):
    try:
        while True:
            swivel.plan(endless(), progress=lambda *_: planning.set(), **keywords)
    except RuntimeError:
        pass  # Python ends; what a daemon thread prints then may abort it
def check(joints):
    return np.ones(len(joints), bool)
for keywords in ({{"planner": LONG}}, {{"planner": LONG, "check": check}}, {{"planner": "lazy"}}):
    planning = threading.Event()
    threading.Thread(target=forever, args=(planning,), kwargs=keywords, daemon=True).start()
    planning.wait()
print("at its end")
"""
        for _ in range(3):
            run = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
            self.assertEqual((run.returncode, run.stdout), (0, "at its end\n"), run.stderr)

    def test_timeouts(self):
        plan = swivel.plan(endless(), planner=LONG, timeout=0.2)
        self.assertEqual(str(plan.status), "timeout")
        self.assertIsNone(plan.diagnosis)
        problem = experiment("c")
        rows = swivel.plan(problem).trajectory
        with self.assertRaises(TimeoutError):
            swivel.refine(problem, rows, timeout=1e-6)
        with self.assertRaises(TimeoutError):
            swivel.time(problem, rows, speed=0.1, timeout=1e-6)


class Errors(unittest.TestCase):
    def raises(self, error, message, function, *arguments, **keywords):
        with self.assertRaisesRegex(error, message) as caught:
            function(*arguments, **keywords)
        self.assertNotIn("\n", str(caught.exception))

    def test_files(self):
        with tempfile.TemporaryDirectory() as folder:
            bad = Path(folder) / "bad.yaml"
            bad.write_text("robot: {urdf: x.urdf}\nfoo: 1\n")
            self.raises(swivel.InputError, r"bad.yaml:2: .*foo", swivel.load, bad)
            self.raises(ValueError, r"bad.yaml:2", swivel.plan, bad)
            broken = Path(folder) / "broken.urdf"
            broken.write_text("<robot name='r'>\n<link/>\n</robot>")
            self.raises(swivel.InputError, r"broken.urdf:2", swivel.Robot, broken)
            self.raises(swivel.InputError, "absent.stl", swivel.Mesh, Path(folder) / "absent.stl")
            rows = swivel.plan(experiment("b")).trajectory
            self.raises(swivel.InputError, "nowhere", rows.save, Path(folder) / "nowhere" / "t.csv")
            motion = swivel.time(
                experiment("c"), swivel.plan(experiment("c")).trajectory, speed=0.1
            )
            self.raises(swivel.InputError, "unknown format", motion.save, Path(folder) / "m.txt")
        self.raises(swivel.InputError, "URDF text:1", swivel.Robot.from_string, "<robot>")
        self.raises(
            swivel.InputError, "tool00.*nearest|unknown link", swivel.Robot, ROBOTS / "iiwa14.urdf",
            tip="tool00"
        )

    def test_values(self):
        self.raises(TypeError, "'clearence', nearest is 'clearance'", swivel.Limits, clearence=1)
        self.raises(
            ValueError, "EdgeMode: 'some': allowed are continuous, nodes", swivel.Limits,
            edges="some"
        )
        self.raises(
            ValueError, "allowed are eager, eager_dp, lazy, parallel", swivel.plan, experiment("b"),
            planner="lasy"
        )
        for keywords in (
            {"threads": -1},
            {"timeout": 0},
            {"rate": 100},
            {"chord": 1e-6},
            {"speed": 0},
            {"speed": 0.1, "rate": 0},
            {"speed": 0.1, "chord": -1},
            {"speed": float("nan")},
        ):
            self.raises(
                ValueError, next(iter(reversed(keywords))) + ".*allowed", swivel.plan,
                experiment("b"), **keywords
            )
        self.raises(
            ValueError,
            r"pose of shape \(2,\)",
            swivel.SceneObject,
            "box",
            swivel.Box([1, 1, 1]),
            [1, 2],
        )
        self.raises(
            ValueError, "no rigid transform", swivel.SceneObject, "box", swivel.Box([1, 1, 1]),
            2 * np.eye(4)
        )
        self.raises(
            ValueError,
            r"waypoints\[1\]: pose of shape \(3,\)",
            swivel.Task,
            [[0, 0, 0, 1, 0, 0, 0], [1, 2, 3]],
        )
        self.raises(ValueError, "not an array of numbers", swivel.Task, ["here", "there"])
        self.raises(
            ValueError,
            "quaternion of length 2",
            swivel.SceneObject,
            "box",
            swivel.Box([1, 1, 1]),
            [0, 0, 0, 2, 0, 0, 0],
        )
        self.raises(ValueError, r"joints of shape \(3,\)", arm().tool_pose, [1, 2, 3])
        self.raises(
            ValueError, r"start of shape \(3,\): allowed is \(7,\)", square, start=[1, 2, 3]
        )
        self.raises(ValueError, "names vertex 3", swivel.Mesh.from_arrays, np.eye(3), [[0, 1, 3]])
        self.raises(
            ValueError,
            "s: allowed is one number for each of the 2 rows",
            swivel.Trajectory,
            np.zeros((2, 7)),
            [1.0],
        )
        self.raises(ValueError, "branch", swivel.Trajectory, np.zeros((1, 7)), [0], [0], [9])

    def test_what_no_problem_may_have(self):
        planner = swivel.Planner(arm(), square())
        self.raises(
            swivel.InvalidArgument, "radius", planner.add,
            swivel.SceneObject("ball", swivel.Sphere(-1))
        )
        planner.add(swivel.SceneObject("ball", swivel.Sphere(0.1), [0, 0, 2]))
        self.raises(
            swivel.InvalidArgument, "taken", planner.add,
            swivel.SceneObject("ball", swivel.Sphere(0.1))
        )
        self.raises(swivel.InvalidArgument, "no such object", planner.move, "bull", np.eye(4))
        self.raises(
            KeyError, "bull.*nearest is 'ball'", planner.problem.scene.move, "bull", np.eye(4)
        )
        task = square()
        task.limits.clearance = float("nan")
        self.raises(swivel.InvalidArgument, "limits.clearance", planner.set_task, task)
        problem = planner.problem
        problem.resolution.ds = 0
        self.raises(swivel.InvalidArgument, "resolution.ds", problem.validate)
        self.assertTrue(planner.plan().solved)
        self.raises(swivel.InputError, "waypoint", swivel.Planner(arm()).plan)
        with self.assertRaises(AttributeError):
            planner.problem.scene["ball"].pose = np.eye(4)
        with self.assertRaises(TypeError):
            swivel.Planner(3)


class Robots(unittest.TestCase):
    def test_from_texts(self):
        urdf, srdf = (ROBOTS / "iiwa14.urdf").read_text(), (ROBOTS / "iiwa14.srdf").read_text()
        one, other = arm(), swivel.Robot.from_string(urdf, srdf)
        self.assertEqual(
            (one.base, one.tip, one.joint_names), (other.base, other.tip, other.joint_names)
        )
        np.testing.assert_array_equal(
            swivel.Planner(one, square()).plan().joints,
            swivel.Planner(other, square()).plan().joints,
        )

    def test_tool_poses(self):
        robot = arm(tool=swivel.pose([0, 0, 0.1], rpy=[0, 0.3, 0]))
        plan = swivel.Planner(robot, square()).plan()
        poses = robot.tool_pose(plan.joints)
        self.assertEqual(poses.shape, (len(plan.joints), 4, 4))
        np.testing.assert_array_equal(robot.tool_pose(plan.joints[3]), poses[3])
        np.testing.assert_allclose(poses[0][:3, 3], [0.45, -0.1, 0.4], atol=1e-9)
        np.testing.assert_allclose(
            poses[:, :3, :3], np.broadcast_to(np.diag([1, -1, -1]), (len(poses), 3, 3)), atol=1e-9
        )
        self.assertEqual(robot.joint_limits.shape, (7, 2))
        self.assertTrue((robot.joint_limits[:, 0] < plan.joints.min(axis=0)).all())
        self.assertTrue((robot.joint_limits[:, 1] > plan.joints.max(axis=0)).all())

    def test_limits_of_joints_by_name(self):
        with tempfile.TemporaryDirectory() as folder:
            limits = Path(folder) / "joint_limits.yaml"
            limits.write_text("joint_limits: {joint_a2: {min_position: -1, max_position: 1}}")
            robot = swivel.Robot(
                ROBOTS / "iiwa14.urdf", joint_limits=limits, limits={"joint_a1": (-0.5, 0.75)}
            )
        self.assertEqual(robot.joint_limits[:2].tolist(), [[-0.5, 0.75], [-1, 1]])
        with self.assertRaisesRegex(swivel.InputError, "joint_a1.*reaches beyond"):
            swivel.Robot(ROBOTS / "iiwa14.urdf", limits={"joint_a1": (-9, 9)})

    def test_links_left_out_and_soft_limits(self):
        urdf = (ROBOTS / "iiwa14.urdf").read_text()
        hand = (
            '<link name="hand"/><joint name="mount" type="fixed"><parent link="tool0"/>'
            '<child link="hand"/></joint></robot>'
        )
        safety = (
            'velocity="1.4835298641951802"/><safety_controller soft_lower_limit="-0.5" '
            'soft_upper_limit="0.5"/>'
        )
        urdf = urdf.replace("</robot>", hand).replace('velocity="1.4835298641951802"/>', safety, 1)
        soft, hard = swivel.Robot.from_string(urdf), swivel.Robot.from_string(
            urdf, without=["hand"], soft_limits=False
        )
        self.assertEqual(soft.joint_limits[0].tolist(), [-0.5, 0.5])
        self.assertLess(hard.joint_limits[0, 0], -2.9)
        self.assertEqual(set(soft.links) - set(hard.links), {"hand"})
        plan = swivel.Planner(soft, square()).plan()
        self.assertTrue(any("soft limits" in warning for warning in plan.warnings), plan.warnings)
        with self.assertRaisesRegex(swivel.InputError, "nearest is 'hand'"):
            swivel.Robot.from_string(urdf, without=["hnad"])

    def test_of_six_joints(self):
        problem = swivel.load(PROBLEMS / "ur5e_deburr_edge.yaml")
        self.assertIsNotNone(problem.roll)
        self.assertEqual(len(problem.joint_names), 7)
        robot = swivel.Robot(
            ROBOTS / "ur5e_like.urdf", base=problem.base, tip=problem.tip,
            roll=swivel.Roll(lower=-1, upper=1)
        )
        self.assertEqual(robot.roll, swivel.Roll(lower=-1, upper=1))
        found = swivel.Robot(ROBOTS / "ur5e_like.urdf", roll=swivel.Roll())
        self.assertEqual((found.base, found.tip), (problem.base, problem.tip))
        fixed = swivel.Robot(ROBOTS / "ur5e_like.urdf")
        self.assertEqual((fixed.roll, len(fixed.joint_names)), (None, 6))
        with self.assertRaisesRegex(ValueError, "no arm of six joints in a row was found"):
            swivel.Robot(ROBOTS / "iiwa14.urdf", roll=swivel.Roll())

    def test_roll_weighs_alike_from_files_and_from_memory(self):
        for name, weights in (("kr6_weld_pipe", [1] * 6 + [0]), ("torch_door", [1] * 7)):
            problem = swivel.load(PROBLEMS / f"{name}.yaml")
            self.assertIsNone(problem.cost.weights)
            costs = []
            for cost in (None, swivel.Cost(), swivel.Cost(weights=weights)):
                if cost is not None:
                    problem.cost = cost
                plan = swivel.plan(problem, planner="lazy")
                steps = np.diff(plan.joints, axis=0) * weights
                self.assertAlmostEqual(plan.cost, np.linalg.norm(steps, axis=1).sum(), delta=1e-9)
                costs.append(plan.cost)
            self.assertEqual(costs, [costs[0]] * 3)

    def test_windows_of_roll(self):
        problem = swivel.load(PROBLEMS / "ur5e_deburr_edge.yaml")
        n = len(problem.waypoints)
        windows = np.column_stack([np.linspace(-0.4, 0.1, n), np.linspace(0.0, 0.1, n)])
        problem.waypoints = np.hstack([problem.waypoints, windows])
        self.assertEqual(problem.waypoints.shape, (n, 9))
        np.testing.assert_array_equal(problem.waypoints[:, 7:], windows)
        np.testing.assert_array_equal(
            pickle.loads(pickle.dumps(problem)).waypoints, problem.waypoints
        )
        plan = swivel.Planner(problem).plan()
        self.assertTrue(plan.solved)
        self.assertAlmostEqual(plan.joints[-1, 6], 0.1, delta=1e-8)
        self.assertTrue(-0.4 - 1e-9 <= plan.joints[0, 6] <= 1e-9)
        with self.assertRaisesRegex(
            ValueError, r"waypoints\[1\]: roll_min and roll_max are not given at all waypoints"
        ):
            problem.waypoints = [problem.waypoints[0], problem.waypoints[1][:7]]
        free = swivel.Robot(
            ROBOTS / "ur5e_like.urdf", base=problem.base, tip=problem.tip, roll=swivel.Roll()
        )
        with self.assertRaisesRegex(
            ValueError, "circle: allowed is a robot whose roll has a range of less than a turn"
        ):
            swivel.Planner(free, swivel.Task(problem.waypoints))

    def test_what_it_carries(self):
        planner = swivel.Planner(arm(), square())
        free = planner.plan(evidence=True)
        planner.attach(
            swivel.AttachedBody("plate", swivel.Box([0.4, 0.4, 0.01]), "tool0", [0, 0, 0.02])
        )
        planner.add(swivel.SceneObject("post", swivel.Cylinder(0.02, 1), [0.3, 0.0, 0.4]))
        carrying = planner.plan(evidence=True)
        self.assertNotEqual(
            carrying.measures.min_clearance if carrying.solved else None,
            free.measures.min_clearance,
        )
        planner.detach("plate")
        planner.remove("post")
        np.testing.assert_array_equal(planner.plan().joints, free.joints)

    def test_meshes(self):
        corners = (
            np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], float) * 0.2 - 0.1
        )
        faces = [
            [0, 1, 3],
            [0, 3, 2],
            [4, 6, 7],
            [4, 7, 5],
            [0, 4, 5],
            [0, 5, 1],
            [2, 3, 7],
            [2, 7, 6],
            [0, 2, 6],
            [0, 6, 4],
            [1, 5, 7],
            [1, 7, 3],
        ]
        mesh = swivel.Mesh.from_arrays(corners, faces, "cube")
        self.assertTrue(mesh.closed)
        np.testing.assert_array_equal(mesh.vertices, corners)
        plans = [
            swivel.Planner(
                arm(), square(), [swivel.SceneObject("cube", shape, [0.55, 0.0, 0.2])]
            ).plan(evidence=True)
            for shape in (mesh, swivel.Box([0.2, 0.2, 0.2]))
        ]
        self.assertAlmostEqual(
            plans[0].measures.min_clearance, plans[1].measures.min_clearance, places=5
        )


class Cartesian(unittest.TestCase):
    def setUp(self):
        self.robot = arm()
        self.start = swivel.Planner(self.robot, square()).plan().joints[0]
        self.there = self.robot.tool_pose(self.start)
        self.there[1, 3] += 0.3

    def test_whole_and_part(self):
        fraction, whole = swivel.compute_cartesian_path(self.robot, [], [self.there], self.start)
        self.assertEqual(fraction, 1.0)
        np.testing.assert_array_equal(whole.joints[0], self.start)
        np.testing.assert_allclose(self.robot.tool_pose(whole.joints[-1]), self.there, atol=1e-9)
        self.assertEqual(len(whole), 61)
        scene = swivel.Scene()
        scene.add("wall", swivel.Box([0.05, 0.02, 0.05]), self.there[:3, 3] - [0, 0.05, 0])
        fraction, part = swivel.compute_cartesian_path(self.robot, scene, [self.there], self.start)
        self.assertTrue(0.1 < fraction < 0.75, fraction)
        self.assertAlmostEqual(part.s[-1], 0.3 * fraction, places=9)
        fraction, _ = swivel.compute_cartesian_path(
            self.robot, scene, [self.there], self.start, max_step=0.02, planner="lazy"
        )
        self.assertTrue(0.1 < fraction < 0.75, fraction)

    def test_ways_to_say_it(self):
        rows = swivel.Task([self.there]).waypoints
        results = [
            swivel.compute_cartesian_path(self.robot, [], waypoints, self.start)
            for waypoints in (
                [self.there],
                np.array([self.there]),
                rows,
                rows.tolist(),
                [self.robot.tool_pose(self.start), self.there],
            )
        ]
        for fraction, trajectory in results:
            self.assertEqual(fraction, 1.0)
            np.testing.assert_allclose(trajectory.joints, results[0][1].joints, atol=1e-9)
        fraction, free = swivel.compute_cartesian_path(
            self.robot, [], [self.robot.tool_pose(self.start), self.there], None
        )
        self.assertEqual(fraction, 1.0)

    def test_a_tool_that_may_turn_about_its_axis(self):
        robot = arm(base="base_link", tip="tool0", roll=swivel.Roll(lower=-0.3, upper=0.3))
        wall = [swivel.SceneObject("wall", swivel.Box([0.05, 0.02, 0.05]), self.there)]
        fraction, rows = swivel.compute_cartesian_path(robot, wall, [self.there], self.start)
        self.assertTrue(0 < fraction < 1, fraction)
        self.assertAlmostEqual(rows.s[-1], 0.3 * fraction, places=9)

    def test_a_start_in_collision_goes_nowhere(self):
        wall = [
            swivel.SceneObject(
                "wall", swivel.Box([0.1, 0.1, 0.1]), self.robot.tool_pose(self.start)
            )
        ]
        fraction, rows = swivel.compute_cartesian_path(self.robot, wall, [self.there], self.start)
        self.assertEqual((fraction, len(rows)), (0.0, 0))


class Threads(unittest.TestCase):
    """What one thread waits for is done by another: nothing here depends on which of them runs
    when."""

    def test_python_runs_while_a_plan_does(self):
        planning = threading.Event()

        def count():
            planning.wait()
            for _ in range(1000):
                pass
            interrupt()  # a plan that kept Python to itself would go on for minutes

        counter = threading.Thread(target=count)
        counter.start()
        with self.assertRaises(KeyboardInterrupt):
            swivel.plan(endless(), planner=LONG, threads=1, progress=lambda *_: planning.set())
        counter.join()

    def test_a_planner_is_for_one_thread_at_a_time(self):
        planner, planning, seen = (
            swivel.Planner(experiment("c", ds=0.02, dphi=0.1)), threading.Event(), threading.Event()
        )

        def check(joints):
            planning.set()
            seen.wait()
            return np.ones(len(joints), bool)

        thread = threading.Thread(target=lambda: planner.plan(check=check))
        thread.start()
        planning.wait()
        try:
            with self.assertRaisesRegex(RuntimeError, r"clone\(\)"):
                planner.problem
            self.assertEqual(repr(planner), "<Planner, at work>")
        finally:
            seen.set()
            thread.join()
        planner.problem  # free again

    def test_what_goes_wrong_in_another_thread_is_told_there(self):
        planner = swivel.Planner(experiment("c", ds=0.02, dphi=0.1))
        rows, asked = planner.plan().trajectory, []

        def broken(joints):
            asked.append(threading.get_ident())
            raise KeyError("mine")

        def other():
            with self.assertRaisesRegex(KeyError, "mine"):
                planner.plan(check=broken, planner="lazy")
            with self.assertRaises(TimeoutError):
                planner.refine(rows, timeout=1e-6)
            np.testing.assert_array_equal(
                planner.plan(check=lambda joints: np.ones(len(joints), bool)).joints, rows.joints
            )
            done.append(threading.get_ident())

        done = []
        thread = threading.Thread(target=other)
        thread.start()
        thread.join()
        self.assertEqual(done, asked)  # the thread that plans is the caller's

    def test_two_threads_plan_what_one_does(self):
        planner = swivel.Planner(experiment("c", dphi=0.02, ds=0.003))

        def walk(own):
            door = own.problem.scene["door"].pose
            for k in range(20):
                door[0, 3] += 1e-3 * (k % 5)
                own.move("door", door)
                yield own.plan(planner="lazy").joints.tobytes()

        clones = [planner.clone() for _ in range(2)]
        expected, answers = list(walk(planner)), [[], []]
        workers = [
            threading.Thread(target=lambda clone, answer: answer.extend(walk(clone)), args=one)
            for one in zip(clones, answers)
        ]
        for worker in workers:
            worker.start()
        for worker in workers:
            worker.join()
        self.assertEqual(answers, [expected, expected])
        self.assertGreater(len(set(expected)), 1)


class Places(unittest.TestCase):
    QUICK = ("--planner", "lazy", "--ds", "0.02", "--dphi", "0.2")
    GRID = {"x": (-0.1, 0.1, 0.05), "y": (0, 0.1, 0.05), "yaw": 0.1}

    @staticmethod
    def problem():
        return experiment("c", ds=0.02, dphi=0.2)

    def table(self, command, *arguments):
        with tempfile.TemporaryDirectory() as folder:
            out = Path(folder) / "out.csv"
            run = subprocess.run(
                [
                    PROGRAM, command, PROBLEMS / "experiment_c.yaml", *self.QUICK, *arguments,
                    "--out", out
                ],
                capture_output=True,
                text=True,
            )
            self.assertIn(run.returncode, (0, 1), run.stderr)
            return out.read_text()

    def saved(self, table):
        with tempfile.TemporaryDirectory() as folder:
            table.save(Path(folder) / "out.csv")
            return (Path(folder) / "out.csv").read_text()

    def test_the_program_gives_the_same_table(self):
        grid = ("--x", "-0.1:0.1:0.05", "--y", "0:0.1:0.05", "--yaw", "0.1")
        fine = {"x": (-0.1, 0.1, 0.02), "y": (-0.1, 0.1, 0.02)}
        count = 0
        for options, keywords in (
            (("--object", "door", *grid), {"object": "door", **self.GRID}),
            (("--base", *grid), {"base": True, **self.GRID}),
            (
                ("--path", "--x", "-0.1:0.1", "--z", "0.01", "--sample", "9", "--seed", "5"),
                {"path": True, "x": (-0.1, 0.1), "z": 0.01, "sample": 9, "seed": 5},
            ),
            (
                (
                    "--object", "door", "--x", "-0.1:0.1:0.02", "--y", "-0.1:0.1:0.02",
                    "--refine-grid", "--best", "speed"
                ),
                {"object": "door", **fine, "refine_grid": True, "best": "speed"},
            ),
            (
                ("--hold", "torso_joint_b1=-0.2:0.2:0.1", "--base", "--y", "0:0.1:0.1"),
                {"hold": {"torso_joint_b1": (-0.2, 0.2, 0.1)}, "base": True, "y": (0, 0.1, 0.1)},
            ),
            (
                ("--hold", "torso_joint_b1=-0.2:0.2", "--sample", "5"),
                {"hold": {"torso_joint_b1": (-0.2, 0.2)}, "sample": 5},
            ),
        ):
            wanted = self.table("place", *options)
            for threads in (1, 2):
                rows = swivel.place(self.problem(), planner="lazy", threads=threads, **keywords)
                self.assertEqual(self.saved(rows), wanted)
                count += len(rows)
        self.assertGreater(count, 100)

    def test_joints_that_are_held(self):
        problem = self.problem()
        torso = {"torso_joint_b1": (-0.2, 0.2, 0.2)}
        rows = swivel.place(problem, hold=torso, planner="lazy")
        np.testing.assert_array_equal(rows.hold["torso_joint_b1"], [-0.2, 0, 0.2])
        self.assertFalse(rows.offset.any())
        self.assertTrue(rows.solved.any())
        for row in rows:
            self.assertEqual(list(row.hold), ["torso_joint_b1"])
            held = problem.placed(row.offset, hold=row.hold)
            self.assertEqual(held.robot.hold, {**problem.robot.hold, **row.hold})
            plan = swivel.plan(held, planner="lazy", evidence=True)
            self.assertEqual((plan.status, plan.cost), (row.status, row.cost))
            self.assertIn(f"torso_joint_b1 at {row.hold['torso_joint_b1']:.6g}", repr(row))
        self.assertIsNone(rows[0].slide_margin)
        again = pickle.loads(pickle.dumps(rows))
        self.assertEqual(self.saved(again), self.saved(rows))
        self.assertEqual(swivel.place(problem, object="door", x=0.1).hold, {})
        for words, keywords in (
            ("'torso', nearest is 'torso_joint_b1'", {"hold": {"torso": 0}}),
            ("outside its limits", {"hold": {"torso_joint_b1": (0, 9, 1)}}),
            ("is planned", {"hold": {"arm_left_joint_1_s": 0}}),
            ("hold: 'torso_joint_b1': allowed is a number", {"hold": {"torso_joint_b1": (0, 1)}}),
            ("exactly one", {"hold": torso, "x": 0.1}),
            ("arm: ", {"path": True, "arm": "left", "x": 0.1}),
            ("whose path", {"base": True, "arm": "left", "x": 0.1}),
        ):
            with self.assertRaisesRegex(swivel.InvalidArgument, words):
                swivel.place(problem, **keywords)

    def test_rows_and_columns(self):
        problem = self.problem()
        rows = swivel.place(problem, object="door", planner="lazy", **self.GRID)
        self.assertEqual(len(rows), 15)
        self.assertEqual(rows.offset.shape, (15, 6))
        self.assertEqual(rows.cell.tolist(), list(range(15)))
        solved = [k for k in range(15) if rows.solved[k]]
        self.assertTrue(0 < len(solved) < 15)
        for k in range(15):
            row = rows[k]
            self.assertEqual(
                (row.cell, row.offset.tolist(), row.status),
                (k, rows.offset[k].tolist(), rows.status[k]),
            )
            plan = swivel.plan(
                problem.placed(row.offset, object="door"), planner="lazy", evidence=True
            )
            self.assertEqual((plan.status, plan.cost), (row.status, row.cost))
            if row.solved:
                self.assertEqual(
                    (rows.cost[k], row.clearance_margin, row.tool_speed),
                    (row.cost, plan.measures.min_margin.margin, plan.measures.top_tool_speed.speed),
                )
                self.assertRegex(repr(row), r"<Placement \d+.*, yaw 0.1: cost [0-9.]+, clearance ")
            else:
                self.assertTrue(np.isnan(rows.cost[k]) and row.cost is None)
                self.assertEqual(rows.reason[k], row.reason)
                self.assertIn("no path, " + row.reason, repr(row))
        self.assertEqual(rows[-1].cell, 14)
        with self.assertRaises(IndexError):
            rows[15]
        self.assertEqual(
            [row.cell for row in rows.best("cost", 3)],
            sorted(solved, key=lambda k: (round(rows.cost[k], 9), k))[:3],
        )
        self.assertEqual(
            [row.cell for row in rows.best(["clearance", "cost"], 99)],
            sorted(
                solved,
                key=lambda k: (round(-rows.clearance_margin[k], 9), round(rows.cost[k], 9), k),
            ),
        )
        self.assertRegex(
            repr(rows),
            r"^<Placements: 15, of which %d have a path; cost [0-9.]+ to [0-9.]+>$" % len(solved),
        )

    def test_campaigns(self):
        without = lambda text: [
            [*line.split(",")[:3], *line.split(",")[4:]] for line in text.splitlines()
        ]
        rows = swivel.campaign(self.problem(), episodes=12, seed=3, planner="lazy")
        self.assertEqual(
            without(self.saved(rows)),
            without(self.table("campaign", "--episodes", "12", "--seed", "3")),
        )
        self.assertEqual(rows.episode.tolist(), list(range(12)))
        self.assertTrue((rows.plan_ms > 0).all())
        plan = swivel.plan(self.problem().episode(3, 5), planner="lazy")
        self.assertEqual(
            (rows[5].status, rows[5].cost, rows[5].nodes_checked),
            (plan.status, plan.cost, plan.counters["nodes_checked"]),
        )
        self.assertRegex(repr(rows), r"^<Episodes: 12, of which \d+ have a path; cost ")
        self.assertRegex(repr(rows[0]), r"^<Episode 0: .* ms>$")

    def test_progress(self):
        seen = []
        rows = swivel.place(
            self.problem(), object="door", planner="lazy",
            progress=lambda part, done, of: seen.append((part[0].cell, done, of)), **self.GRID
        )
        self.assertEqual(sorted(cell for cell, _, _ in seen), rows.cell.tolist())
        self.assertEqual([(done, of) for _, done, of in seen], [(k + 1, 15) for k in range(15)])
        seen.clear()
        swivel.campaign(
            self.problem(), episodes=6,
            progress=lambda part, done, of: seen.append((part[0].episode, done, of))
        )
        self.assertEqual(seen, [(k, k + 1, 6) for k in range(6)])

        def broken(*_):
            raise KeyError("mine")

        for many in (
            lambda: swivel.place(self.problem(), object="door", progress=broken, **self.GRID),
            lambda: swivel.campaign(self.problem(), progress=broken),
        ):
            with self.assertRaisesRegex(KeyError, "mine"):
                many()

    def test_timeout_and_ctrl_c(self):
        many = {"object": "door", "x": (-0.1, 0.1, 0.0005), "y": (-0.1, 0.1, 0.0005)}
        seen = []
        rows = swivel.place(
            self.problem(),
            timeout=0.5,
            progress=lambda rows, *_: seen.extend(row.cell for row in rows),
            **many,
        )
        self.assertLess(len(rows), 160801)
        self.assertEqual(sorted(row.cell for row in rows), sorted(seen))
        stop = {"progress": lambda *_: interrupt()}
        for work in (
            lambda: swivel.place(self.problem(), **many, **stop),
            lambda: swivel.campaign(self.problem(), episodes=100000, **stop),
        ):
            with self.assertRaises(KeyboardInterrupt):
                work()

    def test_bad_values(self):
        problem = self.problem()
        for keywords, words in (
            ({"x": 0}, "exactly one"),
            ({"object": "door", "base": True, "x": 0}, "exactly one"),
            ({"object": "door"}, "one or more"),
            ({"object": "dor", "x": 0}, "'dor'"),
            ({"object": "door", "x": (0, 1)}, "step"),
            ({"object": "door", "x": (1, 0, 0.1)}, "from <= to"),
            ({"object": "door", "x": (0, 1, 0)}, "step > 0"),
            ({"object": "door", "x": (0, 1, 1e-300)}, "larger step"),
            ({"object": "door", "x": (0, 1, 1e-4), "y": (0, 1, 1e-4)}, "1000000"),
            ({"object": "door", "x": (0, 1), "sample": 0}, "1000000"),
            ({"object": "door", "x": (0, 1), "sample": 5, "refine_grid": True}, "without sample"),
            ({"object": "door", "x": 0, "planner": "magic"}, "eager_dp"),
            (
                {"object": "door", "x": (0, 1, 0.5), "refine_grid": True, "best": "fastest"},
                "clearance, cost",
            ),
            ({"object": "door", "x": float("nan")}, "1000"),
            ({"object": "door", "x": 0, "threads": -1}, "1024"),
            ({"object": "door", "x": 0, "timeout": 0}, "above 0"),
        ):
            with self.assertRaisesRegex(ValueError, words):
                swivel.place(problem, **keywords)
        with self.assertRaisesRegex(ValueError, "vary"):
            swivel.campaign(PROBLEMS / "experiment_a.yaml")
        with self.assertRaisesRegex(ValueError, "episodes: 0"):
            swivel.campaign(problem, episodes=0)
        with self.assertRaisesRegex(ValueError, "exactly one"):
            problem.placed(np.zeros(6))


class Pickles(unittest.TestCase):
    """What went through pickle is what went in: every public attribute, and what is planned of
    it."""

    def setUp(self):
        self.count = 0

    def same(self, a, b, where):
        self.assertIs(type(a), type(b), where)
        self.count += 1
        if isinstance(a, np.ndarray):
            self.assertEqual((a.dtype, a.shape), (b.dtype, b.shape), where)
            self.assertTrue(np.array_equal(a, b, equal_nan=a.dtype.kind == "f"), where)
        elif isinstance(a, (list, tuple)):
            self.assertEqual(len(a), len(b), where)
            for k, (x, y) in enumerate(zip(a, b)):
                self.same(x, y, f"{where}[{k}]")
        elif isinstance(a, dict):
            self.assertEqual(list(a), list(b), where)
            for key in a:
                self.same(a[key], b[key], f"{where}[{key!r}]")
        elif isinstance(a, swivel.Scene):
            self.same(list(a), list(b), where)
        elif type(a).__module__ != "swivel" or hasattr(type(a), "__members__"):
            self.assertTrue(a == b or a != a, where)
        else:
            self.assertEqual(repr(a), repr(b), where)
            for name in dir(type(a)):
                member = getattr(type(a), name)
                if (
                    not name.startswith("_")
                    and isinstance(member, property)
                    and not (isinstance(a, swivel.Motion) and not a.executable)
                    and not self.is_again(a, name)
                    and hasattr(a, name)
                ):
                    self.same(getattr(a, name), getattr(b, name), f"{where}.{name}")

    @staticmethod
    def is_again(thing, name):
        """Whether a member of a thing is of the thing's own class, without end."""
        one_run = isinstance(thing, swivel.Check) and len(thing.runs) == 1
        return name == "arms" and isinstance(thing, (swivel.Problem, swivel.Motion)) or (
            name == "runs" and one_run
        )

    def through(self, thing):
        for protocol in (2, pickle.HIGHEST_PROTOCOL):
            self.same(thing, pickle.loads(pickle.dumps(thing, protocol)), type(thing).__name__)
        return pickle.loads(pickle.dumps(thing))

    def test_errors_keep_their_message(self):
        for kind in (swivel.InputError, swivel.InvalidArgument):
            again = pickle.loads(pickle.dumps(kind("a.yaml:3: ds: allowed are numbers above 0")))
            self.assertIs(type(again), kind)
            self.assertEqual(str(again), "a.yaml:3: ds: allowed are numbers above 0")

    def test_problems(self):
        for file in sorted(PROBLEMS.glob("*.yaml")):
            if file.stem.endswith(("_job", "_workcell")):
                continue
            problem = swivel.load(file)
            problem.limits.joint_jerk = [1.0, 2, 3, 4, 5, 6, 7]
            again = self.through(problem)
            for part in (problem.robot, problem.task, problem.scene):
                self.through(part)
            if file.stem in (
                "experiment_a", "experiment_b", "experiment_c", "panda_weld_seam", "kr6_weld_pipe"
            ):
                one, two = swivel.plan(problem, planner="lazy"), swivel.plan(again, planner="lazy")
                self.assertTrue(one.solved)
                self.assertEqual(
                    (one.joints.tobytes(), one.cost, one.counters),
                    (two.joints.tobytes(), two.cost, two.counters),
                )
            if file.stem == "experiment_c":
                self.assertEqual(
                    swivel.plan(problem.episode(1, 4), planner="lazy").cost,
                    swivel.plan(again.episode(1, 4), planner="lazy").cost,
                )
        print(self.count, "values compared")
        self.assertGreater(self.count, 5000)

    def test_parts(self):
        corners, faces = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], [
            [0, 2, 1],
            [0, 1, 3],
            [0, 3, 2],
            [1, 2, 3],
        ]
        mesh = swivel.Mesh.from_arrays(corners, faces)
        for thing in (
            swivel.Sphere(0.1),
            swivel.Box([0.1, 1 / 3, 0.3]),
            swivel.Cylinder(0.1, 0.2),
            swivel.Capsule(0.1, 0.2),
            mesh,
            swivel.Roll(lower=-1 / 3),
            swivel.Limits(edges="nodes"),
            swivel.AttachedBody(
                "tool", mesh, "flange", swivel.pose([0, 0, 0.1], rpy=[0.1, 0.2, 0.3])
            ),
            swivel.SceneObject("box", mesh, [1, 2, 3], ["flange"]),
            swivel.Resolution(arc=0.3),
            swivel.Cost(metric="max"),
            swivel.PathSmoothing(angle=0.1),
            swivel.Refinement(smoothing=0.2),
        ):
            self.through(thing)

    def test_a_mesh_of_many_is_written_once(self):
        problem = swivel.load(PROBLEMS / "experiment_c_20k.yaml")
        size = len(pickle.dumps(problem))
        mesh = problem.scene["door"].shape
        for k in range(20):
            problem.scene.add(f"door {k}", mesh, [k + 2, 0, 0])
        self.assertLess(len(pickle.dumps(problem)), 1.02 * size)

    def test_answers(self):
        problem = experiment("c")
        plan = self.through(swivel.plan(problem, refine=True, speed=0.1, evidence=True))
        self.assertEqual(plan.to_json(), pickle.loads(pickle.dumps(plan)).to_json())
        for thing in (
            plan.motion, plan.refinement, plan.trajectory, plan.measures,
            swivel.check(problem, plan.trajectory)
        ):
            self.through(thing)
        slow = experiment("c")
        slow.limits.joint_acceleration = [0.3] * 7
        self.assertTrue(self.through(swivel.plan(slow, speed=0.25).motion).slow)
        none = swivel.plan(PROBLEMS / "experiment_a_start.yaml", evidence=True)
        self.assertTrue(self.through(none).diagnosis.cause)
        far = experiment("a")
        far.waypoints = (
            far.waypoints + [2, 0, 0, 0, 0, 0, 0] * np.linspace(0, 1, len(far.waypoints))[:, None]
        )
        far = swivel.plan(far, evidence=True)
        self.assertTrue(self.through(far).diagnosis.empty_layers)
        self.assertTrue(far.diagnosis.removed)
        advice = swivel.advise(PROBLEMS / "experiment_a_start.yaml", none)
        self.assertTrue(advice)
        self.through(advice)
        timed = swivel.check(experiment("c"), plan.motion)
        self.assertIsNotNone(self.through(timed).duration)
        self.through(
            swivel.place(Places.problem(), object="door", x=(-0.1, 0.1, 0.05), y=(0, 0.1, 0.05))
        )
        self.through(swivel.campaign(Places.problem(), episodes=12))
        self.through(swivel.place(Places.problem(), object="door", x=(-0.1, 0.1, 0.05))[2])
        stuck = swivel.plan(PROBLEMS / "experiment_c.yaml", speed=0.1, timeout=1e-3)
        self.through(stuck)
        print(self.count, "values compared")
        self.assertGreater(self.count, 1500)

    def test_another_process_plans_the_same(self):
        problem = experiment("c")
        code = (
            "import pickle, sys, swivel; "
            "sys.stdout.buffer.write(pickle.dumps(swivel.plan(pickle.load(sys.stdin.buffer), "
            "planner='lazy')))"
        )
        run = subprocess.run(
            [sys.executable, "-c", code], input=pickle.dumps(problem), capture_output=True
        )
        self.assertEqual(run.returncode, 0, run.stderr)
        self.assertEqual(
            pickle.loads(run.stdout).joints.tobytes(),
            swivel.plan(problem, planner="lazy").joints.tobytes(),
        )

    def test_what_is_no_pickle_of_this_version(self):
        state = swivel.Box([1, 2, 3]).__getstate__()
        version, checksum, content = state
        for wrong, words in (
            (("0.0.9", checksum, content), "version 0.0.9 .*allowed"),
            ((version, checksum, content[:-1]), "damaged pickle.*allowed"),
            ((), "version . .*allowed"),
            ((version, checksum + 1, content), "damaged pickle"),
            ((version, content), "not a pickle of swivel"),
            ((version, str(checksum), content), "not a pickle of swivel"),
            ((version, checksum, content.decode("latin1")), "not a pickle of swivel"),
            ((version, -1, content), "damaged pickle"),
            ((version, 1 << 80, content), "damaged pickle"),
        ):
            with self.assertRaisesRegex(ValueError, words):
                swivel.Box.__new__(swivel.Box).__setstate__(wrong)
        with self.assertRaisesRegex(ValueError, "damaged pickle"):  # the bytes of another class
            swivel.Cylinder.__new__(swivel.Cylinder).__setstate__(
                swivel.Capsule(0.1, 0.2).__getstate__()
            )

    def test_damaged_ones_end_at_once(self):
        """One or two bytes of the version, the checksum or the content changed: refused in
        milliseconds, and without memory."""
        problem = experiment("a")
        plan = swivel.plan(problem, refine=True, speed=0.1, evidence=True)
        far = experiment("a")
        far.waypoints = (
            far.waypoints + [2, 0, 0, 0, 0, 0, 0] * np.linspace(0, 1, len(far.waypoints))[:, None]
        )
        none = swivel.plan(far, evidence=True)
        places = swivel.place(Places.problem(), object="door", x=(-0.1, 0.1, 0.1))
        episodes = swivel.campaign(Places.problem(), episodes=2)
        things = [
            problem, problem.robot, problem.task, problem.scene,
            swivel.SceneObject("box", swivel.Box([1, 2, 3]), [1, 2, 3], ["flange"]), plan,
            plan.motion, plan.refinement, plan.trajectory, plan.measures, plan.lattice, none,
            none.diagnosis, none.diagnosis.cause, none.diagnosis.empty_layers[0],
            swivel.check(problem, plan.trajectory), places, places[0], episodes, episodes[0],
            plan.measures.nearest_limit, plan.measures.min_margin, plan.measures.tool_path_error_mm,
            swivel.Sphere(0.1), swivel.Box([0.1, 0.2, 0.3]), swivel.Cylinder(0.1, 0.2),
            swivel.Capsule(0.1, 0.2),
            swivel.Mesh.from_arrays([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]]),
            swivel.Roll(lower=-0.5), swivel.Limits(), swivel.Resolution(), swivel.Cost(),
            swivel.PathSmoothing(), swivel.Refinement(),
            swivel.AttachedBody("tool", swivel.Sphere(0.1), "flange")
        ]
        random = np.random.default_rng(seed(41))
        refused = 0
        longest = 0.0
        before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
        for thing in things:
            whole, (version, checksum, content) = pickle.dumps(thing), thing.__getstate__()
            # The words of pickle itself are left whole: damaged ones are between Python and its
            # memory.
            parts = [version.encode(), pickle.encode_long(checksum), content]
            places = np.concatenate([whole.index(part) + np.arange(len(part)) for part in parts])
            for _ in range(trials(200)):
                damaged = bytearray(whole)
                for place in set(places[random.integers(0, len(places), random.integers(1, 3))]):
                    damaged[place] ^= random.integers(1, 256)
                start = time.monotonic()
                with self.assertRaisesRegex(
                    (ValueError, UnicodeDecodeError),
                    "allowed|utf-8|pickled by version",
                    msg=type(thing).__name__,
                ):
                    pickle.loads(bytes(damaged))
                refused += 1
                longest = max(longest, time.monotonic() - start)
        grown = (resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before) / 1024
        print(f"{refused} refused, {1e3 * longest:.1f} ms at most, {grown:.0f} MiB more")
        self.assertGreaterEqual(refused, at_least(6800))
        self.assertLess(longest, 2)
        self.assertLess(grown, 300)


class Wheels(unittest.TestCase):
    """What pip installs, from the module that is built already."""

    def test_wheel(self):
        sys.path.insert(0, os.environ["SWIVEL_BACKEND"])
        import build_wheel

        def install_what_is_built(folder):
            shutil.copytree(
                Path(swivel.__file__).parent, Path(folder) / "swivel",
                ignore=shutil.ignore_patterns("__pycache__")
            )

        build_wheel.build_package = install_what_is_built
        with tempfile.TemporaryDirectory() as folder:
            name = build_wheel.build_wheel(folder)
            info = build_wheel.prepare_metadata_for_build_wheel(folder)
            with zipfile.ZipFile(Path(folder) / name) as wheel:
                files = {path: wheel.read(path) for path in wheel.namelist()}
            for path in (Path(folder) / info).iterdir():
                self.assertEqual(path.read_bytes(), files[f"{info}/{path.name}"])
            rows = [line.split(",") for line in files[f"{info}/RECORD"].decode().splitlines()]
            self.assertEqual({row[0] for row in rows}, set(files))
            for path, digest, size in rows[:-1]:
                self.assertEqual(
                    digest,
                    "sha256="
                    + base64.urlsafe_b64encode(hashlib.sha256(files[path]).digest())
                    .rstrip(b"=")
                    .decode(),
                )
                self.assertEqual(int(size), len(files[path]))
            self.assertIn(f"Version: {swivel.__version__}\n", files[f"{info}/METADATA"].decode())
            if subprocess.run(
                [sys.executable, "-m", "pip", "--version"], capture_output=True
            ).returncode:
                self.skipTest("pip is not installed")
            where = Path(folder) / "site"
            subprocess.run(
                [
                    sys.executable, "-m", "pip", "install", "--no-index", "--no-deps", "--quiet",
                    "--target", where, Path(folder) / name
                ],
                check=True,
            )
            program = (
                "import swivel; print(swivel.__file__, "
                f"swivel.plan({str(PROBLEMS / 'experiment_b.yaml')!r}).status)"
            )
            run = subprocess.run(
                [sys.executable, "-c", program],
                capture_output=True,
                text=True,
                check=True,
                env={**os.environ, "PYTHONPATH": str(where)},
            )
            self.assertEqual(run.stdout, f"{where}/swivel/__init__.py solved\n")

    def test_pages_are_packed_or_their_lack_is_told(self):
        sys.path.insert(0, os.environ["SWIVEL_BACKEND"])
        import build_wheel

        page, node = "<html>", "SWIVEL_NODE:FILEPATH=/usr/bin/node\nSWIVEL_NPM:FILEPATH=/npm\n"
        for content, cache, words in (
            (page, f"SWIVEL_REPORT:STRING=AUTO\n{node}", "has the pages of report()"),
            ("", f"SWIVEL_REPORT:STRING=AUTO\n{node}", "no pages, since node, npm or their"),
            (None, "SWIVEL_NODE:FILEPATH=SWIVEL_NODE-NOTFOUND\n", "no pages, since node, npm"),
            (page, "SWIVEL_NPM:FILEPATH=SWIVEL_NPM-NOTFOUND\n", "no pages, since node, npm"),
            (page, f"SWIVEL_REPORT:STRING=OFF\n{node}", "no pages, since SWIVEL_REPORT is OFF"),
        ):
            with self.subTest(words=words), tempfile.TemporaryDirectory() as folder:
                build, package = Path(folder) / "build", Path(folder) / "swivel"
                web = build / "report" / "web"
                web.mkdir(parents=True)
                package.mkdir()
                (build / "CMakeCache.txt").write_text(cache)
                (web / "THIRD-PARTY.txt").write_text("licences")
                if content is not None:
                    (web / "report.html").write_text(content)
                out, err = io.StringIO(), io.StringIO()
                with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
                    build_wheel.add_notices(build, package)
                self.assertIn(words, out.getvalue() + err.getvalue())
                self.assertEqual(
                    (package / "THIRD-PARTY.txt").exists(), words.startswith("has the pages")
                )
                build_wheel.forget_missing_pages(build)
                self.assertEqual((web / "report.html").exists(), content == page)

    def test_source_distribution(self):
        sys.path.insert(0, os.environ["SWIVEL_BACKEND"])
        import build_wheel

        if subprocess.run(
            ["git", "-C", str(build_wheel.ROOT), "rev-parse"], capture_output=True
        ).returncode:
            self.skipTest("no clone by git")
        with tempfile.TemporaryDirectory() as folder, tarfile.open(
            Path(folder) / build_wheel.build_sdist(folder)
        ) as archive:
            names = archive.getnames()
            base = f"swivel-{swivel.__version__}"
            self.assertTrue(
                {
                    f"{base}/{name}"
                    for name in (
                        "PKG-INFO", "pyproject.toml", "CMakeLists.txt", "python/build_wheel.py"
                    )
                }
                <= set(names)
            )


class Stubs(unittest.TestCase):
    def setUp(self):
        self.folder = Path(swivel.__file__).parent
        self.tree = ast.parse((self.folder / "__init__.pyi").read_text())

    def test_plan_has_the_options_of_planners(self):
        def options(body):
            (plan,) = [item for item in body if getattr(item, "name", "") == "plan"]
            return [(a.arg, ast.dump(a.annotation)) for a in plan.args.kwonlyargs], [
                ast.dump(default) for default in plan.args.kw_defaults
            ]

        (planner,) = [node for node in self.tree.body if getattr(node, "name", "") == "Planner"]
        self.assertEqual(options(self.tree.body), options(planner.body))
        self.assertEqual(len(options(self.tree.body)[0]), 14)
        with self.assertRaisesRegex(TypeError, "unexpected keyword argument 'timout'"):
            swivel.plan(PROBLEMS / "experiment_a.yaml", timout=3)

    @staticmethod
    def members(thing):
        """Public names of a class, and what Python asks of sequences; __init__ where it can be
        made by calling it."""
        own = {
            name
            for name in vars(thing)
            if not name.startswith("_")
            or name in (
                "__len__", "__iter__", "__getitem__", "__contains__", "__bool__", "__array__",
                "__getattr__"
            )
        }
        if hasattr(thing, "__members__"):
            return own | {"__eq__", "__hash__"}
        made = getattr(vars(thing).get("__init__"), "__doc__", None) or ""
        return own | ({"__init__"} if made.startswith("__init__(") else set())

    def test_each_name_is_told(self):
        self.assertTrue((self.folder / "py.typed").exists())
        told = {getattr(node, "name", ""): node for node in self.tree.body}
        self.assertLessEqual(set(swivel.__all__), set(told))
        count = 0
        for name in swivel.__all__:
            thing, node = getattr(swivel, name), told[name]
            self.assertEqual(isinstance(node, ast.ClassDef), isinstance(thing, type), name)
            if not isinstance(thing, type) or issubclass(thing, Exception):
                continue
            values = {item.target.id for item in node.body if isinstance(item, ast.AnnAssign)}
            methods = {}
            for item in node.body:
                if isinstance(item, ast.FunctionDef):
                    methods.setdefault(item.name, " ".join(map(ast.unparse, item.decorator_list)))
            self.assertEqual(values | set(methods), self.members(thing), name)
            for member, decorator in methods.items():
                is_property = isinstance(getattr(thing, member), property)
                self.assertEqual("property" in decorator, is_property, f"{name}.{member}")
            count += len(values) + len(methods)
        self.assertGreater(count, 600)

    def test_each_type_is_told(self):
        sys.path.insert(0, os.environ["SWIVEL_BACKEND"])
        from stubs import MAYBE

        anything = MAYBE | {
            "Trajectory.to_dataframe", "Motion.to_dataframe", "Answer.to_dataframe",
            "Placements.to_dataframe", "Episodes.to_dataframe", "Plans.to_dataframe",
            "Trajectory.__array__", "Motion.__array__", "Answer.report", "Answer.map_svg",
            "report", "map_svg", "campaign", "place", "plan_many", "compute_cartesian_path",
            "load_trajectory"
        }
        count = 0
        for name, node in self.functions():
            words = {one.id for one in ast.walk(node) if isinstance(one, ast.Name)}
            self.assertEqual("Any" in words, name in anything, name)
            self.assertEqual("object" in words, name.endswith("__eq__"), name)
            arguments = node.args
            every = arguments.posonlyargs + arguments.args + arguments.kwonlyargs
            self.assertTrue(all(one.annotation or one.arg == "self" for one in every), name)
            self.assertIsNotNone(node.returns, name)
            for default in filter(None, arguments.defaults + arguments.kw_defaults):
                self.assertNotEqual(ast.unparse(default), "...", name)
            count += 1
        self.assertGreater(count, 500)

    def functions(self):
        for node in self.tree.body:
            if isinstance(node, ast.FunctionDef):
                yield node.name, node
            for item in node.body if isinstance(node, ast.ClassDef) else ():
                if isinstance(item, ast.FunctionDef):
                    yield f"{node.name}.{item.name}", item

    def test_keywords_of_structs_have_their_defaults(self):
        functions = dict(self.functions())
        for kind, name, value in (
            (swivel.Limits, "clearance", "0.005"), (swivel.Limits, "edges", "'continuous'"),
            (swivel.Cost, "weights", "None"), (swivel.Resolution, "arcs", "False")
        ):
            arguments = functions[f"{kind.__name__}.__init__"].args
            names = [one.arg for one in arguments.kwonlyargs]
            self.assertEqual(names, [one for one in vars(kind) if not one.startswith("_")])
            self.assertEqual(ast.unparse(arguments.kw_defaults[names.index(name)]), value)

    def test_types_that_are_not_known_are_refused(self):
        sys.path.insert(0, os.environ["SWIVEL_BACKEND"])
        import stubs

        class Binding:
            pass

        def bare(x):
            pass

        def read(doc):
            thing = Binding()
            thing.__doc__ = doc + "\n\nWords."
            return stubs.Stubs({"f": thing}).text()

        for doc, fault in (
            ("f(x: ham) -> None", "f: the type ham: allowed are"),
            ("f() -> List[egg.Plan]", "f: the type egg.Plan: allowed are"),
            ("f(x: handle) -> None", "f: the type handle: allowed are"),
            ("f() -> object", "f: the type object: allowed are"),
            ("f(x: swivel::Plan) -> None", "f: .* is not Python: allowed are types that are bound"),
            ("f(x: float = array([0.,\n 1.])) -> None", "f: its docstring has no signature"),
            ("f(x) -> None", "f: x has no type"),
            # It is known, and tables have entries for all of the package.
            ("f(x: int) -> None", "python/stubs.py: nothing needs the entry Answer.bound"),
        ):
            with self.subTest(doc), self.assertRaisesRegex(SystemExit, "^stubs: " + fault):
                read(doc)
        with self.assertRaisesRegex(SystemExit, "^stubs: f: x has no type"):
            stubs.Stubs({"f": bare}).text()
        known = stubs.Stubs({"Status": swivel.Status})
        for doc, told in (
            ("(x: Dict[str, float] = {}) -> numpy.ndarray[bool]",
             "(x: Mapping[str, float]={}) -> NDArray[np.bool_]"),
            ("(x: List[float[7]]) -> List[float[7]]", "(x: Sequence[float]) -> list[float]"),
            ("(x: Annotated[list[float], FixedSize(6)]) -> None", "(x: ArrayLike) -> None"),
            ("(x: Union[swivel._swivel.Status, str] = None) -> Optional[swivel._swivel.Status]",
             "(x: _Status | None=None) -> Status | None"),
        ):
            thing = Binding()
            thing.__doc__ = "f" + doc
            self.assertEqual(known.function("f", thing), [f"def f{told}: ..."])

    def test_members_of_enums_have_a_name_and_a_value(self):
        enums = [
            thing
            for name in swivel.__all__
            if hasattr(thing := getattr(swivel, name), "__members__")
        ]
        self.assertGreaterEqual(len(enums), 6)
        for enum in enums:
            self.assertTrue(enum.__members__, enum)
            for name, member in enum.__members__.items():
                self.assertIs(type(member), enum)
                self.assertEqual(
                    (member.name, str(member), member.value, repr(member)),
                    (name, name.lower(), int(member), f"<{enum.__name__}.{name}: {member.value}>"),
                )
                self.assertEqual(
                    (getattr(enum, name), enum(member.value), pickle.loads(pickle.dumps(member))),
                    (member, member, member),
                )
            self.assertEqual(
                {m.value for m in enum.__members__.values()}, set(range(len(enum.__members__)))
            )
        self.assertTrue(swivel.Status.SOLVED.name == "SOLVED")

    def test_members_of_enums_are_equal_to_their_names(self):
        enums = [
            thing
            for name in swivel.__all__
            if hasattr(thing := getattr(swivel, name), "__members__")
        ]
        for enum in enums:
            members = list(enum.__members__.values())
            # One key, whichever of the two it is.
            self.assertEqual(len({*members, *map(str, members)}), len(members))
            for member in members:
                name = str(member)
                self.assertTrue(
                    member == name and name == member and not member != name and not name != member
                )
                self.assertEqual(
                    (hash(member), {name: 1}[member], {member: 2}[name], member in (name,)),
                    (hash(name), 1, 2, True),
                )
                for other in (name.upper(), name + "d", "", None, member.value, b"x", object()):
                    self.assertTrue(member != other and not member == other, (member, other))
                for other in members:
                    self.assertEqual(
                        (member == other, member != other, member == str(other)),
                        (member is other, member is not other, member is other),
                    )
        self.assertFalse(swivel.Status.SOLVED == swivel.EdgeMode.CONTINUOUS)
        self.assertTrue(swivel.Status.INFEASIBLE == "infeasible")

    def mypy(self, *files):
        if subprocess.run(
            [sys.executable, "-m", "mypy", "--version"], capture_output=True
        ).returncode:
            self.skipTest("mypy (python3-mypy) is not installed")
        with tempfile.TemporaryDirectory() as folder:
            return subprocess.run(
                [
                    sys.executable, "-m", "mypy", "--ignore-missing-imports", "--cache-dir", folder,
                    *files
                ],
                capture_output=True,
                text=True,
                env={**os.environ, "MYPYPATH": str(self.folder.parent)},
            )

    def test_mypy_accepts_the_examples(self):
        examples = sorted(Path(os.environ["SWIVEL_EXAMPLES"]).glob("*.py"))
        self.assertEqual(len(examples), 4)
        run = self.mypy(*examples, self.folder / "__init__.pyi")
        self.assertEqual(run.returncode, 0, run.stdout + run.stderr)

    def test_mypy_refuses_what_is_misspelt(self):
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "misspelt.py"
            file.write_text(
                "import swivel\n"
                "plan = swivel.Planner(swivel.load('a.yaml')).plan(timout=3)\n"
                "limits = swivel.Limits(clearence=0.01)\n"
                "joints = plan.trajectory[0].joints[0] + plan.trajectory[1:].s[0]\n"
                "plan.trajectry\n"
                "limits.edges = 3\n"
                "names: list[int] = plan.joint_names\n"
                "if plan.measures.min_clearance_status == 'measurd': pass\n"
            )
            run = self.mypy("--strict-equality", file)
        self.assertEqual(run.returncode, 1, run.stdout + run.stderr)
        self.assertEqual(
            re.findall(r"misspelt.py:(\d+): error", run.stdout), ["2", "3", "5", "6", "7", "8"]
        )


if __name__ == "__main__":
    unittest.main(argv=["python_test"] + sys.argv[1:], verbosity=1)

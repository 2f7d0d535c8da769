#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""The command line from outside: exit codes, files, messages, and trajectories verified by
verify.py."""
import csv
import json
import math
import os
import pathlib
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import unittest

SWIVEL = os.environ["SWIVEL"]
DATA = pathlib.Path(os.environ["SWIVEL_DATA"])
# Real robots, where there are any.
SHARED = pathlib.Path(os.environ.get("SWIVEL_SHARED", "/nonexistent"))
VERIFY = pathlib.Path(__file__).with_name("verify.py")
PROBLEMS = DATA / "problems"
LINE = (
    "x,y,z,qw,qx,qy,qz\n0.6,-0.1,0.9,0.7071067811865476,0,-0.7071067811865476,0\n"
    "0.6,0.4,0.9,0.7071067811865476,0,-0.7071067811865476,0\n"
)
QUARTER_TURN = "-1.5707963267948966"


def run(*arguments):
    return subprocess.run(
        [SWIVEL, *map(str, arguments)], capture_output=True, text=True, timeout=300
    )


def on_terminal(stream, command):
    """Exit code and lines of a stream that is a terminal of 80 columns."""
    import fcntl
    import pty
    import struct
    import termios

    outer, inner = pty.openpty()
    fcntl.ioctl(inner, termios.TIOCSWINSZ, struct.pack("HHHH", 24, 80, 0, 0))
    streams = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL, stream: inner}
    done = subprocess.run(command, timeout=300, **streams)
    os.close(inner)
    shown = b""
    while True:
        try:
            part = os.read(outer, 65536)
        except OSError:
            break
        if not part:
            break
        shown += part
    os.close(outer)
    return done.returncode, shown.decode().replace("\r\n", "\n").splitlines()


class WithFolder(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def plan(self, problem, *options):
        out, result = self.folder / "t.csv", self.folder / "r.json"
        done = run("plan", problem, "--out", out, "--json", result, *options)
        return done, out, json.loads(result.read_text()) if result.exists() else None


class Ends(WithFolder):
    """Paths that end in a given posture."""

    def ending(self, joints, scene=""):
        problem = self.folder / "ending.yaml"
        text = (PROBLEMS / "experiment_a.yaml").read_text().replace("../", f"{DATA}/")
        end = ", ".join(map(repr, joints))
        problem.write_text(text.replace("path:\n", f"path:\n  end: {{joints: [{end}]}}\n") + scene)
        return problem

    def setUp(self):
        super().setUp()
        done, out, _ = self.plan(PROBLEMS / "experiment_a.yaml", "--ds", "0.02", "--dphi", "0.13")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.end = [float(x) for x in list(csv.reader(out.open()))[-1][3:10]]

    def test_the_last_row_is_the_end(self):
        problem = self.ending(self.end)
        for options in ((), ("--planner", "eager_dp", "--ds", "0.02"), ("--refine",)):
            done, out, _ = self.plan(problem, *options)
            self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
            last = [float(x) for x in list(csv.reader(out.open()))[-1][3:10]]
            self.assertEqual(last, self.end)
            self.assertEqual(run("check", problem, out).returncode, 0)
        other = self.ending([self.end[0] + 2e-6, *self.end[1:]])
        check = run("check", other, out)
        self.assertEqual(check.returncode, 1, check.stdout)
        self.assertIn("the last: joints are not the given end", check.stdout)
        done = run("plan", self.ending([self.end[0] + 1e-3, *self.end[1:]]))
        self.assertEqual((done.returncode, len(done.stderr.splitlines())), (2, 1), done.stderr)

    def test_that_none_ends_there_is_told_and_proved(self):
        ball = "scene: [{name: ball, sphere: 0.02, xyz: [0.62, 0.4, 0.9]}]\n"
        problem, certificate = self.ending(self.end, ball), self.folder / "none.json"
        done, _, result = self.plan(problem, "--certificate", certificate, "--advise", "2")
        self.assertEqual(done.returncode, 1, done.stdout + done.stderr)
        self.assertIn("free_end", [one["change"] for one in result["advice"]])
        check = run("check", problem, "--certificate", certificate)
        self.assertEqual(check.returncode, 0, check.stdout + check.stderr)


class Certificates(WithFolder):
    """That there is no path: written by plan, verified by check."""

    def setUp(self):
        super().setUp()
        self.problem = PROBLEMS / "experiment_a_start.yaml"
        self.certificate = self.folder / "none.json"
        done, _, self.result = self.plan(self.problem, "--certificate", self.certificate)
        self.assertEqual(done.returncode, 1, done.stderr)
        self.assertIn("certificate: layers", done.stdout)

    def check(self, *options):
        return run("check", self.problem, "--certificate", self.certificate, *options)

    def test_it_is_verified_and_counted(self):
        done = self.check()
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertTrue(done.stdout.startswith("passed: no path at this resolution"), done.stdout)
        told = self.result["certificate"]
        self.assertEqual(told["bytes"], self.certificate.stat().st_size)
        written = json.loads(self.certificate.read_text())
        nodes = sum(
            last - first + 1 for layer in written["layers"] for first, last, _ in layer["nodes"]
        )
        self.assertEqual(sum(removed["nodes"] for removed in told["removed"]), nodes)
        self.assertEqual(
            told["layers"], [written["layers"][0]["layer"], written["layers"][-1]["layer"]]
        )
        self.assertIn(f"{nodes} nodes and 0 edges asked", done.stdout)
        self.assertIsNone(self.result["checked"])

    def test_a_forged_one_is_refused(self):
        written = json.loads(self.certificate.read_text())
        for forge in (
            lambda w: w["layers"][5]["nodes"].pop(),
            lambda w: w["layers"][7]["reached"].clear(),
            lambda w: w["layers"].pop(),
            lambda w: w["layers"][3]["nodes"][0].__setitem__(1, 200),
            lambda w: w["witnesses"][0].update(side="lower"),
        ):
            bad = json.loads(json.dumps(written))
            forge(bad)
            self.certificate.write_text(json.dumps(bad))
            done = self.check()
            self.assertEqual(done.returncode, 1, done.stdout + done.stderr)
            lines = done.stdout.splitlines()
            self.assertEqual((lines[0], len(lines)), ("failed: this certificate proves nothing", 2))

    def test_bad_ones_are_bad_input(self):
        good = self.certificate.read_text()
        for bad in (
            "", "{", "[]", "null", '{"format": 1}', good[:-20],
            good.replace("certificate 1", "certificate 9"), good.replace('"limit"', '"whim"', 1),
            good.replace('"slots":1008', '"slots":-1', 1),
            good.replace('"slots":1008', '"slots":1e300', 1), good.replace("[786,786]", "[786]", 1),
            "[" * 100000
        ):
            self.certificate.write_text(bad)
            done = self.check()
            self.assertEqual(done.returncode, 2, f"{bad[:50]}: {done.stdout}{done.stderr}")
            self.assertEqual(len(done.stderr.strip().splitlines()), 1, done.stderr)
            self.assertIn("allowed", done.stderr)
        self.certificate.write_text(good)
        for options in (("--ds", "0.02"), ("--edges", "nodes"), ("--arcs",), ("trajectory.csv",)):
            done = self.check(*options)
            self.assertEqual(done.returncode, 2, done.stdout + done.stderr)
            self.assertIn("allowed", done.stderr)
        for options in (("--refine",), ("--speed", "0.1")):
            done, _, _ = self.plan(self.problem, "--certificate", self.certificate, *options)
            self.assertEqual(
                (done.returncode, len(done.stderr.strip().splitlines())), (2, 1), done.stderr
            )
            self.assertEqual(self.certificate.read_text(), good)
        done = run("check", self.problem)
        self.assertEqual(
            (done.returncode, len(done.stderr.strip().splitlines())), (2, 1), done.stderr
        )

    def test_a_stale_one_goes_where_there_is_a_path(self):
        done, out, result = self.plan(
            PROBLEMS / "experiment_a.yaml", "--certificate", self.certificate, "--ds", "0.02",
            "--dphi", "0.2"
        )
        self.assertEqual(done.returncode, 0)
        self.assertFalse(self.certificate.exists())
        self.assertIn("there is a path now", done.stderr)
        self.assertIsNone(result["certificate"])
        self.assertTrue(out.exists())


class Checked(WithFolder):
    """Every answer is proved before it is written."""

    def test_answers_say_that_they_were(self):
        quick = ("--ds", "0.02", "--dphi", "0.2")
        for options in ((), ("--refine",), ("--speed", "0.05"), ("--refine", "--speed", "0.05")):
            done, out, result = self.plan(PROBLEMS / "experiment_a.yaml", *quick, *options)
            self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
            self.assertIs(result["checked"], True)
            self.assertGreater(result["time_ms"]["check"], 0)
            self.assertIn("checked in", done.stdout)
            done, plain, result = self.plan(
                PROBLEMS / "experiment_a.yaml", *quick, *options, "--no-check"
            )
            self.assertIs(result["checked"], False)
            self.assertEqual(result["time_ms"]["check"], 0)
        problem = PROBLEMS / "experiment_c.yaml"
        _, out, _ = self.plan(problem, "--refine")
        for options in ((), ("--no-check",)):
            done = run("time", problem, out, "--speed", "0.05", *options)
            self.assertEqual(done.returncode, 0, done.stdout + done.stderr)


class Experiments(WithFolder):
    def verified(self, problem, tip, path, *verify_options):
        done, out, result = self.plan(PROBLEMS / problem)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertEqual(result["status"], "solved")
        check = run("check", PROBLEMS / problem, out)
        self.assertEqual(check.returncode, 0, check.stdout)
        outside = subprocess.run(
            [
                sys.executable, VERIFY, DATA / "robots/sda5f.urdf", "base_link", tip, path, out,
                "--cost", repr(result["cost"]), *verify_options
            ],
            capture_output=True,
            text=True,
        )
        self.assertEqual(outside.returncode, 0, outside.stdout + outside.stderr)
        return result

    def test_a_and_b(self):
        line = self.folder / "line.csv"
        line.write_text(LINE)
        self.verified("experiment_a.yaml", "arm_left_link_7_t", line)
        self.verified("experiment_b.yaml", "arm_left_link_7_t", line)

    def test_c(self):
        for problem in ("experiment_c.yaml", "experiment_c_20k.yaml"):
            self.verified(
                problem, "arm_left_link_tool0", DATA / "paths/door_polish.csv", "--tool", "0", "0",
                "0.10", *self.door_frame(problem)
            )

    @staticmethod
    def door_frame(problem):
        text = next(
            line for line in (PROBLEMS / problem).read_text().splitlines() if "name: door" in line
        )
        numbers = lambda key: text.split(key + ": [")[1].split("]")[0].replace(",", " ").split()
        return ["--frame", *numbers("xyz"), *numbers("rpy")]

    def test_a_from_the_jacobian_start_ends_part_way(self):
        done, out, result = self.plan(PROBLEMS / "experiment_a_start.yaml")
        self.assertEqual(done.returncode, 1)
        self.assertEqual(result["status"], "infeasible")
        self.assertIsNone(result["cost"])
        self.assertFalse(out.exists())
        self.assertAlmostEqual(result["diagnosis"]["reached_s"], 0.34, delta=0.011)
        self.assertIn("no path at this resolution", done.stdout)

    def test_four_planners_write_the_same_bytes(self):
        for experiment in ("a", "b", "c"):
            written = {}
            for planner in ("eager", "eager_dp", "lazy", "parallel"):
                done, out, result = self.plan(
                    PROBLEMS / f"experiment_{experiment}.yaml", "--planner", planner,
                    "--ds", "0.02", "--dphi", "0.2", "--edges", "nodes"
                )
                self.assertEqual(done.returncode, 0, done.stderr)
                written[planner] = (out.read_bytes(), result["cost"])
            self.assertEqual(len(set(written.values())), 1, experiment)


class Files(WithFolder):
    def test_an_old_trajectory_does_not_survive_a_failure(self):
        out = self.folder / "t.csv"
        out.write_text("old")
        done, out, result = self.plan(
            PROBLEMS / "experiment_a_start.yaml", "--ds", "0.02", "--dphi", "0.2"
        )
        self.assertEqual(done.returncode, 1)
        self.assertFalse(out.exists())
        self.assertEqual(result["status"], "infeasible")

    def test_time_out(self):
        done, out, result = self.plan(PROBLEMS / "experiment_c.yaml", "--timeout", "1e-6")
        self.assertEqual(done.returncode, 3)
        self.assertEqual(result["status"], "timeout")
        self.assertFalse(out.exists())

    def test_json_on_standard_output_is_all_there_is(self):
        done = run(
            "plan", PROBLEMS / "experiment_a.yaml", "--json", "-", "--ds", "0.02", "--dphi", "0.2"
        )
        result = json.loads(done.stdout)
        self.assertEqual(result["lattice"]["layers"], 26)
        self.assertEqual(result["lattice"]["phi"], 32)
        self.assertEqual(len(result["trajectory"]), 26)
        self.assertEqual(len(result["arm_angle"]), 26)
        for key in (
            "status", "cost", "planner", "threads", "lattice", "counters", "time_ms",
            "tool_path_error_mm", "min_clearance", "min_manipulability", "arm_angle", "diagnosis",
            "trajectory"
        ):
            self.assertIn(key, result)

    def test_trace(self):
        trace = self.folder / "trace.json"
        done, out, result = self.plan(
            PROBLEMS / "experiment_b.yaml", "--trace", trace, "--threads", "2", "--edges", "nodes"
        )
        self.assertEqual(done.returncode, 0)
        events = json.loads(trace.read_text())["traceEvents"]
        spans = [e for e in events if e["ph"] == "X"]
        names = [e["name"] for e in spans]
        for stage in ("load", "prepare", "plan", "lattice", "report"):
            self.assertEqual(names.count(stage), 1, stage)
        self.assertEqual(names.count("candidate path"), result["counters"]["iterations"])
        self.assertEqual(names.count("node"), result["counters"]["nodes_checked"])
        self.assertEqual(
            sum(e["args"]["nodes"] for e in spans if e["name"] == "nodes asked"),
            result["counters"]["nodes_checked"],
        )
        self.assertEqual({e["tid"] for e in spans}, {e["tid"] for e in events if e["ph"] == "M"})
        planned = next(e for e in spans if e["name"] == "plan")
        for e in spans:
            self.assertGreaterEqual(e["dur"], 0)
            if e["name"] == "node":
                self.assertGreaterEqual(e["ts"], planned["ts"])
                self.assertLessEqual(e["ts"] + e["dur"], planned["ts"] + planned["dur"] + 1)
        self.assertEqual(
            self.plan(PROBLEMS / "experiment_b.yaml", "--edges", "nodes")[2]["cost"], result["cost"]
        )
        # On stderr each stage's own time, longest first; all of it is what the threads spent in
        # outermost spans.
        table = done.stderr[done.stderr.index("swivel: self time by stage, ") :].splitlines()
        total = float(
            re.match(r"swivel: self time by stage, ([0-9.]+) ms on all threads$", table[0])[1]
        )
        if table[-1].endswith(" ms") and "parts of shared loops" in table[-1]:
            table.pop()  # where a thread of TBB was awake in time
        rows = [re.match(r"  (.+?) +(\d+) +([0-9.]+) +([0-9.]+) %$", line) for line in table[2:]]
        self.assertGreater(len(rows), 8)
        self.assertIn("other stages", rows[-1][1])
        own = [float(row[3]) for row in rows]
        self.assertEqual(own[:-1], sorted(own[:-1], reverse=True))
        self.assertAlmostEqual(sum(own), total, delta=0.1)
        self.assertAlmostEqual(sum(float(row[4]) for row in rows), 100, delta=1)
        calls = {row[1]: int(row[2]) for row in rows}
        self.assertEqual(sum(calls.values()), len(spans))
        self.assertEqual(calls["node"], result["counters"]["nodes_checked"])

    def test_map(self):
        drawing = self.folder / "map.svg"
        done, _, result = self.plan(PROBLEMS / "experiment_c.yaml", "--map", "--map-svg", drawing)
        self.assertEqual(done.returncode, 0)
        self.assertIn("* the path", done.stdout)
        self.assertIn("not looked at", done.stdout)
        self.assertNotIn("\x1b", done.stdout)  # no terminal, no colours
        self.assertIn("search", result["time_ms"]["stages"])
        self.assertIn("<svg", drawing.read_text())
        full = run("plan", PROBLEMS / "experiment_b.yaml", "--map", "--full-map").stdout
        self.assertNotIn("not looked at", full)
        self.assertIn("blocked by", full)
        blocked = run("plan", PROBLEMS / "experiment_a_start.yaml", "--map")
        self.assertEqual(blocked.returncode, 1)
        self.assertIn("furthest layer", blocked.stdout)
        for options in (["--full-map"], ["--map", "--json", "-"]):
            done = run("plan", PROBLEMS / "experiment_a.yaml", *options)
            self.assertEqual((done.returncode, done.stdout), (2, ""))
            self.assertEqual(len(done.stderr.splitlines()), 1)

    def test_quiet(self):
        done = run(
            "plan", PROBLEMS / "experiment_a.yaml", "--quiet", "--ds", "0.02", "--dphi", "0.2"
        )
        self.assertEqual((done.returncode, done.stdout, done.stderr), (0, "", ""))

    def test_check_says_that_degrees_are_not_measured(self):
        coarse = ("--ds", "0.02", "--dphi", "0.2")
        _, out, _ = self.plan(PROBLEMS / "experiment_a.yaml", *coarse)
        rows = list(csv.reader(out.open()))
        with out.open("w", newline="") as file:
            degrees = [[repr(math.degrees(float(q))) for q in row[3:]] for row in rows[1:]]
            csv.writer(file).writerows([rows[0][3:], *degrees])
        check = run("check", PROBLEMS / "experiment_a.yaml", out, *coarse)
        self.assertEqual(check.returncode, 1)
        lines = check.stdout.splitlines()
        self.assertRegex(lines[0], r"^failed: 26 rows, \d+ failures, .*; no row could be measured$")
        self.assertEqual(
            lines[1], "  joints would be within their limits as degrees: allowed are radians"
        )

    def test_check_sees_a_damaged_trajectory(self):
        coarse = ("--ds", "0.02", "--dphi", "0.2")
        _, out, _ = self.plan(PROBLEMS / "experiment_a.yaml", *coarse)
        rows = list(csv.reader(out.open()))
        check = run("check", PROBLEMS / "experiment_a.yaml", out, *coarse)
        self.assertEqual((check.returncode, len(check.stdout.splitlines())), (0, 1), check.stdout)
        self.assertIn("passed: 26 rows", check.stdout)
        for column, change, word in (
            (3, 1e-5, "from the path"),
            (3, 9.0, "outside its limits"),
            (0, 1e-3, "from the path"),
        ):
            damaged = [list(row) for row in rows]
            damaged[7][column] = repr(float(damaged[7][column]) + change)
            with out.open("w", newline="") as file:
                csv.writer(file).writerows(damaged)
            check = run("check", PROBLEMS / "experiment_a.yaml", out, *coarse)
            self.assertEqual(check.returncode, 1)
            self.assertIn(word, check.stdout)
            self.assertIn("row 6", check.stdout)
        with out.open("w", newline="") as file:  # the last row is missing
            csv.writer(file).writerows(rows[:-1])
        self.assertIn(
            "before the path", run("check", PROBLEMS / "experiment_a.yaml", out, *coarse).stdout
        )
        for row in rows[1:]:  # phi of every row
            row[1] = "9"
        with out.open("w", newline="") as file:
            csv.writer(file).writerows(rows)
        lines = run("check", PROBLEMS / "experiment_a.yaml", out, *coarse).stdout.splitlines()
        self.assertTrue(
            lines[0].startswith("failed: 26 rows, 26 failures, held: torso_joint_b1 at 0 rad; "),
            lines,
        )
        self.assertLessEqual(len(lines), 4, lines)  # not one for each row
        self.assertRegex(lines[1], r"^  row 0: .* \(and \d+ more like it\)$")
        self.assertEqual(lines[-1], "  and 6 more failures")
        self.assertNotIn(" 0 %", lines[0])

    def test_check_says_nothing_of_what_it_could_not_measure(self):
        """A trajectory of another path: no row is right, so that none has a motion to the next."""
        coarse = ("--ds", "0.02", "--dphi", "0.2")
        _, out, _ = self.plan(PROBLEMS / "experiment_a.yaml", *coarse)
        lines = run("check", PROBLEMS / "experiment_c.yaml", out, *coarse).stdout.splitlines()
        self.assertTrue(lines[0].startswith("failed: 26 rows, 26 failures, "), lines)
        self.assertNotIn(" between", lines[0])
        self.assertNotIn("joint moves", lines[0])

    def test_check_on_a_terminal(self):
        """The verdict first, alike failures in one line, no number broken at 80 columns."""
        coarse = ("--ds", "0.005", "--dphi", "0.2")
        _, out, _ = self.plan(PROBLEMS / "experiment_c.yaml", *coarse)
        rows = list(csv.reader(out.open()))
        for row in rows[11:41]:  # an axis a little outside its limits, in radians
            row[8] = repr(float(row[8]) + 0.3)
        with out.open("w", newline="") as file:
            csv.writer(file).writerows(rows)
        command = [SWIVEL, "check", str(PROBLEMS / "experiment_c.yaml"), str(out), *coarse]
        plain = subprocess.run(command, capture_output=True, text=True, timeout=300).stdout
        self.assertTrue(plain.startswith(f"failed: {len(rows) - 1} rows, 30 failures, "), plain)
        self.assertRegex(plain.splitlines()[1], r"^  row 10: .* \(and 19 more like it\)$")
        self.assertEqual(plain.splitlines()[2:], ["  and 10 more failures"])
        self.assertNotIn("as degrees", plain)
        code, lines = on_terminal("stdout", command)
        self.assertEqual(code, 1)
        self.assertGreater(len(lines), 3)
        self.assertLessEqual(max(map(len, lines)), 80, lines)
        self.assertEqual(" ".join(lines).split(), plain.split())

    def test_episodes_move_the_door_and_can_be_checked(self):
        first = self.plan(
            PROBLEMS / "experiment_c.yaml", "--seed", "1", "--episode", "0", "--ds", "0.02",
            "--dphi", "0.2"
        )[2]
        again = self.plan(
            PROBLEMS / "experiment_c.yaml", "--seed", "1", "--episode", "0", "--ds", "0.02",
            "--dphi", "0.2"
        )[2]
        other = self.plan(
            PROBLEMS / "experiment_c.yaml", "--seed", "1", "--episode", "1", "--ds", "0.02",
            "--dphi", "0.2"
        )[2]
        self.assertEqual((first["status"], first["cost"]), (again["status"], again["cost"]))
        self.assertNotEqual((first["status"], first["cost"]), (other["status"], other["cost"]))
        episode = ("--episode", "1", "--ds", "0.02", "--dphi", "0.2")
        out = self.folder / "t.csv"
        self.assertEqual(
            run("check", PROBLEMS / "experiment_c.yaml", out, "--seed", "1", *episode).returncode, 0
        )
        self.assertEqual(
            run("check", PROBLEMS / "experiment_c.yaml", out, "--seed", "2", *episode).returncode, 1
        )

    def test_info(self):
        done = run(
            "info", DATA / "robots/sda5f.urdf", "--base", "base_link", "--tip", "arm_left_link_7_t"
        )
        self.assertEqual(done.returncode, 0)
        for words in (
            "S-R-S, in-plane elbow offset", "exact", "0.195000 0.243000 0.900000", "59.99"[:4]
        ):
            self.assertIn(words, done.stdout)


class BadInput(WithFolder):
    BASE = """robot:
  urdf: {data}/robots/sda5f.urdf
  srdf: {data}/robots/sda5f.srdf
  base_link: base_link
  tip_link: arm_left_link_7_t
path:
  waypoints:
    - {{xyz: [0.6, -0.1, 0.9], rpy: [0, -1.5707963267948966, 0]}}
    - {{xyz: [0.6, 0.4, 0.9], rpy: [0, -1.5707963267948966, 0]}}
scene:
  - {{name: post, cylinder: {{radius: 0.05, length: 0.8}}, xyz: [1.5, 0, 0]}}
resolution: {{ds: 0.02, dphi: 0.2}}
limits: {{clearance: 0.005}}
"""

    # (old, new, words that the one line must have)
    CASES = [
        ("clearance: 0.005", "clearence: 0.005", ["clearence", "clearance"]),
        ("sda5f.urdf", "nothing.urdf", ["nothing.urdf"]),
        ("sda5f.srdf", "nothing.srdf", ["nothing.srdf"]),
        ("resolution:", "resolution: [", ["problem.yaml"]),
        ("xyz: [0.6, 0.4, 0.9]", "xyz: [0.6, .nan, 0.9]", ["xyz"]),
        (
            "xyz: [0.6, 0.4, 0.9], rpy: [0, -1.5707963267948966, 0]",
            "xyz: [0.6, 0.4, 0.9], quat: [0, 0, 0, 0]",
            ["quat"],
        ),
        ("    - {{xyz: [0.6, 0.4, 0.9], rpy: [0, -1.5707963267948966, 0]}}\n", "", ["two"]),
        ("ds: 0.02", "ds: 0", ["ds"]),
        ("ds: 0.02", "ds: -1", ["ds"]),
        ("ds: 0.02", "ds: 1e-9", ["ds"]),
        ("ds: 0.02, dphi: 0.2", "ds: 1e-5, dphi: 1e-5, knot: 0", ["larger ds or dphi"]),
        ("ds: 0.02, dphi: 0.2", "dphi: 1e-8", ["larger ds or dphi"]),
        ("dphi: 0.2", "dphi: 0.2, arcs: maybe", ["resolution.arcs", "one of false, true"]),
        ("path:\n", "path:\n  frame: nowhere\n", ["nowhere", "frame"]),
        ("tip_link: arm_left_link_7_t", "tip_link: arm_left_link_9", ["arm_left_link_9"]),
        ("base_link: base_link", "base_link: bottom", ["bottom"]),
        (
            "  base_link: base_link\n",
            "  base_link: base_link\n  hold: {{no_such_joint: 0}}\n",
            ["no_such_joint"],
        ),
        ("radius: 0.05", "radius: -0.05", ["radius"]),
        ("cylinder: {{radius: 0.05, length: 0.8}}", "mesh: empty.stl", ["empty.stl"]),
        ("limits:", "start: {{joints: [0, 0, 0]}}\nlimits:", ["joints", "7"]),
        (
            "limits:",
            "start: {{joints: [9, 0, 0, 0, 0, 0, 0]}}\nlimits:",
            ["start.joints", "limits"],
        ),
        (
            "limits:",
            "start: {{joints: [0, 0, 0, 0, 0, 0, 0]}}\nlimits:",
            ["start.joints", "first pose"],
        ),
        (
            "path:\n",
            "path:\n  end: {{joints: [9, 0, 0, 0, 0, 0, 0]}}\n",
            ["path.end.joints", "limits"],
        ),
        (
            "path:\n",
            "path:\n  end: {{joints: [0, 0, 0, 0, 0, 0, 0]}}\n",
            ["path.end.joints", "not on the path", " mm and "],
        ),
        ("tip_link: arm_left_link_7_t", "tip_link: arm_left_link_3_e", ["at least six"]),
        ("{{clearance: 0.005}}", "{{clearance: -1}}", ["clearance"]),
        ("{{clearance: 0.005}}", "{{joint_margin: 3}}", ["joint_margin"]),
        ("name: post", "name: base_link", ["base_link"]),
        (
            (
                "rpy: [0, -1.5707963267948966, 0]}}\n"
                "    - {{xyz: [0.6, 0.4, 0.9], rpy: [0, -1.5707963267948966, 0]}}"
            ),
            "quat: [1, 0, 0, 0]}}\n    - {{xyz: [0.6, 0.4, 0.9], quat: [0, 0, 0, 1]}}",
            ["180"],
        ),
    ]

    def bad(self, text, words):
        problem = self.folder / "problem.yaml"
        problem.write_text(text)
        (self.folder / "empty.stl").write_bytes(bytes(84))
        out, result = self.folder / "t.csv", self.folder / "r.json"
        done = run("plan", problem, "--out", out, "--json", result)
        self.assertEqual(done.returncode, 2, f"{words}: {done.stdout}{done.stderr}")
        self.assertEqual(done.stdout, "")
        self.assertEqual(len(done.stderr.strip().splitlines()), 1, done.stderr)
        for word in words:
            self.assertIn(word, done.stderr)
        self.assertIn(
            "allowed", done.stderr.replace("at least", "allowed").replace("are needed", "allowed")
        )
        self.assertFalse(out.exists() or result.exists())

    def test_the_base_problem_is_fine(self):
        problem = self.folder / "problem.yaml"
        problem.write_text(self.BASE.format(data=DATA))
        self.assertEqual(run("plan", problem).returncode, 0)

    def test_bad_problems(self):
        for old, new, words in self.CASES:
            with self.subTest(new=new):
                self.assertIn(old, self.BASE)
                self.bad(self.BASE.replace(old, new).format(data=DATA), words)

    def test_not_srs(self):
        urdf = (DATA / "robots/iiwa14.urdf").read_text()
        bent = self.folder / "bent.urdf"
        match = re.search(r'(<joint name="joint_a7".*?<origin xyz=")([^"]*)(")', urdf, re.S)
        self.assertIsNotNone(match)
        x, y, z = match.group(2).split()
        bent.write_text(
            urdf[: match.start(2)] + f"{float(x) + 0.088} {y} {z}" + urdf[match.end(2) :]
        )
        problem = (
            "robot: {urdf: bent.urdf, base_link: base_link, tip_link: tool0}\n"
            "path: {waypoints: [{xyz: [0.5, 0, 0.5]}, {xyz: [0.5, 0.1, 0.5]}]}\n"
        )
        self.bad(problem + "limits: {step_error: 0.1}\n", ["limits.step_error", "S-R-S"])
        (self.folder / "bent.yaml").write_text(problem)
        done = run("plan", self.folder / "bent.yaml", "--refine")  # all else takes it
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("refined: cost", done.stdout)

    def test_command_line(self):
        problem = PROBLEMS / "experiment_a.yaml"
        for arguments, word in (
            (["--planner", "magic"], "eager_dp"),
            (["--ds", "0"], "--ds"),
            (["--edges", "none"], "continuous"),
            (["--threads", "-1"], "--threads"),
            (["--seed", "1"], "--episode"),
            (["--nonsense"], "nonsense"),
            (["--planner", "eager", "--ds", "1e-5", "--dphi", "0.005"], "eager_dp"),
            (["--ds", "abc"], "ds"),
            (["--timeout", "-1"], "--timeout"),
        ):
            done = run("plan", problem, *arguments)
            self.assertEqual(done.returncode, 2, arguments)
            self.assertEqual(len(done.stderr.strip().splitlines()), 1, done.stderr)
            self.assertIn(word, done.stderr)
        for arguments, words in (
            (("plan", problem, "--dss", "3"), "unknown option --dss; did you mean --ds?"),
            (("plan", problem, "--dss=3"), "unknown option --dss; did you mean --ds?"),
            (("plan", problem, "x", "--quite"), "unknown option --quite; did you mean --quiet?"),
            (("check", problem, "t.csv", "--zzzzzzz"), "unknown option --zzzzzzz (allowed"),
            (("plan", problem, "other.yaml"), "unexpected word 'other.yaml'"),
            (("pln", problem), "unknown command pln; did you mean plan?"),
            (("--versoin",), "unknown option --versoin; did you mean --version?"),
        ):
            done = run(*arguments)
            self.assertEqual((done.returncode, len(done.stderr.splitlines())), (2, 1), done.stderr)
            self.assertIn(words, done.stderr)
            self.assertIn("--help", done.stderr)
        self.assertEqual(run().returncode, 2)
        self.assertEqual(run("plan", "no_such_file.yaml").returncode, 2)
        self.assertEqual(run("--help").returncode, 0)

    def refused(self, words, *arguments):
        """One line with these words, and nothing written or planned."""
        before = sorted(self.folder.iterdir())
        done = run(*arguments)
        self.assertEqual(
            (done.returncode, done.stdout, len(done.stderr.splitlines())),
            (2, "", 1),
            (arguments, done),
        )
        self.assertIn(words, done.stderr)
        self.assertIn("allowed", done.stderr)
        self.assertEqual(sorted(self.folder.iterdir()), before)

    def test_no_value_is_empty(self):
        """As a variable of a shell leaves it that is not set."""
        problem, out, options = PROBLEMS / "experiment_a.yaml", self.folder / "t.csv", 0
        for command, words, names in (
            (
                "plan",
                [problem],
                (
                    "--out --json --trace --map-svg --report --certificate --timeout --edges --x "
                    "--object"
                ),
            ),
            ("time", [problem, problem, "--speed", "0.1"], "--out --rate"),
            ("campaign", [problem], "--out --json --report --trajectories --rows --shard --seed"),
            (
                "place",
                [problem, "--object", "x", "--x", "0:1:1"],
                "--out --svg --report --write --shard --best",
            ),
            ("merge", [out, problem], "--report --json --svg"),
            ("check", [problem, problem], "--certificate --ds"),
            (
                "info",
                [DATA / "robots/iiwa14.urdf"],
                "--srdf --base --tip --hold --packages --without",
            ),
            ("fit", [DATA / "robots/iiwa14.urdf"], "--out --link --packages"),
        ):
            for option in names.split():
                with self.subTest(command=command, option=option):
                    self.refused(f"{option}: is empty", command, *words, option, "")
                    options += 1
        self.assertEqual(options, 39)
        self.refused("out: is empty", "merge", "", problem)
        self.refused("problem: is empty", "plan", "")

    def test_numbers_are_refused_before_anything_is_planned(self):
        problem = PROBLEMS / "experiment_a.yaml"
        for option, more in (
            ("--timeout", []),
            ("--advise", []),
            ("--speed", []),
            ("--turn-speed", ["--speed", "0.1"]),
            ("--rate", ["--speed", "0.1"]),
            ("--chord", ["--speed", "0.1"]),
            ("--ds", []),
            ("--dphi", []),
        ):
            for value in ("-1", "0", "nan", "inf", "-inf"):
                with self.subTest(option=option, value=value):
                    self.refused(
                        f"{option}: {value}: allowed are", "plan", problem, *more,
                        f"{option}={value}", "--out", self.folder / "t.csv"
                    )
        for value in ("-1", "nan", "inf"):
            self.refused(
                f"--timeout: {value}: allowed are", "place", problem, "--object", "post",
                "--x", "0", f"--timeout={value}"
            )
            self.refused(
                f"--speed: {value}: allowed are", "time", problem, problem, f"--speed={value}"
            )
            self.refused(
                "--x: '", "plan", problem, "--path", f"--x={'1e9' if value == '-1' else value}"
            )
        for option, other in (("--seed", "--episode"), ("--episode", "--seed")):
            self.refused(f"{option}: -1", "plan", problem, other, "1", f"{option}=-1")
        self.refused("--episodes", "campaign", problem, "--episodes=-1")
        self.refused("--top", "place", problem, "--object", "post", "--x", "0", "--top=-1")

    def test_the_name_of_a_table_does_not_promise_another_format(self):
        problem = PROBLEMS / "experiment_a.yaml"
        for end in ("json", "yaml", "yml", "mcap", "html", "svg"):
            name = self.folder / f"t.{end}"
            self.refused(
                f"--out: {name}: a path without times would be in it as CSV", "plan", problem,
                "--out", name
            )
            self.refused(
                f"--out: {name}: a path without times would be in it as CSV", "plan", problem,
                "--refine", "--out", name
            )
            self.refused(
                f"--out: {name}: the table of episodes would be in it as CSV", "campaign", problem,
                "--out", name
            )
            self.refused(
                f"--out: {name}: the table of placements would be in it as CSV", "place", problem,
                "--path", "--x", "0", "--out", name
            )
        for name in ("t.csv", "t.txt", "t"):
            self.assertEqual(
                run(
                    "plan", problem, "--ds", "0.02", "--dphi", "0.2", "--quiet",
                    "--out", self.folder / name
                ).returncode,
                0,
            )
            self.assertIn("s,phi,branch", (self.folder / name).read_text())

    def test_millimetres_are_suspected_at_once(self):
        """A path of 600 m, a part of 300 m, a tool of 130 m: said, and not searched."""
        rows = [f"500,{-150 + 30 * k},300,0,0,1,0" for k in range(20)]
        (self.folder / "mm.csv").write_text("x,y,z,qw,qx,qy,qz\n" + "\n".join(rows) + "\n")
        base = {
            "robot": {
                "urdf": str(DATA / "robots/iiwa14.urdf"), "srdf": str(DATA / "robots/iiwa14.srdf"),
                "base_link": "base_link", "tip_link": "tool0"
            },
            "path": {"file": "mm.csv"},
        }

        def told(words, seconds=5, **changes):
            problem = json.loads(json.dumps(base))
            for section, values in changes.items():
                problem[section] = (
                    {**problem.get(section, {}), **values} if section == "robot" else values
                )
            (self.folder / "p.yaml").write_text(json.dumps(problem))
            start = time.monotonic()
            done = run(
                "plan", self.folder / "p.yaml", "--planner", "lazy", "--quiet",
                "--json", self.folder / "r.json"
            )
            result = json.loads((self.folder / "r.json").read_text())
            self.assertLess(time.monotonic() - start, seconds)
            self.assertEqual(
                sum("millimetres" in warning for warning in result["warnings"]),
                1,
                result["warnings"],
            )
            self.assertTrue(
                any(re.search(words, warning) for warning in result["warnings"]), result["warnings"]
            )
            return done, result

        done, result = told(
            r"path: waypoint 0 is 6\d\d(\.\d)? m from the arm, and the arm reaches [12]\.\d+ m"
        )
        self.assertEqual(done.returncode, 1)
        self.assertLess(result["lattice"]["layers"], 10)
        proof = self.folder / "none.json"
        shown = run("plan", self.folder / "p.yaml", "--planner", "lazy", "--certificate", proof)
        self.assertRegex(
            shown.stdout, r"^no path at any resolution: .* \(out of reach by 6\d\d m\)\n"
        )
        self.assertEqual(shown.stderr.count("are these millimetres?"), 1, shown.stderr)
        checked = run("check", self.folder / "p.yaml", "--certificate", proof)
        self.assertEqual(checked.returncode, 0, checked.stdout)
        # Many GB, if all of it were laid out.
        told(
            "path: waypoint 0", path={"file": "mm.csv", "roll": "free"},
            robot={"tool": {"rpy": [0, 0.7, 0]}}
        )
        near = {
            "waypoints": [
                {"xyz": [0.5, -0.1, 0.4], "rpy": [0, 3, 0]},
                {"xyz": [0.5, 0.1, 0.4], "rpy": [0, 3, 0]},
            ]
        }
        told(
            "scene: 'part' is 300 m long", path=near,
            scene=[{"name": "part", "box": [300, 200, 100], "xyz": [0, 0, -80]}],
            limits={"edges": "nodes"}
        )
        told(
            "scene: 'rack' is .* m from the arm", path=near,
            scene=[{"name": "rack", "sphere": 0.1, "xyz": [700, 0, 300]}]
        )
        told("robot.tool is 130 m long", path=near, robot={"tool": {"xyz": [0, 0, 130]}})
        (self.folder / "p.yaml").write_text(
            json.dumps(
                {
                    **base, "path": near,
                    "scene": [{"name": "floor", "box": [200, 200, 0.1], "xyz": [0, 0, -0.2]}]
                }
            )
        )
        self.assertNotIn(
            "millimetres", run("plan", self.folder / "p.yaml", "--planner", "lazy").stderr
        )

    def test_a_terminal_breaks_no_number(self):
        """On 80 columns lines are broken between words, by the program."""
        command = [
            SWIVEL, "plan", str(PROBLEMS / "experiment_a.yaml"), "--ds", "0.02", "--dphi", "0.2",
            "--refine", "--speed", "0.1"
        ]
        plain = subprocess.run(command, capture_output=True, text=True, timeout=300).stdout
        self.assertGreater(max(map(len, plain.splitlines())), 80)
        code, lines = on_terminal("stdout", command)
        self.assertEqual(code, 0)
        self.assertLessEqual(max(map(len, lines)), 80, lines)

        def words(text):  # times differ from run to run
            return [re.sub(r"[0-9.]+", "#", word) for word in text.split()]

        self.assertEqual(words(" ".join(lines)), words(plain))

    def test_a_terminal_breaks_no_warning(self):
        """Nor on standard error; a pipe has the line whole."""
        for arguments in (
            [SWIVEL, "plan", str(PROBLEMS / "experiment_a.yaml"), "--object", "nothing"],
            [SWIVEL, "plan", str(PROBLEMS / "experiment_a.yaml"), "--ds", "1e-5", "--dphi", "1e-5"],
        ):
            plain = subprocess.run(arguments, capture_output=True, text=True, timeout=300).stderr
            self.assertEqual(plain.count("\n"), 1, plain)
            self.assertGreater(len(plain), 100)
            code, lines = on_terminal("stderr", arguments)
            self.assertEqual(code, 2)
            self.assertGreater(len(lines), 1)
            self.assertLessEqual(max(len(line) for line in lines if " " in line.strip()), 80, lines)
            self.assertTrue(all(line.startswith("    ") for line in lines[1:]), lines)
            self.assertEqual(" ".join(lines).split(), plain.split())

    def test_bad_trajectories(self):
        out = self.folder / "t.csv"
        names = (
            "arm_left_joint_1_s,arm_left_joint_2_l,arm_left_joint_3_e,arm_left_joint_4_u,"
            "arm_left_joint_5_r,arm_left_joint_6_b,arm_left_joint_7_t"
        )
        for text in (
            "", "s,phi,branch,a,b,c,d,e,f,g\n", f"s,phi,branch,{names}\n0,0,0,1,2,3\n",
            f"s,phi,branch,{names}\n0,0,0,1,2,3,4,5,6,x\n"
        ):
            out.write_text(text)
            done = run("check", PROBLEMS / "experiment_a.yaml", out)
            self.assertEqual(done.returncode, 2, text)
            self.assertEqual(len(done.stderr.strip().splitlines()), 1)
            self.assertIn("t.csv", done.stderr)


class ForeignText(WithFolder):
    """What comes from files and would turn, move or colour a terminal is printed as '?'."""

    def test_controls_reach_no_terminal(self):
        controls = "\u202e\u2066\u200f\x1b[31m\x07\x9b"
        robot = self.folder / "robot.urdf"
        text = (DATA / "robots/iiwa14.urdf").read_text()
        # Characters that XML cannot hold are left out.
        xml = "".join(f"&#{ord(c)};" for c in controls if c not in "\x1b\x07")
        robot.write_text(re.sub(r'<robot name="[^"]*"', f'<robot name="arm{xml}"', text))
        problem = self.folder / f"gnp{controls}.yaml"
        problem.write_text(
            (PROBLEMS / "experiment_a.yaml").read_text().replace("../", str(DATA) + "/")
        )
        wrong = self.folder / f"wrong{controls}.yaml"
        wrong.write_text("robot: {}\n")
        seen = 0
        for arguments in (
            ("info", robot),
            ("plan", problem),
            ("plan", problem, "--ds", "1e-9"),
            ("plan", wrong),
            ("check", problem, wrong),
            ("plan", self.folder / controls),
            ("plan", problem, "--out", self.folder / controls / "t.csv"),
            ("info", robot, "--tip", controls),
        ):
            with self.subTest(arguments):
                done = run(*arguments)
                for said in (done.stdout, done.stderr):
                    self.assertFalse(
                        [c for c in said if c in controls and c != "[" and not c.isalnum()],
                        repr(said),
                    )
                    seen += "?" in said
        self.assertGreaterEqual(seen, 6)


class Stopping(WithFolder):
    # A plan of minutes.
    LONG = (
        PROBLEMS / "experiment_b.yaml", "--planner", "eager_dp", "--ds", "0.0005", "--dphi", "0.005"
    )

    def start(self, *options):
        process = subprocess.Popen(
            [SWIVEL, "plan", *map(str, self.LONG), *map(str, options)],
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        )
        self.addCleanup(process.communicate)
        self.addCleanup(process.kill)
        time.sleep(1.5)
        self.assertIsNone(process.poll())
        return process

    def test_terminated_it_leaves_its_result(self):
        for sent in (signal.SIGINT, signal.SIGTERM):
            process = self.start("--json", self.folder / "r.json")
            process.send_signal(sent)
            said = process.communicate(timeout=20)[0]
            self.assertEqual(process.returncode, 3)
            self.assertIn("stopped: cancelled", said)
            self.assertEqual(
                json.loads((self.folder / "r.json").read_text())["status"], "cancelled"
            )

    def test_the_second_time_it_ends_at_once(self):
        process = self.start("--json", self.folder / "r.json")
        process.send_signal(signal.SIGSTOP)  # so that both are there before it can act on the first
        process.send_signal(signal.SIGINT)
        process.send_signal(signal.SIGTERM)
        process.send_signal(signal.SIGCONT)
        process.communicate(timeout=20)
        self.assertIn(process.returncode, (130, 143))
        self.assertFalse((self.folder / "r.json").exists())

    def test_a_time_out_of_centuries(self):
        done = run(
            "plan", PROBLEMS / "experiment_a.yaml", "--ds", "0.02", "--dphi", "0.2",
            "--timeout", "1e10"
        )
        self.assertEqual(done.returncode, 0, done.stdout)

    def test_quiet_measures_nothing(self):
        for quiet in ((), ("--quiet",)):
            trace = self.folder / "trace.json"
            done = run(
                "plan", PROBLEMS / "experiment_c.yaml", "--out", self.folder / "t.csv",
                "--trace", trace, *quiet
            )
            self.assertEqual(done.returncode, 0)
            spans = [e for e in json.loads(trace.read_text())["traceEvents"] if e["ph"] == "X"]
            report = next(e for e in spans if e["name"] == "report")
            asked = [
                e
                for e in spans
                if e["name"].startswith("fcl::")
                and e["ts"] >= report["ts"]
                and e["ts"] <= report["ts"] + report["dur"]
            ]
            self.assertEqual(asked == [], quiet != ())
            self.assertEqual("self time by stage" in done.stderr, quiet == ())

    def test_layers_of_one_reason_on_one_line(self):
        problem = self.folder / "p.yaml"
        problem.write_text(
            (PROBLEMS / "experiment_a.yaml")
            .read_text()
            .replace("../robots", str(DATA / "robots"))
            .replace("{xyz: [0.6, 0.4, 0.9]", "{xyz: [1.4, -0.1, 0.9]")
        )
        done, _, result = self.plan(problem, "--ds", "0.02", "--dphi", "0.2")
        self.assertEqual(done.returncode, 1)
        self.assertTrue(result["diagnosis"]["complete"])
        last = result["diagnosis"]["empty_layers"][-1]
        self.assertEqual(
            (last["reason"], last["cause"]["side"], last["cause"]["unit"], last["waypoints"]),
            ("no IK", "upper", "m", [1, 1]),
        )
        lines = [line for line in done.stdout.splitlines() if "no valid node" in line]
        self.assertLess(len(lines), 5)
        self.assertRegex(
            lines[-1],
            r"  layers \d+ to 40 \(waypoint 1\), s = [0-9.]+ to 0.8000 m: no valid node: no IK "
            r"\(out of reach by [0-9.]+ to %.3g mm\)"
            % (1e3 * last["most"]),
        )


class Campaign(WithFolder):
    PROBLEM = PROBLEMS / "experiment_c.yaml"
    QUICK = ("--ds", "0.02", "--dphi", "0.2", "--edges", "nodes")
    HEADER = (
        "episode,status,cost,plan_ms,nodes_checked,fcl_calls,tool_path_error_mm_mean,"
        "tool_path_error_mm_max,failed_s,cause,by,reason,checked"
    )
    OFFSETS = [f"door.{name}" for name in ("x", "y", "z", "roll", "pitch", "yaw")]
    EPISODES = 12

    def campaign(self, name, *options, code=0, episodes=EPISODES, problem=None):
        out = self.folder / name
        pairs = zip(self.QUICK[::2], self.QUICK[1::2])
        quick = [word for pair in pairs if pair[0] not in options for word in pair]
        done = run(
            "campaign", problem or self.PROBLEM, "--episodes", episodes, *quick, "--out", out,
            *options
        )
        self.assertEqual(done.returncode, code, done.stdout + done.stderr)
        return done, out

    def test_a_flag_that_is_not_given_changes_nothing(self):
        text = BadInput.BASE.format(data=DATA) + "vary: [{object: post, xyz: [0.1, 0.1, 0.1]}]\n"
        for in_file in (False, True):
            problem = self.folder / "problem.yaml"
            problem.write_text(
                text.replace("dphi: 0.2", "dphi: 0.2, arcs: true") if in_file else text
            )
            for option, expected in (((), in_file), (("--arcs",), True), (("--no-arcs",), False)):
                _, out = self.campaign(
                    "shard.csv", "--shard", "0/1", *option, episodes=1, problem=problem
                )
                self.assertIn(f'"arcs":"{str(expected).lower()}"', out.read_text().splitlines()[0])

    def killed(self, name, *options, problem=None, rows=3):
        """The .part file of a campaign that was killed after some rows."""
        part = self.folder / (name + ".part")
        many = (
            SWIVEL, "campaign", problem or self.PROBLEM, "--episodes", "20000", *self.QUICK,
            "--out", self.folder / name, *options
        )
        with subprocess.Popen(
            list(map(str, many)), stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
        ) as process:
            deadline = time.monotonic() + 60
            while (
                time.monotonic() < deadline
                and process.poll() is None
                and (not part.exists() or part.read_text().count("\n") < rows + 2)
            ):
                time.sleep(0.005)
            process.kill()
            _, errors = process.communicate(timeout=60)
        self.assertEqual(process.returncode, -signal.SIGKILL, errors)
        return part

    def rows(self, out):
        """Of a whole campaign, or of a shard, whose first line says so."""
        lines = [
            line
            for line in out.read_text().splitlines()
            if not line.startswith("# swivel campaign {")
        ]
        self.assertEqual(lines[0], ",".join([self.HEADER, *self.OFFSETS]))
        self.assertFalse(out.with_name(out.name + ".part").exists())
        return list(csv.DictReader(lines))

    @staticmethod
    def without_times(rows):
        return [{key: value for key, value in row.items() if key != "plan_ms"} for row in rows]

    def test_rows_do_not_depend_on_threads_and_shards(self):
        done, out = self.campaign("one.csv", "--threads", "1")
        one = self.rows(out)
        counts = [int(n) for n in re.findall(r"^  (\d+) without a path: \S", done.stdout, re.M)]
        self.assertEqual(sum(counts), sum(row["status"] == "infeasible" for row in one))
        self.assertEqual(counts, sorted(counts, reverse=True))
        self.assertEqual([row["episode"] for row in one], [str(k) for k in range(self.EPISODES)])
        self.assertEqual({row["status"] for row in one}, {"solved", "infeasible"})
        for row in one:
            solved = row["status"] == "solved"
            self.assertEqual(
                [
                    row[key] != ""
                    for key in ("cost", "tool_path_error_mm_mean", "tool_path_error_mm_max")
                ],
                [solved] * 3,
            )
            self.assertEqual([row[key] == "" for key in ("reason", "cause")], [solved] * 2)
            self.assertTrue(not solved or row["failed_s"] == "")
        two = self.rows(self.campaign("two.csv", "--threads", "2")[1])
        self.assertEqual(self.without_times(one), self.without_times(two))
        union = []
        for k in range(3):
            shard = self.rows(self.campaign("shard.csv", "--shard", f"{k}/3")[1])
            self.assertEqual(
                [int(row["episode"]) for row in shard], list(range(k, self.EPISODES, 3))
            )
            union += shard
        self.assertEqual(
            self.without_times(one),
            self.without_times(sorted(union, key=lambda row: int(row["episode"]))),
        )

    def test_rows_say_where_the_objects_stood(self):
        """The offsets, put into a problem of no campaign, give the episode."""
        rows = self.rows(self.campaign("r.csv", episodes=40)[1])
        half = {"x": 0.1, "y": 0.1, "z": 0.1, "roll": 0.3, "pitch": 0.3, "yaw": 0.3}
        for name, most in half.items():
            values = [float(row["door." + name]) for row in rows]
            self.assertTrue(
                all(abs(value) <= most for value in values)
                and min(values) < -most / 2
                and max(values) > most / 2,
                name,
            )
        self.assertGreaterEqual(
            len({row["by"] for row in rows if row["status"] == "infeasible"}), 2
        )
        met = set()
        for row in rows[:12]:
            words = [f"--{name}={row['door.' + name]}" for name in half]
            result = self.folder / "one.json"
            done = run(
                "plan", self.PROBLEM, *self.QUICK, "--object", "door", *words, "--json", result,
                "--quiet"
            )
            self.assertIn(done.returncode, (0, 1), done.stderr)
            said = json.loads(result.read_text())
            met.add(said["status"])
            self.assertEqual(said["status"], row["status"])
            if said["status"] == "solved":
                # Poses of placements are rounded to 1e-12.
                self.assertAlmostEqual(said["cost"], float(row["cost"]), 6)
            else:
                self.assertEqual(
                    (said["diagnosis"]["cause"]["cause"], said["diagnosis"]["reason"]),
                    (row["cause"], row["reason"]),
                )
        self.assertEqual(met, {"solved", "infeasible"})
        two = self.folder / "two.yaml"
        two.write_text(
            self.PROBLEM.read_text()
            .replace("../", str(DATA) + "/")
            .replace(
                "{object: door, xyz: [0.1, 0.1, 0.1], rpy: [0.3, 0.3, 0.3]}",
                "{object: post, xyz: [0.1, 0, 0]}\n  - {object: rail, rpy: [0, 0, 0.1]}",
            )
        )
        out = self.campaign("two.csv", problem=two)[1]
        self.assertEqual(out.read_text().splitlines()[0], self.HEADER + ",post.x,rail.yaw")
        done, _ = self.campaign("bad.csv", "--rows", out, code=2)
        self.assertIn("other objects or coordinates vary", done.stderr)

    def test_the_share_of_a_task_of_a_job_array(self):
        wanted = self.campaign("two.csv", "--shard", "2/3")[1].read_text()

        def share(name, code=0, **task):
            environment = {
                key: value for key, value in os.environ.items() if not key.startswith("SLURM_")
            }
            environment.update({"SLURM_ARRAY_TASK_" + key: value for key, value in task.items()})
            out = self.folder / name
            done = subprocess.run(
                [
                    SWIVEL, "campaign", self.PROBLEM, "--episodes", str(self.EPISODES), *self.QUICK,
                    "--shard", "auto", "--out", out
                ],
                capture_output=True,
                text=True,
                timeout=300,
                env=environment,
            )
            self.assertEqual(done.returncode, code, done.stderr)
            if code:
                self.assertEqual(len(done.stderr.splitlines()), 1, done.stderr)
                self.assertFalse(out.exists())
                return done.stderr
            return self.without_times(self.rows(out))

        two = self.without_times(self.rows(self.folder / "two.csv"))
        self.assertEqual(len(wanted.splitlines()), 2 + self.EPISODES // 3)
        self.assertEqual(share("a.csv", ID="7", COUNT="3", MIN="5"), two)
        self.assertEqual(share("b.csv", ID="14", COUNT="3", MIN="10", STEP="2"), two)
        self.assertIn("SLURM_ARRAY_TASK_ID is not set", share("c.csv", 2))
        self.assertIn(
            "SLURM_ARRAY_TASK_COUNT is 'x'", share("d.csv", 2, ID="1", COUNT="x", MIN="0")
        )
        for task in (
            {"ID": "9", "COUNT": "3", "MIN": "5"},
            {"ID": "4", "COUNT": "3", "MIN": "5"},
            {"ID": "6", "COUNT": "3", "MIN": "5", "STEP": "2"},
            {"ID": "6", "COUNT": "3", "MIN": "5", "STEP": "0"},
        ):
            self.assertIn("--array=0-31", share("e.csv", 2, **task))

    def test_a_finished_campaign_is_made_longer(self):
        whole = self.rows(self.campaign("whole.csv")[1])
        first = self.campaign("first.csv", episodes=5)[1]
        longer = self.rows(self.campaign("longer.csv", "--rows", first)[1])
        self.assertEqual(self.without_times(longer), self.without_times(whole))
        # Not planned again.
        self.assertEqual(
            [row["plan_ms"] for row in longer][:5], [row["plan_ms"] for row in self.rows(first)]
        )
        shard = self.campaign("shard.csv", "--shard", "0/3")[1]
        for rows in ([first, first], [shard], [self.PROBLEM]):
            done, _ = self.campaign("bad.csv", "--rows", *rows, code=2)
            self.assertEqual(len(done.stderr.strip().splitlines()), 1, done.stderr)
            self.assertFalse((self.folder / "bad.csv.part").exists())

    def test_a_row_is_what_plan_says(self):
        folder = self.folder / "trajectories"
        done, out = self.campaign("r.csv", "--seed", "5", "--trajectories", folder, "--json", "-")
        rows = self.rows(out)
        summary = json.loads(done.stdout)
        self.assertEqual((summary["episodes"], summary["answered"]), (self.EPISODES, self.EPISODES))
        self.assertEqual(summary["solved"], sum(row["status"] == "solved" for row in rows))
        self.assertEqual(
            {file.name for file in folder.iterdir()},
            {f"episode_{row['episode']}.csv" for row in rows if row["status"] == "solved"},
        )
        for status in ("solved", "infeasible"):
            row = next(row for row in rows if row["status"] == status)
            _, trajectory, result = self.plan(
                self.PROBLEM, *self.QUICK, "--seed", "5", "--episode", row["episode"]
            )
            self.assertEqual(result["status"], status)
            self.assertEqual(
                [int(row[key]) for key in ("nodes_checked", "fcl_calls")],
                [result["counters"][key] for key in ("nodes_checked", "fcl_calls")],
            )
            number = lambda text: float(text) if text else None
            self.assertEqual(
                [
                    number(row[key])
                    for key in ("cost", "tool_path_error_mm_mean", "tool_path_error_mm_max")
                ],
                [
                    result["cost"], result["tool_path_error_mm"]["mean"],
                    result["tool_path_error_mm"]["max"]
                ],
            )
            if status == "solved":
                self.assertEqual(
                    (folder / f"episode_{row['episode']}.csv").read_bytes(), trajectory.read_bytes()
                )
            else:
                self.assertEqual(
                    (number(row["failed_s"]), row["reason"]),
                    (result["diagnosis"]["reached_s"], result["diagnosis"]["reason"]),
                )

    def test_no_trajectory_is_a_file_of_another_option(self):
        folder = self.folder / "trajectories"
        folder.mkdir()
        elsewhere = self.folder / "elsewhere.csv"
        elsewhere.write_text("mine\n")
        (folder / "episode_7.csv").symlink_to(elsewhere)
        (self.folder / "link").symlink_to(folder)
        (folder / "here.csv").symlink_to("episode_3.csv")
        problem = folder / "episode_5.csv"
        problem.write_text(self.PROBLEM.read_text().replace("../", str(DATA) + "/"))
        refused = [
            (self.PROBLEM, "--out", folder / "episode_0.csv"),
            (self.PROBLEM, "--json", folder / "episode_0.csv"),
            (self.PROBLEM, "--out", folder / "." / ".." / "trajectories" / "episode_1.csv"),
            (self.PROBLEM, "--out", self.folder / "link" / "episode_1.csv"),
            (self.PROBLEM, "--out", folder / "here.csv"),
            (self.PROBLEM, "--out", elsewhere),
            (problem, "--out", self.folder / "out.csv"),
        ]
        for arguments in refused:
            with self.subTest(arguments):
                done = run(
                    "campaign", arguments[0], "--episodes", 1, *self.QUICK, *arguments[1:],
                    "--trajectories", folder
                )
                self.assertEqual(done.returncode, 2, done.stdout + done.stderr)
                self.assertEqual(len(done.stderr.strip().splitlines()), 1, done.stderr)
                self.assertIn("--trajectories", done.stderr)
                self.assertEqual(done.stdout, "")
        problem.unlink()
        (folder / "episode_7.csv").unlink()
        self.assertEqual(elsewhere.read_text(), "mine\n")
        new = self.folder / "new"  # which would be a file and a folder
        done = run(
            "campaign", self.PROBLEM, "--episodes", 1, *self.QUICK, "--out", new,
            "--trajectories", new
        )
        self.assertEqual(done.returncode, 2, done.stderr)
        done = run(
            "campaign", self.PROBLEM, "--episodes", 1, *self.QUICK, "--out", folder / "table.csv",
            "--trajectories", folder
        )
        self.assertEqual(done.returncode, 0, done.stderr)
        done = run(
            "campaign", self.PROBLEM, "--episodes", 1, *self.QUICK, "--rows", folder / "table.csv",
            "--out", folder / "table.csv"
        )
        self.assertEqual(done.returncode, 2, done.stderr)
        self.assertIn("one of the files that are read", done.stderr)

    def test_resume(self):
        out = self.campaign("r.csv")[1]
        part = self.folder / "r.csv.part"
        whole = self.rows(out)
        lines = out.read_text().splitlines(keepends=True)
        settings = self.killed("r.csv").read_text().splitlines(keepends=True)[0]
        # Marked, so that a row that was planned again would show.
        marked = [
            ",".join([*line.split(",")[:3], "123456.000", *line.split(",")[4:]])
            for line in lines[1:6]
        ]
        for name, text, kept in (
            ("whole lines", lines[0] + "".join(marked), 5),
            ("torn line", lines[0] + "".join(marked) + lines[6][:-3], 5),
            ("no rows", lines[0], 0),
            ("torn header", lines[0][:20], 0),
            ("no header", "", 0),
            ("complete", "".join(lines), None),
        ):
            with self.subTest(name):
                part.write_text(settings + text)
                again = self.rows(self.campaign("r.csv", "--threads", "2")[1])
                self.assertEqual(self.without_times(again), self.without_times(whole))
                if kept is not None:
                    self.assertEqual(
                        [row["plan_ms"] == "123456.000" for row in again],
                        [k < kept for k in range(self.EPISODES)],
                    )
        for text in ("", settings[:9], settings[:40]):  # torn within the first line
            part.write_text(text)
            self.assertEqual(
                self.without_times(self.rows(self.campaign("r.csv")[1])), self.without_times(whole)
            )
        # Rows from a campaign without trajectories do not stand for them.
        folder = self.folder / "trajectories"
        part.write_text(settings + "".join(lines))
        self.campaign("r.csv", "--trajectories", folder)
        self.assertEqual(
            len(list(folder.iterdir())), sum(row["status"] == "solved" for row in whole)
        )

    def test_a_killed_campaign_goes_on_with_its_own_settings_alone(self):
        for folder in ("robots", "meshes", "paths", "problems"):
            shutil.copytree(DATA / folder, self.folder / folder)
        problem = self.folder / "problems" / self.PROBLEM.name
        unbroken = self.rows(self.campaign("whole.csv", "--threads", "2", problem=problem)[1])
        text = self.killed("r.csv", problem=problem).read_text()
        part = self.folder / "r.csv.part"
        part.write_text("".join(text.splitlines(keepends=True)[:5]))
        text = part.read_text()

        def refused(words, *options):
            done, _ = self.campaign("r.csv", *options, code=2, problem=problem)
            self.assertEqual(len(done.stderr.strip().splitlines()), 1, done.stderr)
            for word in ("r.csv.part:1: ", *words, "allowed"):
                self.assertIn(word, done.stderr)
            self.assertEqual(part.read_text(), text)

        changed = 0
        for options, words in (
            (("--seed", "6"), ["seed 1, this is 6"]),
            (("--planner", "lazy"), ["planner parallel, this is lazy"]),
            (("--ds", "0.021"), ["ds 0.02, this is 0.021"]),
            (("--dphi", "0.21"), ["dphi 0.2, this is 0.21"]),
            (("--arcs",), ["arcs false, this is true"]),
            (("--edges", "continuous"), ["edges nodes, this is continuous"]),
            (("--shard", "0/2"), ["shard 0/1, this is 0/2"]),
        ):
            with self.subTest(options=options):
                refused(words, *options)
                changed += 1
        for name in (
            "problems/" + self.PROBLEM.name, "robots/sda5f.urdf", "robots/sda5f.srdf",
            "meshes/door_2k.stl", "paths/door_polish.csv"
        ):
            with self.subTest(name=name):
                file = self.folder / name
                before = file.read_bytes()
                if name.endswith(".yaml"):
                    after = before.replace(b"clearance: 0.005", b"clearance: 0.012")
                elif name.endswith(".stl"):
                    after = before[:100] + bytes([before[100] ^ 1]) + before[101:]
                else:
                    after = before + b"\n"
                self.assertNotEqual(before, after)
                file.write_bytes(after)
                refused(["the problem file" if name.endswith(".yaml") else "../" + name])
                file.write_bytes(before)
                changed += 1
        self.assertEqual(changed, 12)
        for threads in ("1", "3"):  # from another folder and by another name, with other outputs
            part.write_text(text)
            (self.folder / "problems/other.yaml").write_bytes(problem.read_bytes())
            done = subprocess.run(
                [
                    SWIVEL, "campaign", "problems/other.yaml", "--episodes", str(self.EPISODES),
                    *self.QUICK, "--threads", threads, "--out", "r.csv", "--json", "s.json"
                ],
                cwd=self.folder,
                capture_output=True,
                text=True,
            )
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertEqual(
                self.without_times(self.rows(self.folder / "r.csv")), self.without_times(unbroken)
            )

    def test_a_part_of_something_else_is_left_alone(self):
        lines = self.campaign("r.csv")[1].read_text().splitlines(keepends=True)
        settings = self.killed("r.csv").read_text().splitlines(keepends=True)[0]
        part = self.folder / "r.csv.part"
        for text, options, episodes in (
            ("".join(lines[:3]), ("--shard", "1/2"), self.EPISODES),
            (lines[0] + lines[2], (), self.EPISODES),
            ("x,y,z\n", (), self.EPISODES),
            (lines[0], (), self.EPISODES),
            (lines[0] + "0,solved\n", (), self.EPISODES),
            ("".join(lines), (), 3),
        ):
            text = text if text == lines[0] else settings + text
            part.write_text(text)
            done, _ = self.campaign("r.csv", *options, code=2, episodes=episodes)
            self.assertEqual(len(done.stderr.strip().splitlines()), 1, done.stderr)
            self.assertIn("r.csv.part:", done.stderr)
            self.assertIn("allowed", done.stderr)
            self.assertEqual(part.read_text(), text)

    def test_interrupted(self):
        out = self.folder / "r.csv"
        part = self.folder / "r.csv.part"
        many = ("campaign", self.PROBLEM, "--episodes", "2000", *self.QUICK, "--out", out)
        with subprocess.Popen(
            [SWIVEL, *map(str, many)], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
        ) as process:
            deadline = time.monotonic() + 60
            while time.monotonic() < deadline and (
                not part.exists() or part.read_text().count("\n") < 3
            ):
                time.sleep(0.01)
            process.send_signal(signal.SIGINT)
            _, errors = process.communicate(timeout=60)
        self.assertEqual((process.returncode, errors), (3, ""))
        self.assertFalse(out.exists())
        text = part.read_text()
        self.assertTrue(text.endswith("\n"))
        self.assertEqual(
            [line.split(",")[0] for line in text.splitlines()[2:]],
            [str(k) for k in range(text.count("\n") - 2)],
        )
        self.assertGreater(text.count("\n"), 2)

    def test_bad_input(self):
        cases = [
            (["--shard", shard], "--shard") for shard in ("3/3", "1", "a/b", "0/0", "-1/2", "1/2/3")
        ]
        cases += [
            (["--episodes", "0"], "--episodes"),
            (["--episodes", "-3"], "episodes"),
            (["--planner", "magic"], "eager_dp"),
            (["--dphi", "7"], "--dphi"),
            (["--out", self.folder / "nowhere" / "r.csv"], "nowhere"),
            (["--out", "/dev/null"], "/dev/null"),
            (["--ds", "1e-9"], "ds"),
        ]
        still = PROBLEMS / "experiment_a.yaml"
        for arguments, word in [*cases, ([], "vary")]:
            with self.subTest(arguments=arguments):
                out = [] if "--out" in arguments else ["--out", self.folder / "r.csv"]
                done = run("campaign", self.PROBLEM if arguments else still, *out, *arguments)
                self.assertEqual(done.returncode, 2, done.stdout + done.stderr)
                self.assertEqual(len(done.stderr.strip().splitlines()), 1, done.stderr)
                self.assertIn(word, done.stderr)
                self.assertEqual(list(self.folder.iterdir()), [])
        self.assertEqual(
            run("campaign", still, "--episodes", "1", "--ds", "0.02", "--dphi", "0.2").returncode, 0
        )


class RealRobots(WithFolder):
    """Real URDFs with meshes; skipped where they are not at hand."""

    def setUp(self):
        super().setUp()
        if not (SHARED / "data").exists():
            self.skipTest("real robot files are not here")

    def problem(self, text):
        file = self.folder / "problem.yaml"
        file.write_text(text.format(shared=SHARED / "data"))
        return file

    def test_info(self):
        folder = SHARED / "data/motoman_sda5f/motoman_sda5f_support/urdf"
        for name, deviation in (("sda5f_expanded.urdf", 0.3), ("sda5f_checked_in.urdf", 0.3)):
            done = run("info", folder / name, "--base", "base_link", "--tip", "arm_left_link_7_t")
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertIn("S-R-S, in-plane elbow offset", done.stdout)
            millimetres = float(done.stdout.split("axes within ")[1].split(" mm")[0])
            self.assertLess(millimetres, deviation)
            upper = float(done.stdout.split("shoulder-elbow ")[1].split(" m")[0])
            self.assertAlmostEqual(upper, 0.28306, delta=2e-4)
        puzzle = SHARED / "data/puzzle_cell/tesseract/support/urdf/puzzle_piece_workcell.urdf"
        done = run("info", puzzle, "--base", "base_link", "--tip", "part")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("shoulder-elbow 0.420000 m, elbow-wrist 0.400000 m", done.stdout)
        self.assertIn("0.436 mm", done.stdout)

    def test_experiment_a_with_real_meshes(self):
        problem = self.problem(
            """robot:
  urdf: {shared}/motoman_sda5f/motoman_sda5f_support/urdf/sda5f_expanded.urdf
  srdf: {shared}/motoman_sda5f/motoman_sda5f.srdf
  base_link: base_link
  tip_link: arm_left_link_7_t
path: {{file: "{shared}/paths/paper_experiment_A_line.csv"}}
resolution: {{ds: 0.02, dphi: 0.1}}
"""
        )
        done, out, result = self.plan(problem)
        self.assertEqual(done.returncode, 0, done.stderr)
        urdf = SHARED / "data/motoman_sda5f/motoman_sda5f_support/urdf/sda5f_expanded.urdf"
        outside = subprocess.run(
            [
                sys.executable, VERIFY, urdf, "base_link", "arm_left_link_7_t",
                SHARED / "data/paths/paper_experiment_A_line.csv", out,
                "--cost", repr(result["cost"])
            ],
            capture_output=True,
            text=True,
        )
        self.assertEqual(outside.returncode, 0, outside.stdout)

    def test_puzzle(self):
        problem = self.problem(
            """robot:
  urdf: {shared}/puzzle_cell/tesseract/support/urdf/puzzle_piece_workcell.urdf
  srdf: {shared}/puzzle_cell/tesseract/support/urdf/puzzle_piece_workcell.srdf
  base_link: base_link
  tip_link: part
path: {{file: "{shared}/paths/puzzle_bent_iiwa14_base_to_part.csv"}}
resolution: {{ds: 0.005, dphi: 0.05}}
"""
        )
        done, out, result = self.plan(problem)
        self.assertEqual(done.returncode, 1, done.stderr)
        empty = [run for run in result["diagnosis"]["empty_layers"] if run["waypoints"] is not None]
        # Waypoint 400 is 1.7e-7 rad inside the limit on the exact chain (docs/decisions, 0009).
        self.assertEqual(
            [w for run in empty for w in range(run["waypoints"][0], run["waypoints"][1] + 1)],
            [*range(0, 10), *range(181, 185), *range(396, 400), *range(419, 423)],
        )
        self.assertEqual({run["reason"] for run in empty}, {"joint joint_a4"})


if __name__ == "__main__":
    unittest.main(verbosity=1)

#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""What is promised of one kind of problem is asked of all: every option of `plan`, and every key of
its result, on one path, on a job and on two arms, where there is a plan, where there is none, and
where time or Ctrl-C ends it. What a kind does not have is listed here, with the reason."""
import itertools
import json
import os
import pathlib
import re
import signal
import subprocess
import tempfile
import time
import unittest
import xml.etree.ElementTree

from job_test import one_job
from workcell_test import cell

SWIVEL = os.environ["SWIVEL"]
DATA = pathlib.Path(os.environ["SWIVEL_DATA"])
KINDS = ("path", "job", "two arms")

# A word for each option that takes one; "" for flags, FILE for the name of an output.
FILE = object()
WORDS = {
    "--planner": "lazy", "--threads": "1", "--ds": "0.025", "--dphi": "0.25", "--knot": "0",
    "--arcs": "", "--no-arcs": "", "--edges": "nodes", "--timeout": "60", "--refine": "",
    "--speed": "0.05", "--turn-speed": "0.5", "--rate": "100", "--chord": "0.001",
    "--advise": "0.2", "--out": FILE, "--certificate": FILE, "--json": FILE, "--trace": FILE,
    "--map": "", "--map-svg": FILE, "--report": FILE, "--full-map": "", "--no-check": "",
    "--quiet": ""
}
# Options that choose what is planned; tests of placements and campaigns ask them of all kinds.
ELSEWHERE = {
    "--help", "--seed", "--episode", "--object", "--path", "--arm", "--base", "--hold", "--x",
    "--y", "--z", "--roll", "--pitch", "--yaw"
}
# What must stand beside an option for it to mean something.
BESIDE = {
    "--turn-speed": ("--speed", "0.05"), "--chord": ("--speed", "0.05"), "--full-map": ("--map", ),
    "--rate": ("--speed", "0.05")
}
# Options that a kind refuses by one line, with the reason: none.
REFUSED = {}
# Outputs: where there is a plan, where there is none, where it was stopped.
WRITTEN = {
    "--out": (True, False, False), "--certificate": (False, True, False),
    "--json": (True, True, True), "--report": (True, True, False),
    "--map-svg": (True, True, False), "--trace": (True, True, True)
}
# Keys of results that not every kind has.
KEYS_OF_SOME = {
    "path": {
        "of the rows, which jobs have by stroke and two arms by arm": [
            "summary", "lattice", "tool_path_error_mm", "min_clearance", "min_margin",
            "min_clearance_status", "deepest_contact", "deepest_contact_status",
            "min_manipulability", "arm_angle", "diagnosis", "trajectory", "partial",
            "robot_pairs", "held", "joint_names"
        ],
        "how large the proof is": ["certificate"],
    },
    "job": {
        "of several strokes": [
            "order", "runs", "transitions", "lift_offs", "no_transition", "transition_counters",
            "parts"
        ],
        "bounds of a search over transitions": [
            "bound", "bound_any", "bound_orders", "gap", "lattice_cost"
        ],
        "of the one arm": ["partial", "robot_pairs", "held", "joint_names"],
    },
    "two arms": {
        "of two arms": ["decided_by", "arms", "conflict", "between_arms", "between_arms_status"],
        "of a search over pairs": ["bound"],
    },
}


def run(*arguments):
    return subprocess.run(
        [SWIVEL, *map(str, arguments)], capture_output=True, text=True, timeout=120
    )


def one_path():
    job = one_job()
    return {"robot": job["robot"], **job["strokes"][0], "resolution": job["resolution"]}


def problem_of(kind, has_plan):
    """A small problem of a kind; without a plan a plate stands in the way."""
    if kind == "two arms":
        problem, at = cell(), [0.6, 0.25, 1.05]
    else:
        problem, at = (one_job() if kind == "job" else one_path()), [0.5, 0.1, 0.4]
        for key in ("name", "approach", "retract") if kind == "path" else ():
            problem.pop(key, None)
    if not has_plan:
        problem["scene"] = [{"name": "plate", "box": [0.4, 0.02, 0.04], "xyz": at}]
    return problem


def options_of_plan():
    return set(re.findall(r"^  (?:-h,)?(--[a-z-]+)", run("plan", "--help").stdout, re.MULTILINE))


class Twins(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.files = {}
        for kind, has_plan in itertools.product(KINDS, (True, False)):
            file = self.folder / f"{kind} {has_plan}.yaml"
            file.write_text(json.dumps(problem_of(kind, has_plan)))
            self.files[kind, has_plan] = file

    def output(self, option):
        ending = {"--out": "csv", "--report": "html", "--map-svg": "svg"}.get(option, "json")
        file = self.folder / f"output.{ending}"
        file.write_text("of an earlier run\n")
        return file

    def words_of(self, option):
        """The words of a command line with an option, and its output, if it has one."""
        word = WORDS[option]
        file = self.output(option) if word is FILE else None
        words = [option, *([file or word] if word != "" else [])]
        return [*BESIDE.get(option, ()), *words], file

    def test_every_option_is_in_the_table(self):
        self.assertEqual(options_of_plan(), set(WORDS) | ELSEWHERE)

    def test_options_of_kinds_where_there_is_a_plan_and_where_there_is_none(self):
        asked = refused = 0
        for kind, option, has_plan in itertools.product(KINDS, WORDS, (True, False)):
            with self.subTest(kind=kind, option=option, has_plan=has_plan):
                words, file = self.words_of(option)
                done = run("plan", self.files[kind, has_plan], *words)
                if (kind, option) in REFUSED:
                    refused += 1
                    self.assertEqual(done.returncode, 2, done.stdout + done.stderr)
                    self.assertEqual(len(done.stderr.splitlines()), 1)
                    named = "|".join([option, *BESIDE.get(option, ())[:1]])
                    self.assertRegex(done.stderr, rf"({named})\b.*: allowed")
                    continue
                asked += 1
                self.assertEqual(done.returncode, 0 if has_plan else 1, done.stdout + done.stderr)
                if option == "--quiet":
                    self.assertEqual(done.stdout + done.stderr, "")
                if file:
                    self.assert_written(file, WRITTEN[option][0 if has_plan else 1])
        print(f"{asked} commands, {refused} refused")

    def assert_written(self, file, is_written):
        self.assertEqual(file.exists(), is_written)
        if is_written:
            self.assertNotIn("of an earlier run", file.read_text())

    def test_planners_of_kinds(self):
        """All planners find the same cost, or that there is none; eager ones ask more."""
        for kind, has_plan in itertools.product(KINDS, (True, False)):
            told = {}
            for planner in ("eager", "eager_dp", "lazy", "parallel"):
                file = self.folder / "result.json"
                done = run(
                    "plan", self.files[kind, has_plan], "--planner", planner, "--json", file,
                    "--quiet"
                )
                self.assertEqual(done.returncode, 0 if has_plan else 1, (kind, planner))
                told[planner] = json.loads(file.read_text())
                self.assertEqual(told[planner]["planner"], planner)
            self.assertEqual(len({one["cost"] for one in told.values()}), 1, kind)
            checked = {
                planner: sum(
                    arm["counters"]["nodes_checked"]
                    for arm in (one["arms"] if kind == "two arms" else [one])
                )
                for planner, one in told.items()
            }
            self.assertEqual(checked["eager"], checked["eager_dp"], kind)
            self.assertGreater(checked["eager"], checked["lazy"], kind)

    def test_refinements_of_kinds(self):
        """Refined rows cost less; with a chord the tool keeps nearer to its path."""
        file = self.folder / "result.json"
        for kind in KINDS:
            costs = []
            for options in ((), ("--refine",), ("--refine", "--speed", "0.05")):
                done = run("plan", self.files[kind, True], "--json", file, *options)
                self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
                told = json.loads(file.read_text())
                costs.append(told["cost"])
                self.assertEqual(told["refinement"] is not None, "--refine" in options)
                if "--refine" in options:
                    self.assertLess(told["refinement"]["cost"], told["refinement"]["cost_before"])
                    self.assertRegex(done.stdout, "refined: cost .* before, .* now")
            self.assertLess(costs[1], costs[0], kind)
            rows, motion = self.folder / "rows.csv", self.folder / "motion.csv"
            run("plan", self.files[kind, True], "--speed", "0.05", "--out", rows)
            command = ("time", self.files[kind, True], rows, "--speed", "0.05", "--rate", "20")
            done = run(*command, "--refine", "--chord", "0.000001", "--out", motion)
            self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
            self.assertRegex(done.stdout, "refined: cost")
            slow = motion.read_text().count("\n")
            run(*command, "--out", motion)
            self.assertLess(motion.read_text().count("\n"), slow, kind)

    def test_maps_and_traces_of_kinds(self):
        """Each run has a map below its name, in text and SVG; the trace has the stages."""
        names = {
            "path": [],
            "job": ["stroke 'left'", "stroke 'right'"],
            "two arms": ["arm 'left'", "arm 'right'"]
        }
        stages = {"path": "plan", "job": "plan job", "two arms": "plan workcell"}
        trace, drawing = self.folder / "trace.json", self.folder / "map.svg"
        for kind, has_plan in itertools.product(KINDS, (True, False)):
            with self.subTest(kind=kind, has_plan=has_plan):
                command = ("plan", self.files[kind, has_plan], "--map", "--map-svg", drawing)
                done = run(*command, "--trace", trace)
                self.assertEqual(done.returncode, 0 if has_plan else 1, done.stderr)
                headings = [line for line in done.stdout.splitlines() if line in names[kind]]
                self.assertEqual(headings, names[kind])
                root = xml.etree.ElementTree.parse(drawing).getroot()
                texts = [text.text for text in root.iter("{http://www.w3.org/2000/svg}text")]
                self.assertEqual([text for text in texts if text in names[kind]], names[kind])
                paths = sum(text.startswith("the path; ") for text in texts)
                if has_plan:
                    self.assertEqual(paths, max(1, len(names[kind])), texts)
                spans = {event["name"] for event in json.loads(trace.read_text())["traceEvents"]}
                self.assertIn(stages[kind], spans)
                full = run(*command, "--full-map")
                self.assertNotIn("not looked at", full.stdout)
                if has_plan:
                    without_times = [
                        "".join(line for line in one.stdout.splitlines(True) if " ms" not in line)
                        for one in (full, done)
                    ]
                    self.assertNotEqual(*without_times)

    def test_outputs_of_kinds_that_time_or_a_signal_ends(self):
        ends = {"time-out": ("--timeout", "0.3"), "Ctrl-C": ()}
        slow = ("--ds", "0.00002", "--dphi", "0.002", "--knot", "0")  # takes many seconds
        for kind, option, (end, words) in itertools.product(KINDS, WRITTEN, ends.items()):
            if (kind, option) in REFUSED or option == "--trace":
                continue
            with self.subTest(kind=kind, option=option, end=end):
                own, file = self.words_of(option)
                command = [SWIVEL, "plan", self.files[kind, True], *slow, *own, *words]
                with subprocess.Popen([*map(str, command)], stdout=subprocess.PIPE,
                                      stderr=subprocess.STDOUT, text=True) as process:
                    if end == "Ctrl-C":
                        time.sleep(0.3)
                        process.send_signal(signal.SIGINT)
                    said = process.communicate(timeout=60)[0]
                self.assertEqual(process.returncode, 3, said)
                self.assert_written(file, WRITTEN[option][2])
                if option == "--json":
                    result = json.loads(file.read_text())
                    self.assertEqual(
                        (result["status"], result["checked"], result["cost"]),
                        ("timeout" if words else "cancelled", None, None)
                    )

    def test_keys_of_results(self):
        """A key that every kind could have, and one lacks, is a promise that was forgotten."""
        kinds = json.loads(run("schema", "result").stdout)["anyOf"][:3]
        keys = {kind: set(one["properties"]) for kind, one in zip(KINDS, kinds)}
        common = set.intersection(*keys.values())
        for kind in KINDS:
            listed = set(itertools.chain(*KEYS_OF_SOME[kind].values()))
            with self.subTest(kind=kind):
                self.assertEqual(keys[kind] - common, listed)

    def test_what_every_answer_says(self):
        for kind, has_plan in itertools.product(KINDS, (True, False)):
            with self.subTest(kind=kind, has_plan=has_plan):
                file = self.output("--json")
                run("plan", self.files[kind, has_plan], "--json", file)
                result = json.loads(file.read_text())
                self.assertEqual(result["status"], "solved" if has_plan else "infeasible")
                self.assertEqual(result["checked"], True if has_plan else None)
                self.assertEqual(result["cost"] is not None, has_plan)
                arms = result.get("arms", [result])
                for arm in arms:
                    self.assertEqual(set(arm["robot_pairs"]), {"dropped", "reduced"})
                    self.assertEqual(len(arm["joint_names"]), 7)
                for stage in ("load", "check") if has_plan else ("load", ):
                    self.assertGreater(result["time_ms"].get(stage, 0), 0, stage)


if __name__ == "__main__":
    unittest.main()

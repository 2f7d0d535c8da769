#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Jobs from outside: what `plan`, `check` and `time` say and write of them, and who refuses
them."""
import copy
import csv
import json
import os
import pathlib
import re
import subprocess
import tempfile
import unittest

from motion_test import Mcap
from pages import data_of

SWIVEL = os.environ["SWIVEL"]
DATA = pathlib.Path(os.environ["SWIVEL_DATA"])
JOB = DATA / "problems" / "door_job.yaml"


def run(*arguments):
    return subprocess.run(
        [SWIVEL, *map(str, arguments)], capture_output=True, text=True, timeout=300
    )


def one_job(**changes):
    """Two strokes of an iiwa 14 in free space, the first with lines before and after it."""
    def stroke(name, y, **more):
        corners = [[0.5, y - 0.05, 0.4], [0.5, y + 0.05, 0.4]]
        down = [0, 3.14159265358979, 0]
        return {
            "name": name, "path": {"waypoints": [{"xyz": at, "rpy": down} for at in corners]},
            **more
        }

    return {
        "robot": {
            "urdf": str(DATA / "robots" / "iiwa14.urdf"), "base_link": "base_link",
            "tip_link": "tool0"
        },
        "home": {"joints": [0, 0.5, 0, -1.4, 0, 1.2, 0]},
        "strokes": [stroke("left", 0.1, approach=0.05, retract=0.04), stroke("right", -0.1)],
        "resolution": {"ds": 0.02, "dphi": 0.2},
        **changes,
    }


class WithFolder(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def file(self, job):
        file = self.folder / "job.yaml"
        file.write_text(json.dumps(job))
        return file


class Jobs(WithFolder):
    def plan(self, job, *options):
        out, result = self.folder / "t.csv", self.folder / "r.json"
        done = run("plan", self.file(job), "--out", out, "--json", result, *options)
        return done, out, json.loads(result.read_text()) if result.exists() else None

    def test_answer_rows_and_result(self):
        done, out, result = self.plan(one_job())
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        lines = done.stdout.splitlines()
        self.assertRegex(lines[0], r"^solved: 2 strokes, cost [0-9.]+: none costs less")
        self.assertRegex(lines[1], r"^  stroke +layers +cost +least +clearance mm +tool off mm$")
        self.assertRegex(lines[2], r"^  left +[0-9]+ +[0-9.]+ +[0-9.]+ +")
        self.assertRegex(lines[3], r"^  right +[0-9]+ +[0-9.]+ +[0-9.]+ +")
        self.assertEqual(len({len(line) for line in lines[1:4]}), 1)
        self.assertRegex(lines[4], r"^  3 transitions, [0-3] of them straight, cost ")
        self.assertRegex(
            lines[-1], r"^parallel, [0-9]+ threads?: load [0-9.]+ ms, lattice [0-9.]+ ms, "
            r"find [0-9.]+ ms, report [0-9.]+ ms, check [0-9.]+ ms; [0-9]+ nodes "
        )
        self.assertEqual(result["status"], "solved")
        self.assertEqual([one["stroke"] for one in result["order"]], ["left", "right"])
        self.assertAlmostEqual(result["gap"], result["lattice_cost"] / result["bound"] - 1)
        self.assertLessEqual(result["bound_any"], result["bound"] * (1 + 1e-12))
        self.assertTrue(result["checked"])
        self.assertAlmostEqual(sum(part["cost"] for part in result["parts"]), result["cost"])
        self.assertEqual(
            [(one["from"], one["to"]) for one in result["transitions"]],
            [(None, "left"), ("left", "right"), ("right", None)]
        )
        with open(out) as file:
            rows = list(csv.DictReader(file))
        written = [
            (part["stroke"] or "", row) for part in result["parts"] for row in part["rows"]
        ]
        self.assertEqual(len(rows), len(written))
        for row, (stroke, told) in zip(rows, written):
            self.assertEqual(row["stroke"], stroke)
            self.assertEqual(row["process"], str(int(told["process"])))
            self.assertEqual(
                [float(row[joint]) for joint in result["joint_names"]], told["joints"]
            )
            self.assertEqual(row["s"] == "", stroke == "")
        # From home and back, without a jump from part to part.
        for end in (0, -1):
            self.assertEqual(written[end][1]["joints"], one_job()["home"]["joints"])
        for before, after in zip(result["parts"], result["parts"][1:]):
            for a, b in zip(before["rows"][-1]["joints"], after["rows"][0]["joints"]):
                self.assertAlmostEqual(a, b)
        # The lines before and after the first stroke are none of it.
        left = [row for row in rows if row["stroke"] == "left"]
        on = [float(row["s"]) for row in left if row["process"] == "1"]
        self.assertAlmostEqual(on[0], 0.05)
        self.assertAlmostEqual(on[-1], 0.15)
        self.assertAlmostEqual(float(left[-1]["s"]), 0.19)
        self.assertEqual({row["process"] for row in rows if row["stroke"] == "right"}, {"1"})

    def test_quiet_and_standard_output(self):
        done = run("plan", self.file(one_job()), "--quiet")
        self.assertEqual((done.returncode, done.stdout, done.stderr), (0, "", ""))
        done = run("plan", self.file(one_job()), "--json", "-")
        self.assertEqual(json.loads(done.stdout)["status"], "solved")

    def test_a_stroke_without_a_path(self):
        job = one_job()
        for waypoint in job["strokes"][1]["path"]["waypoints"]:
            waypoint["xyz"][0] = 3
        (self.folder / "t.csv").write_text("earlier")
        done, out, result = self.plan(job)
        self.assertEqual(done.returncode, 1, done.stdout + done.stderr)
        self.assertTrue(
            done.stdout.startswith("no job: 1 of 2 strokes has no path by itself\n"), done.stdout
        )
        self.assertIn("  stroke 'right': no path ", done.stdout)
        self.assertFalse(out.exists())
        self.assertIn("there is no job now", done.stderr)
        self.assertEqual(result["status"], "infeasible")
        self.assertEqual(
            [run["diagnosis"] is not None for run in result["runs"]], [False, True]
        )

    def test_advice_and_certificate(self):
        job = one_job()
        for waypoint in job["strokes"][1]["path"]["waypoints"]:
            waypoint["xyz"][0] = 3
        proof = self.folder / "proof.json"
        done, _, result = self.plan(job, "--advise", 5, "--certificate", proof)
        self.assertEqual(done.returncode, 1, done.stdout + done.stderr)
        self.assertIn("\n  would help: stroke 'right' left out (solved, cost ", done.stdout)
        self.assertRegex(done.stdout, r"\n  stroke 'right': certificate")
        without = result["advice"]["job"][0]
        self.assertEqual((without["change"], without["outcome"]), ("without_strokes", "solved"))
        self.assertEqual(without["strokes"], ["right"])
        left = dict(one_job())
        left["strokes"] = left["strokes"][:1]
        self.assertEqual(self.plan(left)[2]["cost"], without["cost"])
        self.assertEqual([one["stroke"] for one in result["advice"]["strokes"]], ["right"])
        self.assertEqual(json.loads(proof.read_text())["stroke"], "right")
        file = self.file(job)
        done = run("check", file, "--certificate", proof)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertTrue(done.stdout.startswith("stroke 'right': passed: no path"), done.stdout)
        # What cannot be verified leaves no half of a line.
        done = run("check", file, "--certificate", proof, "--ds", 0.01)
        self.assertEqual((done.returncode, done.stdout), (2, ""))
        self.assertRegex(done.stderr, r"^swivel: .*allowed.*\n$")
        proof.write_text(proof.read_text().replace('"right"', '"left"'))
        done = run("check", file, "--certificate", proof)
        self.assertIn(done.returncode, (1, 2), done.stdout)
        proof.write_text(proof.read_text().replace('"left"', '"middle"'))
        for arguments, needle in (
            ((file,), "stroke: 'middle' is none of the job"),
            ((DATA / "problems/experiment_a.yaml",), "stroke: is of stroke 'middle' of a job"),
        ):
            done = run("check", *arguments, "--certificate", proof)
            self.assertEqual((done.returncode, done.stdout), (2, ""))
            self.assertIn(needle, done.stderr)
        # of a stroke that may run either way, a proof of one direction is none
        proof.write_text(proof.read_text().replace('"middle"', '"right"'))
        job["strokes"][1]["reversible"] = True
        done = run("check", self.file(job), "--certificate", proof)
        self.assertEqual((done.returncode, done.stdout), (2, ""))
        self.assertIn("'right' is reversible, and a certificate is of one direction", done.stderr)
        done, _, result = self.plan(job, "--certificate", proof)
        self.assertEqual(done.returncode, 1, done.stdout + done.stderr)
        self.assertIn("\n  stroke 'right', which has no path backwards either: ", done.stdout)
        self.assertRegex(" ".join(result["warnings"]), "'right' is reversible, and a certificate")
        self.assertFalse(proof.exists())
        done = run("plan", file, "--certificate", proof, "--speed", 0.1)
        self.assertEqual(done.returncode, 2)
        self.assertIn("--certificate: is of the job as its file has it", done.stderr)

    def test_strokes_that_one_body_bars_are_told_together(self):
        job = one_job()
        job["strokes"].append(copy.deepcopy(job["strokes"][1]))
        job["strokes"][2]["name"] = "again"
        job["scene"] = [{"name": "plate", "box": [0.4, 0.6, 0.02], "xyz": [0.5, 0, 0.4]}]
        done, _, result = self.plan(job, "--advise", 30)
        self.assertEqual(done.returncode, 1, done.stdout + done.stderr)
        self.assertEqual(len(result["advice"]["strokes"]), 3)  # each of its own
        lines = done.stdout.splitlines()
        self.assertEqual(lines[0], "no job: 3 of 3 strokes have no path by themselves")
        self.assertEqual(sum(line.startswith("  stroke '") for line in lines), 1, done.stdout)
        told = [line for line in lines if line.startswith("  likewise ")]
        self.assertEqual(len(told), 1, done.stdout)
        self.assertRegex(told[0], r"^  likewise '\w+' \(.*\), '\w+' \(.*\)$")
        self.assertIn("  for strokes by themselves:", lines)
        self.assertIn("  would help: no 'plate'", lines)
        self.assertEqual(sum("no 'plate'" in line for line in lines), 1, done.stdout)

    def test_advice_ends_with_the_time_out(self):
        """Six strokes on a door out of reach, on fine lattices: what would help takes seconds."""
        door = self.folder / "door.yaml"
        text = JOB.read_text().replace("../", f"{DATA}/")
        door.write_text(text.replace("xyz: [0.76, 0.27, 0.90]", "xyz: [1.02, 0.27, 0.90]"))
        result = self.folder / "r.json"
        options = ("--ds", 0.001, "--dphi", 0.02, "--advise", 60, "--timeout", 1)
        done = run("plan", door, *options, "--json", result)
        self.assertEqual(done.returncode, 1, done.stderr)
        advice = json.loads(result.read_text())["advice"]
        outcomes = [one["outcome"] for stroke in advice["strokes"] for one in stroke["advice"]]
        self.assertIn("unknown", outcomes)
        self.assertIn("not tried in the time", done.stdout)

    def test_an_earlier_certificate_goes_where_there_is_a_job(self):
        proof = self.folder / "proof.json"
        proof.write_text("earlier")
        done, out, _ = self.plan(one_job(), "--certificate", proof)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertIn("there is a job now", done.stderr)
        self.assertFalse(proof.exists())
        self.assertTrue(out.exists())
        proof.write_text("earlier")
        done, _, _ = self.plan(one_job(), "--certificate", proof, "--timeout", 1e-9)
        self.assertEqual(done.returncode, 3, done.stdout + done.stderr)
        self.assertIn("the search was stopped", done.stderr)
        self.assertFalse(proof.exists())

    def test_a_certificate_is_that_of_the_stroke_by_itself(self):
        ball = {"name": "ball", "sphere": {"radius": 0.02}, "xyz": [0.5, -0.1, 0.4]}
        job = one_job(scene=[ball])
        of_job, by_itself = self.folder / "of_job.json", self.folder / "by_itself.json"
        done, _, _ = self.plan(job, "--certificate", of_job)
        self.assertEqual(done.returncode, 1, done.stdout + done.stderr)
        alone = {key: value for key, value in job.items() if key not in ("home", "strokes")}
        alone["path"] = job["strokes"][1]["path"]
        done = run("plan", self.file(alone), "--certificate", by_itself)
        self.assertEqual(done.returncode, 1, done.stdout + done.stderr)
        proof, other = (json.loads(file.read_text()) for file in (of_job, by_itself))
        self.assertEqual((proof.pop("stroke"), proof.pop("reversed")), ("right", False))
        self.assertEqual(proof, other)
        self.assertTrue(other["witnesses"])

    def test_no_certificate_where_home_is_barred(self):
        wall = {"name": "wall", "box": [4, 4, 4], "xyz": [0, 0, 0]}
        proof = self.folder / "proof.json"
        done, _, result = self.plan(one_job(scene=[wall]), "--certificate", proof)
        self.assertEqual(done.returncode, 1, done.stdout + done.stderr)
        self.assertTrue(done.stdout.startswith("no job: at home "), done.stdout)
        warning = "no stroke was planned by itself: there is no certificate"
        self.assertIn(warning, result["warnings"])
        self.assertFalse(proof.exists())

    def test_page(self):
        file, page = self.file(one_job()), self.folder / "page.html"
        done = run("plan", file, "--report", page)
        if "built without reports" in done.stderr:
            self.skipTest(done.stderr)
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        self.assertTrue(done.stdout.startswith("solved: 2 strokes, "), done.stdout)
        strokes = data_of(page)["strokes"]
        self.assertEqual([stroke["name"] for stroke in strokes], ["left", "right"])
        done = run("plan", file, "--report", page, "--timeout", 1e-9)
        self.assertEqual(done.returncode, 3)
        self.assertFalse(page.exists())

    def test_files_of_a_job_without_times(self):
        file = self.file(one_job())
        done = run("plan", file, "--out", "motion.json")
        self.assertEqual(done.returncode, 2)
        self.assertRegex(
            done.stderr, "^swivel: --out: motion.json: a job without times .*--speed or --rate"
        )

    def test_bad_jobs(self):
        for key, value in (("order", "fastest"), ("lift", True), ("rapid", 2)):
            with self.subTest(key):
                done = run("plan", self.file(one_job(**{key: value})))
                self.assertEqual((done.returncode, done.stdout), (2, ""))
                self.assertRegex(done.stderr, rf"^swivel: .*job.yaml:1: {key}: .*allowed.*\n$")


class LiftOffs(WithFolder):
    """A ring that no single run finishes."""

    def ring(self, **changes):
        text = (DATA / "problems" / "iiwa14_ring_job.yaml").read_text()
        text = text.replace("../", f"{DATA}/")
        text = text.replace("ds: 0.005, dphi: 0.05", "ds: 0.01, dphi: 0.1")
        for key, value in changes.items():
            text = re.sub(rf"(?m)^{key}:.*$", f"{key}: {value}" if value else "", text)
        file = self.folder / "ring.yaml"
        file.write_text(text)
        return file

    def test_answer_and_rows(self):
        ring, rows, out = self.ring(), self.folder / "r.csv", self.folder / "r.json"
        answer = run("plan", ring, "--out", rows, "--json", out)
        self.assertEqual(answer.returncode, 0, answer.stderr)
        self.assertRegex(answer.stdout, r"stroke 'ring': 1 lift-off, at s 0\.\d{3} m\n")
        self.assertIn("with the lift-offs at these places", answer.stdout)
        result = json.loads(out.read_text())
        lift, = result["lift_offs"]
        self.assertEqual(lift["stroke"], "ring")
        self.assertLessEqual(lift["resumed_s"], lift["s"] - 0.01 + 1e-9)
        self.assertGreaterEqual(lift["reached_s"], lift["s"])
        self.assertEqual([one["stroke"] for one in result["order"]], ["ring/1", "ring/2"])
        table = list(csv.DictReader(rows.read_text().splitlines()))
        first = [row for row in table if row["stroke"] == "ring/1"]
        second = [row for row in table if row["stroke"] == "ring/2"]
        self.assertEqual(float(first[0]["s"]), 0)
        # one measure of s: the process ends and goes on where the answer says; lines are 50 mm
        on = [[float(row["s"]) for row in run if row["process"] == "1"] for run in (first, second)]
        self.assertAlmostEqual(on[0][0], 0.05, 9)
        self.assertAlmostEqual(on[0][-1], lift["s"], 9)
        self.assertAlmostEqual(on[1][0], lift["resumed_s"], 9)
        self.assertAlmostEqual(float(first[-1]["s"]), lift["s"] + 0.05, 9)
        self.assertIn(f"1 lift-off, at s {lift['s']:.3f} m", answer.stdout)
        checked = run("check", ring, rows)
        self.assertEqual(checked.returncode, 0, checked.stdout + checked.stderr)
        self.assertRegex(checked.stdout, r"^passed: 1 stroke in 2 runs, \d+ rows; ")
        self.assertIn("speeds of the tool were not checked: rows have no times", checked.stdout)
        self.assertAlmostEqual(
            float(re.search(r"cost ([\d.]+)", checked.stdout)[1]), result["cost"], 5
        )
        motion = self.folder / "m.csv"
        timed = run("time", ring, rows, "--speed", "0.05", "--out", motion)
        self.assertEqual(timed.returncode, 0, timed.stdout + timed.stderr)
        self.assertEqual(run("check", ring, motion).returncode, 0)
        # a gap between the runs, less overlap than asked for, another order, no lift-offs allowed
        gap = table[: len(first) - 12] + table[len(first) :]
        self.refused(ring, gap, rows, ["s: is ", "at most"])
        names = {"ring/1": "ring/2", "ring/2": "ring/1"}
        turned = [row | {"stroke": names.get(row["stroke"], "")} for row in table]
        self.refused(ring, turned, rows, ["stroke: is 'ring/2'", "'ring/1'"])
        more = self.ring(lift="{allowed: true, overlap: 0.1}")
        self.refused(more, table, rows, ["data row", "s: is ", "lift.overlap"])
        self.refused(self.ring(lift=""), table, rows, ["'ring/1' is no stroke of the job"])

    def refused(self, ring, table, file, needles):
        with file.open("w") as out:
            writer = csv.DictWriter(out, table[0].keys(), lineterminator="\n")
            writer.writeheader()
            writer.writerows(table)
        answer = run("check", ring, file)
        self.assertEqual(answer.returncode, 2, answer.stdout)
        for needle in needles:
            self.assertIn(needle, answer.stderr)

    def test_one_path(self):
        text = self.ring().read_text()
        path = re.search(r"path: (\{.*\})\}", text)[1]
        of_jobs = "strokes|  - {name: ring|approach|retract|process_speed|rapid"
        text = re.sub(rf"(?m)^({of_jobs}).*\n", "", text)
        file = self.folder / "path.yaml"
        file.write_text(text + f"path: {path}\n")
        answer = run("plan", file)
        self.assertEqual(answer.returncode, 0, answer.stderr)
        self.assertIn("stroke 'path': 1 lift-off", answer.stdout)

    def test_without_them_there_is_no_job(self):
        for lift in ("", "{allowed: false}"):
            answer = run("plan", self.ring(lift=lift))
            self.assertEqual(answer.returncode, 1, answer.stderr)
            self.assertIn("has no path by itself", answer.stdout)

    def test_no_certificate(self):
        answer = run("plan", self.ring(), "--certificate", self.folder / "c.json")
        self.assertEqual(answer.returncode, 2)
        self.assertIn("--certificate: proves that one run", answer.stderr)


class Timed(WithFolder):
    """Motions of jobs in time, of `plan` and `time`."""

    def timed(self, name, *options, job=None, code=0):
        out = self.folder / name
        done = run("plan", self.file(job or one_job(process_speed=0.05)), "--out", out, *options)
        self.assertEqual(done.returncode, code, done.stdout + done.stderr)
        return done, out

    @staticmethod
    def table(file):
        with open(file) as lines:
            return list(csv.DictReader(lines))

    def events(self, rows):
        """Returns the events that the rows of a motion tell: t, stroke, s, process."""
        found = []
        for k, (before, row) in enumerate(zip([{"process": "0"}, *rows], rows)):
            if row["process"] == before["process"]:
                continue
            stroke = row["stroke"] or rows[k + 1]["stroke"]
            found.append(
                (float(row["t"]), stroke, float(row["s"]), "on" if row["process"] == "1" else "off")
            )
        return found

    def test_every_format(self):
        result = self.folder / "r.json"
        done, file = self.timed("m.csv", "--rate", 100, "--json", result)
        lines = done.stdout.splitlines()
        motion = [line for line in lines if line.startswith("motion: ")]
        self.assertEqual(len(motion), 1, done.stdout)
        rows = self.table(file)
        self.assertRegex(
            motion[0], r"^motion: [0-9.]+ s, [0-9.]+ s of it on strokes at (up to )?[0-9.]+ mm/s "
            rf"and [0-9.]+ s in transitions, {len(rows)} samples at 100 Hz, 4 events$"
        )
        self.assertRegex(lines[-1], r", time [0-9.]+ ms, check motion [0-9.]+ ms; ")
        self.assertEqual([float(row["t"]) for row in rows], [k / 100 for k in range(len(rows))])
        events = self.events(rows)
        self.assertEqual(
            [(stroke, process) for _, stroke, _, process in events],
            [("left", "on"), ("left", "off"), ("right", "on"), ("right", "off")]
        )
        # left has an approach of 0.05 m and is 0.1 m long, right has neither approach nor retract
        for (_, _, s, _), place in zip(events, (0.05, 0.15, 0, 0.1)):
            self.assertGreaterEqual(s, place - 1e-6)
            self.assertLess(s, place + 0.05 / 100 + 1e-6)
        # the tool is as fast on the stroke as the file says
        on = [row for row in rows if row["process"] == "1" and row["stroke"] == "right"]
        middle = len(on) // 2
        step = float(on[middle + 1]["s"]) - float(on[middle]["s"])
        self.assertAlmostEqual(step * 100, 0.05, delta=1e-4)
        begins = [row for row in rows if row["stroke"] == "" and row["s"] != ""]
        self.assertEqual([float(row["s"]) for row in begins], [0, 0])
        done = run("check", self.folder / "job.yaml", file)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertTrue(done.stdout.startswith(f"passed: 2 strokes, {len(rows)} rows; "))

        message = json.loads(self.timed("m.json", "--rate", 100)[1].read_text())
        self.assertEqual(
            [(one["t"], one["stroke"], one["s"], one["process"]) for one in message["events"]],
            events
        )
        self.assertEqual(len(message["points"]), len(rows))
        for k, stroke in enumerate(("left", "right")):
            first, second = (event.pop("run") for event in message["events"][2 * k:2 * k + 2])
            self.assertEqual(first, second)
            own = [number for number, row in enumerate(rows) if row["stroke"] == stroke]
            ends = [rows[own[0] - 1], rows[own[-1]]]  # a run begins where a transition ends
            self.assertEqual(first, {key: [float(row[key]) for row in ends] for key in ("t", "s")})
        told = json.loads(result.read_text())["motion"]
        self.assertEqual(
            (told["executable"], told["samples"], told["duration"]),
            (True, len(rows), float(rows[-1]["t"]))
        )
        self.assertEqual(told["events"], message["events"])
        yaml = self.timed("m.yaml", "--rate", 100)[1].read_text()
        told = [json.loads(line[2:]) for line in yaml[yaml.index("events:") :].splitlines()[1:]]
        for one in told:
            del one["run"]
        self.assertEqual(told, message["events"])

        log = Mcap(self.timed("m.mcap", "--rate", 100)[1].read_bytes())
        self.assertEqual(log.profile, "")  # ros2 has CDR alone
        topics = {topic: (number, *of) for number, (*of, topic, _) in log.channels.items()}
        self.assertEqual(set(topics), {"/joint_states", "/process"})
        number, schema = topics["/process"]
        self.assertEqual(log.channels[number][2], "json")
        self.assertEqual(log.schemas[schema][1], "jsonschema")
        self.assertEqual(json.loads(log.schemas[schema][2])["type"], "object")
        of_process = [one for one in log.messages if one[0] == number]
        told = [json.loads(one[4]) for one in of_process]
        for one in told:
            del one["run"]
        self.assertEqual(told, message["events"])
        self.assertEqual(len(log.messages), len(rows) + 4)
        self.assertEqual(log.statistics[:3], (len(rows) + 4, 2, 2))
        times = [one[2] for one in log.messages]
        self.assertEqual(times, sorted(times))
        for one, event in zip(of_process, events):
            self.assertAlmostEqual(one[2] * 1e-9, event[0], delta=1e-9)
        for channel in (0, 1):
            self.assertEqual(
                log.indexes[channel], [(one[2], one[5] - log.chunk[2]) for one in log.messages
                                       if one[0] == channel]
            )

    def test_speeds(self):
        fast = float(self.table(self.timed("m.csv", "--speed", 0.2)[1])[-1]["t"])
        slow = float(self.table(self.timed("m.csv", "--turn-speed", 1)[1])[-1]["t"])
        self.assertLess(fast + 2, slow)
        (self.folder / "m.csv").write_text("earlier")
        done, out = self.timed("m.csv", "--rate", 100, job=one_job(), code=2)
        self.assertRegex(done.stderr, "^swivel: .*: stroke 'left' has no speed: allowed are .*\n$")
        self.assertEqual(out.read_text(), "earlier")
        done, out = self.timed("m.csv", "--speed", 0.1, "--timeout", 1e-9, code=3)
        self.assertIn("the search was stopped", done.stderr)
        self.assertFalse(out.exists())
        for options, needle in (
            (("--rate", 0), "--rate: 0: allowed are numbers > 0"),
            (("--speed", -1), "--speed: -1: allowed are finite numbers above 0"),
            (("--rate", 100, "--out", "m.bag"), "--out: m.bag: unknown format"),
        ):
            done = run("plan", self.folder / "job.yaml", *options)
            self.assertEqual((done.returncode, done.stdout), (2, ""))
            self.assertTrue(done.stderr.startswith("swivel: " + needle), done.stderr)

    def test_check_holds_the_speeds_of_the_file(self):
        motion, job = self.timed("m.csv", "--speed", 0.1)[1], self.folder / "job.yaml"
        done = run("check", job, motion)
        self.assertEqual(done.returncode, 1, done.stdout + done.stderr)
        self.assertRegex(
            done.stdout, r"stroke 'left': rows \d+-\d+: the tool moves at 0\.\d+ m/s at s = [\d.]+ "
            r"m: allowed is 0\.05, the speed asked for there"
        )
        self.assertEqual(run("check", job, motion, "--speed", 0.1).returncode, 0)
        rows = self.timed("t.csv")[1]
        done = run("check", job, rows)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertIn("speeds of the tool were not checked: rows have no times\n", done.stdout)
        path = DATA / "problems" / "experiment_a.yaml"
        for arguments, needle in (
            ((job, motion, "--speed", 0), "--speed: 0: allowed are finite numbers above 0"),
            ((job, rows, "--speed", 0.1), "has no times: allowed with --speed are motions of jobs"),
            ((path, rows, "--speed", 0.1), "--speed: is of a motion of a job"),
            ((job, "--certificate", rows, "--speed", 0.1), "--speed: is of motions"),
        ):
            done = run("check", *arguments)
            self.assertEqual((done.returncode, done.stdout), (2, ""))
            self.assertIn(needle, done.stderr)

    def test_time_of_a_trajectory(self):
        done, out = self.timed("t.csv")
        job, motion = self.folder / "job.yaml", self.folder / "m.csv"
        done = run("time", job, out, "--rate", 100, "--out", motion)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertRegex(done.stdout, r"^motion: .* at 100 Hz, 4 events\n$")
        self.assertEqual(run("check", job, motion).returncode, 0)
        rows = self.table(out)
        joint = list(rows[0])[5]
        rows[5][joint] = str(float(rows[5][joint]) + 0.01)
        with open(self.folder / "bad.csv", "w", newline="") as file:
            writer = csv.DictWriter(file, list(rows[0]))
            writer.writeheader()
            writer.writerows(rows)
        done = run("time", job, self.folder / "bad.csv", "--out", motion)
        self.assertEqual((done.returncode, done.stdout), (2, ""))
        self.assertRegex(
            done.stderr, r"bad.csv: .*: allowed is a job that passes `swivel check`\n$"
        )

    def test_refined_rows(self):
        """`--refine` writes rows that cost less and pass the check, and says so for each stroke."""
        job, out, result = self.file(one_job()), self.folder / "t.csv", self.folder / "r.json"
        done = run("plan", job, "--out", out, "--json", result)
        self.assertEqual(done.returncode, 0, done.stderr)
        before = json.loads(result.read_text())
        self.assertIsNone(before["refinement"])
        done = run("plan", job, "--refine", "--out", out, "--json", result)
        self.assertEqual(done.returncode, 0, done.stderr)
        told = json.loads(result.read_text())
        refined = told["refinement"]
        self.assertEqual([run["stroke"] for run in refined["runs"]], ["left", "right"])
        for run_, one in zip(refined["runs"], told["runs"], strict=True):
            self.assertTrue(run_["refined"])
            self.assertLess(run_["cost"], run_["cost_before"])
            self.assertAlmostEqual(run_["cost"], one["cost"])
        self.assertAlmostEqual(
            before["cost"] - told["cost"], refined["cost_before"] - refined["cost"], 6
        )
        self.assertEqual(before["transitions"], told["transitions"])
        self.assertAlmostEqual(told["lattice_cost"], before["lattice_cost"], 9)
        self.assertRegex(
            done.stdout, "\nrefined: cost .* before, .* now, without transitions\n"
            "  stroke 'left': joints bend by at most .*\n  stroke 'right': joints bend"
        )
        checked = run("check", job, out)
        self.assertEqual(checked.returncode, 0, checked.stdout)
        done = run("plan", job, "--refine", "--timeout", "1e-9", "--json", result)
        self.assertEqual(done.returncode, 3)
        self.assertIsNone(json.loads(result.read_text())["refinement"])

    def test_what_cannot_be_executed(self):
        # With rows as dense as those of transitions there is no clearance to spare between them.
        episode, out = ("--seed", 1, "--episode", 3), self.folder / "t.csv"
        self.assertEqual(run("plan", JOB, *episode, "--out", out).returncode, 0)
        motion = self.folder / "m.csv"
        motion.write_text("from before")
        done = run("time", JOB, out, *episode, "--out", motion)
        self.assertEqual(done.returncode, 1, done.stderr)
        self.assertRegex(
            done.stdout, r"^not executable: transition .+: rows [0-9]+-[0-9]+: 'polisher' and "
            r"'door' come closer than 5.000 mm\n$"
        )
        self.assertIn("there is no motion now", done.stderr)
        self.assertFalse(motion.exists())
        done = run("plan", JOB, *episode, "--rate", 50, "--out", motion)
        self.assertEqual(done.returncode, 0, done.stdout)
        self.assertTrue(motion.exists())


class SpoiltJobs(unittest.TestCase):
    """`check` passes what was planned of the door and refuses what was spoilt."""

    @classmethod
    def setUpClass(cls):
        holder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(holder.cleanup)
        cls.folder = pathlib.Path(holder.name)
        cls.job = cls.folder / "job.yaml"
        cls.job.write_text(
            "approach: 0.02\nretract: 0.03\n" + JOB.read_text().replace("../", f"{DATA}/")
        )
        cls.files = {}
        for name, options in (("plain", ()), ("timed", ("--rate", 25))):
            out = cls.folder / f"{name}.csv"
            done = run("plan", cls.job, "--out", out, *options)
            assert done.returncode == 0, done.stdout + done.stderr
            with open(out) as lines:
                cls.files[name] = list(csv.DictReader(lines))

    def checked(self, rows):
        file = self.folder / "spoilt.csv"
        with open(file, "w", newline="") as lines:
            writer = csv.DictWriter(lines, list(rows[0]))
            writer.writeheader()
            writer.writerows(rows)
        return run("check", self.job, file)

    def spoilt(self, name, ways):
        done = self.checked(self.files[name])
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertTrue(done.stdout.startswith("passed: 6 strokes, "))
        for what, way, code, needle in ways:
            with self.subTest(what):
                rows = [dict(row) for row in self.files[name]]
                rows = way(rows) or rows
                done = self.checked(rows)
                self.assertEqual(done.returncode, code, done.stdout + done.stderr)
                if code == 1:
                    self.assertTrue(done.stdout.startswith("failed: "), done.stdout)
                    self.assertIn(needle, done.stdout)
                else:
                    self.assertEqual(done.stdout, "")
                    self.assertRegex(done.stderr, r"^swivel: .*spoilt.csv.*: allowed .*\n$")
                    self.assertIn(needle, done.stderr)

    @staticmethod
    def rows_of(rows, stroke):
        return [k for k, row in enumerate(rows) if row["stroke"] == stroke]

    def test_trajectory(self):
        of, joint = self.rows_of, "arm_left_joint_3_e"

        def put(stroke, at, column, text):
            def way(rows):
                rows[of(rows, stroke)[at]][column] = text

            return way

        def move(k, by):
            def way(rows):
                row = rows[k(rows)]
                row[joint] = repr(float(row[joint]) + by)

            return way

        def rename(names):
            def way(rows):
                for row in rows:
                    row["stroke"] = names.get(row["stroke"], row["stroke"])

            return way

        def without(which):
            return lambda rows: [row for k, row in enumerate(rows) if not which(rows, k)]

        def between(rows, k):  # row_0 and row_1
            return of(rows, "row_0")[-1] < k < of(rows, "row_1")[0]

        def swap_blocks(rows):
            one, two = of(rows, "row_2"), of(rows, "row_3")
            return (
                rows[: one[0]] + rows[two[0] : two[-1] + 1] + rows[one[-1] + 1 : two[0]] +
                rows[one[0] : one[-1] + 1] + rows[two[-1] + 1 :]
            )

        def backwards(rows):
            one = of(rows, "row_4")
            places = [rows[k]["s"] for k in one]
            rows[one[0] : one[-1] + 1] = rows[one[0] : one[-1] + 1][::-1]
            for k, s in zip(one, places):
                rows[k]["s"] = s

        self.spoilt("plain", [
            ("process on the approach", put("row_1", -1, "process", "1"), 2, "1 again"),
            ("process late", lambda rows: self.first_on(rows, "row_1", "0"), 1, "process is 0"),
            ("process in a transition", put("", 0, "process", "1"), 2, "in a transition"),
            ("unknown stroke", rename({"row_1": "row_9"}), 2, "'row_9' is no stroke"),
            ("names swapped", rename({"row_1": "row_2", "row_2": "row_1"}), 1, "stroke 'row_"),
            ("rows swapped", swap_blocks, 1, "the given order"),
            ("no transition", without(between), 1, "parts: allowed are"),
            ("half a transition", without(lambda rows, k: k == of(rows, "")[0]), 2, "one row"),
            ("no stroke", without(lambda rows, k: rows[k]["stroke"] == "row_5"), 1, "'row_5'"),
            ("a joint", move(lambda rows: of(rows, "row_3")[40], 0.01), 1, "'row_3': row 40"),
            ("home", move(lambda rows: 0, 0.01), 1, "away from home"),
            ("a way's end", move(lambda rows: of(rows, "row_3")[0] - 1, 1e-6), 1, "no jump"),
            ("s", put("row_2", 30, "s", "0.2"), 1, "stroke 'row_2'"),
            ("retract cut", without(lambda rows, k: k in of(rows, "row_5")[-2:]), 1, "'row_5'"),
            ("backwards", backwards, 1, "'row_4' is run backwards"),
        ])

    def first_on(self, rows, stroke, process):
        on = [k for k in self.rows_of(rows, stroke) if rows[k]["process"] == "1"]
        rows[on[0]]["process"] = process

    def test_motion(self):
        of, joint = self.rows_of, "arm_left_joint_3_e"

        def row_of(rows, stroke, at):
            return rows[of(rows, stroke)[at]]

        def last_on(rows):
            on = [k for k in of(rows, "row_1") if rows[k]["process"] == "1"]
            rows[on[-1]]["process"] = "0"

        def early(rows):
            on = [k for k in of(rows, "row_1") if rows[k]["process"] == "1"]
            rows[on[0] - 1]["process"] = "1"

        def again(rows):
            row_of(rows, "row_1", -1)["process"] = "1"

        def in_transition(rows):
            rows[1]["process"] = "1"

        def rename(names):
            def way(rows):
                for row in rows:
                    row["stroke"] = names.get(row["stroke"], row["stroke"])

            return way

        def without(which):
            def way(rows):
                kept = [row for k, row in enumerate(rows) if not which(rows, k)]
                for k, row in enumerate(kept):
                    row["t"] = repr(k / 25)
                return kept

            return way

        def between(rows, k):  # row_0 and row_1
            return of(rows, "row_0")[-1] < k < of(rows, "row_1")[0]

        def no_last_stroke(rows):
            first = of(rows, "row_5")[0]
            rows[first - 1].update(s="", phi="", branch="", process="0")
            return rows[:first]

        def add(k, column, by):
            def way(rows):
                row = rows[k(rows)]
                row[column] = repr(float(row[column]) + by)

            return way

        def faster(rows):
            for row in rows:
                row["t"] = repr(0.8 * float(row["t"]))

        def middle(rows):  # of the way between row_0 and row_1
            return (of(rows, "row_0")[-1] + of(rows, "row_1")[0]) // 2

        self.spoilt("timed", [
            ("process ends early", last_on, 1, "process off of stroke 'row_1'"),
            ("process late", lambda rows: self.first_on(rows, "row_1", "0"), 1, "process on"),
            ("process early", early, 1, "process on of stroke 'row_1'"),
            ("process again", again, 2, "1 again"),
            ("process in a transition", in_transition, 2, "in a transition"),
            ("unknown stroke", rename({"row_1": "row_9"}), 2, "'row_9' is no stroke"),
            ("names swapped", rename({"row_1": "row_2", "row_2": "row_1"}), 1, "stroke 'row_"),
            ("no transition", without(between), 2, "follows 'row_0' at once"),
            ("a row of a transition", without(lambda rows, k: k == middle(rows)), 1, "'row_1'"),
            ("no last stroke", no_last_stroke, 1, "'row_5' is run 0 times"),
            ("not home", without(lambda rows, k: k > of(rows, "row_5")[-1]), 2, "has a home"),
            ("a joint", add(lambda rows: of(rows, "row_3")[40], joint, 0.01), 1, "'row_3'"),
            ("joint on a way", add(middle, joint, 0.01), 1, "transition to 'row_1'"),
            ("home", add(lambda rows: 0, joint, 0.01), 1, "away from home"),
            ("a speed", add(lambda rows: of(rows, "row_3")[40], joint + "_v", 0.5), 1, "'row_3'"),
            ("s", add(lambda rows: of(rows, "row_2")[30], "s", 1e-4), 1, "stroke 'row_2'"),
            ("faster", faster, 1, "failures"),
            ("retract cut", without(lambda rows, k: k in of(rows, "row_5")[-4:]), 1, "'row_5'"),
        ])

    def test_words(self):
        for arguments, needle in (
            ((), "trajectory: is missing"),
            ((self.folder / "plain.csv", "--certificate", "c.json"), "allowed is one of the two"),
            (("--certificate", self.folder / "missing.json"), "missing.json"),
            ((self.folder / "missing.csv",), "missing.csv"),
            ((JOB,), "key 'robot' is unknown"),
        ):
            with self.subTest(needle):
                done = run("check", self.job, *arguments)
                self.assertEqual((done.returncode, done.stdout), (2, ""))
                self.assertIn(needle, done.stderr)
                self.assertEqual(done.stderr.count("\n"), 1)


class Refused(WithFolder):
    def test_other_commands_refuse_jobs(self):
        rows = self.folder / "rows.csv"
        rows.write_text("")
        commands = [
            ("info", JOB, "--pairs"),
        ]
        for command in commands:
            with self.subTest(command[0]):
                done = run(*command)
                self.assertEqual(done.returncode, 2, done.stdout)
                self.assertRegex(
                    done.stderr, r"^swivel: .*door_job.yaml:[0-9]+: strokes: makes this file a "
                    r"job, which `swivel plan`, `check`, `time`, `campaign`, `place` and "
                    r"io::load_problem\(\) take: allowed is a `path` here\n$"
                )
                self.assertEqual(done.stdout, "")


if __name__ == "__main__":
    unittest.main()

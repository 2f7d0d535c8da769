#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Motions in time from outside: every format read by a reader that is not Swivel's, and rates of
the joints by differences."""
import csv
import json
import os
import pathlib
import struct
import subprocess
import sys
import tempfile
import unittest

from pages import data_of
from trials import trials

SWIVEL = os.environ["SWIVEL"]
PROBLEMS = pathlib.Path(os.environ["SWIVEL_DATA"]) / "problems"
COARSE = ("--ds", "0.02", "--dphi", "0.1")
ACCELERATION, JERK = 10, 100  # what is assumed where nobody says


def run(*arguments):
    return subprocess.run(
        [SWIVEL, *map(str, arguments)], capture_output=True, text=True, timeout=300
    )


class Mcap:
    """Reads a file without compression, by https://mcap.dev/spec: nothing of Swivel's."""

    MAGIC = b"\x89MCAP0\r\n"

    def __init__(self, data):
        assert data[:8] == self.MAGIC and data[-8:] == self.MAGIC
        self.data = data
        self.schemas, self.channels, self.messages, self.profile = {}, {}, [], None
        self.statistics, self.summary, self.indexes = None, [], {}
        self.records(8, len(data) - 8)
        summary_start, offset_start, _ = struct.unpack_from("<QQI", data, len(data) - 8 - 20)
        at = summary_start
        while at < offset_start:
            opcode, length = struct.unpack_from("<BQ", data, at)
            self.summary.append((opcode, at, length))
            at += 9 + length
        assert at == offset_start

    @staticmethod
    def text(data, at):
        (n,) = struct.unpack_from("<I", data, at)
        return data[at + 4 : at + 4 + n].decode(), at + 4 + n

    def records(self, at, end):
        while at < end:
            opcode, length = struct.unpack_from("<BQ", self.data, at)
            self.record(opcode, at + 9, length)
            at += 9 + length
        assert at == end

    def record(self, opcode, at, length):
        data = self.data
        if opcode == 0x01:
            self.profile, _ = self.text(data, at)
        elif opcode == 0x03:
            (number,) = struct.unpack_from("<H", data, at)
            name, k = self.text(data, at + 2)
            encoding, k = self.text(data, k)
            definition, k = self.text(data, k)
            assert k == at + length
            self.schemas[number] = (name, encoding, definition)
        elif opcode == 0x04:
            number, schema = struct.unpack_from("<HH", data, at)
            topic, k = self.text(data, at + 4)
            encoding, k = self.text(data, k)
            self.channels[number] = (schema, topic, encoding)
        elif opcode == 0x05:
            channel, sequence, log, published = struct.unpack_from("<HIQQ", data, at)
            self.messages.append(
                (channel, sequence, log, published, data[at + 22 : at + length], at - 9)
            )
        elif opcode == 0x06:
            start, end, size, _ = struct.unpack_from("<QQQI", data, at)
            compression, k = self.text(data, at + 28)
            (n,) = struct.unpack_from("<Q", data, k)
            assert compression == "" and n == size
            self.chunk = (start, end, k + 8, n)
            self.records(k + 8, k + 8 + n)
        elif opcode == 0x07:
            channel, n = struct.unpack_from("<HI", data, at)
            self.index = [struct.unpack_from("<QQ", data, at + 6 + k) for k in range(0, n, 16)]
            self.indexes[channel] = self.index
        elif opcode == 0x0B:
            self.statistics = struct.unpack_from("<QHIIIIQQ", data, at)


class Cdr:
    def __init__(self, data):
        assert data[:4] == b"\0\1\0\0"
        self.data, self.at = data[4:], 0

    def take(self, kind):
        size = struct.calcsize(kind)
        self.at += -self.at % size
        (value,) = struct.unpack_from("<" + kind, self.data, self.at)
        self.at += size
        return value

    def text(self):
        n = self.take("I")
        value = self.data[self.at : self.at + n]
        self.at += n
        assert value[-1:] == b"\0"
        return value[:-1].decode()

    def numbers(self):
        return [self.take("d") for _ in range(self.take("I"))]


class Motion(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.holder = tempfile.TemporaryDirectory()
        cls.folder = pathlib.Path(cls.holder.name)
        cls.problem = PROBLEMS / "experiment_a.yaml"
        cls.trajectory = cls.folder / "t.csv"
        assert run("plan", cls.problem, "--out", cls.trajectory, *COARSE).returncode == 0

    @classmethod
    def tearDownClass(cls):
        cls.holder.cleanup()

    def timed(self, name, *options):
        out = self.folder / name
        done = run("time", self.problem, self.trajectory, "--out", out, *COARSE, *options)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        return out, done

    def table(self, file):
        with open(file) as lines:
            rows = list(csv.reader(lines))
        return rows[0], [[float(x) for x in row] for row in rows[1:]]

    def test_csv_keeps_the_rates_and_passes_check(self):
        for speed in ("0.05", "0.25"):
            out, done = self.timed("m.csv", "--speed", speed, "--rate", "1000")
            header, rows = self.table(out)
            self.assertEqual(header[:4], ["t", "s", "phi", "branch"])
            self.assertEqual([name + "_v" for name in header[4:11]], header[11:18])
            self.assertEqual([name + "_a" for name in header[4:11]], header[18:25])
            self.assertAlmostEqual(rows[1][0] - rows[0][0], 1e-3)
            most = self.worst_rates(out)
            self.assertLessEqual(max(most), 1 + 1e-9)
            self.assertGreater(most[1], 0.5)
            self.assertAlmostEqual(rows[-1][1], 0.5)
            self.assertIn("acceleration", done.stderr)
            check = run("check", self.problem, out, *COARSE)
            self.assertEqual(check.returncode, 0, check.stdout)
            self.assertIn("motion:", check.stdout)

    def test_check_finds_what_is_wrong(self):
        out, _ = self.timed("good.csv", "--speed", "0.1")
        lines = out.read_text().splitlines()
        bad = self.folder / "bad.csv"

        def checked(changed):
            bad.write_text("\n".join(changed) + "\n")
            return run("check", self.problem, bad, *COARSE)

        def with_field(line, column, change):
            fields = line.split(",")
            fields[column] = repr(change(float(fields[column])))
            return ",".join(fields)

        self.assertEqual(checked(lines).returncode, 0)
        middle = len(lines) // 2
        # Twice as fast; a sample left out of time; a velocity that is not the joints'; a joint that
        # is moved.
        fast = checked(lines[:1] + [with_field(line, 0, lambda t: t / 3) for line in lines[1:]])
        self.assertEqual(fast.returncode, 1)
        self.assertIn("jerk", fast.stdout)
        skipped = checked(
            lines[:middle]
            + [with_field(line, 0, lambda t: t - 0.004) for line in lines[middle + 1 :]]
        )
        self.assertEqual(skipped.returncode, 1)
        gap = checked(
            lines[:middle] + [with_field(line, 0, lambda t: t + 0.5) for line in lines[middle:]]
        )
        self.assertEqual(gap.returncode, 1)
        self.assertIn("at a gap in time: 0.504 s, where rows are 0.004 s apart", gap.stdout)
        paused = checked(lines + [with_field(lines[-1], 0, lambda t: t + 0.5)])  # at rest
        self.assertEqual(paused.returncode, 0, paused.stdout)
        for end in (1, len(lines) - 1):
            stated = checked(
                lines[:end] + [with_field(lines[end], 11, lambda v: 1000.0)] + lines[end + 1 :]
            )
            self.assertEqual(stated.returncode, 1)
            self.assertIn("is said to have 1000 rad/s", stated.stdout)
        said = checked(
            lines[:middle]
            + [with_field(lines[middle], 11, lambda v: v + 0.2)]
            + lines[middle + 1 :]
        )
        self.assertEqual(said.returncode, 1)
        self.assertIn("is said to have", said.stdout)
        moved = checked(
            lines[:middle]
            + [with_field(lines[middle], 4, lambda q: q + 1e-4)]
            + lines[middle + 1 :]
        )
        self.assertEqual(moved.returncode, 1)
        back = checked(lines[:middle] + [lines[middle + 1], lines[middle]] + lines[middle + 2 :])
        self.assertEqual(back.returncode, 2)
        self.assertIn("ascend", back.stderr)

    def test_joint_trajectory(self):
        table = self.table(self.timed("m.csv", "--speed", "0.1", "--rate", "100")[0])
        trajectory = json.loads(
            self.timed("m.json", "--speed", "0.1", "--rate", "100")[0].read_text()
        )
        read = [trajectory]
        text = self.timed("m.yaml", "--speed", "0.1", "--rate", "100")[0].read_text()
        try:
            import yaml

            read.append(yaml.safe_load(text))
        except ImportError:
            self.assertIn("joint_names: [", text)
        for message in read:
            self.assertEqual(
                message["header"], {"stamp": {"sec": 0, "nanosec": 0}, "frame_id": "base_link"}
            )
            self.assertEqual(message["joint_names"], table[0][4:11])
            self.assertEqual(len(message["points"]), len(table[1]))
            for point, row in zip(message["points"], table[1]):
                time = point["time_from_start"]
                self.assertAlmostEqual(time["sec"] + 1e-9 * time["nanosec"], row[0], delta=1e-9)
                self.assertLess(time["nanosec"], 1000000000)
                self.assertEqual([float(x) for x in point["positions"]], row[4:11])
                self.assertEqual([float(x) for x in point["velocities"]], row[11:18])
                self.assertEqual([float(x) for x in point["accelerations"]], row[18:25])
                self.assertEqual(point["effort"], [])

    def test_mcap(self):
        header, rows = self.table(self.timed("m.csv", "--speed", "0.1", "--rate", "100")[0])
        log = Mcap(self.timed("m.mcap", "--speed", "0.1", "--rate", "100")[0].read_bytes())
        self.assertEqual(log.profile, "ros2")
        self.assertEqual(len(log.schemas), 1)
        ((name, encoding, definition),) = log.schemas.values()
        self.assertEqual((name, encoding), ("sensor_msgs/msg/JointState", "ros2msg"))
        self.assertIn("MSG: std_msgs/Header", definition)
        ((schema, topic, message_encoding),) = log.channels.values()
        self.assertEqual((topic, message_encoding), ("/joint_states", "cdr"))
        self.assertEqual(len(log.messages), len(rows))
        self.assertEqual(log.statistics[0], len(rows))
        self.assertEqual([opcode for opcode, _, _ in log.summary], [0x03, 0x04, 0x0B, 0x08])
        self.assertEqual(len(log.index), len(rows))
        for (channel, sequence, logged, published, data, at), row, entry in zip(
            log.messages, rows, log.index
        ):
            self.assertAlmostEqual(logged * 1e-9, row[0], delta=1e-9)
            self.assertEqual(entry, (logged, at - log.chunk[2]))
            cdr = Cdr(data)
            self.assertEqual(cdr.take("i") * 1000000000 + cdr.take("I"), logged)
            self.assertEqual(cdr.text(), "base_link")
            self.assertEqual([cdr.text() for _ in range(cdr.take("I"))], header[4:11])
            self.assertEqual(cdr.numbers(), row[4:11])
            self.assertEqual(cdr.numbers(), row[11:18])
            self.assertEqual(cdr.numbers(), [])
            self.assertEqual(cdr.at, len(cdr.data))

    def test_refine(self):
        plain, _ = self.timed("p.csv", "--speed", "0.1")
        refined, done = self.timed("r.csv", "--speed", "0.1", "--refine")
        self.assertIn("refined: cost", done.stdout)
        self.assertEqual(run("check", self.problem, refined, *COARSE).returncode, 0)

        def way(file):
            rows = [row[4:11] for row in self.table(file)[1]]
            return sum(
                sum((x - y) ** 2 for x, y in zip(a, b)) ** 0.5 for a, b in zip(rows, rows[1:])
            )

        self.assertLess(way(refined), way(plain))

    def test_arms_without_an_arm_angle(self):
        """Of seven joints without one, and of six whose tool may roll: executable, by rates and by
        check, in every format."""
        for name, coarse in (
            ("panda_weld_seam", ()),
            ("kr6_weld_pipe", ()),
            ("ur5e_deburr_edge", ("--ds", "0.01")),
        ):
            problem, out, result = (
                PROBLEMS / f"{name}.yaml", self.folder / "arm.csv", self.folder / "arm.json"
            )
            options = ("--refine", "--speed", "0.05", "--quiet", *coarse)
            done = run("plan", problem, "--rate", "1000", "--out", out, "--json", result, *options)
            self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
            told = json.loads(result.read_text())
            self.assertTrue(told["refinement"]["refined"])
            self.assertLess(told["refinement"]["cost"], told["refinement"]["cost_before"])
            self.assertLess(told["motion"]["duration"], 1.05 * told["motion"]["ideal"])
            header, rows = self.table(out)
            roll = header[10] == "roll"
            self.assertEqual(roll, name != "panda_weld_seam")
            self.assertLessEqual(max(self.worst_rates(out, 6 if roll else 7)), 1 + 1e-9)
            for row in rows:
                self.assertTrue(not roll or row[2] == row[10])
            self.assertEqual(run("check", problem, out, *coarse).returncode, 0)
            # A phi that is not the roll is found.
            if roll:
                lines = out.read_text().splitlines()
                fields = lines[9].split(",")
                fields[2] = repr(float(fields[2]) + 0.01)
                bad = self.folder / "bad_roll.csv"
                bad.write_text("\n".join(lines[:9] + [",".join(fields)] + lines[10:]) + "\n")
                done = run("check", problem, bad, *coarse)
                self.assertEqual(done.returncode, 1)
                self.assertIn("the roll", done.stdout)
            # A trajectory planned without speed, refined and timed afterwards.
            trajectory, later = self.folder / "plain.csv", self.folder / "later.json"
            self.assertEqual(
                run("plan", problem, "--out", trajectory, "--quiet", *coarse).returncode, 0
            )
            done = run("time", problem, trajectory, "--out", later, *options)
            self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
            message = json.loads(later.read_text())
            names = header[4:10] if roll else header[4:11]
            self.assertEqual(message["joint_names"], names)
            self.assertEqual({len(point["positions"]) for point in message["points"]}, {len(names)})
            log = self.folder / "arm.mcap"
            self.assertEqual(run("plan", problem, "--out", log, *options).returncode, 0)
            cdr = Cdr(Mcap(log.read_bytes()).messages[0][4])
            cdr.take("i"), cdr.take("I"), cdr.text()
            self.assertEqual([cdr.text() for _ in range(cdr.take("I"))], names)
            self.assertEqual(len(cdr.numbers()), len(names))

    def test_pages_of_arms_without_an_arm_angle(self):
        page = self.folder / "page.html"
        done = run(
            "plan", PROBLEMS / "kr6_weld_pipe.yaml", "--refine", "--speed", "0.05",
            "--report", page, "--quiet"
        )
        if "built without reports" in done.stderr:
            self.skipTest("built without reports")
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertIn('"tool_mm_s": [', json.dumps(data_of(page)))

    def worst_rates(self, file, joints=7):
        """Largest differences of the joints over what they can do, at rest before and after."""
        _, rows = self.table(file)
        dt = rows[1][0] - rows[0][0]
        q = [row[4 : 4 + joints] for row in [rows[0]] * 3 + rows + [rows[-1]] * 3]
        most = [0, 0]
        for k in range(3, len(q)):
            for a, b, c, d in zip(*(q[k - i] for i in range(4))):
                most[0] = max(most[0], abs(a - 2 * b + c) / dt**2 / ACCELERATION)
                most[1] = max(most[1], abs(a - 3 * b + 3 * c - d) / dt**3 / JERK)
        return most

    def test_plan_refines_and_times(self):
        for problem, options in (
            (self.problem, COARSE),
            (PROBLEMS / "experiment_b.yaml", ()),
            (PROBLEMS / "experiment_c.yaml", ("--seed", "1", "--episode", "7")),
        ):
            out, result = self.folder / "p.csv", self.folder / "p.json"
            done = run(
                "plan", problem, "--refine", "--speed", "0.25", "--rate", "1000", "--out", out,
                "--json", result, *options
            )
            self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
            lines = done.stdout.splitlines()
            self.assertEqual([line.split(":")[0] for line in lines[-2:]], ["refined", "motion"])
            told = json.loads(result.read_text())
            self.assertTrue(told["refinement"]["refined"])
            self.assertLess(told["refinement"]["cost"], told["refinement"]["cost_before"])
            self.assertAlmostEqual(told["cost"], told["refinement"]["cost"])
            self.assertAlmostEqual(
                told["lattice"]["cost"], told["refinement"]["cost_before"], places=6
            )
            motion = told["motion"]
            _, rows = self.table(out)
            self.assertTrue(motion["executable"])
            self.assertEqual(motion["samples"], len(rows))
            self.assertGreaterEqual(motion["duration"], motion["ideal"])
            self.assertLess(motion["between_samples"]["position"], 1e-6)
            for key in "speed", "acceleration", "jerk":
                self.assertEqual(
                    [peak["joint"] for peak in motion["peaks"][key]], told["joint_names"]
                )
            worst = self.worst_rates(out)
            self.assertLessEqual(max(worst), 1 + 1e-9)
            for key, seen in zip(("acceleration", "jerk"), worst):
                self.assertAlmostEqual(
                    max(peak["ratio"] for peak in motion["peaks"][key]), seen, places=6
                )
            for stretch in motion["slow"]:
                self.assertIn(stretch["joint"], told["joint_names"])
                self.assertLess(stretch["share"], 1)
            self.assertEqual(run("check", problem, out, *options).returncode, 0)

    def test_refine_alone_writes_a_trajectory(self):
        plain, refined = self.folder / "plain.csv", self.folder / "refined.csv"
        for out, options in (plain, ()), (refined, ("--refine",)):
            done = run("plan", PROBLEMS / "experiment_b.yaml", "--out", out, *options)
            self.assertEqual(done.returncode, 0, done.stderr)
        check = run("check", PROBLEMS / "experiment_b.yaml", refined)
        self.assertEqual(check.returncode, 0, check.stdout)
        (header, before), (same, after) = self.table(plain), self.table(refined)
        self.assertEqual(header, same)
        self.assertEqual([row[0] for row in before], [row[0] for row in after])
        self.assertEqual(before[0], after[0])  # the given start

    def test_plan_writes_every_format(self):
        for ending in "csv", "json", "yaml", "mcap":
            out = self.folder / f"f.{ending}"
            done = run("plan", self.problem, *COARSE, "--speed", "0.1", "--out", out, "--quiet")
            self.assertEqual((done.returncode, done.stdout), (0, ""), done.stderr)
            self.assertGreater(len(out.read_bytes()), 10000)
        # Without --refine the motion is that of the trajectory that was planned on the rounded
        # path: here the same.
        timed, _ = self.timed("same.csv", "--speed", "0.1")
        self.assertEqual(self.table(timed)[1][-1][0], self.table(self.folder / "f.csv")[1][-1][0])

    def test_what_cannot_be_executed(self):
        jumps, out = self.folder / "jumps.csv", self.folder / "jumps.mcap"
        episode = ("--seed", "1", "--episode", "153")
        self.assertEqual(
            run("plan", PROBLEMS / "experiment_c.yaml", *episode, "--out", jumps).returncode, 0
        )
        out.write_text("from before")
        done = run(
            "time", PROBLEMS / "experiment_c.yaml", jumps, *episode, "--speed", "0.05", "--out", out
        )
        self.assertEqual(done.returncode, 1)
        self.assertIn("not executable", done.stdout)
        self.assertIn("the joints would have to jump", done.stdout)
        self.assertFalse(out.exists())
        done = run(
            "plan", PROBLEMS / "experiment_c.yaml", *episode, "--speed", "0.05", "--out", out
        )
        self.assertEqual(done.returncode, 0, done.stdout)
        self.assertIn("asks joints to jump", done.stderr)

    def test_plan_says_what_is_not_allowed(self):
        for options, word in (
            (("--rate", "100"), "--speed"),
            (("--turn-speed", "1"), "--speed"),
            (("--speed", "-1"), "--speed"),
            (("--speed", "1", "--out", self.folder / "p.bag"), ".mcap"),
            (("--speed", "1", "--rate", "0"), "--rate"),
        ):
            done = run("plan", self.problem, *COARSE, *options)
            self.assertEqual(done.returncode, 2, done.stdout)
            self.assertIn(word, done.stderr)
            self.assertEqual(len(done.stderr.splitlines()), 1)

    def test_time_is_up(self):
        """What is known stays: the path, with the reason why it is not refined or timed."""
        seen, count = set(), max(2, trials(36))
        for k in range(count):
            result, out = self.folder / "late.json", self.folder / "late.csv"
            done = run(
                "plan", PROBLEMS / "experiment_c.yaml", "--planner", "lazy", "--refine",
                "--speed", "0.05", "--timeout", 5e-4 * 1.25 ** (35 * k / (count - 1)),
                "--json", result, "--out", out
            )
            told = json.loads(result.read_text())
            if told["status"] != "solved":
                self.assertEqual(
                    (done.returncode, told["motion"], told["refinement"]), (3, None, None)
                )
                seen.add("no path")
            elif told["motion"]["executable"]:
                self.assertEqual(done.returncode, 0)
                self.assertTrue(out.exists())
                seen.add("motion")
            else:
                self.assertEqual((done.returncode, told["motion"]["reason"]), (3, "stopped"))
                self.assertEqual(len(told["trajectory"]), told["lattice"]["layers"])
                self.assertFalse(out.exists())
                seen.add("path")
        self.assertLessEqual({"no path", "motion"}, seen)

    def test_bad_input(self):
        for options, word in (
            ((), "--speed"),
            (("--speed", "0"), "--speed"),
            (("--speed", "0.1", "--rate", "-1"), "--rate"),
            (("--speed", "0.1", "--out", self.folder / "m.bag"), ".mcap"),
            (("--speed", "0.1", "--out", self.trajectory), "--out"),
        ):
            done = run("time", self.problem, self.trajectory, *COARSE, *options)
            self.assertEqual(done.returncode, 2, done.stdout)
            self.assertIn(word, done.stderr)
            self.assertEqual(len(done.stderr.splitlines()), 1)

    def test_any_trajectory_is_checked_and_timed(self):
        """The same joints in every format, by themselves or with what Swivel writes besides."""
        files = {"t.csv": self.trajectory}
        for ending in ("csv", "json", "yaml", "mcap"):
            files[f"motion.{ending}"], _ = self.timed(
                f"foreign_motion.{ending}", "--speed", "0.1", "--rate", "30"
            )
        for name, source, wanted in (
            ("joints.csv", self.trajectory, "j"),
            ("s_joints.csv", self.trajectory, "sj"),
            ("t_joints.csv", files["motion.csv"], "tj"),
        ):
            header, rows = self.table(source)
            chosen = [
                k
                for k, column in enumerate(header)
                if column == "t"
                and "t" in wanted
                or column == "s"
                and "s" in wanted
                or column.startswith("arm_left_joint")
                and not column.endswith(("_v", "_a"))
            ][::-1]
            self.assertEqual(len(chosen), 6 + len(wanted))
            files[name] = self.folder / f"foreign_{name}"
            files[name].write_text(
                "\n".join(
                    ",".join(map(str, row))
                    for row in [[line[k] for k in chosen] for line in [header, *rows]]
                )
                + "\n"
            )
        for name, file in files.items():
            with self.subTest(name):
                check = run("check", self.problem, file, *COARSE)
                self.assertEqual(check.returncode, 0, check.stdout + check.stderr)
                out = self.folder / "again.csv"
                done = run("time", self.problem, file, "--speed", "0.1", "--out", out, *COARSE)
                self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
                self.assertEqual(run("check", self.problem, out, *COARSE).returncode, 0)
        # Rows of another resolution are moved to the layers of this one.
        finer = ("--ds", "0.013", "--dphi", "0.1")
        done = run(
            "time", self.problem, files["joints.csv"], "--speed", "0.1", "--out", out, *finer
        )
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertEqual(run("check", self.problem, out, *finer).returncode, 0)
        # A joint that is not of the arm is refused; a pose off the path is told by how much.
        header, *rows = files["joints.csv"].read_text().splitlines()
        bad = self.folder / "foreign_bad.csv"
        for command in (
            ("check", self.problem, bad),
            ("time", self.problem, bad, "--speed", "0.1"),
        ):
            bad.write_text("\n".join([header + ",finger", *(row + ",0" for row in rows)]) + "\n")
            done = run(*command, *COARSE)
            self.assertEqual((done.returncode, len(done.stderr.splitlines())), (2, 1), done.stderr)
            self.assertIn("foreign_bad.csv:1: column 'finger'", done.stderr)
        moved = rows[3].split(",")
        moved[3] = repr(float(moved[3]) + 1e-3)
        bad.write_text("\n".join([header, *rows[:3], ",".join(moved), *rows[4:]]) + "\n")
        done = run("check", self.problem, bad, *COARSE)
        self.assertEqual(done.returncode, 1)
        self.assertIn("row 3: the tool is ", done.stdout)
        done = run("time", self.problem, bad, "--speed", "0.1", *COARSE)
        self.assertEqual(done.returncode, 2)
        self.assertIn("foreign_bad.csv: row 3: the tool is ", done.stderr)

    def test_limits_of_the_problem_file_come_first(self):
        text = self.problem.read_text().replace("../", str(PROBLEMS.parent) + "/")
        gentle = self.folder / "gentle.yaml"
        gentle.write_text(
            text.replace(
                "limits: {", "limits: {joint_acceleration: 0.5, joint_jerk: [5, 5, 5, 5, 5, 5, 5], "
            )
        )
        self.assertNotEqual(gentle.read_text(), text)
        done = run(
            "time", gentle, self.trajectory, "--speed", "0.25", "--out", self.folder / "g.csv",
            *COARSE
        )
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertNotIn("are stated neither", done.stderr)
        quick, _ = self.timed("q.csv", "--speed", "0.25")
        self.assertGreater(self.table(self.folder / "g.csv")[1][-1][0], self.table(quick)[1][-1][0])
        self.assertEqual(run("check", gentle, self.folder / "g.csv", *COARSE).returncode, 0)
        self.assertEqual(run("check", gentle, quick, *COARSE).returncode, 1)


if __name__ == "__main__":
    unittest.main()

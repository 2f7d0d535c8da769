# SPDX-License-Identifier: BSD-3-Clause
"""What bench/same_answers compares: times are masked, generated problems load, and what a program
answers otherwise is found."""
import base64
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest
import zlib

BENCH = pathlib.Path(os.environ["SWIVEL_SOURCE"]) / "bench"
PROGRAM = pathlib.Path(os.environ["SWIVEL"])
sys.path.insert(0, str(BENCH))
from same import answers, cases, comparison, masks, random_problems, steps


class Masks(unittest.TestCase):
    def test_times_of_work_alone_are_masked(self):
        printed = "motion: 2.5 s at 50 mm/s\nlazy, 1 thread: load 1.5 ms, plan 2e-05 ms; 3 nodes\n"
        self.assertEqual(
            masks.printed(printed, []),
            "motion: 2.5 s at 50 mm/s\nlazy, 1 thread: load # ms, plan # ms; 3 nodes\n",
        )
        self.assertEqual(masks.printed("6 of 6, 0.1 s, 88 a second", []), "6 of 6, # s, # a second")
        self.assertEqual(
            masks.printed('{"cost": 1, "time_ms": {"a": 1, "stages": {"b": 2}}, "c": 3}', []),
            '{"cost": 1, "time_ms": {}, "c": 3}',
        )
        self.assertEqual(masks.printed("/tmp/x/a: no", [("/tmp/x", "FOLDER")]), "FOLDER/a: no")

    def test_tables_keep_all_but_times(self):
        table = '# x\nepisode,plan_ms,reason\n0,1.5,"a, b"\n1,,c\n'
        self.assertEqual(masks.table(table), '# x\nepisode,plan_ms,reason\n0,#,"a, b"\n1,,c\n')
        self.assertEqual(masks.table("s,phi\n0,1\n"), "s,phi\n0,1\n")

    def test_pages_keep_their_data(self):
        def page(cost, load, binary):
            data = json.dumps({"cost": cost, "time_ms": {"load": load}}).encode() + b"\0" + binary
            data = base64.b64encode(zlib.compress(data)).decode()
            return f'<p><script id="data" type="application/zlib">{data}</script></p>'

        one = masks.page(page(1, 2, b"\xff"), [])
        self.assertEqual(one, masks.page(page(1, 3, b"\xff"), []))
        self.assertNotEqual(one, masks.page(page(2, 2, b"\xff"), []))
        self.assertNotEqual(one, masks.page(page(1, 2, b"\xfe"), []))
        self.assertNotEqual(one, masks.page(page(1, 2, b"\xff") + "<br>", []))


class Generator(unittest.TestCase):
    def test_a_seed_gives_its_problems_again(self):
        for make in cases.MAKERS.values():
            self.assertEqual(make(1, 3), make("1", 3))
            self.assertNotEqual(make(1, 3), make(2, 3))
            self.assertNotEqual(make(1, 3), make(1, 4))

    def test_problems_load(self):
        codes = []
        for kind, make in cases.MAKERS.items():
            for number in range(6):
                files, _ = make(7, number)
                step = answers.Step("plan", ("plan", cases.MADE, *steps.LAZY))
                case = answers.Case("", files, [step])
                found = answers.answers(case, answers.Build(PROGRAM, None))
                codes.append(found["plan code"])
                self.assertIn(codes[-1], (b"0\n", b"1\n"), found["plan stderr"])
        self.assertGreater(codes.count(b"0\n"), 5)
        self.assertGreater(codes.count(b"1\n"), 1)

    def test_names_are_unique(self):
        names = [case.name for case in cases.every_case(1, False)]
        self.assertEqual(len(names), len(set(names)))
        for case in cases.every_case(1, True):
            self.assertEqual(len({step.name for step in case.steps}), len(case.steps), case.name)


class Differences(unittest.TestCase):
    """Runs the command with a program that answers a little otherwise."""

    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.place = pathlib.Path(self.folder.name)

    def tearDown(self):
        self.folder.cleanup()

    def other(self, line):
        """A program that runs the true one and then this line of a shell."""
        wrapper = self.place / "swivel"
        wrapper.write_text(
            '#!/usr/bin/env bash\n"$SWIVEL_TRUE" "$@" > .out 2> .err\ncode=$?\n'
            f"{line} 2> .no\ncat .out; cat .err >&2; rm -f .out .err .no; exit $code\n".replace(
                '"$SWIVEL_TRUE"', f"'{PROGRAM}'"
            )
        )
        wrapper.chmod(0o755)
        return wrapper

    def compare(self, *words, only="random path/007"):
        return subprocess.run(
            [sys.executable, BENCH / "same_answers", *words, "--only", only, "--jobs", "1"],
            capture_output=True,
            text=True,
        )

    def test_a_program_is_as_itself(self):
        done = self.compare(PROGRAM, PROGRAM)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertRegex(done.stdout, r"1 cases, \d\d answers, 0 differ")

    def test_each_kind_of_difference_is_found(self):
        recording = self.place / "kept"
        self.assertEqual(self.compare("--record", recording, PROGRAM).returncode, 0)
        for line, kind in {
            "true": None,
            "sed -i 's/cost 0/cost 1/' .out": "stdout",
            "echo 'swivel: warning: more' >> .err": "stderr",
            "code=7": "code",
            "sed -i 's/\"cost\": /&1/' out/*.answer.json": "answer",
            "sed -i '2s/1/2/' out/lazy.rows.csv": "rows",
            "sed -i '3s/1/2/' out/speed.motion.csv": "motion",
            "rm -f out/speed.motion.csv": "motion",
            "touch out/more": "other file",
        }.items():
            done = self.compare(recording, self.other(line))
            counted = dict(
                re.findall(r"^([a-z ]+?) +\d+ compared, (\d+) differ$", done.stdout, re.M)
            )
            self.assertEqual(done.returncode, 1 if kind else 0, done.stdout + done.stderr)
            differ = {name for name, count in counted.items() if count != "0"}
            self.assertTrue(
                differ == set() if kind is None else kind in differ, (line, done.stdout)
            )

    def test_the_first_line_that_differs_is_shown(self):
        found = comparison.differing_line(
            b"a\n" + 500 * b"b" + b"1\n", b"a\n" + 500 * b"b" + b"2\n"
        )
        self.assertRegex(found, r"^line 2\n    - b{80}1\n    \+ b{80}2$")
        self.assertIn("(none)", comparison.differing_line(b"a\n", b"a\nb\n"))


if __name__ == "__main__":
    unittest.main()

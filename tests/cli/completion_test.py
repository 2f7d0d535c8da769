#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""What the program says of itself: the completion of its command line, in a real shell, against
its help; the help of all commands; exit codes, against the README."""
import os
import pathlib
import re
import shutil
import subprocess
import tempfile
import unittest

SWIVEL = os.environ["SWIVEL"]
README = pathlib.Path(os.environ["SWIVEL_DATA"]).parent / "README.md"


def swivel(*arguments):
    return subprocess.run(
        [SWIVEL, *arguments], capture_output=True, text=True, check=True, timeout=60
    ).stdout


def commands():
    listed = swivel("--help").split("Subcommands:\n")[1].split("\n\n")[0]
    return [line.split()[0] for line in listed.splitlines() if re.match(r"  [a-z]", line)]


def options(*command):
    return set(re.findall(r"^  (?:-h,)?(--[a-z-]+)", swivel(*command, "--help"), re.MULTILINE))


class Completion(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.script = self.folder / "script"
        self.script.write_text(swivel("completion"))
        (self.folder / "my cell.yaml").write_text("")
        (self.folder / "meshes").mkdir()

    def completed(self, *words):
        """What bash offers for the last of the words, behind the program's name."""
        count = len(words)
        done = subprocess.run(
            ["bash", "-c", 'source "$0"; COMP_WORDS=(swivel "$@"); COMP_CWORD=$#; _swivel; '
             'printf "%s\\n" "${COMPREPLY[@]}"', self.script, *words],
            capture_output=True, text=True, check=True, cwd=self.folder, timeout=60
        )
        self.assertEqual(done.stderr, "", (words, count))
        return [line for line in done.stdout.splitlines() if line]

    def test_commands(self):
        self.assertGreaterEqual(len(commands()), 9)
        self.assertEqual(set(self.completed("")), {*commands(), *options()})
        self.assertEqual(self.completed("pl"), ["plan", "place"])
        self.assertEqual(self.completed("--ver"), ["--version"])

    def test_options(self):
        for command in commands():
            with self.subTest(command):
                self.assertEqual(
                    set(self.completed(command, "problem.yaml", "--")), options(command)
                )
        self.assertEqual(self.completed("plan", "--map-"), ["--map-svg"])
        self.assertEqual(self.completed("nothing", "--"), [])

    def test_values_and_files(self):
        self.assertEqual(
            self.completed("plan", "--planner", ""), ["eager", "eager_dp", "lazy", "parallel"]
        )
        self.assertEqual(self.completed("check", "x.yaml", "--edges", "no"), ["nodes"])
        self.assertEqual(self.completed("plan", "my"), ["my cell.yaml"])
        self.assertEqual(self.completed("plan", "--out", "me"), ["meshes"])

    def test_the_script_is_sound(self):
        self.assertEqual(subprocess.run(["bash", "-n", self.script]).returncode, 0)
        if shutil.which("shellcheck"):
            subprocess.run(["shellcheck", "--shell=bash", "--exclude=SC2207", self.script],
                           check=True)

    def test_help_of_all_commands(self):
        text = swivel("--help-all")
        for command in commands():
            for option in options(command):
                self.assertIn(option, text)

    def test_exit_codes(self):
        told = dict(re.findall(r"^  (\d)  (.*)$", swivel("--help").split("Exit codes:\n")[1],
                               re.MULTILINE))
        readme = " ".join(README.read_text().split())
        readme = readme.split("Exit codes: ")[1].split(" report it")[0]
        self.assertEqual(
            [int(code) for code in re.findall(r"(?:^|, )(\d) ", readme)], [*map(int, told)]
        )
        self.assertEqual([*map(int, told)], [0, 1, 2, 3, 4, 5])


if __name__ == "__main__":
    unittest.main()

# SPDX-License-Identifier: BSD-3-Clause
"""Tests of ./swivel and of the bundling of the pages, in projects made for them. SWIVEL_ROOT is the
source tree."""
import json
import os
import pathlib
import pty
import selectors
import shutil
import stat
import subprocess
import sys
import tempfile
import time
import unittest

ROOT = pathlib.Path(os.environ["SWIVEL_ROOT"])

# Builds cli/swivel, a script, and by `pages` what stands for the page: its content is asked of a
# fake npm.
PROJECT = """
cmake_minimum_required(VERSION 3.25)
project(fake LANGUAGES NONE)
add_custom_command(OUTPUT cli/swivel COMMAND ${CMAKE_COMMAND} -P ${CMAKE_SOURCE_DIR}/work.cmake
  COMMAND ${CMAKE_COMMAND} -E copy ${CMAKE_SOURCE_DIR}/program cli/swivel
  DEPENDS program work.cmake)
add_custom_command(OUTPUT report/web/report.html
  COMMAND sh ${CMAKE_SOURCE_DIR}/page > report/web/report.html)
add_custom_target(pages ALL DEPENDS report/web/report.html)
add_custom_target(program ALL DEPENDS cli/swivel)
add_dependencies(program pages)
add_custom_target(all_of_it DEPENDS program)
file(MAKE_DIRECTORY ${CMAKE_BINARY_DIR}/report/web)
enable_testing()
add_test(NAME told COMMAND sh -c "echo scale=$SWIVEL_TEST_SCALE")
"""
PRESETS = {
    "version": 6,
    "configurePresets": [
        {"name": "release", "generator": "Ninja", "binaryDir": "${sourceDir}/build/${presetName}"}
    ],
    "testPresets": [{"name": "release", "configurePreset": "release"}],
}


def executable(path, text):
    path.write_text(text)
    path.chmod(path.stat().st_mode | stat.S_IXUSR)


class Project(unittest.TestCase):
    def setUp(self):
        self.root = pathlib.Path(tempfile.mkdtemp(prefix="swivel-wrapper-"))
        self.addCleanup(shutil.rmtree, self.root)
        shutil.copy(ROOT / "swivel", self.root)
        (self.root / "cmake").mkdir()
        (self.root / "cmake/packages.txt").write_text("# none\nbash\n")
        (self.root / "CMakeLists.txt").write_text(PROJECT)
        (self.root / "CMakePresets.json").write_text(json.dumps(PRESETS))
        (self.root / "work.cmake").write_text("")
        (self.root / "page").write_text("echo page\n")
        executable(self.root / "program", '#!/bin/sh\necho "$PWD:$*"\nexit 3\n')
        self.environment = {
            name: value
            for name, value in os.environ.items()
            if name not in ("CI", "SWIVEL_PRESET", "SWIVEL_TEST_SCALE")
        }

    def build_until_told(self, then=""):
        """The build goes on until let_go(), two minutes at most."""
        (self.root / "work.cmake").write_text(
            f"""
foreach(tick RANGE 1200)
  if(EXISTS {self.root}/go)
    break()
  endif()
  execute_process(COMMAND sleep 0.1)
endforeach()
{then}
"""
        )

    def let_go(self):
        (self.root / "go").touch()

    def begin(self, stderr=subprocess.PIPE):
        return subprocess.Popen(
            [self.root / "swivel"],
            env=self.environment,
            text=True,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=stderr,
        )

    def call(self, *arguments, cwd=None, **environment):
        return subprocess.run(
            [self.root / "swivel", *arguments],
            cwd=cwd or self.root,
            env=self.environment | environment,
            text=True,
            stdin=subprocess.DEVNULL,
            capture_output=True,
            timeout=120,
        )

    def log(self):
        return self.root / "build/release.log"

    def page(self):
        return self.root / "build/release/report/web/report.html"


class Wrapper(Project):
    def test_the_second_call_prints_what_the_program_prints_and_leaves_the_log(self):
        first = self.call("a b", cwd="/")
        self.assertEqual((first.returncode, first.stdout), (3, "/:a b\n"), first.stderr)
        self.assertIn("swivel: configuring release\n", first.stderr)
        log = self.log().read_text()
        self.assertIn("[2/2]", log)
        times = []
        for _ in range(5):
            began = time.monotonic()
            second = self.call("--version", cwd="/")
            times.append(time.monotonic() - began)
            self.assertEqual((second.stdout, second.stderr), ("/:--version\n", ""))
        self.assertEqual(self.log().read_text(), log)
        print(f"wrapper: {min(times) * 1000:.0f} ms")
        self.assertLess(min(times), 1)

    def test_a_long_build_shows_how_far_it_is(self):
        self.build_until_told()
        began = time.monotonic()
        call, shown = self.begin(), ""
        # A line each half minute, the first perhaps before the steps are known.
        while "of 2 steps" not in shown:
            line = call.stderr.readline()
            self.assertTrue(line, shown)
            shown += line
        self.let_go()
        shown += call.stderr.read()
        call.communicate(timeout=120)
        self.assertEqual(call.returncode, 3)
        self.assertLessEqual(
            shown.count("building"), 1 + (time.monotonic() - began) // 30,
            "one line each half minute"
        )
        self.assertRegex(
            shown, r"swivel: building release, [01] of 2 steps; output in .*release.log\n"
        )

    def test_a_terminal_gets_one_line_that_moves(self):
        self.call()
        self.build_until_told()
        try:
            master, slave = pty.openpty()
        except OSError as error:
            self.skipTest(str(error))  # a chroot without /dev/pts
        call, shown = self.begin(stderr=slave), ""
        while shown.count("\r\033[Kswivel: building release") < 2:
            shown += os.read(master, 65536).decode()
        self.let_go()
        call.communicate(timeout=120)
        shown += os.read(master, 65536).decode()
        os.close(slave)
        os.close(master)
        self.assertEqual(call.returncode, 3)
        self.assertNotIn("\n", shown)
        self.assertTrue(shown.endswith("\r\033[K"), "the line is removed")

    def test_a_build_that_fails_shows_why_and_ends_with_4(self):
        (self.root / "work.cmake").write_text('message(FATAL_ERROR "the reason")')
        for _ in range(2):
            done = self.call()
            self.assertEqual((done.returncode, done.stdout), (4, ""))
            self.assertIn("the reason", done.stderr)
            self.assertIn("swivel: the build failed; its output is in", done.stderr)
        (self.root / "work.cmake").write_text("")
        self.assertEqual(self.call().returncode, 3)

    def test_a_configuration_that_fails_shows_why_and_ends_with_4(self):
        (self.root / "CMakeLists.txt").write_text(
            'cmake_minimum_required(VERSION 3.25)\nproject(fake LANGUAGES NONE)\n'
            'message(FATAL_ERROR "the reason")'
        )
        done = self.call()
        self.assertEqual((done.returncode, done.stdout), (4, ""))
        self.assertIn("the reason", done.stderr)

    def test_without_pages_one_line_says_so_and_a_call_with_report_tries_again(self):
        (self.root / "page").write_text("true\n")
        first = self.call("plan")
        self.assertEqual(first.returncode, 3)
        self.assertRegex(first.stderr, "(?m)^swivel: built without the pages of --report.*$")
        self.assertEqual(self.call("plan").stderr, "", "told once")
        again = self.call("plan", "--report", "x.html")
        self.assertEqual(again.returncode, 3)
        self.assertIn("built without the pages of --report", again.stderr)
        (self.root / "page").write_text("echo page\n")
        self.assertEqual(self.call("plan").stderr, "", "no call without --report tries again")
        self.assertNotIn("built without", self.call("plan", "--report=x.html").stderr)
        self.assertEqual(self.page().read_text(), "page\n")
        self.assertEqual(self.call("plan", "--report", "x.html").stderr, "")

    def test_calls_at_once_build_once(self):
        self.build_until_told(then=f"file(APPEND {self.root}/count x)")
        calls = [self.begin() for _ in range(3)]
        waiting = selectors.DefaultSelector()
        for call in calls:
            waiting.register(call.stderr, selectors.EVENT_READ)
        shown = ""
        while shown.count("waiting for another call") < 2:
            for ready, _ in waiting.select(timeout=120):
                text = os.read(ready.fd, 65536).decode()
                self.assertTrue(text, shown)
                shown += text
        self.let_go()
        ends = [(call.communicate(timeout=120)[1], call.returncode) for call in calls]
        self.assertEqual([code for _, code in ends], [3, 3, 3])
        self.assertEqual((self.root / "count").read_text(), "x")
        self.assertEqual(
            (shown + "".join(text for text, _ in ends)).count("waiting for another call"), 2
        )


    def test_tests_make_a_quarter_of_their_trials_unless_told_otherwise(self):
        self.call()
        for scale, given in (("0.25", {}), ("1", {"SWIVEL_TEST_SCALE": "1"})):
            done = self.call("test", "-V", **given)
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertIn(f"scale={scale}\n", done.stdout)
            self.assertIn(f"swivel: testing with {scale} of the random trials", done.stderr)


class Pages(unittest.TestCase):
    """npm fails, as it does without a network or behind a proxy."""

    def bundle(self, folder, report, npm="false"):
        return subprocess.run(
            [
                "cmake", f"-DNPM={npm}", "-DNODE=node", f"-DFOLDER={folder}", f"-DREPORT={report}",
                "-P", ROOT / "report/bundle.cmake"
            ],
            text=True,
            capture_output=True,
            timeout=120,
        )

    def test_where_reports_are_not_asked_for_the_pages_are_left_empty(self):
        with tempfile.TemporaryDirectory() as folder:
            done = self.bundle(folder, "AUTO")
            self.assertEqual(done.returncode, 0)
            self.assertIn("npm ci failed (1): built without the pages of --report", done.stderr)
            for name in ("report.html", "overview.html", "THIRD-PARTY.txt"):
                self.assertEqual((pathlib.Path(folder) / name).read_bytes(), b"")
            self.assertEqual(
                (pathlib.Path(folder) / "bundle.d").read_text(),
                f"{folder}/report.html: {ROOT}/report/web/build.mjs\n",
            )
            self.assertIn(
                "npm ci failed", self.bundle(folder, "AUTO").stderr, "tries again when asked again"
            )

    def test_where_reports_are_asked_for_the_build_fails(self):
        with tempfile.TemporaryDirectory() as folder:
            self.assertEqual(self.bundle(folder, "AUTO").returncode, 0)
            self.assertNotEqual(self.bundle(folder, "ON").returncode, 0)
            self.assertFalse((pathlib.Path(folder) / "report.html").exists())


if __name__ == "__main__":
    unittest.main(argv=sys.argv)

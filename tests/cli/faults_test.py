#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""What happens to files where something goes wrong: one test a row of the table of faults, and
internal errors."""
import json
import os
import pathlib
import re
import resource
import shutil
import signal
import stat
import subprocess
import threading
import time
import unittest

import cli_test
from cli_test import DATA, PROBLEMS, SWIVEL, run

SOLVED = PROBLEMS / "experiment_a.yaml"
NO_PATH = PROBLEMS / "experiment_a_start.yaml"
QUICK = ("--ds", "0.02", "--dphi", "0.2")
CAMPAIGN = ("campaign", PROBLEMS / "experiment_c.yaml", "--edges", "nodes", *QUICK)
NOBODY = 65534


class WithFiles(cli_test.WithFolder):
    """`old` and `json` lie in the folder already; nothing may be left beside them."""

    def setUp(self):
        super().setUp()
        self.old = self.folder / "t.csv"
        self.old.write_text("old")
        self.json = self.folder / "r.json"
        self.json.write_text("old")

    def plan_files(self, problem=SOLVED, out=None, json=None, options=(), **how):
        command = [
            SWIVEL,
            "plan",
            problem,
            *(options if "--ds" in options else (*QUICK, *options)),
            "--out",
            out or self.old,
            "--json",
            json or self.json,
        ]
        return subprocess.run(
            list(map(str, command)), capture_output=True, text=True, timeout=60, **how
        )

    def is_refused(self, done, *words):
        self.assertEqual(done.returncode, 2, f"{done.stdout}{done.stderr}")
        self.assertEqual(len(done.stderr.strip().splitlines()), 1, done.stderr)
        for word in (*words, "allowed"):
            self.assertIn(word, done.stderr)
        self.assertEqual(done.stdout or "", "")
        self.nothing_written()

    def nothing_written(self):
        self.assertEqual((self.old.read_text(), self.json.read_text()), ("old", "old"))
        self.nothing_beside()

    def nothing_beside(self):
        self.assertEqual([file.name for file in self.folder.rglob(".*")], [])


class Faults(WithFiles):
    def test_no_path_removes_a_stale_trajectory_and_says_so(self):
        done = self.plan_files(NO_PATH)
        self.assertEqual(done.returncode, 1)
        self.assertFalse(self.old.exists())
        self.assertEqual(
            done.stderr, f"swivel: removed the earlier {self.old}: there is no path now\n"
        )
        self.assertEqual(json.loads(self.json.read_text())["status"], "infeasible")
        self.assertEqual(self.plan_files(NO_PATH).stderr, "")  # nothing was there

    def test_a_time_out_removes_all_that_would_be_stale(self):
        drawing = self.folder / "map.svg"
        drawing.write_text("old")
        done = self.plan_files(
            PROBLEMS / "experiment_c.yaml", options=("--timeout", "1e-6", "--map-svg", drawing)
        )
        self.assertEqual(done.returncode, 3)
        self.assertFalse(self.old.exists() or drawing.exists())
        self.assertEqual(
            sorted(done.stderr.splitlines()),
            [
                f"swivel: removed the earlier {file}: the search was stopped"
                for file in (drawing, self.old)
            ],
        )

    def test_full_disk(self):
        def limit(size):
            return lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (size, size))

        self.is_refused(self.plan_files(preexec_fn=limit(1000)), "--out", "File too large")
        # The trajectory fits, the result does not: neither is written.
        self.is_refused(self.plan_files(preexec_fn=limit(8000)), "--json", "File too large")

    def test_full_disk_of_root(self):
        disk = self.folder / "disk"
        disk.mkdir()
        if (
            os.geteuid() != 0
            or subprocess.run(
                ["mount", "-t", "tmpfs", "-o", "size=8k", "none", disk], capture_output=True
            ).returncode
            != 0
        ):
            self.skipTest("only root may mount")
        try:
            trajectory = disk / "t.csv"
            trajectory.write_text("old")
            self.is_refused(
                self.plan_files(out=trajectory, options=("--ds", "0.001")), "--out", "No space left"
            )
            self.assertEqual(
                [(file.name, file.read_text()) for file in disk.iterdir()], [("t.csv", "old")]
            )
        finally:
            subprocess.run(["umount", disk], check=True)

    def test_read_only_folder(self):
        closed = self.folder / "closed"
        closed.mkdir()
        (closed / "t.csv").write_text("old")
        closed.chmod(0o555)
        how = {}
        if os.geteuid() == 0:  # to whom no folder is closed
            self.folder.chmod(0o777)
            how = {"user": NOBODY, "group": NOBODY}
        for problem in (SOLVED, NO_PATH):
            self.is_refused(
                self.plan_files(problem, out=closed / "t.csv", **how), "--out", "Permission denied"
            )
            self.assertEqual((closed / "t.csv").read_text(), "old")

    def test_an_unwritable_file_is_noticed_before_planning(self):
        # Planning would take minutes.
        long = ("--ds", "0.0005", "--dphi", "0.002", "--planner", "eager_dp")
        start = time.monotonic()
        for option in ("--trace", "--map-svg", "--json"):
            self.is_refused(
                self.plan_files(
                    options=(*long, option, self.folder / "nowhere" / "x")
                    if option != "--json"
                    else long,
                    json=self.folder / "nowhere" / "x",
                ),
                "nowhere/x",
                option,
            )
        self.assertLess(time.monotonic() - start, 20)

    def test_failing_standard_output(self):
        def closed():
            os.close(1)

        trajectory = self.folder / "solved.csv"
        self.assertEqual(run("plan", SOLVED, *QUICK, "--out", trajectory, "--quiet").returncode, 0)
        info = ("info", DATA / "robots/iiwa14.urdf", "--base", "base_link", "--tip", "tool0")
        commands = [
            ("plan", SOLVED, *QUICK, "--out", self.old, "--json", self.json),
            ("plan", SOLVED, *QUICK, "--out", self.old, "--json", "-"),
            info,
            ("check", SOLVED, trajectory),
            (*CAMPAIGN, "--episodes", "2", "--json", self.json),
            ("--help",),
            ("plan", "--help"),
            ("--version",),
        ]
        for command in commands:
            command = list(map(str, (SWIVEL, *command)))
            with self.subTest(command=command), open("/dev/full", "w") as full:
                self.is_refused(
                    subprocess.run(command, stdout=full, stderr=subprocess.PIPE, text=True)
                )
                self.is_refused(
                    subprocess.run(command, stderr=subprocess.PIPE, text=True, preexec_fn=closed)
                )
                # A reader that has left, as head does, ends it as it ends any other program:
                # silently.
                reader, writer = os.pipe()
                os.close(reader)
                done = subprocess.run(command, stdout=writer, stderr=subprocess.PIPE, text=True)
                os.close(writer)
                self.assertEqual(done.returncode, -signal.SIGPIPE)
                self.assertEqual(
                    [line for line in done.stderr.splitlines() if "warning" not in line], []
                )
                self.nothing_written()
        # What prints nothing needs no standard output.
        done = subprocess.run(
            [SWIVEL, "plan", str(SOLVED), *QUICK, "--quiet", "--out", str(self.old)],
            stderr=subprocess.PIPE,
            text=True,
            preexec_fn=closed,
        )
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        self.assertEqual(self.old.read_bytes(), trajectory.read_bytes())

    def test_head_ends_long_output_silently(self):
        """What is printed is more than a buffer, so that the write that fails is not the last
        one."""
        for command in (
            ("schema", "problem"),
            ("info", SOLVED, "--pairs"),
            ("plan", SOLVED, *QUICK, "--map"),
            ("plan", SOLVED, *QUICK, "--json", "-"),
        ):
            reader, writer = os.pipe()
            process = subprocess.Popen(
                list(map(str, (SWIVEL, *command))), stdout=writer, stderr=subprocess.PIPE, text=True
            )
            os.close(writer)
            os.close(reader)
            self.assertEqual(
                [line for line in process.communicate()[1].splitlines() if "warning" not in line],
                [],
                command,
            )
            self.assertEqual(process.returncode, -signal.SIGPIPE, command)

    def test_all_standard_streams_closed(self):
        def closed():
            os.closerange(0, 3)

        done = subprocess.run(
            [SWIVEL, "plan", str(SOLVED), *QUICK, "--out", str(self.old), "--json", str(self.json)],
            preexec_fn=closed,
        )
        self.assertEqual(done.returncode, 2)
        self.nothing_written()  # no summary in them either

    def device(self, major, minor):
        device = self.folder / "device"
        try:
            os.mknod(device, stat.S_IFCHR | 0o666, os.makedev(major, minor))
        except PermissionError:
            self.skipTest("only root may make devices")
        return device

    def test_device(self):
        null = self.device(1, 3)
        for problem, code in ((SOLVED, 0), (NO_PATH, 1)):
            self.assertEqual(self.plan_files(problem, out=null).returncode, code)
            self.assertTrue(stat.S_ISCHR(null.stat().st_mode))
        self.assertEqual(run("plan", NO_PATH, *QUICK, "--out", null, "--json", null).returncode, 1)
        self.assertTrue(stat.S_ISCHR(null.stat().st_mode))

    def test_full_device(self):
        full = self.device(1, 7)
        self.is_refused(self.plan_files(out=full), "--out", "No space left")
        self.assertTrue(stat.S_ISCHR(full.stat().st_mode))

    def test_standard_output_by_name(self):
        for name in ("-", "/dev/stdout"):
            out = run("plan", SOLVED, *QUICK, "--out", name)
            self.assertEqual(
                (out.returncode, out.stdout.splitlines()[0][:13]), (0, "s,phi,branch,")
            )
            self.assertEqual(len(out.stdout.splitlines()), 27)  # and no summary
        into = self.folder / "stdout.txt"
        with into.open("w") as file:
            subprocess.run(
                [SWIVEL, "plan", str(SOLVED), *QUICK, "--json", "/dev/stdout"],
                stdout=file,
                check=True,
            )
        self.assertEqual(json.loads(into.read_text())["status"], "solved")

    def test_pipe(self):
        pipe = self.folder / "pipe"
        os.mkfifo(pipe)
        self.assertEqual(self.plan_files(NO_PATH, out=pipe).returncode, 1)
        self.assertTrue(stat.S_ISFIFO(pipe.stat().st_mode))
        read = []
        reader = threading.Thread(target=lambda: read.append(pipe.read_text()))
        reader.start()
        self.assertEqual(self.plan_files(out=pipe).returncode, 0)
        reader.join()
        self.assertTrue(stat.S_ISFIFO(pipe.stat().st_mode))
        self.assertEqual(len(read[0].splitlines()), 27)

    def test_link(self):
        link = self.folder / "link.csv"
        (self.folder / "sub").mkdir()
        target = self.folder / "sub" / "target.csv"
        target.write_text("old")
        link.symlink_to(pathlib.Path("sub") / "target.csv")
        self.assertEqual(self.plan_files(NO_PATH, out=link).returncode, 1)
        self.assertFalse(target.exists())  # what it pointed to was stale
        self.assertTrue(link.is_symlink())
        # The answer comes back through the link.
        self.assertEqual(self.plan_files(out=link).returncode, 0)
        self.assertTrue(link.is_symlink())
        self.assertEqual(len(target.read_text().splitlines()), 27)
        self.nothing_beside()

    def test_link_to_nothing(self):
        link = self.folder / "link.csv"
        link.symlink_to("nowhere/target.csv")
        self.is_refused(self.plan_files(out=link), "--out", "nowhere/target.csv")
        self.assertTrue(link.is_symlink())
        loop = self.folder / "loop.csv"
        loop.symlink_to("loop.csv")
        self.is_refused(self.plan_files(out=loop), "--out", "symbolic links")

    def test_folder(self):
        folder = self.folder / "empty"
        folder.mkdir()
        for problem in (SOLVED, NO_PATH):
            self.is_refused(self.plan_files(problem, out=folder), "--out", "is a folder")
            self.assertTrue(folder.is_dir())

    def test_permissions_stay(self):
        self.old.chmod(0o600)
        self.assertEqual(self.plan_files().returncode, 0)
        self.assertEqual(stat.S_IMODE(self.old.stat().st_mode), 0o600)

    def test_twice(self):
        new, link, hard = (self.folder / name for name in ("new.csv", "folder", "hard.csv"))
        link.symlink_to(".")
        os.link(self.old, hard)
        for out, other in (
            (self.old, self.old),
            (self.old, f"{self.folder}/./{self.old.name}"),
            (self.old, link / self.old.name),
            (hard, self.old),
            (new, link / "new.csv"),
        ):
            with self.subTest(out=out, other=other):
                self.is_refused(
                    run("plan", SOLVED, *QUICK, "--out", out, "--json", other),
                    "--json", "the file of --out as well"
                )
                self.assertFalse(new.exists())
        self.is_refused(
            run(*CAMPAIGN, "--episodes", "1", "--out", new, "--json", f"{new}.part"), "--json",
            "--out as well"
        )

    @staticmethod
    def why(option, name):
        return (
            "would be in it as CSV"
            if option == "--out" and name.suffix == ".yaml"
            else "one of the files that are read"
        )

    def test_an_output_that_is_an_input(self):
        for folder in ("robots", "meshes", "paths", "problems"):
            shutil.copytree(DATA / folder, self.folder / folder)
        problem = self.folder / "problems/experiment_c.yaml"
        inputs = [
            problem,
            *(
                self.folder / name
                for name in (
                    "robots/sda5f.urdf", "robots/sda5f.srdf", "meshes/door_2k.stl",
                    "paths/door_polish.csv"
                )
            ),
        ]
        before = [file.read_bytes() for file in inputs]
        for k, file in enumerate(inputs):
            (self.folder / f"soft{k}").symlink_to(file)
            os.link(file, self.folder / f"hard{k}")
            names = [
                file, self.folder / "problems/../problems/.." / file.relative_to(self.folder),
                self.folder / f"soft{k}", self.folder / f"hard{k}"
            ]
            for option, name in zip(("--out", "--json", "--map-svg", "--trace"), names):
                with self.subTest(option=option, name=name):
                    self.is_refused(
                        run("plan", problem, *QUICK, option, name), option, self.why(option, name)
                    )
            for option in ("--out", "--json"):
                self.is_refused(
                    run("campaign", problem, "--episodes", "1", *QUICK, option, file), option,
                    self.why(option, file)
                )
        self.assertEqual(before, [file.read_bytes() for file in inputs])
        path = self.folder / "paths/episode_0.csv"
        shutil.copy(self.folder / "paths/door_polish.csv", path)
        problem.write_text(problem.read_text().replace("door_polish.csv", "episode_0.csv"))
        self.is_refused(
            run(
                "campaign", problem, "--episodes", "1", *QUICK,
                "--trajectories", self.folder / "paths"
            ),
            "--trajectories",
            "episode_0.csv",
        )
        self.assertEqual(path.read_bytes(), before[-1])

    def stopped(self, number):
        """Killed while it plans, which takes a minute."""
        with subprocess.Popen(
            [
                SWIVEL, "plan", str(PROBLEMS / "experiment_c.yaml"), "--planner", "eager_dp",
                "--ds", "0.0005", "--dphi", "0.005", "--threads", "1", "--out", str(self.old),
                "--json", str(self.json)
            ],
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        ) as process:
            time.sleep(0.4)
            self.assertIsNone(process.poll())
            process.send_signal(number)
            _, errors = process.communicate(timeout=60)
        self.nothing_beside()
        return process.returncode, errors

    def test_interrupt(self):
        code, errors = self.stopped(signal.SIGINT)
        self.assertEqual(code, 3)
        self.assertFalse(self.old.exists())
        self.assertIn("removed the earlier", errors)
        self.assertEqual(json.loads(self.json.read_text())["status"], "cancelled")

    def test_terminate(self):
        code, _ = self.stopped(signal.SIGTERM)
        self.assertIn(code, (3, -signal.SIGTERM))

    def test_kill(self):
        self.assertEqual(self.stopped(signal.SIGKILL)[0], -signal.SIGKILL)
        self.nothing_written()
        self.assertEqual(self.plan_files().returncode, 0)  # the next run is as any other
        self.assertEqual(len(self.old.read_text().splitlines()), 27)
        self.nothing_beside()


class Outputs(WithFiles):
    """The same for campaigns."""

    def campaign(self, *options, episodes="3", **how):
        return subprocess.run(
            [SWIVEL, *map(str, CAMPAIGN), "--episodes", episodes, *map(str, options)],
            capture_output=True,
            text=True,
            timeout=60,
            **how,
        )

    def test_all_or_none(self):
        out = self.folder / "rows.csv"
        out.write_text("old")
        self.is_refused(
            self.campaign("--out", out, "--json", self.folder / "nowhere" / "r.json"),
            "--json", "nowhere"
        )
        self.assertEqual(out.read_text(), "old")
        self.assertFalse((self.folder / "rows.csv.part").exists())
        self.is_refused(
            self.campaign(
                "--out", out,
                preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (100, 100))
            ),
            "rows.csv.part",
            "File too large",
        )
        self.assertEqual(out.read_text(), "old")
        done = self.campaign("--out", out)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(out.read_text().splitlines()[0][:8], "episode,")

    def test_earlier_trajectories_of_episodes_without_a_path(self):
        folder = self.folder / "trajectories"
        folder.mkdir()
        for k in range(12):
            (folder / f"episode_{k}.csv").write_text("old")
        done = self.campaign("--trajectories", folder, "--json", "-", episodes="12")
        failed = json.loads(done.stdout)["infeasible"]
        self.assertGreater(failed, 0)
        self.assertEqual(
            done.stderr,
            f"swivel: removed {failed} earlier trajectories in {folder}: there is no path now\n",
        )
        self.assertEqual(len(list(folder.iterdir())), 12 - failed)


class Errors(WithFiles):
    """Bugs, injected."""

    def setUp(self):
        super().setUp()
        self.library = os.environ.get("SWIVEL_FAULT", "")
        if not self.library:
            self.skipTest("no faults can be injected into this build")

    def faulty(self, *arguments):
        """With the largest power of two from which on allocations fail that has an effect."""
        for power in range(26, 12, -1):
            environment = {
                **os.environ, "LD_PRELOAD": self.library, "SWIVEL_FAULT_BYTES": str(1 << power)
            }
            done = subprocess.run(
                [SWIVEL, *map(str, arguments)],
                capture_output=True,
                text=True,
                timeout=60,
                env=environment,
            )
            if done.returncode != 0:
                return done
            for file in (self.old, self.json):
                file.write_text("old")
        self.fail("no fault had an effect")

    EAGER = (*QUICK, "--planner", "eager", "--threads", "1")

    def test_plan(self):
        done = self.faulty("plan", SOLVED, *self.EAGER, "--out", self.old, "--json", self.json)
        self.assertEqual(done.returncode, 5, done.stderr)
        self.assertEqual(
            done.stderr,
            (
                f"swivel: removed the earlier {self.old}: there is no answer now\n"
                "swivel: internal error: injected\n"
            ),
        )
        self.assertEqual(
            json.loads(self.json.read_text()),
            {"schema_version": 1, "status": "error", "message": "injected"},
        )
        self.nothing_beside()
        done = self.faulty("plan", SOLVED, *self.EAGER, "--json", "-")
        self.assertEqual((done.returncode, json.loads(done.stdout)["status"]), (5, "error"))

    def test_an_error_of_advice_costs_no_answer(self):
        """Half the steps need more memory than the plan: the largest fault is in the advice."""
        problem = self.folder / "barred.yaml"
        problem.write_text(
            cli_test.BadInput.BASE.format(data=DATA)
            .replace("clearance: 0.005", "clearance: 0.005, joint_margin: 1.5")
            .replace("ds: 0.02, dphi: 0.2", "ds: 0.005, dphi: 0.05")
        )
        plain = subprocess.run(
            [SWIVEL, "plan", problem], capture_output=True, text=True, timeout=60
        )
        self.assertEqual(plain.returncode, 1, plain.stdout + plain.stderr)
        for power in range(32, 12, -1):
            environment = {
                **os.environ, "LD_PRELOAD": self.library, "SWIVEL_FAULT_BYTES": str(1 << power)
            }
            done = subprocess.run(
                [SWIVEL, "plan", problem, "--advise", "5", "--json", self.json],
                capture_output=True, text=True, timeout=60, env=environment
            )
            if "injected" in done.stderr:
                break
        self.assertEqual(done.returncode, 1, done.stderr)
        self.assertEqual(
            [line for line in done.stderr.splitlines() if "injected" in line],
            ["swivel: warning: --advise: ended by an error, there is no advice: injected"],
        )
        self.assertEqual(done.stdout.splitlines()[0], plain.stdout.splitlines()[0])
        result = json.loads(self.json.read_text())
        self.assertEqual((result["status"], result["advice"]), ("infeasible", None))

    def test_campaign(self):
        problem, out = self.folder / "problem.yaml", self.folder / "rows.csv"
        problem.write_text(
            cli_test.BadInput.BASE.format(data=DATA)
            + "vary: [{object: post, xyz: [0.1, 0.1, 0.1]}]\n"
        )
        done = self.faulty(
            "campaign", problem, "--episodes", "6", *self.EAGER, "--out", out, "--json", self.json
        )
        self.assertEqual(done.returncode, 5, done.stderr)
        rows = [line.split(",") for line in out.read_text().splitlines()[1:]]
        self.assertEqual([row[0] for row in rows], [str(k) for k in range(6)])
        errors = [row for row in rows if row[1] == "error"]
        self.assertGreater(len(errors), 0)
        self.assertEqual({row[11] for row in errors}, {"injected"})
        failures = "".join(
            line + "\n" for line in done.stderr.splitlines() if "warning: " not in line
        )
        self.assertEqual(
            failures,
            (
                f"swivel: internal error in {len(errors)} episodes, the first in episode "
                f"{errors[0][0]}: injected\n"
            ),
        )
        self.assertEqual(json.loads(self.json.read_text())["errors"], len(errors))
        self.assertFalse((self.folder / "rows.csv.part").exists())

    def test_nothing_of_other_libraries(self):
        for threads in ("3", "40"):
            done = run("plan", SOLVED, *QUICK, "--threads", threads)
            self.assertEqual((done.returncode, done.stderr), (0, ""))
        self.assertEqual(run("plan", SOLVED, "--threads", "1025").returncode, 2)

    def test_library_messages_do_not_speak_of_options(self):
        done = run("plan", SOLVED, "--planner", "eager", "--ds", "1e-5", "--dphi", "0.005")
        self.assertEqual(done.returncode, 2)
        self.assertRegex(
            done.stderr,
            (
                r"^swivel: .*experiment_a.yaml: planner eager: its graph would need about \d+ GB: "
                "allowed are .*eager_dp"
            ),
        )
        self.assertRegex(
            run("plan", SOLVED, "--planner", "magic").stderr,
            "^swivel: --planner: unknown planner 'magic': allowed are eager, ",
        )
        for file in (pathlib.Path(__file__).parents[2]).glob("*/src/*.cpp"):
            self.assertIsNone(
                re.search(r'InputError\([^;]*"[^"\n]*--[a-z]', file.read_text()), file
            )


if __name__ == "__main__":
    unittest.main(verbosity=1)

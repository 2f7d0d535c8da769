#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Shards as tasks of Slurm job arrays: a controller and a node of their own on this machine, a task
that is killed in the middle.

SWIVEL is the program, SWIVEL_DATA the data folder, SWIVEL_EXAMPLES has cluster/shards.sbatch. Exit
code 77: not tried.
"""
import getpass
import os
import re
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import time
import unittest
from pathlib import Path

SWIVEL, DATA, EXAMPLES = (
    Path(os.environ[name]).resolve() for name in ("SWIVEL", "SWIVEL_DATA", "SWIVEL_EXAMPLES")
)
PROBLEM = DATA / "problems/experiment_c.yaml"
SCRIPT = EXAMPLES / "cluster/shards.sbatch"
os.environ["PATH"] += ":/usr/sbin"


def free_port():
    with socket.socket() as found:
        found.bind(("127.0.0.1", 0))
        return found.getsockname()[1]


def wait_for(what, seconds, words):
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        if found := what():
            return found
        time.sleep(0.05)
    raise AssertionError(f"{words}: not within {seconds} s")


class Slurm:
    """munged, slurmctld and slurmd of this user, with sockets, ports and state of their own."""

    def __init__(self, folder):
        self.folder, self.daemons, self.environment = folder, [], {}

    def begin(self):
        folder = self.folder
        host, user = socket.gethostname().split(".")[0], getpass.getuser()
        key, sock = folder / "munge.key", folder / "munge.sock"
        folder.chmod(0o755)  # munged wants no folder that others could write to
        key.write_bytes(os.urandom(128))
        key.chmod(0o400)
        for name in ("state", "spool"):
            (folder / name).mkdir()
        self.conf = folder / "slurm.conf"
        self.conf.write_text(
            f"""ClusterName=swivel
SlurmctldHost={host}(127.0.0.1)
SlurmctldPort={free_port()}
SlurmdPort={free_port()}
SlurmUser={user}
SlurmdUser={user}
AuthType=auth/munge
AuthInfo=socket={sock}
CredType=cred/munge
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd.pid
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SwitchType=switch/none
MpiDefault=none
ReturnToService=2
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
SchedulerParameters=sched_interval=1
KillWait=2
NodeName={host} NodeAddr=127.0.0.1 CPUs={os.cpu_count()} State=UNKNOWN
PartitionName=all Nodes=ALL Default=YES State=UP
"""
        )
        self.environment = {
            **os.environ, "SLURM_CONF": str(self.conf),
            "PATH": f"{SWIVEL.parent}:{os.environ['PATH']}"
        }
        del self.environment["SWIVEL"]
        self.start(
            "munged", "--foreground", f"--key-file={key}", f"--socket={sock}",
            f"--pid-file={folder}/munged.pid", f"--log-file={folder}/munged.log",
            f"--seed-file={folder}/munge.seed"
        )
        wait_for(sock.exists, 10, "munged's socket")
        self.start("slurmctld", "-D", "-c", "-f", self.conf)
        self.start("slurmd", "-D", "-f", self.conf, "-N", host)
        wait_for(
            lambda: "idle" in self.said("sinfo", "--noheader", "--format=%t", check=False),
            30,
            "an idle node",
        )

    def start(self, *command):
        with (self.folder / f"{command[0]}.out").open("wb") as log:
            self.daemons.append(
                subprocess.Popen(
                    list(map(str, command)), stdin=subprocess.DEVNULL, stdout=log, stderr=log,
                    env=self.environment
                )
            )

    def stop(self):
        for daemon in reversed(self.daemons):
            daemon.terminate()
            try:
                daemon.wait(10)
            except subprocess.TimeoutExpired:
                daemon.kill()

    def said(self, *command, check=True):
        done = subprocess.run(
            list(map(str, command)), capture_output=True, text=True, env=self.environment,
            cwd=self.folder, timeout=120
        )
        if check and done.returncode:
            raise AssertionError(done.stdout + done.stderr)
        return done.stdout.strip()

    def array(self, tasks, *arguments, export="ALL"):
        """Its number."""
        return self.said(
            "sbatch", "--parsable", f"--export={export}", f"--array={tasks}", SCRIPT, *arguments
        )

    def states(self, job):
        """Task -> state."""
        text = self.said(
            "squeue", "--noheader", "--array", "--states=all", "--format=%K %T", "--jobs", job
        )
        return dict(line.split() for line in text.splitlines())

    def ended(self, job):
        def all_ended():
            states = self.states(job)
            return (
                states
                if states
                and not set(states.values()) & {"PENDING", "RUNNING", "COMPLETING", "CONFIGURING"}
                else None
            )

        return wait_for(all_ended, 240, f"the end of job {job}")


def without_times(text):
    return [[*line.split(",")[:3], *line.split(",")[4:]] for line in text.splitlines()]


class JobArrays(unittest.TestCase):
    def setUp(self):
        self.folder = slurm.folder

    def swivel(self, *arguments, code=0):
        done = subprocess.run(
            [SWIVEL, *map(str, arguments)],
            capture_output=True,
            text=True,
            cwd=self.folder,
            timeout=300,
        )
        self.assertEqual(done.returncode, code, done.stdout + done.stderr)
        return done

    def test_a_campaign_whose_task_is_killed(self):
        # So many that a task is under way when it is killed, on machines of any speed.
        command = [
            "campaign", PROBLEM, "--episodes", 1200, "--seed", 7, "--planner", "lazy", "--ds", 0.01,
            "--dphi", 0.1
        ]
        job = slurm.array("2-5", *command)
        files = [self.folder / f"shards_{job}/{task}.csv" for task in range(2, 6)]
        part = Path(f"{files[1]}.part")
        wait_for(lambda: part.exists() and part.read_text().count("\n") > 20, 120, "rows of task 3")
        ours = [
            int(entry.name)
            for entry in Path("/proc").iterdir()
            if entry.name.isdigit()
            and os.fsencode(files[1].relative_to(self.folder)) in arguments_of(entry)
            and os.fsencode(SWIVEL) == arguments_of(entry)[0]
        ]
        self.assertEqual(len(ours), 1, ours)
        os.kill(ours[0], signal.SIGKILL)
        states = slurm.ended(job)
        self.assertEqual(
            states, {"2": "COMPLETED", "3": "FAILED", "4": "COMPLETED", "5": "COMPLETED"}
        )
        self.assertEqual([file.exists() for file in files], [True, False, True, True])
        rows = part.read_text()[: part.read_text().rindex("\n") + 1]
        known = rows.count("\n") - 2
        self.assertTrue(20 <= known < 300, known)
        gap = self.swivel("merge", "results.csv", files[0], *files[2:], code=2)
        self.assertIn("shard 1/4: missing: 3 of 4 are given", gap.stderr)
        self.assertFalse((self.folder / "results.csv").exists())
        slurm.said("scontrol", "requeue", f"{job}_3")
        # Slurm lets it wait for two minutes.
        slurm.said("scontrol", "update", f"JobId={job}_3", "StartTime=now")
        wait_for(lambda: slurm.states(job)["3"] != "FAILED", 60, "the task's return")
        self.assertEqual(set(slurm.ended(job).values()), {"COMPLETED"})
        self.assertFalse(part.exists())
        # It went on after the rows that were there, times and all.
        self.assertEqual(files[1].read_text().splitlines()[1 : known + 2], rows.splitlines()[1:])
        summary = self.swivel("merge", "results.csv", *files).stdout
        self.swivel(*command, "--out", "serial.csv")
        serial, merged = (
            (self.folder / name).read_text() for name in ("serial.csv", "results.csv")
        )
        self.assertEqual(len(serial.splitlines()), 1201)
        self.assertEqual(without_times(merged), without_times(serial))
        self.assertIn("1200 of 1200 episodes answered", summary)
        print(f"task 3 killed after {known} of 300 rows")

    def test_placements(self):
        command = [
            "place", PROBLEM, "--object", "door", "--x", "-0.1:0.1:0.01", "--y", "-0.1:0.1:0.01",
            "--planner", "lazy", "--ds", 0.02, "--dphi", 0.2
        ]
        job = slurm.array("1-7:2", *command, export=f"ALL,SWIVEL={SWIVEL}")
        self.assertEqual(slurm.ended(job), {task: "COMPLETED" for task in "1357"})
        files = sorted((self.folder / f"shards_{job}").iterdir())
        self.assertEqual([file.name for file in files], ["1.csv", "3.csv", "5.csv", "7.csv"])
        told = self.swivel("merge", "results.csv", *files, "--svg", "map.svg").stdout
        serial = self.swivel(*command, "--out", "serial.csv", "--svg", "serial.svg").stdout
        for merged, whole in (("results.csv", "serial.csv"), ("map.svg", "serial.svg")):
            self.assertEqual(
                (self.folder / merged).read_bytes(), (self.folder / whole).read_bytes()
            )
        self.assertEqual(told, re.sub("; [0-9.]+ s, [0-9]+ a second", "", serial))


def arguments_of(process):
    try:
        return (process / "cmdline").read_bytes().split(b"\0")
    except OSError:
        return [b""]


if __name__ == "__main__":
    missing = [
        name
        for name in ("munged", "slurmctld", "slurmd", "sbatch", "scontrol")
        if shutil.which(name) is None
    ]
    if missing:
        print(f"skipped: without {', '.join(missing)} (Debian: slurm-wlm, munge)")
        sys.exit(77)
    with tempfile.TemporaryDirectory() as place:
        slurm = Slurm(Path(place))
        try:
            slurm.begin()
        except (AssertionError, OSError) as error:
            print(f"skipped: Slurm's daemons do not start here: {error}")
            for log in sorted(Path(place).glob("*.out")):
                print(log.name, *log.read_text(errors="replace").splitlines()[-3:], sep="\n  ")
            slurm.stop()
            sys.exit(77)
        try:
            passed = unittest.main(exit=False, verbosity=2).result.wasSuccessful()
        finally:
            slurm.stop()
    sys.exit(not passed)

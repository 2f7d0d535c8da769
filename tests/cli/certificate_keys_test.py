#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Certificates, key by key: whatever a certificate states is verified, so that no key of it can be
changed, left out or added unnoticed."""
import copy
import json
import os
import pathlib
import random
import subprocess
import tempfile
import unittest

import job_test
import workcell_test

SWIVEL = os.environ["SWIVEL"]
DATA = pathlib.Path(os.environ["SWIVEL_DATA"])


def run(*arguments):
    return subprocess.run(
        [SWIVEL, *map(str, arguments)], capture_output=True, text=True, timeout=300
    )


def places(value, at=()):
    """All places of a JSON value, the value itself first."""
    yield at
    if isinstance(value, (dict, list)):
        for key, part in value.items() if isinstance(value, dict) else enumerate(value):
            yield from places(part, (*at, key))


def kind_of(place):
    """The place without the numbers of list entries."""
    return ".".join("*" if isinstance(key, int) else key for key in place)


def changes_of(value):
    """What a value may be changed to."""
    if isinstance(value, bool):
        return [not value]
    if isinstance(value, int):
        return [value + 1] + ([value - 1] if value > 0 else [])
    if isinstance(value, float):
        return [value * 1.5]
    if isinstance(value, str):
        return [value + "x", ""]
    if isinstance(value, dict):
        return [{**value, "more": 1}] + [
            {key: part for key, part in value.items() if key != left} for left in value
        ]
    return [value[:-1], value + value[-1:]] if value else [[[0]]]


def may_be(kind, value, changed):
    """Whether a certificate with such a change may prove the same."""
    if kind == "arms.*.windings":  # of a joint of just a turn, which has no other
        return True
    if kind.endswith("layers.*.layer"):  # nothing may lead through other layers, too
        return True
    return kind.endswith("region") and changed.keys() < value.keys()  # `bodies` may be missing


def is_more_nodes(place, value, changed):
    """Whether a run of nodes, from the first to the last, gets one more, which may fail alike."""
    if kind_of(place[:-1]).endswith("layers.*.nodes.*"):
        return place[-1] == 0 and changed < value or place[-1] == 1 and changed > value
    return False


class CertificateKeys(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def all_keys_are_verified(self, problem, least, *options):
        file, other = self.folder / "proof.json", self.folder / "forged.json"
        done = run("plan", problem, *options, "--certificate", file)
        self.assertEqual(done.returncode, 1, done.stdout + done.stderr)
        told = json.loads(file.read_text())
        done = run("check", problem, *options, "--certificate", file)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        by_kind = {}
        for place in places(told):
            by_kind.setdefault(kind_of(place), []).append(place)
        chance = random.Random(1)
        tried = 0
        for kind, all_of_kind in by_kind.items():
            for place in chance.sample(all_of_kind, min(2, len(all_of_kind))):
                value = told
                for key in place:
                    value = value[key]
                for changed in changes_of(value):
                    if may_be(kind, value, changed) or is_more_nodes(place, value, changed):
                        continue
                    forged = copy.deepcopy(told)
                    if place:
                        parent = forged
                        for key in place[:-1]:
                            parent = parent[key]
                        parent[place[-1]] = changed
                    else:
                        forged = changed
                    other.write_text(json.dumps(forged))
                    done = run("check", problem, *options, "--certificate", other)
                    tried += 1
                    self.assertIn(
                        done.returncode, (1, 2), f"{kind}: {place}: {value} -> {changed}"[:400]
                    )
        self.assertGreaterEqual(tried, least)  # more than a few keys were there

    def path_is_verified(self, name, least, **changes):
        line = job_test.one_job()
        problem = {key: line[key] for key in ("robot", "resolution")}
        file = self.folder / f"{name}.yaml"
        file.write_text(json.dumps({**problem, "path": line["strokes"][0]["path"], **changes}))
        self.all_keys_are_verified(file, least)

    def test_of_a_path(self):
        wall = {"name": "wall", "box": [1, 0.02, 1], "xyz": [0.5, 0.1, 0.5]}
        self.path_is_verified("wall", 60, scene=[wall])
        self.path_is_verified("steps", 60, limits={"joint_step": 0.01})

    def test_of_a_stroke(self):
        job = job_test.one_job()
        for waypoint in job["strokes"][1]["path"]["waypoints"]:
            waypoint["xyz"][0] = 3
        file = self.folder / "job.yaml"
        file.write_text(json.dumps(job))
        self.all_keys_are_verified(file, 50)

    def test_of_a_workcell(self):
        file = self.folder / "cell.yaml"
        file.write_text(json.dumps(workcell_test.cell(gap=0.02)))
        self.all_keys_are_verified(file, 80)


if __name__ == "__main__":
    unittest.main()

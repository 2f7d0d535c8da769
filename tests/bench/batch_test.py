# SPDX-License-Identifier: BSD-3-Clause
"""Plans of many problems: batch_benchmark, whose ways of planning must have the same answers, and
the table that is made of its file."""
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

sys.path.insert(0, str(pathlib.Path(os.environ["SWIVEL_SOURCE"]) / "bench/evidence"))
import many_plans
from measured_runs import MeasuredRuns

# Only the release build has benchmarks.
PROGRAM = os.environ.get("BATCH_BENCHMARK")
# Every way of planning on one and two threads; of `pipe`, which takes longest, one row.
FILTER = r"^((doors|obstacles|starts|seam)/.*/threads:[12]|pipe/plan_many/threads:2)/"


def name_of(row):
    return row["run_name"].removesuffix("/process_time/real_time")


def cells(line):
    return line.strip("| ").split(" | ")


@unittest.skipUnless(PROGRAM, "benchmarks are not built")
class Program(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.done = subprocess.run(
            [
                PROGRAM, f"--benchmark_filter={FILTER}", "--benchmark_min_time=0.01",
                "--benchmark_format=json"
            ], capture_output=True, text=True
        )
        rows = json.loads(cls.done.stdout)["benchmarks"] if cls.done.returncode == 0 else []
        cls.rows = {name_of(row): row for row in rows}

    def setUp(self):
        self.assertEqual(self.done.returncode, 0, self.done.stdout + self.done.stderr)

    def test_every_way_has_a_row(self):
        expected = {"pipe/plan_many/threads:2"}
        for name in ("doors", "obstacles", "starts", "seam"):
            ways = ["plan", "planner", "plan_many"] + ["campaign"] * (name == "doors")
            expected |= {f"{name}/{way}/threads:{n}" for way in ways for n in (1, 2)}
            expected.add(f"{name}/eager/threads:1")
        self.assertEqual(set(self.rows), expected)

    def test_all_ways_have_the_same_answers(self):
        hashes = {}
        for name, row in self.rows.items():
            self.assertNotIn("error_occurred", row, name)
            self.assertGreater(row["solved"], 0, name)
            self.assertRegex(row["label"], "^answers [0-9a-f]{16}$")
            hashes.setdefault((name.split("/")[0], row["problems"]), set()).add(row["label"])
        for key, found in hashes.items():
            self.assertEqual(len(found), 1, key)
        self.assertEqual(len({*map(frozenset, hashes.values())}), len(hashes), "sets are alike")

    def test_a_lattice_that_is_shared_is_made_once(self):
        plan, many = (
            self.rows[f"seam/{way}/threads:1"]["plans_per_cpu_s"] for way in ("plan", "plan_many")
        )
        self.assertGreater(many, 1.4 * plan)

    def test_table(self):
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder) / "batch.json"
            file.write_text(self.done.stdout)
            header, _, *lines = many_plans.batch(file.parent).splitlines()
        self.assertEqual(cells(header), [*many_plans.HEADER])
        rows = {cells(line)[0]: cells(line)[1:] for line in lines}
        self.assertEqual(list(rows), [f"`{name}`" for name in many_plans.SETS])
        for name, row in rows.items():
            self.assertEqual(len(row), len(many_plans.HEADER) - 1)
            if name != "`pipe`":
                self.assertNotIn("–", row, name)
        # Of `pipe` only plan_many() on two threads was run, which sleeps are taken from.
        known = [name for name, cell in zip(many_plans.HEADER[1:], rows["`pipe`"]) if cell != "–"]
        self.assertEqual(known, ["sleeps a plan"])


def row(name, **counters):
    return {
        "run_type": "iteration", "run_name": f"{name}/process_time/real_time", "real_time": 1,
        **counters
    }


class Table(MeasuredRuns):
    FILE = "batch.json"

    def test_medians_and_ratios(self):
        self.write(
            *(row("seam/plan/threads:1", plans_per_cpu_s=x) for x in (100, 160, 9000)),
            *(
                row("seam/plan_many/threads:1", plans_per_cpu_s=x, plans_per_s=0.9 * x, sleeps=7)
                for x in (600, 1000, 1200)
            ),
            row("seam/plan_many/threads:2", plans_per_cpu_s=950, plans_per_s=1710, sleeps=0.25),
            row("seam/eager/threads:1", plans_per_cpu_s=4)
        )
        table = many_plans.batch(self.data)
        self.assertEqual(
            table.splitlines()[2:],
            ["| `seam` | 160 | 1,000 | 6.2 | 1.90 | 0.25 | 4.00 | 250 |"],
        )

    def test_sets_are_in_order_and_may_lack_rows(self):
        self.write(
            row("seam/eager/threads:1", plans_per_cpu_s=4),
            row("doors/plan/threads:1", plans_per_cpu_s=500)
        )
        self.assertEqual(
            many_plans.batch(self.data).splitlines()[2:],
            [
                "| `doors` | 500 | – | – | – | – | – | – |",
                "| `seam` | – | – | – | – | – | 4.00 | – |"
            ],
        )

    def test_where_nothing_was_measured(self):
        self.assertIsNone(many_plans.batch(self.data))
        self.write(row("a/lazy/#1/nodes"))
        self.assertIsNone(many_plans.batch(self.data))

    def test_filter_takes_the_rows_of_the_table_alone(self):
        for name in many_plans.SETS:
            for way in ("plan/threads:1", "plan_many/threads:2", "eager/threads:1"):
                self.assertTrue(
                    re.search(many_plans.FILTER, f"{name}/{way}/process_time/real_time"), way
                )
            for way in ("plan/threads:16", "planner/threads:1", "campaign/threads:2"):
                self.assertFalse(
                    re.search(many_plans.FILTER, f"{name}/{way}/process_time/real_time"), way
                )


unittest.main()

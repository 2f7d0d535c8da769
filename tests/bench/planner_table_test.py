# SPDX-License-Identifier: BSD-3-Clause
"""The table of planners, made of a file as google-benchmark writes it."""
import json
import os
import pathlib
import re
import sys
import unittest

sys.path.insert(0, str(pathlib.Path(os.environ["SWIVEL_SOURCE"]) / "bench/evidence"))
import planner_table
import tables
from measured import Benchmarks
from measured_runs import MeasuredRuns


def row(name, plan_ms, speed_up=None, calls=0, **counters):
    entry = {
        "run_type": "iteration", "run_name": name + "/real_time", "real_time": plan_ms + 1,
        "plan_ms": plan_ms, "nodes": 9472, "nodes_checked": 1000, "edges_checked": 25,
        "fcl_calls": calls, "solved": 1, **counters
    }
    return {**entry, "speed_up_over_eager": speed_up} if speed_up else entry


def not_run(name, words="not run: more than 60 s a plan"):
    return {
        "run_type": "iteration", "run_name": name + "/real_time", "error_occurred": True,
        "error_message": words, "real_time": 0
    }


class PlannerTable(MeasuredRuns):
    FILE = "plans.json"

    def test_medians_quartiles_and_what_was_not_run(self):
        self.write(
            *(row("b/eager/#1/nodes", ms, calls=12345) for ms in (17.0, 18.0, 40.0)),
            *(row("b/lazy/#1/nodes", 2.0, up, calls=1) for up in (8.0, 9.0, 10.0, 11.0, 30.0)),
            row("b/lazy_fcl_alone/#1/nodes", 4.0, 4.5),
            row("b/parallel/#1/nodes/threads:2", 1.5, 12.0),
            not_run("b/eager/#1/nodes/threads:2"),
            row("meshes/eager/#4/nodes", 7e3, solved=0),
            not_run("meshes/eager/#4/nodes", "not repeated: a plan takes seconds")
        )
        times, work = planner_table.planners(self.data).split("\n\n")
        self.assertEqual(
            times.splitlines()[2:],
            [
                (
                    "| B | #1 | 9,472 | 18.0 | not run: more than 60 s | 4.00: 4.5 (4.5–4.5) | "
                    "2.00: 10 (9.0–11) | 1.50: 12 (12–12) |"
                ),
                "| meshes | #4, no path | 9,472 | 7,000 | – | – | – | – |",
            ],
        )
        self.assertEqual(
            work.splitlines()[2],
            "| B | #1 | 9,472 | 1,025: 12,345 | – | 1,025: 0 | 1,025: 1 | 1,025: 0 |",
        )
        self.assertEqual(work.splitlines()[0].count("|"), times.splitlines()[0].count("|"))

    def test_times_of_a_row_are_those_beside_one_eager(self):
        self.write(
            row("a/eager/#1/nodes", 50.0),  # when the machine was busy
            *(row("a/lazy/#1/nodes", 2.0, up, eager_ms=20.0) for up in (9.0, 10.0, 11.0)),
            row("a/parallel/#1/nodes/threads:2", 3.0, 8.0, eager_ms=24.0)
        )
        times = planner_table.planners(self.data).split("\n\n")[0]
        self.assertEqual(
            times.splitlines()[2],
            "| A | #1 | 9,472 | 20.0 | – | – | 2.00: 10 (9.5–10) | 2.50: 8.0 (8.0–8.0) |",
        )

    def test_first_plans_beside_the_next(self):
        self.assertIsNone(tables.first_plans(self.data))
        runs = [
            {"load": "1.0", "prepare": "2.0", "first": first, "next": "0.5", "faults": "473"}
            for first in ("4.0", "5.0", "30.0")
        ]
        self.data.joinpath("first_plans.json").write_text(
            json.dumps([{"problem": "experiment_c", "runs": runs}])
        )
        self.assertEqual(
            tables.first_plans(self.data).splitlines()[2],
            "| `experiment_c` | 1.00 | 2.00 | 5.00 | 0.500 | 10 | 473 |",
        )

    def test_text_is_aligned(self):
        self.write(row("a/eager/#1/nodes", 17.0), row("c_20k/eager/#2/nodes", 1700.0))
        lines = planner_table.as_text(self.data).split("\n\n")[0].splitlines()
        self.assertEqual(
            len({line.index(word) for line, word in zip(lines[1:], ("17.0", "1,700"))}), 1
        )
        self.assertNotIn("`", lines[0])

    def test_where_nothing_was_measured(self):
        self.assertIsNone(planner_table.planners(self.data))
        self.write(row("micro", 1.0))
        self.assertIsNone(planner_table.planners(self.data))

    def test_other_tables_leave_out_rows_that_were_not_run(self):
        self.write(row("c/lazy/#1/nodes", 2.0, 8.0), not_run("c/eager/#1/nodes"))
        self.assertNotIn("c/eager/#1/nodes", Benchmarks(self.data / "plans.json").runs)
        self.assertIn("| `eager`, ms | – |", tables.plans(self.data))

    def test_a_counter_that_only_some_repetitions_have(self):
        self.write(row("c/lazy/#1/nodes", 2.0, 8.0), row("c/lazy/#1/nodes", 2.0))
        self.assertEqual(
            Benchmarks(self.data / "plans.json").get("c/lazy/#1/nodes", "speed_up_over_eager"), 8.0
        )

    def test_filter_takes_the_rows_of_the_table_alone(self):
        names = [
            name.format(scene, setting) + "/real_time"
            for name in planner_table.PLANNERS.values()
            for scene in planner_table.SCENES
            for setting in ("#1", "#4")
        ]
        for name in names:
            self.assertTrue(re.search(planner_table.FILTER, name), name)
        for name in (
            "c/lazy/fine/nodes/real_time", "c/lazy/#1/continuous/real_time",
            "c/eager_dp/#1/nodes/real_time", "c/parallel/#1/nodes/threads:1/real_time",
            "c/parallel/#1/continuous/threads:2/real_time",
            "c/parallel/#1/nodes/threads:20/real_time"
        ):
            self.assertFalse(re.search(planner_table.FILTER, name), name)


unittest.main()

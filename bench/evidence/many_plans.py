# SPDX-License-Identifier: BSD-3-Clause
"""How many plans a second are made of many problems of one robot, by set of problems: the table of
a file that batch_benchmark has written.

many_plans.py FILE.json    prints it
"""
import pathlib
import sys

from measured import Benchmarks
from words import markdown, number

SETS = ("doors", "obstacles", "starts", "seam", "pipe")
HEADER = (
    "set", "plans/s/core of `plan()`", "of `plan_many()`", "ratio",
    "2 threads over 1 (wall, `plan_many()`)", "sleeps a plan", "`eager`", "times `eager`"
)
# The rows of the table, for --benchmark_filter.
FILTER = rf"^({'|'.join(SETS)})/((plan|plan_many)/threads:[12]|eager/threads:1)/"


def ratio(a, b):
    """a / b; None where either is not known."""
    return None if a is None or b is None else a / b


def row_of(runs, name):
    """The cells of a set. Sleeps are those of plan_many() on two threads."""
    def counter(way, threads, key):
        return runs.get(f"{name}/{way}/threads:{threads}", key)

    plan, many, eager = (
        counter(way, 1, "plans_per_cpu_s") for way in ("plan", "plan_many", "eager")
    )
    threads = ratio(*(counter("plan_many", threads, "plans_per_s") for threads in (2, 1)))
    return [
        f"`{name}`", number(plan), number(many), number(ratio(many, plan), 2), number(threads),
        number(counter("plan_many", 2, "sleeps"), 2), number(eager), number(ratio(many, eager), 2)
    ]


def table(file):
    """Medians over the repetitions, one row for each set that was measured; None if none was."""
    runs = Benchmarks(file)
    rows = [row_of(runs, name) for name in SETS if runs.matching(f"{name}/.*")]
    return markdown(HEADER, rows) if rows else None


def batch(data):
    """For the documents."""
    return table(data / "batch.json")


def throughput(data):
    """Two lines for the README; None if its sets were not measured."""
    file = data / "batch.json"
    runs = Benchmarks(file)
    rates = [
        number(runs.get(f"{name}/plan_many/threads:{threads}", "plans_per_s"))
        for name in ("doors", "obstacles") for threads in (1, 2)
    ]
    if not runs.matching("(doors|obstacles)/plan_many/.*"):
        return None
    return (
        "Of [thousands of different problems](docs/performance.md#thousands-of-plans) "
        f"`plan_many()` plans and proves {rates[0]} doors a second\n"
        f"on one core and {rates[1]} on two; "
        f"{rates[2]} and {rates[3]} where obstacles move and the path stays."
    )


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    print(table(pathlib.Path(sys.argv[1])))

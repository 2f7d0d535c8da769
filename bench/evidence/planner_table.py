# SPDX-License-Identifier: BSD-3-Clause
"""The planners beside each other, on every scene and resolution: time, ratio to eager, questions,
FCL calls."""
import re

from measured import PAPER_SETTINGS, Benchmarks
from words import markdown, number

SCENES = {
    "a": "A", "b": "B", "c": "C", "c_20k": "C, 20,000 triangles", "arcs": "arcs", "roll": "roll",
    "meshes": "meshes"
}
PLANNERS = {
    "`eager`": "{}/eager/{}/nodes", "`eager`, 2 threads": "{}/eager/{}/nodes/threads:2",
    "`lazy`, FCL alone": "{}/lazy_fcl_alone/{}/nodes", "`lazy`": "{}/lazy/{}/nodes",
    "`parallel`, 2 threads": "{}/parallel/{}/nodes/threads:2"
}
# The rows of these tables, for --benchmark_filter.
FILTER = (
    rf"^({'|'.join(SCENES)})/((eager|lazy|lazy_fcl_alone)/#[1-4]/nodes/real_time$|"
    r"(eager|parallel)/#[1-4]/nodes/threads:2/)"
)


def time_cell(plans, name):
    """Milliseconds and, of planners that `eager` ran beside, the ratio. Those milliseconds are
    `eager`'s of the row over the ratio, so that noise between two processes is in neither."""
    if name in plans.not_run and name not in plans.runs:
        return plans.not_run[name].removesuffix(" a plan")
    if name not in plans.runs:
        return "–"
    scene, planner, setting, *_ = name.split("/")
    eager = plans.get(f"{scene}/lazy/{setting}/nodes", "eager_ms")  # beside `lazy`
    ratio = plans.quartiles(name, "speed_up_over_eager")
    if planner == "eager" and not ratio and eager:
        return number(eager)
    if not ratio:
        return number(plans.get(name, "plan_ms"))
    ms = eager / ratio[1] if eager else plans.get(name, "plan_ms")
    return f"{number(ms)}: {number(ratio[1], 2)} ({number(ratio[0], 2)}–{number(ratio[2], 2)})"


def work_cell(plans, name):
    if name not in plans.runs:
        return "–"
    asked = plans.get(name, "nodes_checked") + plans.get(name, "edges_checked")
    return f"{asked:,.0f}: {plans.get(name, 'fcl_calls'):,.0f}"


def tables(plans):
    """Header and rows of each of two tables: of times and of work."""
    found = []
    for first, cell in (
        ("ms: times as fast as `eager`", time_cell),
        ("questions: FCL calls", work_cell),
    ):
        rows = []
        for scene, title in SCENES.items():
            for setting in PAPER_SETTINGS:
                names = [name.format(scene, setting) for name in PLANNERS.values()]
                measured = [name for name in names if name in plans.runs]
                if not measured and not any(name in plans.not_run for name in names):
                    continue
                nodes = f"{plans.get(measured[0], 'nodes'):,.0f}" if measured else "–"
                verdict = (
                    ", no path" if any(not plans.get(name, "solved") for name in measured) else ""
                )
                rows.append(
                    [title, setting + verdict, nodes, *(cell(plans, name) for name in names)]
                )
        found.append((["scene", first, "nodes", *PLANNERS], rows))
    return found


def planners(data):
    """For the documents."""
    plans = Benchmarks(data / "plans.json")
    parts = [markdown(header, rows) for header, rows in tables(plans) if rows]
    return "\n\n".join(parts) or None


def aligned(header, rows):
    lines = [[re.sub("`", "", cell) for cell in line] for line in (header, *rows)]
    widths = [max(map(len, column)) for column in zip(*lines)]
    return "\n".join(
        "  ".join(cell.ljust(width) for cell, width in zip(line, widths)).rstrip() for line in lines
    )


def as_text(data):
    """For a terminal."""
    plans = Benchmarks(data / "plans.json")
    return "\n\n".join(aligned(header, rows) for header, rows in tables(plans))

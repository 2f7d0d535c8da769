# SPDX-License-Identifier: BSD-3-Clause
"""Runs the experiments and benchmarks, then writes tables and figures; see bench/reproduce."""
import argparse
import json
import os
import pathlib
import shutil
import subprocess
import sys
import time

import many_plans
import peers as public_problems
import planner_table
import tables

ROOT = pathlib.Path(__file__).resolve().parents[2]
BENCH = ROOT / "build/release/bench"
PROGRAM = ROOT / "build/release/cli/swivel"


def run(command, log, **environment):
    """Runs a program, its output into a file, which is shown where it fails."""
    with open(log, "w") as out:
        code = subprocess.run(
            command, stdout=out, stderr=subprocess.STDOUT, env={**os.environ, **environment}
        ).returncode
    if code != 0:
        sys.stderr.write(open(log).read())
        sys.exit(f"reproduce: {' '.join(map(str, command))}: ended with {code}")


def benchmark(program, out, repetitions, min_time, *arguments, **environment):
    run(
        [
            BENCH / program, f"--benchmark_out={out}", "--benchmark_out_format=json",
            f"--benchmark_repetitions={repetitions}", f"--benchmark_min_time={min_time}",
            "--benchmark_enable_random_interleaving=true", *arguments
        ],
        f"{out}.log",
        **environment,
    )


def vector_units():
    """Those of this processor."""
    flags = open("/proc/cpuinfo").read().split() if os.path.exists("/proc/cpuinfo") else []
    return ["scalar"] + [
        unit for unit, flag in (("avx2", "avx2"), ("avx512", "avx512dq")) if flag in flags
    ]


def experiments(data, quick):
    run([BENCH / "baselines/baseline_runs", "--rows", data], data / "experiments.txt")


def table1(data, quick):
    run(
        [BENCH / "experiment_c", data / "table1.json", "5" if quick else "100"], data / "table1.log"
    )


def plans(data, quick):
    if quick:
        benchmark(
            "plan_benchmark", data / "plans.json", 3, 0.01, "--plan_limit=2",
            f"--benchmark_filter={planner_table.FILTER}"
        )
    else:
        benchmark("plan_benchmark", data / "plans.json", 5, 0.05, "--plan_limit=60")
    print(tables.machine(data), planner_table.as_text(data), sep="\n\n", end="\n\n", flush=True)


def first_plans(data, quick):
    """Processes that plan one problem, each several times."""
    rows = []
    for problem in tables.FIRST_PLANS:
        runs = [
            subprocess.run(
                [BENCH / "first_plan", ROOT / f"data/problems/{problem}.yaml"],
                capture_output=True, text=True, check=True
            ).stdout.split() for _ in range(3 if quick else 15)
        ]
        rows.append(
            {"problem": problem, "runs": [dict(word.split("=") for word in run) for run in runs]}
        )
    (data / "first_plans.json").write_text(json.dumps(rows, indent=1))


def pieces(data, quick):
    repetitions, min_time = (1, 0.005) if quick else (5, 0.05)
    benchmark(
        "micro_benchmark", data / "pieces.json", repetitions, min_time,
        "--benchmark_filter=-^(ik/layer|ik/single|sweep)"
    )
    for unit in vector_units():
        benchmark(
            "micro_benchmark", data / f"pieces_{unit}.json", repetitions, min_time,
            "--benchmark_filter=^(ik/layer|ik/single|sweep)", SWIVEL_FORCE_ISA=unit
        )


def peers(data, quick):
    """The public problems: costs do not change from run to run, so each is planned once."""
    public_problems.measure(PROGRAM, data)


def batch(data, quick):
    """Many problems of one robot."""
    repetitions, min_time = (3, 0.05) if quick else (5, 0.5)
    benchmark(
        "batch_benchmark", data / "batch.json", repetitions, min_time,
        f"--benchmark_filter={many_plans.FILTER}"
    )
    print(many_plans.batch(data), end="\n\n", flush=True)


def trace(data, quick):
    """A plan whose path is found wanting several times."""
    run(
        [
            PROGRAM, "plan", ROOT / "data/problems/experiment_c.yaml",
            "--seed", "1", "--episode", "13", "--planner", "parallel", "--threads", "2",
            "--trace", data / "trace.json"
        ],
        data / "trace.log",
    )
    if all(shutil.which(program) for program in ("chromium", "npm")):
        run(
            [ROOT / "bench/evidence/trace_picture", data / "trace.json", data / "trace.png"],
            data / "trace_picture.log",
        )
    else:
        print(
            "trace: docs/figures/trace.png is left as it is: chromium and npm are needed to draw it"
        )


STEPS = {
    step.__name__: step
    for step in (experiments, table1, plans, first_plans, pieces, peers, batch, trace)
}
# Steps whose data no figure shows: they need no matplotlib.
NOT_DRAWN = {"peers", "batch"}


def main():
    parser = argparse.ArgumentParser(
        prog="bench/reproduce", description="Regenerates every table and figure of the documents."
    )
    parser.add_argument(
        "--only", choices=STEPS, action="append",
        help="this step alone (may be given several times)"
    )
    parser.add_argument(
        "--quick", action="store_true",
        help="few repetitions; leaves the documents of the repository alone"
    )
    arguments = parser.parse_args()
    data = ROOT / "build" / ("evidence-quick" if arguments.quick else "evidence")
    data.mkdir(parents=True, exist_ok=True)
    documents = ROOT
    if arguments.quick:
        documents = data
        (data / "docs").mkdir(exist_ok=True)
        shutil.copy(ROOT / "README.md", data)
        shutil.copy(ROOT / "docs/performance.md", data / "docs")
    figures = documents / "docs/figures"
    figures.mkdir(exist_ok=True)
    begin = time.monotonic()
    steps = arguments.only or list(STEPS)
    for name in steps:
        start = time.monotonic()
        STEPS[name](data, arguments.quick)
        print(f"{name}: {time.monotonic() - start:.0f} s", flush=True)
    if (data / "trace.png").exists():
        shutil.copy(data / "trace.png", figures)
    if not arguments.only:
        (data / "minutes.txt").write_text(f"{(time.monotonic() - begin) / 60:.0f}")
    written = []
    if not NOT_DRAWN.issuperset(steps):
        import plots

        written += plots.draw(data, figures, ROOT)
    written += tables.fill(data, [documents / "README.md", documents / "docs/performance.md"])
    print(
        f"all: {time.monotonic() - begin:.0f} s; wrote "
        f"{', '.join(str(file.relative_to(ROOT)) for file in written)}"
    )


main()

#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Measures what Python costs: a call beside the plan in it, and two threads beside one and beside
two processes. The measurements alternate.

    PYTHONPATH=build/release/python bench/python_calls.py [ROUNDS [PLANS]]

Default: 7 rounds of 400 plans a thread.
"""
import os
import statistics
import sys
import time
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from multiprocessing import get_context
from pathlib import Path

import swivel

PROBLEM = Path(__file__).parents[1] / "data" / "problems" / "experiment_c.yaml"
# ds (m), dphi (rad); plans of some 0.5, 1 and 10 ms.
SETTINGS = {"#1": (0.02, 0.2), "#4": (0.005, 0.05), "finest": (0.001, 0.01)}

planner = None


def prepare(setting):
    """A planner for this process, that has planned once."""
    global planner
    problem = swivel.load(PROBLEM)
    problem.resolution.ds, problem.resolution.dphi = SETTINGS[setting]
    planner = swivel.Planner(problem)
    planner.plan(planner="lazy")


def walk(own, plans):
    """Plans again and again while the rail goes to and fro by 1 mm a plan; when it began and
    ended."""
    rail = own.problem.scene["rail"].pose
    begin = time.monotonic()
    for k in range(plans):
        rail[0, 3] += 1e-3 * (1 if k // 10 % 2 == 0 else -1)
        own.move("rail", rail)
        own.plan(planner="lazy")
    return begin, time.monotonic()


def walk_alone(plans):
    return walk(planner, plans)


def rate(walks, plans):
    """Plans a second of all together."""
    begins, ends = zip(*walks)
    return len(begins) * plans / (max(ends) - min(begins))


def threads(setting, rounds, plans):
    prepare(setting)
    clones = [planner.clone() for _ in range(2)]
    with ProcessPoolExecutor(
        2, get_context("spawn"), prepare, (setting,)
    ) as processes, ThreadPoolExecutor(2) as pool:
        measured = []
        for k in range(rounds + 1):
            one = rate(pool.map(walk, clones[:1], [plans]), plans)
            two = rate(pool.map(walk, clones, [plans] * 2), plans)
            alone = rate(processes.map(walk_alone, [plans]), plans)
            both = rate(processes.map(walk_alone, [plans] * 2), plans)
            if k > 0:  # the first warms up
                measured.append((one, two, two / one, both / alone))
    one, two, of_threads, of_processes = (statistics.median(column) for column in zip(*measured))
    print(
        f"{setting}: {one:.0f} plans a second by one thread, {two:.0f} by two: {of_threads:.2f} "
        "times as many "
        f"({min(m[2] for m in measured):.2f} to {max(m[2] for m in measured):.2f}); two processes "
        f"{of_processes:.2f} times"
    )


def calls(plans):
    """What a plan takes, and how much more the call, ms."""
    inside, over = [], []
    for _ in range(plans):
        begin = time.perf_counter()
        plan = planner.plan(planner="lazy")
        took = 1e3 * (time.perf_counter() - begin)
        inside.append(sum(plan.time_ms[part] for part in ("prepare", "plan", "report")))
        over.append(took - inside[-1])
    return statistics.median(inside), statistics.median(over)


def overhead(setting, plans):
    prepare(setting)
    with ThreadPoolExecutor(1) as pool:
        (plan, over), (_, elsewhere) = calls(plans), pool.submit(calls, plans).result()
    print(
        f"{setting}: a plan takes {plan:.3f} ms, the call {over:.3f} ms more, in other threads "
        f"than the main one {elsewhere:.3f}"
    )


def main():
    rounds, plans = (
        int(given) if given else usual
        for given, usual in zip((sys.argv[1:] + [""] * 2)[:2], (7, 400))
    )
    print(f"medians of {rounds} rounds; load {os.getloadavg()[0]:.1f} on {os.cpu_count()} cores")
    for setting in SETTINGS:
        overhead(setting, plans)
        threads(setting, rounds, plans)


if __name__ == "__main__":
    main()

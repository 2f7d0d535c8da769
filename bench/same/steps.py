# SPDX-License-Identifier: BSD-3-Clause
"""What is asked of a problem file: plans by several planners, checks and motions of what was
written, and, where there is no plan, certificates and advice."""
from same.answers import Step

LAZY = ("--planner", "lazy", "--threads", "1")
TWO = ("--planner", "parallel", "--threads", "2")
SOLVED, UNSOLVED = ("lazy", (0,)), ("lazy", (1,))
ENDINGS = ("csv", "json", "yaml", "mcap")


def plan(name, problem, *words, planner=LAZY, answer=True, **more):
    """A plan whose answer is written as JSON."""
    words = (*planner, *words)
    if answer:
        words += ("--json", f"out/{name}.answer.json")
    return Step(name, ("plan", problem, *words), **more)


def plans(problem, *words):
    """The same plan by one thread and by two, with rows and answers."""
    return [
        plan("lazy", problem, *words, "--out", "out/lazy.rows.csv"),
        plan("parallel", problem, *words, "--out", "out/parallel.rows.csv", planner=TWO),
    ]


def solved(problem, number, *words):
    """What follows a plan: its rows are checked and timed, and what was made of them is checked.
    The number chooses the format of the motion."""
    rows, motion = "out/lazy.rows.csv", f"out/time.motion.{ENDINGS[number % len(ENDINGS)]}"
    speed = ("--speed", "0.05")
    timing = (*speed, "--rate", "25", *words)
    return [
        Step("check rows", ("check", problem, rows, *words), SOLVED, rows),
        Step("time", ("time", problem, rows, *timing, "--out", motion), SOLVED, rows),
        Step("check motion", ("check", problem, motion, *words), SOLVED, motion),
        plan("speed", problem, *timing, "--out", "out/speed.motion.csv", after=SOLVED),
    ]


def refined(problem, *words):
    """A plan that is refined, and timed, and a motion of refined rows."""
    rows = "out/lazy.rows.csv"
    return [
        plan("refine", problem, "--refine", *words, "--out", "out/refine.rows.csv", after=SOLVED),
        Step(
            "time refined",
            (
                "time",
                problem,
                rows,
                "--refine",
                "--speed",
                "0.05",
                "--rate",
                "20",
                *words,
                "--out",
                "out/refined.motion.csv",
            ),
            SOLVED,
            rows,
        ),
    ]


def unsolved(problem, *words, advise=True):
    """What follows where there is no plan."""
    file = "out/proof.certificate.json"
    steps = [
        plan("certificate", problem, *words, "--certificate", file, after=UNSOLVED),
        Step(
            "check certificate", ("check", problem, "--certificate", file, *words), UNSOLVED, file
        ),
    ]
    if advise:
        steps.append(plan("advise", problem, *words, "--advise", "3600", after=UNSOLVED))
    return steps


def drawn(problem, path, *words):
    """Maps of a problem with one path, and the page."""
    page = ("--report", "out/plan.page.html")
    if path:
        page += ("--map", "--map-svg", "out/plan.map.svg")
    return [plan("page", problem, *words, *page, answer=False)]


def campaign(problem, *words):
    """A campaign of few episodes, and one of them by itself."""
    return [
        Step(
            "campaign",
            (
                "campaign",
                problem,
                *LAZY,
                "--episodes",
                "3",
                *words,
                "--out",
                "out/campaign.table.csv",
                "--json",
                "out/campaign.summary.json",
                "--trajectories",
                "out/episodes",
            ),
        ),
        plan("episode", problem, *words, "--seed", "1", "--episode", "2"),
    ]


def placements(problem, *words):
    """Placements, and one of them by itself."""
    return [
        Step(
            "place",
            (
                "place",
                problem,
                *LAZY,
                "--path",
                "--x",
                "-0.02:0.02:0.02",
                *words,
                "--out",
                "out/place.table.csv",
                "--svg",
                "out/place.map.svg",
            ),
        ),
        Step("placed", ("plan", problem, *LAZY, "--path", "--x", "0.02", *words, "--json", "-")),
    ]


def python(kind, problem):
    """The answer of the Python module."""
    return Step("module", (kind, problem), python=True)

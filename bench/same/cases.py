# SPDX-License-Identifier: BSD-3-Clause
"""All cases that are compared, in their order."""
from same import bad_files, random_problems, special, steps
from same.answers import ROOT, Case, Step

PROBLEMS = ROOT / "data/problems"
RESOLUTIONS = {"1": (0.02, 0.2), "2": (0.005, 0.2), "3": (0.02, 0.05), "4": (0.005, 0.05)}
MADE = "made/problem.yaml"
COUNTS = {"path": 60, "job": 200, "workcell": 60}
MAKERS = {
    "path": random_problems.path_problem,
    "job": random_problems.job,
    "workcell": random_problems.workcell,
}


def kind_of(file):
    """Whether a problem file is of one path, of a job or of a workcell."""
    words = file.read_text()
    return "workcell" if "\narms:" in words else "job" if "\nstrokes:" in words else "path"


def shipped():
    """Problems of data/problems as they are, and coarse."""
    for number, file in enumerate(sorted(PROBLEMS.glob("*.yaml"))):
        problem, kind = f"data/problems/{file.name}", kind_of(file)
        asked = [
            *steps.plans(problem),
            *steps.solved(problem, number),
            *steps.unsolved(problem, advise=False),
            *steps.drawn(problem, kind == "path"),
        ]
        if kind != "job":
            asked += steps.refined(problem)
        if kind == "path":
            asked.append(steps.plan("pairs", problem, "--no-check", "--edges", "nodes"))
            asked.append(Step("info", ("info", problem, "--pairs")))
        asked.append(steps.python(kind, problem))
        yield Case(f"data/{file.stem}", {}, asked)


def table_one():
    """Experiments A, B and C at the resolutions of the paper's Table I."""
    for letter in "abc":
        for name, (ds, dphi) in RESOLUTIONS.items():
            words = ("--ds", str(ds), "--dphi", str(dphi))
            problem = f"data/problems/experiment_{letter}.yaml"
            yield Case(f"table/{letter}{name}", {}, steps.plans(problem, *words))


def generated(seed):
    """Random problems with one path, jobs and workcells."""
    for kind, count in COUNTS.items():
        for number in range(count):
            files, _ = MAKERS[kind](seed, number)
            asked = [*steps.plans(MADE), *steps.solved(MADE, number), *steps.unsolved(MADE)]
            if kind != "job" and number % 2 == 0:
                asked += steps.refined(MADE)
            if kind == "path" and number % 4 == 1:
                asked.append(
                    steps.plan("eager", MADE, planner=("--planner", "eager", "--threads", "1"))
                )
                asked.append(steps.plan("eager_dp", MADE, planner=("--planner", "eager_dp")))
            if number % 4 == 2:
                asked += steps.drawn(MADE, kind == "path")
            if "vary:" in files[MADE] and number % 2:
                asked += steps.campaign(MADE)
            if number % 5 == 0:
                asked += steps.placements(MADE)
            if number % (8 if kind == "job" else 4) == 3:
                asked.append(steps.python(kind, MADE))
            yield Case(f"random {kind}/{number:03}", files, asked)


def every_case(seed, quick):
    """All cases; with `quick` some of them, of each sort."""
    sorts = {
        "data": shipped(),
        "table": table_one(),
        "random": generated(seed),
        "special": special.cases(),
        "bad": bad_files.cases(),
    }
    for name, cases in sorts.items():
        for number, case in enumerate(cases):
            if not quick or number % {"random": 6}.get(name, 4) == 1:
                yield case

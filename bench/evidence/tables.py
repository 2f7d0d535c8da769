# SPDX-License-Identifier: BSD-3-Clause
"""Tables and sentences with figures, written between <!-- evidence NAME --> and <!-- /evidence -->
of the documents."""
import math
import re
import statistics
from collections import Counter

from many_plans import batch, throughput
from measured import (
    PAPER_SETTINGS, RESOLUTION, SETTINGS, Benchmarks, TableOne, load, mean, median, solved
)
from peers import peers
from planner_table import planners
from words import markdown, number

# The paper's Table I: mean ms, mean mm, %. Intel i7-4710HQ, 2.50 GHz, one thread.
PAPER = {
    "jacobian": (0.15, None, 0), "null_space": (5.34, 0.013, 15), "#1": (136.35, 1.32, 85),
    "#2": (837.86, 0.353, 93), "#3": (936.32, 0.532, 91), "#4": (6356.76, 0.021, 98)
}


def machine(data):
    minutes = data / "minutes.txt"
    took = f" All of it took {minutes.read_text()} minutes." if minutes.exists() else ""
    for name in ("plans.json", "table1.json", "pieces.json"):
        context = (load(data / name) or {}).get("context")
        if context:
            return (
                f"Machine: {context['processor']}, {context['hardware_threads']} threads, vector "
                f"unit {context['vector_unit']}; "
                f"{context['compiler']}, `{' '.join(context['flags'].split())}`; commit "
                f"{context['commit']}.{took}"
            )
    return None


def experiments(data):
    file = data / "experiments.txt"
    return f"```text\n{file.read_text().rstrip()}\n```" if file.exists() else None


METHODS = [
    ("jacobian", "", "nodes", "Jacobian pseudo-inverse"),
    ("null_space", "", "nodes", "null-space projection"),
    ("ompl_projected", "", "nodes", "OMPL RRT-Connect, projected space"),
    ("ompl_tangent_bundle", "", "nodes", "OMPL RRT-Connect, tangent bundle"),
]
METHODS += [("eager", s, "nodes", f"`eager` {s}") for s in PAPER_SETTINGS]
METHODS += [("eager_dp", "#4", "nodes", "`eager_dp` #4")]
METHODS += [("lazy", s, "nodes", f"`lazy` {s}") for s in SETTINGS] + [
    ("parallel", s, "nodes", f"`parallel` {s}, 2 threads") for s in PAPER_SETTINGS
]
METHODS += [(p, "#4", "continuous", f"`{p}` #4, motions checked") for p in ("lazy", "parallel")]


def split(method, episodes, feasible):
    """Counts: solved, no path at this resolution, no path at #4 from the start that was given, the
    method failed."""
    counts = Counter()
    for k, e in enumerate(episodes):
        if e["status"] == "solved":
            counts["solved"] += 1
        elif e["status"] == "infeasible" or not feasible[k]:
            counts["infeasible"] += 1
        elif not e.get("possible_from_start", True):
            counts["start"] += 1
        else:
            counts["failed"] += 1
    return counts


def table1(data):
    one = TableOne(data / "table1.json")
    if not one:
        return None
    feasible = [e["status"] == "solved" for e in one.episodes("lazy", "#4")]
    rows = []
    for method, setting, edges, name in METHODS:
        episodes = one.episodes(method, setting, edges)
        if not episodes:
            continue
        counts = split(method, episodes, feasible)
        per_cent = lambda n: f"{100 * n / len(episodes):.0f}"
        paper = (
            PAPER.get(method)
            or (PAPER.get(setting) if method == "eager" else None)
            or (None, None, None)
        )
        local = method not in ("eager", "eager_dp", "lazy", "parallel")
        if len(episodes) < len(feasible):
            name += f", first {len(episodes)} poses"
        rows.append(
            [
                name,
                RESOLUTION.get(setting, "–"),
                f"{number(mean(episodes, 'ms'))} ({number(median(episodes, 'ms'))})",
                number(mean(episodes, "error_mm")),
                per_cent(counts["solved"]),
                per_cent(counts["infeasible"]),
                per_cent(counts["start"]) if local else "–",
                per_cent(counts["failed"]),
                number(paper[0]),
                number(paper[1]),
                "–" if paper[2] is None else str(paper[2]),
            ]
        )
    return markdown(
        [
            "method", "Δs / Δφ (rad)", "planning time, ms: mean (median)", "tool-path error, mm",
            "success, %", "no path at this resolution, %", "none from this start, %",
            "planner failed, %", "paper: ms", "mm", "%"
        ],
        rows,
    )


def slope(points):
    """Of the least-squares line through logarithms."""
    x, y = zip(*((math.log(a), math.log(b)) for a, b in points))
    mx, my = statistics.mean(x), statistics.mean(y)
    return sum((a - mx) * (b - my) for a, b in zip(x, y)) / sum((a - mx) ** 2 for a in x)


def findings(data):
    one = TableOne(data / "table1.json")
    if not one:
        return None
    eager = {s: one.episodes("eager", s) for s in PAPER_SETTINGS}
    count = {s: solved(one.episodes("lazy", s)) for s in SETTINGS}
    error = {s: mean(one.episodes("lazy", s), "error_mm") for s in SETTINGS}
    nodes = {s: mean(eager[s], "nodes") for s in PAPER_SETTINGS}
    growth = slope([(nodes[s], mean(eager[s], "ms")) for s in PAPER_SETTINGS])
    paper = slope([(nodes[s], PAPER[s][0]) for s in PAPER_SETTINGS])
    sampled = [
        (name, one.episodes(method))
        for method, name in (
            ("ompl_projected", "projected space"),
            ("ompl_tangent_bundle", "tangent bundle"),
        )
        if one.episodes(method)
    ]
    same = all(
        [(e["status"], e["reason"]) for e in one.episodes(p, s)]
        == [(e["status"], e["reason"]) for e in eager[s]]
        for p in ("eager_dp", "lazy", "parallel")
        for s in PAPER_SETTINGS
    )
    reasons = {
        s: Counter(e["reason"] for e in one.episodes("lazy", s) if e["status"] != "solved")
        for s in SETTINGS
    }
    names = sorted(
        {reason for s in SETTINGS for reason in reasons[s]}, key=lambda r: -reasons["#1"][r]
    )
    text = [
        f"- Success: {', '.join(f'{s} {count[s]}' for s in SETTINGS)} of {len(eager['#1'])}. The "
        "four planners "
        + (
            "agree in status and reason on every episode."
            if same
            else "DO NOT AGREE in status and reason."
        ),
        "- Tool-path error, mean over solved episodes: "
        f"{', '.join(f'{s} {number(error[s])}' for s in SETTINGS)} mm. From #1 to #2 (Δs a "
        "quarter) it falls "
        f"{number(error['#1'] / error['#2'], 2)} times, from #1 to #3 (Δφ a quarter) "
        f"{number(error['#1'] / error['#3'], 2)} times; the paper has {number(1.32 / 0.353, 2)} "
        f"and {number(1.32 / 0.532, 2)}.",
        (
            f"- Time of `eager` grows with the nodes to the power {growth:.2f} over #1 to #4; the "
            f"paper's figures, over the same nodes, to {paper:.2f}."
        ),
        (
            "- `eager` over `lazy`, median of the episodes' own ratios: "
            f"{', '.join(f'{s} {number(ratio(one, s), 2)}' for s in PAPER_SETTINGS)}."
        ),
    ]
    text += [
        f"- OMPL, {name}: connected start and goal in "
        f"{sum(bool(e.get('connected')) for e in episodes)} of {len(episodes)} episodes; "
        f"{why(episodes)}."
        for name, episodes in sampled
    ]
    text += [
        f"- {name}: {why(one.episodes(method))}."
        for method, name in (
            ("jacobian", "Jacobian pseudo-inverse"),
            ("null_space", "Null-space projection"),
        )
    ]
    table = markdown(
        ["what stops every path", *SETTINGS],
        [
            [reason.replace("arm_left_", ""), *(str(reasons[s][reason]) for s in SETTINGS)]
            for reason in names
        ],
    )
    return "\n".join(text) + ("\n\n" + table if names else "")


def why(episodes):
    """What ended a method, most frequent first."""
    counts = Counter(e["reason"] or "solved" for e in episodes)
    return ", ".join(f"{reason} {count}" for reason, count in counts.most_common())


def ratio(one, setting, base="eager"):
    return statistics.median(
        a["ms"] / b["ms"]
        for a, b in zip(one.episodes(base, setting), one.episodes("lazy", setting))
    )


def plans(data):
    plans = Benchmarks(data / "plans.json")
    if not plans:
        return None
    settings = [s for s in SETTINGS if plans.get(f"c/lazy/{s}/nodes")]
    time = lambda name: number(plans.get(name))
    rows = [
        [
            "nodes of the lattice",
            *(f"{plans.get(f'c/lazy/{s}/nodes', 'nodes'):,.0f}" for s in settings),
        ]
    ]
    rows += [
        [f"`{p}`, ms", *(time(f"c/{p}/{s}/nodes") for s in settings)]
        for p in ("eager", "eager_dp", "lazy")
    ]
    threads = sorted({int(name.rsplit(":", 1)[1]) for name in plans.matching(r"c/parallel/.*")})
    rows += [
        [
            f"`parallel`, {n} thread{'s' * (n > 1)}, ms",
            *(time(f"c/parallel/{s}/nodes/threads:{n}") for s in settings),
        ]
        for n in threads
    ]
    rows += [["`lazy`, motions checked, ms", *(time(f"c/lazy/{s}/continuous") for s in settings)]]
    for name, key in (
        ("`eager` / `lazy`", "speed_up_over_eager"),
        ("`eager_dp` / `lazy`", "speed_up_over_eager_dp"),
    ):
        rows.append([name, *(number(plans.get(f"c/lazy/{s}/nodes", key), 2) for s in settings)])
    for planner in ("eager", "lazy"):
        rows.append(
            [
                f"FCL calls of `{planner}`",
                *(
                    f"{calls:,.0f}"
                    if (calls := plans.get(f"c/{planner}/{s}/nodes", "fcl_calls")) is not None
                    else "–"
                    for s in settings
                ),
            ]
        )
    return markdown(
        ["experiment C, nominal door", *(f"{s} ({RESOLUTION[s]})" for s in settings)], rows
    )


def scenes(data):
    plans = Benchmarks(data / "plans.json")
    if not plans:
        return None
    rows = []
    for scene, name in (
        ("a", "A"),
        ("b", "B"),
        ("c", "C, door of 2,000 triangles"),
        ("c_20k", "C, door of 20,000 triangles"),
    ):
        values = [
            (
                plans.get(f"{scene}/lazy/{s}/nodes", "speed_up_over_eager"),
                plans.get(f"{scene}/lazy/{s}/nodes", "speed_up_over_eager_dp"),
            )
            for s in PAPER_SETTINGS
        ]
        if values[0][0]:
            rows.append([name, *(f"{number(a, 2)} / {number(b, 2)}" for a, b in values)])
    return markdown(["speed-up of `lazy` over `eager` / over `eager_dp`", *PAPER_SETTINGS], rows)


FIRST_PLANS = ("experiment_a", "experiment_b", "experiment_c", "iiwa14_bench", "panda_weld_seam")


def first_plans(data):
    every = load(data / "first_plans.json")
    if not every:
        return None
    rows = []
    for one in every:
        of = lambda key: statistics.median(float(run[key]) for run in one["runs"])
        rows.append(
            [
                f"`{one['problem']}`", number(of("load")), number(of("prepare")),
                number(of("first")), number(of("next")), number(of("first") / of("next"), 2),
                f"{of('faults'):,.0f}"
            ]
        )
    return markdown(
        [
            "problem, `lazy`, one thread", "load, ms", "prepare, ms", "first plan, ms",
            "next plans, ms", "first / next", "page faults of the first"
        ],
        rows,
    )


def pieces(data):
    every = Benchmarks(data / "pieces.json")
    if not every:
        return None
    runs = dict(every.runs)
    for unit in ("scalar", "avx2", "avx512"):
        runs.update(Benchmarks(data / f"pieces_{unit}.json").runs)
    each = lambda name: number(1e9 / runs[name]["items_per_second"]) if name in runs else "–"
    units = [unit for unit in ("scalar", "avx2", "avx512") if f"ik/layer/{unit}" in runs]
    vector = markdown(
        ["ns each", *units],
        [
            ["IK, a node of a whole layer", *(each(f"ik/layer/{u}") for u in units)],
            ["IK, a node asked alone", *(each(f"ik/single_node/{u}") for u in units)],
            [
                "cost-to-go, whole sweep, a node of the lattice (IK included)",
                *(each(f"sweep/whole/{u}") for u in units),
            ],
            [
                "cost-to-go, bounded sweep, a node of the lattice",
                *(each(f"sweep/bounded/{u}") for u in units),
            ],
        ],
    )
    names = {
        "ik/closed_form_libm": "IK, closed form with libm",
        "forward_kinematics": "forward kinematics", "jacobian": "Jacobian",
        "manipulability": "manipulability", "step_error": "step error (one end)",
        "tool_path_error": "tool-path error of an edge", "a_star/expansion": "A\\*, an expansion",
        "posture/fcl": "posture: FCL", "posture/certificates": "posture: certificates, then FCL",
        "posture/kept": "posture of a path: clearances kept",
        "motion/fcl": "motion of an edge: FCL",
        "motion/certificates": "motion of an edge: certificates, then FCL"
    }
    single = markdown(["piece", "ns each"], [[text, each(name)] for name, text in names.items()])
    shapes = ("sphere", "capsule", "box", "cylinder", "mesh_2k", "mesh_20k")
    pair = markdown(
        [
            "capsule against, ns each",
            *(s.replace("_", ", ").replace("k", ",000 triangles") for s in shapes),
        ],
        [
            [text, *(each(f"{name}/capsule-{s}") for s in shapes)]
            for name, text in (
                ("fcl/below", "FCL: clearance below 5 mm?"),
                ("fcl/clearance", "FCL: clearance"),
                ("certificate", "certificate"),
            )
        ],
    )
    return "\n\n".join((vector, single, pair))


def headline(data):
    one = TableOne(data / "table1.json")
    if not one:
        return None
    rows = []
    for method, setting, name in (
        ("jacobian", "", "Jacobian pseudo-inverse"),
        ("null_space", "", "null-space projection"),
        ("eager", "#4", "the paper's method (`eager`)"),
        ("lazy", "#4", "`lazy`"),
        ("parallel", "#4", "`parallel`, 2 threads"),
    ):
        episodes = one.episodes(method, setting)
        paper = PAPER.get(method) or (PAPER["#4"] if method == "eager" else (None, None, None))
        rows.append(
            [
                name,
                number(mean(episodes, "ms")),
                number(mean(episodes, "error_mm")),
                f"{100 * solved(episodes) / len(episodes):.0f}",
                number(paper[0]),
                number(paper[1]),
                "–" if paper[2] is None else str(paper[2]),
            ]
        )
    return markdown(
        [
            f"{len(one.episodes('lazy', '#4'))} door poses, 5 mm / 0.05 rad", "ms",
            "tool-path error, mm", "success, %", "paper: ms", "mm", "%"
        ],
        rows,
    )


BLOCKS = {
    block.__name__: block
    for block in (
        machine, experiments, table1, findings, planners, plans, scenes, first_plans, pieces,
        peers, batch, headline, throughput
    )
}


def fill(data, documents):
    """Rewrites the blocks whose data are there. The files written."""
    written = []
    for document in documents:
        text = document.read_text()
        for name, block in BLOCKS.items():
            content = block(data)
            pattern = re.compile(rf"(<!-- evidence {name} -->\n).*?(<!-- /evidence -->)", re.S)
            if content:
                text = pattern.sub(lambda match: match[1] + content + "\n" + match[2], text)
        if text != document.read_text():
            document.write_text(text)
            written.append(document)
    return written

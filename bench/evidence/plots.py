# SPDX-License-Identifier: BSD-3-Clause
"""Figures of the documents, drawn from the measured data: the same file from the same data."""
import xml.etree.ElementTree as ET
from collections import Counter

import matplotlib

matplotlib.use("svg")
# Okabe and Ito's colours, told apart by the colour-blind.
OKABE_ITO = ["#0072B2", "#E69F00", "#009E73", "#D55E00", "#CC79A7", "#56B4E9", "#000000"]
matplotlib.rcParams.update(
    {
        "svg.hashsalt": "swivel", "font.size": 9, "axes.titlesize": 10, "axes.grid": True,
        "grid.alpha": 0.25, "axes.prop_cycle": matplotlib.cycler(color=OKABE_ITO),
        "axes.spines.top": False, "axes.spines.right": False, "legend.frameon": False
    }
)
import matplotlib.pyplot as plt

from measured import PAPER_SETTINGS, SETTINGS, Benchmarks, TableOne, solved, table

PLANNERS = {
    "eager": ("#000000", "s"), "eager_dp": ("#E69F00", "D"), "lazy": ("#0072B2", "o"),
    "parallel": ("#009E73", "^")
}
RED = "#D55E00"
LENGTH = 0.5  # m, the line of A and B


def save(figure, file):
    figure.savefig(file, metadata={"Date": None})
    plt.close(figure)
    return file


def experiment_a(data, root):
    jacobian = data / "experiment_a_start_jacobian.csv"
    if not jacobian.exists():
        return None
    limits = {}
    for joint in ET.parse(root / "data/robots/sda5f.urdf").getroot().findall("joint"):
        if joint.find("limit") is not None:
            limits[joint.get("name")] = (
                float(joint.find("limit").get("lower")),
                float(joint.find("limit").get("upper")),
            )
    figure, axes = plt.subplots(1, 2, figsize=(10, 3.6), sharey=True)
    for axis, file, title in (
        (axes[0], jacobian, "Jacobian pseudo-inverse: stopped by a joint limit"),
        (
            axes[1], data / "experiment_a_start_swivel_free.csv",
            "Swivel: finishes, start chosen by the search"
        ),
    ):
        rows = table(file)
        for name in (n for n in rows if n in limits):
            low, high = limits[name]
            axis.plot(
                rows["s"],
                [100 * (q - low) / (high - low) for q in rows[name]],
                label=name.replace("arm_left_joint_", "joint "),
                linewidth=1.8,
            )
        axis.set_title(title)
        axis.set_xlabel("s, m along the path")
        axis.set_xlim(0, LENGTH)
        axis.set_ylim(-3, 103)
        for limit in (0, 100):
            axis.axhline(limit, color="black", linewidth=0.8, linestyle="--")
    stop = table(jacobian)["s"][-1]
    axes[0].axvline(stop, color=RED, linewidth=1)
    axes[0].annotate(
        f"limit at {100 * stop / LENGTH:.0f} % of the path",
        (stop, 55),
        xytext=(6, 0),
        textcoords="offset points",
        color=RED,
    )
    axes[0].set_ylabel("joint, % of its range")
    figure.legend(*axes[1].get_legend_handles_labels(), loc="lower center", ncol=7)
    figure.tight_layout(rect=(0, 0.07, 1, 1))
    return figure


def experiment_b(data, root):
    if not (data / "experiment_b_jacobian.csv").exists():
        return None
    figure, axis = plt.subplots(figsize=(7, 3.2))
    for name, title, colour, style in (
        ("jacobian", "Jacobian pseudo-inverse", "#E69F00", "--"),
        ("null_space", "null-space projection", RED, "-."),
        ("swivel", "Swivel, same start", "#0072B2", "-"),
    ):
        rows = table(data / f"experiment_b_{name}.csv")
        clearance = [1e3 * c for c in rows["clearance"]]
        axis.plot(rows["s"], clearance, style, color=colour, label=title, linewidth=1.8)
        if name != "swivel":
            axis.plot(
                rows["s"][-1], clearance[-1], "x", color=colour, markersize=9, markeredgewidth=2.5
            )
            axis.annotate(
                f"stops at {100 * rows['s'][-1] / LENGTH:.0f} %",
                (rows["s"][-1], clearance[-1]),
                xytext=(-8 if name == "jacobian" else 8, 8),
                textcoords="offset points",
                color=colour,
                ha="right" if name == "jacobian" else "left",
            )
    axis.axhline(5, color="black", linewidth=0.8, linestyle="--")
    axis.annotate(
        "asked for: 5 mm", (LENGTH, 5), xytext=(0, -11), textcoords="offset points", ha="right"
    )
    axis.set_xlabel("s, m along the path")
    axis.set_ylabel("least clearance, mm")
    axis.set_xlim(0, LENGTH)
    axis.set_ylim(0)
    axis.legend(loc=(0.5, 0.4))
    figure.tight_layout()
    return figure


def by_resolution(axis, plans, key, planners):
    for planner in planners:
        colour, marker = PLANNERS[planner]
        end = "/threads:1" if planner == "parallel" else ""
        points = sorted(
            (run["nodes"], run[key])
            for run in plans.matching(rf"c/{planner}/[^/]+/nodes{end}").values()
        )
        points = [(nodes, value) for nodes, value in points if value > 0]
        axis.loglog(*zip(*points), color=colour, marker=marker, label=planner, markersize=5)
    axis.set_xlabel("nodes of the lattice")
    axis.legend()


def plans(data, root):
    plans = Benchmarks(data / "plans.json")
    if not plans:
        return None
    figure, (time, checks) = plt.subplots(1, 2, figsize=(10, 3.8))
    by_resolution(time, plans, "real_time", ("eager", "eager_dp", "lazy"))
    time.set_title("Planning time, one thread")
    time.set_ylabel("ms")
    by_resolution(checks, plans, "nodes_checked", ("eager", "lazy", "parallel"))
    nodes = sorted({run["nodes"] for run in plans.matching("c/.*").values()})
    checks.loglog(nodes, nodes, color="grey", linewidth=0.8, linestyle=":")
    checks.annotate(
        "every node",
        (nodes[-1], nodes[-1]),
        xytext=(-6, 0),
        textcoords="offset points",
        ha="right",
        color="grey",
    )
    checks.set_title("Nodes whose clearance was asked")
    figure.suptitle("Experiment C, nominal door, resolutions #1 to #4 of the paper and finer")
    figure.tight_layout()
    return figure


def speed_up(data, root):
    plans = Benchmarks(data / "plans.json")
    if not plans:
        return None
    figure, (bars, threads) = plt.subplots(1, 2, figsize=(10, 3.8))
    scenes = [scene for scene in ("a", "b", "c", "c_20k") if plans.get(f"{scene}/lazy/#1/nodes")]
    width = 0.8 / len(scenes)
    for k, scene in enumerate(scenes):
        for key, colour, label in (
            ("speed_up_over_eager", "#56B4E9", "over eager"),
            ("speed_up_over_eager_dp", "#E69F00", "over eager_dp"),
        ):
            values = [
                plans.get(f"{scene}/lazy/{setting}/nodes", key) or 0 for setting in PAPER_SETTINGS
            ]
            places = [i + (k - (len(scenes) - 1) / 2) * width for i in range(len(PAPER_SETTINGS))]
            bars.bar(
                places,
                values,
                0.9 * width,
                color=colour,
                label=label if k == 0 else None,
                edgecolor="black",
                linewidth=0.4,
            )
            if key == "speed_up_over_eager":
                for place, value in zip(places, values):
                    bars.annotate(
                        scene.replace("c_20k", "c20"),
                        (place, value),
                        xytext=(0, 2),
                        textcoords="offset points",
                        ha="center",
                        fontsize=7,
                    )
    bars.set_yscale("log")
    bars.axhline(1, color="black", linewidth=0.8)
    bars.set_xticks(range(len(PAPER_SETTINGS)), PAPER_SETTINGS)
    bars.set_title("Speed-up of lazy, by experiment and resolution")
    bars.set_ylabel("times as fast, same run")
    bars.legend(loc="upper left")
    markers = iter("osD^v*")
    for name, scene, setting in (
        ("b #4", "b", "#4"),
        ("c #4", "c", "#4"),
        ("c fine", "c", "fine"),
        ("c finest", "c", "finest"),
    ):
        runs = plans.matching(rf"{scene}/parallel/{setting}/continuous/threads:\d+")
        points = sorted(
            (int(run.rsplit(":", 1)[1]), values["real_time"]) for run, values in runs.items()
        )
        if points:
            threads.plot(
                [n for n, _ in points],
                [points[0][1] / ms for _, ms in points],
                marker=next(markers),
                label=name,
            )
    most = max(
        (int(name.rsplit(":", 1)[1]) for name in plans.matching(r".*/threads:\d+")), default=1
    )
    threads.plot([1, most], [1, most], color="grey", linewidth=0.8, linestyle=":")
    threads.set_xticks(range(1, most + 1))
    threads.set_ylim(0)
    threads.set_xlabel("threads")
    threads.set_ylabel("times as fast as one thread")
    threads.set_title("parallel, motions checked (--edges continuous)")
    threads.legend()
    figure.tight_layout()
    return figure


def success(data, root):
    one = TableOne(data / "table1.json")
    if not one:
        return None
    rows = [("Jacobian", one.episodes("jacobian")), ("null space", one.episodes("null_space"))]
    rows += [(f"Swivel {setting}", one.episodes("lazy", setting)) for setting in SETTINGS]
    reasons = Counter()
    for _, episodes in rows:
        reasons.update(e["reason"] for e in episodes if e["status"] != "solved")
    colours = [
        "#D55E00", "#E69F00", "#CC79A7", "#56B4E9", "#F0E442", "#009E73", "#000000", "#999999"
    ]
    names = [reason for reason, _ in reasons.most_common()]
    shown = names[: len(colours) - 1]
    figure, axis = plt.subplots(figsize=(9, 3.6))
    for k, (name, episodes) in enumerate(rows):
        left = 100 * solved(episodes) / len(episodes)
        axis.barh(k, left, color="#0072B2", label="solved" if k == 0 else None)
        axis.annotate(
            f"{left:.0f} %",
            (left, k),
            xytext=(-4 if left > 8 else 4, 0),
            textcoords="offset points",
            ha="right" if left > 8 else "left",
            va="center",
            color="white",
        )
        counts = Counter(
            e["reason"] if e["reason"] in shown else "other"
            for e in episodes
            if e["status"] != "solved"
        )
        for reason, colour in zip(shown + ["other"], colours):
            width = 100 * counts[reason] / len(episodes)
            axis.barh(k, width, left=left, color=colour, edgecolor="white", linewidth=0.5)
            left += width
    for reason, colour in zip(shown + (["other"] if len(names) > len(shown) else []), colours):
        axis.barh(0, 0, color=colour, label=reason.replace("arm_left_", ""))
    axis.set_yticks(range(len(rows)), [name for name, _ in rows])
    axis.invert_yaxis()
    axis.grid(axis="y", visible=False)
    axis.set_xlabel(f"% of {len(rows[0][1])} door poses; the rest by what stops the method")
    axis.set_xlim(0, 100)
    axis.legend(loc="center left", bbox_to_anchor=(1, 0.5))
    figure.tight_layout()
    return figure


def draw(data, figures, root):
    written = []
    for plot in (experiment_a, experiment_b, plans, speed_up, success):
        figure = plot(data, root)
        if figure:
            written.append(save(figure, figures / f"{plot.__name__}.svg"))
    return written

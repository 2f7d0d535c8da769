# SPDX-License-Identifier: BSD-3-Clause
"""Public problems, data/peers: what was published about them beside what Swivel finds, and how far
an arm gets along straight lines."""
import csv
import itertools
import json
import math
import os
import pathlib
import subprocess
import tempfile

from words import markdown

DATA = pathlib.Path(__file__).resolve().parents[2] / "data/peers"
# TORM's lengths, rad and m of the torso, as CppFlow's authors recorded them: TORM_TL_RESULTS of
# cppflow/utils.py, jstmn/cppflow, commit 2b6ad30.
TORM = {
    "fetch_arm__circle": (11.105, None), "fetch_arm__hello": (61.029, None),
    "fetch_arm__rot_yz2": (29.913, None), "fetch_arm__s": (10.856, None),
    "fetch_arm__square": (14.841, None), "panda__1cube": (8.493, None),
    "panda__2cubes": (12.628, None), "panda__flappy_bird": (None, None),
    "fetch__circle": (22.042, 0.498), "fetch__hello": (None, None),
    "fetch__rot_yz2": (30.419, 0.841), "fetch__s": (None, None),
    "fetch__square": (19.577, 0.56392)
}
# "Min Num of Reconfig", README of uwgraphics/IKLink, commit 16d0d70.
IKLINK = {"iklink_panda": 3}
LINES = [f"line_{number}" for number in range(11)]
COLUMNS = (
    "problem", "status", "l1", "cost", "l1_refined", "cost_refined", "by_l1", "by_l1_refined",
    "step_deg", "gap", "lift_offs", "cpu_s", "cpu_refined_s"
)
LINE_COLUMNS = ("line", "capsules_m", "capsules_end", "bare_m", "bare_end", "cpu_s")


def plan(program, file, *options):
    """The answer, and the seconds of processor time of the whole process."""
    with tempfile.TemporaryDirectory() as folder:
        out = pathlib.Path(folder) / "answer.json"
        before = os.times()
        done = subprocess.run(
            [program, "plan", file, "--quiet", "--json", out, *options], capture_output=True,
            text=True
        )
        after = os.times()
        if done.returncode not in (0, 1):
            raise SystemExit(f"peers: {file}: {done.stderr.strip()}")
        answer = json.loads(out.read_text())
    if answer["status"] == "solved" and not answer["checked"]:
        raise SystemExit(f"peers: {file}: the answer was not proved")
    user = after.children_user - before.children_user
    return answer, user + after.children_system - before.children_system


def strokes_of(answer):
    """The rows of joints of each run, without the moves between runs."""
    if "trajectory" in answer:
        return [[row["joints"] for row in answer["trajectory"]]]
    return [
        [row["joints"] for row in part["rows"]] for part in answer["parts"] if part.get("stroke")
    ]


def steps_of(answer):
    """How far each joint turns, from row to row."""
    for rows in strokes_of(answer):
        for before, after in itertools.pairwise(rows):
            yield [abs(b - a) for a, b in zip(before, after)]


def length(answer):
    """The sum of |dq| over rows and joints."""
    return sum(map(sum, steps_of(answer)))


def measure_by_l1(program, name):
    """What a problem costs by the metric l1, as planned and refined."""
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        for part in ("robots", "paths"):
            (folder / part).symlink_to(DATA / part)
        (folder / "problems").mkdir()
        file = folder / "problems" / f"{name}.yaml"
        text = (DATA / f"problems/{name}.yaml").read_text()
        file.write_text(f"{text}cost: {{metric: l1}}\n")
        costs = []
        for options in ((), ("--refine",)):
            answer = plan(program, file, *options)[0]
            assert math.isclose(answer["cost"], length(answer), rel_tol=1e-9), name
            costs.append(answer["cost"])
    return dict(zip(("by_l1", "by_l1_refined"), costs))


def measure_problem(program, name):
    file = DATA / f"problems/{name}.yaml"
    plain, cpu = plan(program, file)
    row = {"problem": name, "status": plain["status"], "cpu_s": cpu}
    if plain["status"] != "solved":
        return row
    refined, cpu_refined = plan(program, file, "--refine")
    return {
        **row, **(measure_by_l1(program, name) if name in TORM else {}),
        "l1": length(plain), "cost": plain["cost"], "l1_refined": length(refined),
        "cost_refined": refined["cost"], "cpu_refined_s": cpu_refined,
        "step_deg": math.degrees(max(map(max, steps_of(refined)))),
        "gap": plain.get("lattice", {}).get("knot_gap"),
        "lift_offs": len(plain["lift_offs"]) if "lift_offs" in plain else None
    }


def measure_line(program, name):
    row = {"line": name, "cpu_s": 0}
    for bodies in ("capsules", "bare"):
        answer, cpu = plan(program, DATA / f"lines/{bodies}/{name}.yaml")
        row["cpu_s"] += cpu
        if answer["status"] == "solved":
            row[f"{bodies}_m"], row[f"{bodies}_end"] = answer["trajectory"][-1]["s"], "–"
        else:
            row[f"{bodies}_m"] = answer["diagnosis"]["reached_s"] or 0
            row[f"{bodies}_end"] = answer["diagnosis"]["reason"]
    return row


def write(file, columns, rows):
    with open(file, "w", newline="") as out:
        table = csv.DictWriter(out, columns)
        table.writeheader()
        table.writerows(rows)


def measure(program, data, problems=(*TORM, *IKLINK), lines=tuple(LINES)):
    """Writes peers.csv and peers_lines.csv."""
    write(data / "peers.csv", COLUMNS, [measure_problem(program, name) for name in problems])
    write(data / "peers_lines.csv", LINE_COLUMNS, [measure_line(program, name) for name in lines])


def read(file):
    """Rows with numbers where there are some, and None where there is nothing."""
    def value(text):
        try:
            return float(text) if text else None
        except ValueError:
            return text

    with open(file, newline="") as lines:
        return [{key: value(text) for key, text in row.items()} for row in csv.DictReader(lines)]


def torm(name):
    turned, slid = TORM[name]
    if turned is None:
        return "none"
    return f"{turned:.3f}" + (f" + {slid:.3f} m, eight joints" if slid else "")


def decimals(value, digits):
    return "–" if value is None else f"{value:.{digits}f}"


def seconds(row):
    return f"{decimals(row['cpu_s'], 2)}, {decimals(row['cpu_refined_s'], 2)}"


def lengths(rows):
    """The table of CppFlow's problems."""
    return markdown(
        [
            "problem", "TORM, L1", "`l1`: plan", "`l1`: refined", "`l2`: L1, refined",
            "`l2`: plan", "`l2`: refined", "refined over plan", "largest step, °",
            "`knot_gap`, %", "verdict", "CPU of plan, refined, s"
        ],
        [
            [
                f"`{row['problem']}`", torm(row["problem"]),
                decimals(row["by_l1"], 3), decimals(row["by_l1_refined"], 3),
                decimals(row["l1_refined"], 2),
                decimals(row["cost"], 3), decimals(row["cost_refined"], 3),
                decimals(row["cost"] and row["cost_refined"] / row["cost"], 3),
                decimals(row["step_deg"], 1), decimals(row["gap"] and 100 * row["gap"], 2),
                row["status"], seconds(row)
            ] for row in rows if row["problem"] in TORM
        ],
    )


def reconfigurations(rows):
    """The table of IKLink's problem."""
    return markdown(
        [
            "problem", "IKLink, reconfigurations", "lift-offs", "L1 of its runs", "plan, cost",
            "refined, cost", "largest step, °", "verdict", "CPU of plan, refined, s"
        ],
        [
            [
                f"`{row['problem']}`", str(IKLINK[row["problem"]]), decimals(row["lift_offs"], 0),
                decimals(row["l1"], 2), decimals(row["cost"], 2), decimals(row["cost_refined"], 2),
                decimals(row["step_deg"], 1), row["status"], seconds(row)
            ] for row in rows if row["problem"] in IKLINK
        ],
    )


def reach(rows):
    """The table of straight lines, and their sum."""
    total = {key: sum(row[key] for row in rows) for key in ("capsules_m", "bare_m", "cpu_s")}
    rows = [*rows, {"line": "all", "capsules_end": "–", "bare_end": "–", **total}]
    return markdown(
        [
            "line of 1.6 m", "with capsules, m", "what ends it", "without bodies, m",
            "what ends it", "CPU of both, s"
        ],
        [
            [
                f"`{row['line']}`", decimals(row["capsules_m"], 3), row["capsules_end"],
                decimals(row["bare_m"], 3), row["bare_end"], decimals(row["cpu_s"], 2)
            ] for row in rows
        ],
    )


def peers(data):
    if not (data / "peers.csv").exists():
        return None
    rows = read(data / "peers.csv")
    lines = read(data / "peers_lines.csv")
    return "\n\n".join((lengths(rows), reconfigurations(rows), reach(lines)))

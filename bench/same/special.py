# SPDX-License-Identifier: BSD-3-Clause
"""Cases with a way of their own: work that is stopped, problems made of earlier answers, rows that
were tampered with, campaigns and placements, and the commands that plan nothing."""
import json

from same import arms, bad_files, steps, text
from same.answers import Case, Step

MADE = bad_files.MADE
DATA = "data/problems"
NEVER = "1e-9"  # s, over before the work begins
COARSE = ("--ds", "0.02", "--dphi", "0.2")


def stopped():
    """Plans whose time is over at once, or in the middle of work that takes seconds."""
    for kind, make in bad_files.GOOD.items():
        problem = {MADE: text.yaml(make())}
        no = {MADE: text.yaml(bad_files.changed(make(), ["limits", "joint_step"], 1e-5))}
        never = ("--timeout", NEVER)
        yield Case(
            f"stopped/{kind}",
            problem,
            [
                steps.plan("lazy", MADE, *never, "--out", "out/stopped.rows.csv"),
                steps.plan("two", MADE, *never, planner=steps.TWO),
                steps.plan("speed", MADE, *never, "--speed", "0.05", "--out", "out/x.motion.csv"),
                steps.plan("refine", MADE, *never, "--refine"),
                steps.plan("page", MADE, *never, "--report", "out/stopped.page.html"),
                Step(
                    "place",
                    (
                        "place",
                        MADE,
                        "--path",
                        "--x",
                        "0:0.02:0.01",
                        *never,
                        *steps.LAZY,
                        "--out",
                        "out/place.table.csv",
                    ),
                ),
            ],
        )
        yield Case(
            f"stopped/{kind} advice",
            no,
            [
                steps.plan("advise", MADE, "--advise", NEVER),
                steps.plan("certificate", MADE, *never, "--certificate", "out/no.certificate.json"),
            ],
        )
    for problem, seconds in (
        ("iiwa14_ring_job", 0.3),
        ("experiment_c_20k", 0.005),
        ("torch_door", 0.05),
        ("door_job", 0.02),
        ("iiwa14_bench_job", 0.02),
        ("iiwa14_deburr_in_hand", 0.05),
    ):
        words = ("plan", f"{DATA}/{problem}.yaml", "--planner", "lazy", "--timeout", str(seconds))
        fine = () if problem == "iiwa14_ring_job" else ("--ds", "0.002", "--dphi", "0.01")
        step = Step("plan", (*words, *fine, "--out", "out/stopped.rows.csv"), whole=False)
        yield Case(f"stopped/{problem}", {}, [step])


def rows_of(folder, name="lazy"):
    """The lines of a trajectory that was written, its header first."""
    return (folder / f"out/{name}.rows.csv").read_text().splitlines()


def joints_of(row):
    """The joints of a row of seven-joint arms without a roll."""
    return [float(value) for value in row.split(",")[3:10]]


def resumed(which):
    """Makes a problem that begins, goes on or ends in the joints of a row of its own answer."""

    def make(folder):
        lines = rows_of(folder)
        first, middle, last = lines[1], lines[len(lines) // 2], lines[-1]
        problem = bad_files.good_path()
        if which == "start":
            problem["start"] = {"joints": joints_of(first)}
        elif which == "middle":
            problem["start"] = {"joints": joints_of(middle)}
            problem["start_at"] = float(middle.split(",")[0])
        else:
            problem["path"]["end"] = {"joints": joints_of(last)}
        (folder / "made/next.yaml").write_text(text.yaml(problem))

    return make


def follow_ups():
    """Problems that are made of rows of earlier answers."""
    problem = {MADE: text.yaml(bad_files.good_path())}
    first = steps.plan("lazy", MADE, "--out", "out/lazy.rows.csv")
    for which in ("start", "middle", "end"):
        again = steps.plan(
            "again",
            "made/next.yaml",
            "--out",
            "out/again.rows.csv",
            needs="out/lazy.rows.csv",
            make=resumed(which),
        )
        checked = Step("check", ("check", "made/next.yaml", "out/again.rows.csv"))
        timed = Step(
            "time",
            (
                "time",
                "made/next.yaml",
                "out/again.rows.csv",
                "--speed",
                "0.05",
                "--rate",
                "20",
                "--out",
                "out/again.motion.csv",
            ),
        )
        yield Case(f"follow/{which}", problem, [first, again, checked, timed])
    for which in range(4):
        yield given_motion(which)


def given_motion(which):
    """A workcell in which the motion of one arm is that of an earlier answer."""

    def make(folder):
        problem = bad_files.good_workcell()
        arm = problem["arms"][which % 2]
        del arm["path"]
        arm["trajectory"] = "../out/lazy.rows.csv"
        if which > 1:  # in the way of what is given
            problem["scene"].append({"name": "wall", "box": [0.3, 0.3, 0.3], "xyz": [0.68, 0, 1.0]})
        (folder / "made/next.yaml").write_text(text.yaml(problem))

    problem = {MADE: text.yaml(bad_files.good_workcell())}
    rows = "out/again.rows.csv"
    return Case(
        f"follow/given motion {which}",
        problem,
        [
            steps.plan("lazy", MADE, "--out", "out/lazy.rows.csv"),
            steps.plan(
                "again", "made/next.yaml", "--out", rows, make=make, needs="out/lazy.rows.csv"
            ),
            Step("check", ("check", "made/next.yaml", rows), ("again", (0,)), rows),
            Step(
                "time", ("time", "made/next.yaml", rows, "--speed", "0.05"), ("again", (0,)), rows
            ),
        ],
    )


def drop_row(lines):
    return lines[:2] + lines[3:]


def move_joint(lines):
    row = lines[2].split(",")
    return [*lines[:2], ",".join([*row[:-1], repr(float(row[-1] or 0) + 0.01)]), *lines[3:]]


def swap_rows(lines):
    return [*lines[:2], lines[3], lines[2], *lines[4:]]


def no_number(lines):
    return [*lines[:2], lines[2].rsplit(",", 1)[0] + ",nan", *lines[3:]]


def other_column(lines):
    return ["colour," + lines[0], *("1," + line for line in lines[1:])]


def no_rows(lines):
    return lines[:1]


def joints_alone(lines):
    return [line.split(",", 3)[3] for line in lines]


TAMPERED = (drop_row, move_joint, swap_rows, no_number, other_column, no_rows, joints_alone)


def tampered():
    """Rows that were changed after they were planned."""
    for kind, good in bad_files.GOOD.items():
        for change in TAMPERED:

            def make(folder, change=change):
                (folder / "out/bad.rows.csv").write_text("\n".join(change(rows_of(folder))) + "\n")

            name = change.__name__.replace("_", " ")
            timing = ("--speed", "0.05", "--rate", "20", "--out", "out/bad.motion.csv")
            yield Case(
                f"rows/{name} of a {kind}",
                {MADE: text.yaml(good())},
                [
                    steps.plan("lazy", MADE, "--out", "out/lazy.rows.csv"),
                    Step("check", ("check", MADE, "out/bad.rows.csv"), make=make),
                    Step("time", ("time", MADE, "out/bad.rows.csv", *timing)),
                ],
            )


def certificates():
    """Certificates that were changed, or are of another problem."""
    for kind, good in bad_files.GOOD.items():
        path = ["arms", 1, "limits"] if kind == "workcell" else ["limits", "joint_step"]
        value = {"joint_step": 0.001} if kind == "workcell" else 0.001
        problem = bad_files.changed(good(), path, value)
        if kind == "job":
            problem["strokes"][0].pop("reversible")

        def make(folder):
            certificate = folder / "out/proof.certificate.json"
            words = certificate.read_text()
            changed = words.replace('"witness', '"wetness') if "witness" in words else words[:-9]
            certificate.with_name("bad.certificate.json").write_text(changed)
            other = json.loads(words)
            (folder / "out/short.certificate.json").write_text(json.dumps(other)[:-30])

        proof = "out/proof.certificate.json"
        yield Case(
            f"certificate/{kind}",
            {MADE: text.yaml(problem), "made/good.yaml": text.yaml(good())},
            [
                steps.plan("plan", MADE, "--certificate", proof),
                Step("good", ("check", MADE, "--certificate", proof)),
                Step("other", ("check", "made/good.yaml", "--certificate", proof)),
                Step("finer", ("check", MADE, "--certificate", proof, "--ds", "0.01")),
                Step(
                    "bad",
                    ("check", MADE, "--certificate", "out/bad.certificate.json"),
                    needs=proof,
                    make=make,
                ),
                Step(
                    "short",
                    ("check", MADE, "--certificate", "out/short.certificate.json"),
                    needs=proof,
                ),
            ],
        )


def many_plans():
    """Campaigns and placements, whole and in shards, and what merges them."""
    door, bench = f"{DATA}/experiment_c.yaml", f"{DATA}/iiwa14_bench.yaml"
    campaign = ("campaign", door, *steps.LAZY, *COARSE, "--episodes", "12")
    place = ("place", bench, *steps.LAZY, *COARSE, "--base", "--x", "-0.3:0.2:0.1")
    place += ("--y", "-0.2:0.2:0.1")
    shards = [f"out/{k}.table.csv" for k in range(2)]
    yield Case(
        "many/campaign",
        {},
        [
            Step(
                "whole",
                (
                    *campaign,
                    "--out",
                    "out/whole.table.csv",
                    "--json",
                    "-",
                    "--report",
                    "out/whole.page.html",
                    "--trajectories",
                    "out/episodes",
                ),
            ),
            *(
                Step(f"shard {k}", (*campaign, "--shard", f"{k}/2", "--out", shards[k]))
                for k in range(2)
            ),
            Step("merge", ("merge", "out/merged.table.csv", *shards, "--json", "-")),
            Step("one shard", ("merge", "out/one.table.csv", shards[0])),
            steps.plan(
                "episode",
                door,
                *COARSE,
                "--seed",
                "1",
                "--episode",
                "7",
                "--out",
                "out/seventh.rows.csv",
            ),
            Step("other seed", (*campaign, "--seed", "2", "--out", "out/whole.table.csv")),
            Step(
                "two threads",
                (
                    "campaign",
                    door,
                    *steps.TWO,
                    *COARSE,
                    "--episodes",
                    "8",
                    "--out",
                    "out/two.table.csv",
                ),
            ),
        ],
    )
    yield Case(
        "many/place",
        {},
        [
            Step(
                "whole",
                (
                    *place,
                    "--out",
                    "out/whole.table.csv",
                    "--svg",
                    "out/whole.map.svg",
                    "--report",
                    "out/whole.page.html",
                ),
            ),
            *(
                Step(f"shard {k}", (*place, "--shard", f"{k}/2", "--out", shards[k]))
                for k in range(2)
            ),
            Step(
                "merge", ("merge", "out/merged.table.csv", *shards, "--svg", "out/merged.map.svg")
            ),
            Step("refine", (*place, "--refine-grid", "--out", "out/refined.table.csv")),
            Step("best", (*place, "--best", "clearance,cost", "--top", "3")),
            Step(
                "sample",
                (
                    "place",
                    bench,
                    *steps.LAZY,
                    *COARSE,
                    "--path",
                    "--x",
                    "-0.1:0.1",
                    "--yaw",
                    "-0.3:0.3",
                    "--sample",
                    "8",
                    "--seed",
                    "3",
                    "--out",
                    "out/sample.table.csv",
                ),
            ),
            Step(
                "object",
                (
                    "place",
                    bench,
                    *steps.LAZY,
                    *COARSE,
                    "--object",
                    "casting",
                    "--z",
                    "0:0.1:0.05",
                    "--out",
                    "out/object.table.csv",
                ),
            ),
            Step("nobody", ("place", bench, *steps.LAZY, "--object", "nobody", "--x", "0:1:0.5")),
            Step("speed", (*place, "--best", "speed")),
        ],
    )
    for kind, good in bad_files.GOOD.items():
        yield Case(
            f"many/{kind}",
            {MADE: text.yaml(good())},
            [
                *steps.placements(MADE),
                Step(
                    "write",
                    (
                        "place",
                        MADE,
                        *steps.LAZY,
                        "--base",
                        "--x",
                        "-0.02:0.02:0.01",
                        "--write",
                        "made/best.yaml",
                        "--best",
                        "margin",
                    ),
                ),
                Step(
                    "object",
                    (
                        "place",
                        MADE,
                        *steps.LAZY,
                        "--object",
                        "post",
                        "--x",
                        "0:0.1:0.05",
                        "--report",
                        "out/object.page.html",
                    ),
                ),
                *steps.campaign(MADE),
            ],
        )
    turn = ("place", f"{DATA}/experiment_a.yaml", *steps.LAZY, *COARSE, "--hold")
    yield Case(
        "many/hold",
        {},
        [
            Step("hold", (*turn, "torso_joint_b1=-0.4:0.4:0.2", "--out", "out/hold.table.csv")),
            Step("no joint", (*turn, "no_joint=0:1:0.5")),
        ],
    )


def without_plans():
    """What arms are, the schemas, and the help of every command."""
    robots = sorted({arm.robot["urdf"][3:] for arm in arms.ARMS.values()})
    robots += [
        "data/robots/sda10f.urdf",
        "data/robots/iiwa14_pair.urdf",
        "data/robots/gen3_like.urdf",
    ]
    yield Case("info/robots", {}, [Step(robot.split("/")[-1], ("info", robot)) for robot in robots])
    yield Case(
        "info/more",
        {},
        [
            Step("srdf", ("info", "data/robots/iiwa14.urdf", "--srdf", "data/robots/iiwa14.srdf")),
            Step("roll", ("info", "data/robots/ur10e_rail_like.urdf", "--roll")),
            Step("tip", ("info", "data/robots/sda5f.urdf", "--tip", "arm_right_link_tool0")),
            Step("no tip", ("info", "data/robots/sda5f.urdf", "--tip", "nowhere")),
            Step("track", ("info", "data/robots/ur10e_rail_like.urdf", "--base", "track")),
            Step("write", ("info", "data/robots/iiwa14.urdf", "--write", "out/begin.problem.yaml")),
            Step("plan", ("plan", "out/begin.problem.yaml", *steps.LAZY)),
            Step("no file", ("info", "nowhere.urdf")),
            Step("pairs", ("info", f"{DATA}/experiment_a.yaml", "--pairs")),
            Step("pairs of a job", ("info", f"{DATA}/door_job.yaml", "--pairs")),
            Step("fit", ("fit", "data/robots/iiwa14.urdf", "--out", "out/fit.robot.urdf")),
        ],
    )
    commands = ("plan", "campaign", "place", "merge", "check", "time", "info", "fit", "schema")
    helps = [Step(f"help {command}", (command, "--help")) for command in commands]
    schemas = [
        Step(f"schema {name}", ("schema", name))
        for name in ("problem", "result", "campaign", "job", "workcell", "nothing")
    ]
    yield Case(
        "words/help",
        {},
        [
            Step("version", ("--version",)),
            Step("help", ("--help",)),
            Step("nothing", ()),
            *helps,
            *schemas,
        ],
    )


def wrong_words():
    """Options that are unknown, out of range, or not of this kind of problem."""
    options = [
        ("--colour",),
        ("--planner", "fast"),
        ("--planner", "eager"),
        ("--threads", "-1"),
        ("--threads", "5000"),
        ("--ds", "0"),
        ("--ds", "nan"),
        ("--dphi", "x"),
        ("--timeout", "0"),
        ("--speed", "-1"),
        ("--speed", "0.05", "--out", "out/x.txt"),
        ("--out", "out/x.json"),
        ("--out", "nowhere/x.csv"),
        ("--map",),
        ("--map-svg", "out/x.map.svg"),
        ("--rate", "50"),
        ("--full-map",),
        ("--certificate", "out/x.json", "--refine"),
        ("--advise", "0"),
        ("--refine",),
        ("--chord", "0.001"),
        ("--x", "0.1"),
        ("--arm", "left", "--path"),
        ("--edges", "none"),
        ("--arcs", "--no-arcs"),
        ("--episode", "1"),
        ("--speed", "100"),
        ("--hold", "no_joint=1"),
        ("--turn-speed", "0.5"),
        ("--quiet",),
        ("--no-check",),
    ]
    for kind, good in bad_files.GOOD.items():
        asked = [
            Step(" ".join(words).replace("/", "_"), ("plan", MADE, *steps.LAZY[2:], *words))
            for words in options
        ]
        asked += [
            Step("no rows", ("check", MADE)),
            Step("no file", ("plan", "nowhere.yaml")),
            Step("time of nothing", ("time", MADE, "nowhere.csv")),
        ]
        yield Case(f"words/{kind}", {MADE: text.yaml(good())}, asked)


def cases():
    """All of these; none is drawn."""
    for make in (
        stopped,
        follow_ups,
        tampered,
        certificates,
        many_plans,
        without_plans,
        wrong_words,
    ):
        yield from make()

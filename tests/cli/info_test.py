#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""`swivel info` without options: which arm it finds on robots of many kinds."""
import json
import random
import re
import unittest

from cli_test import DATA, SWIVEL, WithFolder, on_terminal, run
from trials import SCALE, at_least, seed

IIWA = (DATA / "robots/iiwa14.urdf").read_text()


def joint(name, kind, parent, child, xyz="0 0 0.05", axis="0 0 1", more=""):
    limit = (
        '<limit lower="-1" upper="1" velocity="1" effort="1"/>'
        if kind in ("revolute", "prismatic")
        else ""
    )
    return (
        f'<joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/>'
        f'<origin xyz="{xyz}"/><axis xyz="{axis}"/>{limit}{more}</joint><link name="{child}"/>'
    )


class Info(WithFolder):
    def info(self, more="", *options, text=IIWA):
        file = self.folder / "robot.urdf"
        file.write_text(text.replace("</robot>", more + "</robot>"))
        return run("info", file, *options)

    def finds(self, done, base, tip, words="S-R-S"):
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn(f"arm        {base} to {tip}\n", done.stdout)
        self.assertIn(f"class      {words}", done.stdout)
        self.assertEqual(
            re.findall(r"^joint \d +(\S+)", done.stdout, re.M), [f"joint_a{k}" for k in range(1, 8)]
        )

    def test_arm_alone(self):
        self.finds(self.info(), "base_link", "tool0")

    def test_gripper(self):
        for fingers in (
            joint("left", "prismatic", "tool0", "l", axis="0 1 0")
            + joint(
                "right", "prismatic", "tool0", "r", axis="0 -1 0", more='<mimic joint="left"/>'
            ),
            joint("left", "revolute", "tool0", "l")
            + joint("right", "revolute", "tool0", "r", more='<mimic joint="left"/>'),
            joint("left", "revolute", "tool0", "l")
            + joint("left2", "revolute", "l", "l2")
            + joint("right", "revolute", "tool0", "r"),
            joint("one", "prismatic", "tool0", "l"),
            joint("one", "revolute", "tool0", "l") + joint("two", "revolute", "l", "l2"),
            joint("spindle", "continuous", "tool0", "bit"),
        ):
            with self.subTest(fingers=fingers):
                self.finds(self.info(fingers), "base_link", "tool0")

    def test_named_tools(self):
        self.finds(
            self.info(
                joint("mount", "fixed", "link_7", "hand")
                + joint("end", "fixed", "hand", "hand_tcp")
            ),
            "base_link",
            "tool0",
        )
        renamed = IIWA.replace('"tool0"', '"plate"')
        self.finds(
            self.info(
                joint("mount", "fixed", "link_7", "hand")
                + joint("end", "fixed", "hand", "hand_tcp"),
                text=renamed,
            ),
            "base_link",
            "hand_tcp",
        )
        self.finds(self.info(text=renamed), "base_link", "plate")
        hand = (
            joint("mount", "fixed", "plate", "hand")
            + joint("left", "prismatic", "hand", "l")
            + joint("right", "prismatic", "hand", "r")
        )
        self.finds(self.info(hand, text=renamed), "base_link", "plate")

    def test_torso_and_mobile_base(self):
        for above in (
            joint("lift", "prismatic", "cart", "base_link"),
            joint("turn", "revolute", "cart", "base_link"),
            joint("mount", "fixed", "cart", "base_link"),
        ):
            with self.subTest(above=above):
                more = (
                    '<link name="cart"/>'
                    + above.replace('<link name="base_link"/>', "")
                    + joint("w1", "continuous", "cart", "wheel_1")
                    + joint("w2", "continuous", "cart", "wheel_2")
                )
                self.finds(self.info(more), "base_link", "tool0")

    def test_second_arm(self):
        links = re.findall(r'<link name="([^"]*)"', IIWA)
        other = re.search(r"<robot[^>]*>(.*)</robot>", IIWA, re.S).group(1)
        for name in sorted(
            set(links + re.findall(r'<joint name="([^"]*)"', IIWA)), key=len, reverse=True
        ):
            other = other.replace(f'"{name}"', f'"b_{name}"')
        # The other comes first in the file, and has an elbow that is no S-R-S arm's.
        bent = re.sub(
            r'(<joint name="b_joint_a7".*?<origin xyz=")\S+', r"\g<1>0.088", other, flags=re.S
        )
        mount = '<link name="stand"/>' + "".join(
            joint(f"m_{k}", "fixed", "stand", k).replace(f'<link name="{k}"/>', "")
            for k in ("base_link", "b_base_link")
        )
        for second, first in ((other, "base_link to tool0"), (bent, "base_link to tool0")):
            done = self.info(second + mount)
            self.finds(done, "base_link", "tool0")
            self.assertIn("other arm  b_base_link to b_tool0", done.stdout)
        self.assertIn(
            "arm        stand to b_tool0\n",
            self.info(other + mount, "--base", "stand", "--tip", "b_tool0").stdout,
        )
        self.assertIn(
            "arm        b_base_link to b_tool0\n",
            self.info(other + mount, "--base", "b_base_link").stdout,
        )

    def test_not_srs(self):
        for number, ends, axes, lock in (
            (
                7, "a spherical shoulder and no spherical wrist", "6 and 7",
                "axes 1, 2 and 3 meet in a point"
            ),
            (
                2, "no spherical shoulder and a spherical wrist", "1 and 2",
                "axes 5, 6 and 7 meet in a point"
            ),
        ):
            bent = re.sub(
                rf'(<joint name="joint_a{number}".*?<origin xyz=")\S+', r"\g<1>0.088", IIWA,
                flags=re.S
            )
            self.assertNotEqual(bent, IIWA)
            done = self.info(
                joint("left", "prismatic", "tool0", "l")
                + joint("right", "prismatic", "tool0", "r"),
                text=bent,
            )
            self.assertEqual((done.returncode, done.stderr), (0, ""))
            for line in (
                f"class      7R with {ends}\n",
                f"not S-R-S  axes {axes} miss each other by 88.0 mm\n",
                f"solutions  all: closed form: {lock}; locks joint ",
            ):
                self.assertIn(line, done.stdout)

    def test_five_joints_and_a_gripper(self):
        five = IIWA
        for number in (3, 5):
            five = five.replace(
                f'<joint name="joint_a{number}" type="revolute">',
                f'<joint name="joint_a{number}" type="fixed">',
            )
        done = self.info(
            joint("left", "prismatic", "tool0", "l") + joint("right", "revolute", "tool0", "r"),
            text=five,
        )
        self.assertEqual((done.returncode, done.stdout), (2, ""))
        self.assertIn(
            (
                "no arm of seven or six joints: the longest row of joints that turn has 5, from "
                "'joint_a1' to 'joint_a7'"
            ),
            done.stderr,
        )
        for name in ("left", "right", "prismatic"):
            self.assertNotIn(name, done.stderr)

    def test_roll(self):
        named = ("--base", "base_link", "--tip", "flange")
        for options in ((), named, ("--roll",), ("--roll", *named)):
            done = run("info", DATA / "robots/ur5e_like.urdf", *options)
            self.assertIn("arm        base_link to flange\nclass      6R", done.stdout)
            self.assertIn(
                "have it\nsolutions  all: closed form: axes 2, 3 and 4 are parallel", done.stdout
            )
            self.assertEqual(
                re.findall(r"^joint \d +(\S+)", done.stdout, re.M),
                [f"joint_{k}" for k in range(1, 7)],
            )
        done = self.info("", "--roll")
        self.assertEqual(done.returncode, 2)
        self.assertIn(
            "no arm of six joints: the longest row of joints that turn has 7", done.stderr
        )

    def test_meshes_are_not_needed(self):
        mesh = (
            '<link name="shell"><collision><geometry>'
            '<mesh filename="package://some_robot/meshes/shell.stl"/></geometry></collision></link>'
        )
        more = mesh + joint("glue", "fixed", "base_link", "shell").replace(
            '<link name="shell"/>', ""
        )
        done = self.info(more)
        self.finds(done, "base_link", "tool0")
        for word in (
            "meshes     1 not found", "package://some_robot/meshes/shell.stl",
            "robot.packages: {some_robot: "
        ):
            self.assertIn(word, done.stdout)
        shelf = self.folder / "shelf" / "any-name"
        (shelf / "meshes").mkdir(parents=True)
        (shelf / "meshes/shell.stl").write_bytes(b"not even a mesh")
        self.assertNotIn("meshes", self.info(more, "--packages", f"some_robot={shelf}").stdout)
        for wrong in ("some_robot", "=x", f"some_robot={shelf}/nowhere"):
            done = self.info(more, "--packages", wrong)
            self.assertEqual((done.returncode, done.stdout), (2, ""))
            self.assertIn("--packages", done.stderr)

    def test_linkages_follow_the_arm(self):
        mimics = lambda leader, more="": f'<mimic joint="{leader}"{more}/>'
        rods = (
            joint(
                "balancer", "revolute", "link_1", "rod", axis="0 1 0",
                more=mimics("joint_a2", ' multiplier="-1"')
            )
            + joint(
                "cylinder", "prismatic", "rod", "piston",
                more=mimics("joint_a2", ' multiplier="0.1"')
            )
            + joint("rocker", "revolute", "link_3", "lever", axis="0 1 0", more=mimics("joint_a4"))
        )
        done = self.info(rods)
        self.finds(done, "base_link", "tool0")
        for line in (
            "linkage    balancer moves by -1 times joint 2\n",
            "linkage    cylinder moves by 0.1 times joint 2\n",
            "linkage    rocker moves by 1 times joint 4\n",
        ):
            self.assertIn(line, done.stdout)
        # The balancer's limits.
        self.assertRegex(done.stdout, r"joint 2    joint_a2 +-1\.0000 to +1\.0000 rad")
        six = (DATA / "robots/ur5e_like.urdf").read_text()
        first = re.search(r'<joint name="joint_1".*?<child link="([^"]*)"', six, re.S).group(1)
        done = self.info(
            joint("balancer", "revolute", first, "rod", axis="0 1 0", more=mimics("joint_2")),
            text=six,
        )
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        self.assertIn("class      6R", done.stdout)
        self.assertIn("linkage    balancer moves by 1 times joint 2\n", done.stdout)

    def test_an_arm_that_mimics_itself(self):
        text = re.sub(
            r'(<joint name="joint_a4".*?<axis[^>]*/>)',
            r'\g<1><mimic joint="joint_a2" multiplier="-1"/>', IIWA, flags=re.S
        )
        self.assertNotEqual(text, IIWA)
        done = self.info(text=text)
        self.assertEqual((done.returncode, done.stdout), (2, ""))
        self.assertIn(
            (
                "joint 'joint_a4', between 'base_link' and 'tool0', mimics 'joint_a2' of the arm: "
                "not supported"
            ),
            done.stderr,
        )

    def test_tips(self):
        renamed = IIWA.replace('"tool0"', '"plate"')
        # Holds shapes, at link 7 itself.
        side = joint("shell", "fixed", "link_7", "link_7_sc", xyz="0 0 0")
        camera = joint(
            "camera_rojoint", "revolute", "link_7", "camera_rolink", xyz="0 0.05 0", axis="0 1 0"
        )
        lens = joint("mount", "fixed", "link_7", "front_camera", xyz="0 0.05 0")
        for more in (
            side, camera, lens, side + camera + lens,
            camera + joint("lens", "fixed", "camera_rolink", "lens_link")
        ):
            with self.subTest(more=more):
                self.finds(self.info(more, text=renamed), "base_link", "plate")
        bare = re.sub(
            r'<joint name="[^"]*" type="fixed">\s*<parent link="link_7"/>.*?</joint>', "",
            re.sub(r'<link name="tool0"[^>]*(/>|>.*?</link>)', "", IIWA, flags=re.S), flags=re.S
        )
        self.assertNotIn("tool0", bare)
        self.finds(self.info(camera, text=bare), "base_link", "link_7")

    def rail(self, tail=""):
        """The arm on a rail of 2 m, and a path 1 m beside it."""
        self.info(
            '<link name="hall"/><joint name="rail" type="prismatic"><parent link="hall"/>'
            '<child link="base_link"/><axis xyz="0 1 0"/><limit lower="-2" upper="2" velocity="1" '
            'effort="1"/></joint>'
        )
        file = self.folder / "problem.yaml"
        file.write_text(
            f"robot: {{urdf: robot.urdf, base_link: hall, tip_link: tool0{tail}}}\n"
            f"path: {{waypoints: [{{xyz: [0.5, 1.2, 0.5]}}, {{xyz: [0.5, 1.25, 0.5]}}]}}\n"
        )
        return file

    def test_held_joints_are_named(self):
        problem = self.rail()
        done = run("info", self.folder / "robot.urdf", "--base", "hall", "--tip", "tool0")
        self.assertIn("held       rail at 0 m\n", done.stdout)
        self.assertIn(
            (
                "warning    joint 'rail' lies between base and tip and is not planned: it is held "
                "at 0 m: robot.hold: {rail: POSITION}"
            ),
            done.stdout,
        )
        done = run(
            "info", self.folder / "robot.urdf", "--base", "hall", "--tip", "tool0",
            "--hold", "rail=1"
        )
        self.assertIn("held       rail at 1 m\n", done.stdout)
        self.assertNotIn("warning", done.stdout)
        alone = run("info", self.folder / "robot.urdf").stdout
        self.assertNotIn("held", alone)
        self.assertIn("beside     rail at 0 m\n", alone)

        result = self.folder / "result.json"
        done = run("plan", problem, "--json", result)
        self.assertEqual(done.returncode, 1)
        self.assertIn("no path at any resolution with rail held at 0 m: ", done.stdout)
        self.assertIn(
            (
                "swivel: warning: joint 'rail' lies between base and tip and is not planned: it is "
                "held at 0 m"
            ),
            done.stderr,
        )
        held = {"joint": "rail", "position": 0, "unit": "m", "given": False, "mimics": None}
        self.assertEqual(json.loads(result.read_text())["held"], [held])

        problem = self.rail(", hold: {rail: 1.1}")
        done = run("plan", problem, "--json", result, "--out", self.folder / "path.csv")
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        self.assertIn(" | held: rail at 1.1 m\n", done.stdout)
        self.assertEqual(
            json.loads(result.read_text())["held"], [held | {"position": 1.1, "given": True}]
        )
        done = run("check", problem, self.folder / "path.csv")
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        self.assertIn(", held: rail at 1.1 m; ", done.stdout)
        problem = self.rail(", hold: {rail: 3}")
        done = run("plan", problem)
        self.assertEqual((done.returncode, done.stdout), (2, ""))
        self.assertEqual(
            done.stderr,
            (
                f"swivel: {problem}:1: robot.hold.rail: joint 'rail' at 3 is outside its limits: "
                "allowed is -2 to 2\n"
            ),
        )
        done = run(
            "info", self.folder / "robot.urdf", "--base", "hall", "--tip", "tool0",
            "--hold", "rail=3"
        )
        self.assertEqual(
            (done.returncode, done.stderr),
            (2, "swivel: --hold: joint 'rail' at 3 is outside its limits: allowed is -2 to 2\n"),
        )
        done = run("info", self.folder / "robot.urdf", "--without", "rial")
        self.assertEqual((done.returncode, len(done.stderr.splitlines())), (2, 1))
        self.assertTrue(
            done.stderr.startswith("swivel: --without: unknown link 'rial', nearest is '"),
            done.stderr,
        )
        for value in ("nan", "inf", "-inf", "", "1m", "0x1"):
            done = run(
                "info", self.folder / "robot.urdf", "--base", "hall", "--tip", "tool0",
                "--hold", f"rail={value}"
            )
            self.assertEqual(
                (done.returncode, done.stdout, len(done.stderr.splitlines())), (2, "", 1)
            )
            self.assertIn(f"--hold: 'rail={value}': allowed is JOINT=POSITION", done.stderr)
        done = run(
            "campaign", self.rail(), "--episodes", "1", "--planner", "lazy",
            "--json", self.folder / "s.json"
        )
        self.assertEqual(json.loads((self.folder / "s.json").read_text())["held"], [held])
        self.assertIn(
            "1 of 1 episodes answered: 0 solved, 1 infeasible, held: rail at 0 m\n"
            "  1 without a path: ",
            done.stdout,
        )
        done = run("place", self.rail(), "--path", "--x", "0", "--planner", "lazy")
        self.assertIn("1 of 1 placements planned, 0 with a path, 1 without: ", done.stdout)
        self.assertIn(", held: rail at 0 m; ", done.stdout)

    def test_near_matches(self):
        for options, words in (
            (("--tip", "tol0"), "--tip: unknown link 'tol0', nearest is 'tool0'"),
            (("--base", "baselink"), "--base: unknown link 'baselink', nearest is 'base_link'"),
            (("--hold", "joint_a8=1"), "--hold: unknown joint 'joint_a8', nearest is 'joint_a1'"),
        ):
            done = self.info("", *options)
            self.assertEqual((done.returncode, len(done.stderr.splitlines())), (2, 1))
            self.assertIn(words, done.stderr)
        problem = self.folder / "problem.yaml"
        problem.write_text(
            f"robot: {{urdf: {DATA}/robots/iiwa14.urdf, base_link: base_link, tip_link: tol0}}\n"
            f"path: {{waypoints: [{{xyz: [0.5, 0, 0.5]}}, {{xyz: [0.5, 0.1, 0.5]}}]}}\n"
        )
        self.assertIn("unknown link 'tol0', nearest is 'tool0'", run("plan", problem).stderr)


def prefixed(text, prefix):
    """The inside of a URDF, all its links and joints named anew."""
    text = re.sub(
        r'(<(?:link|joint|parent|child|mimic) (?:name|link|joint)=")', rf"\g<1>{prefix}", text
    )
    return re.search(r"<robot[^>]*>(.*)</robot>", text, re.S).group(1)


class Robots(WithFolder):
    """Arms of each class with what robots have besides: class, method, joints, base and tip without
    options."""

    CLASSES = {
        "iiwa14": ("S-R-S", "all: closed form: spherical"),
        "sda10f": ("S-R-S", "all: closed form: spherical"),
        "sda5f": ("S-R-S, in-plane elbow offset", "all: closed form: spherical"),
        "panda_like": ("7R with a spherical shoulder", "all: closed form: axes 1, 2 and 3 meet"),
        "xarm7_like": ("7R with a spherical shoulder", "all: closed form: axes 1, 2 and 3 meet"),
        "fetch_like": (
            "7R with no spherical shoulder and a spherical wrist",
            "all: closed form: axes 5, 6 and 7 meet",
        ),
        "gen3_like": (
            "7R with no spherical shoulder and a spherical wrist",
            "all: closed form: axes 5, 6 and 7 meet",
        ),
        "offsets": ("7R with no spherical shoulder and no spherical wrist", "those that turn up: "),
        "kr6_like": (
            "6R with no spherical shoulder and a spherical wrist",
            "all: closed form: axes 4, 5 and ",
        ),
        "ur5e_like": (
            "6R with no spherical shoulder and no spherical wrist",
            "all: closed form: axes 2, 3 and 4 are parallel",
        ),
        "six_offsets": (
            "6R with no spherical shoulder and no spherical wrist",
            "those that turn up: ",
        ),
    }

    def setUp(self):
        super().setUp()
        self.texts = {
            name: (DATA / f"robots/{name}.urdf").read_text()
            for name in self.CLASSES
            if "offsets" not in name
        }
        # No three neighbouring axes meet or are parallel: the joints of the wrist pass each other.
        for name, of in (("offsets", "panda_like"), ("six_offsets", "kr6_like")):
            text = self.texts[of]
            for number in (2, 3, 5, 6):
                text = re.sub(
                    rf'(<joint name="joint_{number}".*?<origin xyz=")(\S+) (\S+) (\S+?)"',
                    rf'\g<1>0.0{number}1 0.0{9 - number}3 0.2{number}"', text, flags=re.S
                )
            self.texts[name] = text

    def arm(self, name):
        """An arm of one row, its tip, and its joints."""
        text = self.texts[name]
        if name.startswith("sda"):
            return (
                text, "arm_left_link_tool0",
                re.findall(r'<joint name="(arm_left_joint_\d_\w)"', text)
            )
        tip = "tool0" if name == "iiwa14" else "flange"
        return text, tip, re.findall(r'<joint name="(joint_a?\d)"', text)

    def finds(self, name, text, base, tip, joints, words, others=0):
        self.ran += 1
        file = self.folder / "robot.urdf"
        file.write_text(text)
        done = run("info", file)
        kind, method = self.CLASSES[name]
        right = (
            done.returncode == 0
            and f"arm        {base} to {tip}\n" in done.stdout
            and re.search(f"^class      {kind}", done.stdout, re.M)
            and f"solutions  {method}" in done.stdout
            and re.findall(r"^joint \d +(\S+)", done.stdout, re.M) == joints
            and done.stdout.count("other arm") == others
        )
        if not right:
            self.wrong.append(f"{name}, {words}:\n{done.stdout}{done.stderr}")

    def test_each_class(self):
        self.ran, self.wrong = 0, []
        draw = random.Random(seed(20260704))
        for name in self.CLASSES:
            text, tip, joints = self.arm(name)
            others = 1 if name.startswith("sda") else 0  # two arms as they are

            def variant(
                words, more, before="", base="base_link", last=tip, body=text, named=joints,
                also=others
            ):
                if words != "alone" and draw.random() >= SCALE:
                    return  # each alone, and a share of what it may have besides
                head, inside, tail = re.fullmatch(
                    r"(.*<robot[^>]*>)(.*)(</robot>.*)", body, re.S
                ).groups()
                self.finds(
                    name, head + before + inside + more + tail, base, last, named, words, also
                )

            variant("alone", "")
            renamed = text.replace(f'"{tip}"', '"plate"')
            for flange, body in ((tip, text), ("plate", renamed)):
                hand = joint("mount", "fixed", flange, "hand_body")
                variant(
                    "parallel gripper",
                    hand
                    + joint("left", "prismatic", "hand_body", "l", axis="0 1 0")
                    + joint(
                        "right", "prismatic", "hand_body", "r", axis="0 -1 0",
                        more='<mimic joint="left"/>'
                    ),
                    last=flange,
                    body=body,
                )
                variant(
                    "four-bar gripper",
                    hand
                    + joint("finger_joint", "revolute", "hand_body", "l")
                    + joint("l_inner", "revolute", "l", "l2", more='<mimic joint="finger_joint"/>')
                    + joint(
                        "right", "revolute", "hand_body", "r", more='<mimic joint="finger_joint"/>'
                    ),
                    last=flange,
                    body=body,
                )
                variant(
                    "three fingers",
                    hand
                    + "".join(
                        joint(f"f{k}", "revolute", "hand_body", f"f{k}")
                        + joint(f"f{k}t", "revolute", f"f{k}", f"f{k}t")
                        for k in range(3)
                    ),
                    last=flange,
                    body=body,
                )
                variant(
                    "one finger", hand + joint("gripper", "revolute", "hand_body", "l"),
                    last=flange, body=body
                )
                variant(
                    "gripper with its own centre",
                    hand
                    + joint("end", "fixed", "hand_body", "grasp_tcp")
                    + joint("slide", "prismatic", "hand_body", "l"),
                    last=tip if flange == tip and tip.endswith("tool0") else "grasp_tcp",
                    body=body,
                )
            variant("spindle", joint("turn", "continuous", tip, "bit"))
            wheels = (
                "".join(joint(f"w{k}", "continuous", "cart", f"wheel{k}") for k in range(4))
                + joint("c", "continuous", "cart", "fork")
                + joint("cw", "continuous", "fork", "castor")
            )
            own = (
                '<link name="cart"/>'
                + wheels
                + joint("pan", "revolute", "cart", "neck")
                + joint("tilt", "revolute", "neck", "head")
            )
            for words, kind in (
                ("mobile base", "fixed"),
                ("lift", "prismatic"),
                ("turntable", "revolute"),
            ):
                above = joint("carry", kind, "cart", "base_link").replace(
                    '<link name="base_link"/>', ""
                )
                variant(words, "", own + above)
                variant(
                    words + " called base_link",
                    "",
                    (own + above)
                    .replace('"base_link"', '"arm_base_link"')
                    .replace('"cart"', '"base_link"'),
                    base="arm_base_link",
                    body=text.replace('"base_link"', '"arm_base_link"'),
                )
            gantry = (
                '<link name="floor"/>'
                + joint("x", "prismatic", "floor", "bridge")
                + joint("y", "prismatic", "bridge", "base_link").replace(
                    '<link name="base_link"/>', ""
                )
            )
            variant("gantry", "", gantry)
            if not others:
                side = "b_joint_a" if name == "iiwa14" else "b_joint_"
                for turns in ("fixed", "revolute"):
                    waist = (
                        '<link name="stand"/>'
                        + joint("waist", turns, "stand", "chest")
                        + "".join(
                            joint(f"on_{base}", "fixed", "chest", base).replace(
                                f'<link name="{base}"/>', ""
                            )
                            for base in ("base_link", "b_base_link")
                        )
                    )
                    variant(f"second arm, waist {turns}", prefixed(text, "b_") + waist, also=1)
                    # Without a base of its own: the torso, of which both arms begin.
                    plain = text.replace('"base_link"', '"left_mount"')
                    waist = waist.replace('"base_link"', '"left_mount"').replace(
                        '"b_base_link"', '"b_left_mount"'
                    )
                    # With the waist six joints were seven.
                    turned = len(joints) == 6 and turns == "revolute"
                    variant(
                        f"second arm without a base, waist {turns}",
                        prefixed(plain, "b_") + waist,
                        base="chest" if turned else "stand",
                        body=plain,
                        also=1,
                    )
                legs = "".join(
                    joint(
                        f"{side_}_{part}_joint",
                        "revolute",
                        f"{side_}_{above}" if k else "base_link",
                        f"{side_}_{part}",
                    )
                    for side_ in ("left", "right")
                    for k, (above, part) in enumerate(
                        zip(
                            ("", "hip_yaw", "hip_roll", "hip_pitch", "knee", "ankle_pitch"),
                            (
                                "hip_yaw", "hip_roll", "hip_pitch", "knee", "ankle_pitch",
                                "ankle_roll"
                            ),
                        )
                    )
                )
                variant("legs", legs)
        print(f"{self.ran} robots of {len(self.CLASSES)} arms")
        self.assertFalse(self.wrong, "\n".join(self.wrong))
        self.assertGreaterEqual(self.ran, at_least(200))


class Honoured(WithFolder):
    """What a URDF or SRDF says and the plan does not have: refused in a line, or said as a
    warning."""

    PATH = (
        "path: {waypoints: [{xyz: [0.5, -0.1, 0.4], rpy: [0, 3.1415926536, 0]}, {xyz: [0.5, 0.1, "
        "0.4], rpy: [0, 3.1415926536, 0]}]}\n"
    )

    def files(self, urdf, robot="", more="", srdf=None):
        self.urdf = self.folder / "robot.urdf"
        self.urdf.write_text(urdf)
        if srdf:
            (self.folder / "robot.srdf").write_text(srdf)
            robot += ", srdf: robot.srdf"
        problem = self.folder / "problem.yaml"
        problem.write_text(
            f"robot: {{urdf: robot.urdf, base_link: base_link, tip_link: tool0{robot}}}\n"
            f"{self.PATH}{more}"
        )
        return problem

    def warned(self, *arguments, **keywords):
        done, _, result = self.plan(self.files(*arguments, **keywords))
        self.assertEqual(done.returncode, 0, done.stderr)
        printed = [
            line for line in done.stderr.splitlines() if line.startswith("swivel: warning: ")
        ]
        self.assertEqual(printed, [f"swivel: warning: {warning}" for warning in result["warnings"]])
        return [
            warning
            for warning in result["warnings"]
            if "robot pairs" not in warning and "no collision shape" not in warning
        ]

    def refused(self, done, *words):
        self.assertEqual(done.returncode, 2, done.stdout + done.stderr)
        self.assertEqual(done.stderr.count("\n"), 1, done.stderr)
        for word in words:
            self.assertIn(word, done.stderr)

    def test_soft_limits(self):
        safety = (
            '<safety_controller soft_lower_limit="-1.5" soft_upper_limit="3" k_position="1" '
            'k_velocity="1"/>'
        )
        limits = r'(<joint name="joint_a2".*?<limit [^>]*/>)'
        urdf = re.sub(limits, lambda m: m[1] + safety, IIWA, count=1, flags=re.S)
        warnings = self.warned(urdf)
        line = 1 + urdf[: urdf.index('<joint name="joint_a2"')].count("\n")
        self.assertEqual(len(warnings), 1)
        self.assertIn(
            (
                f"robot.urdf:{line}: joint 'joint_a2' keeps the soft limits of a "
                "safety_controller: -1.5 to 2.0944 of -2.0944 to 2.0944 rad"
            ),
            warnings[0],
        )
        self.assertIn("`limits.soft_limits: false`", warnings[0])
        self.assertIn("warning    " + str(self.urdf), run("info", self.urdf).stdout)
        self.assertEqual(self.warned(urdf, more="limits: {soft_limits: false}\n"), [])
        narrow = urdf.replace('soft_lower_limit="-1.5"', 'soft_lower_limit="1.9"')
        self.assertEqual(run("plan", self.files(narrow)).returncode, 1)
        self.assertEqual(
            run("plan", self.files(narrow, more="limits: {soft_limits: false}\n")).returncode, 0
        )

    def test_empty_ranges(self):
        urdf = re.sub(r'lower="[^"]*" upper="[^"]*"', "", IIWA)
        problem = self.files(urdf)
        line = 1 + urdf[: urdf.index("<joint")].count("\n")
        self.refused(
            run("plan", problem), f"robot.urdf:{line}: joints 'joint_a1', 'joint_a2'",
            "'joint_a7' have an empty range in the URDF"
        )
        self.assertIn("have an empty range in the URDF", run("info", self.urdf).stdout)
        one = re.sub(
            r'(<joint name="joint_a3".*?)lower="[^"]*" upper="[^"]*"', r'\1lower="0.5" upper="0.5"',
            IIWA, count=1, flags=re.S
        )
        self.refused(
            run("plan", self.files(one)),
            "joint 'joint_a3' has an empty range in the URDF (lower = upper = 0.5 rad)",
            "robot.hold",
        )
        self.refused(
            run("plan", self.files(IIWA, more="limits: {joint_margin: 2.5}\n")),
            "limits.joint_margin: leaves no range for joint 'joint_a2'",
        )
        six = self.folder / "six.yaml"
        six.write_text(
            (DATA / "problems/kr6_weld_pipe.yaml")
            .read_text()
            .replace("../", f"{DATA}/")
            .replace("limits: {", "limits: {joint_margin: 4, ")
        )
        self.refused(run("plan", six), "limits.joint_margin: leaves no range for joint 'joint_1'")

    def test_floating_joints(self):
        above = '<link name="world"/>' + joint("free", "floating", "world", "base_link").replace(
            '<link name="base_link"/>', ""
        )
        urdf = IIWA.replace(
            "</robot>", above + joint("thing", "planar", "tool0", "part") + "</robot>"
        )
        for warnings in (
            self.warned(urdf),
            re.findall("^warning    (.*)$", run("info", self.urdf).stdout, re.M),
        ):
            self.assertEqual(len(warnings), 2, warnings)
            self.assertRegex(
                warnings[0], r"robot.urdf:\d+: joint 'free': is floating: it is held at its origin"
            )
            self.assertIn("joint 'thing': is planar", warnings[1])
        for text in (urdf, urdf.replace('"base_link"', '"first"')):  # whatever the base is called
            self.files(text)
            done = run("info", self.urdf)
            self.assertRegex(done.stdout, "arm        (base_link|first) to tool0\n")
            self.assertIn("class      S-R-S", done.stdout)
        problem = self.files(urdf)
        problem.write_text(problem.read_text().replace("base_link: base_link", "base_link: world"))
        self.refused(
            run("plan", problem), "joint 'free' between 'world' and 'tool0' is floating or planar"
        )

    def test_links_left_out(self):
        hand = (
            '<link name="hand"><collision><geometry><mesh filename="absent.stl"/></geometry>'
            '</collision></link>'
            + joint("mount", "fixed", "tool0", "hand").replace('<link name="hand"/>', "")
            + joint("grip", "prismatic", "hand", "finger")
        )
        urdf = IIWA.replace("</robot>", hand + "</robot>")
        self.refused(run("plan", self.files(urdf)), "absent.stl")
        srdf = '<robot name="iiwa14"><disable_collisions link1="finger" link2="link_7"/></robot>'
        self.assertEqual(self.warned(urdf, robot=", without: [hand]", srdf=srdf), [])
        self.refused(
            run("plan", self.files(urdf, robot=", without: [hnad]")),
            "robot.without[0]: unknown link 'hnad', nearest is 'hand'",
        )
        self.assertIn("9 links, 8 joints", run("info", self.urdf, "--without", "hand").stdout)

    def test_srdf(self):
        srdf = (DATA / "robots/iiwa14.srdf").read_text()
        more = (
            '<disable_collisions link1="link_11" link2="link_2"/><passive_joint name="joint_9"/>'
            '</robot>'
        )
        warnings = self.warned(IIWA, srdf=srdf.replace("</robot>", more))
        self.assertEqual(len(warnings), 2, warnings)
        self.assertRegex(
            warnings[0], r"robot\.srdf:\d+: names link 'link_11', which the robot does not have"
        )
        passive = srdf.replace("</robot>", '<passive_joint name="joint_a3"/></robot>')
        self.refused(
            run("plan", self.files(IIWA, srdf=passive)),
            "joint 'joint_a3' is a passive_joint of the SRDF",
        )
        self.assertIn(
            "warning    " + str(self.urdf),
            run("info", self.urdf, "--srdf", self.folder / "robot.srdf").stdout,
        )

    def test_words_of_other_programs(self):
        warnings = self.warned(
            IIWA.replace('<link name="link_4">', '<link name="link_4"><colision/>')
        )
        self.assertEqual(len(warnings), 1, warnings)
        self.assertRegex(
            warnings[0],
            r"robot\.urdf:\d+: unknown element <colision> in <link>, nearest known is 'collision'",
        )

    def test_robots_without_shapes(self):
        urdf = re.sub("<collision>.*?</collision>", "", IIWA, flags=re.S)
        self.files(urdf)
        self.assertIn(
            "shapes     none for collision: the robot is kept clear of nothing\n",
            run("info", self.urdf).stdout,
        )
        self.files(
            urdf.replace(
                '<link name="link_4">',
                (
                    '<link name="link_4"><visual><geometry><mesh filename="x.dae"/></geometry>'
                    '</visual>'
                ),
            )
        )
        self.assertIn(
            "; `swivel fit --visual` fits capsules about its visual meshes\n",
            run("info", self.urdf).stdout,
        )
        self.assertNotIn("shapes ", run("info", DATA / "robots/iiwa14.urdf").stdout)

    def test_files_of_the_wrong_kind(self):
        problem = self.files(IIWA)
        self.refused(
            run("info", problem), "is a problem file", "`swivel info --pairs ", "`swivel plan "
        )
        self.refused(run("fit", problem), "is a problem file", "a URDF file")
        self.refused(run("plan", self.urdf), "is XML", "`swivel info`")
        problem.write_text(problem.read_text().replace("urdf: robot.urdf", "urdf: problem.yaml"))
        self.refused(run("plan", problem), "problem.yaml:1: robot.urdf", "is a problem file")


class Pairs(WithFolder):
    """The table of `swivel info PROBLEM --pairs`."""

    def pairs(self, clearance):
        text = (DATA / "problems/experiment_c.yaml").read_text()
        text = text.replace("clearance: 0.005", f"clearance: {clearance}")
        text = text.replace("../", f"{DATA}/")
        problem = self.folder / "problem.yaml"
        problem.write_text(re.sub(r"^ *srdf: .*\n", "", text, flags=re.M))
        code, lines = on_terminal("stdout", [SWIVEL, "info", str(problem), "--pairs"])
        self.assertEqual(code, 0)
        total, counted, reduced, dropped = map(int, re.findall(r"\d+", lines[0]))
        self.assertEqual(total, counted + dropped)
        rows = [line.split() for line in lines if re.search(" (counts|reduced|dropped) ", line)]
        self.assertTrue(all(len(line) <= 80 for line in lines), lines)
        # No two rows are alike but for their medians, and none is left out.
        kinds = [(*row[:2], row[3], *row[5:]) for row in rows]
        self.assertEqual(len(set(kinds)), len(kinds))
        self.assertEqual(sum(int(row[2]) for row in rows), total)
        self.assertEqual(sum(int(row[2]) for row in rows if row[3] == "reduced"), reduced)
        self.assertGreater(total - len(rows), 10)
        return lines, rows

    def test_alike_rows_are_one(self):
        lines, rows = self.pairs(0.005)
        self.assertEqual(lines[1], "all keep 5/2.5/0.5 mm (on layers/on motions/tolerance)")
        self.assertEqual({len(row) for row in rows}, {5})

    def test_what_rows_keep_that_keep_less(self):
        lines, rows = self.pairs(0.1)
        usual = re.match(r"(\d+) keep (100/\S+) mm .*, others what", " ".join(lines[1:3]))
        self.assertEqual(
            int(usual[1]),
            sum(int(row[2]) for row in rows if row[3] == "counts" or row[5:] == [usual[2]]),
        )
        less = [row for row in rows if row[3] == "reduced"]
        self.assertTrue(less)
        for row in less:
            self.assertLess(float(row[5].split("/")[0]), 100)


class MoreAxes(WithFolder):
    """What `swivel info` says of tables, rails and torsos of arms of six joints."""

    def test_found(self):
        done = run("info", DATA / "robots/kr6_turntable_like.urdf")
        self.assertIn(
            "table      table_joint turns plate: --base plate makes it the first of seven joints\n",
            done.stdout,
        )
        with_it = run("info", DATA / "robots/kr6_turntable_like.urdf", "--base", "plate").stdout
        self.assertRegex(with_it, r"joint 1 +table_joint ")
        self.assertNotIn("\ntable ", with_it)

    def test_none(self):
        kr6 = (DATA / "robots/kr6_like.urdf").read_text()
        for more in (
            "",
            joint("finger", "revolute", "flange", "f"),
            joint("torso", "fixed", "base_link", "t") + joint("rail", "prismatic", "t", "r"),
            joint("a", "revolute", "base_link", "p") + joint("b", "revolute", "p", "q"),
        ):
            urdf = self.folder / "robot.urdf"
            urdf.write_text(kr6.replace("</robot>", more + "</robot>"))
            done = run("info", urdf, "--tip", "flange", "--roll")
            self.assertEqual(done.returncode, 0, done.stderr)
            tilts = re.findall(r"^table +(\S+)", done.stdout, re.M)
            # Of a table on a table the lower one alone is an axis that turns about one line.
            found = ["a"] if '"q"' in more else ["rail"] if "rail" in more else []
            self.assertEqual(tilts, found, done.stdout)

    def test_tables_beside_a_rail_and_legs(self):
        urdf, turn = self.folder / "robot.urdf", joint("table", "revolute", "track", "plate")
        rail = (DATA / "robots/ur10e_rail_like.urdf").read_text()
        urdf.write_text(rail.replace("</robot>", turn + "</robot>"))
        done = run("info", urdf).stdout
        self.assertIn("table      table turns plate: --base plate --hold rail=0 makes it", done)
        self.assertRegex(done, r"\nrail +rail shifts carriage: --base track makes it the first of")
        with_it = run("info", urdf, "--base", "plate", "--hold", "rail=0").stdout
        self.assertRegex(with_it, r"joint 1 +table ")
        parents = zip(("base_link", "thigh", "shin"), ("thigh", "shin", "foot"))
        leg = "".join(joint(f"on_{child}", "revolute", up, child) for up, child in parents)
        kr6 = (DATA / "robots/kr6_like.urdf").read_text()
        urdf.write_text(kr6.replace("</robot>", leg + "</robot>"))
        self.assertNotIn("\ntable ", run("info", urdf, "--tip", "flange", "--roll").stdout)

    def test_short_rows(self):
        turns = joint("j1", "revolute", "room", "a") + joint("j2", "revolute", "a", "b")
        urdf = self.folder / "robot.urdf"
        urdf.write_text(
            f'<robot name="r"><link name="room"/>{turns}{joint("turn", "revolute", "room", "t")}'
            "</robot>"
        )
        done = run("info", urdf)
        self.assertEqual(done.returncode, 2)
        self.assertIn("longest row of joints that turn has 2, from 'j1' to 'j2'", done.stderr)

    def test_rails_and_torsos(self):
        done = run("info", DATA / "robots/ur10e_rail_like.urdf")
        self.assertIn(
            "rail       rail shifts carriage: --base track makes it the first of seven joints\n",
            done.stdout,
        )
        with_it = run("info", DATA / "robots/ur10e_rail_like.urdf", "--base", "track").stdout
        self.assertRegex(with_it, r"joint 1 +rail +-1.8000 to +1.8000 m, 1.000 m/s\n")
        self.assertIn("class      6R and a slide, joint 1\n", with_it)
        self.assertNotIn("\nheld ", with_it)
        for more in (("--roll",), ("--hold", "rail=0.5")):
            held = run("info", DATA / "robots/ur10e_rail_like.urdf", "--base", "track", *more)
            self.assertIn("held       rail at ", held.stdout, held.stderr)
        kr6 = (DATA / "robots/kr6_like.urdf").read_text()
        torso = '<link name="stand"/>' + joint("waist", "revolute", "stand", "base_link").replace(
            '<link name="base_link"/>', ""
        )
        urdf = self.folder / "robot.urdf"
        urdf.write_text(kr6.replace("</robot>", torso + "</robot>"))
        self.assertIn(
            "torso      waist turns base_link: --base stand makes it the first of seven joints\n",
            run("info", urdf).stdout,
        )
        self.assertRegex(run("info", urdf, "--base", "stand").stdout, r"joint 1 +waist ")

    def test_two_slides_and_one_too_many_joints(self):
        urdf = self.folder / "robot.urdf"
        kr6 = (DATA / "robots/ur10e_rail_like.urdf").read_text()
        gantry = '<link name="floor"/>' + joint("lift", "prismatic", "floor", "track").replace(
            '<link name="track"/>', ""
        )
        urdf.write_text(kr6.replace("</robot>", gantry + "</robot>"))
        options = ("--base", "floor", "--tip", "flange")
        done = run("info", urdf, *options)
        self.assertEqual(done.returncode, 2)
        self.assertIn("'rail' is prismatic, and 8 joints move between base and tip", done.stderr)
        done = run("info", urdf, *options, "--hold", "lift=0")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("class      6R and a slide, joint 1\n", done.stdout)
        fixed = kr6.replace('name="joint_1" type="revolute"', 'name="joint_1" type="prismatic"')
        urdf.write_text(fixed)
        done = run("info", urdf, "--base", "track", "--tip", "flange")
        self.assertEqual(done.returncode, 2)
        self.assertIn("joints 'rail' and 'joint_1' are prismatic", done.stderr)


class FirstProblem(WithFolder):
    """`swivel info --write`: the file that it writes is planned without an edit."""

    def write(self, urdf, *options, file="first.yaml"):
        return run("info", urdf, *options, "--write", self.folder / file)

    def plans(self, urdf, *options, file="first.yaml"):
        done = self.write(urdf, *options, file=file)
        self.assertEqual((done.returncode, done.stderr), (0, ""), urdf)
        said = re.search(r"\nwritten    .* planned with cost ([\d.]+);", done.stdout)
        done = run("plan", self.folder / file)
        self.assertEqual(done.returncode, 0, f"{urdf}: {done.stdout}{done.stderr}")
        found = re.search(r" cost ([\d.]+) ", done.stdout)
        self.assertAlmostEqual(float(said[1]), float(found[1]), delta=2e-4)
        return (self.folder / file).read_text()

    def test_every_robot(self):
        robots = sorted((DATA / "robots").glob("*.urdf"))
        for urdf in robots:
            with self.subTest(urdf=urdf.name):
                srdf = urdf.with_suffix(".srdf")
                self.plans(urdf, *(("--srdf", srdf) if srdf.exists() else ()))
        self.assertGreaterEqual(len(robots), 10)

    def test_options_are_kept(self):
        text = IIWA.replace("</robot>", joint("finger", "revolute", "tool0", "gripper")
                            + "</robot>")
        (self.folder / "sub dir").mkdir()
        urdf = self.folder / "sub dir" / "r.urdf"
        urdf.write_text(text)
        written = self.plans(urdf, "--tip", "link_7", "--without", "gripper")
        self.assertIn('  urdf: "sub dir/r.urdf"\n', written)
        self.assertIn("  without:\n    - gripper\n", written)
        self.assertIn("  tip_link: link_7\n", written)
        written = self.plans(urdf, "--hold", "finger=0.25", file="sub dir/held.yaml")
        self.assertIn("  urdf: r.urdf\n", written)
        self.assertIn("  hold:\n    finger: 0.25\n", written)
        written = self.plans(DATA / "robots/kr6_like.urdf")
        self.assertIn("  roll: free\n", written)

    def test_odd_names(self):
        names = ["1", "true", "a: b", "#c", "- d", "~", "null", "1e3", "e\\f", "{g}", "é", "y"]
        for name in names:
            with self.subTest(name=name):
                urdf = self.folder / "robot.urdf"
                urdf.write_text(IIWA.replace('"tool0"', f'"{name}"'))
                self.plans(urdf, "--tip", name)

    def test_standard_output(self):
        done = run("info", DATA / "robots/iiwa14.urdf", "--write", "-")
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        self.assertTrue(done.stdout.startswith("# A problem to begin with"), done.stdout)

    def test_refused(self):
        urdf = self.folder / "robot.urdf"
        urdf.write_text(IIWA)
        for file in ("robot.urdf", "no/such/first.yaml"):
            done = self.write(urdf, file=file)
            self.assertEqual((done.returncode, len(done.stderr.splitlines())), (2, 1), file)
        self.assertEqual(urdf.read_text(), IIWA)
        # An arm that hardly moves follows no path.
        narrow = 'lower="0.5" upper="0.501"'
        urdf.write_text(re.sub(r'lower="[^"]*" upper="[^"]*"', narrow, IIWA))
        done = self.write(urdf)
        self.assertEqual((done.returncode, len(done.stderr.splitlines())), (2, 1), done.stderr)
        self.assertIn("--write: none of ", done.stderr)
        self.assertFalse((self.folder / "first.yaml").exists())


if __name__ == "__main__":
    unittest.main(verbosity=1)

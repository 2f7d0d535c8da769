#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""`swivel info` without options: which arm it finds on robots of many kinds."""
import re
import unittest

from cli_test import DATA, WithFolder, run

IIWA = (DATA / "robots/iiwa14.urdf").read_text()


def joint(name, kind, parent, child, xyz="0 0 0.05", axis="0 0 1", more=""):
    limit = '<limit lower="-1" upper="1" velocity="1" effort="1"/>' if kind in ("revolute", "prismatic") else ""
    return f'<joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/><origin xyz="{xyz}"/><axis xyz="{axis}"/>{limit}{more}</joint><link name="{child}"/>'


class Info(WithFolder):
    def info(self, more="", *options, text=IIWA):
        file = self.folder / "robot.urdf"
        file.write_text(text.replace("</robot>", more + "</robot>"))
        return run("info", file, *options)

    def finds(self, done, base, tip, words="S-R-S"):
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn(f"arm        {base} to {tip}\n", done.stdout)
        self.assertIn(f"class      {words}", done.stdout)
        self.assertEqual(re.findall(r"^joint \d +(\S+)", done.stdout, re.M), [f"joint_a{k}" for k in range(1, 8)])

    def test_arm_alone(self):
        self.finds(self.info(), "base_link", "tool0")

    def test_gripper(self):
        for fingers in (joint("left", "prismatic", "tool0", "l", axis="0 1 0") + joint("right", "prismatic", "tool0", "r", axis="0 -1 0", more='<mimic joint="left"/>'),
                        joint("left", "revolute", "tool0", "l") + joint("right", "revolute", "tool0", "r", more='<mimic joint="left"/>'),
                        joint("left", "revolute", "tool0", "l") + joint("left2", "revolute", "l", "l2") + joint("right", "revolute", "tool0", "r"),
                        joint("one", "prismatic", "tool0", "l"), joint("one", "revolute", "tool0", "l") + joint("two", "revolute", "l", "l2"),
                        joint("spindle", "continuous", "tool0", "bit")):
            with self.subTest(fingers=fingers):
                self.finds(self.info(fingers), "base_link", "tool0")

    def test_named_tools(self):
        self.finds(self.info(joint("mount", "fixed", "link_7", "hand") + joint("end", "fixed", "hand", "hand_tcp")), "base_link", "tool0")
        renamed = IIWA.replace('"tool0"', '"plate"')
        self.finds(self.info(joint("mount", "fixed", "link_7", "hand") + joint("end", "fixed", "hand", "hand_tcp"), text=renamed), "base_link", "hand_tcp")
        self.finds(self.info(text=renamed), "base_link", "plate")
        hand = joint("mount", "fixed", "plate", "hand") + joint("left", "prismatic", "hand", "l") + joint("right", "prismatic", "hand", "r")
        self.finds(self.info(hand, text=renamed), "base_link", "plate")

    def test_torso_and_mobile_base(self):
        for above in (joint("lift", "prismatic", "cart", "base_link"), joint("turn", "revolute", "cart", "base_link"), joint("mount", "fixed", "cart", "base_link")):
            with self.subTest(above=above):
                more = '<link name="cart"/>' + above.replace('<link name="base_link"/>', "") + joint("w1", "continuous", "cart", "wheel_1") + joint("w2", "continuous", "cart", "wheel_2")
                self.finds(self.info(more), "base_link", "tool0")

    def test_second_arm(self):
        links = re.findall(r'<link name="([^"]*)"', IIWA)
        other = re.search(r"<robot[^>]*>(.*)</robot>", IIWA, re.S).group(1)
        for name in sorted(set(links + re.findall(r'<joint name="([^"]*)"', IIWA)), key=len, reverse=True):
            other = other.replace(f'"{name}"', f'"b_{name}"')
        # The other comes first in the file, and has an elbow that is no S-R-S arm's.
        bent = re.sub(r'(<joint name="b_joint_a7".*?<origin xyz=")\S+', r"\g<1>0.088", other, flags=re.S)
        mount = '<link name="stand"/>' + "".join(joint(f"m_{k}", "fixed", "stand", k).replace(f'<link name="{k}"/>', "") for k in ("base_link", "b_base_link"))
        for second, first in ((other, "base_link to tool0"), (bent, "base_link to tool0")):
            done = self.info(second + mount)
            self.finds(done, "base_link", "tool0")
            self.assertIn("other arm  b_base_link to b_tool0", done.stdout)
        self.assertIn("arm        stand to b_tool0\n", self.info(other + mount, "--base", "stand", "--tip", "b_tool0").stdout)
        self.assertIn("arm        b_base_link to b_tool0\n", self.info(other + mount, "--base", "b_base_link").stdout)

    def test_not_srs(self):
        for number, ends, axes, lock in ((7, "a spherical shoulder and no spherical wrist", "6 and 7", "axes 1, 2 and 3 meet in a point"),
                                         (2, "no spherical shoulder and a spherical wrist", "1 and 2", "axes 5, 6 and 7 meet in a point")):
            bent = re.sub(rf'(<joint name="joint_a{number}".*?<origin xyz=")\S+', r"\g<1>0.088", IIWA, flags=re.S)
            self.assertNotEqual(bent, IIWA)
            done = self.info(joint("left", "prismatic", "tool0", "l") + joint("right", "prismatic", "tool0", "r"), text=bent)
            self.assertEqual((done.returncode, done.stderr), (0, ""))
            for line in (f"class      7R with {ends}\n", f"not S-R-S  axes {axes} miss each other by 88.0 mm\n",
                         f"solutions  all: closed form: {lock}; locks joint "):
                self.assertIn(line, done.stdout)

    def test_six_joints_and_a_gripper(self):
        six = IIWA.replace('<joint name="joint_a3" type="revolute">', '<joint name="joint_a3" type="fixed">')
        self.assertNotEqual(six, IIWA)
        done = self.info(joint("left", "prismatic", "tool0", "l") + joint("right", "revolute", "tool0", "r"), text=six)
        self.assertEqual((done.returncode, done.stdout), (2, ""))
        self.assertIn("no arm of seven joints: the longest row of joints that turn has 6, from 'joint_a1' to 'joint_a7'", done.stderr)
        for name in ("left", "right", "prismatic"):
            self.assertNotIn(name, done.stderr)

    def test_meshes_are_not_needed(self):
        mesh = '<link name="shell"><collision><geometry><mesh filename="package://some_robot/meshes/shell.stl"/></geometry></collision></link>'
        more = mesh + joint("glue", "fixed", "base_link", "shell").replace('<link name="shell"/>', "")
        done = self.info(more)
        self.finds(done, "base_link", "tool0")
        for word in ("meshes     1 not found", "package://some_robot/meshes/shell.stl", "robot.packages: {some_robot: "):
            self.assertIn(word, done.stdout)
        shelf = self.folder / "shelf" / "any-name"
        (shelf / "meshes").mkdir(parents=True)
        (shelf / "meshes/shell.stl").write_bytes(b"not even a mesh")
        self.assertNotIn("meshes", self.info(more, "--packages", f"some_robot={shelf}").stdout)
        for wrong in ("some_robot", "=x", f"some_robot={shelf}/nowhere"):
            done = self.info(more, "--packages", wrong)
            self.assertEqual((done.returncode, done.stdout), (2, ""))
            self.assertIn("--packages", done.stderr)

    def test_near_matches(self):
        for options, words in ((("--tip", "tol0"), "--tip: unknown link 'tol0', nearest is 'tool0'"), (("--base", "baselink"), "--base: unknown link 'baselink', nearest is 'base_link'"),
                               (("--hold", "joint_a8=1"), "--hold: unknown joint 'joint_a8', nearest is 'joint_a1'")):
            done = self.info("", *options)
            self.assertEqual((done.returncode, len(done.stderr.splitlines())), (2, 1))
            self.assertIn(words, done.stderr)
        problem = self.folder / "problem.yaml"
        problem.write_text(f"robot: {{urdf: {DATA}/robots/iiwa14.urdf, base_link: base_link, tip_link: tol0}}\npath: {{waypoints: [{{xyz: [0.5, 0, 0.5]}}, {{xyz: [0.5, 0.1, 0.5]}}]}}\n")
        self.assertIn("unknown link 'tol0', nearest is 'tool0'", run("plan", problem).stderr)


if __name__ == "__main__":
    unittest.main(verbosity=1)

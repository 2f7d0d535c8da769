#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Arms of six joints whose tool stands as the waypoints have it: a path, a job and two arms, with
six numbers and no roll in files and messages."""
import csv
import json
import re
import unittest
import xml.etree.ElementTree as ET

from cli_test import DATA, PROBLEMS, WithFolder, run

LINE = PROBLEMS / "ur5e_probe_line.yaml"
NAMES = [f"joint_{k}" for k in range(1, 7)]
DOWN = "rpy: [3.141592653589793, 0, 0]"


def two_ur5e(folder):
    """Writes a robot of two arms that face each other, 1 m apart. Returns its URDF and SRDF."""
    whole = ET.Element("robot", name="pair")
    ET.SubElement(whole, "link", name="room")
    groups = ET.Element("robot", name="pair")
    for side, place, yaw in (("left", "0 0 0", "0"), ("right", "1 0 0", "3.141592653589793")):
        for element in ET.parse(DATA / "robots" / "ur5e_like.urdf").getroot():
            for one in element.iter():
                for key in ("name", "link"):
                    if key in one.attrib and one.tag in ("link", "joint", "parent", "child"):
                        one.set(key, f"{side}_{one.get(key)}")
            whole.append(element)
        base = ET.SubElement(whole, "joint", name=f"{side}_base", type="fixed")
        ET.SubElement(base, "parent", link="room")
        ET.SubElement(base, "child", link=f"{side}_base_link")
        ET.SubElement(base, "origin", xyz=place, rpy=f"0 0 {yaw}")
        for element in ET.parse(DATA / "robots" / "ur5e_like.srdf").getroot():
            if element.tag == "disable_collisions":
                for key in ("link1", "link2"):
                    element.set(key, f"{side}_{element.get(key)}")
                groups.append(element)
    for name, tree in (("pair.urdf", whole), ("pair.srdf", groups)):
        ET.ElementTree(tree).write(folder / name)


def cell_text(right_frame, right):
    """Two arms; `right`: poses of the right one's waypoints."""
    poses = ", ".join("{" + pose + "}" for pose in right)
    return f"""
robot: {{urdf: pair.urdf, srdf: pair.srdf, base_link: room}}
arms:
  - name: left
    tip_link: left_flange
    tool: {{xyz: [0, 0, 0.1]}}
    path:
      waypoints: [{{xyz: [0.3, 0.15, 0.3], {DOWN}}}, {{xyz: [0.38, 0.2, 0.35], {DOWN}}}]
  - name: right
    tip_link: right_flange
    tool: {{xyz: [0, 0, 0.1]}}
    path:
      frame: {right_frame}
      waypoints: [{poses}]
resolution: {{ds: 0.01}}
limits: {{clearance: 0.005, tool_path_error: 0.001}}
"""


class SixJoints(WithFolder):
    def solved(self, *arguments):
        done = run("plan", *arguments)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertNotIn("roll", done.stdout + done.stderr)
        return done

    def header(self, file):
        with open(file, newline="") as rows:
            return next(csv.reader(rows))

    def test_a_path(self):
        out = [self.folder / f"o.{end}" for end in ("csv", "json", "yaml", "mcap")]
        rows, result = self.folder / "rows.csv", self.folder / "result.json"
        self.solved(LINE, "--out", rows, "--json", result)
        self.assertEqual(self.header(rows), ["s", "phi", "branch", *NAMES])
        document = json.loads(result.read_text())
        self.assertEqual(document["joint_names"], NAMES)
        self.assertEqual({len(row["joints"]) for row in document["trajectory"]}, {6})
        self.assertNotIn('"roll"', result.read_text())
        self.assertEqual(run("check", LINE, rows).returncode, 0)
        for file in out:
            self.solved(LINE, "--speed", "0.05", "--out", file)
            done = run("check", LINE, file)
            self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        motion = json.loads(out[1].read_text())
        self.assertEqual(motion["joint_names"], NAMES)
        self.assertEqual({len(point["positions"]) for point in motion["points"]}, {6})
        self.assertEqual(
            self.header(out[0]),
            ["t", "s", "phi", "branch", *NAMES, *(f"{name}_v" for name in NAMES),
             *(f"{name}_a" for name in NAMES)])

    def test_numbers_of_joints(self):
        text = LINE.read_text().replace("../", f"{DATA}/")
        cases = [
            (text.replace("3.3415926535897933]", "3.3415926535897933, 0]"), "start.joints: has 7"),
            (text + "cost: {weights: [1, 1, 1, 1, 1, 1, 0]}\n", "cost.weights: has 7"),
            (text.replace("limits: {", "limits: {joint_speed: [1, 1, 1, 1, 1, 1, 1], "),
             "limits.joint_speed: has 7"),
            (text.replace("ds: 0.005", "ds: 0.005, knot: 0.05"), "resolution.knot: "),
            (text.replace("limits: {", "limits: {roll_slope: 3, "), "limits.roll_slope: "),
            (text + "cost: {roll: 1}\n", "cost.roll: "),
        ]
        file = self.folder / "p.yaml"
        for changed, words in cases:
            file.write_text(changed)
            done = run("plan", file)
            self.assertEqual(done.returncode, 2, (words, done.stdout, done.stderr))
            self.assertIn(words, done.stderr)
        file.write_text(
            text + "cost: {weights: [1, 2, 1, 1, 1, 0]}\n"
            .replace("limits: {", "limits: {joint_speed: [1, 1, 1, 1, 1, 1], "))
        self.solved(file, "--speed", "0.02", "--out", self.folder / "o.csv")
        file.write_text(text + "cost: {weights: {joint_2: 2}}\n")
        self.solved(file)

    def test_no_path_and_advice(self):
        text = (PROBLEMS / "kr6_weld_pipe.yaml").read_text().replace("../", f"{DATA}/")
        file, proof = self.folder / "p.yaml", self.folder / "none.json"
        file.write_text(text.replace("  roll: free\n", ""))
        done = run("plan", file, "--certificate", proof, "--advise", "20")
        self.assertEqual(done.returncode, 1, done.stdout + done.stderr)
        self.assertRegex(done.stdout, r"joint joint_5 \(.* beyond ")
        self.assertIn("a tool free to turn about its axis (path.roll) (solved", done.stdout)
        done = run("check", file, "--certificate", proof)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)

    def test_a_limit_that_excludes_a_layer_is_named(self):
        for roll in ("  roll: free\n", ""):
            text = (PROBLEMS / "kr6_weld_pipe.yaml").read_text().replace("../", f"{DATA}/")
            text = text.replace("  roll: free\n", roll)
            file = self.folder / "p.yaml"
            file.write_text(
                text.replace("limits: {", "limits: {joints: {joint_2: [-3.3, -3.2]}, "))
            done = run("plan", file)
            self.assertEqual(done.returncode, 1, done.stdout + done.stderr)
            self.assertRegex(done.stdout, r"no valid node: joint joint_2 \(.* beyond -183.35 deg")

    def test_followers_that_narrow_a_joint_are_told(self):
        """A joint that mimics joint_2 of the arm, with a range of its own."""
        rod = """
  <link name="rod"/>
  <joint name="piston" type="revolute"><parent link="link_1"/><child link="rod"/>
    <axis xyz="0 0 1"/><mimic joint="joint_2" multiplier="-0.5"/>
    <limit lower="-0.7" upper="1.2" effort="0" velocity="3"/></joint>
</robot>"""
        urdf = (DATA / "robots" / "ur5e_like.urdf").read_text().replace("</robot>", rod)
        (self.folder / "arm.urdf").write_text(urdf)
        told = ("'joint_2' is planned within -2.4 to 1.4 rad, not -6.28319 to 6.28319 rad: the "
                "limits of what mimics it allow no more ('piston')")
        done = run("info", self.folder / "arm.urdf", "--base", "base_link", "--tip", "flange")
        self.assertIn(told, done.stdout)
        file = self.folder / "p.yaml"
        file.write_text(LINE.read_text().replace("../robots/ur5e_like.urdf", "arm.urdf")
                        .replace("../", f"{DATA}/"))
        self.assertIn(told, run("plan", file).stderr)

    def test_a_job(self):
        text = (PROBLEMS / "ur5e_deburr_plate_job.yaml").read_text().replace("../", f"{DATA}/")
        file = self.folder / "job.yaml"
        file.write_text(re.sub(r"\n *roll: \[[^\n]*", "", re.sub(r", roll: \[[^\]]*\]", "", text)))
        self.assertNotIn("roll:", file.read_text())
        for name, more in (("rows", ()), ("motion", ("--speed", "0.02"))):
            out = self.folder / f"{name}.csv"
            self.solved(file, "--out", out, *more)
            self.assertEqual([one for one in self.header(out) if one in NAMES], NAMES)
            self.assertNotIn("roll", self.header(out))
            done = run("check", file, out)
            self.assertEqual(done.returncode, 0, done.stdout + done.stderr)

    def test_two_arms(self):
        two_ur5e(self.folder)
        file, out = self.folder / "cell.yaml", self.folder / "o.csv"
        own = (f"xyz: [0.7, 0.15, 0.3], {DOWN}", f"xyz: [0.62, 0.2, 0.35], {DOWN}")
        held = ("xyz: [0.3, 0, 0]", "xyz: [0.3, 0, 0]")
        for frame, poses in (("room", own), ("left", held)):
            with self.subTest(frame=frame):
                file.write_text(cell_text(frame, poses))
                self.solved(file, "--out", out)
                self.assertEqual(
                    [one for one in self.header(out) if "joint" in one],
                    [f"{side}_{name}" for side in ("left", "right") for name in NAMES])
                done = run("check", file, out)
                self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
                self.solved(file, "--speed", "0.05", "--out", out)
                done = run("check", file, out)
                self.assertEqual(done.returncode, 0, done.stdout + done.stderr)


if __name__ == "__main__":
    unittest.main()

#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""`swivel fit`: capsules in place of meshes, read again from the file that it writes."""
import math
import re
import unittest
import xml.etree.ElementTree as xml

from cli_test import DATA, WithFolder, run

# A wedge: a closed mesh of eight triangles, mm.
WEDGE = [(0, 0, 0), (80, 0, 0), (80, 60, 0), (0, 60, 0), (0, 0, 200), (0, 60, 200)]
SIDES = [(0, 2, 1), (0, 3, 2), (0, 1, 4), (1, 2, 5), (1, 5, 4), (2, 3, 5), (0, 4, 5), (0, 5, 3)]


def rotation(roll, pitch, yaw):
    (a, b), (c, d), (e, f) = ((math.cos(x), math.sin(x)) for x in (roll, pitch, yaw))
    return [
        [e * c, e * d * b - f * a, e * d * a + f * b],
        [f * c, f * d * b + e * a, f * d * a - e * b],
        [-d, c * b, c * a],
    ]


def numbers(element, name):
    return [float(word) for word in element.get(name).split()]


class Fit(WithFolder):
    def setUp(self):
        super().setUp()
        (self.folder / "wedge.obj").write_text(
            "".join(f"v {x} {y} {z}\n" for x, y, z in WEDGE)
            + "".join(f"f {a + 1} {b + 1} {c + 1}\n" for a, b, c in SIDES)
        )
        self.mesh = (
            '<collision><origin xyz="0.01 0.02 0.03" rpy="0.1 0.2 0.3"/><geometry>'
            '<mesh filename="wedge.obj" scale="0.001 0.001 0.001"/></geometry></collision>'
        )
        self.text = (DATA / "robots/iiwa14.urdf").read_text()
        self.urdf = self.folder / "robot.urdf"
        self.with_mesh("link_4")

    def with_mesh(self, link):
        opened = f'<link name="{link}">'
        self.assertIn(opened, self.text)
        self.text = self.text.replace(opened, opened + "<!-- a wedge -->" + self.mesh)
        self.urdf.write_text(self.text)

    def shapes(self, file, link):
        """Cylinders between their spheres, and spheres, as end, other end and radius; what else
        there is as text."""
        ends, others = [], []
        for collision in (
            xml.parse(file).getroot().find(f"link[@name='{link}']").findall("collision")
        ):
            origin, shape = collision.find("origin"), collision.find("geometry")[0]
            if shape.tag == "cylinder":
                axis = [row[2] for row in rotation(*numbers(origin, "rpy"))]
                half, middle = float(shape.get("length")) / 2, numbers(origin, "xyz")
                ends.append(
                    (
                        [m - half * a for m, a in zip(middle, axis)],
                        [m + half * a for m, a in zip(middle, axis)],
                        float(shape.get("radius")),
                    )
                )
            elif shape.tag == "sphere":
                ends.append(
                    (numbers(origin, "xyz"), numbers(origin, "xyz"), float(shape.get("radius")))
                )
            else:
                others.append(xml.tostring(collision, encoding="unicode"))
        return ends, others

    def test_capsules_hold_the_mesh(self):
        out = self.folder / "fitted.urdf"
        for most in (1, 3):
            with self.subTest(most=most):
                done = run("fit", self.urdf, "--out", out, "--capsules", most)
                self.assertEqual(done.returncode, 0, done.stderr)
                self.assertRegex(
                    done.stdout,
                    (
                        r"^link_4 +8 triangles -> [1-3], [\d.]+ l for 0\.48, reaching up to [\d.]+ "
                        r"mm further\n1 meshes"
                    ),
                )
                fitted, others = self.shapes(out, "link_4")
                kept, before = self.shapes(self.urdf, "link_4")
                self.assertEqual(len(before), 1)
                self.assertEqual(others, [])
                fitted = [shape for shape in fitted if shape not in kept]
                self.assertIn(len(fitted), range(1, 3 * most + 1))
                turn = rotation(0.1, 0.2, 0.3)
                for corner in WEDGE:
                    p = [
                        sum(row[k] * corner[k] / 1000 for k in range(3)) + at
                        for row, at in zip(turn, (0.01, 0.02, 0.03))
                    ]

                    def away(a, b, radius):
                        way = [y - x for x, y in zip(a, b)]
                        length2 = sum(w * w for w in way)
                        along = (
                            min(1, max(0, sum(w * (x - y) for w, x, y in zip(way, p, a)) / length2))
                            if length2
                            else 0
                        )
                        return math.dist(p, [x + along * w for x, w in zip(a, way)]) - radius

                    self.assertLess(min(away(*shape) for shape in fitted), 1e-12)

    def test_all_else_stays_as_it_was(self):
        out = self.folder / "fitted.urdf"
        self.assertEqual(run("fit", self.urdf, "--out", out).returncode, 0)
        self.assertIn("<!-- a wedge -->", out.read_text())
        before, after = xml.parse(self.urdf).getroot(), xml.parse(out).getroot()
        self.assertEqual([element.tag for element in before], [element.tag for element in after])
        for one, other in zip(before, after):
            if one.get("name") != "link_4":
                self.assertEqual(
                    [(e.tag, e.attrib) for e in one.iter()],
                    [(e.tag, e.attrib) for e in other.iter()],
                )
        # A capsule is read as one: the robot has as many bodies more as capsules.
        plan = run("plan", self.problem_of(out), "--quiet")
        self.assertEqual(plan.returncode, 0, plan.stdout + plan.stderr)

    def problem_of(self, urdf):
        problem = self.folder / "problem.yaml"
        problem.write_text(
            f"robot: {{urdf: {urdf}, srdf: {DATA}/robots/iiwa14.srdf, base_link: base_link, "
            f"tip_link: tool0}}\n"
            "path: {waypoints: [{xyz: [0.5, -0.1, 0.4], rpy: [0, 3.1415926536, 0]}, {xyz: [0.5, "
            "0.1, 0.4], rpy: [0, 3.1415926536, 0]}]}\n"
            "limits: {clearance: 0.001}\n"
        )
        return problem

    def test_one_link_of_two(self):
        self.with_mesh("link_2")
        done = run("fit", self.urdf, "--link", "link_2", "--out", "-")
        self.assertEqual(done.returncode, 0, done.stderr)
        links = {link.get("name"): link for link in xml.fromstring(done.stdout).findall("link")}
        self.assertIsNone(links["link_2"].find("collision/geometry/mesh"))
        self.assertIsNotNone(links["link_4"].find("collision/geometry/mesh"))
        self.assertIn("2 meshes", run("fit", self.urdf).stdout)

    def test_meshes_that_are_left_are_found_from_another_folder(self):
        self.with_mesh("link_2")
        (self.folder / "there").mkdir()
        out = self.folder / "there" / "fitted.urdf"
        self.assertEqual(run("fit", self.urdf, "--link", "link_2", "--out", out).returncode, 0)
        self.assertIn('filename="../wedge.obj"', out.read_text())
        self.assertIn("link_4 ", run("fit", out).stdout)

    def test_visual_meshes_of_links_without_collision_shapes(self):
        visual = self.mesh.replace("collision>", "visual>")
        box = (
            '<visual><origin xyz="0 0 0.1"/><geometry><box size="0.1 0.1 0.1"/></geometry></visual>'
        )
        self.text = re.sub(
            '<link name="link_4">.*?</link>',
            f'<link name="link_4">{visual}{box}</link>',
            (DATA / "robots/iiwa14.urdf").read_text(),
            count=1,
            flags=re.S,
        )
        # Has collision shapes.
        self.text = self.text.replace('<link name="link_5">', '<link name="link_5">' + visual)
        self.urdf.write_text(self.text)
        self.assertIn(
            "or --visual, which fits capsules about its visual meshes", run("fit", self.urdf).stderr
        )
        out = self.folder / "fitted.urdf"
        done = run("fit", self.urdf, "--visual", "--out", out)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertRegex(done.stdout, r"^link_4 .*\n1 meshes")
        fitted, others = self.shapes(out, "link_4")
        self.assertGreaterEqual(len(fitted), 1)
        self.assertEqual(len(others), 1)
        self.assertIn('<box size="0.1 0.1 0.1"', others[0])
        link = xml.parse(out).getroot().find("link[@name='link_4']")
        self.assertEqual(len(link.findall("visual")), 2)
        self.assertEqual(self.shapes(out, "link_5"), self.shapes(self.urdf, "link_5"))
        self.assertEqual(run("plan", self.problem_of(out), "--quiet").returncode, 0)
        done = run("fit", out, "--visual")
        self.assertEqual(done.returncode, 2)
        self.assertIn("no visual meshes on links without collision shapes", done.stderr)

    def test_bad_input(self):
        without = self.folder / "without.urdf"
        without.write_text((DATA / "robots/iiwa14.urdf").read_text())
        for arguments, words in (
            ((without,), "no collision meshes"),
            ((self.urdf, "--link", "link_44"), "unknown link 'link_44', nearest is 'link_4'"),
            ((self.urdf, "--link", "link_1"), "no collision meshes of --link"),
            ((self.urdf, "--capsules", 0), "--capsules"),
            ((self.urdf, "--out", self.urdf), "--out"),
            ((self.folder / "none.urdf",), "none.urdf"),
        ):
            with self.subTest(arguments=arguments):
                done = run("fit", *arguments)
                self.assertEqual(done.returncode, 2, done.stdout)
                self.assertEqual(done.stderr.count("\n"), 1, done.stderr)
                self.assertIn(words, done.stderr)
        self.assertEqual(self.urdf.read_text(), self.text)


if __name__ == "__main__":
    unittest.main()

# SPDX-License-Identifier: BSD-3-Clause
"""bench/evidence/motions.py finds nothing wrong with motions of the program, and what is made wrong
it finds; its distances are right."""
import importlib.util
import os
import pathlib
import sys
import tempfile
import unittest

if importlib.util.find_spec("numpy") is None:
    print("numpy is missing")
    sys.exit(4)
import numpy as np

SOURCE = pathlib.Path(os.environ["SWIVEL_SOURCE"])
sys.path.insert(0, str(SOURCE / "bench/evidence"))
import distances  # noqa: E402
import motions  # noqa: E402
import problem_files  # noqa: E402
from moving_bodies import Cell  # noqa: E402


def along(distance, a, b):
    """Least of a function of points, by very many of them."""
    return distance(a + np.linspace(0, 1, 8001)[:, None] * (b - a)).min()


def to_segment(c, d):
    return lambda p: np.linalg.norm(
        p - c - np.clip((p - c) @ (d - c) / ((d - c) @ (d - c)), 0, 1)[:, None] * (d - c), axis=-1
    )


def to_triangle(triangle):
    """By the foot in its plane where that lies inside, else by its sides."""
    p, q, r = triangle
    sides = [to_segment(*side) for side in ((p, q), (q, r), (r, p))]
    basis = np.stack([q - p, r - p], 1)

    def distance(x):
        share = np.linalg.lstsq(basis, (x - p).T, rcond=None)[0].T
        inside = (share >= 0).all(-1) & (share.sum(-1) <= 1)
        height = np.linalg.norm(x - p - share @ basis.T, axis=-1)
        return np.where(inside, height, np.min([side(x) for side in sides], axis=0))

    return distance


class Distances(unittest.TestCase):
    def test_from_segments(self):
        random = np.random.default_rng(1)
        for trial in range(50):
            a, b, c, d = random.normal(size=(4, 3))
            if trial % 5 == 0:
                d = c + (b - a) * random.normal()  # parallel
            triangle, half = random.normal(size=(3, 3)), np.abs(random.normal(size=3))
            box, cylinder = (lambda p: distances.point_box(p, half)), (
                lambda p: distances.point_cylinder(p, half[0], half[1])
            )
            for found, expected in (
                (
                    distances.segment_segment(a[None], b[None], c[None], d[None]),
                    along(to_segment(c, d), a, b),
                ),
                (
                    distances.segment_triangle(a[None], b[None], triangle[None]),
                    along(to_triangle(triangle), a, b),
                ),
                (distances.segment_convex(a[None], b[None], box), along(box, a, b)),
                (distances.segment_convex(a[None], b[None], cylinder), along(cylinder, a, b)),
            ):
                # Of a segment of some units, where it passes through.
                self.assertAlmostEqual(found[0], expected, delta=1e-3)
                self.assertLessEqual(found[0], expected + 1e-9)

    def test_of_meshes(self):
        mesh = distances.Mesh(problem_files.load_stl(SOURCE / "data/meshes/door_2k.stl"))
        random = np.random.default_rng(2)
        a, b = 0.5 * random.normal(size=(2, 15, 3))
        for p, q, found in zip(a, b, mesh.distance(a, b)):
            each = distances.segment_triangle(
                *(np.broadcast_to(end, (len(mesh.triangles), 3)) for end in (p, q)), mesh.triangles
            )
            self.assertEqual(found, each.min())
        middle = np.array([0.0, 0.0, -0.3])
        ray = mesh.distance((middle - (0, 1, 0))[None], middle[None])[0]
        self.assertEqual(ray, 0)  # through the panel
        self.assertFalse(mesh.contains(middle - (0, 1, 0)))


class Motions(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.swivel = os.environ["SWIVEL"]

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def planned(self, name, episode, moved, speed=0.25):
        file = SOURCE / f"data/problems/{name}.yaml"
        problem = problem_files.load_problem(file)
        fast, slow = (
            motions.planned(
                self.swivel, file, 1, episode, speed, rate, pathlib.Path(self.folder.name)
            )[0]
            for rate in (1000, 250)
        )
        return problem, Cell(problem, moved), fast, slow, speed, 10

    def test_hold(self):
        file = SOURCE / "data/problems/experiment_c.yaml"
        poses, _ = motions.episodes_of(self.swivel, file, 3, 1, pathlib.Path(self.folder.name))
        number, moved = poses[-1]
        found = motions.examine(*self.planned("experiment_c", number, moved))
        self.assertTrue(all(found["holds"].values()), found)
        self.assertGreater(found["jerk"], 0.9)

    def test_what_is_wrong_is_found(self):
        problem, cell, fast, slow, speed, between = self.planned("experiment_b", None, {})
        right = motions.examine(problem, cell, fast, slow, speed, between)
        self.assertTrue(all(right["holds"].values()), right)
        # The path is straight: the cubic is the path.
        self.assertLess(abs(right["off_position"] - right["chord"]), 1e-8)

        def wrong(problem=problem, fast=fast, slow=slow):
            found = motions.examine(problem, cell, fast, slow, speed, between)
            return {key for key, holds in found["holds"].items() if not holds}

        self.assertEqual(wrong(fast={**fast, "t": 0.97 * fast["t"]}), {"rates"})
        joint = cell.robot.arm[1]
        self.assertEqual(
            wrong(
                slow={
                    **slow,
                    joint: slow[joint] + 1e-3 * np.sin(np.linspace(0, np.pi, len(slow["t"]))),
                }
            ),
            {"path"},
        )
        asked = right["clearance"] + motions.BAND
        self.assertEqual(
            wrong(problem={**problem, "limits": {"clearance": asked + 1e-6}}), {"clearance"}
        )
        self.assertEqual(wrong(problem={**problem, "limits": {"clearance": asked - 1e-6}}), set())
        # One row that is off by half a millimetre between good ones is seen at once.
        bent = slow[joint].copy()
        bent[100] += 1e-3
        self.assertIn("path", wrong(slow={**slow, joint: bent}))

    @unittest.skipIf(importlib.util.find_spec("scipy") is None, "scipy is missing")
    def test_yardstick(self):
        """Joints along a straight line, bounded by jerk alone: the shortest time is 4 (d / 2
        J)^(1/3)."""
        import yardstick

        direction, jerk, length = np.array([3.0, 1, 2, 0.5, 0, 1, 2]), 100.0, 0.4
        shortest = 4 * (direction[0] * length / (2 * jerk)) ** (1 / 3)
        t = np.linspace(0, 2 * shortest, 2001)
        z = t / t[-1]
        x = length * z**4 * (35 - 84 * z + 70 * z**2 - 20 * z**3)
        limits = np.full(7, 1e3), np.full(7, 1e3), np.full(7, jerk)
        time, ratios, feasible, _ = yardstick.shortest_motion(
            t, x, x[:, None] * direction, limits, 10.0
        )
        self.assertAlmostEqual(time / shortest, 1, delta=0.01)
        self.assertFalse(feasible)  # 10 m/s are never reached


if __name__ == "__main__":
    unittest.main()

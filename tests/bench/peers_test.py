# SPDX-License-Identifier: BSD-3-Clause
"""The public problems of data/peers: what docs/performance.md prints about them is what the program
finds, times aside; and the converter, on clones of one problem."""
import csv
import importlib.util
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

SOURCE = pathlib.Path(os.environ["SWIVEL_SOURCE"])
SWIVEL = os.environ["SWIVEL"]
sys.path.insert(0, str(SOURCE / "bench/evidence"))
import peers

# Lines that take least time: one ends where the arm does not reach, one where links meet.
LINES = ("line_5", "line_6")


def tables_of(text):
    """By the first cell of a row: the other cells by the name of their column, times left out."""
    rows = {}
    for table in text.strip().split("\n\n"):
        header, _, *lines = [line.strip("| ").split(" | ") for line in table.splitlines()]
        for line in lines:
            rows[line[0].strip("`")] = {
                f"{number} {name}": cell
                for number, (name, cell) in enumerate(zip(header, line))
                if number > 0 and not name.startswith("CPU")
            }
    return rows


def published():
    text = (SOURCE / "docs/performance.md").read_text()
    return tables_of(re.search(r"<!-- evidence peers -->\n(.*?)<!--", text, re.S)[1])


def cell(row, name):
    """That of the column with this name."""
    [value] = [value for key, value in row.items() if key.split(" ", 1)[1] == name]
    return value


class Peers(unittest.TestCase):
    def test_every_problem_is_in_the_table(self):
        files = {file.stem for file in (peers.DATA / "problems").iterdir()}
        self.assertEqual(files, {*peers.TORM, *peers.IKLINK})
        for folder in ("capsules", "bare"):
            lines = {file.stem for file in (peers.DATA / "lines" / folder).iterdir()}
            self.assertEqual(lines, set(peers.LINES))
        self.assertEqual(set(published()), {*files, *peers.LINES, "all"})

    def test_table_is_what_the_program_finds(self):
        with tempfile.TemporaryDirectory() as folder:
            data = pathlib.Path(folder)
            self.assertIsNone(peers.peers(data))
            peers.measure(SWIVEL, data, lines=LINES)
            found = tables_of(peers.peers(data))
        printed = published()
        compared = 0
        for name, row in found.items():
            if name != "all":  # here the sum of LINES
                self.assertEqual(row, printed[name], name)
                compared += 1
        self.assertEqual(compared, len(peers.TORM) + len(peers.IKLINK) + len(LINES))

    def test_lengths_beside_those_published(self):
        printed = published()
        most = {"fetch_arm__circle": 1.01}
        for name, (turned, slid) in peers.TORM.items():
            self.assertEqual(cell(printed[name], "verdict"), "solved")
            self.assertLessEqual(float(cell(printed[name], "largest step, °")), 7)
            self.assertLessEqual(float(cell(printed[name], "refined over plan")), 1)
            if turned and not name.startswith("fetch__"):
                length = float(cell(printed[name], "`l1`: refined"))
                self.assertLess(length, most.get(name, 1) * turned, name)
                self.assertLess(float(cell(printed[name], "`l1`: plan")), 1.04 * length, name)
                self.assertLess(length, float(cell(printed[name], "`l2`: L1, refined")), name)
        for name, count in peers.IKLINK.items():
            self.assertLess(int(cell(printed[name], "lift-offs")), count)

    def test_length_leaves_out_moves_between_runs(self):
        def part(stroke, *rows):
            return {"stroke": stroke, "rows": [{"joints": row} for row in rows]}

        answer = {
            "parts": [
                part("path/1", [0, 0], [0.1, -0.2], [0.1, -0.1]), part(None, [0.1, -0.1], [2, 2]),
                part("path/2", [2, 2], [2, 2.5])
            ]
        }
        self.assertAlmostEqual(peers.length(answer), 0.9)
        self.assertAlmostEqual(max(map(max, peers.steps_of(answer))), 0.5)


PUBLISHED = """\
robot: "{robot}"
path_name: "{path}"
path_offset_frame: "{frame}"
path_xyz_offset: [1.0, 0.3, 0.55]
path_R_offset: [[0, -1, 0], [1, 0, 0], [0, 0, 1]]
obstacle_xyz_offset: [0.0, 0.0, -0.2]
obstacles: [[x: 0.75, y: 0.0, z: 0.36, roll: 0.0, pitch: 0.0, yaw: 0.0,
             size_x: 0.7, size_y: 1.4, size_z: 0.72]]
"""


def converter():
    try:
        spec = importlib.util.spec_from_file_location("convert", peers.DATA / "convert.py")
        module = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(module)
    except ImportError:
        return None  # python3-yaml is not installed
    return module


@unittest.skipUnless(converter(), "python3-yaml is missing")
class Converter(unittest.TestCase):
    def clones(self, folder):
        """Of CppFlow, all problems with one path of two poses; and of IKLink, with the path of
        data/peers."""
        convert = converter()
        for name in ("cppflow/paths", "cppflow/problems", "input_trajectories"):
            (folder / name).mkdir(parents=True)
        for name in convert.NAMES:
            robot, path = name.split("__")
            frame = "world" if robot == "panda" else "torso_lift_link"
            (folder / f"cppflow/problems/{name}.yaml").write_text(
                PUBLISHED.format(robot=robot, path=path, frame=frame)
            )
            (folder / f"cppflow/paths/{path}.csv").write_text(
                "time,x,y,z,qw,qx,qy,qz\n0.0,0,0,0,1.0,0,0,0\n0.07,0,0,-0.005,0.6,0.8,0,0\n"
            )
        with open(folder / "input_trajectories" / convert.IKLINK, "w") as out:
            out.write("time,X,Y,Z,QX,QY,QZ,QW\n")
            with open(peers.DATA / "paths/iklink_panda.csv") as rows:
                for number, row in enumerate(list(csv.reader(rows))[1:]):
                    x, y, z, qw, qx, qy, qz = row
                    out.write(",".join([str(number / 30), x, y, z, qx, qy, qz, qw]) + "\n")

    def test_paths_and_problems(self):
        with tempfile.TemporaryDirectory() as folder:
            source, out = pathlib.Path(folder) / "clone", pathlib.Path(folder) / "out"
            self.clones(source)
            subprocess.run(
                [sys.executable, peers.DATA / "convert.py", "--cppflow", source, "--iklink", source,
                 out], check=True
            )
            # (0.6, 0.8 i) after a quarter turn about z: (0.6 r, 0.8 r, -0.8 r, 0.6 r), r = √½.
            self.assertEqual(
                (out / "paths/fetch_s.csv").read_text().splitlines()[1:],
                [
                    "0.913125,0.3,0.92743,0.707106781,0,0,0.707106781",
                    "0.913125,0.3,0.92243,0.424264069,0.565685425,-0.565685425,0.424264069"
                ],
            )
            problem = (out / "problems/fetch__s.yaml").read_text()
            self.assertIn("{name: box_0, box: [0.7, 1.4, 0.72], xyz: [0.75, 0, 0.16]}", problem)
            for file in ("paths/iklink_panda.csv", "problems/iklink_panda.yaml"):
                self.assertEqual((out / file).read_text(), (peers.DATA / file).read_text(), file)

    def test_problems_of_the_folder_are_what_it_writes(self):
        with tempfile.TemporaryDirectory() as folder:
            source, out = pathlib.Path(folder) / "clone", pathlib.Path(folder) / "out"
            self.clones(source)
            subprocess.run(
                [sys.executable, peers.DATA / "convert.py", "--cppflow", source, out], check=True
            )
            for file in (out / "problems").iterdir():
                without = [
                    re.sub(r"(?m)^(scene:|  - ).*\n", "", each.read_text())
                    for each in (file, peers.DATA / "problems" / file.name)
                ]
                self.assertEqual(*without, file.name)


unittest.main()

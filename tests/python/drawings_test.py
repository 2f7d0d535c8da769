# SPDX-License-Identifier: BSD-3-Clause
# Maps, pages and notebook views of plans, and certificates, against what the program writes. Usage:
# drawings_test.py CASE; SWIVEL is the program, SWIVEL_DATA the data folder.
import base64
import gzip
import html
import json
import os
import pickle
import re
import subprocess
import sys
import tempfile
import unittest
import zlib
from pathlib import Path
from unittest import mock

import swivel
from pages import data_of

PROGRAM, DATA = os.environ["SWIVEL"], Path(os.environ["SWIVEL_DATA"])
PROBLEMS = DATA / "problems"
PAGES = swivel._swivel._page_available()
# Plan, options of the program, keywords of Python.
CASES = [
    ("experiment_c", [], {}),
    ("ur5e_deburr_edge", [], {}),
    ("experiment_a_start", [], {}),  # no path
    ("kr6_weld_pipe_job", [], {}),
    ("iiwa14_fillet_workcell", [], {}),
    ("experiment_c", ["--refine", "--speed", "0.1"], {"refine": True, "speed": 0.1}),
]


def program(*words, codes=(0,)):
    done = subprocess.run([PROGRAM, *map(str, words)], capture_output=True, text=True)
    assert done.returncode in codes, done.stderr
    return done


def unpacked(match):
    """Returns what a text in base 64 holds, if that is a zlib stream; else the text itself."""
    try:
        return zlib.decompress(base64.b64decode(match[0])).decode("latin-1")
    except (ValueError, zlib.error):
        return match[0]


def without_times(page):
    """Returns a page without what two runs do not have in common: times in ms."""
    text = re.sub(r"[A-Za-z0-9+/]{200,}=*", unpacked, page)
    text = re.sub(r'"(time_ms|threads)":\s*(\{[^}]*\}|\d+)', "", text)
    return re.sub(r'"\w*_ms":\s*[\d.e+-]+', "", text)


class Drawings(unittest.TestCase):
    def test_maps_and_pages_are_those_of_the_program(self):
        for name, options, keywords in CASES:
            with self.subTest(problem=name), tempfile.TemporaryDirectory() as folder:
                drawn = Path(folder) / "map.svg"
                words = ["--map-svg", drawn, "--threads", "1", "--quiet"]
                if PAGES:
                    words += ["--report", Path(folder) / "page.html"]
                program("plan", PROBLEMS / f"{name}.yaml", *options, *words, codes=(0, 1))
                problem = swivel.load(PROBLEMS / f"{name}.yaml")
                plan = swivel.plan(problem, threads=1, **keywords)
                self.assertEqual(plan.map_svg(), drawn.read_text())
                self.assertEqual(swivel.map_svg(problem, plan), drawn.read_text())
                self.assertNotEqual(plan.map_svg(full=True), plan.map_svg())
                if not PAGES:
                    continue
                page = (Path(folder) / "page.html").read_text()
                self.compare(plan.report(), page)
                self.assertIsNone(plan.report(Path(folder) / "own.html"))
                self.compare((Path(folder) / "own.html").read_text(), page)
                again = pickle.loads(pickle.dumps(plan))
                self.compare(swivel.report(PROBLEMS / f"{name}.yaml", again), page)

    @unittest.skipUnless(PAGES, "built without pages")
    def test_pages_have_the_visual_shapes_of_the_program(self):
        with tempfile.TemporaryDirectory() as name:
            folder = Path(name)
            urdf = (DATA / "robots" / "iiwa14.urdf").read_text()
            shape = '<visual><geometry><sphere radius="0.1"/></geometry></visual>'
            (folder / "arm.urdf").write_text(
                urdf.replace('<link name="link_2">', f'<link name="link_2">{shape}')
            )
            text = (PROBLEMS / "iiwa14_bench.yaml").read_text()
            file = folder / "bench.yaml"
            file.write_text(
                text.replace("../robots/iiwa14.urdf", "arm.urdf").replace("../", f"{DATA}/")
            )
            program("plan", file, "--threads", "1", "--quiet", "--report", folder / "page.html")
            plan = swivel.plan(file, threads=1)
            self.compare(plan.report(), (folder / "page.html").read_text())
            self.assertEqual([body["name"] for body in data_of(folder / "page.html")["visual"]],
                             ["link_2"])
            problem = pickle.loads(pickle.dumps(swivel.load(file)))
            self.compare(swivel.report(problem, plan), plan.report())

    def compare(self, page, other):
        self.assertGreater(len(page), 100_000)
        self.assertTrue(without_times(page) == without_times(other), "another page")

    def test_what_cannot_be_drawn_is_refused(self):
        problem = swivel.load(PROBLEMS / "experiment_c.yaml")
        plan = swivel.plan(problem)
        other = swivel.load(PROBLEMS / "experiment_c.yaml")
        other.scene.remove("post")
        other.resolution.ds = 0.02
        own = swivel.plan(problem, cost=lambda joints: joints[:, 0] ** 2)
        for words, call in (
            ("another answer", lambda: swivel.map_svg(other, plan)),
            ("check, check_motions or cost", own.map_svg),
            ("unpickled has none", pickle.loads(pickle.dumps(plan)).map_svg),
            ("no verdict", swivel.plan(problem, planner="eager_dp", timeout=1e-6).map_svg),
        ):
            with self.assertRaisesRegex(ValueError, words):
                call()

    def test_notebooks(self):
        plan = swivel.plan(PROBLEMS / "experiment_c.yaml")
        shown = plan._repr_html_()
        self.assertIn("solved: 109 layers", html.unescape(shown))
        image = re.search(r'src="data:image/svg\+xml;base64,([^"]*)"', shown)
        self.assertEqual(base64.b64decode(image[1]).decode(), plan.map_svg())
        if PAGES:
            packed = base64.b64decode(re.search(r'data-page="([^"]*)"', shown)[1])
            page = gzip.decompress(packed).decode()
            self.assertEqual(without_times(page), without_times(plan.report()))
            self.assertLess(len(shown), 2_500_000)
            # In a handler of an element URL is the document's address, not the class.
            self.assertIn("window.URL.createObjectURL", shown)
        with mock.patch("webbrowser.open") as opened:
            if PAGES:
                plan.show()
                (address,), _ = opened.call_args
                file = Path(address.removeprefix("file://"))
                self.addCleanup(file.unlink)
                self.assertEqual(without_times(file.read_text()), without_times(plan.report()))
        shown = pickle.loads(pickle.dumps(plan))._repr_html_()
        self.assertIn("solved: 109 layers", shown)
        self.assertNotIn("<img", shown)

    def test_a_notebook_makes_its_picture(self):
        try:
            import ipykernel  # noqa: F401
            import nbclient
            import nbformat
        except ImportError as error:
            self.skipTest(f"{error.name} (python3-nbclient, python3-ipykernel) is not installed")
        cells = [
            f"import swivel\nplan = swivel.plan({str(PROBLEMS / 'experiment_c.yaml')!r})\nplan",
            "plan.show(height=300)" if PAGES else "",
        ]
        notebook = nbformat.v4.new_notebook(
            cells=[nbformat.v4.new_code_cell(cell) for cell in cells]
        )
        with tempfile.TemporaryDirectory() as folder:
            kernel = Path(folder) / "kernels" / "this"
            kernel.mkdir(parents=True)
            words = [sys.executable, "-m", "ipykernel_launcher", "-f", "{connection_file}"]
            (kernel / "kernel.json").write_text(
                json.dumps({"argv": words, "display_name": "this", "language": "python"})
            )
            with mock.patch.dict(os.environ, {"JUPYTER_PATH": folder}):
                nbclient.NotebookClient(notebook, timeout=120, kernel_name="this").execute()
        shown = [
            output["data"]["text/html"] for cell in notebook.cells for output in cell.outputs
        ]
        self.assertEqual(len(shown), 2 if PAGES else 1)
        self.assertIn("data:image/svg+xml", shown[0])
        if PAGES:
            frame = '^<iframe srcdoc="[^"]{100000,}" style="width:100%;height:300px'
            self.assertRegex(shown[1], frame)


class Certificates(unittest.TestCase):
    def test_certificates_are_those_of_the_program(self):
        file = PROBLEMS / "experiment_a_start.yaml"
        with tempfile.TemporaryDirectory() as folder:
            theirs, own = Path(folder) / "theirs.json", Path(folder) / "own.json"
            program("plan", file, "--certificate", theirs, "--quiet", codes=(1,))
            certificate = swivel.certificate(file)
            certificate.save(own)
            self.assertEqual(own.read_bytes(), theirs.read_bytes())
            self.assertEqual(certificate.to_json(), theirs.read_text())
            self.assertEqual(swivel.load_certificate(theirs), certificate)
            again = pickle.loads(pickle.dumps(certificate))
            self.assertEqual((again, repr(again)), (certificate, repr(certificate)))
            self.assertIn("passed", program("check", file, "--certificate", own).stdout)
            for one in (certificate, own):
                check = swivel.check_certificate(file, one)
                self.assertTrue(check)
                self.assertIsNone(check.failure)
                self.assertGreater(check.nodes + check.edges, 0)
                self.assertTrue(pickle.loads(pickle.dumps(check)).passed)
            first, last = certificate.band
            self.assertLessEqual(0, first)
            self.assertLess(last, certificate.layers)
            self.assertIn("limit", {str(cause.kind) for cause in certificate.causes})

    def test_a_false_certificate_fails(self):
        file = PROBLEMS / "experiment_a_start.yaml"
        problem = swivel.load(file)
        certificate = swivel.certificate(problem)
        problem.start = None
        self.assertTrue(swivel.plan(problem).solved)
        self.assertIsNone(swivel.certificate(problem))
        check = swivel.check_certificate(problem, certificate)
        self.assertFalse(check)
        self.assertTrue(check.failure)
        self.assertIn("failed", repr(check))
        problem.resolution.ds *= 2
        with self.assertRaises(swivel.InputError):
            swivel.check_certificate(problem, certificate)
        with self.assertRaises(TimeoutError):
            swivel.certificate(file, planner="eager_dp", timeout=1e-6)


class JobDrawings(unittest.TestCase):
    """Pages of jobs, and certificates that a stroke has no path, are those of the program."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def job(self, *strokes):
        """The file of a job on the door: its first two strokes, and others."""
        text = (PROBLEMS / "door_job.yaml").read_text().replace("../", f"{DATA}/")
        text = re.sub(r"  - {name: row_[2-5].*\n", "", text)
        text = text.replace("ds: 0.005, dphi: 0.05", "ds: 0.02, dphi: 0.2")
        text = text.replace("scene:\n", "".join(f"  - {one}\n" for one in strokes) + "scene:\n")
        file = self.folder / "job.yaml"
        file.write_text(text)
        return file

    FAR = "{name: far, path: {waypoints: [{xyz: [3, 0, 1]}, {xyz: [3, 0.1, 1]}]}}"

    @unittest.skipUnless(PAGES, "built without pages")
    def test_pages_are_those_of_the_program(self):
        page, own = self.folder / "page.html", self.folder / "own.html"
        for strokes, keywords, options in (
            ((), {}, ()),
            ((), {"speed": 0.05}, ("--speed", "0.05")),
            ((self.FAR, ), {}, ()),
        ):
            file = self.job(*strokes)
            words = ["--threads", "1", "--quiet", "--report", page, *options]
            program("plan", file, *words, codes=(0, 1))
            plan = swivel.plan(file, threads=1, **keywords)
            self.assertEqual(plan.solved, not strokes)
            self.assertIsNone(plan.report(own))
            texts = [without_times(text.read_text()) for text in (own, page)]
            self.assertTrue(texts[0] == texts[1], "another page")
            again = pickle.loads(pickle.dumps(plan))
            with self.assertRaisesRegex(ValueError, "unpickled has none"):
                again.report()
            text = without_times(swivel.report(file, again))
            self.assertTrue(text == texts[1], "another page")
        with self.assertRaisesRegex(ValueError, "another answer"):
            swivel.report(self.job(), plan)
        with mock.patch("webbrowser.open") as opened:
            plan.show()
        shown = Path(opened.call_args[0][0].removeprefix("file://"))
        self.addCleanup(shown.unlink)
        self.assertEqual(without_times(shown.read_text()), texts[1])

    def test_certificates_are_those_of_the_program(self):
        file, theirs, own = self.job(self.FAR), self.folder / "theirs", self.folder / "own"
        program("plan", file, "--certificate", theirs, "--quiet", codes=(1, ))
        plan = swivel.plan(file)
        certificate = plan.certificate()
        certificate.save(own)
        self.assertEqual(own.read_bytes(), theirs.read_bytes())
        self.assertEqual((certificate.stroke, certificate.reversed), ("far", False))
        self.assertIn("stroke 'far', no path", repr(certificate))
        self.assertEqual(pickle.loads(pickle.dumps(certificate)), certificate)
        self.assertIn("passed", program("check", file, "--certificate", own).stdout)
        job = swivel.load(file)
        for of, what in ((job, certificate), (file, own)):
            self.assertTrue(swivel.check_certificate(of, what))
        again = pickle.loads(pickle.dumps(plan))
        self.assertEqual(again.certificate(file), certificate)
        with self.assertRaisesRegex(ValueError, "unpickled has none"):
            again.certificate()
        job.strokes[-1].waypoints = job.strokes[0].waypoints
        job.strokes[-1].frame = "door"
        with self.assertRaises(swivel.InputError):  # of other layers
            swivel.check_certificate(job, certificate)
        job.strokes = job.strokes[:2]
        with self.assertRaisesRegex(swivel.InputError, "'far' is none of the job"):
            swivel.check_certificate(job, certificate)
        with self.assertRaisesRegex(swivel.InputError, "is of stroke 'far': allowed"):
            swivel.check_certificate(
                swivel.load(PROBLEMS / "experiment_c.yaml"), certificate
            )
        with self.assertRaisesRegex(ValueError, "'solved': allowed is one that is infeasible"):
            swivel.plan(self.job()).certificate()
        with self.assertRaisesRegex(ValueError, "without refine, speed"):
            swivel.plan(file, speed=0.1).certificate()
        with self.assertRaises(TimeoutError):
            plan.certificate(timeout=1e-6)


if __name__ == "__main__":
    unittest.main(argv=["drawings_test"] + sys.argv[1:])

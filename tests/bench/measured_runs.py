# SPDX-License-Identifier: BSD-3-Clause
"""A file as google-benchmark writes it, for tests of the tables that are made of it."""
import json
import pathlib
import tempfile
import unittest


class MeasuredRuns(unittest.TestCase):
    """Has a folder `data` for each test. FILE: the name of the file in it."""

    FILE = ""

    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.data = pathlib.Path(self.folder.name)

    def tearDown(self):
        self.folder.cleanup()

    def write(self, *rows):
        self.data.joinpath(self.FILE).write_text(json.dumps({"context": {}, "benchmarks": rows}))

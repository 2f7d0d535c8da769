# SPDX-License-Identifier: BSD-3-Clause
"""Keeps answers in folders, and says where those of two programs differ."""
import itertools
import os
import pathlib
import shutil

from same import answers

WIDTH = 160  # characters shown of a line


class Recording:
    """A folder with a folder of answers for each case."""

    def __init__(self, folder):
        self.folder = pathlib.Path(folder)

    def place(self, case):
        return self.folder / case.name

    def write(self, case, items):
        """Keeps the answers to a case, and its files."""
        place = self.place(case)
        shutil.rmtree(place, ignore_errors=True)
        for name, content in items.items():
            (place / name).parent.mkdir(parents=True, exist_ok=True)
            (place / name).write_bytes(content)

    def read(self, case):
        """The answers that were kept; None if there are none."""
        place = self.place(case)
        if not place.is_dir():
            return None
        files = (file for file in place.rglob("*") if file.is_file())
        return {str(file.relative_to(place)): file.read_bytes() for file in files}


def inputs(case):
    """The files of a case as items, so that a recording of other cases is noticed."""
    return {
        name: content.encode() if isinstance(content, str) else content
        for name, content in case.files.items()
    }


def differing_line(a, b):
    """The first line that differs, of both, about the place where it does."""
    a, b = (text.decode("utf-8", "backslashreplace").splitlines() for text in (a, b))
    for number, (x, y) in enumerate(itertools.zip_longest(a, b), 1):
        if x != y:
            x, y = ("(none)" if line is None else line for line in (x, y))
            at = max(0, len(os.path.commonprefix([x, y])) - WIDTH // 2)
            return f"line {number}\n    - {x[at:at + WIDTH]}\n    + {y[at:at + WIDTH]}"
    return "the ends of lines"


def compared(before, after, modules):
    """Yields the kind of each answer and, where it differs, how."""
    for name in sorted(before.keys() | after.keys()):
        kind = answers.kind(name)
        if not modules and name.startswith("module "):
            continue
        a, b = before.get(name), after.get(name)
        if a == b:
            yield kind, None
        elif a is None or b is None:
            yield kind, f"{name}: only {'after' if a is None else 'before'}"
        else:
            yield kind, f"{name}: {differing_line(a, b)}"

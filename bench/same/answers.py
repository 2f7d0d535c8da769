# SPDX-License-Identifier: BSD-3-Clause
"""Runs a case with one program in a folder of its own, and keeps all that it answers: exit codes,
what it prints and the files that it writes, masked."""
import dataclasses
import functools
import os
import pathlib
import subprocess
import sys
import tempfile

from same import masks

ROOT = pathlib.Path(__file__).resolve().parents[2]
ADAPTER = pathlib.Path(__file__).with_name("python_values.py")
MOST_SECONDS = 300  # of one step; what takes longer hangs


@dataclasses.dataclass(frozen=True)
class Step:
    """One run of the program with these words, in the folder of the case.

    `after` is a step and the exit codes of it after which this one is taken; `needs` a file without
    which it is left out. Of a step that is not `whole` the exit code and the first word count,
    since the rest depends on when it was stopped. `python` says that the words are for the Python
    module. `make` makes a file of earlier ones: a function of the folder, called before the
    program."""

    name: str
    words: tuple
    after: tuple = ()
    needs: str = ""
    whole: bool = True
    python: bool = False
    make: object = None


@dataclasses.dataclass(frozen=True)
class Case:
    """Files, by their names in the folder of the case, and the steps that use them."""

    name: str
    files: dict
    steps: list


@dataclasses.dataclass(frozen=True)
class Build:
    """A program `swivel`, and the folder that holds the package `swivel` of Python, or nothing."""

    program: pathlib.Path
    module: pathlib.Path | None


@functools.cache
def interpreter(module):
    """The interpreter that can load the package in this folder; None if none can."""
    for words in (sys.executable, "/usr/bin/python3"):
        setting = {**os.environ, "PYTHONPATH": str(module), "PYTHONDONTWRITEBYTECODE": "1"}
        done = subprocess.run([words, "-c", "import swivel"], env=setting, capture_output=True)
        if done.returncode == 0:
            return words
    return None


def environment(build):
    """The environment of a run, which no settings of the caller reach."""
    kept = {key: value for key, value in os.environ.items() if not key.startswith("SWIVEL_")}
    kept.update(LC_ALL="C.UTF-8", PYTHONDONTWRITEBYTECODE="1")
    if build.module:
        kept["PYTHONPATH"] = str(build.module)
    return kept


def run(step, build, folder):
    """The exit code, which is "hangs" of a step that takes too long, and what was printed."""
    words = [str(build.program), *step.words]
    if step.python:
        words = [interpreter(build.module), str(ADAPTER), *step.words]
    try:
        done = subprocess.run(
            words,
            cwd=folder,
            env=environment(build),
            stdin=subprocess.DEVNULL,
            capture_output=True,
            timeout=MOST_SECONDS,
        )
    except subprocess.TimeoutExpired:
        return "hangs", "", ""
    texts = (text.decode("utf-8", "surrogateescape") for text in (done.stdout, done.stderr))
    return done.returncode, *texts


def first_word(out, err):
    """The first word that says how it ended."""
    return next(iter((out or err).split()), "")


def put(folder, files):
    """Writes the files of a case, beside a link to data/."""
    (folder / "data").symlink_to(ROOT / "data")
    (folder / "out").mkdir()
    for name, content in files.items():
        place = folder / name
        place.parent.mkdir(parents=True, exist_ok=True)
        place.write_bytes(content.encode() if isinstance(content, str) else content)


def written(folder, inputs, places):
    """The files below the folder that are not among the inputs, masked."""
    found = {}
    for place in sorted(folder.rglob("*")):
        name = str(place.relative_to(folder))
        if place.is_file() and not name.startswith("data/") and name not in inputs:
            found[name] = masks.file(name, place.read_bytes(), places)
    return found


def answers(case, build):
    """All that the program answers to a case: names of items and their contents, bytes."""
    items = {}
    with tempfile.TemporaryDirectory(prefix="same-") as name:
        folder = pathlib.Path(os.path.realpath(name))
        places = [(str(folder), "FOLDER"), (str(build.program), "swivel"), (str(ROOT), "ROOT")]
        put(folder, case.files)
        inputs, codes, loose = set(case.files), {}, set()
        for step in case.steps:
            if step.after and codes.get(step.after[0]) not in step.after[1]:
                continue
            if step.needs and not (folder / step.needs).exists():
                continue
            if step.python and not build.module:
                continue
            if step.make:
                step.make(folder)
            before = {place: place.stat().st_mtime_ns for place in (folder / "out").rglob("*")}
            codes[step.name], out, err = run(step, build, folder)
            items[f"{step.name} code"] = f"{codes[step.name]}\n"
            if not step.whole:
                items[f"{step.name} first word"] = first_word(out, err) + "\n"
                loose |= {
                    str(p.relative_to(folder))
                    for p in (folder / "out").rglob("*")
                    if before.get(p) != p.stat().st_mtime_ns
                }
                continue
            kind = "python" if step.python else "stdout"
            items[f"{step.name} {kind}"] = masks.printed(out, places)
            items[f"{step.name} stderr"] = masks.printed(err, places)
        items = {key: text.encode("utf-8", "surrogateescape") for key, text in items.items()}
        return {**items, **written(folder, inputs | loose, places)}


def kind(item):
    """What sort of answer an item is: `code`, `stdout`, `rows`, `motion` and the like."""
    if "/" not in item:
        return item.rsplit(" ", 1)[-1].replace("word", "first word")
    words = pathlib.PurePath(item).name.split(".")
    return words[-2] if len(words) > 2 else "other file"

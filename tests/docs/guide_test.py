# SPDX-License-Identifier: BSD-3-Clause
"""Runs what a page of the guide tells its reader to do, in a folder of its own that looks like the
clone.

guide_test.py PAGE.md      needs SWIVEL (the program) and SWIVEL_SOURCE (the clone); with
                           PYTHONPATH the Python package as well

Blocks are taken in their order, by language:
  sh          run by bash, which stops at the first failure; "ends with exit code N" in the
              block says that its last command does
  text        printed by the commands before: each line is the beginning of one of theirs, in this
              order; ... stands for anything
  yaml        with title="NAME" a file; else a part of a problem file, whose keys and values the
              schema must allow
  python      run
  cpp, python that are one line --8<-- "FILE": an example, which has tests of its own
The README's program in C++ is run by examples/CMakeLists.txt; of `./swivel test` and
bench/reproduce its options are held against --help alone.
"""
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile

PROGRAM, SOURCE = os.environ["SWIVEL"], pathlib.Path(os.environ["SWIVEL_SOURCE"])
FENCE = re.compile(r"^```(\w*)([^\n]*)\n(.*?)^```$", re.DOTALL | re.MULTILINE)
INCLUDED = re.compile(r'--8<-- "(.+)"\n')


def only_lacks_keys(error):
    """Returns true if a part of a file breaks its schema only by what it leaves out."""
    if error.validator not in ("anyOf", "oneOf"):
        return error.validator == "required"
    options = {}
    for one in error.context:
        options.setdefault(one.relative_schema_path[0], []).append(one)
    return any(all(map(only_lacks_keys, errors)) for errors in options.values())


class Page:
    def __init__(self, folder):
        self.folder = folder
        self.printed = None
        self.ran = 0
        self.skipped = []
        for name in ("data", "examples"):
            (folder / name).symlink_to(SOURCE / name)
        if build := os.environ.get("SWIVEL_BUILD"):
            (folder / "build").mkdir()
            (folder / "build" / "release").symlink_to(build)
        self.script(
            "swivel", f'[ "$1" != test ] || exit 0  # it runs this test\nexec "{PROGRAM}" "$@"'
        )
        options = (
            f'for word; do case $word in --*) grep -q -e "$word" "$help" || {{ echo "no option '
            f'$word" >&2; exit 2; }};; esac; done'
        )
        self.script(
            "bench/reproduce",
            f'help=$(mktemp)\n"{SOURCE}/bench/reproduce" --help >"$help" || exit 2\n{options}',
        )

    def script(self, name, text):
        file = self.folder / name
        file.parent.mkdir(exist_ok=True)
        file.write_text(f"#!/bin/sh\n{text}\n")
        file.chmod(0o755)

    def sh(self, text, _):
        code = re.search(r"ends with exit code (\d+)", text)
        done = subprocess.run(
            ["bash", "-e", "-o", "pipefail", "-c", text],
            cwd=self.folder,
            capture_output=True,
            text=True,
            timeout=300,
        )
        self.printed = done.stdout + done.stderr
        if "--report" in text and "built without reports" in done.stderr:
            self.skipped.append("a report, since the program was built without")
            return
        expect(
            done.returncode == int(code[1] if code else 0),
            f"ended with {done.returncode}:\n{text}\n{self.printed}",
        )

    def text(self, text, _):
        expect(self.printed is not None, "output without a command before it")
        rest = self.printed.splitlines()
        for line in text.splitlines():
            pattern = re.compile(".*".join(map(re.escape, line.split("..."))))
            while rest and not pattern.match(rest[0]):
                rest.pop(0)
            expect(rest, f"not printed, or not in this order: {line}\nprinted was:\n{self.printed}")
            rest.pop(0)

    def yaml(self, text, title):
        if title:
            (self.folder / title).write_text(text)
            return
        try:
            import jsonschema
            import yaml
        except ImportError:
            self.skipped.append(
                "a part of a problem file, since python3-jsonschema or python3-yaml is missing"
            )
            return
        schema = json.loads(
            subprocess.run(
                [PROGRAM, "schema", "problem"], check=True, capture_output=True, text=True
            ).stdout
        )
        errors = [
            error.message
            for error in jsonschema.Draft7Validator(schema).iter_errors(yaml.safe_load(text))
            if not only_lacks_keys(error)
        ]
        expect(not errors, f"{errors} in\n{text}")

    def python(self, text, _):
        included = INCLUDED.fullmatch(text)
        if included:
            return self.example(included[1], "tests/python/CMakeLists.txt")
        if subprocess.run(
            [sys.executable, "-c", "import swivel"], cwd=self.folder, capture_output=True
        ).returncode:
            self.skipped.append("a program in Python, since the package is not built")
            return
        done = subprocess.run(
            [sys.executable, "-c", text],
            cwd=self.folder,
            capture_output=True,
            text=True,
            timeout=300,
        )
        self.printed = done.stdout + done.stderr
        expect(done.returncode == 0, f"ended with {done.returncode}:\n{text}\n{self.printed}")

    def cpp(self, text, _):
        if text in (SOURCE / "README.md").read_text():
            return
        included = INCLUDED.fullmatch(text)
        expect(included, "programs in C++ are those of examples/, by inclusion")
        self.example(included[1], "examples/CMakeLists.txt")

    @staticmethod
    def example(name, lists):
        stem = pathlib.Path(name).stem
        expect(
            (SOURCE / name).is_file() and stem in (SOURCE / lists).read_text(),
            f"{name} is not run by a test",
        )

    def run(self, text):
        for language, more, body in FENCE.findall(text):
            expect(
                language in ("sh", "text", "yaml", "python", "cpp"),
                f"no rule for blocks of '{language}':\n{body}",
            )
            title = re.search(r'title="([^"/]+)"', more)
            getattr(self, language)(body, title[1] if title else None)
            self.ran += 1


def expect(condition, message):
    if not condition:
        sys.exit(message)


def anchors(page):
    """Of its headings, as GitHub and MkDocs make them."""
    headings = re.findall(r"^#+ (.*)$", FENCE.sub("", page.read_text()), re.MULTILINE)
    return {
        re.sub(r"\s+", "-", re.sub(r"[^\w\s-]", "", heading).strip().lower())
        for heading in headings
    }


def main():
    page = pathlib.Path(sys.argv[1])
    text = page.read_text()
    expect(text.count("```") == 2 * len(FENCE.findall(text)), "a block is not closed")
    for target, anchor in re.findall(r"\]\(([^)#:]*)(?:#([^)]*))?\)", FENCE.sub("", text)):
        if target.endswith(("cpp/index.html", "python.md")):
            continue  # the references, made with the pages
        linked = page.parent / target if target else page
        expect(linked.exists(), f"{page.name} links {target}, which is not there")
        expect(
            not anchor or anchor in anchors(linked),
            f"{page.name} links {target}#{anchor}, which is not there",
        )
    with tempfile.TemporaryDirectory() as folder:
        runner = Page(pathlib.Path(folder))
        runner.run(text)
    for what in runner.skipped:
        print("left out:", what)
    print(f"{page.name}: {runner.ran} blocks")


main()

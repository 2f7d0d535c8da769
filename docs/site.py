#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Builds the guide, all documents of the clone and the references of C++ and Python as pages that
open without a server (their search wants one: python3 -m http.server -d OUT/site).

site.py OUT      writes OUT/site; the Python package must be importable (PYTHONPATH) for its
                 reference. Exit code 4: a tool is missing.
"""
import os
import pathlib
import re
import shutil
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
# The documents, and what they show without a link. All files stay where they lie, so that links
# hold.
COPIED = [
    "*.md", "docs/*.md", "docs/guide/*.md", "docs/decisions/*.md", "docs/measurements/*.md",
    "docs/figures/*", "examples/**/*", "data/README.md", "data/peers/README.md", "data/problems/*",
    "cmake/packages.txt"
]
MADE = {"python.md", "cpp/index.html"}  # by python_reference() and Doxygen
CODE = re.compile(r"^(```|~~~).*?^\1$|(?<!`)(`+)(?!`).+?(?<!`)\2(?!`)", re.DOTALL | re.MULTILINE)
# The target of [words](target), of [words]: target, and of src="target" and href="target".
LINK = re.compile(
    r"""\]\(<?([^()\s>]+)|^\[[^\]]+\]:\s+(\S+)|\b(?:src|href)="([^"]+)\"""", re.MULTILINE
)

# Typesets formulas; copied beside the pages, since nothing is fetched from elsewhere.
KATEX = pathlib.Path("/usr/share/javascript/katex")


def missing():
    """The Debian packages of what is not there."""
    names = [
        package
        for program, package in (("mkdocs", "mkdocs-material"), ("doxygen", "doxygen"))
        if not shutil.which(program)
    ]
    if (
        not names
        and "material"
        not in subprocess.run(["mkdocs", "build", "--help"], capture_output=True, text=True).stdout
    ):
        names.append("mkdocs-material")
    if not (KATEX / "katex.min.js").is_file():
        names.append("libjs-katex")
    return names


def links(document):
    """The files that a document links, as paths from ROOT."""
    text = CODE.sub("", (ROOT / document).read_text())
    for match in LINK.finditer(text):
        target = next(group for group in match.groups() if group).partition("#")[0]
        if target and not re.match(r"[a-z]+:", target):
            yield os.path.normpath(os.path.join(os.path.dirname(document), target))


def documents():
    """What is copied: the files of COPIED and all that they link, as paths from ROOT; and the links
    that lead nowhere, a line for each."""
    found = {
        file.relative_to(ROOT).as_posix()
        for pattern in COPIED
        for file in ROOT.glob(pattern)
        if file.is_file()
    }
    left, broken = sorted(found), []
    while left:
        document = left.pop()
        for target in links(document) if document.endswith(".md") else []:
            if target in found or target in MADE:
                continue
            if (ROOT / target).is_file() and not target.startswith(".."):
                found.add(target)
                left.append(target)
            else:
                broken.append(f"{document}: {target} is not a file of the clone")
    return found, sorted(broken)


def copy_documents(pages):
    for file in documents()[0]:
        target = pages / file
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(ROOT / file, target)
    for name in ("site.css", "formulas.js"):
        shutil.copyfile(ROOT / "docs" / name, pages / name)
    for file in [
        KATEX / "katex.min.js", KATEX / "katex.min.css", *(KATEX / "fonts").glob("*.woff2")
    ]:
        target = pages / "katex" / file.relative_to(KATEX)
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(file, target)


def python_reference():
    done = subprocess.run(
        [sys.executable, ROOT / "docs/python_reference.py"], capture_output=True, text=True
    )
    if done.returncode == 0:
        return done.stdout
    print(
        "docs: without the Python reference, since the package cannot be imported:",
        done.stderr.strip().split("\n")[-1], file=sys.stderr
    )
    return "# Python reference\n\nThese pages were built without the Python package.\n"


def main():
    names = missing()
    if names:
        print(
            (
                f"docs: missing {', '.join(names)}: on Debian apt-get install "
                f"--no-install-recommends {' '.join(names)}"
            ),
            file=sys.stderr,
        )
        return 4
    out = pathlib.Path(sys.argv[1]).resolve()
    pages = out / "pages"
    shutil.rmtree(pages, ignore_errors=True)
    copy_documents(pages)
    (pages / "python.md").write_text(python_reference())
    settings = (ROOT / "docs/Doxyfile").read_text() + f'OUTPUT_DIRECTORY = "{pages}"\n'
    subprocess.run(["doxygen", "-"], input=settings, cwd=ROOT, text=True, check=True)
    shutil.copyfile(ROOT / "docs/mkdocs.yml", out / "mkdocs.yml")
    # SOURCE_DATE_EPOCH: the same pages from the same clone.
    subprocess.run(
        [
            "mkdocs", "build", "--quiet", "--strict", "--clean", "-f", "mkdocs.yml",
            "-d", out / "site"
        ],
        cwd=out,
        check=True,
        env={**os.environ, "SOURCE_DATE_EPOCH": os.environ.get("SOURCE_DATE_EPOCH", "0")},
    )
    print(f"docs: {out / 'site' / 'index.html'}")
    return 0


if __name__ == "__main__":
    sys.exit(main())

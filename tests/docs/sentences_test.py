# SPDX-License-Identifier: BSD-3-Clause
"""Finds constructions that a reader who sees one comment alone cannot follow, in comments of the
sources and in documents.

sentences_test.py SOURCE      prints file:line, what was found, and what to write; exit code 1 where
anything is
"""
import pathlib
import re
import subprocess
import sys

# A construction, and what to say.
FORBIDDEN = [
    (r"\b(hang|hangs|hung|hanging) on\b", "depend on"),
    (r"\bin turn\b", "one after the other, or alternately"),
    (r"\b(that|this|it) will do\b", "suffices"),
    (r"\bmade ready\b", "initialised, or prepared"),
    (r"\bsittings?\b", "session"),
    (
        r"(?:^|[.:;] )The same\b(?! (?:\w+ ){0,3}"
        r"(?:is|are|holds|was|were|has|have|does|do|serves|applies|goes)\b)",
        "what it does, as if nothing were read before",
    ),
]
# Comments alone: documents speak of arms.
IN_COMMENTS = [
    (
        r"^Of arms\b|\bare of arms\b|\bis of arms\b",
        "for, or of which arms, in a sentence with a subject",
    )
]
DOCUMENTS = ("README.md", "HACKING.md", "CONTRIBUTING.md", "docs/*.md", "docs/guide/*.md")
SOURCES = (".hpp", ".cpp", ".inl", ".py", ".js", ".mjs", ".cmake", "CMakeLists.txt")


def comments(text, marks):
    """Runs of comment lines, joined: (line of the first, text)."""
    run, first = [], 0
    for number, line in enumerate([*text.split("\n"), ""], 1):
        found = re.search(rf"(?:^|[\s;{{}})])(?:{marks})\s?(.*)$", line)
        alone = found and not line[: found.start()].strip()
        if run and not alone:
            yield first, " ".join(run)
            run = []
        if found and alone:
            first = first if run else number
            run.append(found[1])
        elif found:
            yield number, found[1]


def paragraphs(text):
    """Of a document, outside of code: (line, text)."""
    run, first, code = [], 0, False
    for number, line in enumerate([*text.split("\n"), ""], 1):
        if line.startswith("```"):
            code = not code
        if run and (code or not line.strip() or line.startswith(("- ", "|", "#", "```"))):
            yield first, " ".join(run)
            run = []
        if not code and line.strip() and not line.startswith("```"):
            first = first if run else number
            run.append(line.strip())


def main():
    root = pathlib.Path(sys.argv[1])
    files = subprocess.run(
        ["git", "ls-files"], cwd=root, capture_output=True, text=True
    ).stdout.split()
    documents = {
        str(path.relative_to(root)) for pattern in DOCUMENTS for path in root.glob(pattern)
    }
    faults = read = 0
    for name in files:
        path = root / name
        if not path.is_file() or name == "tests/docs/sentences_test.py":
            continue
        if name in documents:
            texts, rules = paragraphs(path.read_text()), FORBIDDEN
        elif name.endswith(SOURCES):
            texts, rules = (
                comments(
                    path.read_text(),
                    r"///?<?" if name.endswith((".hpp", ".cpp", ".inl", ".js", ".mjs")) else "#",
                ),
                FORBIDDEN + IN_COMMENTS,
            )
        else:
            continue
        for line, text in texts:
            read += 1
            for pattern, instead in rules:
                for found in re.finditer(pattern, text):
                    around = text[max(0, found.start() - 30) : found.end() + 50]
                    print(f"{name}:{line}: '{found[0].strip()}': say {instead}: {around}")
                    faults += 1
    print(f"{read} comments and paragraphs, {faults} faults")
    if read < 1000:
        sys.exit("too few were read")
    sys.exit(faults > 0)


main()

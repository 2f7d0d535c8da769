# SPDX-License-Identifier: BSD-3-Clause
"""Checks the form of the decision records: docs/decisions/*.md, their index and table of constants,
docs/measurements/*.md.

decisions_test.py [ROOT]      ROOT: the clone; by default the one that this file lies in

Files are numbered without gaps or doubles and have at most 25 lines of at most 140 columns. A
status names later decisions that are there, links lead to files and headings that are there, the
index names every decision once with its title, and each constant of the table "Now in force" stands
in the code with its value. Every violation is printed in one line.
"""
import os
import pathlib
import re
import sys

LINES, COLUMNS = 25, 140
NAME = re.compile(r"(\d{4})-[a-z0-9]+(-[a-z0-9]+)*\.md")
STATUS = re.compile(r"\d{4}-\d\d-\d\d, (proposed|accepted|superseded by \d{4})(; .+)?")
LINK = re.compile(r"\]\(([^)#:\s]*)(?:#([^)\s]*))?\)")
CODE_FENCE = re.compile(r"^```.*?^```$", re.DOTALL | re.MULTILINE)
SOURCES = (".cpp", ".hpp", ".inl", ".py")


class Records:
    def __init__(self, root):
        self.root, self.folder = root, root / "docs/decisions"
        self.faults = []
        self.texts = {}  # by number
        self.names = {}
        self.checked = 0

    def expect(self, condition, where, what):
        self.checked += 1
        if not condition:
            self.faults.append(f"{where.relative_to(self.root)}: {what}")

    def read(self):
        for file in sorted(self.folder.glob("*")):
            if file.name == "README.md":
                continue
            name = NAME.fullmatch(file.name)
            self.expect(name, file, "its name is not NNNN-title.md")
            if not name:
                continue
            self.expect(
                name[1] not in self.texts, file,
                f"{name[1]} is the number of {self.names.get(name[1])} as well"
            )
            self.names[name[1]] = file.name
            self.texts[name[1]] = file.read_text()
        for k, number in enumerate(sorted(self.texts), 1):
            if int(number) != k:
                self.expect(False, self.folder, f"{k:04} is missing")
                break
        self.expect(self.texts, self.folder, "holds no decision")

    def check_decision(self, number):
        file, text = self.folder / self.names[number], self.texts[number]
        lines = text.rstrip("\n").split("\n")
        self.expect(len(lines) <= LINES, file, f"has {len(lines)} lines, allowed are {LINES}")
        for k, line in enumerate(lines, 1):
            self.expect(
                len(line) <= COLUMNS, file,
                f"line {k} has {len(line)} columns, allowed are {COLUMNS}"
            )
        self.expect(
            re.fullmatch(rf"# {number} \S.*", lines[0]), file,
            f"does not begin with '# {number} Title'"
        )
        blocks = text.split("\n\n")
        status = " ".join(blocks[1].split()) if len(blocks) > 1 else ""
        self.expect(
            STATUS.fullmatch(status), file,
            f"its status is '{status}', not 'YYYY-MM-DD, accepted' or 'superseded by NNNN'"
        )
        for part in self.superseding(status):
            self.expect(
                part in self.texts and part > number, file,
                f"is superseded by {part}, which is no later decision"
            )
        self.expect(
            re.search(r"^Decision\b", text, re.MULTILINE), file, "has no paragraph 'Decision: ...'"
        )

    @staticmethod
    def superseding(status):
        """The decisions that supersede one with this status, whole or in part."""
        after = re.search(r"superseded (?:in part )?by (.*)", status)
        return (
            re.findall(r"\b\d{4}\b", re.sub(r"\([^()]*\)", "", after[1].split(";")[0]))
            if after
            else []
        )

    def check_index(self):
        index = self.folder / "README.md"
        text = index.read_text()
        entries = re.findall(r"^- \[(\d{4}) (.+)\]\((\S+)\)(.*)$", text, re.MULTILINE)
        for number in self.texts:
            named = [entry for entry in entries if entry[0] == number]
            self.expect(
                len(named) == 1, index, f"names {number} {len(named)} times by theme, not once"
            )
            status = " ".join(self.texts[number].split("\n\n")[1].split())
            for _, title, file, mark in named:
                self.expect(
                    self.texts[number].startswith(f"# {number} {title}\n"), index,
                    f"{number} has another title"
                )
                self.expect(file == self.names[number], index, f"links {file} as {number}")
                marked = re.findall(r"\b\d{4}\b", mark)
                self.expect(
                    sorted(marked) == sorted(self.superseding(status)),
                    index,
                    (
                        f"{number} is superseded by "
                        f"{', '.join(self.superseding(status)) or 'none'}, marked is "
                        f"{', '.join(marked) or 'none'}"
                    ),
                )
        for number, *_ in entries:
            self.expect(number in self.texts, index, f"names {number}, which is not there")
        self.check_constants(index, text)

    def check_constants(self, index, text):
        """| what | value | `code` | file | decision |: the code stands in the file, which is the
        only one of that name."""
        files = {}
        for folder, inner, names in os.walk(self.root):
            inner[:] = [
                name
                for name in inner
                if not name.startswith(".")
                and name not in ("build", "tests", "node_modules", "__pycache__")
            ]
            for name in names:
                if name.endswith(SOURCES):
                    files.setdefault(name, []).append(pathlib.Path(folder, name))
        rows = re.findall(
            r"^\| (.+) \| (.+) \| `(.+)` \| (\S+) \| .*\[(\d{4})\]\(.*\|$", text, re.MULTILINE
        )
        for what, _, code, name, _ in rows:
            found = [
                file
                for file in files.get(name.rsplit("/", 1)[-1], [])
                if str(file).endswith("/" + name)
            ]
            self.expect(len(found) == 1, index, f"{what}: {len(found)} files are called {name}")
            if len(found) == 1:
                before, after = (
                    r"(?<![\w.'])" if code[0].isalnum() else "",
                    r"(?![\w.'])" if code[-1].isalnum() else "",
                )
                exact = before + r"\s+".join(map(re.escape, code.split())) + after
                self.expect(
                    re.search(exact, found[0].read_text()), index,
                    f"{what}: {name} does not hold `{code}`; its value has changed"
                )
        self.expect(
            len(rows) == len(re.findall(r"^\| .*\[\d{4}\]\(", text, re.MULTILINE))
            and len(rows) > 100,
            index,
            "a row of the constants has not five columns",
        )

    def check_links(self):
        for file in sorted(
            [*self.folder.glob("*.md"), *(self.root / "docs/measurements").glob("*.md")]
        ):
            for target, anchor in LINK.findall(CODE_FENCE.sub("", file.read_text())):
                linked = file.parent / target if target else file
                self.expect(linked.is_file(), file, f"links {target}, which is not there")
                if anchor and linked.is_file():
                    self.expect(
                        anchor in anchors(linked), file,
                        f"links {target}#{anchor}, which is not there"
                    )
        for file in sorted((self.root / "docs/measurements").glob("*")):
            number = file.stem
            self.expect(
                number in self.texts and f"(../measurements/{file.name})" in self.texts[number],
                file, "no decision of its number links it"
            )

    def run(self):
        self.read()
        for number in self.texts:
            self.check_decision(number)
        self.check_index()
        self.check_links()
        print(
            "\n".join(
                self.faults
                + [
                    f"{len(self.texts)} decisions, {self.checked} checks, {len(self.faults)} "
                    "violations"
                ]
            )
        )
        return 1 if self.faults else 0


def anchors(page):
    """Of its headings, as GitHub and MkDocs make them."""
    headings = re.findall(r"^#+ (.*)$", CODE_FENCE.sub("", page.read_text()), re.MULTILINE)
    return {
        re.sub(r"\s+", "-", re.sub(r"[^\w\s-]", "", heading).strip().lower())
        for heading in headings
    }


sys.exit(
    Records(
        pathlib.Path(sys.argv[1]).resolve()
        if len(sys.argv) > 1
        else pathlib.Path(__file__).resolve().parents[2]
    ).run()
)

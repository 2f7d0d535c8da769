# SPDX-License-Identifier: BSD-3-Clause
"""Checks that Markdown leaves the formulas of the documents whole: *.md, docs/, data/ and examples/
of the clone.

formulas_test.py [ROOT]      ROOT: the clone; by default the one that this file lies in

Formulas are written $...$ within a line or $$...$$. Every dollar has its partner; within formulas
nothing stands that GitHub or MkDocs take for Markdown (a star, an escape, an underscore that could
open emphasis); outside of formulas and code there are neither stars that Markdown would pair, as
those of G* and A*, nor raw indices and exponents; and lists begin after an empty line, without
which they are none for MkDocs. Where Node.js and KaTeX (Debian: libjs-katex) are installed, KaTeX
must understand each formula.
Every violation is printed in one line.
"""
import json
import pathlib
import re
import shutil
import subprocess
import sys

PLACES = ["*.md", "docs/**/*.md", "data/**/*.md", "examples/**/*.md"]
KATEX = pathlib.Path("/usr/share/javascript/katex/katex.js")
NOTHING = re.compile(r"^(```|~~~).*?^\1$|<!--.*?-->", re.DOTALL | re.MULTILINE)
CODE = re.compile(r"(?<!`)(`+)(?!`)(.+?)(?<!`)\1(?!`)", re.DOTALL)
TARGET = re.compile(r"\]\([^()\s]*(?:\([^()\s]*\)[^()\s]*)*\)|<https?://[^>]*>|https?://\S+")
FORMULA = re.compile(
    r"(?<!\\)\$\$(.+?)(?<!\\)\$\$|(?<!\\)\$(?!\s)([^$\n]+?)(?<![\s\\])\$", re.DOTALL
)
BULLET = re.compile(r"^(\s*)([-*+]|\d{1,2}\.) ")
INDEX = re.compile(r"(?<!\w)[^\W\d_]\u0302?_\w|_\{")
STAND_IN = "\ufffc"  # for a piece of code: neither space nor part of a word
# Where the document is taken apart, each must be found, and the last must not.
SAMPLES = {
    "of G* and A* alike": 2,
    "*Proof.* G* ends": 1,
    "an *emphasis": 1,
    "a * b": 1,
    "h_k(v) rises": 1,
    "heads in R_{j+1}": 1,
    "about 2^13": 1,
    "costs $5": 1,
    "from $a_k$ to $b": 1,
    "($G^*$)": 1,
    "$a\\,b$": 1,
    "$(a)_k$": 1,
    "$x^{2$": 1,
    "2$x$": 1,
    "$x$3": 1,
    "said _so": 1,
    "three:\n- a": 1,
    "is `G*`, $G^\\ast$ and A\\* of iiwa7_board, *if $h_k$ rises*, **at all**\n\n- a\n- b": 0,
}


class Document:
    def __init__(self, name, text):
        self.name, self.faults, self.formulas = name, [], []
        text = NOTHING.sub(lambda piece: "\n" * piece[0].count("\n"), text)
        line, start = 1, 1
        block = []
        for row in [*text.split("\n"), ""]:
            # Emphasis ends with its paragraph, item of a list, heading, or row of a table.
            if block and (
                not row.strip() or BULLET.match(row) or row.lstrip().startswith(("|", "#"))
            ):
                self.check_list(line, block[-1], row)
                self.check_block(start, "\n".join(block))
                block = []
            if not block:
                start = line
            if row.strip():
                block.append(row)
            line += 1

    def fault(self, start, text, position, what):
        around = (
            text[max(0, position - 24) : position + 24]
            .replace("\n", " ")
            .replace(STAND_IN, "`...`")
        )
        self.faults.append(
            f"{self.name}:{start + text[:position].count(chr(10))}: {what}: ... {around} ..."
        )

    def check_list(self, line, before, row):
        item = BULLET.match(row)
        if (
            item
            and not item[1]
            and item[2] in ("-", "*", "+", "1.")
            and not BULLET.match(before)
            and not before.startswith((" ", "|", "#"))
        ):
            self.faults.append(
                f"{self.name}:{line}: an empty line must stand before a list: {row[:40]} ..."
            )

    def check_block(self, start, text):
        text = TARGET.sub("]", CODE.sub(lambda code: STAND_IN + "\n" * code[0].count("\n"), text))
        if re.fullmatch(r"\s*[*_-]{3,}\s*", text):
            return
        for formula in FORMULA.finditer(text):
            self.check_formula(start, text, formula)
        text = FORMULA.sub(lambda formula: STAND_IN + "\n" * formula[0].count("\n"), text)
        text = re.sub(r"\\[!-/:-@\[-`{-~]", STAND_IN, text)
        for dollar in re.finditer(r"\$", text):
            self.fault(
                start, text, dollar.start(),
                "a dollar without its partner (\\$ is one that is meant)"
            )
        for caret in re.finditer(r"\^", text):
            self.fault(start, text, caret.start(), "an exponent outside of formulas and code")
        for index in INDEX.finditer(text):
            self.fault(start, text, index.start(), "an index outside of formulas and code")
        for edge in re.finditer(r"(?<!\w)_|_(?!\w)", text):
            if text[edge.start() : edge.start() + 2] != "_{":
                self.fault(start, text, edge.start(), "an underscore at the edge of a word")
        self.check_stars(start, BULLET.sub(lambda item: item[0].replace("*", "-"), text))

    def check_formula(self, start, text, formula):
        source = formula[1] or formula[2]
        self.formulas.append((self.name, source, formula[1] is not None))
        before, after = text[: formula.start()][-1:], text[formula.end() :][:1]
        wrong = [
            what
            for what, found in (
                (
                    "a letter or digit beside a dollar, which GitHub takes for money",
                    before.isalnum() or after.isalnum(),
                ),
                ("a star in a formula, which Markdown may pair (\\ast)", "*" in source),
                (
                    "an escape in a formula that Markdown takes away",
                    re.search(r"\\[^A-Za-z]", source),
                ),
                (
                    "an underscore in a formula that may open emphasis",
                    re.search(r"(?:^|[^A-Za-z0-9])_", source),
                ),
                ("braces of a formula that do not match", not balanced(source)),
            )
            if found
        ]
        for what in wrong:
            self.fault(start, text, formula.start(), what)

    def check_stars(self, start, text):
        """Stars open at the beginning of a word, and close at the end of one."""
        opened = []
        for run in re.finditer(r"\*+", text):
            before, after = text[: run.start()][-1:], text[run.end() :][:1]
            opens = after.strip() and not re.match(r"\w", before)
            closes = before.strip() and not re.match(r"\w", after)
            if closes and opened and opened[-1][0] == run[0]:
                opened.pop()
            elif opens:
                opened.append((run[0], run.start()))
            else:
                self.fault(
                    start, text, run.start(), "a star that closes nothing (\\*, or a formula)"
                )
        for _, position in opened:
            self.fault(start, text, position, "a star that nothing closes (\\*, or a formula)")


def balanced(source):
    depth = 0
    for brace in re.findall(r"[{}]", source):
        depth += 1 if brace == "{" else -1
        if depth < 0:
            return False
    return depth == 0


def misunderstood(formulas):
    """What KaTeX says of those that it does not understand; None where it is not installed."""
    node = shutil.which("node") or shutil.which("nodejs")
    if not node or not KATEX.is_file():
        return None
    program = """const katex = require(process.argv[1]), said = [];
for (const [name, source, displayMode] of JSON.parse(require("fs").readFileSync(0)))
  try { katex.renderToString(source, {displayMode, strict: "error"}); }
  catch (error) { said.push(`${name}: ${error.message}`); }
console.log(JSON.stringify(said));"""
    done = subprocess.run(
        [node, "-e", program, str(KATEX)],
        input=json.dumps(formulas),
        capture_output=True,
        text=True,
        check=True,
    )
    return json.loads(done.stdout)


def main():
    root = (
        pathlib.Path(sys.argv[1]).resolve()
        if len(sys.argv) > 1
        else pathlib.Path(__file__).resolve().parents[2]
    )
    faults = []
    for sample, expected in SAMPLES.items():
        found = Document("sample", sample).faults
        if len(found) != expected:
            faults.append(
                f"in the sample {sample!r} {len(found)} violations were found, not {expected}: "
                f"{found}"
            )
    files = sorted({file for place in PLACES for file in root.glob(place)})
    documents = [Document(str(file.relative_to(root)), file.read_text()) for file in files]
    formulas = [formula for document in documents for formula in document.formulas]
    said = misunderstood(formulas)
    faults += [fault for document in documents for fault in document.faults] + (said or [])
    if not formulas:
        faults.append(f"{root}: no formula was found")
    read = "not read by KaTeX, which is not installed" if said is None else "read by KaTeX"
    print(
        "\n".join(
            faults
            + [
                f"{len(documents)} documents, {len(formulas)} formulas ({read}), {len(faults)} "
                "violations"
            ]
        )
    )
    return 1 if faults else 0


sys.exit(main())

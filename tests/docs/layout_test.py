# SPDX-License-Identifier: BSD-3-Clause
"""Finds lines of sources that are wider than 100 columns, and functions longer than 60 lines.
Sources are files with an extension or a name of SOURCES, and files that begin with `#!`.

layout_test.py SOURCE     prints file:line and what was found; exit code 1 where a line is too wide
or a function of C++ is too long
"""
import pathlib
import re
import subprocess
import sys

MOST_LINES = 60
MOST_COLUMNS = 100
CPP = (".hpp", ".cpp", ".inl")
SOURCES = (*CPP, ".py", ".js", ".mjs", ".css", ".cmake", "CMakeLists.txt", "docs/Doxyfile")
# Inputs of the fuzzers are no sources, whatever their first bytes are.
CORPUS = re.compile(r"(^|/)corpus/")
# Lists of what a binding has are no algorithm, however long.
LISTS = ("python/src/",)
# Strings, characters and comments, of which braces do not count. Raw strings first.
TOKENS = re.compile(
    r'R"(?P<end>[^()\\ ]*)\(.*?\)(?P=end)"|"(?:\\.|[^"\\\n])*"|'
    r"(?<![0-9a-fA-F])'(?:\\.|[^'\\\n])+'|//[^\n]*|/\*.*?\*/",
    re.DOTALL,
)


def without_strings(text):
    """The text with strings and comments blank; line breaks stay, so that numbers of lines do."""
    return TOKENS.sub(lambda token: re.sub(r"[^\n]", " ", token[0]), text)


def functions(text):
    """Yields the outermost blocks that are bodies of functions: the line of the head, and how many
    lines there are from it to the closing brace."""
    text = without_strings(text)
    text = re.sub(
        r"^[ \t]*#(?:[^\n]*\\\n)*[^\n]*",
        lambda line: re.sub(r"[^\n]", " ", line[0]),
        text,
        flags=re.MULTILINE,
    )
    stack, head = [], 0
    for found in re.finditer(r"[{};]", text):
        at = found.start()
        if found[0] == ";":
            if not stack or stack[-1] is None:
                head = at + 1
        elif found[0] == "{":
            if stack and stack[-1] is not None:
                stack.append(stack[-1])  # a block of the function
                continue
            words = text[head:at]
            scope = re.search(
                r"\b(namespace|class|struct|union|enum|extern)\b", words
            ) and not re.search(r"\)[^()]*$", words)
            if scope or "(" not in words:
                stack.append(None)
                head = at + 1
            else:
                stack.append(head + len(words) - len(words.lstrip()))
        elif stack:
            began = stack.pop()
            if began is not None and (not stack or stack[-1] is None):
                # Braces of an initialiser list of a constructor end before its body.
                rest = text[at + 1 :].lstrip()
                if rest.startswith((",", "{")):
                    continue
                yield text.count("\n", 0, began) + 1, text.count("\n", began, at) + 1
            if not stack or stack[-1] is None:
                head = at + 1


def is_source(name, content):
    """Tells whether the file of this name and these bytes is a source."""
    return name.endswith(SOURCES) or (content[:2] == b"#!" and not CORPUS.search(name))


def main():
    root = pathlib.Path(sys.argv[1])
    files = subprocess.run(
        ["git", "ls-files", "-z"], cwd=root, capture_output=True, text=True, check=True
    ).stdout.split("\0")
    faults = long = bodies = scripts = 0
    for name in files:
        path = root / name
        content = path.read_bytes() if path.is_file() else b""
        if not is_source(name, content):
            continue
        scripts += not name.endswith(SOURCES)
        # Each byte that is no UTF-8 counts as one column.
        text = content.decode(errors="surrogateescape")
        for number, line in enumerate(text.split("\n"), 1):
            if len(line) > MOST_COLUMNS:
                print(f"{name}:{number}: {len(line)} columns; at most {MOST_COLUMNS}")
                faults += 1
        if not name.endswith(CPP):
            continue
        for number, lines in functions(text):
            bodies += 1
            if lines > MOST_LINES and not name.startswith(LISTS):
                long += 1
                print(f"{name}:{number}: a function of {lines} lines; at most {MOST_LINES}")
    print(f"{faults} lines too wide, {long} of {bodies} functions too long")
    if bodies < 1000 or scripts < 10:
        sys.exit("too few were read")
    sys.exit(faults > 0 or long > 0)


main()

#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Compares the tables of docs/formats.md with what the program prints; --fix puts the program's in.

tables.py SWIVEL FORMATS.md [--fix]      exit code 1: they differ
"""
import pathlib
import re
import subprocess
import sys

BLOCK = re.compile(r"<!-- schema (\w+) -->\n.*?<!-- /schema -->\n", re.DOTALL)


def main():
    program, page = sys.argv[1], pathlib.Path(sys.argv[2])
    printed = subprocess.run(
        [program, "schema", "tables"], check=True, capture_output=True, text=True
    ).stdout
    tables = {block[1]: block[0] for block in BLOCK.finditer(printed)}
    text = page.read_text()
    there = [block[1] for block in BLOCK.finditer(text)]
    if sorted(there) != sorted(tables):
        print(f"{page}: has the tables {sorted(there)}: allowed are {sorted(tables)}, each once")
        return 1
    made = BLOCK.sub(lambda block: tables[block[1]], text)
    if made == text:
        print(f"{page}: {len(tables)} tables are those of the program")
        return 0
    if "--fix" in sys.argv:
        page.write_text(made)
        return 0
    print(
        f"{page}: tables differ from `swivel schema tables`: run docs/tables.py {program} {page} "
        "--fix"
    )
    return 1


sys.exit(main())

# SPDX-License-Identifier: BSD-3-Clause
"""Checks, without the tools that docs/site.py needs, what its pages would be: no link of a document
leads nowhere, and links can be read on the light and on the dark ground.

site_test.py [ROOT]      ROOT: the clone; by default the one that this file lies in

Every violation is printed in one line.
"""
import importlib.util
import pathlib
import re
import sys
import tempfile

ROOT = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else __file__).resolve()
ROOT = ROOT if ROOT.is_dir() else ROOT.parent.parent.parent
GROUNDS = {"default": "#ffffff", "slate": "#2e303e"}  # of the theme, by scheme
LEAST = 4.5  # contrast of text, WCAG 2.2

spec = importlib.util.spec_from_file_location("docs_site", ROOT / "docs/site.py")
site = importlib.util.module_from_spec(spec)
spec.loader.exec_module(site)


def contrast(one, other):
    """The contrast of two colours #rrggbb by WCAG 2.2."""
    def light(colour):
        parts = [int(colour[k:k + 2], 16) / 255 for k in (1, 3, 5)]
        parts = [v / 12.92 if v <= 0.04045 else ((v + 0.055) / 1.055) ** 2.4 for v in parts]
        return 0.2126 * parts[0] + 0.7152 * parts[1] + 0.0722 * parts[2]

    a, b = sorted((light(one), light(other)))
    return (b + 0.05) / (a + 0.05)


def unreadable(style):
    """The colours of links that a style sheet lacks, or that are too faint, a line for each."""
    faults = []
    for scheme, ground in GROUNDS.items():
        own = rf'\[data-md-color-scheme="{scheme}"\][^{{]*{{[^}}]*'
        rule = re.search(own + "--md-typeset-a-color: (#[0-9a-f]{6})", style)
        if not rule:
            faults.append(f"docs/site.css: no colour of links in the scheme {scheme}")
        elif contrast(rule[1], ground) < LEAST:
            faults.append(
                f"docs/site.css: links of {rule[1]} on {ground} have a contrast of "
                f"{contrast(rule[1], ground):.2f}, at least {LEAST}"
            )
    return faults


def check_itself():
    """A clone with a link that holds, one by way of it, and three that lead nowhere."""
    with tempfile.TemporaryDirectory() as folder:
        clone = pathlib.Path(folder)
        (clone / "own").mkdir()
        (clone / "README.md").write_text(
            "[a](own/a.md#there) [b](own) [`c`](c.txt) `[d](d.md)` [e](https://e.org) [f](../f)\n"
        )
        (clone / "own/a.md").write_text("[reference](../python.md) ![picture](a.png)\n")
        (clone / "own/a.png").write_text("")
        real, site.ROOT = site.ROOT, clone
        found, broken = site.documents()
        site.ROOT = real
    assert found == {"README.md", "own/a.md", "own/a.png"}, found
    nowhere = [line.split()[1] for line in broken]
    assert nowhere == ["../f", "c.txt", "own"], broken
    assert len(unreadable("")) == 2
    faint = '[data-md-color-scheme="slate"] { --md-typeset-a-color: #546d78; }'
    assert "of 2.38" in unreadable(faint)[1], unreadable(faint)


check_itself()
faults = site.documents()[1] + unreadable((ROOT / "docs/site.css").read_text())
print("\n".join(faults))
sys.exit(1 if faults else 0)

# SPDX-License-Identifier: BSD-3-Clause
"""Maps, pages and notebook views of plans, and certificates that there is no path."""
from __future__ import annotations

import base64
import gzip
import html
import os
import pathlib
import sys
import tempfile
import webbrowser

from . import _swivel
from .runs import _loaded

# Bytes of a compressed page that is put into a notebook; a larger one is only named.
_MOST_IN_A_NOTEBOOK = 4_000_000

# Opens the compressed page beside the button in a window of its own. In an element's handler URL
# alone would be the address of the document.
_OPEN = (
    "const c=Uint8Array.from(atob(this.dataset.page),x=>x.charCodeAt(0));"
    "new Response(new Blob([c]).stream().pipeThrough(new DecompressionStream('gzip'))).text()"
    ".then(t=>window.open(window.URL.createObjectURL(new Blob([t],{type:'text/html'}))))"
)


def _given(problem):
    """Returns the Problem that is given, or that the file has; None for None."""
    return None if problem is None else _loaded(problem)


def _written(text, file):
    if file is None:
        return text
    pathlib.Path(file).write_text(text, encoding="utf-8")
    return None


def report(
    problem: Problem | _File | None, answer: Answer, file: _File | None = None
) -> str | Any:
    """Makes the page of an answer: what `swivel plan --report` writes, one HTML file.

    problem: the Problem that was planned, or the name of its file; None for the one that the answer
    keeps, which it does until it is pickled. file: where the page is written.

    Returns the page as text, or None where it was written. The problem is planned again, which
    gives the same answer, in the time of one plan. Raises ValueError for answers without a verdict,
    for those that depend on functions of Python, for a problem with another answer, and where the
    package was built without pages.
    """
    return _written(_swivel._draw(answer, _given(problem), True, False)[1], file)


def map_svg(
    problem: Problem | _File | None, answer: Answer, file: _File | None = None, *,
    full: bool = False
) -> str | Any:
    """Draws the lattice maps of an answer as SVG: what `swivel plan --map-svg` writes.

    One map of one path, one below the other of strokes and of two arms, each below its name.
    problem, answer, file: as for report(). full: ask the clearance of every node, not
    only of those that the search asked about.

    Returns the SVG as text, or None where it was written. Raises as report() does.
    """
    return _written(_swivel._draw(answer, _given(problem), False, full)[0], file)


def certificate(
    problem: Problem | _File, *, planner: _PlannerKind = "parallel", threads: int = 0,
    timeout: float | None = None
) -> Certificate | WorkcellCertificate | None:
    """Proves that a problem has no answer, as `swivel plan --certificate` does.

    problem: a Problem, or the name of its file. The others are those of Planner.plan().

    Returns a Certificate of one path or of a stroke, a WorkcellCertificate of two arms; None where
    the problem has an answer. Raises ValueError where strokes have no answer though each has a path
    by itself, and TimeoutError.
    """
    return _swivel._certificate(_loaded(problem), planner, threads, timeout)


def load_certificate(file: _File) -> Certificate | WorkcellCertificate:
    """Loads what `plan --certificate` or save() wrote. Raises InputError."""
    try:
        of_two_arms = b'"swivel certificate of a workcell' in pathlib.Path(file).read_bytes()
    except OSError:
        of_two_arms = False  # what reads it says what is wrong
    load = _swivel._load_workcell_certificate if of_two_arms else _swivel._load_certificate
    return load(file)


def check_certificate(
    problem: Problem | _File, certificate: Certificate | WorkcellCertificate | _File, *,
    timeout: float | None = None
) -> CertificateCheck | WorkcellCertificateCheck:
    """Verifies a certificate from the problem alone, as `swivel check --certificate` does.

    problem: a Problem, with the stroke that the certificate is of if it is of one, or the name of
    its file. certificate: a Certificate, a WorkcellCertificate of two arms, or the name of a file
    of either. timeout: s, or None.

    Returns a CertificateCheck; of two arms a WorkcellCertificateCheck. Raises InputError for the
    certificate of another problem, and TimeoutError.
    """
    if isinstance(certificate, (str, os.PathLike)):
        certificate = load_certificate(certificate)
    return _swivel._check_certificate(_loaded(problem), certificate, timeout)


class _Frame:
    """A page within a cell of a notebook."""

    def __init__(self, page, height):
        self._page, self._height = page, height

    def _repr_html_(self):
        return (
            f'<iframe srcdoc="{html.escape(self._page)}" style="width:100%;height:{self._height}px;'
            'border:0" allowfullscreen></iframe>'
        )


def _in_a_notebook():
    shell = sys.modules.get("IPython") and sys.modules["IPython"].get_ipython()
    return shell is not None and hasattr(shell, "kernel")


def _report(self, file: _File | None = None) -> str | Any:
    """Makes the page of the answer: what `swivel plan --report` writes. See swivel.report()."""
    return report(None, self, file)


def _map_svg(self, file: _File | None = None, *, full: bool = False) -> str | Any:
    """Draws the lattice maps of the answer as SVG. See swivel.map_svg()."""
    return map_svg(None, self, file, full=full)


def _show(self, *, height: int = 720) -> None:
    """Shows the page of the answer: in the cell of a notebook, else in the web browser.

    height: of the cell, pixels. Raises as report() does.
    """
    page = self.report()
    if _in_a_notebook():
        from IPython.display import display

        display(_Frame(page, height))
        return
    with tempfile.NamedTemporaryFile(
        "w", suffix=".html", prefix="swivel-", encoding="utf-8", delete=False
    ) as file:
        file.write(page)
    webbrowser.open(pathlib.Path(file.name).as_uri())


def _html(self):
    """Returns what a notebook shows: the answer, its map, and a button that opens the page."""
    words = html.escape(repr(self).removeprefix("<Answer ").removesuffix(">"))
    answer = f'<pre style="white-space:pre-wrap">{words}</pre>'
    try:
        image, page = _swivel._draw(self, None, _swivel._page_available(), False)
    except ValueError:  # there is nothing to draw, or nothing to draw it from
        return answer
    data = base64.b64encode(image.encode()).decode()
    drawn = (
        '<div style="max-height:36em;overflow:auto"><img alt="Lattice maps" '
        f'style="max-width:100%" src="data:image/svg+xml;base64,{data}"/></div>' if image else ""
    )
    if not page:
        return answer + drawn
    packed = gzip.compress(page.encode(), mtime=0)
    if len(packed) > _MOST_IN_A_NOTEBOOK:
        return f"{answer}{drawn}<p>The page is large: report(file) writes it.</p>"
    button = (
        f'<p><button onclick="{html.escape(_OPEN)}" '
        f'data-page="{base64.b64encode(packed).decode()}">Open the page</button></p>'
    )
    return answer + drawn + button


def _certificate(
    self, problem: Problem | _File | None = None, *, timeout: float | None = None
) -> Certificate | WorkcellCertificate:
    """Proves that the problem has no answer, as `swivel plan --certificate` does.

    problem: the Problem that was planned, or the name of its file; None for the one that the answer
    keeps until it is pickled. timeout: s, or None.

    Returns what certificate() returns. The problem is planned again. Raises ValueError for answers
    that are not infeasible, for those that were made with refine, a motion or functions of Python,
    for strokes that each have a path by themselves, and TimeoutError.
    """
    if not self._is_of_problem_alone():
        raise ValueError(
            "a certificate is of the problem as it is: allowed is an answer without refine, speed, "
            "turn_speed, rate and functions of Python"
        )
    if self.status != "infeasible":
        raise ValueError(f"the answer is '{self.status}': allowed is one that is infeasible")
    problem = self._problem() if problem is None else _given(problem)
    if problem is None:
        raise ValueError(
            "problem: an answer that was unpickled has none: allowed is the problem that was "
            "planned"
        )
    proof = certificate(problem, planner=self.planner, timeout=timeout)
    if proof is None:
        raise ValueError("problem: has another answer than this one: allowed is its own")
    return proof


def extend():
    """Gives answers what is written in this file."""
    for method in (_report, _map_svg, _show, _certificate):
        setattr(_swivel.Answer, method.__name__[1:], method)
    _swivel.Answer._repr_html_ = _html

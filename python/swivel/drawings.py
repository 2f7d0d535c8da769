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
    problem: Problem | _File | None, plan: Plan | JobPlan | WorkcellPlan,
    file: _File | None = None
) -> str | Any:
    """Makes the page of a plan: what `swivel plan --report` writes, one HTML file.

    problem: the Problem that was planned, or the name of its file; None for the one that the plan
    keeps, which it does until it is pickled. plan: Plan, JobPlan or WorkcellPlan.
    file: where the page is written.

    Returns the page as text, or None where it was written. The problem is planned again, which
    gives the same path, in the time of one plan. Raises ValueError for plans without a verdict, for
    those that depend on functions of Python, for a problem with another answer, and where the
    package was built without pages.
    """
    if isinstance(plan, _swivel.JobPlan):
        return _written(_swivel._draw_job(plan, _given(problem)), file)
    if isinstance(plan, _swivel.WorkcellPlan):
        return _written(_swivel._draw_workcell(plan, _given(problem)), file)
    return _written(_swivel._draw(plan, _given(problem), True, False)[1], file)


def map_svg(
    problem: Problem | _File | None, plan: Plan, file: _File | None = None, *, full: bool = False
) -> str | Any:
    """Draws the lattice map of a plan as SVG: what `swivel plan --map-svg` writes.

    problem, plan, file: as for report(). full: ask the clearance of every node, not only of those
    that the search asked about.

    Returns the SVG as text, or None where it was written. Raises as report() does.
    """
    return _written(_swivel._draw(plan, _given(problem), False, full)[0], file)


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
    problem = _loaded(problem)
    if problem._kind() == "one path":
        return _swivel._certificate(problem, planner, threads, timeout)
    plan = _swivel._plan_strokes if problem._kind() == "strokes" else _swivel._plan_two_arms
    answer = plan(problem, planner=planner, threads=threads, timeout=timeout)
    return None if answer.solved else answer.certificate(timeout=timeout)


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
    of_two_arms = isinstance(certificate, _swivel.WorkcellCertificate)
    verify = _swivel._check_workcell_certificate if of_two_arms else _swivel._check_certificate
    return verify(_loaded(problem), certificate, timeout)


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


def _plan_report(self, file: _File | None = None) -> str | Any:
    """Makes the page of the plan: what `swivel plan --report` writes. See swivel.report()."""
    return report(None, self, file)


def _plan_map_svg(self, file: _File | None = None, *, full: bool = False) -> str | Any:
    """Draws the lattice map of the plan as SVG. See swivel.map_svg()."""
    return map_svg(None, self, file, full=full)


def _plan_show(self, *, height: int = 720) -> None:
    """Shows the page of the plan: in the cell of a notebook, else in the web browser.

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


def _plan_html(self):
    """Returns what a notebook shows: the answer, its map, and a button that opens the page."""
    words = html.escape(repr(self).removeprefix("<Plan ").removesuffix(">"))
    answer = f'<pre style="white-space:pre-wrap">{words}</pre>'
    try:
        image, page = _swivel._draw(self, None, _swivel._page_available(), False)
    except ValueError:  # there is nothing to draw, or nothing to draw it from
        return answer
    data = base64.b64encode(image.encode()).decode()
    drawn = (
        '<img alt="Lattice map" style="max-width:100%;max-height:36em" '
        f'src="data:image/svg+xml;base64,{data}"/>'
    )
    if not page:
        return answer + drawn
    packed = gzip.compress(page.encode(), mtime=0)
    if len(packed) > _MOST_IN_A_NOTEBOOK:
        return f"{answer}{drawn}<p>The page is large: plan.report(file) writes it.</p>"
    button = (
        f'<p><button onclick="{html.escape(_OPEN)}" '
        f'data-page="{base64.b64encode(packed).decode()}">Open the page</button></p>'
    )
    return answer + drawn + button


def _workcell_certificate(
    self, workcell: Problem | _File | None = None, *, timeout: float | None = None
) -> WorkcellCertificate:
    """Proves that the workcell has no plan, as `swivel plan WORKCELL --certificate` does.

    workcell: the Problem that was planned, or the name of its file; None for the one that the plan
    keeps until it is pickled. timeout: s, or None.

    Returns a WorkcellCertificate. The proof comes from a search of its own. Raises ValueError for
    plans that are not infeasible, or were made with refine or speed, and TimeoutError.
    """
    return _swivel._workcell_certificate(self, _given(workcell), timeout)


def _job_certificate(
    self, job: Problem | _File | None = None, *, timeout: float | None = None
) -> Certificate:
    """Proves that a stroke has no path by itself, as `swivel plan JOB --certificate` does.

    job: the Problem that was planned, or the name of its file; None for the one that the plan keeps
    until it is pickled. timeout: s, or None.

    Returns a Certificate, of the first such stroke; check_certificate() verifies it. The job is
    planned again. Raises ValueError for plans in which each stroke has a path by itself and for
    those with a motion, and TimeoutError.
    """
    return _swivel._job_certificate(self, _given(job), timeout)


def extend():
    """Gives the classes of plans what is written in this file."""
    for kind, proof in (
        (_swivel.JobPlan, _job_certificate),
        (_swivel.WorkcellPlan, _workcell_certificate),
    ):
        kind.report, kind.show, kind.certificate = _plan_report, _plan_show, proof
    for name, method in (
        ("report", _plan_report),
        ("map_svg", _plan_map_svg),
        ("show", _plan_show),
        ("_repr_html_", _plan_html),
    ):
        setattr(_swivel.Plan, name, method)

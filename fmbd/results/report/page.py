"""Put the page together from its template, its style, its scripts, and what they show."""

import json
from html import escape
from importlib.resources import files
from typing import TYPE_CHECKING

from fmbd import __version__
from fmbd.results.plots.kinds import KINDS, chart
from fmbd.results.report import facts
from fmbd.results.report.embedding import embedded

if TYPE_CHECKING:
    from fmbd.results.run import Run

SCRIPTS = ("data.js", "plot.js", "player.js", "page.js")


def report(run: "Run") -> str:
    """A page of HTML about a run: the moving mechanism, plots, the model, warnings, provenance.

    It holds all its data and works from a file, without a network. Raises ValueError for a run without two outputs.
    """
    if len(run.time) < 2:
        raise ValueError("there is nothing to report: the run has fewer than two outputs")
    charts = [found for kind in KINDS if (found := chart(run, kind)).rows]
    warnings = "".join(f"<li>{escape(text)}</li>" for text in facts.warnings(run))
    status = "complete" if run.status == "complete" else "incomplete"
    parts = {
        "title": escape(run.model.name),
        "description": escape(run.model.description or ""),
        "status": f'<span class="status {status}">{escape(run.status)}</span>',
        "counts": escape(facts.counts(run)),
        "warnings": f'<ul class="warnings">{warnings}</ul>' if warnings else "<p>None.</p>",
        "parameters": facts.parameters(run),
        "model": facts.model_tables(run),
        "statistics": facts.statistics(run),
        "provenance": facts.provenance(run),
        "yaml": facts.model_text(run),
        "version": __version__,
        "style": _resource("page.css"),
        "scripts": "\n".join(_resource(script) for script in SCRIPTS),
        "data": json.dumps(embedded(run, charts), separators=(",", ":"), ensure_ascii=False).replace(
            "</", "<\\/"
        ),
    }
    page = _resource("page.html")
    before, *pieces = page.split("{{")
    for piece in pieces:
        name, after = piece.split("}}", 1)
        before += parts[name] + after
    return before


def _resource(name: str) -> str:
    return (files("fmbd.results.report") / name).read_text(encoding="utf-8")

"""Put a page together from its template, its style, its scripts, and what they show."""

import json
from collections.abc import Mapping
from html import escape
from importlib.resources import files
from typing import TYPE_CHECKING, Any

from fmbd import __version__
from fmbd.model import Model
from fmbd.results.plots.kinds import KINDS, chart
from fmbd.results.report import facts
from fmbd.results.report.embedding import embedded

if TYPE_CHECKING:
    from fmbd.results.run import Run

SCRIPTS = ("data.js", "plot.js", "charts.js")


def report(run: "Run") -> str:
    """A page of HTML about a run: the moving mechanism, plots, the model, warnings, provenance.

    It holds all its data and works from a file, without a network. Raises ValueError for a run without two outputs.
    """
    if len(run.time) < 2:
        raise ValueError("there is nothing to report: the run has fewer than two outputs")
    charts = [found for kind in KINDS if (found := chart(run, kind)).rows]
    parts = {
        "counts": escape(facts.counts(run)),
        "warnings": facts.listed(facts.warnings(run), "warnings") or "<p>None.</p>",
        "statistics": facts.statistics(run),
    }
    attributes = getattr(run.source, "attributes", {})
    return page(
        "run", run.model, run.status, attributes, parts, embedded(run, charts), ("player.js", "run.js")
    )


def page(
    kind: str,
    model: Model,
    status: str,
    attributes: Mapping[str, Any],
    parts: Mapping[str, str],
    data: Mapping[str, Any],
    scripts: tuple[str, ...],
) -> str:
    """A page about what came of a model: the template of its kind, filled.

    attributes: of the file that it is from; parts: HTML by name, of what only this kind has; data: for the scripts
    """
    colour = "complete" if status == "complete" else "incomplete"
    common = {
        "title": escape(model.name),
        "description": escape(model.description or ""),
        "status": f'<span class="status {colour}">{escape(status)}</span>',
        "parameters": facts.parameters(model),
        "model": facts.model_tables(model),
        "provenance": facts.provenance(model, attributes),
        "yaml": facts.model_text(model),
    }
    body = _filled(_resource(f"{kind}.html"), {**common, **parts})
    frame = {
        "title": escape(model.name),
        "body": body,
        "version": __version__,
        "style": _resource("page.css"),
        "scripts": "\n".join(_resource(script) for script in (*SCRIPTS, *scripts)),
        "data": json.dumps(data, separators=(",", ":"), ensure_ascii=False).replace("</", "<\\/"),
    }
    return _filled(_resource("page.html"), frame)


def _filled(template: str, parts: Mapping[str, str]) -> str:
    before, *pieces = template.split("{{")
    for piece in pieces:
        name, after = piece.split("}}", 1)
        before += parts[name] + after
    return before


def _resource(name: str) -> str:
    return (files("fmbd.results.report") / name).read_text(encoding="utf-8")

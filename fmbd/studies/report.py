"""The page about a study: verdicts, plots to zoom and to read, tables, the model, where it is from."""

from html import escape
from typing import Any

from fmbd.results.report import facts
from fmbd.results.report.embedding import Arrays, embedded_charts
from fmbd.results.report.page import page
from fmbd.studies.charts import charts
from fmbd.studies.study import Study
from fmbd.studies.tables import failures, share_of_time, table

LEGEND = """<p class="quiet">order: observed in each three in a row; error: a bound of the largest, in shares of the
largest value, a cautious guess where it begins with ~</p>"""


def report(study: Study) -> str:
    """A page of HTML that holds all its data; raises ValueError for a study without results."""
    if not study.results:
        raise ValueError("there is nothing to report: fewer than two members got to their end")
    arrays = Arrays()
    data: dict[str, Any] = {"charts": embedded_charts(charts(study), arrays), "arrays": arrays.texts}
    failed = list(failures(study))
    axes = "; ".join(
        f"{axis.path} = {', '.join(f'{value:g}' for value in axis.values)}" for axis in study.axes
    )
    remarks = [f"Left out: {text}." for text in failed]
    remarks += [f"Time: {text}." for text in share_of_time(study)]
    parts = {
        "counts": escape(f"refinement of {axes}"),
        "verdicts": "".join(
            facts.listed((result.verdict for result in study.results if result.is_certain is certain), kind)
            for certain, kind in ((True, "verdicts"), (False, "warnings"))
        ),
        "remarks": facts.listed(remarks, "warnings" if failed else "quiet"),
        "tables": "".join(_table(study, k) for k in range(len(study.results))),
        "legend": LEGEND,
    }
    status = "interrupted" if study.is_interrupted else "incomplete" if failed else "complete"
    return page("study", study.model, status, study.attributes, parts, data, ("study.js",))


def _table(study: Study, k: int) -> str:
    caption, headings, rows = table(study, study.results[k])
    return f"<h3>{escape(caption)}</h3>{facts.table(headings, rows)}"

"""What a study says in words and numbers: a table of each result, what failed, what the integration over time takes."""

from collections.abc import Iterator
from math import isnan

from numpy import ndarray as Array

from fmbd.studies.study import Result, Study, percent


def table(study: Study, result: Result) -> tuple[str, list[str], list[list[str]]]:
    """Caption, headings and rows of a result, from coarse to fine."""
    return (_over_time if result.is_over_time else _once)(study, result)


def _over_time(study: Study, result: Result) -> tuple[str, list[str], list[list[str]]]:
    """Differences to the finest, orders, bounds of the error, costs."""
    size, found = result.found.size, result.found
    itself = f"at most {size.largest:.4g}, RMS {size.mean:.4g}"
    caption = f"{result.quantity} [{result.unit}], {itself}; differences to the finest:"
    headings = ["largest", "RMS", "at the end", "order", "error", "steps", "evaluations"]
    rows = []
    for k, (value, share, order) in enumerate(zip(result.values, found.shares(), _orders(result))):
        measured = study.members[result.members[k]].measured
        sizes = [found.differences[k]] if k < len(found.differences) else []
        differences = [f"{x:.2e}" for size in sizes for x in (size.largest, size.mean, size.end)] or [""] * 3
        cost = measured.statistics if measured else {}
        costs = [str(cost["steps"]), str(cost["evaluations"])]
        rows.append([f"{value:g}", *differences, order, _bound(result, share), *costs])
    return caption, [result.axis.key, *headings], rows


def _once(study: Study, result: Result) -> tuple[str, list[str], list[list[str]]]:
    """Values, differences to the finest, orders, bounds of the error."""
    found = result.found
    rows = []
    for k, (value, share, order) in enumerate(zip(result.values, found.shares(), _orders(result))):
        measured = study.members[result.members[k]].measured
        difference = f"{found.differences[k].end:.2e}" if k < len(found.differences) else ""
        got = _numbers(measured.values[result.quantity]) if measured else ""
        rows.append([f"{value:g}", got, difference, order, _bound(result, share)])
    if found.extrapolated is not None:
        rows.append(["limit", _numbers(found.extrapolated), "", "", ""])
    headings = [result.axis.key, "value", "difference", "order", "error"]
    return f"{result.quantity} [{result.unit}]", headings, rows


def _numbers(values: Array) -> str:
    """A number, or several columns."""
    return ", ".join(f"{value:.12g}" for value in values.ravel())


def _bound(result: Result, share: float) -> str:
    """The bound of an error; about so where it is a guess."""
    return f"{'' if result.found.is_settled else '~'}{percent(share)}"


def _orders(result: Result) -> list[str]:
    """The order at the last of each three in a row, - where there is none."""
    orders = [order.order for order in result.found.orders]
    return ["", "", *("-" if isnan(order) else f"{order:.2f}" for order in orders)][: len(result.values)]


def failures(study: Study) -> Iterator[str]:
    """Members that are left out, and why."""
    for member in (*study.members, *([study.check] if study.check else [])):
        if member.problem:
            changes = ", ".join(f"{path} = {value}" for path, value in member.changes.items())
            yield f"{changes}: {member.problem}"


def share_of_time(study: Study) -> Iterator[str]:
    """What share of the last differences is the error of the time integration, if that was measured."""
    shares = {result.quantity: result.time_share for result in study.results if result.time_share is not None}
    if shares:
        worst = max(shares, key=lambda name: shares[name])
        advice = "" if shares[worst] <= 0.1 else ": too much, choose a tighter tolerance or a shorter step"
        yield f"its integration makes {percent(shares[worst])} of the last difference in {worst}{advice}"

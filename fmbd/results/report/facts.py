"""What a report says in words and tables: the model part by part, how the run went, what to mind, where it is from."""

from collections.abc import Iterable, Mapping
from html import escape
from typing import TYPE_CHECKING, Any

import numpy as np

from fmbd.model import Beam, Model
from fmbd.results.course import course
from fmbd.results.layout import ENERGIES

if TYPE_CHECKING:
    from fmbd.results.run import Run

#: Parts of a model in the order of a reader, and what their tables are called.
SECTIONS = {
    "bodies": "Bodies",
    "joints": "Joints",
    "motors": "Motors",
    "controllers": "Controllers",
    "springs": "Springs and dampers",
    "loads": "Loads",
    "signals": "Signals",
    "materials": "Materials",
    "sections": "Cross-sections",
}
SETTINGS = ("gravity", "ground", "initial", "simulation")

#: Energy lost, against energy moved, that a user should mind.
LARGE_LOSS = 1e-3


def table(heads: Iterable[str], rows: Iterable[Iterable[str]]) -> str:
    """An HTML table of texts; the first column heads its rows."""
    head = "".join(f"<th>{escape(text)}</th>" for text in heads)
    body = "".join(
        f"<tr><th>{escape(first)}</th>{''.join(f'<td>{escape(text)}</td>' for text in rest)}</tr>"
        for first, *rest in rows
    )
    above = f"<thead><tr>{head}</tr></thead>" if head else ""
    return f'<div class="wide"><table>{above}<tbody>{body}</tbody></table></div>'


def listed(texts: Iterable[str], kind: str) -> str:
    """A list of sentences, of a kind that the style knows; empty without any."""
    items = "".join(f"<li>{escape(text)}</li>" for text in texts)
    return f'<ul class="{kind}">{items}</ul>' if items else ""


def model_tables(model: Model) -> str:
    """Every part of the model as its file has it: parts of one kind and type share a table."""
    document: dict[str, Any] = model.document.data
    found = []
    for section, title in SECTIONS.items():
        by_type: dict[str, dict[str, Mapping[str, Any]]] = {}
        for name, part in (document.get(section) or {}).items():
            fields = part if isinstance(part, Mapping) else {"value": part}
            by_type.setdefault(str(fields.get("type", "")), {})[name] = fields
        tables = [_parts_table(kind, parts) for kind, parts in by_type.items()]
        if tables:
            found.append(f"<h3>{title}</h3>{''.join(tables)}")
    settings = [(key, flow(document[key])) for key in SETTINGS if key in document]
    return "".join(found) + "<h3>Settings</h3>" + table((), settings)


def _parts_table(kind: str, parts: Mapping[str, Mapping[str, Any]]) -> str:
    keys = list(dict.fromkeys(key for part in parts.values() for key in part if key != "type"))
    rows = ([name, *(flow(part[key]) if key in part else "" for key in keys)] for name, part in parts.items())
    return table([kind, *keys], rows)


def flow(value: Any) -> str:
    """A value in one line, as YAML has it."""
    if isinstance(value, Mapping):
        return ", ".join(f"{key}: {_within(each)}" for key, each in value.items())
    return _within(value)


def _within(value: Any) -> str:
    if isinstance(value, Mapping):
        return "{" + flow(value) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(_within(each) for each in value) + "]"
    if isinstance(value, float):
        return f"{value:.10g}"
    return str(value).lower() if isinstance(value, bool) else str(value)


def parameters(model: Model) -> str:
    """Parameters of the model with their values; the changes to its file."""
    rows = [(name, f"{value:.10g}") for name, value in model.parameters.items()]
    return table(("parameter", "value"), rows) if rows else "<p>The model has no parameters.</p>"


def counts(run: "Run") -> str:
    """The size of a model in one line."""
    model, source = run.model, run.source
    beams = sum(isinstance(body, Beam) for body in model.bodies.values())
    numbers = (
        (len(model.bodies) - beams, "rigid body", "rigid bodies"),
        (beams, "beam", "beams"),
        (len(model.joints), "joint", "joints"),
        (len(model.motors), "motor", "motors"),
        (len(source.coordinates), "coordinate", "coordinates"),
        (len(source.constraints), "constraint", "constraints"),
    )
    return ", ".join(f"{count} {one if count == 1 else many}" for count, one, many in numbers if count)


def statistics(run: "Run") -> str:
    """How the run went."""
    simulation, s = run.model.simulation, run.statistics
    method = f"auto: {s['choice']}" if s.get("choice") else simulation.method
    rows = [
        ("status", run.status),
        ("simulated", f"{run.time[-1]:g} of {simulation.duration:g} s, {len(run.time)} outputs"),
        ("method", f"{method}, rtol {simulation.rtol:g}, atol {simulation.atol:g}"),
        *((label, text) for label, text in course(s) if label not in ("remark", "warning")),
    ]
    return table((), rows)


def warnings(run: "Run") -> list[str]:
    """What a reader of the results should mind, one sentence each."""
    found = []
    if run.status != "complete":
        found.append(f"The run is not complete: {run.status}.")
    found += [remark for remark in str(run.statistics.get("remarks", "")).splitlines() if remark]
    found += [warning for warning in str(run.statistics.get("warnings", "")).splitlines() if warning]
    moved = max(float(np.ptp(run.energy[name])) for name in ENERGIES if name != "balance")
    lost = float(np.abs(run.energy["balance"]).max())
    if lost > LARGE_LOSS * moved:
        found.append(
            f"The energy balance is off by {lost:.2g} J, of {moved:.2g} J that moved: use a smaller rtol."
        )
    return found


def provenance(model: Model, attributes: Mapping[str, Any]) -> str:
    """Which program and machine made a file, from which model, by its attributes; none if it was never written."""
    rows = [
        ("model", str(attributes.get("model_file", model.path or model.name))),
        *(
            (label, str(attributes[key]))
            for key, label in (
                ("command", "command"),
                ("started", "started [UTC]"),
                ("fmbd_version", "fmbd"),
                ("python", "Python"),
                ("platform", "platform"),
                ("model_sha256", "SHA-256 of the model"),
            )
            if key in attributes
        ),
    ]
    libraries = [
        f"{key.removesuffix('_version')} {value}"
        for key, value in attributes.items()
        if key.endswith("_version")
    ]
    return table((), [*rows, *([("libraries", ", ".join(libraries))] if libraries else [])])


def model_text(model: Model) -> str:
    """The model with its changes, as YAML."""
    return escape(model.yaml())

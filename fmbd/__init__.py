"""fmbd: open planar flexible-multibody finite elements.

    model = fmbd.load_model("models/five_bar.yaml")
    run = fmbd.simulate(model.with_("bodies.*.elements", 4), "five_bar.vtkhdf")
    run["rod_right.end.position"]

Names are imported when they are first used, so that `import fmbd` takes no time.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from fmbd.errors import ModelError, UnknownQuantity
    from fmbd.model import Model, load_model
    from fmbd.model.schema import json_schema
    from fmbd.results.animation.movie import animate
    from fmbd.results.archive import ArchiveError
    from fmbd.results.plots.plot import figures
    from fmbd.results.report.page import report
    from fmbd.results.run import Run, open_run
    from fmbd.results.simulate import simulate
    from fmbd.system import System, assemble

__version__ = "0.1.0"

__all__ = [
    "ArchiveError",
    "Model",
    "ModelError",
    "Run",
    "System",
    "UnknownQuantity",
    "__version__",
    "animate",
    "assemble",
    "figures",
    "json_schema",
    "load_model",
    "open_run",
    "report",
    "simulate",
]

_HOMES = {
    "ArchiveError": "fmbd.results.archive",
    "Model": "fmbd.model",
    "ModelError": "fmbd.errors",
    "Run": "fmbd.results.run",
    "System": "fmbd.system",
    "UnknownQuantity": "fmbd.errors",
    "animate": "fmbd.results.animation.movie",
    "assemble": "fmbd.system",
    "figures": "fmbd.results.plots.plot",
    "json_schema": "fmbd.model.schema",
    "load_model": "fmbd.model",
    "open_run": "fmbd.results.run",
    "report": "fmbd.results.report.page",
    "simulate": "fmbd.results.simulate",
}


def __getattr__(name: str) -> Any:
    if name not in _HOMES:
        raise AttributeError(f"module 'fmbd' has no attribute '{name}'")
    value = getattr(import_module(_HOMES[name]), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return __all__

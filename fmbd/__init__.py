"""fmbd: open planar flexible-multibody finite elements.

    model = fmbd.load_model("models/five_bar.yaml")
    run = fmbd.simulate(model.with_("bodies.*.elements", 4), "five_bar.vtkhdf")
    run["rod_right.end.position"]

Names are imported when they are first used, so that `import fmbd` takes no time.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from fmbd.analyses.inverse import Inverse, inverse
    from fmbd.analyses.kinematics import Kinematics, kinematics
    from fmbd.analyses.state_space import StateSpace, linearize
    from fmbd.analyses.statics import Equilibrium, equilibrium
    from fmbd.analyses.vibrations import Modes, modes
    from fmbd.errors import AnalysisError, ModelError, UnknownQuantity
    from fmbd.model import Model, load_model
    from fmbd.model.schema import json_schema
    from fmbd.results.animation.movie import animate
    from fmbd.results.archive import ArchiveError
    from fmbd.results.paraview import draw
    from fmbd.results.plots.plot import figures
    from fmbd.results.report.page import report
    from fmbd.results.run import Run, open_run
    from fmbd.results.simulate import simulate
    from fmbd.studies.refine import refine
    from fmbd.studies.sensitivity import Sensitivity, sensitivity
    from fmbd.studies.study import Study
    from fmbd.studies.study_file import open_study
    from fmbd.studies.verify import verify
    from fmbd.system import System, assemble

__version__ = "0.1.0"

__all__ = [
    "AnalysisError",
    "ArchiveError",
    "Equilibrium",
    "Inverse",
    "Kinematics",
    "Model",
    "ModelError",
    "Modes",
    "Run",
    "Sensitivity",
    "StateSpace",
    "Study",
    "System",
    "UnknownQuantity",
    "__version__",
    "animate",
    "assemble",
    "draw",
    "equilibrium",
    "figures",
    "inverse",
    "json_schema",
    "kinematics",
    "linearize",
    "load_model",
    "modes",
    "open_run",
    "open_study",
    "refine",
    "report",
    "sensitivity",
    "simulate",
    "verify",
]

_HOMES = {
    "AnalysisError": "fmbd.errors",
    "ArchiveError": "fmbd.results.archive",
    "Equilibrium": "fmbd.analyses.statics",
    "Inverse": "fmbd.analyses.inverse",
    "Kinematics": "fmbd.analyses.kinematics",
    "Model": "fmbd.model",
    "ModelError": "fmbd.errors",
    "Modes": "fmbd.analyses.vibrations",
    "Run": "fmbd.results.run",
    "Sensitivity": "fmbd.studies.sensitivity",
    "StateSpace": "fmbd.analyses.state_space",
    "Study": "fmbd.studies.study",
    "System": "fmbd.system",
    "UnknownQuantity": "fmbd.errors",
    "animate": "fmbd.results.animation.movie",
    "assemble": "fmbd.system",
    "draw": "fmbd.results.paraview",
    "equilibrium": "fmbd.analyses.statics",
    "figures": "fmbd.results.plots.plot",
    "inverse": "fmbd.analyses.inverse",
    "json_schema": "fmbd.model.schema",
    "kinematics": "fmbd.analyses.kinematics",
    "linearize": "fmbd.analyses.state_space",
    "load_model": "fmbd.model",
    "modes": "fmbd.analyses.vibrations",
    "open_run": "fmbd.results.run",
    "open_study": "fmbd.studies.study_file",
    "refine": "fmbd.studies.refine",
    "report": "fmbd.results.report.page",
    "sensitivity": "fmbd.studies.sensitivity",
    "simulate": "fmbd.results.simulate",
    "verify": "fmbd.studies.verify",
}


def __getattr__(name: str) -> Any:
    if name not in _HOMES:
        raise AttributeError(f"module 'fmbd' has no attribute '{name}'")
    value = getattr(import_module(_HOMES[name]), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return __all__

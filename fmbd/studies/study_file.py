"""A study as one HDF5 file.

/model                              YAML text of the model that was refined
/model_files/<n>                    text of the n-th table that the model names, attribute `name`
/members/<k>                        attributes: changes (JSON), status, and the solver's statistics of a run
/members/<k>/time                   (nt,) [s], of a run
/members/<k>/values/<quantity>      (nt,), (nt, columns) or (), attribute `units`
/check                              as a member: the finest once more, integrated more tightly
/results/<quantity>/<path>          attributes: units, verdict, order, is_settled, time_error of the finest
                                    (RMS), bar_... of it; datasets by the members along the path, from coarse to fine:
                                    member, value, difference_... to the finest (one less), error_..., each with
                                    largest, mean and end; observed_order and agreement (two less); extrapolated
attributes of /                     as those of an archive: versions, command, time, model_file, model_sha256;
                                    analysis, analysis_options (JSON), quantities, axes (JSON: path, values, sizes),
                                    is_interrupted

What is computed from the series, `/results`, is there for other programs: `open_study` computes it anew.
"""

import json
from dataclasses import asdict
from pathlib import Path

import h5py
import numpy as np

from fmbd.model import load_model_text
from fmbd.results.archive import ArchiveError
from fmbd.results.layout import provenance
from fmbd.studies.convergence import Size
from fmbd.studies.measure import COMPLETE, Analysis, Measured
from fmbd.studies.study import Axis, Member, Result, Study
from fmbd.studies.summary import is_study


def write_study(study: Study, path: Path) -> None:
    """Write a study to a file, replacing it; OSError names it."""
    try:
        file = h5py.File(path, "w")
    except OSError as error:
        raise OSError(f"cannot write {path}: {error}") from None
    with file:
        file.attrs.update(provenance(study.model.yaml()))
        file.attrs["model_file"] = str(study.model.path or f"{study.model.name}.yaml")
        options = asdict(study.analysis)
        file.attrs.update({"analysis": options.pop("kind"), "analysis_options": json.dumps(options)})
        file.attrs["quantities"] = list(study.quantities)
        file.attrs["is_interrupted"] = study.is_interrupted
        file.attrs["axes"] = json.dumps([asdict(axis) for axis in study.axes])
        file["model"] = study.model.yaml()
        for k, (name, text) in enumerate(study.model.files.items()):
            file[f"model_files/{k}"] = text
            file[f"model_files/{k}"].attrs["name"] = name
        for k, member in enumerate(study.members):
            _member(file.create_group(f"members/{k}"), member)
        if study.check is not None:
            _member(file.create_group("check"), study.check)
        for result in study.results:
            _result(file.create_group(f"results/{result.quantity}/{result.axis.path}"), result)


def open_study(path: str | Path) -> Study:
    """The study in a file that `Study.save` wrote; raises OSError, and ArchiveError for another file."""
    Path(path).open("rb").close()  # a missing file is told as such
    if not is_study(path):
        raise ArchiveError(f"{path}: neither a study nor an archive of fmbd")
    with h5py.File(path) as file:
        attributes = dict(file.attrs)
        tables = {table.attrs["name"]: table.asstr()[()] for table in file.get("model_files", {}).values()}
        members = [_read_member(file[f"members/{k}"]) for k in range(len(file["members"]))]
        model = load_model_text(file["model"].asstr()[()], attributes["model_file"], files=tables)
        check = _read_member(file["check"]) if "check" in file else None
    axes = json.loads(attributes.pop("axes"))
    options = json.loads(attributes.pop("analysis_options"))
    return Study(
        model=model,
        analysis=Analysis.of(attributes.pop("analysis"), **options),
        quantities=tuple(attributes.pop("quantities")),
        axes=tuple(Axis(axis["path"], tuple(axis["values"]), tuple(axis["sizes"])) for axis in axes),
        members=tuple(members),
        check=check,
        is_interrupted=bool(attributes.pop("is_interrupted")),
        attributes=attributes,
    )


def _read_member(group: h5py.Group) -> Member:
    attributes = {
        key: value.item() if hasattr(value, "item") else value for key, value in group.attrs.items()
    }
    changes, status = json.loads(attributes.pop("changes")), attributes.pop("status")
    if status != COMPLETE:
        return Member(changes, None, status)
    values = {name: dataset[()] for name, dataset in group["values"].items()}
    units = {name: str(dataset.attrs["units"]) for name, dataset in group["values"].items()}
    time = group["time"][:] if "time" in group else None
    return Member(changes, Measured(values, units, time, status, attributes))


def _member(group: h5py.Group, member: Member) -> None:
    measured = member.measured
    group.attrs["changes"] = json.dumps(dict(member.changes))
    group.attrs["status"] = member.problem or COMPLETE
    if measured is None:
        return
    group.attrs.update(measured.statistics)
    if measured.time is not None:
        group["time"] = measured.time
        group["time"].attrs["units"] = "s"
    for name, values in measured.values.items():
        group[f"values/{name}"] = values
        group[f"values/{name}"].attrs["units"] = measured.units[name]


def _result(group: h5py.Group, result: Result) -> None:
    found = result.found
    group.attrs.update(
        {
            "units": result.unit,
            "verdict": result.verdict,
            "order": found.order,
            "is_settled": found.is_settled,
            "time_error": result.time_error.mean if result.time_error else np.nan,
        }
    )
    group["member"], group["value"] = result.members, result.values
    for name, sizes in (("difference", found.differences), ("error", found.errors)):
        for norm in Size.__dataclass_fields__:
            group[f"{name}_{norm}"] = [getattr(size, norm) for size in sizes]
            group[f"{name}_{norm}"].attrs["units"] = result.unit
    group["observed_order"] = [order.order for order in found.orders]
    group["agreement"] = [order.agreement for order in found.orders]
    if found.extrapolated is not None:
        group["extrapolated"] = found.extrapolated

"""A study as one HDF5 file.

/model                              YAML text of the model that was refined
/members/<k>                        attributes: changes (JSON), status, and the solver's statistics of a run
/members/<k>/time                   (nt,) [s], of a run
/members/<k>/values/<quantity>      (nt,), (nt, columns) or (), attribute `units`
/check                              as a member: the finest once more, integrated more tightly
/results/<quantity>/<path>          attributes: units, verdict, order, is_settled, time_error of the finest
                                    (RMS), bar_... of it; datasets by the members along the path, from coarse to fine:
                                    member, value, difference_... to the finest (one less), error_..., each with
                                    largest, mean and end; observed_order and agreement (two less); extrapolated
attributes of /                     as those of an archive: versions, command, time, model_sha256
"""

import json
from pathlib import Path

import h5py
import numpy as np

from fmbd.results.layout import provenance
from fmbd.studies.convergence import Size
from fmbd.studies.study import Member, Result, Study


def write_study(study: Study, path: Path) -> None:
    """Write a study to a file, replacing it; OSError names it."""
    try:
        file = h5py.File(path, "w")
    except OSError as error:
        raise OSError(f"cannot write {path}: {error}") from None
    with file:
        file.attrs.update(provenance(study.model.yaml()))
        file.attrs.update({"analysis": str(study.analysis), "quantities": list(study.quantities)})
        file["model"] = study.model.yaml()
        for k, member in enumerate(study.members):
            _member(file.create_group(f"members/{k}"), member)
        if study.check is not None:
            _member(file.create_group("check"), study.check)
        for result in study.results:
            _result(file.create_group(f"results/{result.quantity}/{result.axis.path}"), result)


def _member(group: h5py.Group, member: Member) -> None:
    measured = member.measured
    group.attrs["changes"] = json.dumps(dict(member.changes))
    group.attrs["status"] = member.problem or "complete"
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

"""Derivatives as one HDF5 file.

/model                                YAML text of the model as it was run
/time                                 (nt,) [s], of a run
/values/<quantity>                    (nt,), (nt, columns), () or (1, columns), attribute `units`
/derivatives/<quantity>/<parameter>   attributes: nominal, step; datasets: derivative and error, shaped as the values;
                                      a group for each of the numbers `end`, `peak` and `RMS` of a run, or `value`, of
                                      columns `x end` and so on, with attributes value, derivative, error
attributes of /                       as those of an archive: versions, command, time, model_sha256
"""

from pathlib import Path

import h5py

from fmbd.results.layout import provenance
from fmbd.studies.sensitivity import Sensitivity


def write_sensitivity(found: Sensitivity, path: Path) -> None:
    """Write derivatives to a file, replacing it; OSError names it."""
    try:
        file = h5py.File(path, "w")
    except OSError as error:
        raise OSError(f"cannot write {path}: {error}") from None
    with file:
        file.attrs.update(provenance(found.model.yaml()))
        file.attrs["analysis"] = str(found.analysis)
        file["model"] = found.model.yaml()
        if found.time is not None:
            file["time"] = found.time
            file["time"].attrs["units"] = "s"
        for one in found.derivatives:
            name = f"values/{one.quantity}"
            if name not in file:
                file[name] = one.values
                file[name].attrs["units"] = one.unit
            group = file.create_group(f"derivatives/{one.quantity}/{one.parameter}")
            group.attrs.update({"nominal": one.nominal, "step": one.step})
            group["derivative"], group["error"] = one.derivative, one.error
            for what, number in one.numbers.items():
                group.create_group(what).attrs.update(vars(number))

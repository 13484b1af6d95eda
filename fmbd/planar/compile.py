"""How kernels are compiled: by Numba, cached on disk.

Kernels allocate nothing, so reference counts are left out (they cost more than the arithmetic: five times as much for
the five-bar), and so are checks for division by zero: a result that is not finite is for the caller to see.

Numba itself looks at the file of a cached function only, not at those of the functions that it calls. Here the cache
lies in a folder named after a digest of all kernel sources, so that an edit anywhere compiles everything anew.
"""

import hashlib
import os
import shutil
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

import numba

Decorator = Callable[[Callable[..., Any]], Callable[..., Any]]

# read at run time, so that the environment and numba.config both count
config: Any = numba.config

_PACKAGE = Path(__file__).parents[1]
# fused multiply-add, and one reciprocal for several divisions: the last digit may differ
_ROUNDING = {"contract", "arcp"}


@cache
def cache_folder() -> Path:
    """Where the compiled kernels lie: below NUMBA_CACHE_DIR, or the package, or the user's cache."""
    digest = hashlib.sha256()
    for file in sorted(path for part in ("planar", "solvers") for path in (_PACKAGE / part).glob("*.py")):
        digest.update(file.read_bytes())
    name = f"kernels-{digest.hexdigest()[:16]}"
    places = [Path(config.CACHE_DIR)] if config.CACHE_DIR else [_PACKAGE / "__pycache__", _user_cache()]
    for place in places:
        try:
            place.mkdir(parents=True, exist_ok=True)
        except OSError:
            continue
        if os.access(place, os.W_OK) or (place / name).is_dir():
            for old in place.glob("kernels-*"):
                if old.name != name:
                    shutil.rmtree(old, ignore_errors=True)
            return place / name
    return places[-1] / name


def _user_cache() -> Path:
    return (
        Path(os.environ.get("LOCALAPPDATA") or os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache")
        / "fmbd"
    )


def is_compiled(module: str, kernel: str) -> bool:
    """Whether a kernel has been compiled before, for some machine: `is_compiled("explicit", "advance")`."""
    return bool(config.DISABLE_JIT) or any(cache_folder().rglob(f"{module}.{kernel}-*.nbi"))


def _decorator(**options: Any) -> Decorator:
    common: dict[str, Any] = {"cache": True, "error_model": "numpy", "_nrt": False, "fastmath": _ROUNDING}

    def decorate(function: Callable[..., Any]) -> Callable[..., Any]:
        chosen = config.CACHE_DIR
        config.CACHE_DIR = str(cache_folder())
        try:
            kernel: Callable[..., Any] = numba.njit(**(common | options))(function)
        finally:
            config.CACHE_DIR = chosen
        return kernel

    return decorate


_INSIDE = {"no_cpython_wrapper": True, "no_cfunc_wrapper": True}

#: A kernel that Python may call.
compiled = _decorator()
#: A kernel that only other kernels call.
inner = _decorator(**_INSIDE)
#: A part of a kernel, merged into it wherever it is called.
part = _decorator(**_INSIDE, forceinline=True)
#: A part whose sums over modes may be reordered, so that they use the processor's vector units.
part_sums = _decorator(**_INSIDE, forceinline=True, fastmath={*_ROUNDING, "reassoc"})

"""How kernels are compiled: by Numba, cached on disk.

Kernels allocate nothing, so reference counts are left out (they cost more than the arithmetic: five times as much for
the five-bar), and so are checks for division by zero: a result that is not finite is for the caller to see.

Numba itself looks at the file of a cached function only, not at those of the functions that it calls. Here the cache
lies in a folder named after a digest of all kernel sources, so that an edit anywhere compiles everything anew.

Numba optimises each function that another one calls, and turns it into machine code, before it merges it. Parts of
kernels are left as they are written until then, which takes half the time to compile.
"""

import hashlib
import os
import shutil
import time
from collections.abc import Callable
from contextlib import suppress
from functools import cache, partial
from pathlib import Path
from typing import Any

import numba
from numba.core.compiler import Compiler
from numba.core.compiler_machinery import register_pass
from numba.core.typed_passes import NativeLowering

Decorator = Callable[[Callable[..., Any]], Callable[..., Any]]

# read at run time, so that the environment and numba.config both count
config: Any = numba.config

_PACKAGE = Path(__file__).parents[1]
# fused multiply-add, and one reciprocal for several divisions: the last digit may differ
_ROUNDING = {"contract", "arcp"}


@cache
def cache_folder() -> Path:
    """Where the compiled kernels lie: below NUMBA_CACHE_DIR, or else the user's cache, or else the package."""
    digest = hashlib.sha256()
    for file in sorted(path for part in ("planar", "solvers") for path in (_PACKAGE / part).glob("*.py")):
        digest.update(file.read_bytes())
    name = f"kernels-{digest.hexdigest()[:16]}"
    places = [Path(config.CACHE_DIR)] if config.CACHE_DIR else [*_user_cache(), _PACKAGE / "__pycache__"]
    for place in places:
        with suppress(OSError):
            (place / name).mkdir(parents=True, exist_ok=True)
            if os.access(place / name, os.W_OK):
                (place / name).touch()
                _forget(place)
                return place / name
    return places[-1] / name


def _user_cache() -> list[Path]:
    with suppress(RuntimeError):  # there may be no home
        home = os.environ.get("LOCALAPPDATA") or os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache"
        return [Path(home) / "fmbd"]
    return []


def _forget(place: Path) -> None:
    """Remove kernels that no program has used for a month."""
    for old in place.glob("kernels-*"):
        with suppress(OSError):
            if time.time() - old.stat().st_mtime > 30 * 24 * 3600:
                shutil.rmtree(old)


@register_pass(mutates_CFG=True, analysis_only=False)
class _LowerForMerging(NativeLowering):
    """Numba's last pass but for optimisation and machine code, which no one asks of a part."""

    _name = "lower_for_merging"

    def run_pass(self, state: Any) -> bool:
        context = state.targetctx
        library = context.codegen().create_library(state.func_id.func_qualname)
        library._optimize_final_module = _nothing
        library._finalize_final_module = partial(setattr, library, "_finalized", True)
        state.library = library
        # of the entry point, Numba wants no more than that it is a built-in method unlike any other
        context.get_executable = lambda *_: [].append
        try:
            return bool(super().run_pass(state))
        finally:
            del context.get_executable


class _PartCompiler(Compiler):
    def define_pipelines(self) -> list[Any]:
        pipelines: list[Any] = super().define_pipelines()
        for pipeline in pipelines:
            pipeline.passes = [
                (_LowerForMerging if which is NativeLowering else which, why)
                for which, why in pipeline.passes
            ]
        return pipelines


def _nothing() -> None:
    pass


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


#: An index or a count that is not negative. Numba looks at the sign of any other index, which keeps a loop from using
#: the processor's vector units.
index: Any = int if config.DISABLE_JIT else numba.uintp

_INSIDE: dict[str, Any] = {"no_cpython_wrapper": True, "no_cfunc_wrapper": True}
_MERGED = _INSIDE | {"forceinline": True, "cache": False, "pipeline_class": _PartCompiler}

#: A kernel that Python may call.
compiled = _decorator()
#: A kernel that only other kernels call.
inner = _decorator(**_INSIDE)
#: A part of a kernel, merged into it wherever it is called.
part = _decorator(**_MERGED)
#: A part whose sums over modes may be reordered, so that they use the processor's vector units.
part_sums = _decorator(**_MERGED, fastmath={*_ROUNDING, "reassoc"})

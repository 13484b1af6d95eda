"""How kernels are compiled: by Numba, cached on disk.

Kernels allocate nothing, so reference counts are left out (they cost more than the arithmetic: five times as much for
the five-bar), and so are checks for division by zero: a result that is not finite is for the caller to see.
"""

from collections.abc import Callable
from typing import Any

from numba import njit

Decorator = Callable[[Callable[..., Any]], Callable[..., Any]]

# fused multiply-add, and one reciprocal for several divisions: the last digit may differ
_ROUNDING = {"contract", "arcp"}


def _decorator(**options: Any) -> Decorator:
    common: dict[str, Any] = {"cache": True, "error_model": "numpy", "_nrt": False, "fastmath": _ROUNDING}
    decorator: Decorator = njit(**(common | options))
    return decorator


_INSIDE = {"no_cpython_wrapper": True, "no_cfunc_wrapper": True}

#: A kernel that Python may call.
compiled = _decorator()
#: A kernel that only other kernels call.
inner = _decorator(**_INSIDE)
#: A part of a kernel, merged into it wherever it is called.
part = _decorator(**_INSIDE, forceinline=True)
#: A part whose sums over modes may be reordered, so that they use the processor's vector units.
part_sums = _decorator(**_INSIDE, forceinline=True, fastmath={*_ROUNDING, "reassoc"})

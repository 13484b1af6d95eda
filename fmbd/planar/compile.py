"""How kernels are compiled: by Numba, cached on disk.

Kernels allocate nothing, so reference counts are left out (they cost more than the arithmetic: five times as much for
the five-bar), and so are checks for division by zero: a result that is not finite is for the caller to see.
"""

from collections.abc import Callable
from typing import Any

from numba import njit

Decorator = Callable[[Callable[..., Any]], Callable[..., Any]]

_OPTIONS: dict[str, Any] = {"cache": True, "error_model": "numpy", "_nrt": False}
_INSIDE = {"no_cpython_wrapper": True, "no_cfunc_wrapper": True}
# fused multiply-add, and one reciprocal for several divisions: the last digit may differ
_ROUNDING = {"contract", "arcp"}

#: A kernel that Python may call.
compiled: Decorator = njit(fastmath=_ROUNDING, **_OPTIONS)
#: A kernel that only other kernels call.
inner: Decorator = njit(fastmath=_ROUNDING, **_OPTIONS, **_INSIDE)
#: A part of a kernel, merged into it wherever it is called.
part: Decorator = njit(fastmath=_ROUNDING, forceinline=True, **_OPTIONS, **_INSIDE)
#: A part whose sums over modes may be reordered, so that they use the processor's vector units.
part_sums: Decorator = njit(fastmath={*_ROUNDING, "reassoc"}, forceinline=True, **_OPTIONS, **_INSIDE)

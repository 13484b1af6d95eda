"""How kernels are compiled: by Numba, cached on disk.

Kernels allocate nothing, so reference counts are left out (they cost more than the arithmetic: five times as much for
the five-bar), and so are checks for division by zero: a result that is not finite is for the caller to see.
"""

from collections.abc import Callable
from typing import Any

from numba import njit

_OPTIONS: dict[str, Any] = {"cache": True, "error_model": "numpy", "_nrt": False, "forceinline": True}

compiled: Callable[[Callable[..., Any]], Callable[..., Any]] = njit(**_OPTIONS)
#: Sums over modes may be reordered, so that they use the processor's vector units.
compiled_sums: Callable[[Callable[..., Any]], Callable[..., Any]] = njit(
    fastmath={"reassoc", "contract"}, **_OPTIONS
)

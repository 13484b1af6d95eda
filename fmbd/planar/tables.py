"""Tables of piecewise cubics: the first column is where a piece begins, in order."""

import numpy as np

from fmbd.planar.compile import part


@part
def piece(table: np.ndarray, first: int, end: int, x: float) -> int:
    """The last row in [first, end) that begins at or before x; the first stands for all that is before it, too."""
    low, high = first, end
    while high - low > 1:
        middle = (low + high) // 2
        if table[middle, 0] <= x:
            low = middle
        else:
            high = middle
    return low

"""Modes: free motions exp(lambda t) of a mechanism about a state, with all forces, damping, motors and controllers.

lambda = S - 1/mu for the eigenvalues mu of the resolvent W(S) (linearisation.py): slow motions beside fast ones keep
their digits, which the eigenvalues of A itself would lose.
"""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from fmbd.analyses.about import Base, base
from fmbd.analyses.linearisation import SHIFT, Linearisation
from fmbd.analyses.stiffness import shares
from fmbd.model import Model
from fmbd.results.files import save_data
from fmbd.results.run import Run

Array = np.ndarray

#: Files that modes can be written to.
KINDS = (".json", ".csv", ".npz", ".mat", ".h5")
#: Poles [1/s] below this are zero to round-off; it is double where nothing damps the motion.
ZERO = 1e-5
#: A damping ratio below this is none.
UNDAMPED = 1e-10


@dataclass(frozen=True, eq=False)
class Modes:
    """Modes by ascending natural frequency; of a pair of complex poles the one with Im > 0, m in all."""

    base: Base
    poles: Array  #: lambda [1/s], complex, shape (m,); 0 for a motion that nothing opposes
    shapes: Array  #: nodal generalised coordinates, complex, largest entry 1, shape (m, nq)
    shares: tuple[
        dict[str, float], ...
    ]  #: of coordinates, and beams as a whole, in the kinetic energy of each

    @property
    def frequencies(self) -> Array:
        """|lambda| / 2 pi [Hz], 0 for motions that do not oscillate, shape (m,)."""
        return np.where(self.poles.imag > 0.0, np.abs(self.poles), 0.0) / (2.0 * np.pi)

    @property
    def damping_ratios(self) -> Array:
        """-Re lambda / |lambda|, nan for 0; negative if the motion grows, shape (m,)."""
        size = np.abs(self.poles)
        return np.divide(-self.poles.real, size, out=np.full(size.size, np.nan), where=size > 0.0)

    @property
    def decay_times(self) -> Array:
        """Time [s] in which the amplitude falls by e, -1 / Re lambda; negative if it grows, shape (m,)."""
        damped = np.abs(self.damping_ratios) > UNDAMPED
        return np.divide(-1.0, self.poles.real, out=np.full(damped.size, np.inf), where=damped)

    @property
    def stable(self) -> bool:
        """Whether no motion grows."""
        return not (self.decay_times < 0.0).any()

    @property
    def coordinates(self) -> list[str]:
        """Names of the coordinates, the columns of the shapes."""
        return self.base.linearisation.system.coordinate_names

    def save(self, path: str | Path) -> None:
        """Write poles, frequencies, damping and shapes: .json, .csv, .npz, .mat, .h5. Raises ValueError for another."""
        save_data(path, self.data(), self.table(), KINDS)

    def plot(self, path: str | Path, number: int = 6) -> None:
        """Draw the first modes on the mechanism: .svg, .pdf or .png."""
        from fmbd.analyses.mode_shapes import draw
        from fmbd.results.plots.style import save

        save(draw(self, number), path)

    def data(self) -> dict[str, Any]:
        """What is written."""
        return {
            "poles": self.poles,
            "frequencies": self.frequencies,
            "damping_ratios": self.damping_ratios,
            "decay_times": self.decay_times,
            "shapes": self.shapes,
            "coordinates": self.coordinates,
            "units": [unit for _, unit in self.base.linearisation.system.coordinates],
        }

    def table(self) -> Iterator[list[Any]]:
        """Rows of a CSV file: a mode each, its shape as real and imaginary parts."""
        parts = [f"{name}.{part}" for name in self.coordinates for part in ("re", "im")]
        yield ["frequency[Hz]", "damping_ratio", "pole.re[1/s]", "pole.im[1/s]", *parts]
        for k, pole in enumerate(self.poles):
            shape = self.shapes[k].view(float).tolist()
            yield [float(self.frequencies[k]), float(self.damping_ratios[k]), pole.real, pole.imag, *shape]


def modes(
    model: Model | str | Path,
    *,
    about: str | Path | Run = "equilibrium",
    time: float | None = None,
    lock: str | Iterable[str] | None = None,
    moving: bool = False,
    release: bool = False,
    open_loop: bool = False,
) -> Modes:
    """Natural frequencies, damping and shapes about `equilibrium`, `start`, or the state of a run or archive at a time.

    Of all that the model has: beams, springs, gravity, constraint forces and their change of direction, dampers,
    gyroscopic forces, motors with their circuits, controllers. Arguments as in `analyses.about.base`.
    Raises ModelError, ArchiveError, AnalysisError.
    """
    about_ = base(model, about, time, lock, moving, release, open_loop)
    lin = about_.linearisation
    poles, x = _poles(lin)
    shapes = lin.directions(x)[0]
    # the first of the large ones: of two that are equal round-off would choose another in the next mesh
    large = np.abs(shapes) > 0.9 * np.abs(shapes).max(axis=0, initial=0.0)
    largest = large.argmax(axis=0) if shapes.size else np.zeros(0, int)
    scale = shapes[largest, np.arange(poles.size)]
    scale = np.where(np.abs(scale) > 0.0, scale, 1.0)
    return Modes(
        about_,
        poles,
        np.ascontiguousarray((shapes / scale).T),
        tuple(shares(lin, x[: lin.freedom, k]) for k in range(poles.size)),
    )


def _poles(lin: Linearisation) -> tuple[Array, Array]:
    """Poles (m,) by their size, and x as columns (nx, m)."""
    if not lin.size:
        return np.zeros(0, complex), np.zeros((0, 0), complex)
    W = lin.resolvent
    mu, x = np.linalg.eig(W)
    poles = SHIFT - 1.0 / mu.astype(complex)
    some = (np.abs(poles) > ZERO) & (poles.imag > -1e-12 * np.abs(poles))
    _, size, V = np.linalg.svd(np.eye(lin.size) - SHIFT * W)
    free = V[size < ZERO**2].T  # x' = 0: a double pole has one of them
    poles, x = poles[some], x[:, some]
    order = np.argsort(np.abs(poles))
    zeros = np.zeros(free.shape[1], complex)
    return np.concatenate([zeros, poles[order]]), np.hstack([free, x[:, order]])

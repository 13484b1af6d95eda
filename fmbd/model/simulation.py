"""How a model is simulated."""

from typing import Literal

from pydantic import Field

from fmbd.model.base import Part, Positive


class Baumgarte(Part):
    """Stabilisation of the constraints: Phi'' + 2 delta omega Phi' + omega^2 Phi = 0."""

    delta: Positive = 1.0
    """Damping ratio."""
    omega: Positive = 700.0
    """Natural frequency [rad/s]."""


class Simulation(Part):
    """Method, accuracy and output of a simulation."""

    duration: Positive = 1.0
    """Simulated time [s]."""
    method: Literal["auto", "dop853", "rk45", "rodas5p", "baumgarte"] = "auto"
    """auto: dop853 or rodas5p, whichever gets on with less work. dop853, rk45: explicit, order 8 and 5. rodas5p:
    linearly implicit, order 5, for fine or damped beams and stiff springs. All with projection onto the constraints.
    baumgarte: the null-space scheme of the paper."""
    rtol: Positive = 1e-6
    """Relative tolerance of a step."""
    atol: Positive = Field(default_factory=lambda data: data["rtol"])
    """Absolute tolerance of a step [m, rad, m/s, rad/s]; rtol when left out (lower it for tiny parts)."""
    output_interval: Positive = Field(default_factory=lambda data: data["duration"] / 1000.0)
    """Time between outputs [s]; a thousandth of the duration when left out."""
    max_step: Positive | None = None
    """Longest step [s]."""
    baumgarte: Baumgarte = Baumgarte()
    """Parameters of the Baumgarte scheme."""

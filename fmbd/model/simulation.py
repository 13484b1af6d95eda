"""How a model is simulated."""

from typing import Annotated, Literal

from pydantic import BeforeValidator, Field, model_validator

from fmbd.model.base import Part, Positive, to_number
from fmbd.model.context import reject


class Baumgarte(Part):
    """Stabilisation of the constraints: Phi'' + 2 delta omega Phi' + omega^2 Phi = 0."""

    delta: Positive = 1.0
    """Damping ratio."""
    omega: Positive = 700.0
    """Natural frequency [rad/s]."""


class GeneralizedAlpha(Part):
    """Options of the generalised-alpha method."""

    spectral_radius: Annotated[
        float,
        Field(ge=0, le=1),
        BeforeValidator(to_number, json_schema_input_type=Annotated[float, Field(ge=0, le=1)] | str),
    ] = 0.8
    """What is left, per step, of a vibration that is much faster than the step: from 0 to 1, which damps nothing."""
    step: Positive | None = None
    """Fixed step [s]; when left out, steps follow rtol and atol."""
    formulation: Literal["stabilised", "index3"] = "stabilised"
    """stabilised: constraints hold in place and velocity. index3: in place only, as the method was first published; it
    wants a fixed step and a spectral radius below 1."""

    @model_validator(mode="after")
    def _check(self) -> "GeneralizedAlpha":
        if self.formulation == "index3" and self.spectral_radius == 1.0:
            reject(
                ("spectral_radius",), "must be below 1 for index3, whose reactions would grow without bound"
            )
        return self


class Radau(Part):
    """Options of the Radau IIA methods."""

    stages: Literal[3, 5] = 5
    """Stages of a step: 3 give order 5, 5 give order 9."""


class Simulation(Part):
    """Method, accuracy and output of a simulation."""

    duration: Positive = 1.0
    """Simulated time [s]."""
    method: Literal["auto", "dop853", "rk45", "rodas5p", "radau", "generalized_alpha", "baumgarte"] = "auto"
    """auto: dop853 or radau, whichever gets on with less work. dop853, rk45: explicit, order 8 and 5. rodas5p:
    linearly implicit, order 5, for fine or damped beams and stiff springs. radau: implicit, order 9 or 5, for vibrating
    beams and tight tolerances. All with projection onto the constraints. generalized_alpha: implicit, order 2, with a
    fixed step or an adaptive one. baumgarte: the null-space scheme of the paper."""
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
    generalized_alpha: GeneralizedAlpha = GeneralizedAlpha()
    """Options of the generalised-alpha method."""
    radau: Radau = Radau()
    """Options of the Radau IIA methods."""

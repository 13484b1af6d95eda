"""Materials."""

from typing import Annotated

from pydantic import AfterValidator

from fmbd.model.base import Number, Part, Positive


def _in_range(ratio: float) -> float:
    if not -1.0 < ratio <= 0.5:
        raise ValueError(f"must lie above -1 and up to 0.5, is {ratio:g}")
    return ratio


class Material(Part):
    """A linear elastic material."""

    density: Positive
    """Mass per volume [kg/m^3]."""
    youngs_modulus: Positive
    """Young's modulus [Pa]."""
    poissons_ratio: Annotated[Number, AfterValidator(_in_range)] | None = None
    """Poisson's ratio, for beams with shear."""
    shear_modulus: Positive | None = None
    """Shear modulus [Pa], for beams with shear; if left out, that of an isotropic material of this Poisson's ratio."""

"""Materials."""

from fmbd.model.base import Part, Positive


class Material(Part):
    """A linear elastic material."""

    density: Positive
    """Mass per volume [kg/m^3]."""
    youngs_modulus: Positive
    """Young's modulus [Pa]."""

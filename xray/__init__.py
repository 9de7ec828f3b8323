"""What the beam sees: absorption of a polymer solution."""

if __name__ != "spinline.xray":
    raise ImportError("import spinline.xray, not xray")

from spinline.xray.absorption import contrast, fraction_change, linear_attenuation

__all__ = ["contrast", "fraction_change", "linear_attenuation"]

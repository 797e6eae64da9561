"""The parameters of a BRDF."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypedDict


class ParameterDict(TypedDict):
    """The keyword arguments of a BRDF."""

    k2: float
    kd: float
    k1: float
    n: float
    p: float
    model: str


@dataclass(frozen=True, slots=True)
class Parameters:
    """The parameters of a BRDF. ``evaluate(psi, theta, **parameters.to_dict())`` evaluates it."""

    k2: float
    """Specular weight >= 0, dimensionless."""
    kd: float
    """Diffuse weight >= 0, dimensionless: the hemispherical reflectance of the Lambertian part."""
    k1: float
    """Width of the facet distribution, 1e-8 to 1e8, dimensionless; small is a narrow lobe."""
    n: float
    """Refractive index, 1 to 1e5."""
    p: float = 1.0
    """Exponent of the facet distribution; 1 where the model has none."""
    model: str = "three"
    """The model."""

    def to_dict(self) -> ParameterDict:
        """The keyword arguments of the functions of the package."""
        return {
            "k2": self.k2,
            "kd": self.kd,
            "k1": self.k1,
            "n": self.n,
            "p": self.p,
            "model": self.model,
        }

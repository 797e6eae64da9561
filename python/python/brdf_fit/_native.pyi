"""The compiled part. Arrays are contiguous, of one axis unless another shape is stated."""

from collections.abc import Sequence
from typing import Any, final

from numpy import float64
from numpy.typing import NDArray

__all__ = [
    "BatchPlan",
    "ExportError",
    "FitError",
    "Plan",
    "ReadError",
    "Report",
    "Sampler",
    "Scan",
    "evaluate",
    "evaluate_each",
    "export",
    "fit",
    "hemispherical_reflectance",
    "read",
]

class FitError(ValueError): ...
class ReadError(ValueError): ...
class ExportError(ValueError): ...

@final
class BatchPlan:
    def __new__(
        cls,
        psi: NDArray[float64],
        theta: NDArray[float64],
        phi: NDArray[float64],
        n: float,
        model: str,
    ) -> BatchPlan: ...
    @property
    def free(self) -> list[str]: ...
    def fit_many(
        self,
        scans: NDArray[Any],
        weights: NDArray[Any] | None,
        errors: bool,
        intervals: bool,
        threads: int | None,
    ) -> dict[str, NDArray[Any]]: ...

@final
class Scan:
    def __new__(
        cls,
        columns: Sequence[NDArray[float64]],
        sigma: NDArray[float64] | None,
        wavelength_um: float | None,
        source: str,
    ) -> Scan: ...
    @staticmethod
    def from_json(text: str) -> Scan: ...
    def to_json(self) -> str: ...
    @property
    def source(self) -> str: ...
    @property
    def format(self) -> str: ...
    @property
    def wavelength_um(self) -> float | None: ...
    @property
    def n(self) -> float | None: ...
    @property
    def metadata(self) -> list[tuple[str, str]]: ...
    @property
    def conversions(self) -> list[str]: ...
    @property
    def ignored_columns(self) -> list[str]: ...
    def __len__(self) -> int: ...
    def columns(self) -> list[NDArray[float64]]: ...

@final
class Report:
    @staticmethod
    def from_json(text: str) -> Report: ...
    def to_json(self) -> str: ...
    def text(self) -> str: ...
    def detailed_text(self) -> str: ...
    def html(self) -> str: ...
    @property
    def status(self) -> str: ...
    @property
    def file(self) -> str: ...
    @property
    def model(self) -> str: ...
    @property
    def wavelength_um(self) -> float | None: ...
    @property
    def parameters(self) -> tuple[float, float, float, float, float]: ...
    @property
    def e_percent(self) -> float: ...
    @property
    def readings(self) -> int: ...
    @property
    def estimates(self) -> list[tuple[str, float, float, float]]: ...
    @property
    def warnings(self) -> list[tuple[str, str]]: ...

@final
class Sampler:
    def __new__(cls, parameters: Sequence[float], model: str) -> Sampler: ...
    def sample(self, source: NDArray[float64], u: NDArray[float64]) -> list[NDArray[float64]]: ...
    def pdf(self, source: NDArray[float64], view: NDArray[float64]) -> NDArray[float64]: ...
    def specular_weights(self) -> NDArray[float64]: ...

@final
class Plan:
    def __new__(
        cls,
        parameters: Sequence[float],
        model: str,
        tolerance: float,
        psi_max: float,
        theta_max: float,
        evaluations: float,
        cosines: bool,
    ) -> Plan: ...
    @property
    def name(self) -> str: ...
    @property
    def max_error(self) -> float | None: ...
    def evaluate(self, points: Sequence[NDArray[Any]], threads: int | None) -> NDArray[Any]: ...

def evaluate(
    angles: Sequence[NDArray[float64]],
    parameters: Sequence[float],
    model: str,
) -> NDArray[float64]: ...
def evaluate_each(
    angles: Sequence[NDArray[float64]],
    parameters: Sequence[NDArray[float64]],
    model: str,
) -> NDArray[float64]: ...
def hemispherical_reflectance(
    psi: NDArray[float64], parameters: Sequence[float], model: str, tolerance: float
) -> NDArray[float64]: ...
def fit(scan: Scan, options: dict[str, Any], depth: str, threads: int | None) -> Report: ...
def read(
    path: str,
    format: str | None,
    theta_positive: str | None,
    phi_zero: str | None,
    sample: int | None,
    columns: Sequence[tuple[str, str]],
    declarations: Sequence[tuple[str, str]],
) -> list[Scan]: ...
def export(
    fits: Sequence[Report],
    format: str,
    name: str,
    tolerance: float | None,
    grid: str,
    rgb_um: tuple[float, float, float] | None,
) -> tuple[bytes, tuple[str, bytes] | None, str | None]: ...

"""Fits of many scans chunk by chunk, with Dask: on all cores, or on the workers of a cluster.

The fit of a chunk is a function of the chunk and the angles alone, and has the same bits on every machine of one kind
whatever the chunks are. A scheduler may therefore compute a chunk again where a worker was lost. Each worker fits with
one thread: the chunks are the parallelism. Chunks of 100,000 scans or more make the share of the scheduler small; where
the scans fit into the memory of one machine, :meth:`brdf_fit.Geometry.fit_many` is as fast or faster.

Needs ``dask[array]``, and xarray for its arrays.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, overload

import dask.array as da
import numpy as np
from numpy.typing import NDArray

from ._batch import COLUMNS, STDERR_COLUMNS, WEIGHTS_AND_INTERVALS, Geometry, interval_columns

if TYPE_CHECKING:
    import xarray

INTEGERS = {"readings": np.uint32, "status": np.uint8}


@overload
def fit_many(
    geometry: Geometry,
    scans: xarray.DataArray,
    *,
    dim: str = ...,
    weights: da.Array | xarray.DataArray | NDArray[Any] | None = ...,
    errors: bool = ...,
    intervals: bool = ...,
) -> xarray.Dataset: ...
@overload
def fit_many(
    geometry: Geometry,
    scans: da.Array,
    *,
    dim: str = ...,
    weights: da.Array | xarray.DataArray | NDArray[Any] | None = ...,
    errors: bool = ...,
    intervals: bool = ...,
) -> dict[str, da.Array]: ...
def fit_many(
    geometry: Geometry,
    scans: da.Array | xarray.DataArray,
    *,
    dim: str = "reading",
    weights: da.Array | xarray.DataArray | NDArray[Any] | None = None,
    errors: bool = False,
    intervals: bool = False,
) -> dict[str, da.Array] | xarray.Dataset:
    """Fits scans lazily, chunk by chunk.

    Compute the columns together, as ``dask.compute(columns)`` or ``dataset.to_zarr(path)``: each chunk is then
    fitted once.

    Args:
        geometry: The angles, one for each reading.
        scans: f_r in 1/sr: a Dask array (..., readings), or a DataArray of xarray with the dimension ``dim``. NaN
            is a reading that was not taken. Chunks that divide the readings of a scan are joined.
        dim: The dimension of the readings of a DataArray.
        weights: Weights of the readings of at least 0, shape (readings,) or that of the scans.
        errors: Whether to compute standard errors for noise of constant size.
        intervals: Whether to compute the standard errors and the intervals of 95 % of each free parameter by the
            full inference of single scans: the columns ``k1_standard_error``, ``k1_from``, ``k1_to`` and so on.
            It takes a few hundred times as long as the fits, and needs scans without weights.

    Returns:
        For a Dask array, a dictionary of Dask arrays (...): the columns of :class:`brdf_fit.BatchFit`. For a
        DataArray, a Dataset of them with its other dimensions and coordinates.

    Raises:
        ValueError: The number of readings is not that of the geometry, ``dim`` is no dimension, or weights and
            intervals are both given. Negative weights are found when the columns are computed.
    """
    if intervals and weights is not None:
        raise ValueError(WEIGHTS_AND_INTERVALS)
    names = COLUMNS + (STDERR_COLUMNS if errors else ())
    if intervals:
        names += tuple(column for name in geometry._plan.free for column in interval_columns(name))
    if isinstance(scans, da.Array):
        return _fit_array(geometry, scans, weights, names)
    if dim not in scans.dims:
        raise ValueError(f"the scans have the dimensions {scans.dims}: expected one of them to be {dim!r}")
    return _fit_data_array(geometry, scans, dim, weights, names)


def _fit_data_array(
    geometry: Geometry, scans: xarray.DataArray, dim: str, weights: Any, names: tuple[str, ...]
) -> xarray.Dataset:
    import xarray

    ordered = scans.transpose(..., dim)
    if isinstance(weights, xarray.DataArray):
        same = set(weights.dims) == {dim}
        weights = weights.data if same else weights.broadcast_like(ordered).transpose(*ordered.dims).data
    columns = _fit_array(geometry, da.asarray(ordered.data), weights, names)
    kept = {name: coord for name, coord in ordered.coords.items() if dim not in coord.dims}
    return xarray.Dataset(
        {name: (ordered.dims[:-1], column) for name, column in columns.items()}, coords=kept
    )


def _fit_array(
    geometry: Geometry, scans: da.Array, weights: Any, names: tuple[str, ...]
) -> dict[str, da.Array]:
    if scans.ndim == 0 or scans.shape[-1] != len(geometry):
        raise ValueError(
            f"the scans have the shape {scans.shape}: expected (..., {len(geometry)}), as the geometry has angles"
        )
    scans = scans.rechunk({scans.ndim - 1: -1})
    blocks = [scans]
    if weights is not None and np.ndim(weights) == 1:
        weights = np.asarray(weights)
    elif weights is not None:
        blocks.append(da.broadcast_to(da.asarray(weights), scans.shape).rechunk(scans.chunks))
        weights = None
    table = da.map_blocks(
        _columns,
        *blocks,
        geometry=geometry,
        weights=weights,
        names=names,
        dtype=np.float64,
        chunks=(*scans.chunks[:-1], (len(names),)),
        # Without it, the function would be called with an empty block.
        meta=np.empty((0,) * scans.ndim),
    )
    return {name: table[..., i].astype(INTEGERS.get(name, np.float64)) for i, name in enumerate(names)}


def _columns(
    scans: NDArray[Any],
    own_weights: NDArray[Any] | None = None,
    *,
    geometry: Geometry,
    weights: NDArray[Any] | None,
    names: tuple[str, ...],
) -> NDArray[np.float64]:
    """The fits of a block, with the columns on the last axis."""
    given = weights if own_weights is None else own_weights
    many = geometry.fit_many(
        scans,
        weights=given,
        errors=not set(STDERR_COLUMNS).isdisjoint(names),
        intervals=any(name.endswith("_standard_error") for name in names),
        threads=1,
    )
    columns = many.columns()
    return np.stack([columns[name] for name in names], axis=-1, dtype=np.float64)

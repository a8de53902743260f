"""Volumes larger than memory: what is seen is read, when it is seen."""

from __future__ import annotations

import os
import threading
from typing import Any, Sequence

import numpy as np

from . import _arrays, _chiaro, _progress
from .volume import Volume

#: voxels along the longest axis of the level from which statistics are found, as the tool's `info` does
SMALL = 256
#: bytes of what is read at once from an array that does not say how it is stored
PART = 1 << 20
#: bytes of a chunk of which only few can be kept
LARGE = 64 << 20
_UNITS = {"K": 1 << 10, "M": 1 << 20, "G": 1 << 30, "T": 1 << 40}


def _bytes_of(memory: Any) -> float:
    """0 for None: half of what is free."""
    if memory is None:
        return 0
    text = str(memory).strip().upper()
    try:
        size = float(text[:-1]) * _UNITS[text[-1]] if text[-1:] in _UNITS else float(text)
    except ValueError:
        size = 0
    if not (16 << 20) <= size < 1 << 50:
        raise ValueError(f"memory={memory!r}: must be a number of bytes or a size such as '4G', 16M at least")
    return size


def _chunk_of(array: Any) -> tuple[int, ...]:
    """What of an array (z, y, x) is read at the least cost: its chunks (dask, zarr, h5py), else rows of a slice."""
    chunk = getattr(array, "chunksize", None) or getattr(array, "chunks", None)
    if chunk is not None and all(isinstance(n, (int, np.integer)) for n in chunk):
        return tuple(min(int(n), int(size)) for n, size in zip(chunk, array.shape))
    rows = PART // (int(array.shape[2]) * int(array.dtype.itemsize))
    return 1, max(1, min(rows, int(array.shape[1]))), int(array.shape[2])


def _checked(levels: Sequence[Any]) -> None:
    if not levels:
        raise ValueError("levels: there must be one array at least")
    for array in levels:
        if isinstance(array, np.ma.MaskedArray):
            raise TypeError("a masked array: fill it first, as in array.filled(0)")
        if not hasattr(array, "shape") or not hasattr(getattr(array, "dtype", None), "itemsize"):
            raise TypeError(f"a volume of {type(array).__module__}.{type(array).__name__}: give an array, a list of ever smaller ones, or a path")
        _arrays._refuse_type(np.dtype(array.dtype))
        _arrays._refuse_shape(tuple(array.shape), False)
    for finer, coarser in zip(levels, levels[1:]):
        if coarser.dtype != levels[0].dtype:
            raise TypeError(f"levels of {levels[0].dtype} and {coarser.dtype}: must be of one type")
        if any(b > a for a, b in zip(finer.shape, coarser.shape)) or coarser.shape == finer.shape:
            raise ValueError(f"levels of shape {tuple(finer.shape)} and {tuple(coarser.shape)}: each must be smaller than the one before")


class LazyVolume(Volume):
    """A volume that is read by bricks; made by ``Volume.lazy``. It has no ``array``: ``level(n)`` gives one of its levels as a
    volume. Statistics, window and histogram are those of a level of at most 256 voxels along an axis."""

    def __init__(
        self,
        source: Any,
        spacing: float | Sequence[float] = 1.0,
        origin: Sequence[float] = (0.0, 0.0, 0.0),
        direction: Any = None,
        frame: str | None = None,
        name: str = "array",
        *,
        affine: Any = None,
        memory: Any = None,
        finest_level: int = 0,
        exact: bool = False,
    ) -> None:
        self._memory = _bytes_of(memory)
        self._exact = bool(exact)
        self._small: Volume | None = None
        self._first = None
        self._channels = []
        self._transposed = False
        if isinstance(source, (str, os.PathLike)):
            if affine is not None or direction is not None or frame is not None or spacing != 1.0 or tuple(origin) != (0.0, 0.0, 0.0):
                raise ValueError(f"{os.fspath(source)}: a file says where it lies")
            self._source = self._of_file(os.fspath(source))
        else:
            self._source = self._of_arrays(source, str(name), (spacing, origin, direction, frame, affine))
        self._header = self._source.header
        self._notes = [*self._header.notes, *self._notes]
        self._version = 0
        self._statistics = None
        self._finest = int(finest_level)
        if not 0 <= self._finest < len(self.levels):
            raise ValueError(f"finest_level={finest_level}: {self.name} has levels 0 to {len(self.levels) - 1}")

    def _of_file(self, name: str) -> Any:
        self._notes = []
        with _progress.reporting(None) as report:
            source = _chiaro.source_of_file(name, _chiaro.Scene(name), report)
        if source is None:
            raise ValueError(f"{name}: its format is read as a whole: chiaro.read(), or `chiaro convert` makes OME-Zarr of it")
        return source

    def _of_arrays(self, source: Any, name: str, place: tuple[Any, ...]) -> Any:
        levels = list(source) if isinstance(source, (list, tuple)) else [source]
        _checked(levels)
        dtype = np.dtype(levels[0].dtype)
        stored = np.dtype(_arrays._CONVERTED.get(dtype.name, dtype.newbyteorder("=").name))
        one_at_a_time = threading.Lock()  # not every array may be read by several threads

        def read(level: int, first: Sequence[int], end: Sequence[int]) -> np.ndarray[Any, Any]:
            box = tuple(slice(a, b) for a, b in zip(first[::-1], end[::-1]))
            with one_at_a_time:
                part = np.asarray(levels[level][box])
            return np.ascontiguousarray(part, dtype=stored)

        shapes = [(tuple(int(n) for n in array.shape[::-1]), _chunk_of(array)[::-1]) for array in levels]
        self._take(_chiaro.header(stored.name, shapes[0][0]).told(name, "array", "", 1.0, 0.0), [], *place)
        largest = max(int(np.prod(chunk)) for _, chunk in shapes) * stored.itemsize
        if largest > LARGE:
            self._notes.append(f"its chunks have {largest / 1e6:.0f} MB each, and one is decoded for a single brick: chunks of 64 to 256 voxels a side are read sooner")
        return _chiaro.source_of_arrays(self._header, shapes, read)

    # --- levels
    @property
    def levels(self) -> list[tuple[int, int, int]]:
        """Voxels along z, y, x of each level, the finest first."""
        return [(z, y, x) for x, y, z in self._source.levels]

    def level(self, number: int, *, progress: Any = None) -> Volume:
        """A level as a volume in memory, all of which is read now. Where it lies is kept."""
        if not 0 <= int(number) < len(self.levels):
            raise ValueError(f"level({number}): {self.name} has levels 0 to {len(self.levels) - 1}")
        with _progress.reporting(progress) as report:
            return Volume._of_native(self._source.read_level(int(number), report))

    def _small_level(self) -> Volume:
        if self._small is None:
            fitting = [i for i, shape in enumerate(self.levels) if max(shape) <= SMALL]
            self._small = self.level(fitting[0] if fitting else len(self.levels) - 1)
        return self._small

    # --- as a volume
    @property
    def _native(self) -> Any:
        raise ValueError(f"{self.name} is read by bricks, as pictures need them: take level(n) of it, n from 0 to {len(self.levels) - 1}")

    @_native.setter
    def _native(self, native: Any) -> None:
        self._header = native

    @property
    def _head(self) -> Any:
        return self._header

    @property
    def shape(self) -> tuple[int, ...]:
        """Voxels along z, y, x of the finest level."""
        return self.levels[0]

    @property
    def statistics(self) -> dict[str, Any]:
        """As a Volume's, of a level of at most 256 voxels along an axis."""
        return self._small_level().statistics

    def histogram(self) -> tuple[np.ndarray[Any, Any], np.ndarray[Any, Any]]:
        """As a Volume's, of a level of at most 256 voxels along an axis."""
        return self._small_level().histogram()

    def changed(self) -> None:
        """Raises ValueError: what was read is kept."""
        raise ValueError(f"{self.name} keeps what it has read: make another with Volume.lazy")

    def _view_of(self) -> tuple[Any, ...]:
        return None, self._source, self._memory, self._finest, self._exact

    def _show_in(self, session: Any, report: Any) -> None:
        session.show_source(self._source, self._memory, self._finest, self._exact, report)

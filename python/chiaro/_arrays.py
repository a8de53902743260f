"""Which arrays are volumes: what is borrowed, what is converted, what is refused."""

from __future__ import annotations

import logging
import os
from typing import Any

import numpy as np

log = logging.getLogger("chiaro")

#: numpy types that are stored as they are
STORED = ("uint8", "int8", "uint16", "int16", "uint32", "int32", "uint64", "int64", "float32", "float64")
_CONVERTED = {"bool": "uint8", "float16": "float32"}


def _refuse_type(dtype: np.dtype[Any]) -> None:
    name = dtype.name
    if dtype.fields is not None:
        raise TypeError(f"an array with fields {dtype.names}: pick one, as in array['{dtype.names[0]}']")  # type: ignore[index]
    if dtype.kind == "c":
        raise TypeError(f"an array of {name}: complex numbers have no order; take abs(array) or array.real")
    if dtype.kind == "O":
        raise TypeError("an array of Python objects: convert it first, as in array.astype('float32')")
    if dtype.newbyteorder("=").name not in STORED and name not in _CONVERTED:
        raise TypeError(f"an array of {name}: must be bool, float16 or one of {', '.join(STORED)}")


def _refuse_shape(shape: tuple[int, ...], channels: bool) -> None:
    if channels and len(shape) != 4:
        raise ValueError(f"an array of shape {shape}: with channels it has four axes, c, z, y, x (of colours also z, y, x, c)")
    if not channels and len(shape) != 3:
        hint = "; give one moment of it, as in array[0], or channels=True" if len(shape) == 4 else ""
        raise ValueError(f"an array of shape {shape}: a volume has three axes, z, y, x{hint}")
    if 0 in shape:
        raise ValueError(f"an array of shape {shape}: it has no voxels")
    if max(shape) > 65535:
        raise ValueError(f"an array of shape {shape}: an axis has 1 to 65535 voxels")


def available_bytes() -> int:
    """Memory that can be had without swapping."""
    try:
        with open("/proc/meminfo", encoding="ascii") as lines:
            for line in lines:
                if line.startswith("MemAvailable:"):
                    return int(line.split()[1]) * 1024
    except OSError:
        pass
    return os.sysconf("SC_AVPHYS_PAGES") * os.sysconf("SC_PAGE_SIZE")


def _in_memory(source: Any) -> np.ndarray[Any, Any]:
    """The whole of an array that is read piece by piece (dask, zarr, h5py), where it fits."""
    if isinstance(source, np.ndarray):
        return source
    shape, dtype = getattr(source, "shape", None), getattr(source, "dtype", None)
    if shape is not None and dtype is not None and hasattr(dtype, "itemsize"):
        size = int(np.prod([int(n) for n in shape])) * int(dtype.itemsize)
        if size > available_bytes() * 0.8:
            raise ValueError(
                f"an array of {size / 1e9:.1f} GB does not fit the {available_bytes() / 1e9:.1f} GB of memory that are free: "
                "give a part of it, or every second voxel, as in array[::2, ::2, ::2]"
            )
        if not hasattr(source, "__array__"):
            return np.asarray(source[...])
    return np.asarray(source)


def stored(source: Any, channels: bool = False) -> tuple[np.ndarray[Any, Any], list[str]]:
    """The array as it will be shown, the same memory where that can be, and what was done to it, a sentence each.

    The result is in C order, or the transpose of such an array.
    """
    if isinstance(source, np.ma.MaskedArray):
        raise TypeError("a masked array: fill it first, as in array.filled(0)")
    array = _in_memory(source)
    if isinstance(array, np.ma.MaskedArray):
        raise TypeError("a masked array: fill it first, as in array.filled(0)")
    _refuse_type(array.dtype)
    _refuse_shape(array.shape, channels)
    notes = []
    if array.dtype.name in _CONVERTED:
        to = _CONVERTED[array.dtype.name]
        notes.append(f"an array of {array.dtype.name} is copied as {to}")
        array = array.astype(to)
    elif not array.dtype.isnative:
        notes.append("a big-endian array is copied in the machine's byte order")
        array = array.astype(array.dtype.newbyteorder("="))
    if not array.flags.c_contiguous and not array.flags.f_contiguous:
        notes.append("an array with gaps between its voxels is copied")
        array = np.ascontiguousarray(array)
    if not array.flags.aligned:
        notes.append("an array that does not begin at an address for its type is copied")
        array = array.copy()
    for note in notes:
        log.info(note)
    return array, notes

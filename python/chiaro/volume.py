"""Volumes: voxels on a grid in the world."""

from __future__ import annotations

import logging
import os
from typing import TYPE_CHECKING, Any, Callable, Iterator, Sequence

import numpy as np

from . import _arrays, _channels, _chiaro, _progress

if TYPE_CHECKING:
    from .lazy import LazyVolume

log = logging.getLogger("chiaro")

#: index axes x, y, z and their place in (z, y, x)
_FLIP = np.diag([-1.0, -1.0, 1.0, 1.0])


def _three(values: Any, what: str) -> tuple[float, float, float]:
    numbers = [float(v) for v in np.atleast_1d(np.asarray(values, dtype=float))]
    if len(numbers) == 1:
        numbers *= 3
    if len(numbers) != 3 or not np.isfinite(numbers).all():
        raise ValueError(f"{what}={values!r}: must be three finite numbers")
    return numbers[0], numbers[1], numbers[2]


class Volume:
    """Voxels, and where they lie.

    ``array``
        (z, y, x), any integer or float type; with ``time`` (t, z, y, x). Its memory is borrowed where it is in C or Fortran order: nothing is
        copied, changed or freed, and the array lives as long as the volume. Else it is copied, and ``notes`` say why.
    ``spacing``
        distance of the voxels in mm along z, y, x (one number: of all three).
    ``origin``
        where the first voxel is in the world, in mm: x, y, z.
    ``direction``
        3 × 3, its columns the world's directions of the index axes x, y, z.
    ``frame``
        'RAS', 'LPS' or None: what the world's axes are.
    ``affine``
        in the place of spacing, origin, direction and frame: 4 × 4, from (x, y, z) index to RAS mm, as nibabel has it.
    ``name``
        what messages and scene files call it.
    ``channels``
        of an array (c, z, y, x) with up to eight values a voxel, shown together as one medium: True, or for each channel its
        name, its gain, or a dict of name, color (a CSS name or three numbers), gain, show and transfer. 'rgb': three or four
        values, (c, z, y, x) or (z, y, x, c), are the voxels' own colours and alpha. The array is copied.
    ``time``
        which moment of an array of several, from 0. Its pictures have the range, the look and the camera of moment 0.

    Raises TypeError for types, ValueError for shapes and numbers that are none of these. Costs nothing to speak of;
    the first picture reads the array once.
    """

    def __init__(
        self,
        array: Any,
        spacing: float | Sequence[float] = 1.0,
        origin: Sequence[float] = (0.0, 0.0, 0.0),
        direction: Any = None,
        frame: str | None = None,
        name: str = "array",
        *,
        affine: Any = None,
        time: int | None = None,
        channels: Any = None,
    ) -> None:
        self._first: Callable[[], Volume] | None = None
        self._channels: list[dict[str, Any]] = []
        if channels is not None:
            self._take(*self._of_channels(array, channels, time, str(name)), spacing, origin, direction, frame, affine)
            return
        moments = 1 if time is None else _moments_in(array, time)
        if time:
            self._first = lambda: Volume(array, spacing, origin, direction, frame, name, affine=affine, time=0)
        held, notes = _arrays.stored(array if time is None else array[time])
        self._transposed = not held.flags.c_contiguous
        base = held.T if self._transposed else held
        dimensions = tuple(int(n) for n in base.shape[::-1])
        native = _chiaro.borrow(base, held.dtype.name, dimensions, 1).told(str(name), "array", "", 1.0, 0.0)
        self._take(native.at_moment(time or 0, moments), notes, spacing, origin, direction, frame, affine)

    def _of_channels(self, array: Any, channels: Any, time: int | None, name: str) -> tuple[Any, list[str]]:
        if time is not None:
            raise ValueError(f"time={time}: several channels are shown at one moment; give an array of that one")
        held, notes = _arrays.stored(array, channels=True)
        own = isinstance(channels, str)
        if own and channels != "rgb":
            raise ValueError(f"channels={channels!r}: must be True, 'rgb' or a list")
        last = own and held.shape[3] in (3, 4)
        count = held.shape[3 if last else 0]
        if own and count not in (3, 4):
            raise ValueError(f"an array of shape {held.shape}: colours are three or four values, (c, z, y, x) or (z, y, x, c)")
        if count > _channels.MOST:
            raise ValueError(f"an array of shape {held.shape}: at most {_channels.MOST} channels can be shown")
        if not own and channels is not True:
            self._channels = _channels.rows_of(channels, count)
        self._transposed = False
        base = np.ascontiguousarray(held if last else np.moveaxis(held, 0, -1))
        dimensions = tuple(int(n) for n in base.shape[2::-1])
        native = _chiaro.borrow(base, held.dtype.name, dimensions, count).told(name, "array", "", 1.0, 0.0)
        infos = [(str(row.get("name", "")), _channels.color_text(row.get("color"))) for row in self._channels]
        return native.with_channels(own, infos), notes

    def _take(self, native: Any, notes: list[str], spacing: Any, origin: Any, direction: Any, frame: str | None, affine: Any) -> None:
        if affine is not None:
            place = _place_of_affine(affine)
        else:
            z, y, x = _three(spacing, "spacing")
            columns = np.eye(3) if direction is None else np.asarray(direction, dtype=float)
            place = (x, y, z), _three(origin, "origin"), columns, _frame(frame)
        self._native = self._placed(native, *place)
        self._notes = list(notes)
        self._version = 0
        self._statistics: dict[str, Any] | None = None

    def _placed(self, native: Any, spacing: Any, origin: Any, columns: Any, frame: str) -> Any:
        if columns.shape != (3, 3):
            raise ValueError(f"direction of shape {columns.shape}: must be 3 × 3")
        if not all(0 < s < np.inf for s in spacing):
            raise ValueError(f"spacing {tuple(spacing)} mm: every distance must be above 0")
        lengths = np.linalg.norm(columns, axis=0)
        if not np.isfinite(columns).all() or abs(np.linalg.det(columns)) < 1e-9 * float(np.prod(lengths)) or not (lengths > 0).all():
            raise ValueError("direction: its three columns must point in different directions")
        axes = [tuple(float(v) for v in columns[:, a] / lengths[a]) for a in range(3)]
        spacing = [float(s) for s in spacing]
        if self._transposed:
            axes, spacing = axes[::-1], spacing[::-1]
        return native.placed(tuple(spacing), tuple(origin), axes, frame)

    @classmethod
    def _of_native(cls, native: Any) -> "Volume":
        self = cls.__new__(cls)
        self._native = native
        self._transposed = False
        self._first = None
        self._channels = []
        self._notes = list(native.notes)
        self._version = 0
        self._statistics = None
        return self

    @staticmethod
    def of(source: Any, **more: Any) -> "Volume":
        """The volume of something that other packages hold: a nibabel image, a SimpleITK or itk image, an xarray
        DataArray, vtkImageData or a PyVista grid, a list of pydicom datasets, a path, an array of numpy, dask, zarr or
        h5py, or a volume. Where it lies is kept. ``more`` as for Volume, for what has no place of its own."""
        from . import _of

        return _of.volume_of(source, **more)

    @staticmethod
    def lazy(source: Any, *place: Any, **more: Any) -> "LazyVolume":
        """A volume that need not fit in memory: what pictures show is read when they show it, as fine as their pixels are.

        ``source``
            an array (z, y, x) of dask, zarr, h5py, numpy.memmap or whatever has ``shape``, ``dtype`` and slicing, of integers or
            floats; a list of ever smaller arrays of the same volume, finest first; or the name of a file, folder, store or
            sample that is read by bricks (docs/any-size.md). Without smaller arrays coarser levels are every second voxel and
            so on: the first picture then reads all chunks once.
        ``spacing``, ``origin``, ``direction``, ``frame``, ``name``, ``affine``
            as for Volume, of arrays.
        ``memory``
            bytes, or a size such as '4G', that pictures may take, light included; None: half of what is free. What fits as a
            whole is read as a whole.
        ``finest_level``
            no finer level is drawn.
        ``exact``
            all voxels are read once for the range of values and for what is empty; else a coarse level tells.

        Raises TypeError and ValueError as Volume, InputError for files. A part that cannot be read is a note, and a coarser level in
        the picture. Sessions tell in ``paging`` which level was drawn."""
        from .lazy import LazyVolume

        return LazyVolume(source, *place, **more)

    # --- the voxels
    @property
    def _head(self) -> Any:
        """What is known without the voxels."""
        return self._native

    def _show_in(self, session: Any, report: Any) -> None:
        session.show(self._native, report)

    def _view_of(self) -> tuple[Any, ...]:
        return self._native, None, 0, 0, False

    @property
    def array(self) -> np.ndarray[Any, Any]:
        """The stored numbers, (z, y, x), the same memory, not to be written through this view."""
        view = np.asarray(self._native)
        view.flags.writeable = False
        return view.T if self._transposed else view  # of channels (z, y, x, c)

    def to_numpy(self) -> np.ndarray[Any, Any]:
        """A copy of the values, after slope and intercept (HU for CT); float32 where those are not 1 and 0."""
        if self.slope == 1 and self.intercept == 0:
            return self.array.copy()
        return (self.array * self.slope + self.intercept).astype(np.float32)

    def __array__(self, dtype: Any = None, copy: Any = None) -> np.ndarray[Any, Any]:
        return np.array(self.array, dtype=dtype) if copy or dtype is not None else self.array

    def changed(self) -> None:
        """To be called after the borrowed array was written to: sessions read it again for their next picture."""
        self._version += 1
        self._statistics = None

    @property
    def shape(self) -> tuple[int, ...]:
        """Voxels along z, y, x."""
        return tuple(self.array.shape)

    @property
    def dtype(self) -> np.dtype[Any]:
        return np.dtype(str(self._head.type))

    @property
    def slope(self) -> float:
        """value = slope × stored number + intercept"""
        return float(self._head.slope)

    @property
    def intercept(self) -> float:
        return float(self._head.intercept)

    # --- its place
    @property
    def spacing(self) -> tuple[float, float, float]:
        """Distance of the voxels in mm along z, y, x."""
        s = self._head.spacing
        return (s[0], s[1], s[2]) if self._transposed else (s[2], s[1], s[0])

    @property
    def origin(self) -> tuple[float, float, float]:
        """World x, y, z of the first voxel, mm."""
        o = self._head.origin
        return (o[0], o[1], o[2])

    @property
    def direction(self) -> np.ndarray[Any, Any]:
        """3 × 3, its columns the world's directions of the index axes x, y, z."""
        columns = np.array(self._head.direction).T
        return columns[:, ::-1].copy() if self._transposed else columns

    @property
    def frame(self) -> str | None:
        """'RAS', 'LPS' or None."""
        return self._head.frame or None

    @property
    def affine(self) -> np.ndarray[Any, Any]:
        """4 × 4, from (x, y, z) index to RAS mm, as nibabel has it; without a frame to the world as it is."""
        matrix = np.eye(4)
        matrix[:3, :3] = self.direction * np.array(self.spacing[::-1])
        matrix[:3, 3] = self.origin
        return _FLIP @ matrix if self.frame == "LPS" else matrix

    # --- what it is
    @property
    def name(self) -> str:
        return str(self._head.source)

    @property
    def format(self) -> str:
        return str(self._head.format)

    @property
    def modality(self) -> str:
        """'CT', 'MR', ... where the file says so, else ''."""
        return str(self._head.modality)

    @property
    def moments(self) -> dict[str, Any]:
        """Of what changes with time: count, shown (which of them this is, from 0), times and their unit."""
        return dict(self._head.moments)

    @property
    def channels(self) -> list[dict[str, Any]]:
        """Name and color (sRGB, or None) of each of several values a voxel."""
        told = list(self._head.channels) or [("", None)] * int(self._head.components)
        return [{"name": name, "color": color} for name, color in told] if len(told) > 1 else []

    @property
    def has_own_colors(self) -> bool:
        """Whether the values of a voxel are its colour."""
        return bool(self._head.has_own_colors)

    @property
    def notes(self) -> list[str]:
        """What one should know, a sentence each: slices left out, voxels copied."""
        return list(self._notes)

    @property
    def statistics(self) -> dict[str, Any]:
        """min, max, p1, p50, p99, p999 (percentiles), noise (over the range from p1 to p999), nonfinite; read once."""
        if self._statistics is None:
            found = self._native.statistics()
            found["histogram"] = np.asarray(found["histogram"])
            self._statistics = found
        return {key: value for key, value in self._statistics.items() if key != "histogram"}

    @property
    def window(self) -> tuple[float, float]:
        """Centre and width that show nearly all values: from the first to the 99.9th percentile."""
        s = self.statistics
        return (s["p1"] + s["p999"]) / 2, max(s["p999"] - s["p1"], np.finfo(float).tiny)

    def histogram(self) -> tuple[np.ndarray[Any, Any], np.ndarray[Any, Any]]:
        """Counts of 256 equal bins from the least to the greatest value, and their 257 edges."""
        s = self.statistics
        assert self._statistics is not None
        return self._statistics["histogram"].copy(), np.linspace(s["min"], s["max"], 257)

    def __repr__(self) -> str:
        z, y, x = self.shape[:3]
        mm = " × ".join(f"{s:g}" for s in self.spacing)
        frame = f", {self.frame}" if self.frame else ""
        return f"<chiaro.Volume {self.name!r}: {z} × {y} × {x} {self.dtype.name}, {mm} mm{frame}>"

    def _repr_html_(self) -> str:
        from . import _html

        return _html.volume(self)


def _moments_in(array: Any, time: int) -> int:
    shape: tuple[int, ...] = tuple(getattr(array, "shape", ()))
    if len(shape) != 4:
        raise ValueError(f"time={time}: the array must be (t, z, y, x), not of shape {shape}")
    if not 0 <= time < shape[0]:
        raise ValueError(f"time={time}: the array has moments 0 to {shape[0] - 1}")
    return int(shape[0])


def _frame(frame: str | None) -> str:
    if frame not in (None, "RAS", "LPS"):
        raise ValueError(f"frame={frame!r}: must be 'RAS', 'LPS' or None")
    return frame or ""


def _place_of_affine(affine: Any) -> tuple[Any, Any, np.ndarray[Any, Any], str]:
    matrix = np.asarray(affine, dtype=float)
    if matrix.shape != (4, 4) or not np.isfinite(matrix).all() or not np.allclose(matrix[3], [0, 0, 0, 1]):
        raise ValueError("affine: must be 4 × 4 finite numbers with 0, 0, 0, 1 in the last row")
    columns = matrix[:3, :3]
    spacing = np.linalg.norm(columns, axis=0)
    if not (spacing > 0).all():
        raise ValueError("affine: every index axis needs a length above 0")
    return tuple(spacing), tuple(float(v) for v in matrix[:3, 3]), columns / spacing, "RAS"


def read(path: str | os.PathLike[str], *, progress: Any = None, **settings: Any) -> Volume:
    """The volume of a file, a folder of DICOM slices, or ``sample:NAME[:SIZE]``: all that the tool reads.

    ``settings``: raw_size, raw_type, raw_spacing, raw_endian, raw_offset, series, rescale, time. Files are opened by a helper
    program, never in this process. Raises InputError with a sentence about the file. What one should know of it goes to
    ``logging.getLogger("chiaro")`` and to ``volume.notes``.
    """
    from .scene import Scene

    name = os.fspath(path)
    volume = _read(name, Scene(**settings), progress)
    for note in volume.notes:
        log.warning("%s: %s", name, note)
    return volume


def _read(name: str, scene: Any, progress: Any = None) -> Volume:
    with _progress.reporting(progress) as report:
        volume = Volume._of_native(_chiaro.read(name, scene._native, report))
    if volume.moments["shown"] > 0:
        volume._first = lambda: _read(name, scene.with_(time=0))
    return volume


def write(volume: Any, path: str | os.PathLike[str], *, encoding: str = "raw", progress: Any = None) -> None:
    """Writes NRRD with all that is known of the volume, whole or not at all; ``encoding`` is 'raw' or 'gzip'.

    Raises UsageError for another ending than .nrrd, OutputError where the file cannot be written.
    """
    from .errors import error_of

    name = os.fspath(path)
    if not name.endswith(".nrrd"):
        raise error_of(2, f"{name}: volumes are written as .nrrd")
    with _progress.reporting(progress) as report:
        _chiaro.write(Volume.of(volume)._native, name, encoding, {}, report)


def sample(name: str, size: int = 0) -> Volume:
    """A generated volume: an exact function of position, ``size`` voxels a side (0: its own). See ``samples()``."""
    with _progress.reporting(None) as report:
        return Volume._of_native(_chiaro.make_sample(name, size, report))


def samples() -> Iterator[tuple[str, str]]:
    """Name and sentence of each sample."""
    for name, sentence, _ in _chiaro.list_samples():
        yield name, sentence

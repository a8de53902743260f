"""Transfer functions: what a value looks like."""

from __future__ import annotations

import os
from typing import Any, Iterable, Sequence

import numpy as np

from . import _chiaro


class TransferFunction:
    """Colour and opacity by value, piecewise linear between points, constant outside. It never changes.

    ``source`` is one of

    * the name of a preset or colour map (``list_presets()``; matplotlib's names too), or a file of the tool's
      (``FILE#FUNCTION`` picks one of several),
    * a colormap of matplotlib,
    * points: rows of (value, r, g, b, opacity), colours sRGB in 0 to 1; or (value, colour, opacity) with a CSS name.

    ``volume`` or ``range`` = (low, high) is what presets and colour maps are stretched over; without them a name stays a
    name until a picture asks. ``opacity`` of a colormap: (at its low end, at its high end). ``opacity_unit``: the length
    that opacities belong to, in units of the smallest voxel size, or ``opacity_unit_mm``.
    """

    _native: Any
    _source: str | None

    def __init__(
        self,
        source: Any,
        volume: Any = None,
        *,
        range: Sequence[float] | None = None,  # noqa: A002
        opacity: Sequence[float] = (0.0, 1.0),
        opacity_unit: float = 1.0,
        opacity_unit_mm: float | None = None,
        linear: bool = False,
        name: str = "",
    ) -> None:
        self._source = None
        self._native = None
        unit = (opacity_unit if opacity_unit_mm is None else opacity_unit_mm, opacity_unit_mm is not None)
        if isinstance(source, (str, os.PathLike)):
            self._load(os.fspath(source), volume, range, opacity)
        elif callable(source) and hasattr(source, "N"):
            rows = _rows_of_colormap(source, _span(volume, range, getattr(source, "name", "colormap")), opacity)
            self._native = _chiaro.TransferFunction(rows, False, *unit, name or getattr(source, "name", ""))
        else:
            self._native = _chiaro.TransferFunction([_row(p) for p in source], bool(linear), *unit, name)

    def _load(self, name: str, volume: Any, span: Any, opacity: Sequence[float]) -> None:
        from .errors import UsageError

        native_volume = None if volume is None else _volume(volume)._native
        try:
            low, high = (0.0, 1.0) if span is None else (float(span[0]), float(span[1]))
            self._native, stretched, notes, _ = _chiaro.load_transfer(name, native_volume, low, high)
        except UsageError:
            colormap = _matplotlib(name)
            if colormap is None:
                raise
            rows = _rows_of_colormap(colormap, _span(volume, span, name), opacity)
            self._native = _chiaro.TransferFunction(rows, False, 1.0, False, name)
            return
        _note(name, notes)
        if (stretched or _is_stretched(name)) and volume is None and span is None:
            self._source = name

    @classmethod
    def _of_native(cls, native: Any) -> "TransferFunction":
        self = cls.__new__(cls)
        self._native, self._source = native, None
        return self

    @staticmethod
    def of(source: Any, volume: Any = None) -> "TransferFunction":
        """Itself, or what TransferFunction(source, volume) is."""
        return source if isinstance(source, TransferFunction) else TransferFunction(source, volume)

    @staticmethod
    def guessed(volume: Any) -> "TransferFunction":
        """What a picture of the volume takes where nothing is said."""
        from .session import Session

        return Session(volume).transfer_function

    def _known(self) -> Any:
        if self._source is not None:
            raise ValueError(f"'{self._source}' is stretched over the data: give TransferFunction a volume or range=(low, high)")
        return self._native

    @property
    def points(self) -> np.ndarray[Any, Any]:
        """(n, 5): value, r, g, b, opacity."""
        return np.array([p[:5] for p in self._known().points])

    @property
    def name(self) -> str:
        return str(self._native.name)

    @property
    def opacity_unit(self) -> tuple[float, str]:
        """The length that opacities belong to, and 'voxels' (of the smallest size) or 'mm'."""
        return float(self._native.opacity_unit), "mm" if self._native.opacity_unit_is_mm else "voxels"

    def with_points(self, points: Iterable[Any]) -> "TransferFunction":
        """The same with other points, rows of (value, r, g, b, opacity)."""
        native = self._known()
        rows = [_row(p) for p in points]
        unit = native.opacity_unit, native.opacity_unit_is_mm
        return TransferFunction._of_native(_chiaro.TransferFunction(rows, native.is_linear, *unit, native.name))

    def scaled(self, opacity: float) -> "TransferFunction":
        """The same with opacities times a factor, at most 1."""
        points = self.points
        points[:, 4] = np.minimum(1, points[:, 4] * opacity)
        return self.with_points(points)

    def windowed(self, center: float, width: float) -> "TransferFunction":
        """Moved so that its first and last point span the window."""
        return TransferFunction._of_native(self._known().windowed(float(center), float(width)))

    def __call__(self, values: Any) -> np.ndarray[Any, Any]:
        """(..., 4): r, g, b, opacity at values."""
        given = np.asarray(values, dtype=float)
        found = np.array([self._known().evaluate(v) for v in given.ravel()]).reshape(*given.shape, 4)
        return found

    def to_json(self) -> str:
        """As a scene file keeps it."""
        return str(self._known().to_json())

    def save(self, path: str | os.PathLike[str], format: str = "chiaro") -> None:  # noqa: A002
        """Writes JSON of ours, or of ParaView (``format='paraview'``)."""
        if format not in ("chiaro", "paraview"):
            raise ValueError(f"format={format!r}: must be 'chiaro' or 'paraview'")
        text = self.to_json() if format == "chiaro" else str(self._known().to_paraview_json())
        with open(path, "w", encoding="utf-8") as file:
            file.write(text + "\n")

    def draw(self, volume: Any = None, size: tuple[int, int] = (480, 120)) -> np.ndarray[Any, Any]:
        """(height, width, 3) uint8: the colours below the opacity, the volume's histogram behind it."""
        from . import _html

        return _html.graph(self, volume, size)

    def _repr_png_(self) -> bytes | None:
        return None if self._source is not None else bytes(_chiaro.encode_png(self.draw(), []))

    def __eq__(self, other: object) -> bool:
        return isinstance(other, TransferFunction) and self._source == other._source and self._native == other._native

    __hash__ = None  # type: ignore[assignment]

    def __repr__(self) -> str:
        if self._source is not None:
            return f"<chiaro.TransferFunction {self._source!r}, stretched over the data>"
        points = self.points
        return f"<chiaro.TransferFunction {self.name!r}: {len(points)} points from {points[0, 0]:g} to {points[-1, 0]:g}>"


def list_presets() -> list[tuple[str, str, str]]:
    """Name, modality and sentence of each preset, then of the colour maps."""
    return [(name, modality, sentence) for name, modality, sentence, _ in _chiaro.list_presets()]


def _is_stretched(name: str) -> bool:
    """Whether this is a preset or colour map that is stretched over the data."""
    return any(stretched and name in (preset, f"{preset}_r") for preset, _, _, stretched in _chiaro.list_presets())


def _volume(source: Any) -> Any:
    from .volume import Volume

    return Volume.of(source)


def _note(name: str, notes: list[str]) -> None:
    import logging

    for note in notes:
        logging.getLogger("chiaro").info("%s: %s", name, note)


def _span(volume: Any, span: Any, name: str) -> tuple[float, float]:
    if span is not None:
        return float(span[0]), float(span[1])
    if volume is None:
        raise ValueError(f"'{name}' has no values of its own: give TransferFunction a volume or range=(low, high)")
    found = _volume(volume).statistics
    return found["p1"], found["p999"]


def _row(point: Any) -> tuple[float, float, float, float, float, str]:
    row = list(point)
    if len(row) == 3 and isinstance(row[1], str):
        row = [row[0], *_chiaro.parse_color(row[1]), row[2]]
    if len(row) not in (5, 6):
        raise ValueError(f"a point of {len(row)} values: must be value, r, g, b, opacity, or value, colour name, opacity")
    value, r, g, b, opacity = (float(v) for v in row[:5])
    return value, r, g, b, opacity, str(row[5]) if len(row) == 6 else ""


def _matplotlib(name: str) -> Any:
    """A colormap by name, where matplotlib is loaded already or installed."""
    try:
        import matplotlib
    except ImportError:
        return None
    maps: Any = getattr(matplotlib, "colormaps", {})
    return maps[name] if name in maps else None


def _rows_of_colormap(colormap: Any, span: tuple[float, float], opacity: Sequence[float]) -> list[Any]:
    count = int(min(max(colormap.N, 2), 256))
    at = np.linspace(0, 1, count)
    colours = np.asarray(colormap(at), dtype=float)
    return [
        (span[0] + t * (span[1] - span[0]), *(float(c) for c in colours[i, :3]), float(opacity[0] + t * (opacity[1] - opacity[0])), "")
        for i, t in enumerate(at)
    ]



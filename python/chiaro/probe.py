"""Environment maps (HDRI, light probes)."""

from __future__ import annotations

import os
from typing import Any

import numpy as np

from . import _chiaro


class Probe:
    """Light from all around: the name of a built-in one (``list_probes()``), an equirectangular .hdr or .exr file, or an
    array (height, width, 3) of linear radiance, row 0 up. ``rotation`` in degrees turns it around the up axis,
    ``exposure`` multiplies its light by 2 to this power; None: a file's until it lights a white ball well, an array's and
    a built-in one's as it is. It never changes.
    """

    def __init__(self, source: Any, rotation: float = 0.0, exposure: float | None = None) -> None:
        self.name = ""
        self._loaded: Any = None
        self.rotation, self.exposure = float(rotation), None if exposure is None else float(exposure)
        if isinstance(source, (str, os.PathLike)):
            self.name = os.fspath(source)
            return
        array = np.asarray(source)
        if array.ndim != 3 or array.shape[2] not in (3, 4) or array.dtype.kind not in "fiu":
            raise ValueError(f"a probe of shape {array.shape} and type {array.dtype}: must be (height, width, 3) numbers")
        self.exposure = self.exposure or 0.0
        self._loaded = _chiaro.Probe(np.ascontiguousarray(array[..., :3], dtype=np.float32))

    @staticmethod
    def of(source: Any) -> "Probe":
        """Itself, or what Probe(source) is."""
        return source if isinstance(source, Probe) else Probe(source)

    @property
    def _native(self) -> Any:
        if self._loaded is None:
            self._loaded = _chiaro.load_probe(self.name)
        return self._loaded

    @property
    def array(self) -> np.ndarray[Any, Any]:
        """(height, width, 3) float32, linear, neither turned nor exposed."""
        return np.asarray(self._native.rgb)

    def _with(self, rotation: float, exposure: float | None) -> "Probe":
        other = Probe.__new__(Probe)
        other.name, other._loaded = self.name, self._loaded
        other.rotation, other.exposure = rotation, exposure
        return other

    def rotated(self, degrees: float) -> "Probe":
        """Turned further around the up axis."""
        return self._with(self.rotation + float(degrees), self.exposure)

    def exposed(self, stops: float) -> "Probe":
        """Brighter by 2 to this power."""
        return self._with(self.rotation, (self.exposure or 0.0) + float(stops))

    def _repr_png_(self) -> bytes:
        light = self.array[:: max(1, self.array.shape[0] // 128), :: max(1, self.array.shape[1] // 256)]
        shown = np.clip(light * 2.0 ** (self.exposure or 0.0), 0, 1)
        srgb = np.where(shown <= 0.0031308, 12.92 * shown, 1.055 * shown ** (1 / 2.4) - 0.055)
        shift = int(round(self.rotation / 360 * srgb.shape[1]))
        return bytes(_chiaro.encode_png(np.ascontiguousarray(np.roll(np.rint(255 * srgb).astype(np.uint8), -shift, axis=1)), []))

    def __repr__(self) -> str:
        what = repr(self.name) if self.name else f"array {self.array.shape[:2]}"
        stops = "exposed by itself" if self.exposure is None else f"{self.exposure:+g} stops"
        return f"<chiaro.Probe {what}, turned {self.rotation:g}°, {stops}>"


def list_probes() -> list[tuple[str, str]]:
    """Name and sentence of each built-in probe."""
    return [(name, sentence) for name, sentence in _chiaro.list_probes()]

"""Pictures."""

from __future__ import annotations

import json
import os
from typing import Any, Callable

import numpy as np

from . import _chiaro


class Image:
    """A picture. ``np.asarray(image)`` is what is shown: (h, w, 3) uint8 sRGB, (h, w, 4) with ``background='transparent'``.

    ``scene`` made it; ``stats`` tells how, as the tool's --stats does.
    """

    def __init__(self, pixels: np.ndarray[Any, Any], linear: Any, scene: Any, stats: dict[str, Any], depth: Callable[[], Any] | None) -> None:
        self._pixels = pixels
        self._linear = linear
        self._depth: Any = None
        self._find_depth = depth
        self.scene = scene
        self.stats = stats

    @property
    def width(self) -> int:
        return int(self._pixels.shape[1])

    @property
    def height(self) -> int:
        return int(self._pixels.shape[0])

    @property
    def linear(self) -> np.ndarray[Any, Any]:
        """(h, w, 4) float32: linear light (Rec. 709), premultiplied by alpha, exposed, neither bent by a tone curve nor
        over a background."""
        if callable(self._linear):
            self._linear = self._linear()
        return np.asarray(self._linear)

    @property
    def depth(self) -> np.ndarray[Any, Any]:
        """(h, w) float32: mm from the eye (orthographic: from the plane through it) to where a ray's opacity reaches one
        half, infinity where it never does. Found when first asked for, while this is the newest picture of its session
        (or of ``render``); of an older one it is known only where ``depth=True`` asked for it."""
        if self._depth is None:
            if self._find_depth is None:
                raise ValueError("the depth of this picture is not known any more: ask with depth=True when rendering")
            self._depth = np.asarray(self._find_depth())
            self._find_depth = None
        return np.asarray(self._depth)

    def _forget_source(self) -> None:
        self._find_depth = None
        if callable(self._linear):
            self._linear = self._linear()

    def __array__(self, dtype: Any = None, copy: Any = None) -> np.ndarray[Any, Any]:
        return self._pixels if dtype is None and not copy else np.array(self._pixels, dtype=dtype)

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes .png or .exr (linear light), whole or not at all, with the scene inside."""
        from .errors import error_of

        name = os.fspath(path)
        metadata = [("chiaro", self.scene._native.to_json(os.path.dirname(name)))] if self.scene is not None else []
        if name.endswith(".exr"):
            if self.scene is not None and self.scene.color == "display":
                raise error_of(2, f"{name}: color='display' gives no linear light, which .exr holds")
            _chiaro.write_exr(np.ascontiguousarray(self.linear), name, metadata)
        elif name.endswith(".png"):
            _chiaro.write_png(np.ascontiguousarray(self._pixels), name, metadata)
        else:
            raise error_of(2, f"{name}: must end in .png or .exr")

    def _repr_png_(self) -> bytes:
        return bytes(_chiaro.encode_png(np.ascontiguousarray(self._pixels), []))

    def __repr__(self) -> str:
        return f"<chiaro.Image {self.width} × {self.height}>"

    def stats_json(self) -> str:
        """``stats`` as text."""
        return json.dumps(self.stats, indent=2)


def read_image(path: str | os.PathLike[str]) -> Image:
    """A picture from a .png, or an .exr (then only ``linear`` is what the file holds). ``scene`` is what it carries, or
    None. Raises InputError."""
    from .errors import InputError
    from .scene import Scene

    name = os.fspath(path)
    try:
        scene: Any = Scene.from_picture(name)
    except InputError:
        scene = None
    if name.endswith(".exr"):
        linear = np.asarray(_chiaro.read_exr(name))
        shown = np.clip(linear[..., :3], 0, 1)
        srgb = np.where(shown <= 0.0031308, 12.92 * shown, 1.055 * shown ** (1 / 2.4) - 0.055)
        return Image(np.rint(255 * srgb).astype(np.uint8), linear, scene, {}, None)
    pixels = np.asarray(_chiaro.read_png(name))
    alpha = pixels[..., 3:] / 255 if pixels.shape[2] == 4 else np.ones((*pixels.shape[:2], 1))
    code = pixels[..., :3] / 255
    light = np.where(code <= 0.04045, code / 12.92, ((code + 0.055) / 1.055) ** 2.4)
    return Image(pixels, np.concatenate([light * alpha, alpha], axis=2).astype(np.float32), scene, {}, None)

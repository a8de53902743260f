"""What a notebook shows of things that are no pictures."""

from __future__ import annotations

import base64
import html
from typing import Any

import numpy as np

from . import _chiaro


def _png(pixels: np.ndarray[Any, Any]) -> str:
    data = base64.b64encode(_chiaro.encode_png(np.ascontiguousarray(pixels), [])).decode()
    return f"data:image/png;base64,{data}"


def _nearest(count: int, to: int) -> np.ndarray[Any, Any]:
    """The indices of `count` values that stand for `to` of them."""
    found: np.ndarray[Any, Any] = np.minimum((np.arange(to) + 0.5) * count / to, count - 1).astype(int)
    return found


def _slice(volume: Any, axis: int, edge: int = 160) -> str:
    """The middle slice across an axis of (z, y, x), as wide as it is in mm."""
    array = volume.array if volume.array.ndim == 3 else volume.array[..., 0]
    values = np.take(array, array.shape[axis] // 2, axis=axis).astype(float) * volume.slope + volume.intercept
    center, width = volume.window
    shown = np.nan_to_num(np.clip((values - center) / width + 0.5, 0, 1))
    spacing = np.delete(np.array(volume.spacing), axis)
    size = np.array(shown.shape) * spacing
    rows, columns = np.maximum(1, np.rint(size / size.max() * edge)).astype(int)
    small = shown[np.ix_(_nearest(shown.shape[0], rows), _nearest(shown.shape[1], columns))]
    if axis != 0:
        small = small[::-1]  # z upwards
    grey = np.rint(255 * small).astype(np.uint8)
    return f'<img alt="slice" src="{_png(np.repeat(grey[..., None], 3, axis=2))}">'


def volume(v: Any) -> str:
    z, y, x = v.shape[:3]
    s = v.statistics
    facts = [
        ("voxels", f"{z} × {y} × {x} (z, y, x), {v.dtype.name}"),
        ("spacing", " × ".join(f"{mm:g}" for mm in v.spacing) + " mm"),
        ("values", f"{s['min']:g} to {s['max']:g}, half of them below {s['p50']:g}"),
        ("world", v.frame or "of its own"),
        ("format", " ".join(filter(None, [v.format, v.modality]))),
        *[("note", note) for note in v.notes],
    ]
    rows = "".join(f"<tr><th style='text-align:left'>{html.escape(k)}</th><td style='text-align:left'>{html.escape(t)}</td></tr>" for k, t in facts)
    slices = "".join(_slice(v, axis) for axis in range(3))
    return f"<div><b>{html.escape(v.name)}</b><div style='display:flex;gap:8px;background:#000;width:max-content;padding:8px'>{slices}</div><table>{rows}</table></div>"


def graph(function: Any, volume: Any, size: tuple[int, int]) -> np.ndarray[Any, Any]:
    """Colours below the curve of opacity over the histogram (square roots of counts, so that little matter is seen)."""
    width, height = size
    points = function.points
    low, high = points[0, 0], points[-1, 0]
    counts = edges = None
    if volume is not None:
        from .volume import Volume

        counts, edges = Volume.of(volume).histogram()
        low, high = min(low, edges[0]), max(high, edges[-1])
    values = np.linspace(low, high if high > low else low + 1, width)
    found = function(values)
    row = np.arange(height)[:, None]
    pixels: np.ndarray[Any, Any] = np.full((height, width, 3), 255.0)
    if counts is not None and edges is not None:
        bins = np.clip(np.searchsorted(edges, values, side="right") - 1, 0, len(counts) - 1)
        inside = (values >= edges[0]) & (values <= edges[-1])
        tall = np.where(inside, np.sqrt(counts[bins] / max(counts.max(), 1)), 0)
        pixels[(height - row) <= tall * height] = 215
    colour = 255 * found[:, :3]
    under = (height - 1 - row) < found[:, 3] * (height - 1)
    pixels = np.where(under[..., None], 0.25 * pixels + 0.75 * colour[None], pixels)
    curve = np.rint((1 - found[:, 3]) * (height - 1)).astype(int)
    for column in range(width):
        other = curve[max(column - 1, 0)]
        pixels[min(curve[column], other) : max(curve[column], other) + 1, column] = 32
    shown: np.ndarray[Any, Any] = np.rint(pixels).astype(np.uint8)
    return shown

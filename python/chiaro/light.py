"""Light as data, and how far methods are from the ground truth."""

from __future__ import annotations

import os
from typing import Any, Mapping, Sequence

import numpy as np

from . import _chiaro, _progress
from .image import Image, read_image
from .scene import scene_of
from .session import Session, render, split_device
from .volume import Volume


class Field(Volume):
    """What a lighting method computes for every voxel (or node), with its place in the world. ``array`` is float32,
    (z, y, x) for accessibility (1: all light arrives), (z, y, x, c) for mean radiance and spherical harmonics."""

    stages: list[tuple[str, float]]


def illuminate(volume: Any, *, progress: Any = None, **settings: Any) -> Field:
    """The light of a scene's method as numbers: ambient occlusion, accessibility, mean radiance.

    Takes what ``render`` takes; settings of the camera do not matter. Raises UsageError for a method that computes no
    field (none) and for mode='mip', else as ``render``.
    """
    device, picture = split_device(settings)
    session = Session(scene_of(volume, picture, "illuminate"), **device)
    with _progress.reporting(progress) as report:
        session._show(report)
        native, stages = session._session.field(session.scene._native, report)
    field = Field._of_native(native)
    assert isinstance(field, Field)
    field.stages = stages
    return field


class Difference(dict[str, float]):
    """Figures by name, also as attributes: rmse, psnr, ssim, max and bias of pictures; rmse, max, bias and correlation of
    volumes."""

    def __getattr__(self, name: str) -> float:
        try:
            return self[name]
        except KeyError:
            raise AttributeError(name) from None

    def __repr__(self) -> str:
        return ", ".join(f"{name} {value:.4g}" for name, value in self.items())


def _pixels(source: Any) -> np.ndarray[Any, Any]:
    if isinstance(source, (str, os.PathLike)):
        picture = read_image(source)
        return picture.linear if os.fspath(source).endswith(".exr") else np.asarray(picture)
    return np.asarray(source)


def _four(linear: np.ndarray[Any, Any]) -> np.ndarray[Any, Any]:
    if linear.shape[2] == 3:
        linear = np.concatenate([linear, np.ones((*linear.shape[:2], 1))], axis=2)
    return np.ascontiguousarray(linear, dtype=np.float32)


def compare(a: Any, b: Any) -> Difference:
    """How two pictures or two volumes differ, as ``chiaro compare`` tells it.

    Pictures: an Image, (h, w, 3 or 4) uint8 or float32, or a .png or .exr; both of one kind and size. Volumes: of one
    shape, wherever they lie. Raises InputError for different sizes, TypeError for what is neither.
    """
    if isinstance(a, Volume) or isinstance(b, Volume):
        return Difference(_chiaro.compare_volumes(Volume.of(a)._native, Volume.of(b)._native))
    left, right = _pixels(a), _pixels(b)
    for pixels in (left, right):
        if pixels.ndim != 3 or pixels.shape[2] not in (3, 4) or pixels.dtype.kind not in "uf":
            raise TypeError(f"an array of shape {pixels.shape} and type {pixels.dtype} is no picture: (height, width, 3 or 4)")
    if (left.dtype == np.uint8) != (right.dtype == np.uint8):
        raise TypeError("one picture has display values (uint8), the other linear light (float): compare equal kinds")
    if left.dtype == np.uint8:
        return Difference(_chiaro.compare_images(np.ascontiguousarray(left), np.ascontiguousarray(right)))
    return Difference(_chiaro.compare_frames(_four(left), _four(right)))


def compare_methods(volume: Any, methods: Sequence[str], *, progress: Any = None, **settings: Any) -> list[dict[str, Any]]:
    """Pictures of a scene by several lighting methods, each with its distance from the ground truth (path tracing), as
    ``chiaro compare --methods`` tells it: method, linear, reference (both (h, w, 4) float32), light, rmse, psnr, ssim,
    block_error, light_seconds, frame_seconds. ``reference_rays`` says how many paths a pixel."""
    device, picture = split_device(settings)
    session = Session(scene_of(volume, picture, "compare_methods"), **device)
    with _progress.reporting(progress) as report:
        session._show(report)
        found: list[Mapping[str, Any]] = session._session.compare(session.scene._native, list(methods), report)
    return [{key: np.asarray(value) if key in ("linear", "reference") else value for key, value in row.items()} for row in found]


def reference(volume: Any, **settings: Any) -> Image:
    """The ground truth of a scene: ``render`` with lighting='reference', path tracing. ``reference_rays``: paths a pixel;
    ``reference_time``, ``reference_error``: when to stop before. ``image.stats['paths']`` tells the noise."""
    given: dict[str, Any] = {"lighting": "reference", **settings}
    return render(volume, **given)

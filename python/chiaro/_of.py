"""Volumes of what other packages hold, by what they are: none of these packages is imported here."""

from __future__ import annotations

import os
import sys
from typing import Any

import numpy as np

from .volume import Volume, read


def volume_of(source: Any, **more: Any) -> Volume:
    if isinstance(source, Volume):
        return source
    if isinstance(source, (str, os.PathLike)):
        return read(source, **more)
    for fits, take in _KINDS:
        if fits(source):
            return take(source, **more)
    if hasattr(source, "shape") or hasattr(source, "__array__"):
        return Volume(source, **more)
    raise TypeError(f"a volume of {type(source).__module__}.{type(source).__name__}: give an array, a path or an image that says where it lies")


def _module(source: Any) -> str:
    return type(source).__module__.split(".")[0]


# --- nibabel: (x, y, z) and an affine to RAS
def _is_nibabel(source: Any) -> bool:
    return hasattr(source, "affine") and hasattr(source, "dataobj")


def _of_nibabel(image: Any, **more: Any) -> Volume:
    data = np.asanyarray(image.dataobj)
    if data.ndim == 4 and data.shape[3] == 1:
        data = data[..., 0]
    if data.ndim != 3:
        raise ValueError(f"an image of shape {data.shape}: a volume has three axes; give one of them, as in image.slicer[..., 0]")
    name = image.get_filename() if hasattr(image, "get_filename") else None
    return Volume(data.T, affine=image.affine, **{"name": os.fspath(name) if name else "nibabel image", **more})


# --- SimpleITK and itk: LPS
def _is_itk(source: Any) -> bool:
    return hasattr(source, "GetSpacing") and hasattr(source, "GetDirection") and _module(source) in ("SimpleITK", "itk")


def _of_itk(image: Any, **more: Any) -> Volume:
    package = sys.modules[_module(image)]
    if _module(image) == "SimpleITK":
        array = package.GetArrayViewFromImage(image)
        direction: np.ndarray[Any, Any] = np.array(image.GetDirection()).reshape(len(image.GetSpacing()), -1)
    else:
        array = package.array_view_from_image(image)
        direction = np.asarray(package.array_from_matrix(image.GetDirection()))
    if direction.shape != (3, 3):
        raise ValueError(f"an image of {direction.shape[0]} axes: a volume has three")
    spacing, origin = [float(s) for s in image.GetSpacing()], [float(o) for o in image.GetOrigin()]
    kept: dict[str, Any] = {"name": f"{_module(image)} image", **more}
    volume = Volume(array, spacing=spacing[::-1], origin=origin, direction=direction, frame="LPS", **kept)
    volume._owner = image  # type: ignore[attr-defined] # the view does not keep it
    return volume


# --- xarray: named axes with coordinates
def _is_xarray(source: Any) -> bool:
    return hasattr(source, "dims") and hasattr(source, "coords") and hasattr(source, "transpose")


def _of_xarray(data: Any, **more: Any) -> Volume:
    dims = list(data.dims)
    if len(dims) != 3:
        raise ValueError(f"a DataArray with the axes {', '.join(map(str, dims))}: a volume has three; choose with .isel({dims[0]}=0)")
    order = dims
    lower = [str(d).lower() for d in dims]
    if set(lower) == {"x", "y", "z"}:
        order = [dims[lower.index(axis)] for axis in "zyx"]
    spacing, origin, signs = [], [], []
    for dim in order:
        first, step = _regular(data, dim)
        spacing.append(abs(step))
        origin.append(first)
        signs.append(1.0 if step > 0 else -1.0)
    name = str(data.name) if getattr(data, "name", None) is not None else "xarray DataArray"
    given: dict[str, Any] = {"spacing": spacing, "origin": origin[::-1], "direction": np.diag(signs[::-1]), "name": name, **more}
    return Volume(data.transpose(*order).data, **given)


def _regular(data: Any, dim: Any) -> tuple[float, float]:
    """Where an axis begins, and its step: 0 and 1 without coordinates."""
    if dim not in data.coords or data.sizes[dim] == 0:
        return 0.0, 1.0
    at = np.asarray(data.coords[dim].values)
    if at.dtype.kind not in "iuf":
        raise ValueError(f"the axis {dim!r} has coordinates of type {at.dtype}: must be numbers")
    if len(at) == 1:
        return float(at[0]), 1.0
    steps = np.diff(at.astype(float))
    step = float(steps.mean())
    if step == 0 or not np.allclose(steps, step, rtol=1e-3, atol=0):
        raise ValueError(f"the coordinates of the axis {dim!r} are not evenly spaced: resample it first, as with .interp")
    return float(at[0]), step


# --- vtkImageData, and PyVista's, which is one
def _is_vtk(source: Any) -> bool:
    return hasattr(source, "GetDimensions") and hasattr(source, "GetPointData") and hasattr(source, "GetSpacing")


def _of_vtk(image: Any, **more: Any) -> Volume:
    points = image.GetPointData()
    scalars = points.GetScalars()
    if scalars is None and points.GetNumberOfArrays() > 0:
        scalars = points.GetArray(0)
    if scalars is None:
        raise ValueError("the image has no values at its points; of values in cells take image.cell_data_to_point_data()")
    if scalars.GetNumberOfComponents() != 1:
        raise ValueError(f"the array '{scalars.GetName()}' has {scalars.GetNumberOfComponents()} values a voxel: only one can be shown")
    x, y, z = image.GetDimensions()
    array = np.asarray(memoryview(scalars)).reshape(z, y, x)
    direction = np.eye(3)
    if hasattr(image, "GetDirectionMatrix"):
        matrix = image.GetDirectionMatrix()
        direction = np.array([[matrix.GetElement(i, j) for j in range(3)] for i in range(3)])
    extent = image.GetExtent()
    spacing = np.array(image.GetSpacing(), dtype=float)
    signs = np.where(spacing < 0, -1.0, 1.0)
    origin = np.array(image.GetOrigin()) + direction @ (spacing * np.array(extent[::2]))
    given = {"spacing": np.abs(spacing)[::-1], "origin": origin, "direction": direction * signs, "name": scalars.GetName() or "vtkImageData", **more}
    return Volume(array, **given)


# --- pydicom: one dataset for each slice
def _is_pydicom(source: Any) -> bool:
    return isinstance(source, (list, tuple)) and bool(source) and all(hasattr(one, "pixel_array") for one in source)


def _of_pydicom(slices: Any, **more: Any) -> Volume:
    first = slices[0]
    rows, columns = (np.array([float(v) for v in first.ImageOrientationPatient]).reshape(2, 3)) if "ImageOrientationPatient" in first else np.eye(3)[:2]
    normal = np.cross(rows, columns)
    place = [float(np.dot(normal, [float(v) for v in one.ImagePositionPatient])) if "ImagePositionPatient" in one else float(i) for i, one in enumerate(slices)]
    order = np.argsort(place, kind="stable")
    ordered = [slices[i] for i in order]
    at = np.array(place)[order]
    steps = np.diff(at)
    if len(steps) and (steps.min() <= 0 or steps.max() - steps.min() > 0.01 * abs(steps.mean()) + 1e-3):
        raise ValueError("the slices are not evenly spaced, or two lie at one place: they are no volume")
    shapes = {one.pixel_array.shape for one in ordered}
    if len(shapes) != 1 or len(next(iter(shapes))) != 2:
        raise ValueError(f"the slices have the shapes {sorted(shapes)}: must be one, of two axes")
    scales = {(float(getattr(one, "RescaleSlope", 1)), float(getattr(one, "RescaleIntercept", 0))) for one in ordered}
    stack = np.stack([one.pixel_array for one in ordered])
    slope, intercept = next(iter(scales))
    if len(scales) > 1:  # each slice has its own: values rather than stored numbers
        factors = np.array([[float(getattr(one, "RescaleSlope", 1)), float(getattr(one, "RescaleIntercept", 0))] for one in ordered])
        stack = (stack * factors[:, 0, None, None] + factors[:, 1, None, None]).astype(np.float32)
        slope, intercept = 1.0, 0.0
    dy, dx = (float(v) for v in getattr(first, "PixelSpacing", (1, 1)))
    thickness = float(steps.mean()) if len(steps) else float(getattr(first, "SliceThickness", 1) or 1)
    origin = [float(v) for v in ordered[0].ImagePositionPatient] if "ImagePositionPatient" in ordered[0] else [0.0, 0.0, 0.0]
    given = {"spacing": (thickness, dy, dx), "origin": origin, "direction": np.stack([rows, columns, normal], axis=1), "frame": "LPS", "name": "pydicom datasets", **more}
    volume = Volume(stack, **given)
    volume._native = volume._native.told(volume.name, "DICOM", str(getattr(first, "Modality", "")), slope, intercept)
    return volume


_KINDS = (
    (_is_nibabel, _of_nibabel),
    (_is_itk, _of_itk),
    (_is_xarray, _of_xarray),
    (_is_vtk, _of_vtk),
    (_is_pydicom, _of_pydicom),
)

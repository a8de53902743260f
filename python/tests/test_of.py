import itertools

import chiaro
import numpy as np
import pytest

nib = pytest.importorskip("nibabel")


def affines():
    """48 orientations: six orders of the axes, eight of their signs."""
    for order in itertools.permutations(range(3)):
        for signs in itertools.product((1, -1), repeat=3):
            affine = np.zeros((4, 4))
            affine[3, 3] = 1
            for column, (axis, sign) in enumerate(zip(order, signs)):
                affine[axis, column] = sign * (0.5, 1.25, 2)[column]
            affine[:3, 3] = (-7, 11, 13)
            yield affine


@pytest.mark.parametrize("affine", list(affines()), ids=lambda a: "".join(nib.aff2axcodes(a)))
def test_48_orientations_round_trip_through_nibabel(affine, blob, tmp_path, picture):
    image = nib.Nifti1Image(np.asfortranarray(blob.T), affine)
    v = chiaro.Volume.of(image)
    np.testing.assert_allclose(v.affine, affine)
    np.testing.assert_array_equal(v.array, blob)
    assert v.array.ctypes.data == image.dataobj.ctypes.data and v.frame == "RAS"
    nib.save(image, tmp_path / "a.nii")
    read = chiaro.read(tmp_path / "a.nii")
    np.testing.assert_allclose(read.affine, affine, atol=1e-5)
    np.testing.assert_array_equal(read.array, v.array)
    view = {"view": "left", "lighting": "none", "size": (24, 18)}
    assert np.abs(picture(v, **view).astype(int) - picture(read, **view)).max() <= 2
    back = nib.Nifti1Image(v.array.T, v.affine)
    assert nib.aff2axcodes(back.affine) == nib.aff2axcodes(affine)


def test_nibabel_refuses_four_axes(blob):
    with pytest.raises(ValueError, match=r"slicer"):
        chiaro.Volume.of(nib.Nifti1Image(np.stack([blob.T] * 2, axis=3), np.eye(4)))
    assert chiaro.Volume.of(nib.Nifti1Image(blob.T[..., None], np.eye(4))).shape == blob.shape


def test_xarray(blob):
    xr = pytest.importorskip("xarray")
    z, y, x = (np.arange(n) * step + first for n, step, first in zip(blob.shape, (3, 2, -1), (5, 6, 7)))
    data = xr.DataArray(blob, dims=("z", "y", "x"), coords={"z": z, "y": y, "x": x}, name="heat")
    v = chiaro.Volume.of(data)
    assert v.spacing == (3, 2, 1) and v.origin == (7, 6, 5) and v.name == "heat"
    np.testing.assert_array_equal(v.direction, np.diag([-1, 1, 1]))
    assert v.array.ctypes.data == blob.ctypes.data
    turned = chiaro.Volume.of(data.transpose("x", "z", "y"))
    np.testing.assert_array_equal(turned.array, blob)
    np.testing.assert_allclose(turned.affine, v.affine)
    with pytest.raises(ValueError, match="evenly spaced"):
        chiaro.Volume.of(data.assign_coords(z=z**2))
    with pytest.raises(ValueError, match="isel"):
        chiaro.Volume.of(data.expand_dims("time"))


def test_vtk(blob):
    core = pytest.importorskip("vtkmodules.vtkCommonDataModel")
    from vtkmodules.util.numpy_support import numpy_to_vtk

    image = core.vtkImageData()
    image.SetDimensions(*blob.shape[::-1])
    image.SetSpacing(1, 2, 3)
    image.SetOrigin(10, 20, 30)
    image.SetDirectionMatrix(0, -1, 0, 1, 0, 0, 0, 0, 1)
    scalars = numpy_to_vtk(blob.ravel(), deep=False)
    scalars.SetName("density")
    image.GetPointData().SetScalars(scalars)
    v = chiaro.Volume.of(image)
    assert v.spacing == (3, 2, 1) and v.origin == (10, 20, 30) and v.name == "density"
    np.testing.assert_array_equal(v.array, blob)
    assert v.array.ctypes.data == blob.ctypes.data
    np.testing.assert_array_equal(v.direction, [[0, -1, 0], [1, 0, 0], [0, 0, 1]])
    with pytest.raises(ValueError, match="no values"):
        chiaro.Volume.of(core.vtkImageData())


def test_simpleitk(blob):
    sitk = pytest.importorskip("SimpleITK")
    image = sitk.GetImageFromArray(blob)
    image.SetSpacing((1, 2, 3)), image.SetOrigin((10, 20, 30)), image.SetDirection((0, -1, 0, 1, 0, 0, 0, 0, 1))
    v = chiaro.Volume.of(image)
    assert v.spacing == (3, 2, 1) and v.origin == (10, 20, 30) and v.frame == "LPS"
    np.testing.assert_array_equal(v.array, blob)


def test_simpleitk_by_what_it_is(blob, monkeypatch):
    """Debian has no SimpleITK: a class of its module and methods stands for it."""
    import sys
    import types

    module = types.ModuleType("SimpleITK")

    class Image:
        GetSpacing = staticmethod(lambda: (1.0, 2.0, 3.0))
        GetOrigin = staticmethod(lambda: (10.0, 20.0, 30.0))
        GetDirection = staticmethod(lambda: (0.0, -1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0))

    Image.__module__ = "SimpleITK"
    module.GetArrayViewFromImage = lambda image: blob
    monkeypatch.setitem(sys.modules, "SimpleITK", module)
    v = chiaro.Volume.of(Image())
    assert v.spacing == (3, 2, 1) and v.origin == (10, 20, 30) and v.frame == "LPS"
    np.testing.assert_array_equal(v.direction, [[0, -1, 0], [1, 0, 0], [0, 0, 1]])
    assert v.array.ctypes.data == blob.ctypes.data


def dicom_slices(blob, folder):
    pydicom = pytest.importorskip("pydicom")
    from pydicom.dataset import FileDataset, FileMetaDataset
    from pydicom.uid import CTImageStorage, ExplicitVRLittleEndian, generate_uid

    series, study = generate_uid(), generate_uid()
    files = []
    for k in (3, 0, 2, 1):  # in no order
        meta = FileMetaDataset()
        meta.MediaStorageSOPClassUID, meta.MediaStorageSOPInstanceUID = CTImageStorage, generate_uid()
        meta.TransferSyntaxUID = ExplicitVRLittleEndian
        path = folder / f"{k}.dcm"
        data = FileDataset(str(path), {}, file_meta=meta, preamble=b"\0" * 128)
        data.is_little_endian, data.is_implicit_VR = True, False
        data.SOPClassUID, data.SOPInstanceUID = CTImageStorage, meta.MediaStorageSOPInstanceUID
        data.SeriesInstanceUID, data.StudyInstanceUID, data.Modality = series, study, "CT"
        data.ImageOrientationPatient, data.ImagePositionPatient = [1, 0, 0, 0, 1, 0], [-5, 6, 7 + 2.5 * k]
        data.PixelSpacing, data.SliceThickness = [0.75, 0.5], 2.5
        data.RescaleSlope, data.RescaleIntercept = 2, -1000
        data.Rows, data.Columns = blob.shape[1:]
        data.SamplesPerPixel, data.PhotometricInterpretation = 1, "MONOCHROME2"
        data.BitsAllocated, data.BitsStored, data.HighBit, data.PixelRepresentation = 16, 16, 15, 0
        data.PixelData = blob[k].tobytes()
        data.save_as(str(path), write_like_original=False)
        files.append(pydicom.dcmread(str(path)))
    return files


def test_pydicom_is_what_the_folder_is(blob, tmp_path, picture):
    slices = dicom_slices(blob, tmp_path)
    v, read = chiaro.Volume.of(slices), chiaro.Volume.of(tmp_path)
    np.testing.assert_array_equal(v.to_numpy(), read.to_numpy())
    np.testing.assert_allclose(v.affine, read.affine)
    assert v.spacing == (2.5, 0.75, 0.5) and v.modality == read.modality == "CT" and v.frame == "LPS"
    np.testing.assert_array_equal(picture(v, view="left"), picture(read, view="left"))
    with pytest.raises(ValueError, match="evenly spaced"):
        chiaro.Volume.of([slices[0], slices[0]])


def test_arrays_that_are_read_piece_by_piece(blob, tmp_path, caplog):
    da = pytest.importorskip("dask.array")
    np.testing.assert_array_equal(chiaro.Volume.of(da.from_array(blob, chunks=8)).array, blob)
    zarr = pytest.importorskip("zarr")
    np.testing.assert_array_equal(chiaro.Volume.of(zarr.array(blob)).array, blob)
    h5py = pytest.importorskip("h5py")
    with h5py.File(tmp_path / "a.h5", "w") as file:
        np.testing.assert_array_equal(chiaro.Volume.of(file.create_dataset("a", data=blob)).array, blob)
    np.save(tmp_path / "a.npy", blob)
    mapped = np.load(tmp_path / "a.npy", mmap_mode="r")
    assert chiaro.Volume.of(mapped).array.ctypes.data == mapped.ctypes.data
    huge = da.zeros((60000, 60000, 60000), chunks=1000, dtype="u2")
    with pytest.raises(ValueError, match=r"an array of 432000\.0 GB does not fit"):
        chiaro.Volume.of(huge)


def test_others_are_refused_in_a_sentence():
    with pytest.raises(TypeError, match="a volume of builtins.dict: give an array, a path"):
        chiaro.Volume.of({})
    v = chiaro.sample("ball", 8)
    assert chiaro.Volume.of(v) is v


def test_nothing_of_others_is_imported(python):
    said = python("import sys, chiaro; print([m for m in ('nibabel', 'SimpleITK', 'itk', 'xarray', 'vtk', 'pydicom', 'dask', 'matplotlib', 'IPython') if m in sys.modules])")
    assert said.strip() == "[]"

"""Writes the same voxels in several formats for bare.py: make_files.py FOLDER. Needs tifffile, h5py and pydicom."""

import pathlib
import sys

import chiaro
import h5py
import numpy as np
import tifffile

sys.path.insert(0, str(pathlib.Path(__file__).parent))
from test_of import dicom_slices

folder = pathlib.Path(sys.argv[1])
(folder / "dicom").mkdir(parents=True)
z, y, x = np.mgrid[:4, :24, :28]
values = (200 * z + 3 * y + x + 100 * (np.hypot(y - 12, x - 14) < 9)).astype(np.uint16)
dicom_slices(values, folder / "dicom")
stored = (2 * values.astype(np.int16) - 1000)  # what dicom_slices states
np.save(folder / "expected.npy", stored)
chiaro.write(stored, folder / "volume.nrrd")
tifffile.imwrite(folder / "volume.tif", stored, photometric="minisblack")
with h5py.File(folder / "volume.h5", "w") as file:
    file["volume"] = stored

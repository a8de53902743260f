"""Stores that Python's zarr writes are read as they are."""
import numpy as np
import pytest

import chiaro

zarr = pytest.importorskip("zarr")
numcodecs = pytest.importorskip("numcodecs")

COMPRESSORS = {
    "none": None,
    "zlib": numcodecs.Zlib(3),
    "gzip": numcodecs.GZip(3),
    "zstd": numcodecs.Zstd(3),
    "lz4": numcodecs.LZ4(),
    "blosc-lz4": numcodecs.Blosc("lz4", 5, numcodecs.Blosc.SHUFFLE),
    "blosc-zstd": numcodecs.Blosc("zstd", 5, numcodecs.Blosc.BITSHUFFLE),
    "blosc-zlib": numcodecs.Blosc("zlib", 5, numcodecs.Blosc.NOSHUFFLE),
}


@pytest.mark.parametrize("compressor", COMPRESSORS)
@pytest.mark.parametrize("order", ["C", "F"])
@pytest.mark.parametrize("dtype", ["<u2", ">i4", "|u1", ">f8", "<f2"])
def test_every_compressor_order_and_type(tmp_path, compressor, order, dtype):
    values = (np.random.default_rng(1).random((20, 33, 17)) * 1000).astype(dtype)
    store = zarr.open_array(str(tmp_path / "a"), mode="w", shape=values.shape, chunks=(8, 9, 10), dtype=dtype,
                            compressor=COMPRESSORS[compressor], order=order, fill_value=0)
    store[:] = values
    read = chiaro.read(str(tmp_path / "a")).array
    np.testing.assert_array_equal(np.asarray(read, "f8"), np.asarray(values, "f8"))

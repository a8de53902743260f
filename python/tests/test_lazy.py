"""Volumes that are read where pictures show them."""
import threading
import time

import numpy as np
import pytest

import chiaro

SIZE = (96, 64)
PICTURE = dict(size=(160, 120), lighting="spao", interpolation="linear", transfer=[(60, "black", 0), (200, "orange", 0.6)])


@pytest.fixture(scope="module")
def shells():
    return chiaro.sample("shells", 256).array


class Counting:
    """An array whose parts are counted."""

    def __init__(self, array, chunks=None):
        self.array, self.shape, self.dtype = array, array.shape, array.dtype
        self.read, self.threads = 0, set()
        if chunks:
            self.chunks = chunks

    def __getitem__(self, box):
        part = self.array[box]
        self.read += part.size
        self.threads.add(threading.get_ident())
        return part


def picture(volume, **settings):
    session = chiaro.Session(volume, **{**PICTURE, **settings})
    return np.asarray(session.image()), session.paging


@pytest.mark.parametrize("chunks", [None, (64, 64, 64), (100, 30, 256)])
def test_by_bricks_it_is_the_picture_of_the_whole(shells, chunks):
    whole, none = picture(chiaro.Volume(shells, spacing=(0.5, 1, 1)))
    lazy = chiaro.Volume.lazy(Counting(shells, chunks), spacing=(0.5, 1, 1), memory="32M", exact=True)
    paged, paging = picture(lazy, early_termination=0)
    assert none is None and paging["level"] < paging["levels"] and paging["bricks_read"] > 0
    fine, _ = picture(chiaro.Volume.lazy(shells, spacing=(0.5, 1, 1), memory="2G"), early_termination=0)
    difference = np.abs(paged.astype(int) - fine.astype(int))
    assert np.sqrt(np.mean(difference**2.0)) < 12
    np.testing.assert_array_equal(picture(chiaro.Volume.lazy(Counting(shells, chunks), spacing=(0.5, 1, 1), memory="2G"))[0], whole)


def test_only_what_is_seen_is_read(shells):
    counted = Counting(shells, (32, 32, 32))
    small = [Counting(shells[1::2, 1::2, 1::2], (32, 32, 32)), Counting(shells[2::4, 2::4, 2::4], (32, 32, 32))]
    lazy = chiaro.Volume.lazy([counted, *small], memory="32M")
    assert lazy.levels[:3] == [(256,) * 3, (128,) * 3, (64,) * 3] and counted.read == 0
    _, far = picture(lazy, size=SIZE)
    assert counted.read == 0 and far["level"] > 0  # a voxel of a coarser level is a pixel
    _, near = picture(lazy, size=(320, 240), zoom=8)
    assert near["level"] == 0 and 0 < counted.read < shells.size / 4


def test_levels_lie_where_the_volume_does(shells):
    lazy = chiaro.Volume.lazy([shells, shells[::2, ::2]], spacing=(2, 1, 0.5), origin=(3, 4, 5), frame="LPS", name="s")
    assert lazy.shape == (256, 256, 256) and lazy.spacing == (2, 1, 0.5) and lazy.frame == "LPS" and lazy.dtype == np.uint8
    level = lazy.level(1)
    assert level.shape == (128, 128, 256) and level.spacing == (4, 2, 0.5)
    np.testing.assert_array_equal(level.array, shells[::2, ::2])
    # The edges of both boxes are the same.
    np.testing.assert_allclose(level.affine @ [-0.5, -0.5, -0.5, 1], lazy.affine @ [-0.5, -0.5, -0.5, 1])
    assert lazy.statistics["max"] <= shells.max() and lazy.window[1] > 0


@pytest.mark.parametrize("kind", ["bool", "float16", ">i2", "uint32", "float64"])
def test_types_are_those_of_a_whole_array(shells, kind):
    values = (shells[::4, ::4, ::4] > 100 if kind == "bool" else shells[::4, ::4, ::4]).astype(kind)
    lazy = chiaro.Volume.lazy(values)
    np.testing.assert_array_equal(lazy.level(0).array.astype(float), values.astype(float))


def test_arrays_of_others(shells, tmp_path):
    whole, _ = picture(chiaro.Volume(shells))
    np.save(tmp_path / "a.npy", shells)
    kinds = [np.load(tmp_path / "a.npy", mmap_mode="r")]
    da = pytest.importorskip("dask.array")
    kinds.append(da.from_array(shells, chunks=(64, 100, 128)))
    kinds.append(pytest.importorskip("zarr").array(shells, chunks=(64, 64, 64)))
    h5py = pytest.importorskip("h5py")
    with h5py.File(tmp_path / "a.h5", "w") as file:
        kinds.append(file.create_dataset("a", data=shells, chunks=(32, 64, 64)))
        for kind in kinds:
            np.testing.assert_array_equal(picture(chiaro.Volume.lazy(kind, memory="1G"))[0], whole)
    huge = da.zeros((60000, 60000, 60000), chunks=256, dtype="u2")
    assert chiaro.Volume.lazy(huge).shape == (60000,) * 3


def test_files_by_their_name(tmp_path, shells):
    chiaro.write(chiaro.Volume(shells), tmp_path / "s.nrrd")
    lazy = chiaro.Volume.lazy(tmp_path / "s.nrrd", memory="32M")
    assert lazy.format == "NRRD" and lazy.shape == shells.shape
    assert picture(lazy)[1]["levels"] == len(lazy.levels)
    assert chiaro.Volume.lazy("sample:shells:4096").shape == (4096,) * 3
    with pytest.raises(chiaro.InputError):
        chiaro.Volume.lazy(tmp_path / "none.nrrd")
    with pytest.raises(ValueError, match="a file says where it lies"):
        chiaro.Volume.lazy(tmp_path / "s.nrrd", spacing=2)
    chiaro.write(chiaro.Volume(shells[:8, :8, :8]), tmp_path / "z.nrrd", encoding="gzip")
    with pytest.raises(ValueError, match="read as a whole"):
        chiaro.Volume.lazy(tmp_path / "z.nrrd")


def test_a_part_that_cannot_be_read_is_a_note(shells, caplog):
    class Broken(Counting):
        def __getitem__(self, box):
            if box[0].start >= 192:
                raise OSError("the disk is gone")
            return super().__getitem__(box)

    lazy = chiaro.Volume.lazy([Broken(shells, (64, 64, 64)), shells[1::2, 1::2, 1::2]], memory="32M", name="broken")
    _, paging = picture(lazy, size=(640, 480), zoom=2)
    assert paging["level"] == 0 and any("OSError: the disk is gone" in fault for fault in paging["faults"])
    assert any("broken: reading a part of it fails" in record.getMessage() for record in caplog.records)


def test_the_viewer_reads_what_is_looked_at(shells):
    counted = Counting(shells, (64, 64, 64))
    coarse = Counting(shells[1::2, 1::2, 1::2], (64, 64, 64))
    lazy = chiaro.Volume.lazy([counted, coarse], memory="32M", name="seen")
    view = chiaro.view(lazy, threads=1, **PICTURE)
    try:
        until = time.time() + 60
        while coarse.read == 0 and time.time() < until:
            time.sleep(0.05)
        assert coarse.read > 0 and counted.read == 0  # the whole level is a coarse one
        view.camera.azimuth = 70
        np.testing.assert_array_equal(np.asarray(view.snapshot()), picture(lazy, azimuth=70)[0])
        assert view.scene.volume is lazy
    finally:
        view.stop()


def test_misuse_is_a_sentence(shells):
    with pytest.raises(ValueError, match="memory='2X'"):
        chiaro.Volume.lazy(shells, memory="2X")
    with pytest.raises(ValueError, match="finest_level=9"):
        chiaro.Volume.lazy(shells, finest_level=9)
    with pytest.raises(ValueError, match="three axes"):
        chiaro.Volume.lazy(shells[0])
    with pytest.raises(ValueError, match="each must be smaller"):
        chiaro.Volume.lazy([shells, shells])
    with pytest.raises(TypeError, match="of one type"):
        chiaro.Volume.lazy([shells, shells[::2, ::2, ::2].astype("u2")])
    with pytest.raises(TypeError, match="give an array"):
        chiaro.Volume.lazy({})
    lazy = chiaro.Volume.lazy(shells)
    with pytest.raises(ValueError, match=r"take level\(n\) of it, n from 0 to"):
        lazy.array
    with pytest.raises(ValueError, match=r"levels 0 to"):
        lazy.level(99)
    assert "256 × 256 × 256 uint8" in repr(lazy)

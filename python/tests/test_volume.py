import gc
import logging
import weakref

import chiaro
import numpy as np
import pytest

STORED = ["uint8", "int8", "uint16", "int16", "uint32", "int32", "uint64", "int64", "float32", "float64"]


def address(array):
    return array.__array_interface__["data"][0]


@pytest.mark.parametrize("dtype", STORED)
def test_memory_is_borrowed_for_every_stored_type(dtype, blob):
    a = blob.astype(dtype)
    v = chiaro.Volume(a)
    assert address(v.array) == address(a) and v.dtype == a.dtype and v.shape == a.shape and not v.notes
    np.testing.assert_array_equal(v.array, a)
    assert not v.array.flags.writeable


def test_fortran_order_is_borrowed_as_its_transpose(blob, picture):
    a = np.asfortranarray(blob)
    v = chiaro.Volume(a, spacing=(3, 2, 1), origin=(5, 6, 7))
    assert address(v.array) == address(a) and v.shape == a.shape and v.spacing == (3, 2, 1) and v.origin == (5, 6, 7)
    np.testing.assert_array_equal(v.array, a)
    same = chiaro.Volume(np.ascontiguousarray(a), spacing=(3, 2, 1), origin=(5, 6, 7))
    np.testing.assert_allclose(v.affine, same.affine)
    difference = np.abs(picture(v).astype(int) - picture(same))
    assert difference.max() <= 6 and difference.mean() < 0.2


def test_the_array_is_unchanged_by_all_that_reads_it(blob, small, tmp_path):
    a = blob.copy()
    v = chiaro.Volume(a)
    chiaro.render(v, **small)
    s = chiaro.Session(v, **small)
    s.image(), s.image(azimuth=80)
    del s
    chiaro.illuminate(v, threads=1)
    chiaro.write(v, tmp_path / "a.nrrd")
    v.statistics, v.histogram(), v._repr_html_()
    assert (a == blob).all()


def test_an_array_may_be_read_only_and_is_kept(blob, picture):
    a = blob.copy()
    expected = picture(a)
    a.flags.writeable = False
    v = chiaro.Volume(a)
    lives = weakref.ref(a)
    del a
    gc.collect()
    assert lives() is not None
    np.testing.assert_array_equal(picture(v), expected)
    del v
    gc.collect()
    chiaro.render(blob, size=(8, 8))  # the last picture's session goes
    gc.collect()
    assert lives() is None


def test_after_changed_a_session_reads_it_again(blob, small):
    a = blob.copy()
    s = chiaro.Session(a, transfer="gray", window=(500, 1000), **small)
    first, before = np.asarray(s.image()).copy(), s.volume.statistics
    a[:, :, 14:] = 0
    np.testing.assert_array_equal(np.asarray(s.image()), first)
    s.volume.changed()
    assert (np.asarray(s.image()) != first).any()
    assert s.volume.statistics != before


@pytest.mark.parametrize("dtype, to", [("bool", "uint8"), ("float16", "float32")])
def test_bool_and_float16_are_converted_and_said(dtype, to, blob, caplog):
    a = (blob > 500).astype(dtype)
    with caplog.at_level(logging.INFO, "chiaro"):
        v = chiaro.Volume(a)
    assert v.dtype == to and v.notes == [f"an array of {dtype} is copied as {to}"] and v.notes[0] in caplog.text
    np.testing.assert_array_equal(v.array, a.astype(to))


@pytest.mark.parametrize(
    "make, note",
    [
        (lambda a: a.astype(">u2"), "a big-endian array is copied in the machine's byte order"),
        (lambda a: a[::2, :, ::-1], "an array with gaps between its voxels is copied"),
        (lambda a: np.broadcast_to(a[:1], a.shape), "an array with gaps between its voxels is copied"),
        (lambda a: np.frombuffer(b"\0" + a.tobytes(), "u1")[1:].view("<u2").reshape(a.shape), "an array that does not begin at an address for its type is copied"),
    ],
)
def test_what_cannot_be_borrowed_is_copied_and_said(make, note, blob):
    a = make(blob)
    v = chiaro.Volume(a)
    assert v.notes == [note]
    np.testing.assert_array_equal(v.array, a)


@pytest.mark.parametrize(
    "make, kind, sentence",
    [
        (lambda a: a.astype(complex), TypeError, "an array of complex128: complex numbers have no order; take abs(array) or array.real"),
        (lambda a: a.astype(object), TypeError, "an array of Python objects: convert it first, as in array.astype('float32')"),
        (lambda a: np.zeros(a.shape, [("hu", "i2"), ("label", "u1")]), TypeError, "an array with fields ('hu', 'label'): pick one, as in array['hu']"),
        (lambda a: a[0], ValueError, "an array of shape (24, 28): a volume has three axes, z, y, x"),
        (lambda a: a[None], ValueError, "an array of shape (1, 20, 24, 28): a volume has three axes, z, y, x; give one moment of it, as in array[0], or channels=True"),
        (lambda a: a[:0], ValueError, "an array of shape (0, 24, 28): it has no voxels"),
        (lambda a: np.ma.masked_less(a, 9), TypeError, "a masked array: fill it first, as in array.filled(0)"),
        (lambda a: a.astype("U4"), TypeError, None),
        (lambda a: a.astype("m8[s]"), TypeError, None),
        (lambda a: a.astype(np.longdouble), TypeError, None),
        (lambda a: 5, ValueError, "an array of shape (): a volume has three axes, z, y, x"),
    ],
)
def test_every_wrong_array_is_refused_in_a_sentence(make, kind, sentence, blob):
    with pytest.raises(kind) as refused:
        chiaro.Volume(make(blob))
    said = str(refused.value)
    assert (said == sentence if sentence else said.startswith("an array of ")) and "\n" not in said


@pytest.mark.parametrize(
    "place",
    [
        {"spacing": (1, 2)},
        {"spacing": (1, 0, 1)},
        {"spacing": (1, np.nan, 1)},
        {"direction": np.zeros((3, 3))},
        {"direction": np.eye(2)},
        {"frame": "XYZ"},
        {"affine": np.eye(3)},
        {"affine": np.zeros((4, 4))},
        {"origin": (1, 2)},
    ],
)
def test_places_that_are_none_are_refused(place, blob):
    with pytest.raises(ValueError):
        chiaro.Volume(blob, **place)


def test_where_it_lies(blob):
    turn = np.array([[0, -1, 0], [1, 0, 0], [0, 0, 1]])
    v = chiaro.Volume(blob, spacing=(3, 2, 1), origin=(10, 20, 30), direction=turn, frame="LPS")
    assert v.spacing == (3, 2, 1) and v.origin == (10, 20, 30) and v.frame == "LPS"
    expected = np.diag([-1, -1, 1, 1]) @ np.array([[0, -2, 0, 10], [1, 0, 0, 20], [0, 0, 3, 30], [0, 0, 0, 1]])
    np.testing.assert_allclose(v.affine, expected)
    again = chiaro.Volume(blob, affine=v.affine)
    np.testing.assert_allclose(again.affine, v.affine)
    assert again.frame == "RAS"


def test_values_statistics_and_words(blob):
    v = chiaro.Volume(blob, name="blob")
    s = v.statistics
    assert s["min"] == blob.min() and s["max"] == blob.max() and s["nonfinite"] == 0
    counts, edges = v.histogram()
    assert counts.sum() == blob.size and len(edges) == 257 and edges[0] == blob.min() and edges[-1] == blob.max()
    center, width = v.window
    assert center - width / 2 == s["p1"] and center + width / 2 == s["p999"]
    assert repr(v) == "<chiaro.Volume 'blob': 20 × 24 × 28 uint16, 1 × 1 × 1 mm>"
    html = v._repr_html_()
    assert html.count("data:image/png;base64,") == 3 and "20 × 24 × 28" in html
    assert (v.to_numpy() == blob).all() and v.to_numpy().flags.writeable


def test_read_and_write_round_trip(blob, tmp_path, tool):
    v = chiaro.Volume(blob, spacing=(3, 2, 1), origin=(10, 20, 30), frame="LPS")
    for encoding in ("raw", "gzip"):
        chiaro.write(v, tmp_path / "a.nrrd", encoding=encoding)
        back = chiaro.read(tmp_path / "a.nrrd")
        np.testing.assert_array_equal(back.array, blob)
        np.testing.assert_allclose(back.affine, v.affine)
        assert back.format == "NRRD" and back.frame == "LPS"
    blob.tofile(tmp_path / "b.raw")
    raw = chiaro.read(tmp_path / "b.raw", raw_size=(28, 24, 20), raw_type="uint16", raw_spacing=(1, 2, 3))
    np.testing.assert_array_equal(raw.array, blob)
    assert raw.spacing == (3, 2, 1)
    tool("info", tmp_path / "a.nrrd")


def test_files_that_cannot_be_read_or_written_say_so(blob, tmp_path):
    (tmp_path / "bad.nrrd").write_text("NRRD0004\nsizes: x\n")
    with pytest.raises(chiaro.InputError) as refused:
        chiaro.read(tmp_path / "bad.nrrd")
    assert "bad.nrrd" in str(refused.value) and refused.value.code == 3
    with pytest.raises(chiaro.InputError):
        chiaro.read(tmp_path / "missing.nrrd")
    with pytest.raises(ValueError):
        chiaro.write(blob, tmp_path / "a.xyz")
    with pytest.raises(chiaro.OutputError):
        chiaro.write(blob, tmp_path / "no" / "folder.nrrd")
    assert not (tmp_path / "no").exists()


def test_samples():
    names = dict(chiaro.samples())
    assert "ball" in names
    assert chiaro.sample("ball", 16).shape == (16, 16, 16)
    with pytest.raises(ValueError, match="did you mean 'ball'"):
        chiaro.sample("bal")

"""Volumes that change with time: a moment has the range and the camera of the first, from a file and from an array."""

import numpy as np
import pytest

import chiaro


@pytest.fixture
def beat():
    z, y, x = np.mgrid[:16, :16, :16] - 7.5
    r = np.sqrt(x * x + y * y + z * z)
    return np.stack([np.clip(5 + t - r, 0, 1) * (80 + 40 * t) for t in range(3)]).astype(np.uint8)


def test_of_an_array_and_of_a_file_are_the_tools(beat, tool, tmp_path):
    beat.tofile(tmp_path / "beat.raw")
    (tmp_path / "beat.nhdr").write_text(
        "NRRD0005\ntype: uint8\ndimension: 4\nsizes: 16 16 16 3\nkinds: domain domain domain time\nspacings: 1 1 1 2\n"
        "encoding: raw\ndata file: beat.raw\n"
    )
    look = dict(size=(48, 40), transfer="gray", lighting="none")
    for t in (0, 2):
        picture = tmp_path / f"{t}.png"
        tool("render", str(tmp_path / "beat.nhdr"), "-o", str(picture), "--time", str(t), "--size", "48x40", "--transfer", "gray", "--lighting", "none")
        expected = np.asarray(chiaro.read_image(picture))
        volume = chiaro.read(tmp_path / "beat.nhdr", time=t)
        assert volume.moments == {"count": 3, "shown": t, "times": [0, 2, 4], "unit": ""}
        image = chiaro.render(volume, **look)
        assert np.array_equal(np.asarray(image), expected)
        assert image.stats["volume"]["moments"]["shown"] == t
        assert np.array_equal(np.asarray(chiaro.render(chiaro.Volume(beat, time=t), **look)), expected)
        session = chiaro.Session(str(tmp_path / "beat.nhdr"), **look)
        session.time = t
        assert np.array_equal(np.asarray(session.image()), expected)


def test_refuses_what_is_no_moment(beat):
    with pytest.raises(ValueError, match="moments 0 to 2"):
        chiaro.Volume(beat, time=3)
    with pytest.raises(ValueError, match="must be"):
        chiaro.Volume(beat[0], time=0)

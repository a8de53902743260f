"""Films of keyframes are those of the tool."""
import json

import numpy as np
import pytest

import chiaro


@pytest.fixture
def film(tmp_path):
    base = chiaro.Scene("sample:shells:40", lighting="spao", azimuth=10)
    keys = [{"at": at, "scene": json.loads(base.with_(azimuth=azimuth, elevation=elevation).to_json())} for at, azimuth, elevation in ((0, 10, 5), (0.5, 80, 30))]
    path = tmp_path / "film.json"
    path.write_text(json.dumps({"film": 1, "fps": 8, "size": [64, 48], "keys": keys}))
    return path


def test_frames_are_those_of_the_tool(film, tmp_path, tool):
    tool("render", "--film", film, "-o", tmp_path / "f-{frame:02}.png", "--quiet")
    frames = [np.asarray(image) for image in chiaro.animate(film)]
    assert len(frames) == 5 and frames[0].shape[:2] == (48, 64)
    for i, frame in enumerate(frames):
        np.testing.assert_array_equal(frame, np.asarray(chiaro.read_image(tmp_path / f"f-{i:02}.png")))


def test_keys_may_be_scenes_of_an_array(film):
    volume = chiaro.Volume(chiaro.sample("shells", 40).array)
    scene = chiaro.Scene(volume, lighting="spao", transfer=[(60, "black", 0), (200, "orange", 0.6)])
    frames = list(chiaro.animate([(0, scene.with_(azimuth=10)), (0.5, scene.with_(azimuth=80))], fps=4, size=(32, 24), threads=1))
    assert len(frames) == 3
    middle = np.asarray(frames[1]).astype(int)
    assert np.abs(middle - np.asarray(frames[0])).max() > 20 and np.abs(middle - np.asarray(frames[2])).max() > 20


def test_misuse_is_a_sentence(film):
    scene = chiaro.Scene("sample:shells:16")
    with pytest.raises(ValueError, match="must rise"):
        chiaro.animate([(1, scene), (0, scene)])
    with pytest.raises(ValueError, match="1 to 1000 keys"):
        chiaro.animate([])
    with pytest.raises(ValueError, match="one volume"):
        chiaro.animate([(0, scene), (1, chiaro.Scene("sample:ball:16"))])
    with pytest.raises(TypeError, match="settings are those of the keyframes"):
        chiaro.animate(film, azimuth=3)
    with pytest.raises(chiaro.InputError):
        chiaro.animate("none.json")

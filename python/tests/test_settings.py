"""Settings and scenes: every one that the tool has, by its name, both ways."""

import inspect
import json
import pickle

import chiaro
import numpy as np
import pytest
from chiaro import _settings

TABLE = _settings.table()

# A value other than the default for every setting, as one would write it in Python.
OTHER = {
    "raw_size": (4, 5, 6), "raw_type": "int16", "raw_spacing": (1, 2, 3), "raw_endian": "big", "raw_offset": 12, "series": "2",
    "rescale": (2, -1000), "time": 3, "channels_as": "rgb", "transfer": "gray", "window": (40, 400), "threshold": (10, 20), "opacity_scale": 0.5, "opacity_unit": 2,
    "opacity_unit_mm": 2, "camera_matrix": (0.5, 0, 0, 1, 0, 0.25, 0, 2.5, 0, 0, -0.125, 0, 0, 0, 0, 1), "size": (320, 200), "mode": "mip", "iso": [100, (120, "red")], "background": "white",
    "clip_box": (0, 1, 0, 0.5, 0, 1), "clip_plane": [(0, 0, 1, 10)], "azimuth": 10, "elevation": -5, "roll": 3, "zoom": 2, "fov": 40,
    "up": (0, 1, 0), "projection": "orthographic", "view": "left", "eye": (1, 2, 3), "target": (4, 5, 6), "light": [(10, 20, "red"), "headlight", "at:1,2,3"],
    "probe": "sky", "hist_effects": "ao", "glow": "1:2=3", "cache": "none", "sh_sampling": "jittered:4", "bounces": 3,
    "reference_quantity": "ao", "probe_exposure": 1.5, "labels": "sample:organs", "label_table": "totalsegmentator",
}


def other(row):
    if row["name"] in OTHER:
        return OTHER[row["name"]]
    if row["kind"] == "switch":
        return not row["default"]
    if row["choices"]:
        choices = [int(c) for c in row["choices"]] if row["kind"] == "integer" else row["choices"]
        return next(c for c in choices if c != row["default"])
    if row["kind"] == "integer":
        return 7 if row["default"] != 7 else 8
    assert row["kind"] == "number", row
    return 0.25 if row["default"] != 0.25 else 0.5


@pytest.mark.parametrize("name", TABLE)
def test_every_setting_can_be_given_read_and_kept(name):
    row = TABLE[name]
    given = {name: other(row)}
    if name in ("eye", "target"):
        given = {"eye": OTHER["eye"], "target": OTHER["target"]}
    if name == "iso":
        given["mode"] = "iso"
    if name == "label_table":
        given["labels"] = OTHER["labels"]
    if name == "probe_background":
        given["probe"] = "sky"
    scene = chiaro.Scene("sample:ball", **given)
    value = getattr(scene, name)
    assert value != row["default"], (name, value)
    group = row["group"].lower().replace(" ", "_")
    if group in _settings.grouped():
        assert getattr(getattr(scene, group), name) == value
    assert getattr(chiaro.Scene("sample:ball", **{**given, name: value}), name) == value
    if row["optional"] and name not in ("eye", "target"):
        assert getattr(scene.with_(**{name: None}), name) == row["default"]
    method = row["methods"].split("|")[0]
    kept = scene.with_(lighting=method) if method else scene
    back = chiaro.Scene.from_json(kept.to_json(), "/")
    if not row["key"].startswith(("volume.raw", "volume.series", "volume.rescale")) and name not in ("cache",):
        assert getattr(back, name) == getattr(kept, name)


def test_names_are_the_tools_flags(tool):
    flags = {line.split("`")[1].split(" ")[0] for line in tool("--list-options").splitlines() if line.startswith("| `--")}
    assert flags == {"--" + name.replace("_", "-") for name in TABLE}


def test_defaults_are_the_tools():
    scene = chiaro.Scene("sample:ball")
    for name, row in TABLE.items():
        assert getattr(scene, name) == row["default"], name


@pytest.mark.parametrize(
    "settings, kind, said",
    [
        ({"lightning": "spao"}, TypeError, "render() got an unknown setting 'lightning'; did you mean 'lighting'?"),
        ({"lighting": "transprot"}, ValueError, "lighting=transprot: must be none, spao, visibility, histogram, transport, reference; did you mean 'transport'?"),
        ({"step": 0}, ValueError, "step=0: must be 0.001 to 100 voxels"),
        ({"step": "fine"}, TypeError, "step='fine': must be a number, not text"),
        ({"step": None}, TypeError, "step=None: must be given a value (default 0.5)"),
        ({"step": [1]}, TypeError, None),
        ({"step": True}, TypeError, None),
        ({"samples_per_pixel": 1.5}, TypeError, "samples_per_pixel=1.5: must be a whole number"),
        ({"no_skip_empty": 1}, TypeError, "no_skip_empty=1: must be True or False"),
        ({"size": (0, 10)}, ValueError, None),
        ({"size": (10, "x")}, ValueError, None),
        ({"window": (1, {})}, TypeError, None),
        ({"view": "left", "eye": (1, 2, 3)}, ValueError, None),
        ({"background": "whit"}, ValueError, None),
        ({"probe": "stdio"}, ValueError, None),
        ({"transfer": "grey1"}, ValueError, None),
        ({"device": "gpu"}, ValueError, "device='gpu': must be auto, cpu or cuda:N"),
        ({"threads": 5000}, ValueError, None),
    ],
)
def test_wrong_settings_are_refused_in_a_sentence(settings, kind, said):
    with pytest.raises(kind) as refused:
        chiaro.render("sample:ball:16", **{"size": (16, 12), **settings})
    assert "\n" not in str(refused.value)
    if said:
        assert str(refused.value) == said
    if isinstance(refused.value, chiaro.Error):
        assert refused.value.code == 2


def test_scenes_never_change_and_go_both_ways(tmp_path, tool):
    scene = chiaro.Scene("sample:ball:24", lighting="visibility", probe="sky", size=(40, 30))
    turned = scene.with_(azimuth=80)
    assert scene.azimuth == 35 and turned.azimuth == 80 and turned.camera.azimuth == 80 and turned.lighting == "visibility"
    with pytest.raises(AttributeError, match="never changes"):
        scene.azimuth = 1
    with pytest.raises(AttributeError, match="did you mean 'azimuth'"):
        scene.camera.azimut
    assert scene == chiaro.Scene.from_json(scene.to_json()) and scene != turned and len({scene, turned}) == 2
    assert pickle.loads(pickle.dumps(turned)) == turned
    turned.save(tmp_path / "scene.json")
    assert chiaro.Scene.read(tmp_path / "scene.json") == turned
    tool("render", "--scene", tmp_path / "scene.json", "-o", tmp_path / "tool.png", "--quiet")
    # A picture tells what was found, too: the ball that the camera fits, and the exposure.
    seen = chiaro.Scene.from_picture(tmp_path / "tool.png")
    assert seen != turned and seen.probe_exposure == 0 and "centre" in json.dumps(json.loads(seen.to_json())["camera"])
    assert seen.with_(fit="visible", probe_exposure="auto") == turned
    chiaro.render(turned).save(tmp_path / "python.png")
    assert (tmp_path / "python.png").read_bytes() == (tmp_path / "tool.png").read_bytes()
    assert "azimuth=80.0" in repr(turned) and "elevation" not in repr(turned)
    with pytest.raises(chiaro.InputError):
        chiaro.Scene.from_json("{")


def test_unknown_keys_are_told(caplog):
    text = json.dumps({**json.loads(chiaro.Scene("sample:ball").to_json()), "colour": 1})
    chiaro.Scene.from_json(text)
    assert "unknown key colour" in caplog.text


def test_help_tells_every_setting():
    said = inspect.getdoc(chiaro.render)
    for name, row in TABLE.items():
        assert f"{name} = " in said and row["sentence"] in said


def test_transfer_and_probe_of_other_kinds():
    function = chiaro.TransferFunction([(0, "black", 0), (255, "white", 0.5)])
    scene = chiaro.Scene("sample:ball:16", transfer=function)
    np.testing.assert_allclose(scene.transfer_function.points, [[0, 0, 0, 0, 0], [255, 1, 1, 1, 0.5]])
    assert chiaro.Scene("sample:ball:16", transfer=[(0, "black", 0), (255, "white", 0.5)]) == scene
    assert scene.with_(transfer="gray").transfer_function is None
    turned = chiaro.Scene("sample:ball", probe=chiaro.Probe("sky").rotated(30).exposed(1))
    assert (turned.probe, turned.probe_rotation, turned.probe_exposure) == ("sky", 30, 1)

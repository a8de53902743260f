"""render, Session, light as data, comparisons, films: against the tool and against themselves."""

import logging
import shutil

import chiaro
import numpy as np
import pytest

LIGHTS = [{"lighting": "none"}, {"lighting": "spao"}, {"lighting": "visibility", "probe": "sky"}, {"lighting": "transport", "transport_grid": 16},
          {"lighting": "reference", "reference_rays": 2}, {"lighting": "histogram", "hist_clusters": 16, "cache": "none"},
          {"mode": "iso", "iso": 500}, {"mode": "mip"}, {"background": "transparent"}]


def flags(settings):
    return [f"--{name.replace('_', '-')}={value}" for name, value in settings.items()]


@pytest.mark.parametrize("settings", LIGHTS, ids=lambda s: "-".join(map(str, s.values())))
def test_a_picture_is_the_tools_byte_for_byte(settings, blob, tmp_path, tool):
    chiaro.write(chiaro.Volume(blob, spacing=(1.5, 1, 1)), tmp_path / "blob.nrrd")
    path = tmp_path / "blob.nrrd"
    tool("render", path, "-o", tmp_path / "tool.png", "--size", "80x60", "--quiet", *flags(settings))
    image = chiaro.render(path, size=(80, 60), **settings)
    image.save(tmp_path / "python.png")
    assert (tmp_path / "python.png").read_bytes() == (tmp_path / "tool.png").read_bytes()
    np.testing.assert_array_equal(np.asarray(chiaro.render(chiaro.Volume(blob, spacing=(1.5, 1, 1)), size=(80, 60), **settings)), np.asarray(image))
    tool("render", path, "-o", tmp_path / "tool.exr", "--size", "80x60", "--quiet", *flags(settings))
    image.save(tmp_path / "python.exr")
    assert (tmp_path / "python.exr").read_bytes() == (tmp_path / "tool.exr").read_bytes()
    np.testing.assert_array_equal(chiaro.read_image(tmp_path / "tool.exr").linear, image.linear)


def test_an_image_is_numpy_and_a_file(blob, tmp_path, small):
    image = chiaro.render(blob, **small)
    pixels = np.asarray(image)
    assert pixels.shape == (48, 64, 3) and pixels.dtype == np.uint8 and (image.width, image.height) == (64, 48)
    assert image.linear.shape == (48, 64, 4) and image.linear.dtype == np.float32
    assert image._repr_png_()[1:4] == b"PNG" and repr(image) == "<chiaro.Image 64 × 48>"
    assert np.asarray(chiaro.render(blob, background="transparent", **small)).shape == (48, 64, 4)
    image.save(tmp_path / "a.png")
    back = chiaro.read_image(tmp_path / "a.png")
    np.testing.assert_array_equal(np.asarray(back), pixels)
    assert back.scene == chiaro.Scene.from_json(image.scene.to_json())
    with pytest.raises(ValueError, match="must end in .png or .exr"):
        image.save(tmp_path / "a.jpg")
    with pytest.raises(ValueError, match="no linear light"):
        chiaro.render(blob, color="display", **small).save(tmp_path / "a.exr")
    stats = image.stats
    assert [s["name"] for s in stats["stages"]][:2] == ["measure", "upload"] and stats["samples"] > 0 and stats["threads"] == 1
    assert stats["settings"]["image"]["size"] == [64, 48]


def test_depth_is_the_distance_to_what_is_seen(small):
    z, y, x = np.mgrid[:33, :33, :33]
    ball = np.sqrt((x - 16) ** 2 + (y - 16) ** 2 + (z - 16) ** 2).astype(np.float32)
    front = {"mode": "iso", "iso": 10, "azimuth": 0, "elevation": 0, "projection": "orthographic"}
    image = chiaro.render(ball, **front, **small)
    depth = image.depth
    assert depth.shape == (48, 64) and np.isinf(depth[0, 0])
    middle = depth[23:25, 31:33].mean()
    edge = depth[23:25][np.isfinite(depth[23:25])].max()
    assert 7 < edge - middle < 10.5
    eager = chiaro.render(ball, depth=True, **front, **small)
    with pytest.raises(ValueError, match="depth=True"):
        first = chiaro.render(ball, **small)
        chiaro.render(ball, **small)
        first.depth
    np.testing.assert_array_equal(eager.depth, depth)


def test_a_session_redoes_what_lies_right_of_a_change(blob, small):
    s = chiaro.Session(blob, **small)
    s.image()

    def redone(**settings):
        return [stage["name"] for stage in s.image(**settings).stats["stages"] if stage["seconds"] > 0 and " " not in stage["name"]]

    assert redone() == []
    s.camera.azimuth += 10
    assert s.azimuth == 45 and redone() == ["raycast", "develop"]
    s.transfer = "gray"
    assert redone()[0] == "classify"
    s.background = "white"
    assert redone() == ["develop"]
    np.testing.assert_array_equal(np.asarray(s.image()), np.asarray(chiaro.render(s.scene)))
    assert (s.scene.azimuth, s.scene.transfer, s.scene.background) == (45, "gray", chiaro.Scene("sample:ball", background="white").background)
    with pytest.raises(AttributeError, match="did you mean 'azimuth'"):
        s.azimut = 3
    with pytest.raises(AttributeError, match="did you mean"):
        s.camera.azimut = 3
    with pytest.raises(ValueError):
        s.step = 0
    assert s.step == 0.5
    s.volume = blob[::-1].copy()
    assert redone()[:2] == ["measure", "upload"]
    assert s.transfer_function.name == "gray"
    assert s.camera.zoom == 1 and "zoom=1.0" in repr(s.camera)


def test_older_pictures_of_a_session_keep_their_light(blob, small):
    s = chiaro.Session(blob, **small)
    first = s.image()
    expected = chiaro.render(blob, **small).linear.copy()
    s.image(azimuth=200)
    np.testing.assert_array_equal(first.linear, expected)
    with pytest.raises(ValueError, match="depth=True"):
        first.depth


def test_refine_ends_in_the_picture(blob, small):
    s = chiaro.Session(blob, lighting="reference", reference_rays=8, **small)
    images = list(s.refine())
    assert len(images) >= 3
    final = np.asarray(images[-1]).astype(int)
    np.testing.assert_array_equal(final, np.asarray(chiaro.render(blob, lighting="reference", reference_rays=8, **small)))
    errors = [np.abs(np.asarray(image) - final).mean() for image in images]
    assert errors[0] > errors[-1] == 0 and errors[0] >= errors[-2]
    for _ in s.refine(azimuth=3):
        break  # leaves the work
    np.testing.assert_array_equal(np.asarray(s.image()), np.asarray(chiaro.render(s.scene)))
    assert s.scene.azimuth == 3


def test_light_as_data(blob, tmp_path, tool):
    v = chiaro.Volume(blob, spacing=(1.5, 1, 1), origin=(3, 4, 5))
    chiaro.write(v, tmp_path / "blob.nrrd")
    tool("illuminate", tmp_path / "blob.nrrd", "-o", tmp_path / "ao.nrrd", "--quiet")
    field = chiaro.illuminate(v)
    assert isinstance(field, chiaro.Field) and field.array.dtype == np.float32 and field.shape == v.shape
    np.testing.assert_array_equal(field.array, chiaro.read(tmp_path / "ao.nrrd").array)
    np.testing.assert_allclose(field.affine, v.affine)
    assert 0 <= field.array.min() < field.array.max() <= 1 and field.stages
    mean = chiaro.illuminate(v, lighting="transport", transport_grid=8)
    assert mean.array.ndim == 4 and mean.array.shape[3] == 3
    for wrong in ({"lighting": "none"}, {"mode": "mip"}):
        with pytest.raises(ValueError):
            chiaro.illuminate(v, **wrong)


def test_compare_is_the_tools(blob, tmp_path, tool, small):
    import json

    a, b = chiaro.render(blob, **small), chiaro.render(blob, azimuth=40, **small)
    a.save(tmp_path / "a.png"), b.save(tmp_path / "b.png")
    told = json.loads(tool("compare", tmp_path / "a.png", tmp_path / "b.png", "--json"))
    found = chiaro.compare(a, b)
    for name, value in found.items():
        assert value == pytest.approx(told[name], rel=1e-5), name
    assert found.rmse == found["rmse"] and chiaro.compare(tmp_path / "a.png", a).rmse == 0
    assert chiaro.compare(a.linear, b.linear).psnr > 10
    v = chiaro.Volume(blob)
    assert chiaro.compare(v, chiaro.Volume(blob + 1)).bias == 1
    with pytest.raises(chiaro.InputError):
        chiaro.compare(a, chiaro.render(blob, size=(10, 10)))
    with pytest.raises(TypeError, match="is no picture"):
        chiaro.compare(a, np.zeros(3))
    with pytest.raises(TypeError, match="equal kinds"):
        chiaro.compare(np.asarray(a), a.linear)


def test_methods_and_the_ground_truth(blob, small):
    truth = chiaro.reference(blob, reference_rays=4, **small)
    assert truth.scene.lighting == "reference" and truth.stats["paths"]["samples"] == 4 and truth.stats["paths"]["noise"] > 0
    rows = chiaro.compare_methods(blob, ["none", "spao"], reference_rays=8, **small)
    assert [row["method"] for row in rows] == ["none", "spao"] and rows[0]["linear"].shape == (48, 64, 4)
    assert all(row["rmse"] > 0 for row in rows)


def test_a_turntable_is_the_tools(blob, tmp_path, tool):
    chiaro.write(blob, tmp_path / "blob.nrrd")
    tool("render", tmp_path / "blob.nrrd", "-o", tmp_path / "t-{frame}.png", "--frames", "3", "--size", "40x30", "--quiet")
    for k, image in enumerate(chiaro.turntable(tmp_path / "blob.nrrd", 3, size=(40, 30))):
        image.save(tmp_path / "python.png")
        assert (tmp_path / "python.png").read_bytes() == (tmp_path / f"t-{k}.png").read_bytes()
    assert k == 2
    for wrong in ({"frames": 0}, {"frames": 3, "view": "left"}):
        with pytest.raises(ValueError):
            chiaro.turntable(chiaro.Volume(blob, frame="RAS"), **wrong)


@pytest.mark.skipif(not shutil.which("ffmpeg"), reason="no ffmpeg")
def test_films(blob, tmp_path):
    import subprocess

    for name in ("a.mp4", "a.gif"):
        assert chiaro.save_video(tmp_path / name, chiaro.turntable(blob, 5, size=(41, 31)), fps=10) == 5
    counted = subprocess.run(["ffprobe", "-v", "error", "-count_frames", "-show_entries", "stream=nb_read_frames,width", "-of", "csv=p=0", tmp_path / "a.mp4"], capture_output=True, text=True)
    assert counted.stdout.strip() == "42,5"
    with pytest.raises(ValueError, match="at least one"):
        chiaro.save_video(tmp_path / "b.mp4", [])
    with pytest.raises(ValueError, match="picture 1 has"):
        chiaro.save_video(tmp_path / "b.mp4", [np.zeros((8, 8, 3), "u1"), np.zeros((9, 8, 3), "u1")])
    with pytest.raises(chiaro.OutputError):
        chiaro.save_video(tmp_path / "b.nothing", [np.zeros((8, 8, 3), "u1")])
    assert sorted(p.name for p in tmp_path.iterdir()) == ["a.gif", "a.mp4"]


def test_a_film_without_ffmpeg_says_so(monkeypatch, tmp_path):
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(chiaro.OutputError, match="apt install ffmpeg"):
        chiaro.save_video(tmp_path / "a.mp4", [np.zeros((8, 8, 3), "u1")])


def test_notes_go_to_the_log(blob, caplog, small):
    with caplog.at_level(logging.INFO, "chiaro"):
        chiaro.render(blob, **small)
    assert "looks like" in caplog.text
    a = blob.astype("f4")
    a[0, 0, 0] = np.nan
    caplog.clear()
    chiaro.write(a, "/tmp/chiaro-nan.nrrd")
    with caplog.at_level(logging.INFO, "chiaro"):
        chiaro.read("/tmp/chiaro-nan.nrrd")
    assert "not finite" in caplog.text or "NaN" in caplog.text or "finite" in caplog.text


def test_progress_is_told_once(blob, capfd, small):
    heard = []
    chiaro.render(blob, progress=lambda stage, fraction: heard.append((stage, fraction)), lighting="reference", reference_rays=64, **{**small, "size": (200, 150)})
    assert heard and all(0 <= fraction <= 1 for _, fraction in heard)
    assert capfd.readouterr() == ("", "")
    with pytest.raises(RuntimeError, match="enough"):
        def stop(*_):
            raise RuntimeError("enough")
        chiaro.render(blob, progress=stop, lighting="reference", reference_rays=65536, **{**small, "size": (640, 480)})
    chiaro.set_progress(lambda stage, fraction: heard.append(stage))
    chiaro.set_progress("auto")
    with pytest.raises(ValueError):
        chiaro.set_progress("loud")

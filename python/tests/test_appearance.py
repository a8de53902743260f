import chiaro
import numpy as np
import pytest


def test_presets_files_and_points(tmp_path, blob):
    names = [name for name, _, _ in chiaro.list_presets()]
    assert "gray" in names and "viridis" in names
    v = chiaro.Volume(blob)
    gray = chiaro.TransferFunction("gray", v)
    assert gray.points[0, 0] < gray.points[-1, 0] <= blob.max()
    stretched = chiaro.TransferFunction("gray", range=(100, 300))
    assert stretched.points[0, 0] == 100 and stretched.points[-1, 0] == 300
    for format in ("chiaro", "paraview"):
        stretched.save(tmp_path / f"{format}.json", format=format)
        back = chiaro.TransferFunction(tmp_path / f"{format}.json")
        np.testing.assert_allclose(back.points, stretched.points, atol=1e-6)
    with pytest.raises(ValueError, match="did you mean"):
        chiaro.TransferFunction("grey1")
    with pytest.raises(ValueError):
        stretched.save(tmp_path / "a", format="xml")


def test_a_name_waits_for_its_data(blob, picture):
    waiting = chiaro.TransferFunction("gray")
    with pytest.raises(ValueError, match="give TransferFunction a volume or range"):
        waiting.points
    np.testing.assert_array_equal(picture(blob, transfer=waiting), picture(blob, transfer="gray"))


def test_matplotlib(blob, picture):
    matplotlib = pytest.importorskip("matplotlib")
    ours = {preset for preset, _, _ in chiaro.list_presets()}
    name = next(n for n in matplotlib.colormaps if n not in ours and not n.endswith("_r") and matplotlib.colormaps[n].N == 256)
    colormap = matplotlib.colormaps[name]
    by_object = chiaro.TransferFunction(colormap, blob, opacity=(0, 0.5))
    assert len(by_object.points) == 256 and by_object.points[-1, 4] == 0.5
    np.testing.assert_allclose(by_object.points[100, 1:4], colormap(100 / 255)[:3], atol=0.02)
    by_name = chiaro.TransferFunction(name, range=(0, 1))
    np.testing.assert_allclose(by_name.points[:, 1:4], by_object.points[:, 1:4])
    with pytest.raises(ValueError, match="no values of its own"):
        chiaro.TransferFunction(colormap)
    assert picture(blob, transfer=by_object).max() > 0


def test_points_can_be_edited():
    f = chiaro.TransferFunction([(0, 0, 0, 0, 0), (10, 1, 0, 0, 1)], opacity_unit_mm=2)
    assert f.opacity_unit == (2, "mm")
    np.testing.assert_allclose(f([0, 5, 20]), [[0, 0, 0, 0], [0.5, 0, 0, 0.5], [1, 0, 0, 1]])
    points = f.points
    points[1, 4] = 0.25
    g = f.with_points(points)
    assert g.points[1, 4] == 0.25 and f.points[1, 4] == 1 and g != f and g.opacity_unit == f.opacity_unit
    assert f.scaled(0.5).points[1, 4] == 0.5
    assert list(f.windowed(100, 20).points[:, 0]) == [90, 110]
    for wrong in ([(5, 0, 0, 0, 0), (1, 0, 0, 0, 0)], [(0, 2, 0, 0, 0)], [(0, 0, 0)], []):
        with pytest.raises((ValueError, chiaro.InputError)):
            chiaro.TransferFunction(wrong)
    with pytest.raises(ValueError):
        chiaro.TransferFunction([(0, "blak", 1)])


def test_functions_draw_themselves(blob):
    f = chiaro.TransferFunction([(0, "black", 0), (1000, "red", 1)])
    plain, with_histogram = f.draw(), f.draw(blob)
    assert plain.shape == (120, 480, 3) and (plain != with_histogram).any()
    right = plain[100, 460].astype(int)
    assert right[0] > right[1] + 100
    assert f._repr_png_()[1:4] == b"PNG"


def test_probes(picture, blob):
    names = [name for name, _ in chiaro.list_probes()]
    assert {"white", "sky", "studio"} <= set(names)
    sky = chiaro.Probe("sky")
    assert sky.array.shape[2] == 3 and sky._repr_png_()[1:4] == b"PNG"
    lit = {"lighting": "visibility", "shading": "none"}
    by_name = picture(blob, probe="sky", **lit)
    by_array = picture(blob, probe=sky.array, **lit)
    np.testing.assert_array_equal(by_name, by_array)
    assert (picture(blob, probe=sky.rotated(90), **lit) != by_name).any()
    np.testing.assert_array_equal(picture(blob, probe=sky.rotated(90), **lit), picture(blob, probe="sky", probe_rotation=90, **lit))
    assert picture(blob, probe=sky.exposed(1), **lit).mean() > by_name.mean()
    scene = chiaro.Scene(blob, probe=sky.array)
    assert scene.with_(probe="white").probe == "white" and not scene.with_(probe="white")._native.has_own_probe
    with pytest.raises(ValueError):
        chiaro.Probe(np.zeros((4, 4)))
    with pytest.raises(ValueError, match="did you mean"):
        chiaro.Probe("skyy").array

"""Several values a voxel: channels, colours of a volume's own, labels with a table."""

import numpy as np
import pytest

import chiaro

LOOK = dict(size=(48, 40), lighting="spao")


def ball(at, value=200):
    z, y, x = np.mgrid[:16, :16, :16] - 7.5
    return (np.clip(5 - np.sqrt((x - at) ** 2 + y * y + z * z), 0, 1) * value).astype(np.uint8)


@pytest.fixture
def two():
    return np.stack([ball(-2), ball(3)])


def same(a, b):
    return np.array_equal(np.asarray(a), np.asarray(b))


def test_channels_are_the_tools(two, tool, tmp_path):
    chiaro.write(chiaro.Volume(two[0]), tmp_path / "a.nrrd")
    chiaro.write(chiaro.Volume(two[1]), tmp_path / "b.nrrd")
    picture = tmp_path / "two.png"
    tool("render", str(tmp_path / "a.nrrd"), "--channel", str(tmp_path / "b.nrrd"), "--channel-gains", "1,0.5", "-o", str(picture), "--size", "48x40", "--lighting", "spao")
    volume = chiaro.Volume(two, channels=["cells", {"name": "marker", "gain": 0.5}])
    assert volume.shape == (16, 16, 16, 2) and [c["name"] for c in volume.channels] == ["cells", "marker"]
    assert same(chiaro.render(volume, **LOOK), chiaro.read_image(picture))
    # Gains are a scene's, and may change; 0 hides.
    session = chiaro.Session(volume, **LOOK)
    session.set(channels=[1, 0])
    assert same(session.image(), chiaro.render(chiaro.Volume(two, channels=[1, {"show": False}]), **LOOK))
    assert not same(session.image(), chiaro.read_image(picture))


def test_channels_have_their_colours(two):
    look = dict(LOOK, background="black", shading="none")
    seen = np.asarray(chiaro.render(chiaro.Volume(two, channels=[{"color": (0, 0, 1)}, {"color": "#00ff00"}]), **look))
    assert seen[..., 0].max() < 40 and seen[..., 1].max() > 100 and seen[..., 2].max() > 100
    by_hand = [{"transfer": [(20, 0, 0, 1, 0), (200, 0, 0, 1, 0.3)]}, {"color": "lime"}]
    assert np.asarray(chiaro.render(chiaro.Volume(two, channels=by_hand), **look))[..., 0].max() < 40


def test_own_colours(two):
    planes = np.stack([ball(0), ball(0, 100), ball(0, 20)])
    volume = chiaro.Volume(planes, channels="rgb", spacing=(1, 1, 2))
    assert volume.has_own_colors and volume.spacing == (1, 1, 2)
    image = chiaro.render(volume, background="black", **LOOK)
    assert same(image, chiaro.render(chiaro.Volume(np.moveaxis(planes, 0, -1), channels="rgb", spacing=(1, 1, 2)), background="black", **LOOK))
    pixel = np.asarray(image)[20, 24]
    assert pixel[0] > pixel[1] > pixel[2]


@pytest.mark.parametrize(
    "channels, error, sentence",
    [
        ("cmyk", ValueError, "must be True, 'rgb' or a list"),
        ("rgb", ValueError, "three or four values"),
        (["a"], ValueError, "1 are told of, where the array has 2"),
        ([{"hue": 1}, {}], TypeError, "unknown key 'hue'"),
        ([{"gain": -1}, {}], ValueError, "must be 0 or more"),
        (3, TypeError, "must be a list"),
    ],
)
def test_refused(two, channels, error, sentence):
    with pytest.raises(error, match=sentence):
        chiaro.Volume(two, channels=channels)


def test_refused_shapes(two):
    with pytest.raises(ValueError, match="it has four axes"):
        chiaro.Volume(two[0], channels=True)
    with pytest.raises(ValueError, match="at most 8 channels"):
        chiaro.Volume(np.concatenate([two] * 5), channels=True)


def test_labels(tool, tmp_path):
    look = LOOK | {"fit": "volume"}  # a session keeps what its first picture's camera fits
    volume = chiaro.Volume(ball(0))
    labels = np.zeros((16, 16, 16), np.uint16)
    labels[:, :, 8:] = 3
    table = [{"value": 3, "name": "right", "rgb": [1, 0, 0]}]
    image = chiaro.render(volume, labels=labels, label_table=table, transfer="gray", **look)
    chiaro.write(volume, tmp_path / "v.nrrd")
    chiaro.write(chiaro.Volume(labels), tmp_path / "l.nrrd")
    (tmp_path / "t.json").write_text('{"labels": [{"value": 3, "rgb": [1, 0, 0]}]}')
    picture = tmp_path / "p.png"
    tool("render", str(tmp_path / "v.nrrd"), "-o", str(picture), "--labels", str(tmp_path / "l.nrrd"), "--label-table", str(tmp_path / "t.json"), "--transfer", "gray", "--size", "48x40", "--lighting", "spao", "--fit", "volume")
    assert same(image, chiaro.read_image(picture))
    for told in ({3: {"rgb": [1, 0, 0]}}, str(tmp_path / "t.json")):
        assert same(image, chiaro.render(volume, labels=labels, label_table=told, transfer="gray", **look))
    plain = chiaro.render(volume, transfer="gray", **look)
    assert not same(image, plain)
    session = chiaro.Session(volume, labels=labels, label_table=table, transfer="gray", **look)
    assert same(session.image(), image)
    session.labels = None
    assert same(session.image(), plain)
    own = [{"value": 3, "transfer_function": chiaro.TransferFunction([(0, 0, 1, 0, 0), (200, 0, 1, 0, 0.5)])}]
    green = np.asarray(chiaro.render(volume, labels=labels, label_table=own, transfer="gray", background="black", **LOOK))
    assert green[20, 32, 1] > green[20, 32, 0] + 20


def test_labels_alone():
    labels = chiaro.Volume((ball(0) > 50).astype(np.uint8))
    assert np.asarray(chiaro.render(labels, labels=labels, **LOOK)).std() > 5


def test_labels_refused():
    volume = chiaro.Volume(ball(0))
    with pytest.raises(chiaro.InputError, match="label_table"):
        chiaro.render(volume, labels=ball(0), label_table=[{"value": 1.5}], **LOOK)
    with pytest.raises(TypeError, match="goes with labels="):
        chiaro.render(volume, label_table=[{"value": 1}], **LOOK)

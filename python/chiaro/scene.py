"""Scenes: everything that a picture needs."""

from __future__ import annotations

import os
from typing import Any

import numpy as np

from . import _channels, _chiaro, _progress, _settings
from .probe import Probe
from .transfer import TransferFunction
from .volume import Volume


class Scene:
    """A volume and how it is shown; the same scene gives the same picture. It never changes: ``with_`` makes others.

    ``volume`` is a Volume, or the name of a file or sample as for ``read``. ``settings`` are the tool's flags with ``_``
    for ``-``; each can be read back as an attribute, or by group (``scene.camera.azimuth``). ``transfer`` also takes a
    TransferFunction or whatever that takes, ``probe`` a Probe or an array, ``labels`` an array or Volume, ``label_table`` a
    dict or list (docs/python.md); ``channels`` is a list with the gain, or a dict of name, gain, show and transfer, of each of
    several channels. Wrong names and types raise TypeError, wrong
    values UsageError (a ValueError).
    """

    _native: Any
    _volume: Volume | None

    def __init__(self, volume: Any = None, **settings: Any) -> None:
        _settings.refuse_unknown("Scene", settings)
        held = None
        if isinstance(volume, (str, os.PathLike)):
            name = os.fspath(volume)
        elif volume is None:
            name = ""
        else:
            held = Volume.of(volume)
            name = held.name
        if held is not None and held._channels and any(row.keys() - {"name", "color"} for row in held._channels):
            settings = {"channels": held._channels, **settings}
        changed = Scene._of(_chiaro.Scene(name), held)._changed(settings)
        object.__setattr__(self, "_native", changed._native)
        object.__setattr__(self, "_volume", held)

    @classmethod
    def _of(cls, native: Any, volume: Volume | None) -> "Scene":
        self = cls.__new__(cls)
        object.__setattr__(self, "_native", native)
        object.__setattr__(self, "_volume", volume)
        return self

    def _changed(self, settings: dict[str, Any]) -> "Scene":
        plain = dict(settings)
        native = self._native
        if "channels" in plain:
            native = native.with_channels(_channels.settings_of(_channels.rows_of(plain.pop("channels") or []), self._volume))
        native = self._labelled(native, plain)
        function = probe = None
        if "transfer" in plain and not isinstance(plain["transfer"], (str, os.PathLike, type(None))):
            function = TransferFunction.of(plain.pop("transfer"), self._volume)
            if function._source is not None:
                plain["transfer"], function = function._source, None
        if "probe" in plain and not isinstance(plain["probe"], (str, os.PathLike, type(None))):
            probe = Probe.of(plain.pop("probe"))
            plain.setdefault("probe_rotation", probe.rotation)
            plain.setdefault("probe_exposure", "auto" if probe.exposure is None else probe.exposure)
            if probe.name:
                plain["probe"], probe = probe.name, None
        elif "probe" in plain and native.has_own_probe:
            native = native.with_probe(_chiaro.Probe())
        if function is not None:
            native = native.with_transfer(function._native)
        if probe is not None:
            native = native.with_probe(probe._native)
        return Scene._of(native.with_settings(_settings.texts(plain)), self._volume)

    def _labelled(self, native: Any, plain: dict[str, Any]) -> Any:
        """With labels or tables that are in memory, which are taken out of the settings."""
        labels, table = plain.get("labels"), plain.get("label_table")
        is_name = isinstance(labels, (str, os.PathLike))
        if labels is None or (is_name and isinstance(table, (str, os.PathLike, type(None)))):
            if table is not None and not isinstance(table, (str, os.PathLike)):
                raise TypeError("label_table: a dict or list goes with labels=, which it is the table of")
            return native.without_labels() if "labels" in plain and native.has_own_labels else native
        del plain["labels"]
        plain.pop("label_table", None)
        held = self._volume
        if isinstance(labels, np.ndarray) and held is not None and labels.shape == held.shape[:3]:
            volume = Volume(labels, held.spacing, held.origin, held.direction, held.frame, "labels")
        else:
            volume = Volume.of(labels)
        alone = held is not None and labels is held
        is_text = table is not None and not isinstance(table, (str, os.PathLike))
        text = _channels.table_text(table) if is_text else os.fspath(table or "")
        name = native.volume if alone else f"labels: {volume.name}"
        with _progress.reporting(None) as report:
            return native.with_labels(volume._native, name, text, is_text, report)

    def with_(self, **settings: Any) -> "Scene":
        """The scene with other settings (None takes an optional one back), or of another ``volume``."""
        _settings.refuse_unknown("with_", settings, ("volume",))
        scene: Scene = self
        if "volume" in settings:
            volume = settings.pop("volume")
            if isinstance(volume, (str, os.PathLike)):
                scene = Scene._of(self._native.with_volume(os.fspath(volume)), None)
            else:
                held = Volume.of(volume)
                scene = Scene._of(self._native.with_volume(held.name), held)
        return scene._changed(settings)

    @property
    def volume(self) -> Any:
        """The Volume, or the name of what is read for it."""
        return self._volume if self._volume is not None else self._native.volume

    @property
    def transfer_function(self) -> "TransferFunction | None":
        """The points that the scene itself holds; None where it names a preset or file, or leaves that to the data."""
        points = self._native.points
        return None if points is None else TransferFunction._of_native(points)

    def to_json(self, folder: str | os.PathLike[str] = "") -> str:
        """The scene as the tool keeps it; parse_scene of it gives the same. Files are named as seen from ``folder``. A
        probe that was given as an array is not in it, nor are the voxels of an array."""
        return str(self._native.to_json(os.fspath(folder)))

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes a scene file of the tool."""
        folder = os.path.dirname(os.path.abspath(path))
        with open(path, "w", encoding="utf-8") as file:
            file.write(self.to_json(folder) + "\n")

    @staticmethod
    def from_json(text: str, folder: str | os.PathLike[str] = ".") -> "Scene":
        """The scene of a text of the tool's. Relative names are looked up in ``folder``. Raises InputError."""
        native, notes = _chiaro.parse_scene(text, os.path.abspath(folder))
        return _told(native, notes, "scene")

    @staticmethod
    def read(path: str | os.PathLike[str], data: str | os.PathLike[str] = "") -> "Scene":
        """The scene of a scene file, or of a picture that carries one. A relative volume is looked up beside the file,
        then in ``data``. Raises InputError."""
        native, notes = _chiaro.read_scene(os.fspath(path), os.fspath(data))
        return _told(native, notes, os.fspath(path))

    from_picture = read

    def __getattr__(self, name: str) -> Any:
        if name.startswith("__"):
            raise AttributeError(name)
        return read_setting(self, name)

    def __setattr__(self, name: str, value: Any) -> None:
        raise AttributeError(f"a scene never changes: use scene.with_({name}=...)")

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Scene) and self.to_json() == other.to_json() and self._volume is other._volume

    def __hash__(self) -> int:
        return hash(self.to_json())

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *_settings.table(), *_settings.grouped()]

    def __reduce__(self) -> Any:
        if self._volume is not None or self._native.has_own_labels:
            raise TypeError("a scene of an array cannot be pickled: keep its to_json() and the array")
        return Scene.from_json, (self.to_json(),)

    def __repr__(self) -> str:
        plain = Scene()
        said = [f"{name}={value!r}" for name in _settings.table() if (value := read_setting(self, name)) != read_setting(plain, name)]
        return f"chiaro.Scene({', '.join([repr(self.volume), *said])})"


class Group:
    """The settings of one group of a scene or session: ``session.camera.azimuth += 10``."""

    def __init__(self, owner: Any, group: str) -> None:
        object.__setattr__(self, "_owner", owner)
        object.__setattr__(self, "_group", group)

    def _check(self, name: str) -> str:
        names = _settings.grouped()[self._group]
        if name not in names:
            raise AttributeError(f"{self._group} has no setting '{name}'{_settings.meant(name, names)}")
        return name

    def __getattr__(self, name: str) -> Any:
        return getattr(self._owner, self._check(name))

    def __setattr__(self, name: str, value: Any) -> None:
        setattr(self._owner, self._check(name), value)

    def __dir__(self) -> list[str]:
        return list(_settings.grouped()[self._group])

    def __repr__(self) -> str:
        return ", ".join(f"{name}={getattr(self, name)!r}" for name in _settings.grouped()[self._group])


def read_setting(owner: Any, name: str) -> Any:
    """A setting of a scene or session, or the group of that name."""
    if name in _settings.table():
        return owner._native_scene().value(name) if hasattr(type(owner), "_native_scene") else owner._native.value(name)
    if name in _settings.grouped():
        return Group(owner, name)
    raise AttributeError(f"'{name}' is no setting{_settings.meant(name, [*_settings.table(), *_settings.grouped()])}")


class HasSettings:
    """Of a session and a view: each setting of its scene is an attribute, also by group."""

    #: what else may be set
    _more: tuple[str, ...] = ()

    def set(self, **settings: Any) -> Any:
        raise NotImplementedError

    def _choose(self, scene: Any) -> None:
        """``scene`` was set."""
        raise NotImplementedError

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_"):
            raise AttributeError(name)
        return read_setting(self, name)

    def __setattr__(self, name: str, value: Any) -> None:
        if name == "scene":
            self._choose(value)
        elif name in _settings.table() or name in self._more:
            self.set(**{name: value})
        else:
            raise AttributeError(f"'{name}' is no setting{_settings.meant(name, _settings.table())}")

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *_settings.table(), *_settings.grouped()]


def _told(native: Any, notes: list[str], name: str) -> Scene:
    import logging

    for note in notes:
        logging.getLogger("chiaro").warning("%s: %s", name, note)
    return Scene._of(native, None)


def scene_of(volume: Any, settings: dict[str, Any], call: str) -> Scene:
    """The scene of whatever `render` and its like take."""
    _settings.refuse_unknown(call, settings)
    return volume.with_(**settings) if isinstance(volume, Scene) else Scene(volume, **settings)

"""Pictures of one volume, one after the other."""

from __future__ import annotations

import logging
import queue
import threading
import time
import weakref
from typing import Any, Iterator

import numpy as np

from . import _chiaro, _progress, _settings
from .image import Image
from .probe import Probe
from .scene import HasSettings, Scene, scene_of
from .transfer import TransferFunction
from .volume import Volume, _read

log = logging.getLogger("chiaro")


def split_device(settings: dict[str, Any]) -> tuple[dict[str, Any], dict[str, Any]]:
    """What is said of the device, and the settings of the picture."""
    device = {name: settings[name] for name in _settings.DEVICE if name in settings}
    return device, {name: value for name, value in settings.items() if name not in device}


class Session(HasSettings):
    """A volume, and all that was made of it: of the next picture only what lies to the right of a change is redone.

        s = chiaro.Session(volume, lighting="transport")
        s.camera.azimuth += 10
        s.transfer = "ct-bone"
        s.image()

    ``settings`` are a Scene's; each is an attribute, also by group. ``device`` ('auto', 'cpu', 'cuda:0'), ``threads`` (0:
    all) and ``isa`` say where the work is done. Several sessions may be used by several threads at a time; one session
    takes one call after the other. Memory: 1.3 × the voxels, and the light.
    """

    def __init__(self, volume: Any = None, **settings: Any) -> None:
        device, picture = split_device(settings)
        self._open(scene_of(volume, picture, "Session"), device)

    def _open(self, scene: Scene, device: dict[str, Any]) -> None:
        state = self.__dict__
        state["_scene"] = scene
        state["_where"] = device
        state["_session"] = _chiaro.Session(device.get("device", "auto"), int(device.get("threads", 0)), device.get("isa", ""))
        state["_shown"] = None
        state["_last"] = None
        state["_read_seconds"] = None
        state["_volume_read"] = None

    # --- the scene
    @property
    def scene(self) -> Scene:
        """What the next picture shows."""
        return self._scene  # type: ignore[no-any-return]

    def _native_scene(self) -> Any:
        return self._scene._native

    @property
    def volume(self) -> Volume:
        """What is shown; read when first asked for."""
        if self._scene._volume is not None:
            return self._scene._volume  # type: ignore[no-any-return]
        wanted = (self._scene._native.volume, self._scene.time)
        if self._volume_read is None or self._volume_read[0] != wanted:
            begun = time.perf_counter()
            read_now = _read(self._scene._native.volume, self._scene)
            for note in read_now.notes:
                log.warning("%s: %s", read_now.name, note)
            self.__dict__["_read_seconds"] = time.perf_counter() - begun
            self.__dict__["_volume_read"] = (wanted, read_now)
        return self._volume_read[1]  # type: ignore[no-any-return]

    def set(self, **settings: Any) -> "Session":
        """Several settings at once; the session itself."""
        self.__dict__["_scene"] = self._scene.with_(**settings)
        return self

    _more = ("volume",)

    def _choose(self, scene: Any) -> None:
        self.__dict__["_scene"] = scene if isinstance(scene, Scene) else Scene(scene)

    # --- pictures
    def _show(self, report: Any) -> None:
        volume = self.volume
        shown = (volume, volume._version)
        if self._shown is not None and self._shown[0] is volume and self._shown[1] == volume._version:
            return
        self._forget()
        self.__dict__["_shown"] = None
        if volume._first is None:
            volume._show_in(self._session, report)
        else:
            native = self._session.show_moment(self._scene._native, volume._first()._native, volume._native, report)
            self.__dict__["_scene"] = Scene._of(native, self._scene._volume)
        self.__dict__["_shown"] = shown
        self._tell_guess()

    def _tell_guess(self) -> None:
        scene = self._scene
        if scene.transfer is None and scene._native.points is None and not scene._native.volume.startswith("sample:"):
            modality, preset, reason = self._session.guess()
            log.info("looks like %s (%s): using transfer=%r", modality, reason, preset)

    def _forget(self) -> None:
        """An image that is not the newest any more has to know what it would ask for."""
        last = self._last() if self._last is not None else None
        if last is not None:
            last._forget_source()
        self.__dict__["_last"] = None

    def image(self, *, depth: bool = False, progress: Any = None, **settings: Any) -> Image:
        """The picture of the scene as it is, ``settings`` set before. ``depth``: found at once rather than when asked
        for. Raises KeyboardInterrupt on Ctrl-C, within 100 ms."""
        if settings:
            self.set(**settings)
        with _progress.reporting(progress) as report:
            self._show(report)
            self._forget()
            pixels = self._session.render(self._scene._native, report, None)
        for note in [*self._session.notes(), *(self.paging or {}).get("faults", [])]:
            log.warning(note)
        image = self._image(np.asarray(pixels), newest=True)
        if depth:
            image.depth
        return image

    def _fit_all_around(self, progress: Any) -> None:
        """The camera fits the ball that all azimuths need."""
        with _progress.reporting(progress) as report:
            self._show(report)
            self._forget()
            native = self._session.fitted_all_around(self._scene._native, report)
        self.__dict__["_scene"] = Scene._of(native, self._scene._volume)

    def _image(self, pixels: np.ndarray[Any, Any], newest: bool) -> Image:
        native = self._session
        scene = Scene._of(native.seen(self._scene._native), self._scene._volume)
        # The camera fits what is visible, once: what is changed from now on moves nothing else.
        self.__dict__["_scene"] = Scene._of(self._scene._native.with_camera_of(scene._native), self._scene._volume)
        if not newest:
            return Image(pixels, None, scene, {}, None)
        image = Image(pixels, lambda: native.frame(scene._native), scene, self._stats(), native.depth)
        self.__dict__["_last"] = weakref.ref(image)
        return image

    def _stats(self) -> dict[str, Any]:
        """As the tool's --stats writes it."""
        import json

        from . import __version__

        stages = [{"name": name, "seconds": seconds} for name, seconds in self._session.stages()]
        if self._read_seconds is not None:
            stages.insert(0, {"name": "read", "seconds": self._read_seconds})
        done = self._session.render_statistics()
        volume = self.volume
        told: dict[str, Any] = {
            "chiaro": __version__,
            **self._session.device(),
            "volume": {"file": volume.name, "format": volume.format, "dimensions": list(volume.shape[::-1]), "type": volume.dtype.name, **({"moments": volume.moments} if volume.moments["count"] > 1 else {})},
            "settings": json.loads(self._scene.to_json()),
            "stages": stages,
            "samples": done["samples"],
        }
        if self.paging:
            told["paging"] = self.paging
        if done["paths"]:
            told["paths"] = {"samples": done["paths"], "noise": done["noise"], "relative_noise": done["relative_noise"]}
        return told

    def refine(self, **settings: Any) -> Iterator[Image]:
        """Better and better pictures of the scene as it is: at once one by the light that is known, then with each coarse
        light or each pass of paths, last the one that ``image`` gives. Leaving the loop ends the work."""
        if settings:
            self.set(**settings)
        self._show(None)
        self._forget()
        yield self._image(np.asarray(self._session.preview(self._scene._native)), newest=False)
        news: queue.Queue[Any] = queue.Queue()
        stop = threading.Event()

        def listen(*_: Any) -> None:
            if stop.is_set():
                raise GeneratorExit

        def work() -> None:
            try:
                news.put(self._session.render(self._scene._native, listen, lambda pixels: news.put((pixels,))))
            except BaseException as error:  # noqa: BLE001 - handed to the loop
                news.put(error)

        thread = threading.Thread(target=work, daemon=True)
        thread.start()
        try:
            while True:
                found = news.get()
                if isinstance(found, BaseException):
                    raise found
                if not isinstance(found, tuple):
                    yield self._image(np.asarray(found), newest=True)
                    return
                yield self._image(np.asarray(found[0]), newest=False)
        finally:
            stop.set()
            thread.join()

    # --- what is known
    @property
    def paging(self) -> dict[str, Any] | None:
        """Of the last picture of a lazy volume: the level that was drawn, why no finer one, bricks read, faults. None where the
        volume is in memory as a whole."""
        return self._session.paging()  # type: ignore[no-any-return]

    @property
    def transfer_function(self) -> TransferFunction:
        """The one that the scene's pictures take: its points, a preset, or what is guessed from the data."""
        self._show(None)
        return TransferFunction._of_native(self._session.transfer(self._scene._native))

    @property
    def probe_used(self) -> Probe | None:
        return None if self._scene.probe is None else Probe(self._scene.probe, self._scene.probe_rotation, None if self._scene.probe_exposure == "auto" else self._scene.probe_exposure)

    def __repr__(self) -> str:
        return f"<chiaro.Session of {self._scene!r}>"


_last_render: Any = None


def render(volume: Any, *, depth: bool = False, progress: Any = None, **settings: Any) -> Image:
    """The picture of a volume, or of a scene.

    ``volume``: a Volume or whatever ``Volume.of`` takes, the name of a file or sample, or a Scene, whose settings those
    given here replace. ``settings`` are the tool's flags, with ``_`` for ``-`` (listed below), and ``device``, ``threads``
    and ``isa``. ``depth``: also finds ``image.depth`` at once. ``progress``: False, True, or a function of (stage,
    fraction).

    Raises TypeError for wrong names, types and arrays, UsageError (a ValueError) for values out of range, InputError and
    OutputError with the tool's sentence, KeyboardInterrupt on Ctrl-C. Memory: 1.3 × the voxels beside the array, and
    the light.
    """
    global _last_render
    previous = _last_render() if _last_render is not None else None
    if previous is not None:
        previous._forget_source()
    device, picture = split_device(settings)
    session = Session(scene_of(volume, picture, "render"), **device)
    session._session.expect_one_look()
    image = session.image(depth=depth, progress=progress)
    _last_render = weakref.ref(image)
    return image



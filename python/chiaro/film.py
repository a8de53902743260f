"""Pictures in a row."""

from __future__ import annotations

import logging
import os
import shutil
import subprocess
from typing import Any, Iterable, Iterator

import numpy as np

from . import _chiaro
from .image import Image
from .scene import Scene, scene_of
from .session import Session, split_device

log = logging.getLogger("chiaro")


def turntable(volume: Any, frames: int, *, progress: Any = None, **settings: Any) -> Iterator[Image]:
    """Pictures from ``frames`` azimuths once around, as ``chiaro render --frames`` makes them: light is found once.

    Raises UsageError with ``view`` and ``eye``, which leave nothing to turn; else as ``render``.
    """
    from .errors import error_of

    device, picture = split_device(settings)
    scene = scene_of(volume, picture, "turntable")
    if not 1 <= frames <= 100000:
        raise error_of(2, f"frames={frames}: must be 1 to 100000")
    if scene.view is not None or scene.eye is not None:
        raise error_of(2, "a turntable turns the orbit: it goes with neither view nor eye")
    return _turned(Session(scene, **device), scene.azimuth, frames, progress)


def _turned(session: Session, azimuth: float, frames: int, progress: Any) -> Iterator[Image]:
    session._fit_all_around(progress)
    for frame in range(frames):
        yield session.image(azimuth=azimuth + 360 * frame / frames, progress=progress)


def animate(
    keyframes: Any,
    *,
    data: str | os.PathLike[str] = "",
    fps: float = 25,
    size: tuple[int, int] = (1280, 720),
    progress: Any = None,
    **device: Any,
) -> Iterator[Image]:
    """The pictures of a film of keyframes, as ``chiaro render --film`` and the viewer make them.

    ``keyframes``: the name of a film's file, whose relative volume is looked up beside it, then in ``data``; or a list of
    (seconds, Scene) of one volume, in rising order, with ``fps`` and ``size`` (width, height). ``device``, ``threads`` and ``isa`` as
    for ``render``. What lies between two keys is told in docs/scene.md.

    Raises InputError for files, ValueError for keys that make no film; else as ``render``.
    """
    where, picture = split_device(device)
    if picture:
        raise TypeError(f"animate: {', '.join(picture)}: settings are those of the keyframes' scenes")
    if isinstance(keyframes, (str, os.PathLike)):
        film, unknown = _chiaro.read_film(os.fspath(keyframes), os.fspath(data))
        for key in unknown:
            log.warning("%s: unknown key %s", os.fspath(keyframes), key)
        held = None
    else:
        film, held = _film_of(list(keyframes), float(fps), size)
    return _frames(film, Session(Scene._of(film.first, held), **where), held, progress)


def _film_of(keys: list[Any], fps: float, size: tuple[int, int]) -> tuple[Any, Any]:
    width, height = (int(n) for n in size)
    if not 0 < fps <= 1000 or not (1 <= width <= 16384 and 1 <= height <= 16384):
        raise ValueError(f"fps={fps}, size={size}: must be up to 1000 pictures a second of up to 16384 pixels a side")
    if not 1 <= len(keys) <= 1000 or not all(isinstance(scene, Scene) for _, scene in keys):
        raise ValueError("a film needs 1 to 1000 keys, each (seconds, Scene)")
    times = [float(seconds) for seconds, _ in keys]
    if not all(0 <= a < b for a, b in zip(times, times[1:])) or not 0 <= times[0] <= times[-1] < 1e6:
        raise ValueError("the seconds of a film's keys must rise from 0 or later")
    if (times[-1] - times[0]) * fps >= 100000:
        raise ValueError("a film has 100000 frames at most")
    held = keys[0][1]._volume
    if any(scene._volume is not held or scene._native.volume != keys[0][1]._native.volume for _, scene in keys):
        raise ValueError("all keys of a film show one volume")
    return _chiaro.film_of([(at, scene._native) for at, (_, scene) in zip(times, keys)], fps, width, height), held


def _frames(film: Any, session: Session, held: Any, progress: Any) -> Iterator[Image]:
    session._fit_all_around(progress)
    film = film.fitted(session.scene._native)
    for frame in range(film.frames):
        session._choose(Scene._of(film.scene(session.volume._head, frame), held))
        yield session.image(progress=progress)


def save_video(path: str | os.PathLike[str], images: Iterable[Any], fps: float = 25) -> int:
    """Writes pictures (Image or (h, w, 3) uint8, of one size) as a film by the program ffmpeg; the ending of ``path`` says
    how (.mp4, .webm, .gif, ...). Returns how many there were. Whole or not at all.

    Raises OutputError where ffmpeg is missing or fails, ValueError for pictures of different sizes or none.
    """
    from .errors import error_of

    name = os.fspath(path)
    program = shutil.which("ffmpeg")
    if program is None:
        raise error_of(4, "films need the program ffmpeg, which is not installed (apt install ffmpeg)")
    root, ending = os.path.splitext(name)
    partial = f"{root}.partial-{os.getpid()}{ending}"
    process: Any = None
    size: Any = None
    count = 0
    try:
        for image in images:
            pixels = np.ascontiguousarray(np.asarray(image)[..., :3], dtype=np.uint8)
            if process is None:
                size = pixels.shape
                process = _start(program, size, fps, partial)
            elif pixels.shape != size:
                raise ValueError(f"picture {count} has {pixels.shape[1]} × {pixels.shape[0]} pixels, the first {size[1]} × {size[0]}")
            process.stdin.write(pixels.tobytes())
            count += 1
        if process is None:
            raise ValueError("a film needs at least one picture")
        _, said = process.communicate()
        if process.returncode != 0:
            raise error_of(4, f"{name}: ffmpeg failed: {said.decode(errors='replace').strip().splitlines()[-1:]}")
        os.replace(partial, name)
        return count
    except BrokenPipeError:
        _, said = process.communicate()
        last = said.decode(errors="replace").strip().splitlines()
        raise error_of(4, f"{name}: ffmpeg failed: {last[-1] if last else 'it ended'}") from None
    finally:
        if process is not None and process.poll() is None:
            process.kill()
            process.wait()
        if os.path.exists(partial):
            os.remove(partial)


def _start(program: str, size: tuple[int, ...], fps: float, path: str) -> Any:
    height, width = size[:2]
    command = [program, "-loglevel", "error", "-y", "-f", "rawvideo", "-pix_fmt", "rgb24", "-s", f"{width}x{height}", "-r", str(fps), "-i", "-"]
    if path.endswith((".mp4", ".m4v", ".mov", ".mkv")):
        # Players want even sizes and this pixel format.
        command += ["-vf", "pad=ceil(iw/2)*2:ceil(ih/2)*2", "-pix_fmt", "yuv420p", "-crf", "18"]
    return subprocess.Popen([*command, path], stdin=subprocess.PIPE, stderr=subprocess.PIPE)

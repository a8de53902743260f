"""Pictures in a row."""

from __future__ import annotations

import os
import shutil
import subprocess
from typing import Any, Iterable, Iterator

import numpy as np

from .image import Image
from .scene import scene_of
from .session import Session, split_device


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

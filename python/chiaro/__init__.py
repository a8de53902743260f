"""Chiaro: natural light for volumes.

    import chiaro
    volume = chiaro.read("scan.nii.gz")
    chiaro.render(volume, lighting="transport", probe="studio", view="left")
"""

from __future__ import annotations

from ._chiaro import version as __version__
from ._progress import set_progress
from .errors import Error, InputError, Interrupted, OutputError, UsageError
from .film import animate, save_video, turntable
from .image import Image, read_image
from .light import Difference, Field, compare, compare_methods, illuminate, reference
from .probe import Probe, list_probes
from .scene import Scene
from .session import Session, render
from .transfer import TransferFunction, list_presets
from .viewer import View, view
from .volume import Volume, read, sample, samples, write

__all__ = [
    "Difference", "Error", "Field", "Image", "InputError", "Interrupted", "OutputError", "Probe", "Scene", "Session",
    "TransferFunction", "UsageError", "View", "Volume", "animate", "compare", "compare_methods", "illuminate", "list_presets", "list_probes",
    "read", "read_image", "reference", "render", "sample", "samples", "save_video", "set_progress", "turntable", "view", "write",
    "__version__",
]


def _explain() -> None:
    """What each setting does, for help(chiaro.render)."""
    from ._settings import explained

    for function in (render, illuminate, view, Scene, Session):
        function.__doc__ = (function.__doc__ or "") + "\n    Settings:\n" + explained()


_explain()
del _explain

"""What a call shows while it works: a line in a terminal, a bar in a notebook, nothing else where."""

from __future__ import annotations

import contextlib
import html
import sys
import time
from typing import Any, Callable, Iterator

Report = Callable[[str, float], None]

#: "auto", "none" or a function of (stage, fraction)
setting: Any = "auto"


def set_progress(how: str | Report) -> None:
    """How calls show their progress: 'auto' (a line in a terminal, a bar in a notebook), 'none', or a function of
    (stage, fraction in 0 to 1), which may raise to end the call."""
    global setting
    if how not in ("auto", "none") and not callable(how):
        raise ValueError(f"set_progress({how!r}): must be 'auto', 'none' or a function")
    setting = how


class _Line:
    """One line on a terminal, written over and over, and taken away in the end."""

    def __init__(self) -> None:
        self._begun = time.monotonic()
        self._shown = False

    def __call__(self, stage: str, fraction: float) -> None:
        seconds = time.monotonic() - self._begun
        if seconds < 0.3:
            return
        bar = ("█" * round(20 * fraction)).ljust(20, "░")
        sys.stderr.write(f"\r\033[K{stage[:40]}: {100 * fraction:3.0f} % |{bar}| {seconds:.1f} s")
        sys.stderr.flush()
        self._shown = True

    def close(self) -> None:
        if self._shown:
            sys.stderr.write("\r\033[K")
            sys.stderr.flush()


class _Widget:
    """A bar under the cell, which goes when the work is done."""

    def __init__(self) -> None:
        self._begun = time.monotonic()
        self._bar: Any = None

    def __call__(self, stage: str, fraction: float) -> None:
        if time.monotonic() - self._begun < 0.3:
            return
        if self._bar is None:
            import ipywidgets
            from IPython.display import display

            self._bar = ipywidgets.FloatProgress(min=0, max=1)
            display(self._bar)
        self._bar.description, self._bar.value = stage[:24], fraction

    def close(self) -> None:
        if self._bar is not None:
            self._bar.close()


class _Html:
    """The same without ipywidgets: an output that is written over, and empty in the end."""

    def __init__(self) -> None:
        self._begun = self._written = time.monotonic()
        self._handle: Any = None

    def __call__(self, stage: str, fraction: float) -> None:
        now = time.monotonic()
        if now - self._begun < 0.3 or (self._handle is not None and now - self._written < 0.2):
            return
        from IPython.display import HTML, display

        bar = HTML(f"<progress value='{fraction:.3f}'></progress> {html.escape(stage[:40])}")
        self._written = now
        if self._handle is None:
            self._handle = display(bar, display_id=True)
        else:
            self._handle.update(bar)

    def close(self) -> None:
        if self._handle is not None:
            from IPython.display import HTML

            self._handle.update(HTML(""))


def _in_notebook() -> bool:
    ipython = sys.modules.get("IPython")
    shell = ipython.get_ipython() if ipython else None
    return shell is not None and type(shell).__name__ == "ZMQInteractiveShell"


def _has_widgets() -> bool:
    """ipywidgets before 7 speak a protocol that programs which run notebooks do not understand any more."""
    from importlib import metadata

    try:
        return int(metadata.version("ipywidgets").split(".")[0]) >= 7
    except (metadata.PackageNotFoundError, ValueError):
        return False


def _automatic() -> Any:
    if _in_notebook():
        return _Widget() if _has_widgets() else _Html()
    return _Line() if sys.stderr is not None and sys.stderr.isatty() else None


@contextlib.contextmanager
def reporting(progress: Any) -> Iterator[Any]:
    """What to report to: `progress` (True, False, a function), else what `set_progress` said."""
    how = setting if progress is None or progress is True else progress
    if how is False or how == "none":
        yield None
    elif how == "auto":
        shown = _automatic()
        try:
            yield shown
        finally:
            if shown is not None:
                shown.close()
    else:
        yield how

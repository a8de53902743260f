"""The viewer beside the notebook, or in the browser."""

from __future__ import annotations

import atexit
import base64
import json
import os
import secrets
import weakref
from typing import Any, Callable, Sequence
from urllib.parse import urlsplit

from . import _chiaro, _progress
from .image import Image
from .scene import HasSettings, Scene, scene_of
from .session import Session, split_device

#: what may frame the page unless something else is said: notebooks of this machine
LOCAL = ("http://localhost:*", "http://127.0.0.1:*")
_open: "weakref.WeakSet[View]" = weakref.WeakSet()


class View(HasSettings):
    """A viewer that is alive: what the person chooses is read back, and what is set here is shown there.

        v = chiaro.view(volume)
        v.camera.azimuth = 80        # turns the picture
        v.scene                      # as it looks now, orbits and edits of the page included

    Made by ``chiaro.view``.
    """

    _session: Any
    _server: Any
    _volume: Any

    def __init__(self, scene: Scene, device: dict[str, Any], height: int, host: str, port: int, embed_from: Sequence[str] | None) -> None:
        state = self.__dict__
        state["_height"] = int(height)
        state["_listeners"] = []
        state["_session"] = None
        state["_first"] = scene
        state["_device"] = device
        public = os.environ.get("CHIARO_VIEW_URL", "")
        origins = list(LOCAL if embed_from is None else embed_from)
        base_path = "/"
        if public:
            parts = urlsplit(public.replace("{port}", str(port)))
            base_path = parts.path if parts.path.endswith("/") else parts.path + "/"
            origins.append(f"{parts.scheme}://{parts.netloc}")
        volume = scene._volume
        if volume is None:
            volume = Session(scene, **device).volume
        state["_volume"] = volume
        state["_server"] = _chiaro.ViewServer(
            scene._native, *volume._view_of(), _folders(scene), host, port, base_path, origins, int(device.get("threads", 0)), _heard(weakref.ref(self))
        )
        state["_public"] = public
        _open.add(self)

    # --- its addresses
    @property
    def port(self) -> int:
        return int(self._server.port)

    @property
    def url(self) -> str:
        """The address on this machine, good as long as the view lives: not for files that others see."""
        return str(self._server.url)

    def url_of_one_visit(self) -> str:
        """The address that a browser knows, with a key that is good for one visit within 60 seconds."""
        path = self._server.path_of_one_visit()
        if self._public:
            parts = urlsplit(self._public.replace("{port}", str(self.port)))
            return f"{parts.scheme}://{parts.netloc}{path}"
        return f"http://localhost:{self.port}{path}"

    def open(self) -> None:
        """Opens it in the browser of this machine."""
        import webbrowser

        webbrowser.open(self.url_of_one_visit())

    # --- the scene, both ways
    @property
    def scene(self) -> Scene:
        """As it looks now: what was set here, or what the person chose since."""
        native = self._server.scene().with_settings({"size": "x".join(map(str, self._first.size))})
        return Scene._of(native, self._volume)

    def _native_scene(self) -> Any:
        return self._server.scene()

    def set(self, **settings: Any) -> "View":
        """Several settings at once; the view itself."""
        self._server.put(self.scene.with_(**settings)._native)
        return self

    def _choose(self, scene: Any) -> None:
        self._server.put(scene._native)

    def on_change(self, listener: Callable[[Scene], None]) -> None:
        """Calls it with each scene that a page chooses, in another thread."""
        self._listeners.append(listener)

    def snapshot(self, *, progress: Any = None, **settings: Any) -> Image:
        """The picture of the scene as it is now, of its own size or of ``size``."""
        session: Any = self._session or Session(self._first.with_(volume=self._volume), **self._device)
        self.__dict__["_session"] = session
        session.scene = self.scene.with_(**settings)
        image: Image = session.image(progress=progress)
        return image

    def stop(self) -> None:
        """Ends the server; pages keep their last picture."""
        self._server.stop()
        _open.discard(self)

    # --- in a notebook
    def _ipython_display_(self) -> None:
        if not _progress._in_notebook():
            print(repr(self))
            return
        from IPython.display import publish_display_data

        name = f"chiaro-view-{secrets.token_hex(8)}"
        png = self.snapshot(progress=False)._repr_png_()
        publish_display_data({"text/plain": repr(self), "text/html": _cell(name, png, self._height), "image/png": base64.b64encode(png).decode()})
        _send(name, {"url": self.url_of_one_visit(), "port": self.port, "here": not self._public})

    def __repr__(self) -> str:
        return f"<chiaro.View of {self._volume.name!r} at port {self.port}>"


def _heard(view: Any) -> Callable[[Any], None]:
    """What the server calls; it keeps no view alive."""

    def changed(native: Any) -> None:
        alive = view()
        for listener in list(alive._listeners) if alive is not None else []:
            listener(Scene._of(native, alive._volume))

    return changed


def _folders(scene: Scene) -> list[str]:
    """Where the scene's own files lie: pages may open what is there, and below the current folder."""
    found = [os.getcwd()]
    for name in (scene.transfer, scene.probe):
        if name and ("/" in str(name) or "." in str(name)):
            found.append(os.path.dirname(os.path.abspath(str(name).split("#")[0])))
    return found


def _cell(name: str, png: bytes, height: int) -> str:
    """The picture, and a script that puts the living page in its place when the kernel sends the address: by a message,
    which is not kept. So a saved notebook holds the picture alone."""
    picture = base64.b64encode(png).decode()
    return f"""<div id="{name}" style="max-width:100%"><img alt="Chiaro" style="max-width:100%" src="data:image/png;base64,{picture}"></div>
<script>
(() => {{
  const root = document.getElementById({json.dumps(name)}), notebook = window.Jupyter && Jupyter.notebook;
  if (!root || !notebook || !notebook.kernel) return;
  notebook.kernel.comm_manager.register_target({json.dumps(name)}, (comm, message) => {{
    const told = message.content.data, frame = document.createElement("iframe"), url = new URL(told.url);
    if (told.here && ["localhost", "127.0.0.1"].includes(location.hostname)) url.hostname = location.hostname;
    frame.src = url.href;
    frame.title = "Chiaro";
    frame.style.cssText = "width:100%;height:{height}px;border:0";
    root.replaceChildren(frame);
  }});
}})();
</script>"""


def _send(target: str, data: dict[str, Any]) -> None:
    """A message to the script of a cell."""
    from ipykernel import comm

    made: Any = comm.Comm
    made(target_name=target, data=data).close()


def view(volume: Any, *, height: int = 600, host: str = "127.0.0.1", port: int = 0, embed_from: Sequence[str] | None = None, **settings: Any) -> View:
    """The viewer of a volume or scene: under the notebook's cell, from a script in the browser.

    Takes what ``render`` takes. ``height`` of the frame in pixels; ``host`` and ``port`` (0: any) where it is served: to
    this machine alone unless said otherwise. ``embed_from``: origins that may frame it (default: those of this machine).
    Behind a hub or proxy CHIARO_VIEW_URL says what address a browser has for it, "https://hub.org/user/ann/proxy/{port}/".
    It ends with the process, or with ``stop``.
    """
    device, picture = split_device(settings)
    made = View(scene_of(volume, picture, "view"), device, height, host, port, embed_from)
    if not _progress._in_notebook() and (os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")):
        made.open()
    return made


@atexit.register
def _end() -> None:
    for one in list(_open):
        one.stop()



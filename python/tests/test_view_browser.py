"""The viewer in Debian's jupyter-notebook, in Chromium: both ways, and what a saved notebook holds. Skipped without them."""

import json
import os
import pathlib
import shutil
import signal
import socket
import subprocess
import sys
import time

import pytest

HERE = pathlib.Path(__file__).parent
PLAYWRIGHT = HERE.parent.parent / "tests" / "browser" / "node_modules" / "playwright-core"
MISSING = [what for what in ("chromium", "node", "jupyter-notebook") if not shutil.which(what)] + ([] if PLAYWRIGHT.is_dir() else ["playwright-core (scripts/setup tests)"])
pytestmark = pytest.mark.skipif(bool(MISSING), reason=f"no {', '.join(MISSING)}")

CELLS = [
    "import chiaro\nv = chiaro.view(chiaro.sample('tubes', 32), size=(320, 240), height=500, lighting='none')\nv",
    "v.camera.azimuth = 80",
    "print(v.scene.azimuth)",
]


@pytest.fixture
def notebook(tmp_path):
    """A running jupyter-notebook with a notebook of the cells above: its address with the token, and the file."""
    import nbformat

    spec = tmp_path / "share" / "kernels" / "python3"
    spec.mkdir(parents=True)
    (spec / "kernel.json").write_text(json.dumps({"argv": [sys.executable, "-m", "ipykernel_launcher", "-f", "{connection_file}"], "display_name": "Python 3", "language": "python"}))
    folder = tmp_path / "work"
    folder.mkdir()
    file = folder / "view.ipynb"
    nbformat.write(nbformat.v4.new_notebook(cells=[nbformat.v4.new_code_cell(text) for text in CELLS], metadata={"kernelspec": {"name": "python3", "display_name": "Python 3"}}), file)
    environment = {**os.environ, "JUPYTER_PATH": str(tmp_path / "share"), "JUPYTER_RUNTIME_DIR": str(tmp_path / "run"), "JUPYTER_CONFIG_DIR": str(tmp_path / "config"), "DISPLAY": ""}
    log = open(tmp_path / "log", "w")
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    server = subprocess.Popen(
        ["/usr/bin/python3", "/usr/bin/jupyter-notebook", "--no-browser", "--allow-root", f"--port={port}", "--ip=127.0.0.1", "--NotebookApp.token=letmein", f"--notebook-dir={folder}"],
        stdout=log, stderr=log, env=environment)
    try:
        end = time.monotonic() + 60
        found = []
        while not found and time.monotonic() < end and server.poll() is None:
            found = list((tmp_path / "run").glob("nbserver-*.json"))
            time.sleep(0.1)
        assert found, (tmp_path / "log").read_text()
        time.sleep(0.2)
        yield json.loads(found[0].read_text())["url"].replace("127.0.0.1", "localhost"), file
    finally:
        server.send_signal(signal.SIGTERM)
        try:
            server.wait(20)
        except subprocess.TimeoutExpired:
            server.kill()
        log.close()


def test_the_viewer_is_alive_under_the_cell(notebook, tmp_path):
    url, file = notebook
    picture = os.environ.get("CHIARO_VIEW_PICTURE", str(tmp_path / "page.png"))
    done = subprocess.run(["node", str(HERE / "browser" / "notebook.mjs"), str(PLAYWRIGHT), f"{url}notebooks/view.ipynb?token=letmein", picture], capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stdout + done.stderr
    seen = json.loads(done.stdout.splitlines()[-1])
    assert seen["page_azimuth"] == pytest.approx(80)
    assert seen["dragged_azimuth"] != pytest.approx(80, abs=1)
    assert seen["python_azimuth"] == pytest.approx(seen["dragged_azimuth"], abs=1e-6)

    # What was saved: the picture, and no key.
    text = file.read_text()
    key = seen["frame"].split("key=")[1]
    assert key not in text and "key=" not in text and "token" not in text
    [shown] = [output for output in json.loads(text)["cells"][0]["outputs"] if "image/png" in output.get("data", {})]
    assert set(shown["data"]) >= {"image/png", "text/html"}
    exported = subprocess.run(["/usr/bin/python3", "-m", "nbconvert", "--to", "html", "--stdout", str(file)], capture_output=True, text=True)
    assert exported.returncode == 0, exported.stderr
    assert "data:image/png;base64," in exported.stdout and key not in exported.stdout


class Proxy:
    """A reverse proxy with https: what lies below its prefix goes to the viewer, bytes as they are; / is a page that frames it."""

    prefix = "/user/ann/proxy/1/"

    def __init__(self, folder, to):
        import ssl
        import threading

        key, certificate = folder / "key.pem", folder / "cert.pem"
        subprocess.run(["openssl", "req", "-x509", "-newkey", "rsa:2048", "-nodes", "-days", "2", "-subj", "/CN=hub.test", "-keyout", key, "-out", certificate], check=True, capture_output=True)
        self.context = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
        self.context.load_cert_chain(certificate, key)
        self.listener = socket.create_server(("127.0.0.1", 0))
        self.port = self.listener.getsockname()[1]
        self.to, self.framed, self.refused = to, "", []
        self.threads = threading
        threading.Thread(target=self.accept, daemon=True).start()

    def accept(self):
        while True:
            try:
                plain, _ = self.listener.accept()
            except OSError:
                return
            self.threads.Thread(target=self.serve, args=(plain,), daemon=True).start()

    def serve(self, plain):
        try:
            with self.context.wrap_socket(plain, server_side=True) as client:
                head = b""
                while b"\r\n\r\n" not in head:
                    piece = client.recv(65536)
                    if not piece:
                        return
                    head += piece
                path = head.split(b" ")[1].decode()
                if path == "/":
                    body = f"<!doctype html><iframe src='{self.framed}' style='width:980px;height:680px;border:0'></iframe>".encode()
                    client.sendall(b"HTTP/1.1 200 OK\r\nContent-Type: text/html\r\nConnection: close\r\nContent-Length: %d\r\n\r\n" % len(body) + body)
                elif path.startswith(self.prefix):
                    self.tunnel(client, head)
                else:
                    self.refused.append(path)
                    client.sendall(b"HTTP/1.1 404 Not Found\r\nConnection: close\r\nContent-Length: 0\r\n\r\n")
        except OSError:
            pass

    def tunnel(self, client, head):
        import select

        with socket.create_connection(("127.0.0.1", self.to())) as server:
            server.sendall(head)
            while True:
                ready = [client] if client.pending() else select.select([client, server], [], [])[0]
                for source in ready:
                    piece = source.recv(65536)
                    if not piece:
                        return
                    (server if source is client else client).sendall(piece)


@pytest.mark.skipif(not shutil.which("openssl"), reason="no openssl")
def test_it_works_behind_a_proxy(tmp_path, monkeypatch):
    import chiaro

    views = []
    proxy = Proxy(tmp_path, lambda: views[0].port)
    monkeypatch.setenv("CHIARO_VIEW_URL", f"https://hub.test:{proxy.port}{proxy.prefix}")
    views.append(chiaro.view(chiaro.sample("tubes", 32), lighting="none", embed_from=[], threads=2))
    [view] = views
    try:
        proxy.framed = view.url_of_one_visit()
        assert proxy.framed.startswith(f"https://hub.test:{proxy.port}{proxy.prefix}?key=")
        done = subprocess.run(["node", str(HERE / "browser" / "proxy.mjs"), str(PLAYWRIGHT), f"https://hub.test:{proxy.port}/"], capture_output=True, text=True, timeout=200)
        assert done.returncode == 0, done.stdout + done.stderr
        seen = json.loads(done.stdout.splitlines()[-1])
        assert seen["frame"] == proxy.framed and seen["azimuth"] != pytest.approx(35, abs=1)
        assert view.scene.azimuth == pytest.approx(seen["azimuth"], abs=1e-6)
        assert not [path for path in proxy.refused if path != "/favicon.ico"], "the page asked beside its prefix"
    finally:
        view.stop()
        proxy.listener.close()

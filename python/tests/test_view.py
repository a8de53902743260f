"""The viewer's server within Python."""

import gc
import os
import signal
import socket
import subprocess
import sys
import time
import urllib.error
import urllib.request

import chiaro
import numpy as np
import pytest


def status(url):
    try:
        return urllib.request.urlopen(url).status
    except urllib.error.HTTPError as error:
        return error.code


@pytest.fixture
def view(blob):
    v = chiaro.view(chiaro.Volume(blob, frame="RAS"), size=(64, 48), threads=1)
    yield v
    v.stop()


def test_a_key_is_good_once_and_no_token_is_in_it(view):
    url = view.url_of_one_visit()
    token = view.url.split("token=")[1]
    assert token not in url and status(url) == 200 and status(url) == 403
    page = urllib.request.urlopen(view.url_of_one_visit()).read().decode()
    assert token not in page and 'name="chiaro-visit"' in page
    assert status(f"http://localhost:{view.port}/") == 403


def test_the_scene_goes_both_ways(view, blob):
    assert view.scene.azimuth == 35 and view.scene.volume is view._volume
    view.camera.azimuth += 45
    view.transfer = "gray"
    assert view.scene.azimuth == 80 and view.azimuth == 80 and view.scene.transfer == "gray"
    view.scene = view.scene.with_(mode="mip")
    np.testing.assert_array_equal(np.asarray(view.snapshot()), np.asarray(chiaro.render(view.scene, threads=1)))
    assert np.asarray(view.snapshot(size=(20, 10))).shape == (10, 20, 3) and view.scene.size == (64, 48)
    with pytest.raises(AttributeError, match="did you mean 'azimuth'"):
        view.azimut = 3
    with pytest.raises(ValueError):
        view.step = 0


def test_stopping_leaves_nothing(blob):
    chiaro.view(blob, threads=1).stop()
    gc.collect()
    before = len(os.listdir("/proc/self/task")), len(os.listdir("/proc/self/fd"))
    for _ in range(10):
        v = chiaro.view(blob, threads=1)
        port = v.port
        v.stop(), v.stop()
        with pytest.raises(OSError):
            socket.create_connection(("127.0.0.1", port), 1).close()
        del v
    gc.collect()
    assert (len(os.listdir("/proc/self/task")), len(os.listdir("/proc/self/fd"))) <= before


def test_behind_a_hub_the_address_is_the_hubs(blob, monkeypatch):
    monkeypatch.setenv("CHIARO_VIEW_URL", "https://hub.example.org/user/ann/proxy/{port}/")
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    v = chiaro.view(blob, port=port, threads=1)
    url = v.url_of_one_visit()
    assert url.startswith(f"https://hub.example.org/user/ann/proxy/{port}/?key=")
    answer = urllib.request.urlopen(url.replace("https://hub.example.org", f"http://localhost:{port}"))
    assert "https://hub.example.org" in answer.headers["Content-Security-Policy"]
    v.stop()
    with pytest.raises(ValueError, match="must be an origin"):
        chiaro.view(blob, embed_from=["hub.example.org"])


def test_it_ends_with_its_process():
    script = "import chiaro, time; v = chiaro.view('sample:ball:16'); print(v.port, flush=True); time.sleep(600)"
    kernel = subprocess.Popen([sys.executable, "-c", script], stdout=subprocess.PIPE, text=True, env={**os.environ, "DISPLAY": ""})
    port = int(kernel.stdout.readline())
    socket.create_connection(("127.0.0.1", port)).close()
    kernel.send_signal(signal.SIGKILL)
    kernel.wait()
    end = time.monotonic() + 2
    while time.monotonic() < end:
        try:
            socket.create_connection(("127.0.0.1", port)).close()
        except ConnectionRefusedError:
            return
        time.sleep(0.05)
    pytest.fail("the server is still there after two seconds")

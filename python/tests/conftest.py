import os
import socket
import subprocess
import sys

import numpy as np
import pytest

os.environ.setdefault("XDG_CACHE_HOME", "/tmp/chiaro-python-tests-cache")

import chiaro
from chiaro.__main__ import program

# Tests of servers and kernels talk to this machine itself, which `unshare -n` takes away.
TALKING = ("test_view.py", "test_view_browser.py", "test_notebooks.py")


def has_loopback():
    try:
        with socket.create_server(("127.0.0.1", 0)) as server:
            socket.create_connection(server.getsockname(), 1).close()
        return True
    except OSError:
        return False


def pytest_collection_modifyitems(items):
    if has_loopback():
        return
    for item in items:
        if item.path.name in TALKING:
            item.add_marker(pytest.mark.skip(reason="no loopback: ip link set lo up"))


@pytest.fixture
def blob():
    """(z, y, x) uint16 with structure of its own along every axis."""
    z, y, x = np.mgrid[:20, :24, :28]
    r = np.sqrt((z - 9) ** 2 + (y - 12) ** 2 + ((x - 13) * 0.8) ** 2)
    return (np.exp(-((r / 7) ** 2)) * 1000 + 5 * z + 3 * y + x).astype(np.uint16)


@pytest.fixture
def tool():
    """Runs the tool of the package."""

    def run(*arguments, code=0):
        done = subprocess.run([program(), *map(str, arguments)], capture_output=True, text=True)
        assert done.returncode == code, done.stderr
        return done.stdout

    return run


@pytest.fixture
def python():
    """Runs a script in an interpreter of its own and returns what it printed."""

    def run(script, *arguments, code=0, **environment):
        done = subprocess.run([sys.executable, "-c", script, *map(str, arguments)], capture_output=True, text=True, env={**os.environ, **environment})
        assert done.returncode == code, done.stdout + done.stderr
        return done.stdout

    return run


SMALL = {"size": (64, 48), "threads": 1}


@pytest.fixture
def small():
    return dict(SMALL)


@pytest.fixture
def picture(small):
    """A small picture of something, as an array."""
    return lambda volume, **settings: np.asarray(chiaro.render(volume, **{**small, **settings})).copy()

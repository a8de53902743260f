"""What pip is told where something is missing; needs the sources beside the tests."""

import os
import pathlib
import subprocess
import sys

import pytest

BACKEND = pathlib.Path(__file__).parent.parent / "build_tools"
pytestmark = pytest.mark.skipif(not BACKEND.is_dir(), reason="no sources")


def build(tmp_path, hidden=(), path=None):
    """Asks the backend for a wheel where modules are hidden or programs missing."""
    script = f"""
import importlib.util, sys
sys.path.insert(0, {str(BACKEND)!r})
find = importlib.util.find_spec
importlib.util.find_spec = lambda name, *rest: None if name in {tuple(hidden)!r} else find(name, *rest)
import backend
backend.build_wheel({str(tmp_path)!r})
"""
    return subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, env={**os.environ, **({"PATH": path} if path else {})})


@pytest.mark.parametrize("module, package", [("wheel", "python3-wheel"), ("setuptools", "python3-setuptools")])
def test_a_missing_module_is_one_sentence(module, package, tmp_path):
    done = build(tmp_path, hidden=[module])
    assert done.returncode == 1 and done.stderr == f"chiaro cannot be built here: apt install {package}\n"


def test_missing_programs_are_one_sentence(tmp_path):
    done = build(tmp_path, path=str(tmp_path))
    assert done.returncode == 1 and done.stderr == "chiaro cannot be built here: apt install cmake ninja-build patchelf g++\n"

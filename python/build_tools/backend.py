"""What pip builds the package with: setuptools, once all that it needs is there; else one sentence that names it."""

from __future__ import annotations

import importlib.util
import os
import shutil
import sys

# What is asked for, and the Debian package that has it.
MODULES = {"setuptools": "python3-setuptools", "wheel": "python3-wheel"}
PROGRAMS = {"cmake": "cmake", "ninja": "ninja-build", "patchelf": "patchelf"}


def has_pybind11() -> bool:
    """As a Debian package, or as one of Python's."""
    return os.path.isdir("/usr/include/pybind11") or importlib.util.find_spec("pybind11") is not None


def missing() -> list[str]:
    """Debian packages that a build lacks."""
    found = [package for module, package in MODULES.items() if importlib.util.find_spec(module) is None]
    found += [package for program, package in PROGRAMS.items() if shutil.which(program) is None]
    if not any(shutil.which(name) for name in (os.environ.get("CXX", "c++"), "c++", "g++", "clang++")):
        found.append("g++")
    import sysconfig

    if not os.path.exists(os.path.join(sysconfig.get_path("include"), "Python.h")):
        found.append("python3-dev")
    if not has_pybind11():
        found.append("pybind11-dev")
    return found


def _setuptools():  # type: ignore[no-untyped-def]
    lacking = missing()
    if lacking:
        sys.stderr.write(f"chiaro cannot be built here: apt install {' '.join(lacking)}\n")
        sys.exit(1)
    import setuptools.build_meta

    return setuptools.build_meta


def _hook(name: str):  # type: ignore[no-untyped-def]
    def call(*arguments, **named):  # type: ignore[no-untyped-def]
        return getattr(_setuptools(), name)(*arguments, **named)

    call.__name__ = name
    return call


build_wheel = _hook("build_wheel")
build_sdist = _hook("build_sdist")
build_editable = _hook("build_editable")
prepare_metadata_for_build_wheel = _hook("prepare_metadata_for_build_wheel")
prepare_metadata_for_build_editable = _hook("prepare_metadata_for_build_editable")


def _requires(name: str):  # type: ignore[no-untyped-def]
    def call(*arguments, **named):  # type: ignore[no-untyped-def]
        try:
            import setuptools.build_meta
        except ImportError:
            return []  # the build itself tells
        found = getattr(setuptools.build_meta, name)(*arguments, **named)
        return found if has_pybind11() else [*found, "pybind11>=2.10"]

    return call


get_requires_for_build_wheel = _requires("get_requires_for_build_wheel")
get_requires_for_build_sdist = _requires("get_requires_for_build_sdist")
get_requires_for_build_editable = _requires("get_requires_for_build_editable")

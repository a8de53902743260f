"""Builds the engine with CMake, puts the package together and makes it stand alone."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

from setuptools import Distribution, setup
from setuptools.command.build_ext import build_ext
from setuptools.command.sdist import sdist
from setuptools.extension import Extension

try:
    from wheel.bdist_wheel import bdist_wheel
except ImportError:
    from setuptools.command.bdist_wheel import bdist_wheel

here = Path(__file__).resolve().parent
sys.path.insert(0, str(here / "build_tools"))
import bundle  # noqa: E402
import stubs  # noqa: E402

# In a clone the engine lies around this folder; in a source archive within it.
engine = here / "engine" if (here / "engine").is_dir() else here.parent
# What of the engine a source archive needs.
SOURCES = ["CMakeLists.txt", "LICENSE", "cmake", "include", "src", "server", "cli", "viewer"]


def version() -> str:
    [found] = re.findall(r"project\(chiaro VERSION ([0-9.]+)", (engine / "CMakeLists.txt").read_text())
    return found


class CMakeBuild(build_ext):
    """The extension, with all that lies beside it."""

    def get_ext_filename(self, name: str) -> str:
        return super().get_ext_filename(name)

    def run(self) -> None:
        build = Path(os.environ.get("CHIARO_BUILD_DIR", engine / "build-python")).resolve()
        configure = ["cmake", "-S", str(engine), "-B", str(build), "-DCHIARO_PYTHON=ON", f"-DPython_EXECUTABLE={sys.executable}"]
        if not (build / "CMakeCache.txt").exists():
            configure += ["-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release", "-DCHIARO_TESTS=OFF"]
        configure += os.environ.get("CHIARO_CMAKE_ARGS", "").split()
        subprocess.run(configure, check=True)
        subprocess.run(["cmake", "--build", str(build), "--target", "python_package"], check=True)
        package = here / "chiaro" if self.inplace or self.editable_mode else Path(self.build_lib) / "chiaro"
        package.mkdir(parents=True, exist_ok=True)
        shutil.rmtree(package / "_native", ignore_errors=True)
        subprocess.run(["cmake", "--install", str(build), "--component", "python", "--prefix", str(package.resolve())], check=True)
        taken = bundle.bundle(str(package))
        bundle.licences(taken, str(package / "_native" / "licenses"))
        stubs.write(str(package))
        print(f"chiaro: starts with glibc {bundle.least_glibc(str(package))} or later")

    def get_outputs(self) -> list[str]:
        package = Path(self.build_lib) / "chiaro"
        return [str(path) for path in package.rglob("*") if path.is_file()]

    def get_output_mapping(self) -> dict[str, str]:
        return {}


class Wheel(bdist_wheel):
    """With the licences of what it bundles where tools look for them."""

    def egg2dist(self, egginfo_path: str, distinfo_path: str) -> None:
        super().egg2dist(egginfo_path, distinfo_path)
        licences = Path(distinfo_path) / "licenses"
        licences.mkdir(exist_ok=True)
        shutil.copyfile(engine / "LICENSE", licences / "LICENSE")
        root = Path(self.bdist_dir) if getattr(self, "bdist_dir", None) else Path(distinfo_path).parent
        bundled = root / "chiaro" / "_native" / "licenses"
        if bundled.is_dir():
            for text in bundled.iterdir():
                shutil.copyfile(text, licences / text.name)
            shutil.rmtree(bundled)


class SourceArchive(sdist):
    """With the engine that it is built from."""

    def make_release_tree(self, base_dir: str, files: list[str]) -> None:
        super().make_release_tree(base_dir, files)
        to = Path(base_dir) / "engine"
        leave_out = shutil.ignore_patterns("__pycache__", "node_modules", "test.cpp")
        for name in SOURCES:
            source = engine / name
            if source.is_dir():
                shutil.copytree(source, to / name, ignore=leave_out, dirs_exist_ok=True)
            else:
                to.mkdir(parents=True, exist_ok=True)
                shutil.copyfile(source, to / name)
        for name in ("CMakeLists.txt", "src"):
            source = engine / "python" / name
            target = to / "python" / name
            target.parent.mkdir(parents=True, exist_ok=True)
            shutil.copytree(source, target) if source.is_dir() else shutil.copyfile(source, target)
        for name in ("build_tools", "tests", "notebooks"):
            if (here / name).is_dir():
                shutil.copytree(here / name, Path(base_dir) / name, ignore=leave_out, dirs_exist_ok=True)


class BinaryDistribution(Distribution):
    def has_ext_modules(self) -> bool:
        return True


setup(
    version=version(),
    distclass=BinaryDistribution,
    ext_modules=[Extension("chiaro._chiaro", [])],
    cmdclass={"build_ext": CMakeBuild, "bdist_wheel": Wheel, "sdist": SourceArchive},
)

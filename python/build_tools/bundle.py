"""Makes a package stand alone: the libraries that a bare system lacks lie beside it, under names of their own."""

from __future__ import annotations

import glob
import hashlib
import os
import re
import shutil
import subprocess

# Of every system with this C library; the standard library of C++ comes with it, wherever numpy is. A sanitizer is the process's own.
OF_THE_SYSTEM = re.compile(r"^(linux-vdso|ld-linux.*|lib(c|m|mvec|dl|rt|pthread|resolv|nsl|util|anl|gcc_s|stdc\+\+|asan|ubsan)\.so.*)$")
# No interpreter's process may load these (GPL): helper programs alone do.
HELPERS_ONLY = re.compile(r"^libjbig")


def _run(*command: str) -> str:
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout


def _needed(path: str) -> list[str]:
    return _run("patchelf", "--print-needed", path).split()


def _found(path: str) -> dict[str, str]:
    """Where the loader finds each library that the file, or one of those, needs."""
    lines = (line.split() for line in _run("ldd", path).splitlines())
    return {words[0]: words[2] for words in lines if len(words) > 2 and words[1] == "=>" and os.path.isabs(words[2])}


def _own_name(path: str) -> str:
    """libtbb.so.12 of these very bytes: libtbb-1a2b3c4d.so.12."""
    with open(path, "rb") as file:
        digest = hashlib.sha256(file.read()).hexdigest()[:8]
    name, rest = os.path.basename(path).split(".so", 1)
    return f"{name}-{digest}.so{rest}"


def bundle(package: str) -> list[str]:
    """Completes the folder of a package; returns the files of the system that were taken along."""
    native, lib = os.path.join(package, "_native"), os.path.join(package, "_native", "lib")
    extension = glob.glob(os.path.join(package, "_chiaro.*.so"))
    programs = [path for path in glob.glob(os.path.join(native, "*")) if os.path.isfile(path)]
    own = [path for path in glob.glob(os.path.join(lib, "*.so*"))]
    taken: dict[str, str] = {}  # name in the system: file there
    for path in [*extension, *programs, *own]:
        for name, file in _found(path).items():
            if not OF_THE_SYSTEM.match(name) and not name.startswith("libchiaro-python"):
                taken.setdefault(name, os.path.realpath(file))
    names = {name: _own_name(file).replace(os.path.basename(file).split(".so", 1)[1], name.split(".so", 1)[1]) for name, file in taken.items()}
    for name, file in taken.items():
        copy = os.path.join(lib, names[name])
        shutil.copyfile(file, copy)
        os.chmod(copy, 0o755)
        subprocess.run(["strip", "--strip-unneeded", copy], check=True)
        _run("patchelf", "--set-soname", names[name], copy)
    for path in [*extension, *programs, *own, *(os.path.join(lib, names[name]) for name in taken)]:
        if path not in (os.path.join(lib, n) for n in names.values()):
            subprocess.run(["strip", "--strip-unneeded", path], check=True)
        for name in _needed(path):
            if name in names:
                _run("patchelf", "--replace-needed", name, names[name], path)
        origin = "$ORIGIN" if os.path.dirname(path) == lib else "$ORIGIN/_native/lib" if path in extension else "$ORIGIN/lib"
        _run("patchelf", "--set-rpath", origin, path)
    _refuse_helpers_libraries(extension, lib)
    return sorted(taken.values())


def _refuse_helpers_libraries(extension: list[str], lib: str) -> None:
    """Nothing that only helper programs may use is reached from the extension or the library."""
    waiting, seen = list(extension), set()
    while waiting:
        path = waiting.pop()
        for name in _needed(path):
            if HELPERS_ONLY.match(name):
                raise SystemExit(f"{path} needs {name}, which only helper programs may")
            beside = os.path.join(lib, name)
            if os.path.exists(beside) and beside not in seen:
                seen.add(beside)
                waiting.append(beside)


def least_glibc(package: str) -> str:
    """The oldest C library that everything in the package starts with."""
    versions = [(2, 0)]
    for root, _, files in os.walk(package):
        for name in files:
            path = os.path.join(root, name)
            with open(path, "rb") as file:
                if file.read(4) != b"\x7fELF":
                    continue
            found = re.findall(r"GLIBC_2\.(\d+)", _run("objdump", "-T", path))
            versions += [(2, int(minor)) for minor in found]
    return "{}.{}".format(*max(versions))


def licences(files: list[str], to: str) -> None:
    """What Debian says of the licences of the files' packages, one text for each."""
    os.makedirs(to, exist_ok=True)
    for file in files:
        for place in (file, file.replace("/usr/lib/", "/lib/")):
            found = subprocess.run(["dpkg-query", "-S", place], capture_output=True, text=True).stdout
            if found:
                break
        package = found.split(":")[0] if found else os.path.basename(file)
        text = f"/usr/share/doc/{package}/copyright"
        target = os.path.join(to, f"{package}.txt")
        if os.path.exists(text):
            shutil.copyfile(os.path.realpath(text), target)
        elif not os.path.exists(target):
            with open(target, "w", encoding="utf-8") as out:
                out.write(f"{os.path.basename(file)}: from a package that left no copyright file on the machine of the build\n")

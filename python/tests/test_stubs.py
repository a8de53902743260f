"""The stubs are made when the package is built; they are what the package is."""

import ast
import inspect
import os
import pathlib
import shutil
import subprocess
import sys

import chiaro
import pytest
from chiaro import _settings

STUB = pathlib.Path(chiaro.__file__).with_name("__init__.pyi")
HERE = pathlib.Path(__file__).parent


@pytest.fixture
def mypy(tmp_path):
    """Checks files against the stubs, which are copied: errors in installed packages are passed over."""
    module = [sys.executable, "-m", "mypy"]
    if subprocess.run([*module, "--version"], capture_output=True).returncode != 0:
        pytest.skip("no mypy")
    copy = tmp_path / "stubs" / "chiaro" / "__init__.pyi"
    copy.parent.mkdir(parents=True)
    copy.write_text(STUB.read_text())
    options = ["--no-incremental", "--cache-dir=/dev/null", "--strict"]

    def check(*files, path=copy.parent.parent):
        return subprocess.run([*module, *options, *map(str, files)], capture_output=True, text=True, env={**os.environ, "MYPYPATH": str(path)}, cwd=tmp_path)

    return check, copy


def test_they_and_what_users_write_pass_strictly(mypy):
    check, stub = mypy
    done = check(stub, HERE / "usage.py")
    assert done.returncode == 0, done.stdout + done.stderr


def test_the_package_itself_passes_strictly(mypy, tmp_path):
    check, stub = mypy
    shutil.copytree(STUB.parent, tmp_path / "code" / "chiaro", ignore=shutil.ignore_patterns("_native", "*.so", "__init__.pyi"))
    done = check("--ignore-missing-imports", "--allow-untyped-calls", *sorted((tmp_path / "code" / "chiaro").glob("*.py")), path=tmp_path / "code")
    assert done.returncode == 0, done.stdout + done.stderr


def test_wrong_uses_are_found(tmp_path, mypy):
    wrong = tmp_path / "wrong.py"
    wrong.write_text('import chiaro\nchiaro.render("a", lightning="spao")\nchiaro.render("a", lighting="transprot")\nchiaro.Session("a").camera.azimuth = "x"\n')
    said = mypy[0](wrong).stdout
    assert said.count("error:") == 3, said


def test_they_name_all_that_is_there():
    tree = ast.parse(STUB.read_text())
    told = {node.name: node for node in tree.body if isinstance(node, (ast.FunctionDef, ast.ClassDef))}
    public = [name for name in chiaro.__all__ if name != "__version__"]
    assert set(public) <= set(told), set(public) - set(told)
    for name in public:
        thing = getattr(chiaro, name)
        if inspect.isclass(thing):
            members = {n for n in vars(thing) if not n.startswith("_")}
            said = {getattr(n, "name", None) or getattr(getattr(n, "target", None), "id", None) for n in told[name].body}
            assert members - said - {"code"} <= {"probe_used"}, (name, members - said)
    for name in ("render", "illuminate"):
        keywords = {a.arg for a in told[name].args.kwonlyargs}
        assert set(_settings.table()) <= keywords

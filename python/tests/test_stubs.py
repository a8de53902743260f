"""The stubs are made when the package is built; they are what the package is."""

import ast
import inspect
import os
import pathlib
import subprocess
import sys

import chiaro
import pytest
from chiaro import _settings

STUB = pathlib.Path(chiaro.__file__).with_name("__init__.pyi")
HERE = pathlib.Path(__file__).parent


def mypy(*arguments):
    module = [sys.executable, "-m", "mypy"]
    if subprocess.run([*module, "--version"], capture_output=True).returncode != 0:
        pytest.skip("no mypy")
    return subprocess.run([*module, "--no-incremental", "--cache-dir=/dev/null", "--strict", *map(str, arguments)], capture_output=True, text=True, env={**os.environ, "MYPYPATH": str(STUB.parent.parent)})


def test_they_and_what_users_write_pass_strictly():
    done = mypy(STUB, HERE / "usage.py")
    assert done.returncode == 0, done.stdout


def test_wrong_uses_are_found(tmp_path):
    wrong = tmp_path / "wrong.py"
    wrong.write_text('import chiaro\nchiaro.render("a", lightning="spao")\nchiaro.render("a", lighting="transprot")\nchiaro.Session("a").camera.azimuth = "x"\n')
    said = mypy(wrong).stdout
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

"""docs/python.md says what the package says; needs the sources beside the tests."""

import pathlib
import re
import sys

import chiaro
import pytest

ROOT = pathlib.Path(__file__).parent.parent.parent
PAGE = ROOT / "docs" / "python.md"
pytestmark = pytest.mark.skipif(not PAGE.exists(), reason="no sources")


def test_its_tables_are_up_to_date():
    sys.path.insert(0, str(ROOT / "python" / "build_tools"))
    import tables

    page = PAGE.read_text()
    assert tables.with_tables(page) == page, "renew with python/build_tools/tables.py docs/python.md"


def test_what_it_names_is_there():
    names = set(re.findall(r"chiaro\.([A-Za-z_]+)", PAGE.read_text()))
    for name in names - {"render"}:
        assert hasattr(chiaro, name), name


def test_the_first_lines_run(tmp_path, monkeypatch):
    """The three lines of the page and the README, with a file of ours."""
    chiaro.write(chiaro.Volume(chiaro.sample("ball", 16).array, frame="RAS"), tmp_path / "scan.nrrd")
    monkeypatch.chdir(tmp_path)
    for page in (PAGE, ROOT / "README.md"):
        code = re.search(r"```python\n(import chiaro.*?)```", page.read_text(), re.S)
        assert code, page
        exec(code[1].replace("scan.nii.gz", "scan.nrrd"), {})

"""The notebooks run from top to bottom, and show pictures of something. CHIARO_NOTEBOOKS_OUT keeps them, to be looked at."""

import base64
import io
import os
import pathlib
import sys

import numpy as np
import pytest

nbformat = pytest.importorskip("nbformat")
nbclient = pytest.importorskip("nbclient")
pytest.importorskip("ipykernel")
pytest.importorskip("matplotlib")

FOLDER = pathlib.Path(__file__).parent.parent / "notebooks"
NEEDS = {"4": ["nibabel", "xarray", "dask"]}
PICTURES = {"1": 3, "2": 4, "3": 4, "4": 3, "5": 1, "6": 1}


@pytest.fixture
def kernel(tmp_path, monkeypatch):
    """Python as it runs the tests, not as the system knows it."""
    import json

    spec = tmp_path / "share" / "kernels" / "python3"
    spec.mkdir(parents=True)
    (spec / "kernel.json").write_text(json.dumps({"argv": [sys.executable, "-m", "ipykernel_launcher", "-f", "{connection_file}"], "display_name": "Python 3", "language": "python"}))
    monkeypatch.setenv("JUPYTER_PATH", str(tmp_path / "share"))
    return tmp_path


@pytest.mark.parametrize("path", sorted(FOLDER.glob("*.ipynb")), ids=lambda p: p.stem)
def test_it_runs_and_shows_pictures(path, kernel):
    for module in NEEDS.get(path.stem[0], []):
        pytest.importorskip(module)
    notebook = nbformat.read(path, as_version=4)
    assert all(not cell.get("outputs") for cell in notebook.cells), "notebooks are kept without outputs"
    nbclient.NotebookClient(notebook, timeout=600, kernel_name="python3", resources={"metadata": {"path": str(kernel)}}).execute()
    pictures = [base64.b64decode(output["data"]["image/png"]) for cell in notebook.cells for output in cell.get("outputs", []) if "image/png" in output.get("data", {})]
    assert len(pictures) >= PICTURES[path.stem[0]]
    from PIL import Image

    for k, png in enumerate(pictures):
        pixels = np.asarray(Image.open(io.BytesIO(png)).convert("RGB")).astype(int)
        assert pixels.std() > 5, "a picture of nothing"
        if out := os.environ.get("CHIARO_NOTEBOOKS_OUT"):
            pathlib.Path(out).mkdir(parents=True, exist_ok=True)
            (pathlib.Path(out) / f"{path.stem}-{k}.png").write_bytes(png)

"""Run in a bare root by scripts/try_python: reads one file of each kind, and uses the tool. Needs numpy alone.

bare.py FOLDER, with expected.npy and volume.nrrd, .tif, .h5 and a folder of DICOM slices, all of the same voxels.
"""

import os
import re
import subprocess
import sys
import urllib.request

import chiaro
import numpy as np

folder = sys.argv[1]
expected = np.load(os.path.join(folder, "expected.npy"))
for name in ("volume.nrrd", "volume.tif", "volume.h5", "dicom"):
    volume = chiaro.read(os.path.join(folder, name))
    np.testing.assert_array_equal(volume.to_numpy(), expected)
    image = chiaro.render(volume, size=(64, 48), lighting="visibility", probe="sky")
    print(f"{name}: {volume.format}, {np.asarray(image).mean():.2f}")
    image.save(os.path.join(folder, "picture.png"))
    image.save(os.path.join(folder, "picture.exr"))

tool = [sys.executable, "-m", "chiaro"]
print(subprocess.run([*tool, "--version"], check=True, capture_output=True, text=True).stdout.splitlines()[0])
subprocess.run([*tool, "render", os.path.join(folder, "volume.tif"), "-o", os.path.join(folder, "tool.png"), "--size", "64x48", "--lighting", "visibility", "--probe", "sky", "--quiet"], check=True)
chiaro.render(os.path.join(folder, "volume.tif"), size=(64, 48), lighting="visibility", probe="sky").save(os.path.join(folder, "python.png"))
pictures = [open(os.path.join(folder, name), "rb").read() for name in ("tool.png", "python.png")]
assert pictures[0] == pictures[1], "the tool's picture is another"

viewer = subprocess.Popen([*tool, "view", os.path.join(folder, "volume.nrrd"), "--no-open", "--port", "0", "--quiet"], stdout=subprocess.PIPE, text=True)
try:
    address = viewer.stdout.readline().strip().replace("localhost", "127.0.0.1")  # a bare root knows no names
    page = urllib.request.urlopen(address).read().decode()
    assert re.search("<title>.*Chiaro", page, re.S), page[:200]
    print("chiaro view answers")
finally:
    viewer.terminate()
    viewer.wait()

"""Figures of the package on this machine: benchmark.py [--size N] [--quick]. Medians; ratios are of things measured in turns."""

from __future__ import annotations

import argparse
import importlib.util
import os
import signal
import statistics
import subprocess
import sys
import tempfile
import threading
import time
from typing import Callable

import numpy as np

del sys.path[0]  # this folder: it is the package that is installed that is measured, not its sources
import chiaro
from chiaro.__main__ import program


def seconds(work: Callable[[], object]) -> float:
    begun = time.perf_counter()
    work()
    return time.perf_counter() - begun


def importing(runs: int) -> None:
    script = "import time, numpy; b = time.perf_counter(); import chiaro; print(time.perf_counter() - b)"
    took = [float(subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True).stdout) for _ in range(runs)]
    print(f"import beyond numpy: {1e3 * statistics.median(took):.1f} ms (at most 60)")


def overhead(runs: int) -> None:
    """A call, minus what the library says that its stages took."""
    session = chiaro.Session(chiaro.sample("ball", 16), size=(64, 64))
    session.image()
    over = []
    for k in range(runs):
        begun = time.perf_counter()
        image = session.image(azimuth=float(k % 360))
        np.asarray(image)
        over.append(time.perf_counter() - begun - sum(stage["seconds"] for stage in image.stats["stages"]))
    print(f"overhead of a call (64 × 64, 16³): {1e3 * statistics.median(over):.2f} ms (at most 5)")


def first_picture(size: int, runs: int) -> None:
    """The array to its first picture, and the tool from a raw file to its own."""
    z, y, x = np.ogrid[:size, :size, :size]
    c = (size - 1) / 2
    r = np.sqrt((x - c) ** 2 + (y - c) ** 2 + (z - c) ** 2) / c
    a = (1000 * np.exp(-(((r - 0.6) / 0.1) ** 2))).astype(np.uint16)
    del r
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, f"a_{size}x{size}x{size}_uint16.raw")
        a.tofile(path)
        settings = {"transfer": "gray", "size": (1024, 768)}
        flags = ["--transfer", "gray", "--size", "1024x768", "--quiet"]
        ours, tools = [], []
        for _ in range(runs + 1):
            ours.append(seconds(lambda: chiaro.render(a, **settings).save(os.path.join(folder, "a.png"))))
            tools.append(seconds(lambda: subprocess.run([program(), "render", path, "-o", os.path.join(folder, "b.png"), *flags], check=True)))
    ratio = statistics.median(o / t for o, t in zip(ours[1:], tools[1:]))
    print(f"numpy {size}³ uint16 to first picture: {statistics.median(ours[1:]):.2f} s, tool {statistics.median(tools[1:]):.2f} s, ratio {ratio:.2f} (at most 1.1)")


PEAK = """
import sys, numpy as np, chiaro
def peak():
    return next(int(line.split()[1]) * 1024 for line in open("/proc/self/status") if line.startswith("VmHWM"))
n, light, picture = int(sys.argv[1]), sys.argv[2], tuple(map(int, sys.argv[3:5]))
z, y, x = np.ogrid[:n, :n, :n]
a = np.empty((n, n, n), "u2")
for k in range(n):
    a[k] = (x[0] * 3 + y[0] * 5 + k * 7) % 4096
chiaro.render("sample:ball:16", size=(64, 48))
open("/proc/self/clear_refs", "w").write("5")
before = peak()
chiaro.render(a, lighting=light, size=picture)
print(peak() - before)
"""


def peak_memory(size: int) -> None:
    """Of processes of their own that render a fog, which fills the whole volume, beside its array; a small picture tells the volume's part."""
    array = 2 * size**3

    def peak(light: str, *picture: int) -> float:
        return float(subprocess.run([sys.executable, "-c", PEAK, *map(str, (size, light, *picture))], capture_output=True, text=True, check=True).stdout)

    unlit = peak("none", 64, 48)
    print(f"peak memory of {size}³ uint16: the array + {unlit / array:.2f} × the array (at most 1.4)")
    print(f"  a picture of 1024 × 768 adds {(peak('none', 1024, 768) - unlit) / 1e6:.0f} MB")
    for light in ("spao", "visibility", "transport"):
        print(f"  {light} adds {(peak(light, 64, 48) - unlit) / array:.2f} × the array")


LIGHTS = ("none", "spao", "visibility", "histogram", "transport", "reference")
LONG = {"none": {"samples_per_pixel": 64}, "histogram": {"cache": "none"}, "reference": {"reference_rays": 65536}}


def interrupting(size: int, moments: int) -> None:
    """From the signal to KeyboardInterrupt, at moments spread over a second of the first picture of a volume."""
    volume = chiaro.sample("shells", size)
    signal.signal(signal.SIGINT, signal.default_int_handler)  # which a shell has its background do without
    for light in LIGHTS:
        took, ended = [], 0
        for k in range(moments):
            sent = [0.0]

            def send() -> None:
                sent[0] = time.perf_counter()
                os.kill(os.getpid(), signal.SIGINT)

            timer = threading.Timer((k + 0.5) / moments, send)
            timer.start()
            try:
                chiaro.render(volume, lighting=light, **LONG.get(light, {}))
                timer.cancel()
                timer.join()
                ended += 1
            except KeyboardInterrupt:
                took.append(time.perf_counter() - sent[0])
        print(f"Ctrl-C, {light}: {1e3 * statistics.median(took):.0f} ms, {1e3 * max(took):.0f} at most (at most 100), of {len(took)}; {ended} had ended before")


FUNCTION = [(60, 0.9, 0.6, 0.3, 0.0), (110, 0.9, 0.6, 0.3, 0.05), (160, 0.8, 0.8, 0.9, 0.4), (255, 1.0, 1.0, 1.0, 0.6)]
SIZE = (640, 480)


def vtk_picture(a: np.ndarray, eye: tuple, target: tuple) -> np.ndarray:
    """What VTK makes of the array, by the same function and camera: 22 lines."""
    import vtkmodules.vtkRenderingOpenGL2  # noqa: F401
    import vtkmodules.vtkRenderingVolumeOpenGL2  # noqa: F401
    from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
    from vtkmodules.vtkCommonDataModel import vtkImageData, vtkPiecewiseFunction
    from vtkmodules.vtkRenderingCore import vtkColorTransferFunction, vtkRenderer, vtkRenderWindow, vtkVolume, vtkVolumeProperty, vtkWindowToImageFilter
    from vtkmodules.vtkRenderingVolume import vtkFixedPointVolumeRayCastMapper

    image = vtkImageData()
    image.SetDimensions(*a.shape[::-1])
    image.GetPointData().SetScalars(numpy_to_vtk(a.ravel(), deep=False))
    colours, opacity = vtkColorTransferFunction(), vtkPiecewiseFunction()
    for value, r, g, b, o in FUNCTION:
        colours.AddRGBPoint(value, r, g, b), opacity.AddPoint(value, o)
    mapper = vtkFixedPointVolumeRayCastMapper()
    mapper.SetInputData(image)
    looks = vtkVolumeProperty()
    looks.SetColor(colours), looks.SetScalarOpacity(opacity), looks.ShadeOn(), looks.SetInterpolationTypeToLinear()
    volume = vtkVolume()
    volume.SetMapper(mapper), volume.SetProperty(looks)
    renderer, window = vtkRenderer(), vtkRenderWindow()
    renderer.AddVolume(volume)
    window.SetOffScreenRendering(1), window.SetSize(*SIZE), window.AddRenderer(renderer)
    camera = renderer.GetActiveCamera()
    camera.SetPosition(*eye), camera.SetFocalPoint(*target), camera.SetViewUp(0, 0, 1), camera.SetViewAngle(30)
    renderer.ResetCameraClippingRange()
    window.Render()
    grab = vtkWindowToImageFilter()
    grab.SetInput(window), grab.Update()
    return vtk_to_numpy(grab.GetOutput().GetPointData().GetScalars()).reshape(SIZE[1], SIZE[0], 3)[::-1].copy()


def beside_vtk(size: int) -> None:
    if importlib.util.find_spec("vtkmodules") is None:
        print("VTK: not installed (python3-vtk9)")
        return
    if not os.environ.get("DISPLAY"):
        print("VTK: no display, which its window needs (xvfb-run gives one)")
        return
    a = chiaro.sample("shells", size).to_numpy()
    target = ((size - 1) / 2,) * 3
    eye = (target[0] + 2.2 * size, target[1] + 1.3 * size, target[2] + 1.2 * size)
    look = {"transfer": FUNCTION, "eye": eye, "target": target, "fov": 30, "size": SIZE}
    truth = chiaro.reference(a, reference_rays=64, bounces=0, probe="white", **look)
    theirs: list[np.ndarray] = []
    seconds_of_vtk = seconds(lambda: theirs.append(vtk_picture(a, eye, target)))
    print(f"beside VTK on {size}³, {SIZE[0]} × {SIZE[1]}; PSNR of the display values to the ground truth under a white sky:")
    print(f"  VTK, 22 lines: {seconds_of_vtk:.2f} s, {chiaro.compare(theirs[0], truth).psnr:.1f} dB")
    for light in ({"lighting": "none"}, {"lighting": "spao"}, {"lighting": "visibility", "probe": "white", "shading": "none"}):
        ours: list[chiaro.Image] = []
        took = seconds(lambda: ours.append(chiaro.render(a, **light, **look)))
        print(f"  {light['lighting']}, 1 line: {took:.2f} s, {chiaro.compare(ours[0], truth).psnr:.1f} dB")


def main() -> None:
    arguments = argparse.ArgumentParser()
    arguments.add_argument("--size", type=int, default=512)
    arguments.add_argument("--quick", action="store_true")
    given = arguments.parse_args()
    runs = 3 if given.quick else 5
    importing(runs * 2 + 1)
    overhead(20 if given.quick else 100)
    first_picture(64 if given.quick else given.size, runs)
    interrupting(64 if given.quick else 256, 5 if given.quick else 20)
    peak_memory(64 if given.quick else given.size)
    beside_vtk(64 if given.quick else 256)


if __name__ == "__main__":
    main()

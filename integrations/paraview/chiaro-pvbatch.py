#!/usr/bin/env pvbatch
"""Draws a scene of Chiaro's by any number of processes, each with a block of the volume:

    mpirun -np 8 pvbatch chiaro-pvbatch.py FILE... --scene scene.json -o picture.png

FILE is what ParaView reads as image data; several are moments in time. {t} in the picture's name: one of each moment,
else the first. The scene is `chiaro render`'s (docs/scene.md), with the points of its transfer function; of its volume
nothing counts. Exit codes as the tool's: 2 usage, 3 input, 4 what could not be drawn or written.
"""
import argparse
import json
import os
import sys


def arguments():
    parser = argparse.ArgumentParser(prog="chiaro-pvbatch.py", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("files", nargs="+", metavar="FILE")
    parser.add_argument("--scene", required=True, help="scene file, or a picture that carries one")
    parser.add_argument("-o", "--output", required=True, help="PNG, or EXR with the floats; {t}: the moment's number")
    parser.add_argument("--array", help="name of the values to show; the first of the points")
    parser.add_argument("--size", help="WIDTHxHEIGHT instead of the scene's")
    parser.add_argument("--ghost-levels", type=int, default=16, help="of each block: wide light grids need more, and say so")
    parser.add_argument("--plugin", default=os.path.join(os.path.dirname(os.path.abspath(sys.argv[0])), "Chiaro.so"))
    return parser.parse_args()


def fail(code, sentence):
    print(f"chiaro-pvbatch.py: {sentence}", file=sys.stderr)
    sys.stderr.flush()
    sys.stdout.flush()
    os._exit(code)  # the other processes are ended by mpirun


def size_of(options):
    """Width and height in pixels."""
    try:
        if options.size:
            width, height = (int(n) for n in options.size.split("x"))
        else:
            with open(options.scene, encoding="utf-8") as file:
                width, height = json.load(file).get("image", {}).get("size", (1024, 768))
    except UnicodeDecodeError:
        width, height = 1024, 768  # a picture
    except OSError as error:
        fail(3, f"cannot read {options.scene}: {error.strerror}")
    except ValueError as error:
        fail(3, f"{options.size or options.scene}: {error}")
    if not (0 < width <= 16384 and 0 < height <= 16384):
        fail(2, f"a picture of {width} x {height} pixels")
    return width, height


def main():
    options = arguments()
    size = size_of(options)
    is_float = options.output.endswith(".exr")
    if not is_float and not options.output.endswith(".png"):
        fail(2, f"{options.output}: a picture is a .png or an .exr")
    for name in (*options.files, options.plugin):
        if not os.path.exists(name):
            fail(3, f"cannot read {name}: there is no such file")
    from paraview import simple
    from vtkmodules.vtkCommonCore import vtkOutputWindow

    said = []
    vtkOutputWindow.GetInstance().AddObserver("ErrorEvent", lambda *_: said.append("an error, told above"))
    vtkOutputWindow.GetInstance().AddObserver("WarningEvent", lambda *_: said.append("a warning, told above"))
    simple.LoadPlugin(options.plugin, remote=False, ns=globals())
    source = simple.OpenDataFile(options.files if len(options.files) > 1 else options.files[0])
    if source is None:
        fail(3, f"ParaView has no reader for {options.files[0]}")
    simple.UpdatePipeline(proxy=source)
    names = list(source.PointData.keys())
    array = options.array or (names[0] if names else None)
    if array not in names:
        fail(3, f"{options.files[0]} has no values {array or ''} at its points; there are: {', '.join(names) or 'none'}")
    view = simple.CreateRenderView(ViewSize=list(size))
    view.OrientationAxesVisibility = 0
    display = simple.Show(source, view)
    simple.ColorBy(display, ("POINTS", array))
    display.SetRepresentationType("Chiaro")
    display.ChiaroGhostLevels = options.ghost_levels
    display.ChiaroExactCompositing = 1
    display.ChiaroScene = os.path.abspath(options.scene)
    simple.ResetCamera(view)
    times = list(source.TimestepValues) if "{t" in options.output and hasattr(source, "TimestepValues") else []
    for t, time in enumerate(times or [None]):
        if time is not None:
            view.ViewTime = time
        name = options.output.format(t=t)
        if is_float:
            display.ChiaroFrameFile = os.path.abspath(name)
        simple.Render(view)
        if said:
            fail(4, f"{name} was not written: {said[0]}")
        if not is_float:
            simple.SaveScreenshot(name, view, ImageResolution=list(size))
        print(name)


main()

"""One picture, by any number of processes: mpirun -np N pvbatch ranks.py PLUGIN FILE.vti METHOD PICTURE.png. Then zoomed until a block
is off the screen, edited, hidden and shown: none of it may wait for ever."""
import sys

from paraview.simple import *  # noqa: F403

plugin, file, method, picture = sys.argv[1:5]
LoadPlugin(plugin, remote=False, ns=globals())
source = OpenDataFile(file)
UpdatePipeline(proxy=source)
values = source.PointData.GetArray(0)
low, high = values.GetRange()


def at(share):
    return low + share * (high - low)


view = CreateRenderView(ViewSize=[480, 360])
view.UseColorPaletteForBackground = 0
view.Background = [0.2, 0.22, 0.25]
view.OrientationAxesVisibility = 0
display = Show(source, view)
ColorBy(display, ("POINTS", values.Name))
GetColorTransferFunction(values.Name).RGBPoints = [at(0), 0.2, 0.3, 0.7, at(0.5), 0.9, 0.8, 0.6, at(1), 0.8, 0.2, 0.1]
opacity = GetOpacityTransferFunction(values.Name)
opacity.Points = [at(0), 0, 0.5, 0, at(0.35), 0, 0.5, 0, at(0.6), 0.5, 0.5, 0, at(1), 0.9, 0.5, 0]
display.SetRepresentationType("Chiaro")
ResetCamera(view)
middle = list(view.CameraFocalPoint)
view.CameraPosition = [c + d for c, d in zip(middle, (130, 170, 90))]
view.CameraViewUp = [0, 0, 1]
display.ChiaroLighting = method
display.ChiaroTransportError = "0.05"
display.ChiaroInterpolation = "linear"
display.ChiaroEarlyTermination = 0
SaveScreenshot(picture, view, ImageResolution=[480, 360])

view.CameraFocalPoint = [c + d for c, d in zip(middle, (0, 0, 60))]
view.CameraPosition = [c + d for c, d in zip(middle, (20, 30, 60))]
Render(view)
opacity.Points = [at(0), 0, 0.5, 0, at(0.5), 0, 0.5, 0, at(0.7), 0.5, 0.5, 0, at(1), 0.9, 0.5, 0]
Render(view)
Hide(source, view)
Render(view)
Show(source, view)
Render(view)
print("came through")

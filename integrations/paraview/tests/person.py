"""A person's way, by a script: load the plugin, open a file, choose Chiaro, move a point of the opacity curve, save the state, load it
again. person.py PLUGIN FILE.vti FOLDER: pictures and what was asked of them go to the folder."""
import sys

from paraview.simple import *  # noqa: F403

plugin, file, folder = sys.argv[1:4]
LoadPlugin(plugin, remote=False, ns=globals())


def shot(name):
    SaveScreenshot(f"{folder}/{name}.png", view, ImageResolution=[480, 360], TransparentBackground=0)


paraview.simple._DisableFirstRenderCameraReset()
source = OpenDataFile(file)
UpdatePipeline(proxy=source)
name = source.PointData.GetArray(0).Name
low, high = source.PointData.GetArray(0).GetRange()
view = CreateRenderView(ViewSize=[480, 360])
view.UseColorPaletteForBackground = 0
view.Background = [0.2, 0.22, 0.25]
view.OrientationAxesVisibility = 0
display = Show(source, view)
ColorBy(display, ("POINTS", name))
colours = GetColorTransferFunction(name)
opacity = GetOpacityTransferFunction(name)


def at(share):
    return low + share * (high - low)


colours.RGBPoints = [at(0), 0.2, 0.3, 0.7, at(0.5), 0.9, 0.8, 0.6, at(1), 0.8, 0.2, 0.1]
opacity.Points = [at(0), 0, 0.5, 0, at(0.35), 0, 0.5, 0, at(0.6), 0.5, 0.5, 0, at(1), 0.9, 0.5, 0]
display.SetRepresentationType("Volume")
ResetCamera(view)
view.CameraPosition = [c + d for c, d in zip(view.CameraFocalPoint, (130, 170, 90))]
view.CameraViewUp = [0, 0, 1]
Render(view)
shot("volume")
display.SetRepresentationType("Chiaro")
Render(view)
shot("chiaro")
display.ChiaroLighting = "visibility"
display.ChiaroProbe = "studio"
Render(view)
shot("visibility")
opacity.Points = [at(0), 0, 0.5, 0, at(0.6), 0, 0.5, 0, at(0.75), 0.8, 0.5, 0, at(1), 0.9, 0.5, 0]
Render(view)
shot("edited")
SaveState(f"{folder}/state.pvsm")
ResetSession()
LoadPlugin(plugin, remote=False, ns=globals())
LoadState(f"{folder}/state.pvsm")
view = GetActiveViewOrCreate("RenderView")
display = GetDisplayProperties(GetSources()[next(iter(GetSources()))], view)
assert display.Representation == "Chiaro", display.Representation
assert display.ChiaroLighting == "visibility", display.ChiaroLighting
assert display.ChiaroProbe == "studio", display.ChiaroProbe
Render(view)
shot("loaded")

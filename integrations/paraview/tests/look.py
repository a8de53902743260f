"""What the tests' scripts have in common: the balls of sample.py under one look."""
from paraview.simple import *  # noqa: F403


def open_view(source, size=(480, 360), ghosts=16):
    """A view of its own that shows the source as Chiaro: view, display, opacity curve, and at(share of the range)."""
    UpdatePipeline(proxy=source)
    values = source.PointData.GetArray(0)

    def at(share):
        return 210 * share  # of all moments

    view = CreateRenderView(ViewSize=list(size))
    view.UseColorPaletteForBackground = 0
    view.Background = [0.2, 0.22, 0.25]
    view.OrientationAxesVisibility = 0
    display = Show(source, view)
    ColorBy(display, ("POINTS", values.Name))
    colours = GetColorTransferFunction(values.Name)
    colours.AutomaticRescaleRangeMode = "Never"
    colours.RGBPoints = [at(0), 0.2, 0.3, 0.7, at(0.5), 0.9, 0.8, 0.6, at(1), 0.8, 0.2, 0.1]
    opacity = GetOpacityTransferFunction(values.Name)
    opacity.Points = [at(0), 0, 0.5, 0, at(0.35), 0, 0.5, 0, at(0.6), 0.5, 0.5, 0, at(1), 0.9, 0.5, 0]
    display.SetRepresentationType("Chiaro")
    display.ChiaroGhostLevels = ghosts
    display.ScalarOpacityUnitDistance = 1.7  # ParaView's own choice counts cells, ghosts too
    ResetCamera(view)
    look_from(view, (130, 170, 90))
    display.ChiaroTransportError = "0.05"
    display.ChiaroInterpolation = "linear"
    display.ChiaroEarlyTermination = 0
    return view, display, opacity, at


def look_from(view, offset, aside=(0, 0, 0)):
    """From the middle of the balls, moved aside."""
    view.CameraFocalPoint = [c + d for c, d in zip((40, 32.5, 35.5), aside)]
    view.CameraPosition = [c + d for c, d in zip(view.CameraFocalPoint, offset)]
    view.CameraViewUp = [0, 0, 1]


def shot(view, name):
    SaveScreenshot(name, view, ImageResolution=list(view.ViewSize))

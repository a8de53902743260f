"""VTK's wavelet in Chiaro's light, with a ball in it: wavelet.py [PICTURE.png]; without a picture a window to turn it in."""

import sys

import vtkmodules.vtkInteractionStyle  # noqa: F401
from chiarovtk import vtkChiaroVolumeMapper
from vtkmodules.vtkCommonDataModel import vtkPiecewiseFunction
from vtkmodules.vtkFiltersSources import vtkSphereSource
from vtkmodules.vtkImagingCore import vtkRTAnalyticSource
from vtkmodules.vtkIOImage import vtkPNGWriter
from vtkmodules.vtkRenderingCore import (vtkActor, vtkColorTransferFunction, vtkPolyDataMapper, vtkRenderer, vtkRenderWindow,
                                         vtkRenderWindowInteractor, vtkVolume, vtkVolumeProperty, vtkWindowToImageFilter)

wavelet = vtkRTAnalyticSource()
wavelet.SetWholeExtent(-40, 40, -40, 40, -40, 40)

colours, opacity = vtkColorTransferFunction(), vtkPiecewiseFunction()
for value, r, g, b, o in [(130, 0.9, 0.8, 0.6, 0), (165, 0.9, 0.75, 0.5, 0.25), (210, 0.9, 0.45, 0.25, 0.9), (270, 1, 0.9, 0.8, 1)]:
    colours.AddRGBPoint(value, r, g, b), opacity.AddPoint(value, o)
looks = vtkVolumeProperty()
looks.SetColor(colours), looks.SetScalarOpacity(opacity), looks.SetInterpolationTypeToLinear(), looks.ShadeOn()

mapper = vtkChiaroVolumeMapper()
mapper.SetInputConnection(wavelet.GetOutputPort())
mapper.SetLighting("visibility")
mapper.SetProbe("sky")
mapper.SetSetting("color", "linear")  # as chiaro mixes colours; VTK mixes them as they are shown
volume = vtkVolume()
volume.SetMapper(mapper), volume.SetProperty(looks)

ball = vtkSphereSource()
ball.SetCenter(18, -22, 8), ball.SetRadius(14), ball.SetThetaResolution(64), ball.SetPhiResolution(64)
polygons, actor = vtkPolyDataMapper(), vtkActor()
polygons.SetInputConnection(ball.GetOutputPort())
actor.SetMapper(polygons), actor.GetProperty().SetColor(0.2, 0.6, 0.3)

renderer, window = vtkRenderer(), vtkRenderWindow()
renderer.AddVolume(volume), renderer.AddActor(actor), renderer.SetBackground(0.85, 0.87, 0.9)
window.SetSize(640, 480), window.AddRenderer(renderer)
renderer.GetActiveCamera().SetPosition(1, -1.6, 0.8), renderer.GetActiveCamera().SetViewUp(0, 0, 1)
renderer.ResetCamera(), renderer.GetActiveCamera().Zoom(1.5)
if len(sys.argv) > 1:
    window.SetOffScreenRendering(1)
    window.Render()
    grab, writer = vtkWindowToImageFilter(), vtkPNGWriter()
    grab.SetInput(window), writer.SetInputConnection(grab.GetOutputPort())
    writer.SetFileName(sys.argv[1]), writer.Write()
else:
    person = vtkRenderWindowInteractor()
    person.SetRenderWindow(window)
    person.Start()

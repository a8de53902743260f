"""The mapper as Python has it: several components, functions of value and gradient, lights. Ends with an assertion that fails."""

import numpy as np
import vtkmodules.vtkRenderingVolumeOpenGL2  # noqa: F401
from chiarovtk import vtkChiaroVolumeMapper
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkImageData, vtkPiecewiseFunction
from vtkmodules.vtkRenderingCore import (vtkColorTransferFunction, vtkLight, vtkRenderer, vtkRenderWindow, vtkVolume, vtkVolumeProperty,
                                         vtkWindowToImageFilter)

N = 32


def ball(x, y, z, radius):
    k, j, i = np.indices((N, N, N))
    away = np.sqrt((i - x) ** 2 + (j - y) ** 2 + (k - z) ** 2)
    return np.clip(255 * (1 - away / radius), 0, 255).astype(np.uint8).ravel()


A, B = ball(13, 15, 15, 12), ball(19, 16, 14, 11)


def picture(values, change=lambda looks, renderer: None):
    """Rows of the window, and what the mapper said."""
    image, mapper, volume, renderer, window, said = vtkImageData(), vtkChiaroVolumeMapper(), vtkVolume(), vtkRenderer(), vtkRenderWindow(), []
    image.SetDimensions(N, N, N), image.GetPointData().SetScalars(numpy_to_vtk(np.stack(values, axis=1).copy(), deep=True))
    mapper.SetInputData(image), mapper.SetLighting("none")
    mapper.AddObserver("WarningEvent", lambda *_: said.append("warning")), mapper.AddObserver("ErrorEvent", lambda *_: said.append("error"))
    looks = volume.GetProperty()
    looks.SetInterpolationTypeToLinear()
    for k, (low, high) in enumerate([((0, 0, 0.5), (1, 0.5, 0)), ((0, 0.5, 0), (0.5, 1, 1))]):
        colours, opacity = vtkColorTransferFunction(), vtkPiecewiseFunction()
        colours.AddRGBPoint(0, *low), colours.AddRGBPoint(255, *high), opacity.AddPoint(0, 0), opacity.AddPoint(255, 0.2)
        looks.SetColor(k, colours), looks.SetScalarOpacity(k, opacity)
    volume.SetMapper(mapper), renderer.AddVolume(volume)
    renderer.GetActiveCamera().SetPosition(90, -60, 50), renderer.GetActiveCamera().SetFocalPoint(15, 15, 15), renderer.GetActiveCamera().SetViewUp(0, 0, 1)
    renderer.ResetCameraClippingRange()
    change(looks, renderer)
    window.SetOffScreenRendering(1), window.SetMultiSamples(0), window.SetSize(90, 70), window.AddRenderer(renderer)
    window.Render()
    grab = vtkWindowToImageFilter()
    grab.SetInput(window), grab.ReadFrontBufferOff(), grab.Update()
    return vtk_to_numpy(grab.GetOutput().GetPointData().GetScalars()).astype(int), said


def off(a, b):
    assert not a[1] and not b[1], (a[1], b[1])
    return np.abs(a[0] - b[0]).max()


alone, both = picture([A]), picture([A, B])
assert (alone[0].max(axis=1) > 15).sum() > 200
assert off(alone, both) > 30
assert off(alone, picture([A, B], lambda looks, _: looks.SetComponentWeight(1, 0))) == 0


def of_both(looks, _):
    """The same function: of no gradient's own."""
    value = np.linspace(0, 1, 256) * 255
    colours, opacity = looks.GetRGBTransferFunction(0), looks.GetScalarOpacity(0)
    row = np.array([[*colours.GetColor(v), opacity.GetValue(v)] for v in value], np.float32)
    function = vtkImageData()
    function.SetDimensions(256, 4, 1), function.GetPointData().SetScalars(numpy_to_vtk(np.tile(row, (4, 1)), deep=True))
    looks.SetTransferFunction2D(function), looks.SetTransferFunctionMode(vtkVolumeProperty.TF_2D)


assert off(alone, picture([A], of_both)) <= 3  # texels stand between the values
assert off(picture([A, B], lambda looks, _: looks.IndependentComponentsOff()), both) > 30


def lit(*lights):
    def change(looks, renderer):
        looks.ShadeOn(), looks.SetAmbient(0), looks.SetDiffuse(1), looks.SetSpecular(0)
        for place, cone in lights:
            light = vtkLight()
            light.SetLightTypeToSceneLight(), light.SetPosition(*place), light.SetFocalPoint(15, 15, 15), light.SetIntensity(0.4)
            light.SetPositional(cone is not None), light.SetConeAngle(cone or 180)
            renderer.AddLight(light)

    return picture([A], change)


one, other, two = lit(((50, 0, 20), None)), lit(((15, 15, 70), 180)), lit(((50, 0, 20), None), ((15, 15, 70), 180))
assert not two[1] and np.abs(one[0] + other[0] - two[0]).max() <= 2
assert other[0].max() > 30
assert lit(((15, 15, 70), 20))[1] == ["warning"]
told = picture([A] * 5)
assert told[1] == ["warning"] and told[0].max() == 0
print("wrapped: all is as it should be")

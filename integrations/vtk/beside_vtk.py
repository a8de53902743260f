"""What the mapper makes of the scenes of VTK's own volume tests, remade on shells of ours, beside VTK's mapper for GPUs.

beside_vtk.py TOOL [FOLDER] prints the table of docs/vtk.md; pictures go to FOLDER. By `none` and with samples a quarter of a voxel
apart, so that what differs is not the light. Needs a display; PYTHONPATH as in docs/vtk.md.
"""

import math
import os
import subprocess
import sys
import tempfile

import numpy as np
import vtkmodules.vtkRenderingVolumeOpenGL2  # noqa: F401
from chiarovtk import vtkChiaroVolumeMapper
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkImageData, vtkPiecewiseFunction, vtkPlane, vtkRectilinearGrid
from vtkmodules.vtkCommonMath import vtkMatrix3x3
from vtkmodules.vtkFiltersSources import vtkSphereSource
from vtkmodules.vtkIOImage import vtkNrrdReader, vtkPNGWriter
from vtkmodules.vtkRenderingCore import (vtkActor, vtkColorTransferFunction, vtkLight, vtkLightKit, vtkPolyDataMapper, vtkRenderer,
                                         vtkRenderWindow, vtkVolume, vtkVolumeProperty, vtkWindowToImageFilter)
from vtkmodules.vtkRenderingVolume import vtkFixedPointVolumeRayCastMapper, vtkGPUVolumeRayCastMapper

SIZE = 64


class Scene:
    """A composited, shaded volume, to be changed by a scene of the list."""

    def __init__(self, image, mapper):
        self.image, self.mapper, self.volume, self.looks, self.renderer = image, mapper, vtkVolume(), vtkVolumeProperty(), vtkRenderer()
        colours, self.opacity = vtkColorTransferFunction(), vtkPiecewiseFunction()
        for value, r, g, b, o in [(40, 0.2, 0.4, 0.9, 0), (90, 0.9, 0.5, 0.1, 0.08), (160, 0.3, 0.9, 0.4, 0.3), (255, 1, 1, 1, 0.8)]:
            colours.AddRGBPoint(value, r, g, b), self.opacity.AddPoint(value, o)
        self.looks.SetColor(colours), self.looks.SetScalarOpacity(self.opacity), self.looks.SetInterpolationTypeToLinear(), self.looks.ShadeOn()
        mapper.SetInputData(image)
        self.volume.SetMapper(mapper), self.volume.SetProperty(self.looks)
        self.renderer.AddVolume(self.volume), self.renderer.SetBackground(0.31, 0.2, 0.4)
        self.camera = self.renderer.GetActiveCamera()
        self.camera.SetPosition(1.4, -1.1, 0.9), self.camera.SetViewUp(0, 0, 1)

    def drawn(self, path):
        window = vtkRenderWindow()
        window.SetOffScreenRendering(1), window.SetMultiSamples(0), window.SetSize(240, 180), window.AddRenderer(self.renderer)
        if self.camera.GetPosition() == (1.4, -1.1, 0.9):
            self.renderer.ResetCamera()
        window.Render()
        grab, writer = vtkWindowToImageFilter(), vtkPNGWriter()
        grab.SetInput(window), grab.ReadFrontBufferOff(), writer.SetInputConnection(grab.GetOutputPort())
        writer.SetFileName(path), writer.Write()
        return vtk_to_numpy(grab.GetOutput().GetPointData().GetScalars()).astype(float)


def plane(scene):
    cut = vtkPlane()
    cut.SetOrigin(32, 32, 32), cut.SetNormal(-0.8, 0.5, 0.2)
    scene.mapper.AddClippingPlane(cut)


def crop(scene, flags=0x2000):
    scene.mapper.CroppingOn(), scene.mapper.SetCroppingRegionPlanes(15, 45, 20, 60, 10, 40), scene.mapper.SetCroppingRegionFlags(flags)


def cells(scene):
    values = vtk_to_numpy(scene.image.GetPointData().GetScalars()).reshape(SIZE, SIZE, SIZE)[:-1, :-1, :-1].copy()
    image = vtkImageData()
    image.SetDimensions(SIZE, SIZE, SIZE), image.GetCellData().SetScalars(numpy_to_vtk(values.ravel(), deep=True))
    scene.mapper.SetInputData(image)


def turned(scene):
    scene.volume.RotateX(40), scene.volume.RotateZ(25), scene.volume.SetScale(0.8, 0.8, 1.3)


def oriented(scene):
    m = vtkMatrix3x3()
    for i, row in enumerate([(0, -1, 0), (0.8, 0, -0.6), (0.6, 0, 0.8)]):
        for j, v in enumerate(row):
            m.SetElement(i, j, v)
    image = vtkImageData()
    image.ShallowCopy(scene.image), image.SetDirectionMatrix(m)
    scene.mapper.SetInputData(image)


def ball(scene):
    source, polygons, actor = vtkSphereSource(), vtkPolyDataMapper(), vtkActor()
    source.SetCenter(40, 20, 36), source.SetRadius(14), source.SetThetaResolution(48), source.SetPhiResolution(48)
    polygons.SetInputConnection(source.GetOutputPort())
    actor.SetMapper(polygons), actor.GetProperty().SetColor(0.9, 0.2, 0.2)
    scene.renderer.AddActor(actor)


def inside(scene):
    scene.camera.SetPosition(40, 30, 34), scene.camera.SetFocalPoint(10, 40, 30), scene.camera.SetClippingRange(0.1, 200)


def positional(scene):
    light = vtkLight()
    light.SetPosition(140, -90, 130), light.SetFocalPoint(32, 32, 32), light.PositionalOn(), light.SetConeAngle(180), light.SetLightTypeToSceneLight()
    scene.renderer.AddLight(light)


def kit(scene):
    scene.kit = vtkLightKit()
    scene.kit.AddLightsToRenderer(scene.renderer)


def light_components(scene):
    light = vtkLight()
    light.SetDiffuseColor(0.5, 0.5, 0.5), light.SetSpecularColor(0, 0, 1), light.SetLightTypeToHeadlight()
    scene.renderer.AddLight(light), scene.looks.SetSpecular(0.5), scene.looks.SetSpecularPower(20)


def give(scene, *others):
    """Values of the shells last, after others."""
    shells = vtk_to_numpy(scene.image.GetPointData().GetScalars())
    image = vtkImageData()
    values = numpy_to_vtk(np.stack([*others, shells], axis=1).astype(np.uint8).copy(), deep=True)
    image.SetDimensions(SIZE, SIZE, SIZE), image.GetPointData().SetScalars(values)
    scene.mapper.SetInputData(image), scene.looks.ShadeOff()


def axis(k):
    return 4 * np.indices((SIZE,) * 3)[2 - k].ravel()


def independent(scene):
    give(scene, axis(0) // 2, 255 - axis(1), axis(2))
    for k, rgb in enumerate([(0.9, 0.2, 0.1), (0.2, 0.8, 0.3), (0.1, 0.3, 0.9)]):
        colours, opacity = vtkColorTransferFunction(), vtkPiecewiseFunction()
        colours.AddRGBPoint(0, *rgb), opacity.AddPoint(60, 0), opacity.AddPoint(255, 0.02)
        scene.looks.SetColor(k, colours), scene.looks.SetScalarOpacity(k, opacity)
    scene.looks.SetColor(3, scene.looks.GetRGBTransferFunction(0)), scene.looks.SetScalarOpacity(3, scene.opacity)
    scene.looks.SetComponentWeight(1, 0.5)


def colour_by_another(scene):
    give(scene, axis(0)), scene.looks.IndependentComponentsOff()


def own_colours(scene):
    give(scene, axis(0), axis(1), axis(2)), scene.looks.IndependentComponentsOff()


def of_both(scene):
    """Opacities are a sample's: its unit is as long."""
    value, steep = np.meshgrid(np.linspace(0, 1, 128), np.linspace(0, 1, 128))
    rgba = np.stack([1 - steep, 0.4 + 0 * value, steep, 0.05 * value * (steep > 0.3)], axis=2).reshape(-1, 4)
    image = vtkImageData()
    image.SetDimensions(128, 128, 1), image.GetPointData().SetScalars(numpy_to_vtk(rgba.astype(np.float32), deep=True))
    scene.looks.SetTransferFunction2D(image), scene.looks.SetTransferFunctionMode(vtkVolumeProperty.TF_2D), scene.looks.ShadeOff()
    scene.looks.SetScalarOpacityUnitDistance(0.25)


def gradient(scene):
    f = vtkPiecewiseFunction()
    f.AddPoint(0, 0), f.AddPoint(40, 1)
    scene.looks.SetGradientOpacity(f)


def rectilinear(scene):
    grid, places = vtkRectilinearGrid(), numpy_to_vtk(np.arange(SIZE) * 1.0, deep=True)
    grid.SetDimensions(SIZE, SIZE, SIZE), grid.SetXCoordinates(places), grid.SetYCoordinates(places), grid.SetZCoordinates(places)
    grid.GetPointData().SetScalars(scene.image.GetPointData().GetScalars())
    scene.mapper.SetInputData(grid)


def isosurfaces(scene):
    scene.mapper.SetBlendModeToIsoSurface()
    for i, value in enumerate((90, 150)):
        scene.looks.GetIsoSurfaceValues().SetValue(i, value)


def mean(scene):
    scene.mapper.SetBlendModeToAverageIntensity(), scene.opacity.AddPoint(0, 0.6)


def faint(scene):
    scene.mapper.SetBlendModeToAdditive(), scene.looks.SetScalarOpacityUnitDistance(20)


# Tests of VTK's Rendering/Volume and RenderingVolumeOpenGL2, and what they ask of a mapper.
SCENES = {
    "TestSmartVolumeMapper, TestGPUVolumeRayCastMapper, TestFixedPointRayCasterLinear": lambda s: None,
    "TestGPURayCastVolumeUpdate, ...ReleaseResources": lambda s: s.looks.ShadeOff(),
    "TestGPURayCastDataTypesMIP, ...CompositeToMIP, ...MIPToComposite": lambda s: s.mapper.SetBlendModeToMaximumIntensity(),
    "TestGPURayCastDataTypesMinIP, TestMinIntensityRendering": lambda s: (s.mapper.SetBlendModeToMinimumIntensity(), s.opacity.AddPoint(0, 0.5)),
    "TestGPURayCastAverageIP": mean,
    "TestGPURayCastAdditive": faint,
    "TestGPURayCastIsosurface": isosurfaces,
    "TestGPURayCastPerspectiveParallel": lambda s: s.camera.ParallelProjectionOn(),
    "TestGPURayCastCameraInside": inside,
    "TestGPURayCastCellData": cells,
    "TestGPURayCastClipping, volRCClipPlanes": plane,
    "TestGPURayCastCropping of a box, TestFixedPointRayCasterLinearCropped": crop,
    "TestGPURayCastVolumeRotation, ...VolumeScale": turned,
    "TestGPURayCastOrientedVolume": oriented,
    "TestGPURayCastVolumePolyData, ...DepthPeelingOpaque": ball,
    "TestGPURayCastMapperSampleDistance, ...ImageSampleXY": lambda s: s.mapper.SetSampleDistance(1),
    "TestGPURayCastPositionalLights": positional,
    "TestGPURayCastVolumeLightKit": kit,
    "TestGPURayCastCropping of fences and crosses": lambda s: crop(s, 0x2EBFEBA),
    "TestGPURayCastGradientOpacity": gradient,
    "TestFixedPointRayCastLightComponents": light_components,
    "TestGPURayCastTransfer2D": of_both,
    "TestGPURayCastFourComponentsComposite, ...ThreeComponentsIndependent, ...TwoComponentsIndependent": independent,
    "TestGPURayCastTwoComponentsDependent": colour_by_another,
    "TestGPURayCastFourComponentsDependentGradient": own_colours,
    "TestGPURayCastNearestDataTypesMIP, TestFixedPointRayCasterNearest": lambda s: s.looks.SetInterpolationTypeToNearest(),
    "TestGPURayCastMapperRectilinearGrid": rectilinear,
    "TestGPURayCastSlicePlane (SLICE_BLEND)": lambda s: s.mapper.SetBlendModeToSlice(),
}

# VTK's mapper for GPUs gives several components another opacity than its others do: a mean weighted by itself.
BY_FIXED_POINT = {independent, light_components}


def main(tool, folder):
    source = os.path.join(folder, "shells.nrrd")
    subprocess.run([tool, "sample", "shells", "-o", source, "--size", str(SIZE), "--quiet"], check=True)
    reader = vtkNrrdReader()
    reader.SetFileName(source), reader.Update()
    image = vtkImageData()
    image.SetDimensions(SIZE, SIZE, SIZE), image.GetPointData().SetScalars(reader.GetOutput().GetPointData().GetScalars())
    print("| tests of VTK's | drawn | mean difference from VTK's mapper, of 255; PSNR |\n| --- | --- | --- |")
    for k, (tests, change) in enumerate(SCENES.items()):
        said = []
        ours = Scene(image, vtkChiaroVolumeMapper())
        ours.mapper.AddObserver("WarningEvent", lambda *_: said.append("said"))
        ours.mapper.SetLighting("none"), ours.mapper.SetSampleDistance(0.25)
        change(ours)
        first = ours.drawn(os.path.join(folder, f"{k:02}-chiaro.png"))
        if said and np.ptp(first, axis=0).max() < 3:
            print(f"| {tests} | no, and says so | |")
            continue
        theirs = Scene(image, vtkFixedPointVolumeRayCastMapper() if change in BY_FIXED_POINT else vtkGPUVolumeRayCastMapper())
        theirs.mapper.AutoAdjustSampleDistancesOff(), theirs.mapper.SetSampleDistance(0.25)
        if change not in BY_FIXED_POINT:
            theirs.mapper.UseJitteringOff()
        change(theirs)
        second = theirs.drawn(os.path.join(folder, f"{k:02}-vtk.png"))
        off = np.abs(first - second)
        psnr = 10 * math.log10(255**2 / max((off**2).mean(), 1e-9))
        print(f"| {tests} | yes{', and says what is left out' if said else ''} | {off.mean():.2f}; {psnr:.0f} dB |")


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as temporary:
        main(sys.argv[1], sys.argv[2] if len(sys.argv) > 2 else temporary)

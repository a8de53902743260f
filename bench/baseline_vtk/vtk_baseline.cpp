// A scene with VTK's fixed-point volume mapper on the CPU: renders a turntable after one warm-up frame, writes
// that first picture, and prints the CPU milliseconds of each frame as JSON. vtk_baseline --scene S.json --volume
// V.nrrd --out P.png [--size 1024x768] [--step 1] [--shade 0|1] [--frames 4]
#include <vtkCamera.h>
#include <vtkColorTransferFunction.h>
#include <vtkFixedPointVolumeRayCastMapper.h>
#include <vtkImageData.h>
#include <vtkLight.h>
#include <vtkLightCollection.h>
#include <vtkNew.h>
#include <vtkNrrdReader.h>
#include <vtkPNGWriter.h>
#include <vtkPiecewiseFunction.h>
#include <vtkRenderWindow.h>
#include <vtkRenderer.h>
#include <vtkVolume.h>
#include <vtkVolumeProperty.h>
#include <vtkWindowToImageFilter.h>

#include <algorithm>
#include <ctime>

#include "scene.h"

namespace {

using namespace baseline;

void set_property(vtkVolumeProperty* property, const Json& scene, bool shade) {
    vtkNew<vtkColorTransferFunction> color;
    vtkNew<vtkPiecewiseFunction> opacity;
    for (const Json& p : scene["transfer_function"]["points"]) {
        color->AddRGBPoint(p["value"], p["rgb"][0], p["rgb"][1], p["rgb"][2]);
        opacity->AddPoint(p["value"].get<double>(), p["opacity"].get<double>());
    }
    color->SetColorSpaceToRGB();
    property->SetColor(color);
    property->SetScalarOpacity(opacity);
    property->SetInterpolationTypeToLinear();
    property->SetScalarOpacityUnitDistance(scene["transfer_function"]["opacity_unit_distance"]);
    const Json& shading = scene["shading"];
    property->SetShade(shade);
    property->SetAmbient(shading["ambient"]);
    property->SetDiffuse(shading["diffuse"]);
    property->SetSpecular(shading["specular"]);
    property->SetSpecularPower(shading["specular_power"]);
}

/// Every ray and every step as asked for: no adaptive sampling.
void set_sampling(vtkFixedPointVolumeRayCastMapper* mapper, double step) {
    mapper->AutoAdjustSampleDistancesOff();
    mapper->SetImageSampleDistance(1);
    mapper->SetMinimumImageSampleDistance(1);
    mapper->SetMaximumImageSampleDistance(1);
    mapper->SetSampleDistance(step);
    mapper->SetInteractiveSampleDistance(step);
    mapper->IntermixIntersectingGeometryOff();
}

/// VTK's headlight, with white ambient light: its own is black, which would drop the ambient term.
void set_light(vtkRenderer* renderer) {
    renderer->CreateLight();
    vtkLightCollection* lights = renderer->GetLights();
    lights->InitTraversal();
    while (vtkLight* light = lights->GetNextItem()) light->SetAmbientColor(1, 1, 1);
}

void aim(vtkRenderer* renderer, const Json& camera, const std::array<double, 3>& extent, double turn_deg) {
    vtkCamera* view = renderer->GetActiveCamera();
    view->SetViewAngle(camera["view_angle_deg"]);
    view->SetFocalPoint(extent[0] / 2, extent[1] / 2, extent[2] / 2);
    view->SetPosition(orbit_eye(camera, extent, turn_deg).data());
    view->SetViewUp(0, 0, 1);
    renderer->ResetCameraClippingRange(0, extent[0], 0, extent[1], 0, extent[2]);
}

void write_image(vtkRenderWindow* window, const std::string& path) {
    vtkNew<vtkWindowToImageFilter> image;
    image->SetInput(window);
    image->SetInputBufferTypeToRGB();
    image->ReadFrontBufferOff();
    image->ShouldRerenderOff();
    vtkNew<vtkPNGWriter> writer;
    writer->SetInputConnection(image->GetOutputPort());
    writer->SetFileName(path.c_str());
    writer->Write();
}

double cpu_ms() { return 1e3 * double(std::clock()) / CLOCKS_PER_SEC; }

}  // namespace

int main(int argc, char** argv) {
    Options o = read_options(argc, argv, {{"size", "1024x768"}, {"step", "1"}, {"shade", "1"}, {"frames", "4"}});
    const Json scene = read_json(o["scene"]);
    const Size size = read_size(o["size"]);

    vtkNew<vtkNrrdReader> reader;
    reader->SetFileName(o["volume"].c_str());
    reader->Update();
    vtkImageData* image = reader->GetOutput();
    image->SetOrigin(0, 0, 0);
    double spacing[3], bounds[6];
    image->GetSpacing(spacing);
    image->GetBounds(bounds);
    const std::array<double, 3> extent{bounds[1], bounds[3], bounds[5]};

    vtkNew<vtkFixedPointVolumeRayCastMapper> mapper;
    mapper->SetInputData(image);
    set_sampling(mapper, std::stod(o["step"]) * *std::min_element(spacing, spacing + 3));
    vtkNew<vtkVolume> volume;
    set_property(volume->GetProperty(), scene, o["shade"] == "1");
    volume->SetMapper(mapper);

    vtkNew<vtkRenderer> renderer;
    vtkNew<vtkRenderWindow> window;
    window->SetOffScreenRendering(1);
    window->SetMultiSamples(0);
    window->SetSize(size.width, size.height);
    window->AddRenderer(renderer);
    window->SetDesiredUpdateRate(1e-5);
    renderer->AddVolume(volume);
    set_light(renderer);

    Json result{{"threads", mapper->GetNumberOfThreads()}, {"cpu_ms", Json::array()}};
    const int frames = std::stoi(o["frames"]);
    for (int frame = -1; frame < frames; ++frame) {
        aim(renderer, scene["camera"], extent, frame < 0 ? 0 : 360.0 * frame / frames);
        const double start = cpu_ms();
        window->Render();
        window->WaitForCompletion();
        if (frame < 0)
            write_image(window, o["out"]);
        else
            result["cpu_ms"].push_back(cpu_ms() - start);
    }
    std::printf("%s\n", result.dump().c_str());
}

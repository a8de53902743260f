// VTK's wavelet in Chiaro's light, with a ball in it: wavelet [PICTURE.png]; without a picture a window to turn it in.
#include "vtkActor.h"
#include "vtkCamera.h"
#include "vtkChiaroVolumeMapper.h"
#include "vtkColorTransferFunction.h"
#include "vtkNew.h"
#include "vtkPNGWriter.h"
#include "vtkPiecewiseFunction.h"
#include "vtkPolyDataMapper.h"
#include "vtkProperty.h"
#include "vtkRTAnalyticSource.h"
#include "vtkRenderWindow.h"
#include "vtkRenderWindowInteractor.h"
#include "vtkRenderer.h"
#include "vtkSphereSource.h"
#include "vtkVolume.h"
#include "vtkVolumeProperty.h"
#include "vtkWindowToImageFilter.h"

int main(int count, char** arguments) {
    vtkNew<vtkRTAnalyticSource> wavelet;
    wavelet->SetWholeExtent(-40, 40, -40, 40, -40, 40);

    vtkNew<vtkColorTransferFunction> colours;
    vtkNew<vtkPiecewiseFunction> opacity;
    const double points[][5] = {
        {130, 0.9, 0.8, 0.6, 0}, {165, 0.9, 0.75, 0.5, 0.25}, {210, 0.9, 0.45, 0.25, 0.9}, {270, 1, 0.9, 0.8, 1}};
    for (const auto& [value, r, g, b, o] : points) {
        colours->AddRGBPoint(value, r, g, b);
        opacity->AddPoint(value, o);
    }
    vtkNew<vtkVolumeProperty> looks;
    looks->SetColor(colours);
    looks->SetScalarOpacity(opacity);
    looks->SetInterpolationTypeToLinear();
    looks->ShadeOn();

    vtkNew<vtkChiaroVolumeMapper> mapper;
    mapper->SetInputConnection(wavelet->GetOutputPort());
    mapper->SetLighting("visibility");
    mapper->SetProbe("sky");
    mapper->SetSetting("color", "linear");  // as chiaro mixes colours; VTK mixes them as they are shown
    vtkNew<vtkVolume> volume;
    volume->SetMapper(mapper);
    volume->SetProperty(looks);

    vtkNew<vtkSphereSource> ball;
    ball->SetCenter(18, -22, 8);
    ball->SetRadius(14);
    ball->SetThetaResolution(64);
    ball->SetPhiResolution(64);
    vtkNew<vtkPolyDataMapper> polygons;
    polygons->SetInputConnection(ball->GetOutputPort());
    vtkNew<vtkActor> actor;
    actor->SetMapper(polygons);
    actor->GetProperty()->SetColor(0.2, 0.6, 0.3);

    vtkNew<vtkRenderer> renderer;
    renderer->AddVolume(volume);
    renderer->AddActor(actor);
    renderer->SetBackground(0.85, 0.87, 0.9);
    vtkNew<vtkRenderWindow> window;
    window->SetSize(640, 480);
    window->AddRenderer(renderer);
    renderer->GetActiveCamera()->SetPosition(1, -1.6, 0.8);
    renderer->GetActiveCamera()->SetViewUp(0, 0, 1);
    renderer->ResetCamera();
    renderer->GetActiveCamera()->Zoom(1.5);
    if (count > 1) {
        window->SetOffScreenRendering(1);
        window->Render();
        vtkNew<vtkWindowToImageFilter> grab;
        grab->SetInput(window);
        vtkNew<vtkPNGWriter> writer;
        writer->SetInputConnection(grab->GetOutputPort());
        writer->SetFileName(arguments[1]);
        writer->Write();
    } else {
        vtkNew<vtkRenderWindowInteractor> person;
        person->SetRenderWindow(window);
        person->Start();
    }
}

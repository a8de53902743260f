// Transfer functions of VTK's, and places of volumes, in Chiaro's words.
#include "case.h"
#include "look.h"
#include "vtkMatrix4x4.h"
#include "vtkTransform.h"

using namespace chiaro;
using namespace chiaro::testing;

namespace {

/// Largest differences of colour and opacity over values in and around the functions.
double farthest(vtkVolumeProperty& property, double from, double to) {
    const TransferFunction tf = from_vtk::transfer_of(property, 0, 1);
    validate(tf);
    double most = 0;
    for (int i = 0; i <= 5000; ++i) {
        const double value = from + (to - from) * (i + 0.37) / 5001;
        const ControlPoint p = evaluate(tf, value);
        most = std::max(most, std::abs(p.opacity - property.GetScalarOpacity()->GetValue(value)));
        double rgb[3];
        if (property.GetColorChannels() == 1)
            rgb[0] = rgb[1] = rgb[2] = property.GetGrayTransferFunction()->GetValue(value);
        else
            property.GetRGBTransferFunction()->GetColor(value, rgb);
        for (std::size_t c = 0; c < 3; ++c) most = std::max(most, std::abs(p.rgb[c] - rgb[c]));
    }
    return most;
}

}  // namespace

TEST(Functions, AreAsVtkHasThem) {
    vtkNew<vtkVolumeProperty> property;
    vtkNew<vtkColorTransferFunction> colours;
    vtkNew<vtkPiecewiseFunction> opacity;
    property->SetColor(colours), property->SetScalarOpacity(opacity);
    colours->AddRGBPoint(-100, 1, 0, 0), colours->AddRGBPoint(50, 0, 1, 0.5, 0.3, 0.6),
        colours->AddRGBPoint(300, 0.2, 0.2, 1);
    opacity->AddPoint(-50, 0.1, 0.2, 0.9), opacity->AddPoint(100, 0.9, 0.7, 0.4), opacity->AddPoint(250, 0.3);
    for (const int space : {VTK_CTF_RGB, VTK_CTF_HSV, VTK_CTF_LAB, VTK_CTF_DIVERGING}) {
        colours->SetColorSpace(space);
        EXPECT_LT(farthest(*property, -300, 500), 0.004) << space;
    }
    opacity->ClampingOff();
    EXPECT_LT(farthest(*property, -300, 500), 0.004);
    vtkNew<vtkPiecewiseFunction> gray;
    gray->AddPoint(0, 0), gray->AddPoint(200, 1);
    property->SetColor(gray.Get());
    EXPECT_LT(farthest(*property, -300, 500), 0.004);
}

// Where a function jumps, so does ours: sharpness 1.
TEST(Functions, Jump) {
    vtkNew<vtkVolumeProperty> property;
    vtkNew<vtkPiecewiseFunction> opacity;
    property->SetScalarOpacity(opacity);
    opacity->AddPoint(0, 0, 0.5, 1), opacity->AddPoint(100, 1);
    const TransferFunction tf = from_vtk::transfer_of(*property, 0, 2);
    EXPECT_LT(evaluate(tf, 49.8).opacity, 0.01);
    EXPECT_GT(evaluate(tf, 50.2).opacity, 0.99);
    EXPECT_EQ(tf.opacity_unit, property->GetScalarOpacityUnitDistance() / 2);
}

TEST(Places, AreTheCamerasOrTheVolumes) {
    Case c;
    vtkNew<vtkTransform> turn;
    turn->Translate(1, 2, 3), turn->RotateX(30), turn->Scale(2, 2, 2);
    const from_vtk::Placement turned = from_vtk::placement_of(*c.image, false, *turn->GetMatrix());
    EXPECT_NEAR(turned.scale, 2, 1e-12);
    EXPECT_EQ(turned.geometry.spacing_mm, (Vec3{1, 0.9, 1.2}));
    EXPECT_EQ(turned.geometry.origin_mm, (Vec3{5, -10, 3}));
    vtkNew<vtkTransform> mirror;
    mirror->Scale(-1, 1, 3);
    const from_vtk::Placement mirrored = from_vtk::placement_of(*c.image, false, *mirror->GetMatrix());
    EXPECT_EQ(mirrored.scale, 1);
    EXPECT_EQ(mirrored.geometry.direction[0], (Vec3{-1, 0, 0}));
    EXPECT_NEAR(mirrored.geometry.spacing_mm.z, 3.6, 1e-12);
    EXPECT_EQ(mirrored.geometry.origin_mm, (Vec3{-5, -10, 9}));
}

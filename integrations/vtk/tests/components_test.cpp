// Several values a voxel: what Chiaro itself makes of them as channels.
#include "case.h"

using namespace chiaro;
using namespace chiaro::testing;

// Components are Chiaro's channels: with functions, weights, units and gradient opacity of their own.
TEST(Mapper, MixesComponentsAsChannels) {
    Case c;
    const auto n = vtkIdType(c.volume.voxel_count());
    vtkNew<vtkUnsignedCharArray> both;
    both->SetNumberOfComponents(2), both->SetNumberOfTuples(n);
    Volume pair = make_volume(c.volume.dimensions, VoxelType::u8);
    pair.geometry = c.volume.geometry, pair.components = 2;
    pair.voxels = VoxelBuffer(2 * c.volume.voxel_count());
    for (vtkIdType i = 0; i < n; ++i) {
        const std::uint8_t values[2]{c.volume.as<std::uint8_t>()[std::size_t(i)], std::uint8_t(5 * (i / 48 % 48))};
        for (int k = 0; k < 2; ++k)
            both->SetTypedComponent(i, k, pair.as<std::uint8_t>()[2 * std::size_t(i) + std::size_t(k)] = values[k]);
    }
    c.image->GetPointData()->SetScalars(both);
    vtkVolumeProperty& looks = *c.actor->GetProperty();
    vtkNew<vtkColorTransferFunction> colors;
    colors->AddRGBPoint(0, 0.1, 0.9, 0.2), colors->AddRGBPoint(255, 0.9, 0.1, 0.9);
    vtkNew<vtkPiecewiseFunction> opacity, by_gradient;
    opacity->AddPoint(0, 0), opacity->AddPoint(255, 0.1);
    by_gradient->AddPoint(0, 0), by_gradient->AddPoint(25, 1);
    looks.SetColor(1, colors), looks.SetScalarOpacity(1, opacity), looks.SetScalarOpacityUnitDistance(1, 3);
    looks.SetComponentWeight(1, 0.7), looks.SetGradientOpacity(0, by_gradient);
    TransferFunction of_second;
    of_second.points = {{0, {0.1, 0.9, 0.2}, 0}, {255, {0.9, 0.1, 0.9}, 0.1}};
    of_second.opacity_unit = 3, of_second.opacity_unit_is_mm = true;
    c.scene.channels.resize(2);
    c.scene.channels[0].transfer.points = c.scene.transfer.points;
    c.scene.channels[0].transfer.points->gradient = {{0, 0}, {25 / ((1 + 0.9 + 1.2) / 3), 1}};
    c.scene.channels[1].transfer.points = of_second, c.scene.channels[1].gain = 0.7;
    for (const char* method : {"none", "spao", "visibility"}) {
        from_text(method, c.scene.illumination.method);
        c.mapper->SetLighting(method);
        c.expect_same(method, &pair);
    }
}

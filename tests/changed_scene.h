// A scene with every setting away from its default.
#pragma once
#include <chiaro/describe.h>

#include <string>
#include <utility>
#include <vector>

inline chiaro::Scene changed_scene(chiaro::Method method = chiaro::Method::spao) {
    using namespace chiaro;
    Scene s;
    s.volume = "volume.nrrd";
    s.read.raw = {{{4, 5, 6}}, VoxelType::u16, Vec3{1, 2, 3}, true, 12};
    s.read.series = "1.10";
    s.read.rescale = {2, -1024};
    s.read.time = 7;
    s.read.components_as = ComponentsAs::channels;
    s.stated = {{{7, 8, 9}}, VoxelType::f32, Vec3{0.5, 0.25, 2}};
    s.labels = {"organs.nrrd", "organs.label", {{.show = false}, {7, Rgb{1, 0.5, 0}, 0.5, 0.25, true}}};
    s.transfer.source = "ct-bone";
    s.transfer.window = {40, 400};
    s.transfer.threshold = {-100.5, 1e6};
    s.transfer.opacity_scale = 0.5;
    s.transfer.opacity_unit_mm = 3;
    s.mode = Mode::iso;
    s.iso = {{0.5, Rgb{1, 0.5, 0}, 0.25}, {300}};
    s.clip = {std::array{0.0, 0.5, 0.25, 1.0, 0.0, 1.0}, {{{1, 0, 0.5}, -3}, {{0, -1, 0}, 4}}, true};
    s.camera = {-10,
                12.5,
                90,
                4,
                45,
                Vec3{0, -1, 0},
                Projection::orthographic,
                View::left,
                Vec3{1, 2, 3},
                Vec3{0, 0, 0.1},
                Matrix4{1, 0.5, 0, 2, 0, 1, 0, 3, 0, 0, 1, -4, 0, 0, -1, 0.25},
                Fit::volume,
                Vec3{4, 5, 6},
                7.5,
                0.5,
                120};
    s.lighting = {Shading::lambert,
                  0.1,
                  0.2,
                  0.4,
                  5,
                  {{false, 30, -40, {1, 0.5, 0.25}}, {false, 0, 0, {0, 0, 1}, Vec3{1, 2, 3}}, {}},
                  0.75,
                  {"studio", 20, -2, true},
                  {true, 0.25}};
    s.illumination = {
        method,
        SurfaceModel::none,
        {SpaoFilter::hybrid, 5, 2, 0.5, SpaoModel::thick},
        {2, 96, 4, VisibilityTraversal::full, {true, 8}, VisibilityModel::paper, ShWindow::hann, ShStorage::f16},
        {12,
         64,
         32,
         HistogramPacking::paper,
         HistogramMetric::l1,
         HistogramPath::exact,
         2,
         HistogramModel::paper,
         {true, false, true, true},
         -0.5,
         "40:80=3",
         "none",
         2},
        {48, 12, 100, 0.01},
        {64, ReferenceQuantity::ao, ReferenceMedium::trilinear, 0, 2, 30, 0.125},
        {{3}, 0.75, 12}};
    s.sampling = {1, Classification::preintegrated, Compositing::back_to_front, 4, RaySetup::raster, 0, false};
    s.interpolation = Interpolation::texture;
    s.output = {{0.1, 0.2, 0.3}, false, ColorMode::display, Tone::aces, -1.5};
    s.slices = {SliceLayout::linked,    Vec3{1, 2, 3},         Vec3{4, 5, 6},           2.5,   std::pair{40.0, 400.0},
                SliceSampling::nearest, SliceColors::transfer, SliceSide::neurological, false, 0.7};
    s.width = 64, s.height = 48;
    return s;
}

/// Every value that concerns the scene as text, by key.
inline std::vector<std::pair<std::string, std::string>> texts_of(const chiaro::Scene& scene) {
    std::vector<std::pair<std::string, std::string>> texts;
    for_each_setting(
        [&](const chiaro::Setting& s, const auto&... fields) {
            if (s.concerns(chiaro::to_text(scene.illumination.method)))
                texts.emplace_back(s.key, value_text(s, fields...));
        },
        scene);
    return texts;
}

// Volumes in which labels lie.
#pragma once
#include "classify/labels/labelled.h"
#include "fixtures.h"

namespace chiaro::testing {

inline constexpr Rgb red{1, 0, 0}, blue{0, 0, 1}, white{1, 1, 1};

inline LabelVolume labels_of(const Volume& volume, const std::vector<Label>& table) {
    Progress progress;
    const LabelTable names{table, "Chiaro", {}};
    return make_labels(volume, &names, progress);
}
/// What is no structure.
inline Label nothing(bool show) { return {.value = 0, .tint = 0, .show = show}; }

/// A volume of one value everywhere, and labels in it.
struct Labelled {
    Volume volume, numbers;
    std::vector<Label> table;
    TransferFunction tf = constant(0.5);
    Shape shape;

    Labelled(std::array<int, 3> n, const Field& number, std::vector<Label> names)
        : volume(sampled<std::uint8_t>(n, [](double, double, double) { return 100; })),
          numbers(sampled<std::uint8_t>(n, number)),
          table(std::move(names)) {}

    Medium medium() const {
        Progress progress;
        const Device device = tested_device();
        const DeviceVolume uploaded = upload(device, volume);
        const LabelVolume labels = labels_of(numbers, table);
        return with_labels(device, classify(uploaded, tf, shape),
                           label_bricks(labels, labels.labels, uploaded, shape.color, 2, progress), progress);
    }
    Frame picture(const Camera& camera, const Lighting& lighting, const RaySettings& rays, int size) const {
        Frame frame(size, size);
        Progress progress;
        raycast(tested_device(), medium(), IlluminationField(), lighting, camera, rays, frame, progress);
        return frame;
    }
};

/// RMS of shade minus true shade over mean shade, within .95 of a ball's radius, seen along z of the world.
inline double shade_error(const Labelled& ball, Vec3 centre_mm, double radius_mm, double zoom) {
    constexpr int size = 200;
    const Camera camera{.eye = centre_mm + Vec3{0, 0, 1000},
                        .forward = {0, 0, -1},
                        .right = {1, 0, 0},
                        .up = {0, 1, 0},
                        .projection = Projection::orthographic,
                        .half_height = radius_mm / zoom};
    Lighting lighting{.shading = Shading::lambert};
    lighting.ambient = 0, lighting.diffuse = 1, lighting.specular = 0;
    const Frame frame = ball.picture(camera, lighting, {.step_voxels = 0.25}, size);
    double squares = 0, sum = 0;
    int count = 0;
    for (int y = 0; y < size; ++y)
        for (int x = 0; x < size; ++x) {
            const double u = ((x + 0.5) / size * 2 - 1) / zoom, v = ((y + 0.5) / size * 2 - 1) / zoom;
            if (u * u + v * v > 0.95 * 0.95) continue;
            const double truth = std::sqrt(1 - u * u - v * v);
            const double shade = frame.rgba[std::size_t(4 * (y * size + x))];
            squares += (shade - truth) * (shade - truth), sum += truth, ++count;
        }
    return std::sqrt(squares / count) / (sum / count);
}

}  // namespace chiaro::testing

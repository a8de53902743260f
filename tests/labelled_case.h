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

}  // namespace chiaro::testing

#include "classify/labels/labelled.h"

#include <chiaro/error.h>

#include "classify/labels/fields.h"
#include "classify/mixture.h"
#include "core/threads.h"

namespace chiaro {

std::shared_ptr<const LabelBricks> label_bricks(const LabelVolume& labels, const std::vector<Label>& looks,
                                                const DeviceVolume& volume, ColorMode color, int threads,
                                                const Progress& progress) {
    const DeviceVolume::Data& data = volume.data();
    const LabelPlacement placed = place_labels(labels, data.dimensions, data.geometry);
    const LabelFields fields = make_label_fields(labels, looks, color, threads, progress);
    return std::make_shared<const LabelBricks>(in_bricks(fields, placed, data.dimensions, threads, progress));
}

namespace {

/// The medium once for each transfer function, where it holds.
std::vector<std::shared_ptr<const Medium::Data>> by_transfer(const Device& device, const Medium::Data& data,
                                                             const std::shared_ptr<const LabelBricks>& labels,
                                                             const Progress& progress) {
    if (is_mixed(data))
        throw Error(ErrorCode::usage,
                    "labels: a transfer function of a label's own goes with a volume of one value a voxel");
    Shape shape = data.shape;
    shape.clip.largest = false;  // which is all that is left of the volume
    std::vector<std::shared_ptr<const Medium::Data>> channels;
    for (const TransferShare& one : labels->transfers) {
        const Medium its = one.transfer ? classify(device, data.volume, *one.transfer, shape, progress)
                                        : Medium(data.shared_from_this());
        channels.push_back(with_share(its.data(), {labels, &one.share}));
    }
    return channels;
}

}  // namespace

Medium with_labels(const Device& device, const Medium& medium, std::shared_ptr<const LabelBricks> labels,
                   const Progress& progress) {
    const Medium::Data& data = medium.data();
    if (!labels) return medium;
    if (data.shape.mode != Mode::dvr && data.shape.mode != Mode::additive)
        throw Error(ErrorCode::usage,
                    "labels: they go with --mode dvr and additive: surfaces of a value, and values of whole rays, are "
                    "found without them");
    if (data.volume.data().pages)
        throw Error(ErrorCode::usage, "labels: a volume that is read by bricks has none: raise --memory");
    MixtureParts parts = parts_of(data);
    if (!labels->transfers.empty()) parts.channels = by_transfer(device, data, labels, progress);
    parts.labels = std::move(labels);
    return mixed(device, std::move(parts), data.shape, progress);
}

std::vector<std::uint8_t> cells_with_labels(const LabelBricks& labels, const DeviceVolume::Data& volume) {
    if (!labels.distance.size()) return {};
    const auto* const distance = reinterpret_cast<const std::uint8_t*>(labels.distance.data());
    constexpr int nothing_up_to = LabelCoding::middle - int(LabelCoding::per_voxel / 2 + 0.5f);
    const auto [nx, ny, nz] = volume.cells.count;
    std::vector<std::uint8_t> left(volume.cells.low.size());
    parallel_for(volume.device.threads, nz, 1, [&](std::int64_t z, std::int64_t) {
        for (int y = 0; y < ny; ++y)
            for (int x = 0; x < nx; ++x) {
                const std::uint8_t* const first =
                    distance + voxel_index(volume, x * cell_edge, y * cell_edge, int(z) * cell_edge);
                bool any = false;
                for (int i = 0; i < 125 && !any; ++i)
                    any = first[(i / 25 * brick_row + i / 5 % 5) * brick_row + i % 5] > nothing_up_to;
                left[(std::size_t(z) * ny + y) * nx + x] = any;
            }
    });
    return left;
}

}  // namespace chiaro

#include "classify/labels/labelled.h"

#include <chiaro/error.h>

#include "classify/mixture.h"
#include "core/threads.h"

namespace chiaro {

std::shared_ptr<const LabelBricks> label_bricks(const LabelVolume& labels, const std::vector<Label>& looks,
                                                const DeviceVolume& volume, ColorMode color, int threads,
                                                const Progress& progress) {
    const std::shared_ptr<const LabelVolume> lent(std::shared_ptr<const LabelVolume>(), &labels);
    return LabelBorders().find(lent, looks, volume, color, threads, progress);
}

std::shared_ptr<const LabelBricks> LabelBorders::find(std::shared_ptr<const LabelVolume> labels,
                                                      const std::vector<Label>& looks, const DeviceVolume& volume,
                                                      ColorMode color, int threads, const Progress& progress) {
    const DeviceVolume::Data& data = volume.data();
    const LabelPlacement placed = place_labels(*labels, data.dimensions, data.geometry);
    const bool is_known = labels_ == labels && color_ == color && volume_ && &volume_.data() == &data;
    const LabelFields& f = fields_;
    const auto what_lies_everywhere = [&] {
        return std::tuple(f.distance.size(), f.share.size(), f.tint.size(), f.distance_beyond, f.share_beyond,
                          f.tint_beyond);
    };
    labels_.reset();  // what throws leaves nothing that could serve
    std::vector<std::uint8_t> tiles;
    const auto before = what_lies_everywhere();
    if (is_known)
        tiles = renew_label_fields(fields_, *labels, looks_, looks, color, threads, progress);
    else
        fields_ = make_label_fields(*labels, looks, color, threads, progress);
    const bool is_alike = is_known && before == what_lies_everywhere() && bricks_ &&
                          bricks_->transfers.size() == fields_.transfers.size();
    std::optional<OlderBricks> older;
    if (is_alike) older.emplace(OlderBricks{*bricks_, tiles});
    bricks_ = std::make_shared<const LabelBricks>(
        in_bricks(fields_, placed, data.dimensions, threads, progress, older ? &*older : nullptr));
    labels_ = std::move(labels), looks_ = looks, volume_ = volume, color_ = color;
    return bricks_;
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
    if (data.shape.mode == Mode::mean)
        throw Error(ErrorCode::usage,
                    "labels: they go with --mode dvr, iso, additive, mip and minip: the mean of a ray is found without "
                    "them");
    if (!labels->transfers.empty() && data.shape.mode != Mode::dvr && data.shape.mode != Mode::additive)
        throw Error(ErrorCode::usage,
                    "labels: a transfer function of a label's own goes with --mode dvr and additive: a value of a "
                    "whole ray is shown by the volume's");
    if (data.volume.data().pages)
        throw Error(ErrorCode::usage, "labels: a volume that is read by bricks has none: raise --memory");
    if (data.shape.mode == Mode::iso) return with_labelled_surfaces(device, data, std::move(labels), progress);
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

// A medium in which labels lie.
#pragma once
#include <chiaro/labels.h>

#include "classify/labels/fields.h"
#include "classify/medium.h"
#include "volume/label_bricks.h"

namespace chiaro {

/// What labels of these looks make of media on a volume's grid. Cost and errors: make_label_fields, place_labels.
std::shared_ptr<const LabelBricks> label_bricks(const LabelVolume& labels, const std::vector<Label>& looks,
                                                const DeviceVolume& volume, ColorMode color, int threads,
                                                const Progress& progress);

/// The same for one look after another, of which only what has changed is found anew; bit for bit. Keeps what
/// make_label_fields gives: one to six bytes a voxel of the labels.
class LabelBorders {
public:
    std::shared_ptr<const LabelBricks> find(std::shared_ptr<const LabelVolume> labels, const std::vector<Label>& looks,
                                            const DeviceVolume& volume, ColorMode color, int threads,
                                            const Progress& progress);

private:
    std::shared_ptr<const LabelVolume> labels_;  ///< null: nothing is known
    std::vector<Label> looks_;
    DeviceVolume volume_;
    ColorMode color_ = ColorMode::linear;
    LabelFields fields_;
    std::shared_ptr<const LabelBricks> bricks_;
};

/// The medium with labels (in the place of those that it had; null: without). Its extinction is multiplied, its colours
/// are tinted, and all that looks at it - rays, light, paths - sees the product. Throws Error{usage} for a mode in
/// which labels have no meaning, and for volumes by bricks.
Medium with_labels(const Device& device, const Medium& medium, std::shared_ptr<const LabelBricks> labels,
                   const Progress& progress);

/// The same of isosurfaces. What labels hide lies outside all of them: rays and paths find its border in the labels
/// (kernel::shown_value), light in voxels that have become others. Cost: a copy of the bricks where labels hide
/// something. Throws Error{usage} where labels thin, or every value lies within the lowest surface.
Medium with_labelled_surfaces(const Device& device, const Medium::Data& medium,
                              std::shared_ptr<const LabelBricks> labels, const Progress& progress);

/// For each 4³ cell whether labels show anything in it: 0 or 1; empty: in all.
std::vector<std::uint8_t> cells_with_labels(const LabelBricks& labels, const DeviceVolume::Data& volume);

}  // namespace chiaro

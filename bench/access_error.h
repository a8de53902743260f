// How far a field of accessibility is from the ground truth: what is lit, and what is told of the difference.
#pragma once
#include <chiaro/device.h>
#include <chiaro/lighting.h>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "illumination/cells/opacity.h"

namespace chiaro::bench {

/// A small classified volume, and the opacity of its cells.
struct LitSubject {
    Device device;
    Medium medium;
    CellOpacity opacity;

    /// Of every cell, by any method.
    CellValues field(const IlluminationSettings& settings, Progress& progress) const;
    CellValues ground_truth(ReferenceQuantity quantity, int rays, Progress& progress) const;
};

/// "cornell" and "fog" (samples), "engine", "bonsai" and "cthead" (crops of volumes in the folder `data`).
const std::vector<std::string>& lit_subjects();
/// `samples` and `crops`: voxels per axis. Nothing when the volume is not there.
std::optional<LitSubject> find_lit_subject(const Device& device, const std::filesystem::path& data,
                                           const std::string& name, int samples, int crops, Progress& progress);

/// One byte a cell: whether its error counts.
using CellMask = std::vector<std::uint8_t>;
/// Cells that hold something visible, or one of whose 26 neighbours does.
CellMask visible_cells(const CellValues& opacity);
/// Cells where the opacity's central difference (a step edge: 1) is at least `least`.
CellMask cells_with_normal(const CellValues& opacity, double least);

struct AccessError {
    double rmse = 0, bias = 0;  ///< of found - ground truth
    double correlation = 0;     ///< Pearson's
};
AccessError error_of(const CellValues& found, const CellValues& ground_truth, const CellMask& counts);
/// Structural similarity of the slices, on average.
double mean_ssim(const CellValues& a, const CellValues& b);

}  // namespace chiaro::bench

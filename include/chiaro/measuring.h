// Numbers from a volume: values of a region, places on its surfaces, and how often values and gradients come together.
#pragma once
#include <chiaro/brick_source.h>
#include <chiaro/export.h>
#include <chiaro/medium.h>
#include <chiaro/progress.h>

#include <array>
#include <cstdint>
#include <optional>
#include <variant>
#include <vector>

namespace chiaro {

struct BallRegion {
    Vec3 centre_mm;
    double radius_mm = 0;
};
/// Between two opposite corners, with edges along the volume's own axes.
struct BoxRegion {
    Vec3 corner_mm, opposite_mm;
};
using Region = std::variant<BallRegion, BoxRegion>;

/// Of the voxels whose centres lie in a region, its rim included; in data units.
struct RegionValues {
    std::uint64_t count = 0;
    double mean = 0, min = 0, max = 0;
    std::optional<double> deviation;  ///< standard deviation, with n - 1; none of one voxel
    static constexpr std::array<double, 7> shares{0.01, 0.05, 0.25, 0.5, 0.75, 0.95, 0.99};
    std::array<double, 7> percentiles{};        ///< at `shares`; between two values interpolated (numpy's "linear")
    std::array<std::uint64_t, 64> histogram{};  ///< equal bins over [min, max]
    double volume_mm3 = 0;                      ///< count × that of a voxel ...
    double exact_mm3 = 0;  ///< ... and that of the ball or box itself, also where it leaves the data
};

/// Throws Error{usage} for a region that is empty or not finite, Error{interrupted} when cancelled. Cost: some 10 ns
/// and 8 bytes a voxel in it.
CHIARO_EXPORT RegionValues measure(const DeviceVolume& volume, const Region& region, Progress& progress);
/// The same of the finest level of a volume by bricks, of which the region's voxels are read. `whole`: a level that is
/// in memory (Session::volume). Throws as BrickSource::read, too. Memory: some 10 bytes a voxel of the region's box.
CHIARO_EXPORT RegionValues measure(const BrickSource& source, const DeviceVolume& whole, const Region& region,
                                   Progress& progress);

/// The place nearest to `p_mm`, at most `reach_mm` away, where the value is half way between what lies on either side
/// of the nearest edge; within the plane of this normal through `p_mm`, where one is given. Nothing where there is no
/// edge of 2 % of the volume's range a voxel. On edges between even matter it is right to a tenth of a voxel. Cost:
/// some microseconds a voxel within reach, of which at most 24 an axis are looked at.
CHIARO_EXPORT std::optional<Vec3> snap_to_surface(const DeviceVolume& volume, Vec3 p_mm, double reach_mm,
                                                  std::optional<Vec3> normal = std::nullopt);
/// The same on the finest level of a volume by bricks, as above.
CHIARO_EXPORT std::optional<Vec3> snap_to_surface(const BrickSource& source, const DeviceVolume& whole, Vec3 p_mm,
                                                  double reach_mm, std::optional<Vec3> normal = std::nullopt);

/// How many voxels have a value and, there, a gradient of a magnitude: what transfer functions of both are drawn over.
struct GradientHistogram {
    int columns = 0, rows = 0;
    double value_low = 0, value_high = 0;  ///< data units: columns are equal bins over [low, high]
    double steepest = 0;                   ///< the largest magnitude that occurs, data units per mm
    std::vector<std::uint64_t> counts;     ///< [row][column]; every voxel is in one of them

    /// The least magnitude of a row: rows are equal bins of the square root of the magnitude, so that weak edges are
    /// told apart beside strong ones; steepest × (row / rows)².
    double magnitude_of(double row) const { return steepest * (row / rows) * (row / rows); }
};
inline constexpr int max_histogram_bins = 1024;

/// Of all voxels of a whole volume, whose gradients are the central differences that shade (at the border the missing
/// neighbour is the border voxel itself), in millimetres. `columns` and `rows` in 1 to `max_histogram_bins`; whole
/// numbers in a range smaller than `columns` have a column each. Throws Error{usage} for other numbers of bins,
/// Error{interrupted} when cancelled. Cost: two passes, together some 6 core-ns a voxel.
CHIARO_EXPORT GradientHistogram gradient_histogram(const DeviceVolume& volume, int columns, int rows,
                                                   Progress& progress);

}  // namespace chiaro

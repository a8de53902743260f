// The voxels of a volume filtered along all axes, one brick at a time, so that no whole copy in floats is needed.
#pragma once
#include <functional>

#include "volume/device_volume.h"

namespace chiaro {

/// n rows of `lanes` numbers, `stride` numbers apart, as the lines of one axis: lane by lane.
struct Lines {
    float* first;
    std::ptrdiff_t stride;
    int n, lanes;
    float* row(int i) const { return first + i * stride; }
};
/// Filters lines in place. One number may depend on others far away only by what is negligible.
using Filter = void (*)(const Lines&);

/// The numbers c with (c[i - 1] + 4 c[i] + c[i + 1]) / 6 = v[i], straight on at both ends (a natural spline, which
/// reproduces linear ramps): by elimination (Thomas).
void to_coefficients(const Lines& v);
/// (v[i - 1] + 4 v[i] + v[i + 1]) / 6; beyond the ends the last voxel stands.
void smooth(const Lines& v);

/// Receives the numbers of one brick, border included, and which it is.
using VisitBrick = std::function<void(const std::vector<float>& values, const std::array<int, 3>& brick)>;
/// In layers, the bricks of each by many threads at a time. Beyond the volume the last number of each axis stands or,
/// of coefficients, what goes straight on from the last two. Throws Error{interrupted} when cancelled.
void for_each_brick(const DeviceVolume::Data& source, Filter filter, const Progress& progress, const VisitBrick& visit);

}  // namespace chiaro

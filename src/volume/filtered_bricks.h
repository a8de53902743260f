// The voxels of a volume filtered along all axes, one brick at a time, so that no whole copy in floats is needed.
#pragma once
#include <functional>
#include <memory>

#include "volume/device_volume.h"

namespace chiaro {

enum class Filter {
    coefficients,  ///< of the spline that interpolates the voxels; beyond the volume they go straight on
    smoothed       ///< the voxels as a spline smooths them; beyond the volume the last one stands
};

/// Receives the brick_voxels numbers of one brick, border included, and which it is.
using VisitBrick = std::function<void(const float* values, const std::array<int, 3>& brick)>;
/// What goes through all bricks of a volume, as often as is asked, in the same memory.
class FilteredBricks {
public:
    FilteredBricks(const DeviceVolume::Data& source, Filter filter);
    ~FilteredBricks();
    /// In layers, the bricks of each by many threads at a time. Throws Error{interrupted} when cancelled.
    void for_each(const Progress& progress, const VisitBrick& visit);

private:
    class Slab;
    const DeviceVolume::Data& source_;
    Filter filter_;
    std::unique_ptr<Slab> slab_;
};

}  // namespace chiaro

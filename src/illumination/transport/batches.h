// Directions that are swept together, with all that their kernels read of them.
#pragma once
#include "core/host_array.h"
#include "illumination/transport/incident.h"
#include "illumination/transport/sweep.h"

namespace chiaro {

/// Of uncollided light.
class FirstBatch : SweepBatch {
public:
    using Kernel = kernel::FirstSweepKernel;

    FirstBatch(SweepBatch batch, const std::vector<Vec3>& all, const IncidentLight& incident);

    using SweepBatch::octants;
    int count() const { return int(rays.size()); }
    Kernel kernel(bool is_first) const;
    void add_to(HostArrays& arrays) const;

private:
    struct Basis {
        float of[8];
    };
    static Basis basis_of(const IncidentRay& ray, Vec3 direction);

    std::vector<Basis> basis_;
    std::vector<float> per_share_, on_faces_;
};

/// Of scattered light, each direction weighing as much as any other.
class SourceBatch : SweepBatch {
public:
    using Kernel = kernel::SourceSweepKernel;

    SourceBatch(SweepBatch batch, const std::vector<Vec3>& all, const SweepAxes& axes);

    using SweepBatch::octants;
    int count() const { return int(rays.size()); }
    /// Of a sweep of `directions`.
    Kernel kernel(std::size_t directions, bool is_first) const;
    void add_to(HostArrays& arrays) const;

private:
    std::vector<float> open_weights_;  ///< [ray][pattern][tap]
    std::vector<float> cosines_;       ///< [ray][5]
};

}  // namespace chiaro

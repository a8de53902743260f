#include "illumination/transport/batches.h"

#include "core/srgb.h"

namespace chiaro {

/// What a ray of T = 1 adds: J, first moment of luminance; twice what its (in + out) is multiplied by.
FirstBatch::Basis FirstBatch::basis_of(const IncidentRay& ray, Vec3 direction) {
    Basis basis{};
    double y = 0;
    for (int c = 0; c < 3; ++c) {
        basis.of[c] = float(0.5 * ray.light[c]);
        y += luminance_weights[c] * ray.light[c];
    }
    for (int axis = 0; axis < 3; ++axis) basis.of[3 + axis] = float(0.5 * y * direction[axis]);
    return basis;
}

FirstBatch::FirstBatch(SweepBatch batch, const std::vector<Vec3>& all, const IncidentLight& incident)
    : SweepBatch(std::move(batch)), per_share_(std::size_t(kernel::OctantRays::patterns) * Kernel::max_rays) {
    std::vector<float> weights;
    for (std::size_t r = 0; r < rays.size(); ++r) {
        const auto direction = std::size_t(directions[r]);
        basis_.push_back(basis_of(incident.rays[direction], all[direction]));
        weights.push_back(float(0.5 * incident.rays[direction].share));
        for (int axis = 0; axis < 3; ++axis) {
            for (int c = 0; c < 3; ++c) on_faces_.push_back(cosines[r][axis] * basis_[r].of[c]);
            on_faces_.push_back(0);
        }
        on_faces_.resize(on_faces_.size() + 4);
        for (int pattern = 0; pattern < kernel::OctantRays::patterns; ++pattern)
            if (const float share = open_share(int(r), pattern); share >= kernel::least_open)
                per_share_[std::size_t(pattern) * Kernel::max_rays + r] = 1 / share;
    }
    weigh(weights);
}

FirstBatch::Kernel FirstBatch::kernel(bool is_first) const {
    return {rays.data(),
            basis_[0].of,
            octants.data(),
            std::int32_t(octants.size()),
            per_share_.data(),
            on_faces_.data(),
            std::int32_t(rays.size()),
            is_first,
            {}};
}

void FirstBatch::add_to(HostArrays& arrays) const {
    arrays.add(rays), arrays.add(basis_), arrays.add(octants), arrays.add(per_share_), arrays.add(on_faces_);
}

/// Weights between the cells that a pattern calls clear: bilinear; 0 where a ray does not count.
SourceBatch::SourceBatch(SweepBatch batch, const std::vector<Vec3>& all, const SweepAxes& axes)
    : SweepBatch(std::move(batch)) {
    weigh(std::vector<float>(rays.size(), 1));
    for (std::size_t r = 0; r < rays.size(); ++r) {
        const Vec3 d = all[std::size_t(directions[r])];
        cosines_.insert(cosines_.end(), cosines[r].begin(), cosines[r].end());
        cosines_.push_back(float(d[axes.u])), cosines_.push_back(float(d[axes.v]));
        for (int pattern = 0; pattern < kernel::OctantRays::patterns; ++pattern) {
            const float share = open_share(int(r), pattern);
            for (int tap = 0; tap < 4; ++tap)
                open_weights_.push_back(
                    share >= kernel::least_open && (pattern >> tap & 1) ? rays[r].weight[tap] / share : 0);
        }
    }
}

SourceBatch::Kernel SourceBatch::kernel(std::size_t of_directions, bool is_first) const {
    return {rays.data(),
            float(0.5 / double(of_directions)),
            octants.data(),
            std::int32_t(octants.size()),
            open_weights_.data(),
            cosines_.data(),
            {float(luminance_weights[0]), float(luminance_weights[1]), float(luminance_weights[2])},
            std::int32_t(rays.size()),
            is_first,
            {}};
}

void SourceBatch::add_to(HostArrays& arrays) const {
    arrays.add(rays), arrays.add(octants), arrays.add(open_weights_), arrays.add(cosines_);
}

}  // namespace chiaro

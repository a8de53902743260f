// Passes of sweeps on a card, in the places of grid_pass and sheared_pass.
#pragma once
#include "illumination/visibility/card.h"
#include "illumination/visibility/sheared_kernel.h"
#include "illumination/visibility/sweep_pass.h"

namespace chiaro {

/// What travels from plane to plane: two planes of nodes with a halo of one, where all light arrives.
class SweepPlanes {
public:
    struct Plane {
        std::vector<float> density, light;
        std::vector<std::uint8_t> state;
    };
    SweepPlanes(int nu, int nv, int directions);

    int row() const { return row_; }
    Plane& before(int k) { return planes_[(k + 1) & 1]; }  ///< at plane k
    Plane& here(int k) { return planes_[k & 1]; }
    kernel::SweepPlanes view(int k);

private:
    Plane planes_[2];
    int row_, directions_;
};

/// Of one batch on its sheared lattice: planes and lattice points are padded, so that sixteen numbers can be read and
/// written from any point on.
class ShearedPlanes {
public:
    ShearedPlanes(int nu, int nv, int directions);

    int row() const { return row_; }
    int density_row() const { return density_row_; }
    float* density() { return density_.data() + density_row_ + 1; }
    kernel::ShearedPlanes view(int k) { return view(k, density_.data(), light_[0].data(), light_[1].data()); }
    /// Of copies of the arrays.
    kernel::ShearedPlanes view(int k, float* density, float* even, float* odd) const;
    const std::vector<float>& densities() const { return density_; }
    const std::vector<float>& light() const { return light_[0]; }  ///< at first; of both planes

private:
    static constexpr int padding = kernel::ShearedKernel::width;
    int density_row_, row_;
    std::int64_t direction_;
    std::vector<float> density_, light_[2];
};

/// Where the rays of a batch lie in each plane: [plane][direction].
std::vector<kernel::ShearedDirection> sheared_rays(std::span<const SweepDirection> batch, int planes, int row,
                                                   double start);

void grid_pass_on_card(const CardField& field, const SweepPass& pass, const SweepAxes& axes,
                       std::span<const SweepDirection> batch, const std::function<void(double)>& tell);
void sheared_pass_on_card(const CardField& field, const SweepPass& pass, const SweepAxes& axes,
                          std::span<const SweepDirection> batch, const std::function<void(double)>& tell);

}  // namespace chiaro

// Density on a card, and the sweep: planes, packs of directions and coefficients stay there until all directions are
// done.
#pragma once
#include "cuda/mirror.h"
#include "illumination/visibility/nodes.h"
#include "illumination/visibility/sub_voxel.h"
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

/// The passes of one field, in the place of grid_pass.
class CardSweep {
public:
    CardSweep(const Device& device, const Density& density, int coefficients);

    void pass(const SweepPass& pass, const SweepAxes& axes, std::span<const SweepDirection> batch,
              const std::function<void(double)>& tell);
    void fetch(ShField& field);
    /// As keep_nodes, of what has been swept.
    VisibilityNodes keep(const VisibilitySettings& settings);

private:
    const std::shared_ptr<cuda::Stream> stream_;
    const CellGrid grid_;
    const int coefficients_;
    const float* density_;
    cuda::Array<float> field_;
};

/// Fills a density, which stays on the card: the cells of the blocks, halved so often. Memory there: 4 bytes a node,
/// 144 KiB a block, of up to 256 at a time.
void assemble_on_card(const Device& device, const BlockMap& blocks, int halvings, const BlockDepths& depths,
                      Density& out, Progress& progress);

/// LightKernel on the device's card: `kernel` as it is for the host, which gets the light.
void light_on_card(const Device& device, const kernel::LightKernel& kernel, const HostArrays& arrays,
                   std::size_t nodes);

}  // namespace chiaro

// Density on a GPU, and the sweep: planes, packs of directions and coefficients stay there until all directions are
// done.
#pragma once
#include <optional>

#include "cuda/device_cache.h"
#include "illumination/visibility/nodes.h"
#include "illumination/visibility/sh_field.h"
#include "illumination/visibility/sub_voxel.h"

namespace chiaro {

/// V_lm of all nodes there, in the place of an ShField: at first none.
class GpuField {
public:
    GpuField(const Device& device, const Density& density, int coefficients, bool in_steps = false);

    cuda::Stream& stream() const { return *stream_; }
    const CellGrid& grid() const { return grid_; }
    int coefficients() const { return coefficients_; }
    const float* density() const { return density_; }
    std::size_t size() const { return grid_.size() * std::size_t(coefficients_); }  ///< all coefficients
    bool is_in_steps() const { return steps_.has_value(); }
    float* data() const { return field_->data(); }  ///< unless it is in steps, as for fetch
    void fetch(ShField& field) const;
    /// Adds so many parts, each of all coefficients, one after the other.
    void add(const float* parts, std::int32_t count) const;
    /// As keep_nodes.
    VisibilityNodes keep(const VisibilitySettings& settings) const;

private:
    const std::shared_ptr<cuda::Stream> stream_;
    const CellGrid grid_;
    const int coefficients_;
    const float* density_;
    std::optional<cuda::Array<float>> field_;
    std::optional<cuda::Array<std::uint16_t>> steps_;
};

/// Fills a density, which stays on the GPU: the cells of the blocks, halved so often. Memory there: 4 bytes a node,
/// 144 KiB a block, of up to 256 at a time.
void assemble_on_gpu(const Device& device, const BlockMap& blocks, int halvings, const BlockDepths& depths,
                     Density& out, Progress& progress);

/// LightKernel on the device's GPU: `kernel` as it is for the host, which gets the light.
void light_on_gpu(const Device& device, const kernel::LightKernel& kernel, const HostArrays& arrays, std::size_t nodes);

}  // namespace chiaro

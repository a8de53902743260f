// Light by transport as it is kept for pictures: of particles, or of surfaces where matter has them.
#pragma once
#include <chiaro/device.h>
#include <chiaro/geometry.h>

#include <memory>
#include <mutex>
#include <optional>

#include "illumination/sh/rotation.h"
#include "illumination/transport/field.h"
#include "illumination/transport/nodes.h"
#include "illumination/transport/surface_map.h"

namespace chiaro {

/// What matter looks like.
enum class Look {
    particles,  ///< c J everywhere, as the reference has it in volumes; solid samples read another light than thin ones
    surfaces    ///< surfaces by the normals of the samples, particles elsewhere
};

/// What the ray caster reads of it.
struct ShownLight {
    VoxelBuffer light, boundary_cells;
    std::vector<kernel::AroundNode> around;
    kernel::NodeLight view;
    const kernel::Light16* boundary_view = nullptr;
    std::size_t bytes() const {
        return light.size() + boundary_cells.size() + around.size() * sizeof(kernel::AroundNode);
    }
};

class TransportLight {
public:
    /// `edges`: of the smallest voxel edge, in the edge of a cell. `most`: what falls on a surface that nothing hides
    /// from the light; none is brighter. (At grazing directions sweeps let some per cent too much through.) `before`:
    /// other light, perhaps of the same matter, whose surfaces are then known.
    TransportLight(const Device& device, TransportNodes nodes, double edges, const std::array<float, 3>& most,
                   const TransportLight* before = nullptr);

    /// `eye`, in voxels: opaque particles send more to where they are seen at grazing angles; none: the mean. The last
    /// look is kept. The views are valid as long as the result is. Cost: some 10 core-ms for 64³ nodes, of particles
    /// more where it is not known yet which are opaque.
    std::shared_ptr<const ShownLight> shown(Look look, std::optional<Vec3> eye = {}) const;
    std::size_t bytes() const;
    const TransportNodes& nodes() const { return nodes_; }

private:
    struct Asked {
        Look look;
        std::optional<Vec3> eye;
        bool operator==(const Asked&) const = default;
    };
    ShownLight particles(const std::optional<Vec3>& eye) const;
    ShownLight surfaces() const;
    std::array<float, 3> brightest(float factor) const;

    Device device_;
    TransportNodes nodes_;
    std::array<float, 3> most_;
    std::shared_ptr<SurfaceMaps> maps_;
    mutable std::mutex mutex_;  ///< of what is kept
    mutable std::optional<Asked> of_;
    mutable std::shared_ptr<const ShownLight> kept_;
};

}  // namespace chiaro

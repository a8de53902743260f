// How the nodes of a grid show, which matter alone decides: found once, and kept while light is refined or turned.
#pragma once
#include <chiaro/device.h>

#include <memory>
#include <mutex>

#include "illumination/transport/surface.h"

namespace chiaro {

/// A node that shows a surface, or the air beside one.
struct SurfaceNode {
    int x = 0;         ///< its place in the row
    float weight = 0;  ///< that the surface has between other nodes
    float own = 0;     ///< how much the node's own light counts; the rest is the light beside
    Float3 normal{}, result{};
    LightBeside beside;
};

/// What samples read: particles, or particles that are solid by themselves.
enum class Reading { particles, boundary_cells };

struct SurfaceMap {
    std::vector<float> particles;                    ///< [node]: what its own light weighs as particles
    std::vector<std::vector<SurfaceNode>> surfaces;  ///< of each row (y fastest), along x
    std::size_t bytes() const;
};

/// The maps of a medium, each found when it is asked for first.
class SurfaceMaps {
public:
    /// `edges`: of the smallest voxel edge, in the edge of a cell.
    explicit SurfaceMaps(double edges) : edges_(edges) {}

    /// `nodes`: of this medium, in any light. Cost: some 30 core-ms for 64³ nodes the first time.
    std::shared_ptr<const SurfaceMap> of(const Device& device, const TransportNodes& nodes, Reading reading);
    double edges() const { return edges_; }
    std::size_t bytes() const;

private:
    double edges_;
    mutable std::mutex mutex_;
    std::array<std::shared_ptr<const SurfaceMap>, 2> maps_;
};

/// Whether both show the same matter, however it is lit.
bool is_same_matter(const TransportNodes& a, const TransportNodes& b);

}  // namespace chiaro

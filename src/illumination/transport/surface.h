// What a node looks like from outside where it is a surface: the light one cell out, and where that comes from.
#pragma once
#include <array>

#include "illumination/cells/kernel.h"
#include "illumination/transport/nodes.h"
#include "illumination/transport/opaque.h"

namespace chiaro {

using Float3 = std::array<float, 3>;

/// Light around a place: J and its first moment, per channel.
struct LightAround {
    Float3 j{};
    std::array<Float3, 3> moment{};

    void add(float weight, const LightAround& other) {
        for (int c = 0; c < 3; ++c) {
            j[c] += weight * other.j[c];
            for (int axis = 0; axis < 3; ++axis) moment[c][axis] += weight * other.moment[c][axis];
        }
    }
};

/// Which way matter lies at a node: n, unit, out of it, in the axes of the grid; 0 where that is nowhere.
struct NodeOutwards {
    Float3 normal{};
    float edges = 1;  ///< how many off the surface's light is seen
};

/// How a node shows: as particles, as the air beside a surface, as matter behind one. Steps of a quarter of the opacity
/// between neighbours are surfaces (cells/kernel.h).
struct NodeRoles {
    float particles, air, matter;
};

class SurfaceNodes {
public:
    SurfaceNodes(const TransportNodes& nodes, const std::vector<float>& opacity) : nodes_(nodes), opacity_(opacity) {}

    NodeRoles roles(int x, int y, int z) const;
    /// n = -(α(i + 1) - α(i - 1)) per axis, α of a voxel's edge. Within matter also over twice the distance, as
    /// KeepKernel of visibility has it: samples on the surface lie between its nodes and those.
    NodeOutwards outwards(int x, int y, int z) const;
    /// The same of particles, where some cells are opaque: those are lit as surfaces are, by the air beside them.
    NodeRoles particle_roles(int x, int y, int z) const;
    /// R(a) / a of the surfaces at a node and around it.
    Float3 answer(int x, int y, int z) const;
    /// |n · v|, v from the node to a place in voxels; -1 where there is no n.
    float cosine_to(Vec3 eye, const NodeOutwards& outwards, int x, int y, int z) const;
    LightAround at(std::size_t node) const;
    /// Whether a surface passes through the node, as far as light knows.
    bool shows(std::size_t node) const { return !nodes_.answer.empty() && nodes_.answer[3 * node] > 0; }
    float weight(std::size_t node) const { return nodes_.weight[node]; }
    /// Trilinear, each node by what it lets through: the light in the air beside matter, not that within.
    LightAround off(const NodeOutwards& outwards, int x, int y, int z) const;

private:
    Float3 step_down(int x, int y, int z, int distance) const;
    float alpha(int x, int y, int z) const;
    bool is_skin(std::size_t node) const { return shows(node) && nodes_.weight[node] < opaque_weight; }
    bool is_air(int x, int y, int z) const;

    const TransportNodes& nodes_;
    const std::vector<float>& opacity_;
};

}  // namespace chiaro

// What a node looks like from outside where it is a surface: the light one cell out, and where that comes from.
#pragma once
#include <chiaro/device.h>

#include <array>

#include "illumination/cells/outward.h"
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

/// How a node shows: as particles, as the air beside an opaque cell, as matter behind its face.
struct NodeRoles {
    float particles, air, matter;
};

/// J and its first moment at a node.
LightAround light_of(const TransportNodes& nodes, std::size_t node);

/// The light beside a surface: a mean over nodes, each by what it lets through.
struct LightBeside {
    std::array<std::uint32_t, 8> nodes{};
    std::array<float, 8> weights{};
    float sum = 0;

    LightAround of(const TransportNodes& light) const;
};

class SurfaceNodes {
public:
    /// `edges`: of the smallest voxel edge, in the edge of a cell.
    SurfaceNodes(const Device& device, const TransportNodes& nodes, double edges);

    /// n = -(α(i + 1) - α(i - 1)) per axis, α of a voxel's edge. Within matter also over twice the distance:
    /// samples on the surface lie between its nodes and those.
    NodeOutwards outwards(int x, int y, int z) const;
    /// Where some cells are opaque: those are lit as surfaces are, by the air beside them.
    NodeRoles particle_roles(int x, int y, int z) const;
    /// ... for samples that are solid by themselves: cells that matter fills in part, beside opaque ones, are surfaces
    /// too, not fog in the bright light of their air; and inner corners, which touch air by an edge only, do not count.
    NodeRoles boundary_roles(int x, int y, int z) const;
    /// R(a) / a of the surfaces at a node and around it.
    Float3 result(int x, int y, int z) const;
    /// Whether a surface passes through the node, as far as light knows.
    bool shows(std::size_t node) const { return !nodes_.result.empty() && nodes_.result[3 * node] > 0; }
    float weight(std::size_t node) const { return nodes_.weight[node]; }
    /// Trilinear, each node by what it lets through: the light in the air beside matter, not that within.
    LightBeside off(const NodeOutwards& outwards, int x, int y, int z) const;

private:
    Float3 step_down(int x, int y, int z, int distance) const;
    float alpha(int x, int y, int z) const;
    bool is_boundary(std::size_t node) const { return shows(node) && nodes_.weight[node] < opaque_weight; }
    bool is_air(int x, int y, int z) const;

    const TransportNodes& nodes_;
    std::vector<float> opacity_;  ///< [node]: of a smallest voxel edge
    std::vector<float> results_;  ///< above 0 where a surface is near
};

}  // namespace chiaro

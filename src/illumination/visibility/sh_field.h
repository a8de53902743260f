// Visibility at every node, as spherical harmonics in the axes of the grid.
#pragma once
#include "illumination/cells/grid.h"

namespace chiaro {

/// V_lm of every node: its coefficients one after the other, nodes with x fastest.
struct ShField {
    CellGrid grid;
    int coefficients;  ///< 4 or 16
    VoxelBuffer buffer;

    ShField(const CellGrid& nodes, int per_node)
        : grid(nodes), coefficients(per_node), buffer(nodes.size() * std::size_t(per_node) * sizeof(float)) {}
    float* node(std::size_t index) {
        return reinterpret_cast<float*>(buffer.data()) + index * std::size_t(coefficients);
    }
    const float* node(std::size_t index) const {
        return reinterpret_cast<const float*>(buffer.data()) + index * std::size_t(coefficients);
    }
};

/// The same while a sweep adds it up for what is kept in 8 bits: in whole steps (kernel::AddSteps), in half the memory.
struct ShSteps {
    CellGrid grid;
    int coefficients;  ///< 4 or 16
    VoxelBuffer buffer;

    ShSteps(const CellGrid& nodes, int per_node)
        : grid(nodes), coefficients(per_node), buffer(nodes.size() * std::size_t(per_node) * sizeof(std::uint16_t)) {}
    std::uint16_t* node(std::size_t index) {
        return reinterpret_cast<std::uint16_t*>(buffer.data()) + index * std::size_t(coefficients);
    }
};

}  // namespace chiaro

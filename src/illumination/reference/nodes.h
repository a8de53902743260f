// The cells that rays start from: every Nth per axis and the last one; between them the answer is trilinear.
#pragma once
#include <chiaro/progress.h>

#include "illumination/cells/grid.h"

namespace chiaro {

class NodeGrid {
public:
    NodeGrid(const CellGrid& cells, int stride);

    const CellGrid& cells() const { return cells_; }
    const CellGrid& nodes() const { return nodes_; }  ///< counts nodes in the place of cells
    int stride() const { return stride_; }
    int cell(int axis, int node) const { return std::min(node * stride_, cells_.count[axis] - 1); }
    /// Whether a node is nearer to the one before than the others are.
    bool is_irregular(int axis, int node) const { return node * stride_ >= cells_.count[axis]; }

    /// The blocks of nodes that the given blocks of cells lie between.
    BlockMap blocks_for(const BlockMap& cell_blocks) const;

    /// Fills the given blocks of cells.
    CellValues interpolate(const CellValues& at_nodes, const BlockMap& cell_blocks, int threads,
                           Progress& progress) const;

private:
    CellGrid cells_, nodes_;
    int stride_;
};

}  // namespace chiaro

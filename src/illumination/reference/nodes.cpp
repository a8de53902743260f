#include "illumination/reference/nodes.h"

#include "core/threads.h"

namespace chiaro {
namespace {

/// Between which nodes every cell of an axis lies, and how far along.
struct Between {
    int node, next;
    float share;
};

std::vector<Between> along(const NodeGrid& grid, int axis) {
    const int last = grid.nodes().count[axis] - 1;
    std::vector<Between> list;
    for (int x = 0; x < grid.cells().count[axis]; ++x) {
        const int node = std::min(x / grid.stride(), std::max(last - 1, 0)), next = std::min(node + 1, last);
        const int from = grid.cell(axis, node), to = grid.cell(axis, next);
        list.push_back({node, next, to > from ? float(x - from) / float(to - from) : 0});
    }
    return list;
}

}  // namespace

NodeGrid::NodeGrid(const CellGrid& cells, int stride) : cells_(cells), nodes_(cells), stride_(stride) {
    for (int& n : nodes_.count) n = (n - 1 + stride - 1) / stride + 1;
}

BlockMap NodeGrid::blocks_for(const BlockMap& cell_blocks) const {
    BlockMap map(nodes_.count);
    for (std::size_t b : cell_blocks.held()) {
        const auto block = cell_blocks.cells(b, cells_.count);
        const auto first = [&](int axis) { return block[axis].first / stride_ / block_edge; };
        const auto last = [&](int axis) { return (block[axis].second - 1 + stride_ - 1) / stride_ / block_edge; };
        for (int z = first(2); z <= last(2); ++z)
            for (int y = first(1); y <= last(1); ++y)
                for (int x = first(0); x <= last(0); ++x) map(x, y, z) = 1;
    }
    return map;
}

CellValues NodeGrid::interpolate(const CellValues& at_nodes, const BlockMap& cell_blocks, int threads,
                                 Progress& progress) const {
    CellValues out(cells_);
    const auto x = along(*this, 0), y = along(*this, 1), z = along(*this, 2);
    const auto mix = [](float a, float b, float share) { return a + share * (b - a); };
    const auto row = [&](int i, int j, int k) {
        const std::uint16_t* from = at_nodes.data() + nodes_.index(0, j, k);
        return mix(from[x[i].node], from[x[i].next], x[i].share);
    };
    const auto slice = [&](int i, const Between& j, int k) {
        return mix(row(i, j.node, k), row(i, j.next, k), j.share);
    };
    const auto blocks = cell_blocks.held();
    parallel_for(threads, std::int64_t(blocks.size()), 1, "interpolation", progress, [&](std::int64_t b, std::int64_t) {
        const auto [along_x, along_y, along_z] = cell_blocks.cells(blocks[b], cells_.count);
        for (int k = along_z.first; k < along_z.second; ++k)
            for (int j = along_y.first; j < along_y.second; ++j)
                for (int i = along_x.first; i < along_x.second; ++i)
                    out.data()[cells_.index(i, j, k)] =
                        std::uint16_t(mix(slice(i, y[j], z[k].node), slice(i, y[j], z[k].next), z[k].share) + 0.5f);
    });
    progress.check();
    return out;
}

}  // namespace chiaro

#include "illumination/transport/grid.h"

#include "classify/clip.h"
#include "classify/medium.h"
#include "core/srgb.h"
#include "core/threads.h"
#include "illumination/transport/axis_places.h"
#include "illumination/transport/skin.h"
#include "illumination/transport/tints.h"

namespace chiaro {
namespace {

/// How many cells make a node: halved so often, then perhaps taken by threes.
struct Blocks {
    int halvings = 0;
    bool by_three = false;
    int edge() const { return (by_three ? 3 : 1) << halvings; }
};

Blocks blocks_for(const CellGrid& cells, int most) {
    const int longest = *std::max_element(cells.count.begin(), cells.count.end());
    const auto fits = [&](Blocks b) { return (longest + b.edge() - 1) / b.edge() <= most; };
    // 1, 2, 3, 4, 6, 8, 12 ... up to 48: blocks of 32³ are halved in the cache.
    for (Blocks b;; ++b.halvings) {
        if (fits(b)) return b;
        if (b.halvings > 0 && fits({b.halvings - 1, true})) return {b.halvings - 1, true};
        if (b.halvings == 5) return b;
    }
}

/// Of blocks of 3³: as `halved` of 2³.
Density thirded(const Density& finer, const Device& device, Progress& progress) {
    Density out(coarser(finer.grid, 3));
    const auto& fine = finer.grid;
    const auto depth = [&](int x, int y, int z) {
        const bool inside = x < fine.count[0] && y < fine.count[1] && z < fine.count[2];
        return inside ? finer.data()[fine.index(x, y, z)] : 0.0f;
    };
    const auto [nx, ny, nz] = out.grid.count;
    parallel_for(device.threads, std::int64_t(ny) * nz, 4, "density", progress,
                 [&, nx = nx, ny = ny](std::int64_t first, std::int64_t end) {
                     for (auto row = first; row < end; ++row)
                         for (int x = 0; x < nx; ++x) {
                             const int y = int(row % ny), z = int(row / ny);
                             double column[3][9]{}, sum[3]{};
                             for (int i = 0; i < 27; ++i) {
                                 const int a = i % 3, b = i / 3 % 3, c = i / 9;
                                 const double d = depth(3 * x + a, 3 * y + b, 3 * z + c);
                                 column[0][3 * c + b] += d, column[1][3 * c + a] += d, column[2][3 * b + a] += d;
                             }
                             for (int axis = 0; axis < 3; ++axis)
                                 for (double d : column[axis]) sum[axis] += std::exp(-d) / 9;
                             const double open = sum[0] * sum[1] * sum[2];
                             out.numbers()[out.grid.index(x, y, z)] =
                                 float(-std::log(std::clamp(open, 1e-110, 1.0)) / 3);
                         }
                 });
    progress.check();
    return out;
}

Density density_of_nodes(const Medium::Data& medium, Blocks blocks, const Device& device, Progress& progress) {
    Density density = density_for(medium, 1 << blocks.halvings, device, progress);
    return blocks.by_three ? thirded(density, device, progress) : std::move(density);
}

/// Sums of colour over the cells of a node.
template <class Voxel>
class NodeColours {
public:
    NodeColours(const Medium::Data& medium, double albedo_max, const Density& nodes, int edge)
        : cells_(make_cell_grid(medium.volume.data().dimensions, medium.volume.data().geometry)),
          nodes_(nodes),
          edge_(edge),
          stride_(edge >= 4 ? 2 : 1),
          places_(view_of<Voxel>(medium.volume.data()), centres_of(cells_)),
          tints_(medium, albedo_max),
          kept_(half_spaces(medium.shape.clip, medium.volume.data().geometry, medium.volume.data().dimensions)) {}

    /// Of a row of nodes; nothing where there is no matter.
    void add_row(int y, int z, Tint* sums) const {
        const float* depths = nodes_.data() + nodes_.grid.index(0, y, z);
        const auto end = [&](int axis, int node) { return std::min((node + 1) * edge_, cells_.count[axis]); };
        for (int k = z * edge_; k < end(2, z); k += stride_)
            for (int j = y * edge_; j < end(1, y); j += stride_)
                for (int x = 0; x < nodes_.grid.count[0]; ++x)
                    for (int i = x * edge_; depths[x] > 0 && i < end(0, x); i += stride_) add(i, j, k, sums[x]);
    }

private:
    static std::array<std::vector<double>, 3> centres_of(const CellGrid& cells) {
        std::array<std::vector<double>, 3> centres;
        for (int axis = 0; axis < 3; ++axis)
            for (int i = 0; i < cells.count[axis]; ++i)
                centres[axis].push_back(cells.is_voxel_grid ? i : cells.voxel_of(i, i, i)[axis]);
        return centres;
    }
    void add(int x, int y, int z, Tint& sum) const {
        const Tint& tint = tints_.of(cells_.is_voxel_grid ? float(places_.voxel(x, y, z)) : places_.value(x, y, z));
        if (tint.weight == 0 || is_clipped(x, y, z)) return;
        sum.weight += tint.weight;
        for (int c = 0; c < 3; ++c) sum.colour[c] += tint.colour[c];
    }
    bool is_clipped(int x, int y, int z) const {
        for (const HalfSpace& half : kept_)
            if (dot(half.normal, cells_.voxel_of(x, y, z)) > half.d) return true;
        return false;
    }

    CellGrid cells_;
    const Density& nodes_;
    int edge_, stride_;
    AxisPlaces<Voxel> places_;
    Tints tints_;
    std::vector<HalfSpace> kept_;
};

/// Where matter lies between the places that were looked at: as around it, else as everywhere.
Tint around(const std::vector<Tint>& sums, const CellGrid& grid, int x, int y, int z) {
    Tint sum;
    for (int k = std::max(z - 1, 0); k <= std::min(z + 1, grid.count[2] - 1); ++k)
        for (int j = std::max(y - 1, 0); j <= std::min(y + 1, grid.count[1] - 1); ++j)
            for (int i = std::max(x - 1, 0); i <= std::min(x + 1, grid.count[0] - 1); ++i) {
                const Tint& tint = sums[grid.index(i, j, k)];
                sum.weight += tint.weight;
                for (int c = 0; c < 3; ++c) sum.colour[c] += tint.colour[c];
            }
    return sum;
}

}  // namespace

LightGrid light_grid(const Medium::Data& medium, int cells, double albedo_max, const Device& device,
                     Progress& progress) {
    const DeviceVolume::Data& volume = medium.volume.data();
    const Blocks blocks = blocks_for(make_cell_grid(volume.dimensions, volume.geometry), cells);
    LightGrid out{density_of_nodes(medium, blocks, device, progress), {}, medium.shape.mode == Mode::iso, {}};
    if (!out.is_surface) out.skins = open_skins(medium, device, progress, out.extinction);
    const CellGrid& grid = out.extinction.grid;
    for (auto& channel : out.albedo) channel.resize(grid.size());
    std::vector<Tint> sums(grid.size());
    const auto [nx, ny, nz] = grid.count;
    const auto each_row = [&, ny = ny, nz = nz](const auto& body) {
        parallel_for(device.threads, std::int64_t(ny) * nz, 8, "albedo", progress,
                     [&](std::int64_t first, std::int64_t end) {
                         for (auto row = first; row < end; ++row) body(int(row % ny), int(row / ny));
                     });
        progress.check();
    };
    with_stored_voxel(volume, [&](auto voxel) {
        const NodeColours<decltype(voxel)> colours(medium, albedo_max, out.extinction, blocks.edge());
        each_row([&](int y, int z) { colours.add_row(y, z, sums.data() + grid.index(0, y, z)); });
    });
    const Tint fallback = Tints(medium, albedo_max).mean();
    each_row([&, nx = nx](int y, int z) {
        for (int x = 0; x < nx; ++x) {
            const std::size_t node = grid.index(x, y, z);
            if (!(out.extinction.data()[node] > 0)) continue;
            Tint tint = sums[node].weight > 0 ? sums[node] : around(sums, grid, x, y, z);
            if (!(tint.weight > 0)) tint = fallback;
            for (int c = 0; c < 3; ++c) out.albedo[c][node] = tint.colour[c] / tint.weight;
        }
    });
    return out;
}

}  // namespace chiaro

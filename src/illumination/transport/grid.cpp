#include "illumination/transport/grid.h"

#include <algorithm>

#include "classify/medium.h"
#include "cuda/executor.h"
#include "illumination/cells/rank_nodes.h"
#include "illumination/transport/axis_places.h"
#include "illumination/transport/boundary_cells.h"
#include "illumination/transport/colour_kernel.h"
#include "illumination/transport/downsample_by_3_kernel.h"
#include "illumination/transport/matter_kernel.h"
#include "illumination/transport/scattering_colours.h"
#include "illumination/visibility/surface_share.h"

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
Density downsampled_by_3(const Density& finer, const Device& device, Progress& progress) {
    Density out(coarser(finer.grid, 3));
    const auto [nx, ny, nz] = finer.grid.count;
    run_steps(device, &progress, [&, nx = nx, ny = ny, nz = nz](auto& executor) {
        const auto made = executor.template output<float>(out.buffer);
        const kernel::DownsampleBy3Kernel third{
            executor.values(finer), {nx, ny, nz}, made.data(), out.grid.count[0], out.grid.count[1]};
        executor.for_each(std::int64_t(out.grid.size()), third, "density", 256);
        made.keep();
    });
    return out;
}

/// Of a grid's cells, and of nodes about half as wide, where voxels are smaller than those.
struct Extinction {
    Density cells;
    std::shared_ptr<const Density> finer;
};

Extinction extinction_of(const Medium::Data& medium, Blocks blocks, const Device& device, Progress& progress) {
    const auto density = [&](int halvings) { return density_for(medium, 1 << halvings, device, progress); };
    if (blocks.halvings == 0) {
        Density voxels = density(0);
        if (!blocks.by_three) return {std::move(voxels), {}};
        return {downsampled_by_3(voxels, device, progress),
                std::make_shared<const Density>(halved(voxels, device, progress))};
    }
    Density half = density(blocks.halvings - 1);
    if (blocks.by_three) half = downsampled_by_3(half, device, progress);
    const auto finer = std::make_shared<const Density>(std::move(half));
    return {halved(*finer, device, progress), finer};
}

/// As StoredValues, by places found once for each coordinate.
template <class Voxel>
struct PlacedValues {
    const AxisPlaces<Voxel>& places;
    bool are_voxels;
    kernel::StoredValues<Voxel> plain;
    kernel::LabelView labels;  ///< of isosurfaces
    bool is_mixed() const { return plain.is_mixed(); }
    kernel::Rgba matter(int x, int y, int z) const { return plain.matter(x, y, z); }
    bool has_factor() const { return plain.has_factor(); }
    float factor(int x, int y, int z) const { return plain.factor(x, y, z); }
    bool has_tints() const { return labels.tint; }
    kernel::Rgba tinted(int x, int y, int z, kernel::Rgba colour) const {
        const auto p = plain.volume.clamp(plain.centres.of(x, y, z));
        return kernel::tinted(labels, plain.volume.template locate<float>(p, plain.volume.voxel(p)), colour);
    }
    float at(int x, int y, int z) const { return are_voxels ? float(places.voxel(x, y, z)) : places.value(x, y, z); }
};

std::array<std::vector<double>, 3> centres_of(const CellGrid& cells) {
    std::array<std::vector<double>, 3> centres;
    for (int axis = 0; axis < 3; ++axis)
        for (int i = 0; i < cells.count[axis]; ++i)
            centres[axis].push_back(cells.is_voxel_grid ? i : cells.voxel_of(i, i, i)[axis]);
    return centres;
}

/// The colours of a grid's nodes, each of edge³ cells.
class Colouring {
public:
    Colouring(const Medium::Data& medium, double albedo_max, int edge, const Device& device, Progress& progress)
        : medium_(medium),
          cells_(make_cell_grid(medium.volume.data().dimensions, medium.volume.data().geometry)),
          scattering_colours_(medium, albedo_max),
          edge_(edge),
          device_(device),
          progress_(progress) {}

    void fill(LightGrid& grid) const {
        const CellGrid& nodes = grid.extinction.grid;
        grid.albedo = GridColour(nodes.size());
        run_steps(device_, &progress_, [&](auto& executor) {
            auto sums = executor.template array<ScatteringColour>(nodes.size());
            const float* depths = executor.values(std::as_const(grid).extinction);
            add_colours(executor, nodes, depths, sums.data());
            gather_nodes(device_, medium_.volume.data(), nodes, sums.data());
            const auto made = executor.template output<float>(grid.albedo.buffer);
            kernel::AlbedoKernel albedos{
                depths, sums.data(), nodes.count[0], nodes.count[1], nodes.count[2], scattering_colours_.mean(), {}};
            for (std::size_t c = 0; c < 3; ++c) albedos.albedo[c] = made.data() + c * nodes.size();
            executor.for_each(std::int64_t(nodes.size()), albedos, "albedo", 512);
            made.keep();
        });
    }

private:
    template <class Values>
    kernel::NodeColours<Values> colours(const Values& values) const {
        const auto [nx, ny, nz] = cells_.count;
        return {
            values, cell_centres(medium_, cells_), scattering_colours_.view(), {nx, ny, nz}, edge_, edge_ >= 4 ? 2 : 1};
    }
    /// On the CPU row by row, by places found once for each coordinate: a look-up of each cell's own costs twice the
    /// time.
    void add_colours(CpuExecutor& executor, const CellGrid& nodes, const float* depths, ScatteringColour* sums) const {
        with_stored_voxel(medium_.volume.data(), [&](auto voxel) {
            using Voxel = decltype(voxel);
            const AxisPlaces<Voxel> places(view_of<Voxel>(medium_.volume.data()), centres_of(cells_));
            const auto of =
                colours(PlacedValues<Voxel>{places,
                                            cells_.is_voxel_grid,
                                            {view_of<Voxel>(medium_.volume.data()), cell_centres(medium_, cells_)},
                                            label_view(medium_.surface_labels.get())});
            const NodeRange own = own_nodes(medium_.volume.data(), nodes);
            if (own.is_empty()) return;
            const int high = own.end[1] - own.first[1];
            const auto add_row = [&](std::int64_t node_row) {
                const int y = own.first[1] + int(node_row % high), z = own.first[2] + int(node_row / high);
                const std::size_t row = nodes.index(0, y, z);
                for (int k = z * edge_; k < of.end(2, z); k += of.stride)
                    for (int j = y * edge_; j < of.end(1, y); j += of.stride)
                        for (int x = own.first[0]; x < own.end[0]; ++x)
                            if (depths[row + x] > 0) of.add_row(x, j, k, sums[row + x]);
            };
            executor.for_each(std::int64_t(high) * (own.end[2] - own.first[2]), add_row, "albedo", 8);
        });
    }
    void add_colours(GpuExecutor& executor, const CellGrid& nodes, const float* depths, ScatteringColour* sums) const {
        HostArrays arrays;
        medium_.volume.data().add_to(arrays), scattering_colours_.add_to(arrays);
        with_stored_voxel(medium_.volume.data(), [&](auto voxel) {
            using Values = kernel::StoredValues<decltype(voxel)>;
            kernel::ColourSums<Values> add{
                colours(Values{view_of<decltype(voxel)>(medium_.volume.data()), cell_centres(medium_, cells_)}), depths,
                nodes.count[0], nodes.count[1], sums};
            executor.exchange(arrays, add.colours.values.volume.voxels, add.colours.values.volume.spline.coefficients,
                              add.colours.values.volume.factor.entries, add.colours.scattering_colours.entries);
            executor.for_each(std::int64_t(nodes.size()), add);
        });
    }

    const Medium::Data& medium_;
    const CellGrid cells_;
    const ScatteringColours scattering_colours_;
    const int edge_;
    const Device& device_;
    Progress& progress_;
};

}  // namespace

std::vector<std::array<float, 3>> colours_at(const GridColour& colour, const std::vector<std::size_t>& nodes,
                                             const Device& device) {
    std::vector<std::array<float, 3>> found(nodes.size());
    if (nodes.empty()) return found;
    run_steps(device, nullptr, [&](auto& executor) {
        auto made = executor.template array<std::array<float, 3>>(nodes.size());
        executor.for_each(
            std::int64_t(nodes.size()),
            kernel::GatherKernel{executor.template values<float>(colour.buffer), std::int64_t(colour.nodes),
                                 executor.input(nodes), reinterpret_cast<float*>(made.data())});
        executor.fetch(found, made);
    });
    return found;
}

LightGrid light_grid(const Medium::Data& medium, int cells, double albedo_max, const Device& device, Progress& progress,
                     SurfaceModel surfaces) {
    const DeviceVolume::Data& volume = medium.volume.data();
    const CellGrid fine = make_cell_grid(volume.dimensions, volume.geometry);
    const Blocks blocks = blocks_for(fine, cells);
    check_ghosts(volume, coarser(fine, blocks.edge()));
    auto [extinction, finer] = extinction_of(medium, blocks, device, progress);
    LightGrid out{std::move(extinction), {}, medium.shape.mode == Mode::iso, {}, {}};
    out.finer = std::move(finer);
    if (!out.is_isosurface) out.boundary_cells = open_boundary_cells(medium, device, progress, out.extinction);
    if (!out.is_isosurface && surfaces == SurfaceModel::automatic)
        out.surface_share = shares_of_surface(medium, out.extinction, device, progress);
    const double edges = out.extinction.grid.edge_mm / volume.geometry.smallest_spacing_mm();
    out.resolves_skins = float(std::clamp(1 - 0.8 * (edges - 2), 0.2, 1.0));
    Colouring(medium, albedo_max, blocks.edge(), device, progress).fill(out);
    return out;
}

}  // namespace chiaro

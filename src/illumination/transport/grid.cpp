#include "illumination/transport/grid.h"

#include "classify/medium.h"
#include "core/threads.h"
#include "cuda/device_cache.h"
#include "illumination/transport/axis_places.h"
#include "illumination/transport/boundary_cells.h"
#include "illumination/transport/launch_gpu.h"
#include "illumination/transport/matter_kernel.h"
#include "illumination/transport/scattering_colours.h"

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
    const auto nodes = std::int64_t(out.grid.size());
    kernel::DownsampleBy3Kernel third{nullptr, {nx, ny, nz}, nullptr, out.grid.count[0], out.grid.count[1]};
    const auto on_gpu = [&] {
        cuda::Stream& stream = *device.stream;
        const cuda::Array<float> made(stream, out.grid.size());
        third.finer = finer.on_gpu(stream), third.to = made.data();
        kernel::run_on_gpu(stream, nodes, third);
        out.buffer.keep(device.stream, made.data());
    };
    if (cuda::try_gpu(device, on_gpu)) return out;
    third.finer = finer.data(), third.to = out.numbers();
    parallel_for(device.threads, nodes, 256, "density", progress, [&](std::int64_t first, std::int64_t end) {
        for (auto node = first; node < end; ++node) third(node);
    });
    progress.check();
    return out;
}

Density density_of_nodes(const Medium::Data& medium, Blocks blocks, const Device& device, Progress& progress) {
    Density density = density_for(medium, 1 << blocks.halvings, device, progress);
    return blocks.by_three ? downsampled_by_3(density, device, progress) : std::move(density);
}

/// As StoredValues, by places found once for each coordinate.
template <class Voxel>
struct PlacedValues {
    const AxisPlaces<Voxel>& places;
    bool are_voxels;
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
        grid.albedo = GridColour(grid.extinction.grid.size());
        if (!cuda::try_gpu(device_, [&] { fill_on_gpu(grid); })) fill_here(grid);
    }

private:
    template <class Values>
    kernel::NodeColours<Values> colours(const Values& values) const {
        const auto [nx, ny, nz] = cells_.count;
        return {
            values, cell_centres(medium_, cells_), scattering_colours_.view(), {nx, ny, nz}, edge_, edge_ >= 4 ? 2 : 1};
    }
    kernel::AlbedoKernel albedo(const CellGrid& nodes, const float* depths,
                                const kernel::ScatteringColour* sums) const {
        return {depths, sums, nodes.count[0], nodes.count[1], nodes.count[2], scattering_colours_.mean(), {}};
    }

    void fill_here(LightGrid& grid) const {
        const Density& density = grid.extinction;
        const auto [nx, ny, nz] = density.grid.count;
        std::vector<ScatteringColour> sums(density.grid.size());
        const auto each_row = [&, ny = ny, nz = nz](const auto& body) {
            parallel_for(device_.threads, std::int64_t(ny) * nz, 8, "albedo", progress_,
                         [&](std::int64_t first, std::int64_t end) {
                             for (auto row = first; row < end; ++row) body(int(row % ny), int(row / ny));
                         });
            progress_.check();
        };
        with_stored_voxel(medium_.volume.data(), [&, nx = nx](auto voxel) {
            using Voxel = decltype(voxel);
            const AxisPlaces<Voxel> places(view_of<Voxel>(medium_.volume.data()), centres_of(cells_));
            const auto of = colours(PlacedValues<Voxel>{places, cells_.is_voxel_grid});
            each_row([&](int y, int z) {
                const std::size_t row = density.grid.index(0, y, z);
                for (int k = z * edge_; k < of.end(2, z); k += of.stride)
                    for (int j = y * edge_; j < of.end(1, y); j += of.stride)
                        for (int x = 0; x < nx; ++x)
                            if (density.data()[row + x] > 0) of.add_row(x, j, k, sums[row + x]);
            });
        });
        kernel::AlbedoKernel albedos = albedo(density.grid, density.data(), sums.data());
        for (int c = 0; c < 3; ++c) albedos.albedo[c] = grid.albedo.numbers(std::size_t(c));
        each_row([&, nx = nx](int y, int z) {
            for (int x = 0; x < nx; ++x) albedos(std::int64_t(density.grid.index(x, y, z)));
        });
    }

    void fill_on_gpu(LightGrid& grid) const {
        cuda::Stream& stream = *device_.stream;
        const CellGrid& nodes = grid.extinction.grid;
        const float* depths = std::as_const(grid).extinction.on_gpu(stream);
        const cuda::Array<kernel::ScatteringColour> sums(stream, nodes.size());
        const cuda::Array<float> made(stream, 3 * nodes.size());
        HostArrays arrays;
        medium_.volume.data().add_to(arrays), scattering_colours_.add_to(arrays);
        cuda::Views views(stream, std::move(arrays));
        with_stored_voxel(medium_.volume.data(), [&](auto voxel) {
            using Values = kernel::StoredValues<decltype(voxel)>;
            kernel::ColourSums<Values> add{
                colours(Values{view_of<decltype(voxel)>(medium_.volume.data()), cell_centres(medium_, cells_)}), depths,
                nodes.count[0], nodes.count[1], sums.data()};
            views.to_device_pointers(add.colours.values.volume.voxels, add.colours.scattering_colours.entries);
            kernel::run_on_gpu(stream, std::int64_t(nodes.size()), add);
        });
        kernel::AlbedoKernel albedos = albedo(nodes, depths, sums.data());
        for (std::size_t c = 0; c < 3; ++c) albedos.albedo[c] = made.data() + c * nodes.size();
        kernel::run_on_gpu(stream, std::int64_t(nodes.size()), albedos);
        grid.albedo.buffer.keep(device_.stream, made.data());
        progress_.check();
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
    kernel::GatherKernel gather{nullptr, std::int64_t(colour.nodes), nullptr, nullptr};
    const auto on_gpu = [&] {
        cuda::Stream& stream = *device.stream;
        const cuda::Array<std::size_t> which(stream, nodes.size());
        const cuda::Array<float> made(stream, 3 * nodes.size());
        const cuda::SyncOnExit sync{stream};
        stream.upload(which.data(), nodes.data(), nodes.size() * sizeof nodes[0]);
        gather.colour = colour.on_gpu(stream), gather.which = which.data(), gather.out = made.data();
        kernel::run_on_gpu(stream, std::int64_t(nodes.size()), gather);
        stream.fetch(found.data(), made.data(), found.size() * sizeof found[0]);
    };
    if (cuda::try_gpu(device, on_gpu)) return found;
    gather.colour = colour[0], gather.which = nodes.data(), gather.out = found[0].data();
    for (std::size_t i = 0; i < nodes.size(); ++i) gather(std::int64_t(i));
    return found;
}

LightGrid light_grid(const Medium::Data& medium, int cells, double albedo_max, const Device& device,
                     Progress& progress) {
    const DeviceVolume::Data& volume = medium.volume.data();
    const Blocks blocks = blocks_for(make_cell_grid(volume.dimensions, volume.geometry), cells);
    LightGrid out{density_of_nodes(medium, blocks, device, progress), {}, medium.shape.mode == Mode::iso, {}};
    if (!out.is_surface) out.boundary_cells = open_boundary_cells(medium, device, progress, out.extinction);
    Colouring(medium, albedo_max, blocks.edge(), device, progress).fill(out);
    return out;
}

}  // namespace chiaro

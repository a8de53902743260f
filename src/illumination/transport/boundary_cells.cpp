#include "illumination/transport/boundary_cells.h"

#include "classify/medium.h"
#include "core/threads.h"
#include "cuda/device_cache.h"
#include "illumination/transport/axis_places.h"
#include "illumination/transport/launch_gpu.h"
#include "illumination/transport/opaque.h"

namespace chiaro {
namespace {

using kernel::all_points, kernel::few_points;

template <int n>
kernel::PointLattice<n> points_of(const CellGrid& nodes) {
    const Vec3& k = nodes.voxels_per_cell;
    return {{k.x, k.y, k.z}};
}

/// As ValuesAtPoints, by places found once for each coordinate.
template <class Voxel, int n>
class PlacedPoints {
public:
    PlacedPoints(const DeviceVolume::Data& volume, const CellGrid& nodes)
        : places_(view_of<Voxel>(volume), coordinates(nodes)) {}
    float at(int x, int y, int z) const { return places_.value(x, y, z); }

private:
    static std::array<std::vector<double>, 3> coordinates(const CellGrid& nodes) {
        const kernel::PointLattice points = points_of<n>(nodes);
        std::array<std::vector<double>, 3> all_axes;
        for (int axis = 0; axis < 3; ++axis)
            for (int i = 0; i < n * nodes.count[axis]; ++i) all_axes[axis].push_back(points.along(axis, i));
        return all_axes;
    }
    AxisPlaces<Voxel> places_;
};

template <class Points>
struct Placed {
    const Points& points;
    float at(int x, int y, int z) const { return points.at(x, y, z); }
};

class BoundaryCells {
public:
    BoundaryCells(const Medium::Data& medium, const Device& device, Progress& progress, Density& extinction)
        : medium_(medium), device_(device), progress_(progress), extinction_(extinction), grid_(extinction.grid) {
        const float hard = float(1 / medium.volume.data().geometry.smallest_spacing_mm());
        for (const auto& entry : medium.table.entries) is_hard_.push_back(!(entry.extinction_per_mm < hard));
        open_.resize(grid_.size());
    }

    std::vector<std::size_t> open() {
        if (!cuda::try_gpu(device_, [&] { open_on_gpu(); })) open_here();
        std::vector<std::size_t> boundary_cells;
        for (std::size_t node = 0; node < open_.size(); ++node)
            if (open_[node]) boundary_cells.push_back(node);
        return boundary_cells;
    }

private:
    std::size_t halo_size() const {
        return std::size_t(grid_.count[0] + 2) * (grid_.count[1] + 2) * (grid_.count[2] + 2);
    }
    kernel::BoundaryView view(const std::uint8_t* opaque, const kernel::Fill* fills, const std::uint8_t* thin) const {
        return {grid_.count[0], grid_.count[1], grid_.count[2], 0, opaque, fills, thin};
    }
    template <int n, class Values>
    kernel::HardPoints<Values, n> hard_points(const Values& values) const {
        const auto [nx, ny, nz] = medium_.volume.data().dimensions;
        const OpticalTable& table = medium_.table;
        return {values,
                points_of<n>(grid_),
                {is_hard_.data(),
                 table.index_scale,
                 table.index_offset,
                 double(is_hard_.size() - 1),
                 {nx - 0.5, ny - 0.5, nz - 0.5},
                 cell_centres(medium_, grid_)}};
    }

    void open_here() {
        std::vector<std::uint8_t> opaque(halo_size()), thin(grid_.size());
        std::vector<kernel::Fill> fills(grid_.size());
        const kernel::BoundaryView seen = view(opaque.data(), fills.data(), thin.data());
        const auto [nx, ny, nz] = grid_.count;
        const auto each = [&, nx = nx, ny = ny, nz = nz](const auto& step) {
            parallel_for(device_.threads, std::int64_t(ny) * nz, 4, "density", progress_,
                         [&](std::int64_t first, std::int64_t end) {
                             for (auto row = first; row < end; ++row)
                                 for (int x = 0; x < nx; ++x)
                                     step(seen, row * nx + x, x, std::int32_t(row % ny), std::int32_t(row / ny));
                         });
            progress_.check();
        };
        float* depth = extinction_.numbers();
        each(kernel::MarkOpaque{depth, opaque_from, opaque.data()});
        with_stored_voxel(medium_.volume.data(), [&](auto voxel) {
            using Voxel = decltype(voxel);
            const PlacedPoints<Voxel, few_points> at_few(medium_.volume.data(), grid_);
            const PlacedPoints<Voxel, all_points> at_all(medium_.volume.data(), grid_);
            const auto few = hard_points<few_points>(Placed{at_few});
            const auto all = hard_points<all_points>(Placed{at_all});
            each(kernel::FindFill<decltype(few), decltype(all)>{few, all, fills.data()});
        });
        each(kernel::FindThin{thin.data()});
        each(kernel::OpenBoundary{depth, depth, open_.data()});
    }

    void open_on_gpu() {
        cuda::Stream& stream = *device_.stream;
        const float* depth = std::as_const(extinction_).on_gpu(stream);
        cuda::Array<std::uint8_t> opaque(stream, halo_size());
        opaque.zero();
        const cuda::Array<std::uint8_t> thin(stream, grid_.size()), open(stream, grid_.size());
        const cuda::Array<kernel::Fill> fills(stream, grid_.size());
        const cuda::Array<float> made(stream, grid_.size());
        HostArrays arrays;
        medium_.volume.data().add_to(arrays), arrays.add(is_hard_);
        cuda::Views views(stream, std::move(arrays));
        const kernel::BoundaryView seen = view(opaque.data(), fills.data(), thin.data());
        const auto each = [&](const auto& step) {
            kernel::run_on_gpu(stream, std::int64_t(grid_.size()),
                               kernel::EachCell<std::remove_cvref_t<decltype(step)>>{step, seen});
        };
        each(kernel::MarkOpaque{depth, opaque_from, opaque.data()});
        with_stored_voxel(medium_.volume.data(), [&](auto voxel) {
            const auto there = [&](auto points) {
                auto hard =
                    hard_points<decltype(points)::n>(kernel::ValuesAtPoints<decltype(voxel), decltype(points)::n>{
                        view_of<decltype(voxel)>(medium_.volume.data()), points});
                views.to_device_pointers(hard.values.volume.voxels, hard.matter.is_hard);
                return hard;
            };
            each(kernel::FindFillOf<decltype(voxel)>{there(points_of<few_points>(grid_)),
                                                     there(points_of<all_points>(grid_)), fills.data()});
        });
        each(kernel::FindThin{thin.data()});
        each(kernel::OpenBoundary{depth, made.data(), open.data()});
        stream.download(open_.data(), open.data(), open_.size());
        stream.wait();
        Density opened(grid_);
        opened.buffer.keep(device_.stream, made.data());
        extinction_ = std::move(opened);
    }

    const Medium::Data& medium_;
    const Device& device_;
    Progress& progress_;
    Density& extinction_;
    const CellGrid grid_;
    std::vector<std::uint8_t> is_hard_, open_;  ///< entry by entry of the table; of each node
};

}  // namespace

std::vector<std::size_t> open_boundary_cells(const Medium::Data& medium, const Device& device, Progress& progress,
                                             Density& extinction) {
    return BoundaryCells(medium, device, progress, extinction).open();
}

}  // namespace chiaro

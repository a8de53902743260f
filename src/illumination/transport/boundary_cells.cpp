#include "illumination/transport/boundary_cells.h"

#include "classify/medium.h"
#include "cuda/executor.h"
#include "illumination/cells/rank_nodes.h"
#include "illumination/transport/axis_places.h"
#include "illumination/transport/boundary_kernel.h"
#include "illumination/transport/opaque.h"

namespace chiaro {
namespace {

using kernel::all_points, kernel::few_points;

template <int n>
kernel::PointLattice<n> points_of(const CellGrid& nodes) {
    const Vec3& k = nodes.voxels_per_cell;
    return {{k.x, k.y, k.z}};
}

/// As ValuesAtPoints, by places found once for each coordinate; of mixtures how many times as dense they are as what is
/// just hard.
template <class Voxel, int n>
class PlacedPoints {
public:
    PlacedPoints(const DeviceVolume::Data& volume, const CellGrid& nodes)
        : places_(view_of<Voxel>(volume), coordinates(nodes)), edge_mm_(float(volume.geometry.smallest_spacing_mm())) {}
    float at(int x, int y, int z) const {
        return places_.is_mixed() ? edge_mm_ * places_.matter(x, y, z).a : places_.value(x, y, z);
    }

private:
    static std::array<std::vector<double>, 3> coordinates(const CellGrid& nodes) {
        const kernel::PointLattice points = points_of<n>(nodes);
        std::array<std::vector<double>, 3> all_axes;
        for (int axis = 0; axis < 3; ++axis)
            for (int i = 0; i < n * nodes.count[axis]; ++i) all_axes[axis].push_back(points.along(axis, i));
        return all_axes;
    }
    AxisPlaces<Voxel> places_;
    float edge_mm_;
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
        if (is_mixed(medium)) {
            is_hard_ = {0, 1};
            return;
        }
        const float hard = float(1 / medium.volume.data().geometry.smallest_spacing_mm());
        for (const auto& entry : medium.table.entries) is_hard_.push_back(!(entry.extinction_per_mm < hard));
    }

    std::vector<std::size_t> open() {
        run_steps(device_, &progress_, [&](auto& executor) { open(executor); });
        std::vector<std::size_t> boundary_cells;
        for (std::size_t node = 0; node < open_.size(); ++node)
            if (open_[node]) boundary_cells.push_back(node);
        return boundary_cells;
    }

private:
    std::size_t halo_size() const {
        return std::size_t(grid_.count[0] + 2) * (grid_.count[1] + 2) * (grid_.count[2] + 2);
    }
    template <int n, class Values>
    kernel::HardPoints<Values, n> hard_points(const Values& values) const {
        const auto [nx, ny, nz] = medium_.volume.data().dimensions;
        const OpticalTable& table = medium_.table;
        const bool mixed = is_mixed(medium_);
        return {values,
                points_of<n>(grid_),
                {is_hard_.data(),
                 mixed ? 1 : table.index_scale,
                 mixed ? -0.5 : table.index_offset,
                 double(is_hard_.size() - 1),
                 {nx - 0.5, ny - 0.5, nz - 0.5},
                 cell_centres(medium_, grid_)}};
    }

    template <class Executor>
    void open(Executor& executor) {
        auto opaque = executor.template zeros<std::uint8_t>(halo_size());
        auto thin = executor.template array<std::uint8_t>(grid_.size());
        auto is_open = executor.template array<std::uint8_t>(grid_.size());
        auto fills = executor.template array<kernel::Fill>(grid_.size());
        const kernel::BoundaryView seen{grid_.count[0], grid_.count[1], grid_.count[2], 0,
                                        opaque.data(),  fills.data(),   thin.data()};
        Density opened(grid_);
        const auto made = executor.template output<float>(opened.buffer);
        const float* depth = executor.values(std::as_const(extinction_));
        each_cell(executor, seen, kernel::MarkOpaque{depth, opaque_from, opaque.data()});
        with_stored_voxel(medium_.volume.data(),
                          [&](auto voxel) { find_fill<decltype(voxel)>(executor, seen, fills.data()); });
        gather_nodes(device_, medium_.volume.data(), grid_, fills.data());
        each_cell(executor, seen, kernel::FindThin{thin.data()});
        each_cell(executor, seen, kernel::OpenBoundary{depth, made.data(), is_open.data()});
        executor.fetch(open_, is_open);
        made.keep();
        extinction_ = std::move(opened);
    }

    template <class Executor, class Step>
    void each_cell(Executor& executor, const kernel::BoundaryView& seen, const Step& step) const {
        executor.for_each_node(grid_.count, kernel::OnSkin<Step>{step, seen}, "density");
    }

    /// On the CPU by places found once for each coordinate.
    template <class Voxel>
    void find_fill(CpuExecutor& executor, const kernel::BoundaryView& seen, kernel::Fill* fills) const {
        const PlacedPoints<Voxel, few_points> at_few(medium_.volume.data(), grid_);
        const PlacedPoints<Voxel, all_points> at_all(medium_.volume.data(), grid_);
        const auto few = hard_points<few_points>(Placed{at_few});
        const auto all = hard_points<all_points>(Placed{at_all});
        each_cell(executor, seen, kernel::FindFill<decltype(few), decltype(all)>{few, all, fills});
    }
    template <class Voxel>
    void find_fill(GpuExecutor& executor, const kernel::BoundaryView& seen, kernel::Fill* fills) const {
        HostArrays arrays;
        medium_.volume.data().add_to(arrays), arrays.add(is_hard_);
        const auto there = [&](auto points) {
            constexpr int n = decltype(points)::n;
            auto hard = hard_points<n>(kernel::ValuesAtPoints<Voxel, n>{view_of<Voxel>(medium_.volume.data()), points});
            executor.exchange(arrays, hard.values.volume.voxels, hard.values.volume.spline.coefficients,
                              hard.values.volume.factor.entries, hard.matter.is_hard);
            return hard;
        };
        each_cell(
            executor, seen,
            kernel::FindFillOf<Voxel>{there(points_of<few_points>(grid_)), there(points_of<all_points>(grid_)), fills});
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

#include "illumination/reference/reference.h"

#include <algorithm>

#include "core/threads.h"
#include "illumination/reference/crossings.h"
#include "illumination/reference/gpu.h"
#include "illumination/reference/interpolated.h"
#include "illumination/reference/launch.h"
#include "illumination/reference/nodes.h"
#include "illumination/reference/outward.h"
#include "illumination/sh/directions.h"

namespace chiaro {
namespace {

using kernel::Lobe;
using kernel::NodeColumn;

Lobe lobe_of(ReferenceQuantity quantity) {
    if (quantity == ReferenceQuantity::obscurance) return Lobe::sphere;
    return quantity == ReferenceQuantity::ao ? Lobe::hemisphere : Lobe::cosine;
}

/// Up to sixteen nodes along x in each row of a block: what one thread traces at a time.
struct Column {
    int first, nodes;
    std::pair<int, int> y, z;
    bool is_irregular;
};

/// An irregular last node lies off the rhythm of the others: it is a column of its own.
std::vector<Column> columns_of(const NodeGrid& grid, const BlockMap& blocks) {
    std::vector<Column> columns;
    for (std::size_t b : blocks.held()) {
        const auto [x, y, z] = blocks.cells(b, grid.nodes().count);
        const int irregular = grid.is_irregular(0, x.second - 1);
        for (int first = x.first; first < x.second - irregular; first += NodeColumn::width)
            columns.push_back({first, std::min(NodeColumn::width, x.second - irregular - first), y, z, false});
        if (irregular) columns.push_back({x.second - 1, 1, y, z, true});
    }
    std::stable_partition(columns.begin(), columns.end(), [](const Column& c) { return !c.is_irregular; });
    return columns;
}

/// One column's nodes and sums.
class Tracing {
public:
    Tracing(const NodeGrid& grid, const Column& column, Lobe lobe, const CellValues& opacity)
        : grid_(grid), column_(column), x_(grid.cell(0, column.first)) {
        for (int i = 0; i < NodeColumn::width; ++i) cell_x_.push_back(float(x_ + i * grid.stride()));
        for (int j = column.y.first; j < column.y.second; ++j) y_.push_back(grid.cell(1, j));
        for (int k = column.z.first; k < column.z.second; ++k) z_.push_back(grid.cell(2, k));
        const std::size_t size = y_.size() * z_.size() * NodeColumn::width;
        light_.resize(size);
        if (lobe == Lobe::sphere) return;
        weight_.resize(size);
        for (auto& component : outward_) component.resize(size);
        for_each_node([&](std::size_t at, int i, int j, int k) {
            const Outward outward = outward_at(opacity, i, j, k, reference_normal_factor);
            for (int axis = 0; axis < 3; ++axis) outward_[axis][at] = float(outward.normal[axis]);
            outward_[3][at] = float(outward.share);
        });
    }

    int x() const { return x_; }
    NodeColumn view(int place) {
        return {.x = x_,
                .stride = grid_.stride(),
                .place = place,
                .rows_y = int(y_.size()),
                .rows_z = int(z_.size()),
                .y = y_.data(),
                .z = z_.data(),
                .cell_x = cell_x_.data(),
                .normal_x = outward_[0].data(),
                .normal_y = outward_[1].data(),
                .normal_z = outward_[2].data(),
                .share = outward_[3].data(),
                .light = light_.data(),
                .weight = weight_.data()};
    }

    void add_to(HostArrays& arrays) const {
        arrays.add(y_), arrays.add(z_), arrays.add(cell_x_), arrays.add(light_), arrays.add(weight_);
        for (const auto& component : outward_) arrays.add(component);
    }
    /// Sums that a GPU added to its copies.
    void land(cuda::Stream& stream, const NodeColumn& there) {
        stream.download(light_.data(), there.light, light_.size() * sizeof(double));
        if (!weight_.empty()) stream.download(weight_.data(), there.weight, weight_.size() * sizeof(double));
    }

    void keep(CellValues& at_nodes, int rays) const {
        std::size_t row = 0;
        for (int k = column_.z.first; k < column_.z.second; ++k)
            for (int j = column_.y.first; j < column_.y.second; ++j, row += NodeColumn::width)
                for (int i = 0; i < column_.nodes; ++i) {
                    const double weight = weight_.empty() ? rays : weight_[row + i];
                    at_nodes.data()[at_nodes.grid.index(column_.first + i, j, k)] =
                        cell_value(weight > 0 ? light_[row + i] / weight : 1);
                }
    }

private:
    template <class Visit>
    void for_each_node(const Visit& visit) const {
        std::size_t row = 0;
        for (int z : z_)
            for (int y : y_) {
                for (int i = 0; i < column_.nodes; ++i) visit(row + i, x_ + i * grid_.stride(), y, z);
                row += NodeColumn::width;
            }
    }

    const NodeGrid& grid_;
    const Column column_;
    const int x_;
    std::vector<float> cell_x_;
    std::vector<std::int32_t> y_, z_;
    std::array<std::vector<float>, 4> outward_;  ///< normal and share
    std::vector<double> light_, weight_;
};

/// A call's own copies, which a kernel may write.
NodeColumn on_gpu(cuda::Views& views, NodeColumn column) {
    const double *light = column.light, *weight = column.weight;
    views.to_device_pointers(column.y, column.z, column.cell_x, column.normal_x, column.normal_y, column.normal_z,
                             column.share, light, weight);
    column.light = const_cast<double*>(light), column.weight = const_cast<double*>(weight);
    return column;
}

constexpr std::size_t columns_together = 64;  ///< on a GPU: a million threads, 32 MB

/// The columns' sums, all of them with the same list of crossings.
template <class Follower>
void trace_on_gpu(cuda::Stream& stream, cuda::Views& medium, std::vector<Tracing>& columns, Lobe lobe,
                  const Follower& follower, const std::vector<Vec3>& directions, Progress& progress) {
    HostArrays arrays;
    for (const Tracing& column : columns) column.add_to(arrays);
    cuda::Views views(stream, std::move(arrays));
    std::vector<NodeColumn> there;
    for (Tracing& column : columns) there.push_back(on_gpu(views, column.view(follower(column.x()).place)));
    const cuda::Array<NodeColumn> their_columns(stream, there.size());
    const cuda::SyncOnExit sync{stream};
    stream.upload(their_columns.data(), there.data(), there.size() * sizeof there[0]);
    auto follow = follower(columns[0].x());
    follow_on_gpu(stream, medium, follow, directions, progress, [&](const auto& rays, Vec3 d) {
        using Rays = std::remove_cvref_t<decltype(rays)>;
        const kernel::RayKernel<Rays> kernel{rays, {float(d.x), float(d.y), float(d.z)}, lobe};
        kernel::trace_columns(stream, kernel, their_columns.data(), std::int64_t(there.size()));
    });
    for (std::size_t c = 0; c < columns.size(); ++c) columns[c].land(stream, there[c]);
    stream.wait();
}

/// Rays in all directions from all nodes. `follower(column)` makes, for a thread's column, the function from a
/// direction to the rays that the kernel follows.
template <class Rays, class Follower>
CellValues trace(const Device& device, const NodeGrid& grid, const ReferenceSettings& settings,
                 const CellOpacity& opacity, const BlockMap& blocks, const Follower& follower, Progress& progress) {
    CellValues at_nodes(grid.nodes());
    const Lobe lobe = lobe_of(settings.quantity.value_or(ReferenceQuantity::obscurance));
    const auto directions = fibonacci_directions(settings.rays);
    const auto columns = columns_of(grid, grid.blocks_for(blocks));
    HostArrays arrays;
    follower(0).add_medium(arrays);
    const auto on_gpu = [&] {
        cuda::Stream& stream = *device.stream;
        cuda::Views medium(stream, arrays);
        for (std::size_t first = 0, end; first < columns.size(); first = end) {
            std::vector<Tracing> together;
            for (end = first; end < std::min(first + columns_together, columns.size()) &&
                              columns[end].is_irregular == columns[first].is_irregular;
                 ++end)
                together.emplace_back(grid, columns[end], lobe, opacity.values);
            trace_on_gpu(stream, medium, together, lobe, follower, directions, progress);
            for (const Tracing& column : together) column.keep(at_nodes, settings.rays);
            progress.report("rays", double(end) / double(columns.size()));
        }
    };
    if (cuda::try_gpu(device, on_gpu)) return at_nodes;
    arrays.fetch();
    const auto trace_column = kernel::trace_column_for<Rays>(device.isa);
    const auto work = [&](std::int64_t c, std::int64_t) {
        Tracing tracing(grid, columns[c], lobe, opacity.values);
        auto follow = follower(tracing.x());
        for (const Vec3& d : directions) {
            if (progress.cancelled()) return;
            trace_column({follow(d), {float(d.x), float(d.y), float(d.z)}, lobe}, tracing.view(follow.place));
        }
        tracing.keep(at_nodes, settings.rays);
    };
    parallel_for(device.threads, std::int64_t(columns.size()), 1, "rays", progress, work);
    progress.check();
    return at_nodes;
}

/// Rays through cells of constant extinction.
struct CellFollower {
    Crossings crossings;
    int x, place;
    double start;
    kernel::CellRays operator()(Vec3 direction) { return crossings.along(direction, x, start); }
    void add_medium(HostArrays& arrays) const { crossings.cells().add_to(arrays); }
    void add_way(HostArrays& arrays) const { crossings.add_to(arrays); }
};

/// Rays through the interpolated medium.
template <class Voxel>
struct InterpolatedFollower {
    const InterpolatedMedium<Voxel>& medium;
    double start;
    int place = 0;
    std::vector<kernel::HalfSpaceView> planes = {};
    kernel::InterpolatedRays<Voxel> operator()(Vec3 direction) { return medium.along(direction, start, planes); }
    void add_medium(HostArrays& arrays) const { medium.add_to(arrays); }
    void add_way(HostArrays& arrays) const { arrays.add(planes); }
};

}  // namespace

CellValues reference_accessibility(const Device& device, const Medium::Data& medium, const CellOpacity& opacity,
                                   const ReferenceSettings& settings, const BlockMap& blocks, StageTimer& timer,
                                   Progress& progress, double step) {
    const NodeGrid grid(opacity.values.grid, settings.subsample);
    const double start = settings.start_half_voxels;
    const auto through_cells = [&] {
        const ExtinctionCells cells =
            timer("extinction", [&] { return ExtinctionCells(medium, opacity, settings.subsample, device, progress); });
        const auto follower = [&](int x) { return CellFollower{Crossings(cells), x, cells.place(x), start}; };
        return timer("rays", [&] {
            return trace<kernel::CellRays>(device, grid, settings, opacity, blocks, follower, progress);
        });
    };
    const auto through_voxels = [&](auto voxel) {
        using Voxel = decltype(voxel);
        const InterpolatedMedium<Voxel> interpolated(medium, grid.cells(), step);
        const auto follower = [&](int) { return InterpolatedFollower<Voxel>{interpolated, start}; };
        return timer("rays", [&] {
            return trace<kernel::InterpolatedRays<Voxel>>(device, grid, settings, opacity, blocks, follower, progress);
        });
    };
    CellValues at_nodes = settings.medium == ReferenceMedium::voxels
                              ? through_cells()
                              : with_stored_voxel(medium.volume.data(), through_voxels);
    if (grid.stride() == 1) return at_nodes;
    return timer("interpolation", [&] { return grid.interpolate(at_nodes, blocks, device.threads, progress); });
}

}  // namespace chiaro

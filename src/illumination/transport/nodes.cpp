#include "illumination/transport/nodes.h"

#include <limits>

#include "core/srgb.h"
#include "core/threads.h"
#include "illumination/transport/solver_state.h"

namespace chiaro {
namespace {

/// Samples look between nodes: a cell behind the faces of others holds what the darkest of those holds, for the
/// others may lie on a wall's far side.
void fill_behind(const OpaqueCells& opaque, TransportNodes& nodes) {
    const auto [nx, ny, nz] = nodes.grid.count;
    const auto fill = [&, nx = nx, ny = ny, nz = nz](int x, int y, int z) {
        std::size_t darkest = nodes.grid.size();
        double least = std::numeric_limits<double>::infinity();
        for (int k = std::max(z - 1, 0); k <= std::min(z + 1, nz - 1); ++k)
            for (int j = std::max(y - 1, 0); j <= std::min(y + 1, ny - 1); ++j)
                for (int i = std::max(x - 1, 0); i <= std::min(x + 1, nx - 1); ++i) {
                    const std::size_t node = nodes.grid.index(i, j, k);
                    if (!opaque.is_opaque(node) || opaque.is_buried(node)) continue;
                    const double light = luminance(&nodes.light[3 * node]);
                    if (light < least) least = light, darkest = node;
                }
        const std::size_t node = nodes.grid.index(x, y, z);
        const bool is_known = darkest < nodes.grid.size();
        for (std::size_t c = 0; c < 3; ++c) nodes.light[3 * node + c] = is_known ? nodes.light[3 * darkest + c] : 0;
        for (std::size_t m = 0; m < 9; ++m) nodes.moment[9 * node + m] = is_known ? nodes.moment[9 * darkest + m] : 0;
    };
    for (int z = 0; z < nz; ++z)
        for (int y = 0; y < ny; ++y)
            for (int x = 0; x < nx; ++x)
                if (opaque.is_buried(nodes.grid.index(x, y, z))) fill(x, y, z);
}

}  // namespace

/// Scattered light of nodes.
void TransportSolver::State::gather(std::vector<float>& scattered) const {
    if (gpu) return gpu->scattered(scattered);
    kernel::ScatteredNodeKernel kernel{
        cell_places(medium.lattices.along_x, medium.lattices.along_y), {}, {}, {}, scattered.data()};
    for (int c = 0; c < 3; ++c) {
        kernel.mean[c] = mean[c].data(), kernel.first[c] = first.light[c].data();
        for (int axis = 0; axis < 3; ++axis) kernel.moment[c][axis] = moment[c][axis].data();
    }
    parallel_for(device.threads, kernel.places.count(), 4096, [&](std::int64_t from, std::int64_t end) {
        for (std::int64_t node = from; node < end; ++node) kernel(node);
    });
}

/// Light and moment of nodes.
void TransportSolver::State::gather(std::vector<float>& light, std::vector<float>& moments) const {
    if (gpu) return gpu->nodes(light, moments);
    kernel::NodeKernel kernel{
        cell_places(medium.lattices.along_x, medium.lattices.along_y), {}, {}, {}, light.data(), moments.data()};
    for (int c = 0; c < 3; ++c) {
        kernel.mean[c] = mean[c].data();
        for (int axis = 0; axis < 3; ++axis) {
            kernel.moment[c][axis] = moment[c][axis].data();
            kernel.first_moment[c][axis] = first.moment[c][axis].data();
        }
    }
    const CellGrid& grid = matter->grid.extinction.grid;
    const auto [nx, ny, nz] = grid.count;
    parallel_for(device.threads, nz, 1, [&, nx = nx, ny = ny](std::int64_t z, std::int64_t) {
        for (int y = 0; y < ny; ++y)
            for (int x = 0; x < nx; ++x)
                kernel.gather(std::int64_t(grid.index(x, y, int(z))),
                              std::int64_t(medium.lattices.along_x.index(x, y, int(z))));
    });
}

TransportNodes TransportSolver::nodes(SurfaceModel surfaces) const {
    const State& s = *state_;
    TransportNodes out = unlit_nodes(*s.matter);
    out.iterations = s.iterations, out.change = s.change;
    s.gather(out.light, out.moment);
    const auto faces = s.gpu ? s.gpu->mean_faces() : s.mean_faces;
    for (std::size_t cell = 0; cell < s.opaque.count(); ++cell) {
        const auto seen = s.opaque.seen(cell, faces[cell]);
        std::copy(seen.begin(), seen.end(), out.light.begin() + std::ptrdiff_t(3 * s.opaque.nodes()[cell]));
    }
    fill_behind(s.opaque, out);
    if (surfaces == SurfaceModel::none) return out;
    out.scattered.resize(12 * out.grid.size());
    s.gather(out.scattered);
    return out;
}

}  // namespace chiaro

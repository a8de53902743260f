#include "illumination/transport/opaque.h"

#include <cmath>
#include <limits>

#include "core/threads.h"

namespace chiaro {

double half_space_reflectance(double albedo) {
    const double s = std::sqrt(std::max(1 - albedo, 0.0));
    return (1 - s) * (1 - 0.139 * s) / (1 + 1.17 * s);
}

double reflected_per_albedo(double albedo) {
    const double a = std::max(albedo, 1e-4);
    return half_space_reflectance(a) / a;
}

OpaqueCells::OpaqueCells(const LightGrid& grid, float threshold, const Device& device)
    : count_(grid.extinction.grid.count),
      bits_(std::size_t(count_[0] + 2) * (count_[1] + 2) * (count_[2] + 2), 0xff),
      clear_(bits_.size(), 1) {
    if (threshold == std::numeric_limits<float>::infinity()) return;
    kind_.resize(grid.extinction.grid.size());
    for (std::size_t node = 0; node < kind_.size(); ++node)
        kind_[node] = grid.extinction.data()[node] >= threshold ? buried : clear;
    ids_.assign(kind_.size(), -1);
    find_shown(grid.extinction.grid);
    find_reflectance(grid, device);
    find_behind(grid.extinction.grid);
    around_.reserve(listed());
    for (std::size_t node : nodes_) around_.push_back(around(node));
    for (std::size_t node : behind_) around_.push_back(around(node));
}

/// Of a node and its 26 neighbours, as kernel::OpaqueCell has them.
std::uint32_t OpaqueCells::around(std::size_t node) const {
    const std::size_t nx = std::size_t(count_[0]), ny = std::size_t(count_[1]);
    const std::uint8_t* own = clear_.data() + bit_index(int(node % nx), int(node / nx % ny), int(node / nx / ny));
    std::uint32_t bits = 0;
    int bit = 0;
    for (int k = -1; k <= 1; ++k)
        for (int j = -1; j <= 1; ++j)
            for (int i = -1; i <= 1; ++i) bits |= std::uint32_t(own[k * stride(2) + j * stride(1) + i]) << bit++;
    return bits;
}

void OpaqueCells::find_shown(const CellGrid& cells) {
    const auto [nx, ny, nz] = count_;
    const auto is_open = [&](int x, int y, int z) {
        return !cells.holds(x, y, z) || kind_[cells.index(x, y, z)] == clear;
    };
    for (int z = 0; z < nz; ++z)
        for (int y = 0; y < ny; ++y)
            for (int x = 0; x < nx; ++x) {
                const std::size_t node = cells.index(x, y, z);
                if (kind_[node] == clear) continue;
                const int open = is_open(x + 1, y, z) | is_open(x - 1, y, z) << 1 | is_open(x, y + 1, z) << 2 |
                                 is_open(x, y - 1, z) << 3 | is_open(x, y, z + 1) << 4 | is_open(x, y, z - 1) << 5;
                std::uint8_t bits = 0;
                for (int o = 0; o < octants; ++o)
                    for (int axis = 0; axis < 3; ++axis)
                        bits |= std::uint8_t((open >> kernel::face_left(o, axis) & 1) << o);
                bits_[std::size_t(bit_index(x, y, z))] = bits;
                clear_[std::size_t(bit_index(x, y, z))] = 0;
                if (!open) continue;
                ids_[node] = std::int32_t(nodes_.size());
                nodes_.push_back(node), open_.push_back(std::uint8_t(open));
            }
    for (std::size_t node : nodes_) kind_[node] = shown;
}

void OpaqueCells::find_reflectance(const LightGrid& grid, const Device& device) {
    const auto colours = colours_at(grid.albedo, nodes_, device);
    for (std::size_t cell = 0; cell < nodes_.size(); ++cell) {
        const double q = grid.share_of_surface(nodes_[cell]);
        std::array<float, 3> reflectance, per_albedo;
        for (int c = 0; c < 3; ++c) {
            const double a = colours[cell][c];
            reflectance[c] = float(std::lerp(half_space_reflectance(a), a, q));
            per_albedo[c] = float(std::lerp(reflected_per_albedo(a), 1.0, q));
        }
        reflectance_.push_back(reflectance), per_albedo_.push_back(per_albedo);
    }
}

/// A ray between four cells may pass the edge of two opaque ones and find the one behind, which shows no face there: it
/// looks like those in front of it.
void OpaqueCells::find_behind(const CellGrid& grid) {
    const auto [nx, ny, nz] = count_;
    for (int z = 0; z < nz; ++z)
        for (int y = 0; y < ny; ++y)
            for (int x = 0; x < nx; ++x) {
                const std::size_t node = grid.index(x, y, z);
                if (kind_[node] == clear) continue;
                for (int o = 0; o < octants; ++o) {
                    if (bits_[std::size_t(bit_index(x, y, z))] >> o & 1) continue;
                    kernel::OpaqueCover cover{ids_[node], o, {}, 0};
                    for (int axis = 0; axis < 3; ++axis) {
                        std::array<int, 3> p{x, y, z};
                        p[axis] += o >> axis & 1 ? 1 : -1;
                        const std::int32_t id = id_of(grid, p[0], p[1], p[2]);
                        const bool results = id >= 0 && std::size_t(id) < count() &&
                                             (bits_[std::size_t(bit_index(p[0], p[1], p[2]))] >> o & 1);
                        if (results) cover.in_front[cover.count++] = id;
                    }
                    if (cover.count == 0) continue;
                    if (cover.id < 0) {
                        cover.id = ids_[node] = std::int32_t(listed());
                        behind_.push_back(node), kind_[node] = behind;
                    }
                    covers_.push_back(cover);
                }
            }
}

OpaqueCells::Rows OpaqueCells::list_rows(bool along_y) const {
    const auto [nx, ny, nz] = count_;
    const int length = along_y ? ny : nx, inner = along_y ? nz : ny, outer = along_y ? nx : nz;
    const std::size_t slice = std::size_t(nx) * ny, step = along_y ? nx : 1;
    Rows rows{{}, {0}};
    for (int b = 0; b < outer; ++b)
        for (int a = 0; a < inner; ++a) {
            const std::size_t first = along_y ? a * slice + b : b * slice + std::size_t(a) * nx;
            for (int i = 0; i < length && !ids_.empty(); ++i)
                if (const std::int32_t id = ids_[first + i * step]; id >= 0)
                    rows.cells.push_back({i, id, around_[std::size_t(id)]});
            rows.starts.push_back(std::int32_t(rows.cells.size()));
        }
    return rows;
}

std::span<const kernel::OpaqueCell> OpaqueCells::row(const Lattice& lattice, int a, int b) const {
    const Rows& rows = (lattice.along_y() ? along_y_ : along_x_)([&] { return list_rows(lattice.along_y()); });
    const std::size_t row = lattice.along_y() ? std::size_t(a) * count_[2] + b : std::size_t(b) * count_[1] + a;
    const std::int32_t first = rows.starts[row], end = rows.starts[row + 1];
    return std::span(rows.cells).subspan(std::size_t(first), std::size_t(end - first));
}

void OpaqueCells::reflect(const std::vector<Faces>& radiance, int threads, LatticeField& emission) const {
    emission.assign(listed() * octants * 4, 0);
    const kernel::ReflectKernel reflect = reflect_kernel(numbers(radiance), emission.data());
    const kernel::CoverKernel cover = cover_kernel(emission.data());
    parallel_for(threads, std::int64_t(count() * octants), 8192, [&](std::int64_t i, std::int64_t end) {
        for (; i < end; ++i) reflect(i);
    });
    for (std::size_t i = 0; i < covers(); ++i) cover(std::int64_t(i));
}

std::vector<std::int32_t> OpaqueCells::ids_with_halo() const {
    std::vector<std::int32_t> ids(clear_.size(), -1);
    const auto [nx, ny, nz] = count_;
    for (std::size_t node = 0; node < ids_.size(); ++node)
        ids[std::size_t(bit_index(int(node % nx), int(node / nx % ny), int(node / nx / ny)))] = ids_[node];
    return ids;
}

std::array<float, 3> OpaqueCells::seen(std::size_t cell, const Faces& radiance) const {
    std::array<float, 3> sum{};
    float open = 0;
    for (int face = 0; face < faces; ++face) {
        if (!is_open(cell, face)) continue;
        open += 1;
        for (int c = 0; c < 3; ++c) sum[c] += radiance[face][c];
    }
    for (int c = 0; c < 3; ++c) sum[c] *= per_albedo_[cell][c] / open;
    return sum;
}

}  // namespace chiaro

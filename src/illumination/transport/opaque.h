// Cells through which nothing passes: they answer face by face, so that no light leaks through walls of a cell or two.
#pragma once
#include <span>

#include "core/host_array.h"
#include "core/lazy.h"
#include "illumination/transport/grid.h"
#include "illumination/transport/lattice.h"
#include "illumination/transport/opaque_kernel.h"
#include "illumination/transport/sweep_kernel.h"

namespace chiaro {

/// Cells whose optical thickness is at least this are opaque. Measured on the engine, albedo .95: the mean radiance in
/// the air is 4.5 % too bright with 4, and .4 % too dark with 2.
inline constexpr float opaque_from = 2;
/// What such a cell stops at least: 1 - exp(-opaque_from), rounded down.
inline constexpr float opaque_weight = 0.8646f;

/// What a half space of albedo a reflects of diffuse light (isotropic scattering; van de Hulst 1980: (1 - s) (1 - .139
/// s) / (1 + 1.17 s), s = √(1 - a)).
double half_space_reflectance(double albedo);
/// That over the albedo: what a sample is lit by, since its colour comes on top.
double reflected_per_albedo(double albedo);

/// Opaque cells that show a face. Faces: +x, -x, +y ...; octants by the signs of a direction (1: -x, 2: -y, 4: -z).
class OpaqueCells {
public:
    static constexpr int faces = 6, octants = 8;
    using Faces = std::array<std::array<float, 4>, faces>;  ///< RGB, and what it weighs

    /// None where `threshold` is infinite.
    OpaqueCells(const LightGrid& grid, float threshold, const Device& device);

    /// Those that show a face; those behind them follow in the lists of rows, up to `listed`.
    std::size_t count() const { return nodes_.size(); }
    std::size_t listed() const { return nodes_.size() + behind_.size(); }
    bool is_opaque(std::size_t node) const { return !kind_.empty() && kind_[node] != 0; }
    /// Without a face in the open.
    bool is_buried(std::size_t node) const { return !kind_.empty() && kind_[node] >= buried; }
    /// Whether rays may find it: it has a face in the open, or is seen past the edge of one that has.
    bool is_listed(std::size_t node) const { return !ids_.empty() && ids_[node] >= 0; }
    /// Node of each cell, x fastest.
    const std::vector<std::size_t>& nodes() const { return nodes_; }
    bool is_open(std::size_t cell, int face) const { return open_[cell] >> face & 1; }

    /// Those in a row of a lattice.
    std::span<const kernel::OpaqueCell> row(const Lattice& lattice, int a, int b) const;

    /// A byte a cell, 0 where it is opaque. With a halo of one about the grid: index of a node, strides.
    const std::uint8_t* clear_cells() const { return clear_.data(); }
    std::int64_t bit_index(int x, int y, int z) const { return (z + 1) * stride(2) + (y + 1) * stride(1) + (x + 1); }
    std::int64_t stride(int axis) const {
        return axis == 0 ? 1 : axis == 1 ? count_[0] + 2 : std::int64_t(count_[0] + 2) * (count_[1] + 2);
    }

    /// Which cells around each listed one are clear (kernel::OpaqueCell).
    const std::vector<std::uint32_t>& around() const { return around_; }

    /// A field's worth of them, [cell][face][4], as kernels have it.
    static float* numbers(std::vector<Faces>& faces) { return reinterpret_cast<float*>(faces.data()); }
    static const float* numbers(const std::vector<Faces>& faces) {
        return reinterpret_cast<const float*>(faces.data());
    }

    /// What each cell sends back of the light on its faces, as a ray towards an octant finds it: [octant][cell][4].
    void reflect(const std::vector<Faces>& radiance, int threads, LatticeField& emission) const;
    /// That, from and to elsewhere: first for each octant of each cell, then for each of the covers.
    kernel::ReflectKernel reflect_kernel(const float* faces, float* emission) const {
        return {open_.data(), reinterpret_cast<const float*>(reflectance_.data()), faces, std::int64_t(listed()),
                emission};
    }
    kernel::CoverKernel cover_kernel(float* emission) const {
        return {covers_.data(), std::int64_t(listed()), emission};
    }
    std::size_t covers() const { return covers_.size(); }
    /// What kernels read.
    void add_to(HostArrays& arrays) const {
        arrays.add(open_), arrays.add(reflectance_), arrays.add(covers_), arrays.add(clear_);
        arrays.add(around_);
    }
    /// Each cell's id, or -1, with the halo.
    std::vector<std::int32_t> ids_with_halo() const;

    /// The mean light on the open faces × what is reflected / albedo.
    std::array<float, 3> seen(std::size_t cell, const Faces& radiance) const;
    /// What is reflected / albedo.
    const std::array<float, 3>& per_albedo(std::size_t cell) const { return per_albedo_[cell]; }

private:
    enum Kind : std::uint8_t { clear = 0, shown = 1, buried = 2, behind = 3 };
    void find_shown(const CellGrid& cells);
    void find_reflectance(const LightGrid& grid, const Device& device);
    void find_behind(const CellGrid& grid);
    std::uint32_t around(std::size_t node) const;
    struct Rows {
        std::vector<kernel::OpaqueCell> cells;
        std::vector<std::int32_t> starts;  ///< of rows (y, z), or (z, x) of those along y
    };
    Rows list_rows(bool along_y) const;
    /// The cell's id, or -1.
    std::int32_t id_of(const CellGrid& grid, int x, int y, int z) const {
        return grid.holds(x, y, z) ? ids_[grid.index(x, y, z)] : -1;
    }

    std::array<int, 3> count_;
    std::vector<std::uint8_t> kind_;  ///< of each node
    std::vector<std::size_t> nodes_;
    std::vector<std::uint8_t> open_;  ///< faces of each cell
    std::vector<std::array<float, 3>> reflectance_, per_albedo_;
    std::vector<std::int32_t> ids_;    ///< of each node
    std::vector<std::size_t> behind_;  ///< nodes of the cells behind
    std::vector<kernel::OpaqueCover> covers_;
    std::vector<std::uint8_t> bits_;   ///< bit o: a ray towards octant o finds a face in the open; with the halo
    std::vector<std::uint8_t> clear_;  ///< with the halo
    std::vector<std::uint32_t> around_;
    Lazy<Rows> along_x_, along_y_;
};

}  // namespace chiaro

#include "illumination/transport/skin.h"

#include <cmath>

#include "classify/clip.h"
#include "classify/medium.h"
#include "core/threads.h"
#include "illumination/transport/axis_places.h"
#include "illumination/transport/opaque.h"

namespace chiaro {
namespace {

constexpr int samples = 4;  ///< of a cell, per axis

/// How much of a cell hard matter fills, and which way its middle lies.
struct Fill {
    float share = 1;
    Vec3 middle{0, 0, 0};

    bool is_thin() const { return share > 0 && share <= 0.5f; }
};

/// n points of each cell along one axis, voxels.
std::vector<double> points_of(const CellGrid& nodes, int axis, int n) {
    std::vector<double> points;
    for (int cell = 0; cell < nodes.count[axis]; ++cell)
        for (int i = 0; i < n; ++i) {
            const double off = (i + 0.5) / n - 0.5;
            points.push_back(nodes.voxel_of(cell + off, cell + off, cell + off)[axis]);
        }
    return points;
}
std::array<std::vector<double>, 3> points_of(const CellGrid& nodes, int n) {
    return {points_of(nodes, 0, n), points_of(nodes, 1, n), points_of(nodes, 2, n)};
}

/// What hard matter fills of cells, by n points per axis.
template <class Voxel>
class HardPoints {
public:
    HardPoints(const Medium::Data& medium, const CellGrid& nodes, int n)
        : n_(n),
          table_(medium.table),
          points_(points_of(nodes, n)),
          places_(view_of<Voxel>(medium.volume.data()), points_),
          kept_(half_spaces(medium.shape.clip, medium.volume.data().geometry, medium.volume.data().dimensions)) {
        const float hard = float(1 / medium.volume.data().geometry.smallest_spacing_mm());
        for (const auto& entry : medium.table.entries) is_hard_.push_back(!(entry.extinction_per_mm < hard));
        for (int axis = 0; axis < 3; ++axis) last_[axis] = medium.volume.data().dimensions[axis] - 0.5;
    }

    Fill of_node(int x, int y, int z) const {
        Fill fill;
        int count = 0;
        for (int k = 0; k < n_; ++k)
            for (int j = 0; j < n_; ++j)
                for (int i = 0; i < n_; ++i) {
                    if (!is_hard(x * n_ + i, y * n_ + j, z * n_ + k)) continue;
                    fill.middle = fill.middle + Vec3{(i + 0.5) / n_ - 0.5, (j + 0.5) / n_ - 0.5, (k + 0.5) / n_ - 0.5};
                    ++count;
                }
        fill.share = float(count) / float(n_ * n_ * n_);
        return fill;
    }

private:
    bool is_hard(int x, int y, int z) const {
        const Vec3 p{points_[0][x], points_[1][y], points_[2][z]};
        for (int axis = 0; axis < 3; ++axis)
            if (p[axis] > last_[axis]) return false;
        const double index = table_.index_of(places_.value(x, y, z)) + 0.5;
        if (!is_hard_[std::size_t(std::clamp(index, 0.0, double(is_hard_.size() - 1)))]) return false;
        return std::none_of(kept_.begin(), kept_.end(), [&](const HalfSpace& h) { return dot(h.normal, p) > h.d; });
    }

    int n_;
    const OpticalTable& table_;
    std::array<std::vector<double>, 3> points_;
    AxisPlaces<Voxel> places_;
    std::vector<HalfSpace> kept_;
    std::vector<std::uint8_t> is_hard_;  ///< entry by entry of the table
    double last_[3];
};

/// Two points per axis tell most cells that are full.
template <class Voxel>
class HardMatter {
public:
    HardMatter(const Medium::Data& medium, const CellGrid& nodes)
        : few_(medium, nodes, 2), all_(medium, nodes, samples) {}

    Fill of_node(int x, int y, int z) const {
        const Fill rough = few_.of_node(x, y, z);
        return rough.share > 0.5f ? rough : all_.of_node(x, y, z);
    }

private:
    HardPoints<Voxel> few_, all_;
};

/// What there is of a cell and its 26 neighbours, a bit each.
using Around = std::uint32_t;
constexpr int bit_of(int i, int j, int k) { return (k + 1) * 9 + (j + 1) * 3 + i + 1; }

/// Each place and its 26 neighbours, of 27.
constexpr std::array<Around, 27> neighbours = [] {
    std::array<Around, 27> all{};
    for (int a = 0; a < 27; ++a)
        for (int b = 0; b < 27; ++b) {
            const auto near = [](int p, int q) { return p - q <= 1 && q - p <= 1; };
            if (near(a % 3, b % 3) && near(a / 3 % 3, b / 3 % 3) && near(a / 9, b / 9)) all[a] |= 1u << b;
        }
    return all;
}();

Around beside(Around places) {
    Around all = 0;
    for (int place = 0; place < 27; ++place)
        if (places >> place & 1) all |= neighbours[place];
    return all;
}

/// Whether what is clear hangs together, and touches all that is thin.
bool is_one_side(Around clear, Around thin) {
    Around piece = clear & (~clear + 1);
    for (Around before = 0; piece != before;) {
        before = piece;
        piece |= beside(piece) & clear;
    }
    return piece == clear && (thin & ~beside(piece)) == 0;
}

class Skins {
public:
    explicit Skins(Density& extinction)
        : grid_(extinction.grid),
          row_(grid_.count[0] + 2),
          slice_(row_ * (grid_.count[1] + 2)),
          is_opaque_(slice_ * (grid_.count[2] + 2)),
          fills_(grid_.size()) {
        const auto [nx, ny, nz] = grid_.count;
        for (int z = 0; z < nz; ++z)
            for (int y = 0; y < ny; ++y)
                for (int x = 0; x < nx; ++x)
                    is_opaque_[place(x, y, z)] = extinction.data()[grid_.index(x, y, z)] >= opaque_from;
    }

    /// Also of places one outside the grid, which are not.
    bool is_opaque(int x, int y, int z) const { return is_opaque_[place(x, y, z)] != 0; }
    /// On a surface: in a corner between walls only an edge may lie in the open.
    bool is_asked(int x, int y, int z) const {
        if (!is_opaque(x, y, z)) return false;
        for (int k = -1; k <= 1; ++k)
            for (int j = -1; j <= 1; ++j)
                for (int i = -1; i <= 1; ++i)
                    if (!is_opaque(x + i, y + j, z + k)) return true;
        return false;
    }
    Fill& fill(int x, int y, int z) { return fills_[grid_.index(x, y, z)]; }

    /// Thin, before a cell that is not.
    bool is_backed(int x, int y, int z) const {
        const Fill& here = fills_[grid_.index(x, y, z)];
        if (!is_opaque(x, y, z) || !here.is_thin()) return false;
        const Vec3 m = here.middle;
        const double most = std::max({std::abs(m.x), std::abs(m.y), std::abs(m.z)});
        const auto step = [&](double c) { return std::abs(c) > 0.5 * most ? (c > 0 ? 1 : -1) : 0; };
        const int i = x + step(m.x), j = y + step(m.y), k = z + step(m.z);
        return is_opaque(i, j, k) && !fills_[grid_.index(i, j, k)].is_thin();
    }
    /// Whether nothing parts here, were all the thin cells around open: c and a thin cell on the other side may not
    /// leave a wall of edges.
    template <class IsThin>
    bool is_on_one_side(int x, int y, int z, const IsThin& is_thin) const {
        Around clear = 0, thin = 0;
        for (int k = -1; k <= 1; ++k)
            for (int j = -1; j <= 1; ++j)
                for (int i = -1; i <= 1; ++i) {
                    const Around bit = 1u << bit_of(i, j, k);
                    if (!is_opaque(x + i, y + j, z + k))
                        clear |= bit;
                    else if (is_thin(x + i, y + j, z + k))
                        thin |= bit;
                }
        return is_one_side(clear, thin);
    }

private:
    std::size_t place(int x, int y, int z) const { return (z + 1) * slice_ + (y + 1) * row_ + x + 1; }

    const CellGrid& grid_;
    std::size_t row_, slice_;
    std::vector<std::uint8_t> is_opaque_;  ///< with a halo of one about the grid
    std::vector<Fill> fills_;
};

}  // namespace

std::vector<std::size_t> open_skins(const Medium::Data& medium, const Device& device, Progress& progress,
                                    Density& extinction) {
    const CellGrid& grid = extinction.grid;
    const auto [nx, ny, nz] = grid.count;
    const auto each = [&, nx = nx, ny = ny, nz = nz](const auto& body) {
        parallel_for(device.threads, std::int64_t(ny) * nz, 4, "density", progress,
                     [&](std::int64_t first, std::int64_t end) {
                         for (auto row = first; row < end; ++row)
                             for (int x = 0; x < nx; ++x) body(x, int(row % ny), int(row / ny));
                     });
        progress.check();
    };
    Skins surface(extinction);
    with_stored_voxel(medium.volume.data(), [&](auto voxel) {
        const HardMatter<decltype(voxel)> matter(medium, grid);
        each([&](int x, int y, int z) {
            if (surface.is_asked(x, y, z)) surface.fill(x, y, z) = matter.of_node(x, y, z);
        });
    });
    std::vector<std::uint8_t> thin(grid.size()), open(grid.size());
    each([&](int x, int y, int z) { thin[grid.index(x, y, z)] = surface.is_backed(x, y, z); });
    const auto is_thin = [&](int x, int y, int z) { return thin[grid.index(x, y, z)] != 0; };
    each([&](int x, int y, int z) {
        open[grid.index(x, y, z)] = is_thin(x, y, z) && surface.is_on_one_side(x, y, z, is_thin);
    });
    std::vector<std::size_t> skins;
    for (int z = 0; z < nz; ++z)
        for (int y = 0; y < ny; ++y)
            for (int x = 0; x < nx; ++x)
                if (const std::size_t node = grid.index(x, y, z); open[node]) {
                    extinction.numbers()[node] = -std::log(1 - surface.fill(x, y, z).share);
                    skins.push_back(node);
                }
    return skins;
}

}  // namespace chiaro

#include "core/threads.h"
#include "illumination/probe/data.h"
#include "illumination/sh/quadrature.h"

namespace chiaro {
namespace {

constexpr int waves = 2 * max_bands - 1;  // cos and sin of mφ, index m + 3
using Waves = std::array<double, waves>;
using Channels = std::array<ShCoefficients, 3>;

/// ∫ cos mφ or sin |m|φ over each column.
std::vector<Waves> column_integrals(const ProbeImage& image) {
    const double width = 2 * std::numbers::pi / image.width;
    std::vector<Waves> columns(image.width);
    for (int x = 0; x < image.width; ++x) {
        const double phi = image.azimuth(x + 0.5);
        columns[x][3] = width;
        for (int m = 1; m < max_bands; ++m) {
            const double extent = 2 * std::sin(m * width / 2) / m;
            columns[x][3 + m] = extent * std::cos(m * phi);
            columns[x][3 - m] = extent * std::sin(m * phi);
        }
    }
    return columns;
}

/// ∫ P_lm(θ) sin θ dθ over a row; P_lm is Y_l|m| at azimuth 0. In pieces of at most 3°, so that four points are plenty.
ShCoefficients row_integrals(const ProbeImage& image, int y) {
    ShCoefficients sums{};
    const int pieces = 1 + 60 / image.height;
    const double half = std::numbers::pi / image.height / pieces / 2;
    for (int piece = 0; piece < pieces; ++piece)
        for (const auto [x, weight] : gauss_legendre) {
            const double theta = image.polar_angle(y + (piece + (1 + x) / 2) / pieces);
            const ShCoefficients polar = spherical_harmonics({std::sin(theta), 0, std::cos(theta)});
            for (int l = 0; l < max_bands; ++l)
                for (int m = -l; m <= l; ++m)
                    sums[l * (l + 1) + m] += weight * half * std::sin(theta) * polar[l * (l + 1) + std::abs(m)];
        }
    return sums;
}

Channels project_row(const ProbeImage& image, const std::vector<Waves>& columns, int y) {
    std::array<Waves, 3> sums{};
    const float* pixel = image.rgb.data() + std::size_t(3) * image.width * y;
    for (int x = 0; x < image.width; ++x)
        for (int c = 0; c < 3; ++c, ++pixel)
            for (int k = 0; k < waves; ++k) sums[c][k] += double(*pixel) * columns[x][k];
    const ShCoefficients polar = row_integrals(image, y);
    Channels row;
    for (int c = 0; c < 3; ++c)
        for (int l = 0; l < max_bands; ++l)
            for (int m = -l; m <= l; ++m) row[c][l * (l + 1) + m] = polar[l * (l + 1) + m] * sums[c][3 + m];
    return row;
}

}  // namespace

Channels project(const ProbeImage& image) {
    const std::vector<Waves> columns = column_integrals(image);
    std::vector<Channels> rows(image.height);
    parallel_for(image.height, 16, [&](std::int64_t first, std::int64_t last) {
        for (auto y = first; y < last; ++y) rows[y] = project_row(image, columns, int(y));
    });
    Channels sums{};
    for (const Channels& row : rows)
        for (int c = 0; c < 3; ++c)
            for (int i = 0; i < max_coefficients; ++i) sums[c][i] += row[c][i];
    return sums;
}

}  // namespace chiaro

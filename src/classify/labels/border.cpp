#include "classify/labels/border.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace chiaro {
namespace {

constexpr float widest_sigma = 2.25f, narrower_sigmas[] = {1.2f, 0.6f};
constexpr float density_at_0 = 0.3989423f;  ///< of the normal distribution
/// Where the best voxel around one lies so far on their side, voxels, the wide filter has lost what they belong to; and
/// where one lies so far on the wrong side.
constexpr float lost_at = 0.4f, kept_at = 0.7f, wrong_from = 0.25f, wrong_at = 0.5f;
constexpr float nearest = 0.05f;  ///< voxels: of a border to a voxel's centre

int reach_of(float sigma) { return int(std::lround(2.9 * sigma)); }

/// One half of a Gaussian, the middle first.
std::vector<float> kernel_of(float sigma) {
    std::vector<float> kernel(std::size_t(reach_of(sigma)) + 1);
    double sum = 0;
    for (std::size_t i = 0; i < kernel.size(); ++i) {
        const double x = double(i) / sigma, g = std::exp(-0.5 * x * x);
        kernel[i] = float(g), sum += i ? 2 * g : g;
    }
    for (float& k : kernel) k = float(k / sum);
    return kernel;
}

/// out[i] = Σ_t k[|t|] in[i + t * stride], n of them; known when compiling, which saves a third of the time.
template <int n>
void convolve(const std::vector<float>& kernel, const float* in, std::ptrdiff_t stride, float* out) {
    for (int i = 0; i < n; ++i) out[i] = kernel[0] * in[i];
    for (std::size_t t = 1; t < kernel.size(); ++t) {
        const float k = kernel[t];
        const float *before = in - std::ptrdiff_t(t) * stride, *behind = in + std::ptrdiff_t(t) * stride;
        for (int i = 0; i < n; ++i) out[i] += k * (before[i] + behind[i]);
    }
}

float share(float from, float to, float x) { return std::clamp((x - from) / (to - from), 0.0f, 1.0f); }

}  // namespace

std::array<float, 3> border_widths(const Vec3& spacing_mm) {
    constexpr double thick = 1.5, narrowest = 0.6, widest = 2.5;
    const double least = std::min({spacing_mm.x, spacing_mm.y, spacing_mm.z}),
                 most = std::max({spacing_mm.x, spacing_mm.y, spacing_mm.z});
    if (most < thick * least) return {1, 1, 1};
    std::array<float, 3> widths;
    for (int axis = 0; axis < 3; ++axis)
        widths[std::size_t(axis)] = float(std::clamp(std::sqrt(least * most) / spacing_mm[axis], narrowest, widest));
    return widths;
}

int BorderTile::halo_of(const Widths& widths) {
    return reach_of(2 * widest_sigma * *std::max_element(widths.begin(), widths.end())) + margin_of(widths);
}

BorderTile::BorderTile(const Widths& widths)
    : widths_(widths),
      margin_(margin_of(widths)),
      span_(edge + 2 * margin_),
      halo_(halo_of(widths)),
      row_(edge + 2 * halo_),
      source_(std::size_t(row_) * row_ * row_),
      own_(std::size_t(span_) * span_ * span_),
      along_x_(std::size_t(row_) * row_ * span_),
      along_y_(std::size_t(row_) * span_ * span_),
      narrow_(std::size_t(span_) * span_ * span_),
      wide_(narrow_.size()),
      smooth_(narrow_.size()),
      local_(narrow_.size()),
      thin_(narrow_.size()),
      distance_(std::size_t(edge) * edge * edge) {}

/// 2 G(σ) - G(2σ) as a distance: a plane's value rises by 1.5 φ(0) / σ a voxel.
void BorderTile::smooth(float sigma, const Widths& widths, std::vector<float>& out) {
    const int first = halo_ - margin_, row = row_, span = span_;
    constexpr int narrow_span = edge + 2 * 4, wide_span = edge + 2 * 5;  // by margin_
    const auto line_of = span == narrow_span ? convolve<narrow_span> : convolve<wide_span>;
    const auto slice_of = span == narrow_span ? convolve<narrow_span * narrow_span> : convolve<wide_span * wide_span>;
    const auto blur = [&](float s, std::vector<float>& blurred) {
        const std::vector<float> x = kernel_of(s * widths[0]), y = kernel_of(s * widths[1]),
                                 z = kernel_of(s * widths[2]);
        for (int line = 0; line < row * row; ++line)
            line_of(x, source_.data() + std::ptrdiff_t(line) * row + first, 1,
                    along_x_.data() + std::ptrdiff_t(line) * span);
        for (int k = 0; k < row; ++k)
            for (int j = 0; j < span; ++j)
                line_of(y, along_x_.data() + (std::ptrdiff_t(k) * row + j + first) * span, span,
                        along_y_.data() + (std::ptrdiff_t(k) * span + j) * span);
        for (int k = 0; k < span; ++k)
            slice_of(z, along_y_.data() + std::ptrdiff_t(k + first) * span * span, span * span,
                     blurred.data() + std::ptrdiff_t(k) * span * span);
    };
    blur(sigma, narrow_), blur(2 * sigma, wide_);
    const float per_voxel = widths == alike ? sigma / (1.5f * density_at_0) : 1;
    for (std::size_t i = 0; i < out.size(); ++i) out[i] = (2 * narrow_[i] - wide_[i]) * per_voxel;
    if (widths == alike) return;
    narrow_ = out;
    divide_by_slope(sigma, widths, out);
}

/// Of the values in `narrow_`. Where they are nearly even, as in the middle of what the filter has lost, by more than
/// half a plane's slope in that direction: that structure is told by its small distance.
void BorderTile::divide_by_slope(float sigma, const Widths& widths, std::vector<float>& out) const {
    constexpr float of_plane = 0.6f * 1.5f * density_at_0;
    const int span = span_;
    const std::array<int, 3> stride{1, span, span * span};
    for (int z = 1; z < span - 1; ++z)
        for (int y = 1; y < span - 1; ++y)
            for (int x = 1; x < span - 1; ++x) {
                const int i = (z * span + y) * span + x;
                float squares = 0, across = 0;
                for (std::size_t a = 0; a < 3; ++a) {
                    const float g = 0.5f * (narrow_[std::size_t(i + stride[a])] - narrow_[std::size_t(i - stride[a])]);
                    squares += g * g, across += widths[a] * widths[a] * g * g;
                }
                const float width = sigma * std::sqrt(across / std::max(squares, 1e-9f));
                out[std::size_t(i)] =
                    narrow_[std::size_t(i)] / std::max(std::sqrt(squares), of_plane / std::max(width, 1e-3f));
            }
}

/// 1 where the wide filter has lost what a voxel belongs to, and beside it.
void BorderTile::find_thin() {
    const int span = span_;
    std::fill(thin_.begin(), thin_.end(), 0.0f);
    any_thin_ = false;
    for (int z = 1; z < span - 1; ++z)
        for (int y = 1; y < span - 1; ++y)
            for (int x = 1; x < span - 1; ++x) {
                const int i = (z * span + y) * span + x;
                const float side = own_[std::size_t(i)] > 0 ? 1.0f : -1.0f, here = side * smooth_[std::size_t(i)];
                if (here >= kept_at) continue;
                float best = here;
                for (int dz = -1; dz <= 1; ++dz)
                    for (int dy = -1; dy <= 1; ++dy)
                        for (int dx = -1; dx <= 1; ++dx) {
                            const int j = i + (dz * span + dy) * span + dx;
                            if (own_[std::size_t(j)] * side > 0) best = std::max(best, side * smooth_[std::size_t(j)]);
                        }
                const float thin = std::max(1 - share(lost_at, kept_at, best), share(wrong_from, wrong_at, -here));
                thin_[std::size_t(i)] = thin;
                any_thin_ = any_thin_ || thin > 0;
            }
}

/// Where a filter has lost what voxels belong to, and beside them, the narrower one's.
void BorderTile::take_narrower() {
    const int span = span_;
    for (int z = 2; z < span - 2; ++z)
        for (int y = 2; y < span - 2; ++y)
            for (int x = 2; x < span - 2; ++x) {
                const int i = (z * span + y) * span + x;
                float thin = 0;
                for (int j = 0; j < 27; ++j)
                    thin =
                        std::max(thin, thin_[std::size_t(i + ((j / 9 - 1) * span + j / 3 % 3 - 1) * span + j % 3 - 1)]);
                float& d = smooth_[std::size_t(i)];
                if (thin > 0) d += thin * (local_[std::size_t(i)] - d);
            }
}

const std::vector<float>& BorderTile::distance(const std::vector<std::uint8_t>& inside) {
    const int span = span_, margin = margin_;
    for (std::size_t i = 0; i < source_.size(); ++i) source_[i] = inside[i] ? 0.5f : -0.5f;
    for (int z = 0, to = 0; z < span; ++z)
        for (int y = 0; y < span; ++y, to += span)
            std::copy_n(
                &source_[std::size_t(((z + halo_ - margin) * row_ + y + halo_ - margin) * row_ + halo_ - margin)], span,
                &own_[std::size_t(to)]);
    smooth(widest_sigma, widths_, smooth_);
    for (const float sigma : narrower_sigmas) {
        find_thin();
        if (!any_thin_) break;
        smooth(sigma, alike, local_);
        take_narrower();
    }
    for (int z = 0, to = 0; z < edge; ++z)
        for (int y = 0; y < edge; ++y)
            for (int x = 0; x < edge; ++x, ++to) {
                const int i = ((z + margin) * span + y + margin) * span + x + margin;
                const float side = own_[std::size_t(i)] > 0 ? 1.0f : -1.0f;
                distance_[std::size_t(to)] = side * std::clamp(side * smooth_[std::size_t(i)], nearest, reach);
            }
    return distance_;
}

}  // namespace chiaro

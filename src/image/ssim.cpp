#include "image/ssim.h"

#include <array>
#include <cmath>
#include <limits>

#include "core/srgb.h"
#include "image/ordered_sum.h"

namespace chiaro {
namespace {

constexpr int taps = 11;
constexpr double sigma = 1.5, c1 = 0.01 * 0.01, c2 = 0.03 * 0.03;  // C = (K L)², for a range L of 1

/// The window is a product of two of these.
std::array<double, taps> gaussian() {
    std::array<double, taps> weights{};
    double sum = 0;
    for (int i = 0; i < taps; ++i) {
        const double x = i - taps / 2;
        sum += weights[i] = std::exp(-x * x / (2 * sigma * sigma));
    }
    for (double& weight : weights) weight /= sum;
    return weights;
}

/// Weighted means of two signals, their squares and their product.
struct WindowMoments {
    double a = 0, b = 0, aa = 0, bb = 0, ab = 0;

    void add(double weight, const WindowMoments& m) {
        a += weight * m.a, b += weight * m.b;
        aa += weight * m.aa, bb += weight * m.bb, ab += weight * m.ab;
    }
    double ssim() const {  // eq. 13
        const double variances = (aa - a * a) + (bb - b * b), covariance = ab - a * b;
        return (2 * a * b + c1) * (2 * covariance + c2) / ((a * a + b * b + c1) * (variances + c2));
    }
};

}  // namespace

double ssim(const Frame& a, const Frame& b) {
    const int columns = a.width - taps + 1, rows = a.height - taps + 1;
    if (columns < 1 || rows < 1) return std::numeric_limits<double>::quiet_NaN();
    const auto window = gaussian();
    const auto sum_of_row = [&](std::int64_t row) {
        std::vector<WindowMoments> column(a.width);  // weighted down the window; then along it
        for (int y = 0; y < taps; ++y)
            for (int x = 0; x < a.width; ++x) {
                const std::size_t pixel = 4 * ((row + y) * a.width + x);
                const double p = luminance(&a.rgba[pixel]), q = luminance(&b.rgba[pixel]);
                column[x].add(window[y], {p, q, p * p, q * q, p * q});
            }
        double sum = 0;
        for (int x = 0; x < columns; ++x) {
            WindowMoments moments;
            for (int i = 0; i < taps; ++i) moments.add(window[i], column[x + i]);
            sum += moments.ssim();
        }
        return sum;
    };
    return ordered_sum(rows, sum_of_row) / (double(columns) * rows);
}

}  // namespace chiaro

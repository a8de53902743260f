#include "illumination/probe/reflection_table.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace chiaro {
namespace {

/// ρ(μ) of k = 1: the mean over half vectors drawn by (n·h)^(s + 1), in equal shares, of f (n·l) over their density.
double reflected_of(double shininess, double cosine) {
    constexpr int rings = 96, sectors = 48;
    const double sine = std::sqrt(1 - cosine * cosine);
    double sum = 0;
    for (int i = 0; i < rings; ++i) {
        const double nh = std::pow((i + 0.5) / rings, 1 / (shininess + 2)), across = std::sqrt(1 - nh * nh);
        for (int j = 0; j < sectors; ++j) {
            const double hv = cosine * nh + sine * across * std::cos(std::numbers::pi * (j + 0.5) / sectors);
            const double nl = 2 * hv * nh - cosine;
            if (hv > 0 && nl > 0) sum += nl * hv / nh;
        }
    }
    return 8 / (shininess + 2) * sum / (rings * sectors);
}

}  // namespace

ReflectionTable::ReflectionTable(double strength, double shininess) : shininess_(shininess) {
    reflected_.assign(steps + 1, 0);
    if (!(strength > 0)) return;
    std::vector<double> of_one;
    for (int i = 0; i <= steps; ++i) of_one.push_back(reflected_of(shininess, double(i) / steps));
    strength_ = std::min(strength, most / *std::max_element(of_one.begin(), of_one.end()));
    double mean = 0;  // of what is interpolated, over 2 μ dμ
    for (int i = 0; i <= steps; ++i) {
        reflected_[std::size_t(i)] = float(strength_ * of_one[std::size_t(i)]);
        if (i == 0) continue;
        const double low = strength_ * of_one[std::size_t(i) - 1], high = strength_ * of_one[std::size_t(i)];
        mean += ((3 * i - 2) * low + (3 * i - 1) * high) / (3.0 * steps * steps);
    }
    matte_ = 1 / (1 - mean);
}

}  // namespace chiaro

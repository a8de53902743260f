#include "pathtrace/light_table.h"

#include <algorithm>
#include <bit>

#include "illumination/probe/data.h"
#include "illumination/probe/light.h"
#include "volume/float3.h"

namespace chiaro {
namespace {

constexpr std::int64_t max_bins = 1 << 21;

/// Vose's way: places with less than their share are filled up by those with more.
void make_alias(const double* weights, int count, float* threshold, float* alias) {
    double sum = 0;
    for (int i = 0; i < count; ++i) sum += weights[i];
    std::vector<double> share(count, 1.0);
    std::vector<int> poor, rich;
    for (int i = 0; i < count; ++i) {
        if (sum > 0) share[i] = weights[i] / sum * count;
        (share[i] < 1 ? poor : rich).push_back(i);
    }
    for (int i = 0; i < count; ++i) threshold[i] = 1, alias[i] = std::bit_cast<float>(i);
    while (!poor.empty() && !rich.empty()) {
        const int low = poor.back(), high = rich.back();
        poor.pop_back();
        threshold[low] = float(share[low]);
        alias[low] = std::bit_cast<float>(high);
        share[high] -= 1 - share[low];
        if (share[high] < 1) rich.pop_back(), poor.push_back(high);
    }
}

bool is_even(std::span<const float> rgb) {
    for (std::size_t i = 3; i < rgb.size(); ++i)
        if (rgb[i] != rgb[i - 3]) return false;
    return true;
}

}  // namespace

LightTable::LightTable(const Lighting& lighting, Vec3 orbit_up)
    : lighting_(lighting), up_(orbit_up), probe_(lighting_probe(lighting)), even_(is_even(probe_.rgb())) {
    if (!even_) make_bins();
}

void LightTable::make_bins() {
    const ProbeImage& image = probe_.data().image;
    int edge = 1;
    while (std::int64_t(image.width) * image.height > max_bins * edge * edge) edge *= 2;
    bins_x_ = (image.width + edge - 1) / edge, bins_y_ = (image.height + edge - 1) / edge;
    // Bins of equal size that cover the picture: a pixel's light may lie in two, so each takes the pixels it touches.
    const std::size_t bins = std::size_t(bins_x_) * bins_y_;
    std::vector<double> light(bins), rows(bins_y_);
    for (int y = 0; y < bins_y_; ++y) {
        cosines_.push_back(float(std::cos(std::numbers::pi * y / bins_y_)));
        for (int x = 0; x < bins_x_; ++x) {
            const auto span = [](int bin, int count, int n) {
                return std::pair(int(std::int64_t(bin) * n / count),
                                 int((std::int64_t(bin + 1) * n + count - 1) / count));
            };
            const auto [left, right] = span(x, bins_x_, image.width);
            const auto [top, bottom] = span(y, bins_y_, image.height);
            double& sum = light[std::size_t(y) * bins_x_ + x];
            for (int j = top; j < bottom; ++j)
                for (int i = left; i < right; ++i)
                    for (int c = 0; c < 3; ++c)
                        sum += luminance_weights[c] * image.rgb[3 * (std::size_t(j) * image.width + i) + c];
        }
    }
    cosines_.push_back(-1);
    column_threshold_.resize(bins), column_alias_.resize(bins), densities_.resize(bins);
    row_threshold_.resize(bins_y_), row_alias_.resize(bins_y_);
    double all = 0;
    const auto solid_angle = [&](int y) {
        return 2 * std::numbers::pi / bins_x_ * (double(cosines_[y]) - double(cosines_[y + 1]));
    };
    for (int y = 0; y < bins_y_; ++y) {
        const double* row = &light[std::size_t(y) * bins_x_];
        for (int x = 0; x < bins_x_; ++x) rows[y] += row[x] * solid_angle(y);
        all += rows[y];
        make_alias(row, bins_x_, &column_threshold_[std::size_t(y) * bins_x_],
                   &column_alias_[std::size_t(y) * bins_x_]);
    }
    make_alias(rows.data(), bins_y_, row_threshold_.data(), row_alias_.data());
    for (std::size_t b = 0; b < bins; ++b) densities_[b] = float(light[b] / all);
}

void LightTable::add_to(HostArrays& arrays) const {
    arrays.add(probe_.data().weak_from_this(), probe_.data().image.rgb);
    for (const auto* numbers :
         {&row_threshold_, &row_alias_, &column_threshold_, &column_alias_, &cosines_, &densities_})
        arrays.add(*numbers);
}

kernel::ProbeLightView LightTable::view() const {
    const ProbeImage& image = probe_.data().image;
    const float gain = float(probe_gain(lighting_));
    const Axes axes = world_from_probe(lighting_.probe.rotation_deg, up_);
    return {.even = even_,
            .radiance = {gain * image.rgb[0], gain * image.rgb[1], gain * image.rgb[2]},
            .rgb = image.rgb.data(),
            .width = image.width,
            .height = image.height,
            .gain = gain,
            .bins_x = bins_x_,
            .bins_y = bins_y_,
            .rows = {row_threshold_.data(), row_alias_.data()},
            .columns = {column_threshold_.data(), column_alias_.data()},
            .cosines = cosines_.data(),
            .densities = densities_.data(),
            .axis_x = float3(axes[0]),
            .axis_y = float3(axes[1]),
            .axis_z = float3(axes[2])};
}

}  // namespace chiaro

#include "illumination/probe/importance.h"

#include <algorithm>

#include "illumination/probe/data.h"

namespace chiaro {
namespace {

/// Running sums of `weights`, the last one 1; even shares where all are 0. Returns the sum before that.
double accumulate(const double* weights, int count, double* sums) {
    double sum = 0;
    for (int i = 0; i < count; ++i) sums[i] = sum += weights[i];
    for (int i = 0; i < count; ++i) sums[i] = sum > 0 ? sums[i] / sum : double(i + 1) / count;
    sums[count - 1] = 1;
    return sum;
}

/// The first sum above u, and how far u has come into it, in [0, 1).
std::pair<int, double> find(const double* sums, int count, double u) {
    const int i = int(std::min<std::ptrdiff_t>(std::upper_bound(sums, sums + count, u) - sums, count - 1));
    const double before = i ? sums[i - 1] : 0;
    return {i, std::clamp((u - before) / (sums[i] - before), 0.0, 1 - 1e-12)};
}

}  // namespace

ImportanceTable::ImportanceTable(const ProbePicture& picture)
    : picture_(picture), rows_(picture.height), columns_(std::size_t(picture.width) * picture.height) {
    std::vector<double> row(picture.width), weights(picture.height);
    const float* pixel = picture.rgb.data();
    for (int y = 0; y < picture.height; ++y) {
        for (double& luminance : row) {
            luminance = 0;
            for (int c = 0; c < 3; ++c) luminance += luminance_weights[c] * *pixel++;
        }
        double* columns = columns_.data() + std::size_t(y) * picture.width;
        weights[y] = picture.solid_angle(y) * accumulate(row.data(), picture.width, columns);
    }
    const bool black = std::all_of(weights.begin(), weights.end(), [](double w) { return w == 0; });
    for (int y = 0; y < picture.height && black; ++y) weights[y] = picture.solid_angle(y);
    accumulate(weights.data(), picture.height, rows_.data());
}

double ImportanceTable::density_in(int x, int y) const {
    const double* columns = columns_.data() + std::size_t(y) * picture_.width;
    const double share = (rows_[y] - (y ? rows_[y - 1] : 0)) * (columns[x] - (x ? columns[x - 1] : 0));
    return share / picture_.solid_angle(y);
}

ImportanceTable::Sample ImportanceTable::sample(double u1, double u2) const {
    const auto [y, down] = find(rows_.data(), picture_.height, u1);
    const auto [x, along] = find(columns_.data() + std::size_t(y) * picture_.width, picture_.width, u2);
    const double top = std::cos(picture_.polar_angle(y)), bottom = std::cos(picture_.polar_angle(y + 1));
    const double z = top + down * (bottom - top), r = std::sqrt(std::max(0.0, 1 - z * z));
    const double phi = picture_.azimuth(x + along);
    return {{r * std::cos(phi), r * std::sin(phi), z}, density_in(x, y)};
}

double ImportanceTable::density(Vec3 direction) const {
    const auto [x, y] = picture_.place(direction);
    return density_in(std::min(int(x), picture_.width - 1), std::min(int(y), picture_.height - 1));
}

}  // namespace chiaro

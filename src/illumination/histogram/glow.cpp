#include "illumination/histogram/glow.h"

#include <chiaro/error.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <optional>
#include <sstream>

namespace chiaro {
namespace {

std::optional<double> number(const std::string& text) {
    std::istringstream in(text);
    double value = 0;
    return in >> value && in.eof() && std::isfinite(value) ? std::optional(value) : std::nullopt;
}

}  // namespace

GlowMapping::GlowMapping(const std::string& text) {
    const std::string who = "glow '" + text + "'";
    const auto colon = text.find(':'), equals = text.find('=', colon == text.npos ? 0 : colon);
    if (colon != text.npos && equals != text.npos) {
        const auto low = number(text.substr(0, colon)), high = number(text.substr(colon + 1, equals - colon - 1)),
                   strength = number(text.substr(equals + 1));
        if (!low || !high || !strength || *low > *high)
            throw Error(ErrorCode::usage, who + ": expected LO:HI=STRENGTH, LO not above HI");
        add(*low, *strength, who), add(*high, *strength, who);
        return;
    }
    std::ifstream file(text);
    if (!file) throw Error(ErrorCode::input, who + ": is neither LO:HI=STRENGTH nor a file that can be read");
    int count = 0;
    for (std::string line; std::getline(file, line);) {
        ++count;
        std::istringstream words(line.substr(0, line.find('#')));
        std::string value, strength, rest;
        if (!(words >> value)) continue;
        words >> strength >> rest;
        const auto v = number(value), s = number(strength);
        if (!v || !s || !rest.empty())
            throw Error(ErrorCode::input, who + ", line " + std::to_string(count) + ": expected VALUE STRENGTH");
        add(*v, *s, who);
    }
    if (points_.empty()) throw Error(ErrorCode::input, who + ": has no line VALUE STRENGTH");
}

void GlowMapping::add(double value, double strength, const std::string& who) {
    if (strength < 1 || strength > 1e6)
        throw Error(ErrorCode::usage, who + ": strength must be 1 (does not glow) to 1000000");
    if (!points_.empty() && value < points_.back().first) throw Error(ErrorCode::input, who + ": values must not fall");
    points_.emplace_back(value, strength);
}

double GlowMapping::at(double value) const {
    if (points_.empty() || value < points_.front().first || value > points_.back().first) return 1;
    const auto next = std::lower_bound(points_.begin(), points_.end(), value,
                                       [](const auto& point, double v) { return point.first < v; });
    if (next == points_.begin() || next->first == value) return next->second;
    const auto before = std::prev(next);
    const double t = (value - before->first) / (next->first - before->first);
    return before->second + t * (next->second - before->second);
}

std::vector<kernel::Rgba> glow_of_words(const Device& device, const LocalHistograms& h, BinOptics optics,
                                        HistogramModel model) {
    const float highest = *std::max_element(optics.glow.begin(), optics.glow.end());
    for (std::size_t j = 0; j < optics.alpha.size(); ++j)
        optics.alpha[j] *= (optics.glow[j] - 1) / std::max(highest - 1, 1e-6f);
    optics.glow.clear();
    std::vector<kernel::Rgba> words;
    for (const auto& [r, g, b, sum] : word_sums(device, h, optics)) {
        const float share = std::min(sum, 0.999f);
        const float edge = model == HistogramModel::paper ? share : -std::expm1(std::log1p(-share) / float(h.radius));
        const float scale = sum > 0 ? edge / sum : 0;
        words.push_back({scale * r, scale * g, scale * b, edge});
    }
    return words;
}

std::vector<std::uint8_t> glowing_occupancy(const Medium::Data& medium, const LocalHistograms& h,
                                            const BinOptics& optics) {
    const DeviceVolume::Data& volume = medium.volume.data();
    CellRanges ranges = volume.cells;
    const auto [nx, ny, nz] = ranges.count;
    std::vector<int> before(optics.alpha.size() + 1, 0);  // bins that glow
    for (std::size_t j = 0; j < optics.alpha.size(); ++j)
        before[j + 1] = before[j] + (optics.alpha[j] > 0 && optics.glow[j] > 1);
    const double reach_mm = (h.radius + 2) * h.grid.edge_mm;
    std::array<int, 3> reach;
    for (int axis = 0; axis < 3; ++axis)
        reach[axis] = int(std::ceil(reach_mm / (volume.geometry.spacing_mm[axis] * cell_edge))) + 1;
    constexpr float lit = std::numeric_limits<float>::quiet_NaN();
    for (int z = 0; z < nz; ++z)
        for (int y = 0; y < ny; ++y)
            for (int x = 0; x < nx; ++x) {
                const std::size_t cell = (std::size_t(z) * ny + std::size_t(y)) * nx + std::size_t(x);
                if (before[h.binning.bin_of(volume.cells.high[cell]) + 1u] ==
                    before[h.binning.bin_of(volume.cells.low[cell])])
                    continue;
                for (int k = std::max(z - reach[2], 0); k <= std::min(z + reach[2], nz - 1); ++k)
                    for (int j = std::max(y - reach[1], 0); j <= std::min(y + reach[1], ny - 1); ++j) {
                        const auto row = ranges.low.begin() + (std::ptrdiff_t(k) * ny + j) * nx;
                        std::fill(row + std::max(x - reach[0], 0), row + std::min(x + reach[0], nx - 1) + 1, lit);
                    }
            }
    const RangeTest visible = visible_range(medium.table);
    double occupied = 0;
    return make_occupancy(
        ranges, [&](float low, float high) { return std::isnan(low) || visible(low, high); }, volume.device.threads,
        occupied);
}

}  // namespace chiaro

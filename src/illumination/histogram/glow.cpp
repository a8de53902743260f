#include "illumination/histogram/glow.h"

#include <chiaro/error.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <optional>
#include <sstream>

#include "core/threads.h"
#include "volume/occupancy.h"

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
        if (const std::string fault = fault_of(*low, *strength); !fault.empty())
            throw Error(ErrorCode::usage, who + ": " + fault);
        points_ = {{*low, *strength}, {*high, *strength}};
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
        const std::string fault = v && s && rest.empty() ? fault_of(*v, *s) : "expected VALUE STRENGTH";
        if (!fault.empty()) throw Error(ErrorCode::input, who + ", line " + std::to_string(count) + ": " + fault);
        points_.emplace_back(*v, *s);
    }
    if (points_.empty()) throw Error(ErrorCode::input, who + ": has no line VALUE STRENGTH");
}

std::string GlowMapping::fault_of(double value, double strength) const {
    if (strength < 1 || strength > 1e6) return "strength must be 1 (does not glow) to 1000000";
    return points_.empty() || value >= points_.back().first ? "" : "values must not fall";
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

namespace {

/// Cubes of nodes, of which one holds a word that glows.
class GlowingNodes {
public:
    GlowingNodes(const Device& device, const LocalHistograms& h, const kernel::HistogramView& view) {
        for (int axis = 0; axis < 3; ++axis) count_[axis] = (h.nodes[axis] - 1) / edge + 1;
        std::vector<std::uint8_t> glows;
        for (int word = 0; word < h.words; ++word) glows.push_back(view.glow_words[word].a > 0);
        glows_.resize(std::size_t(count_[0]) * count_[1] * count_[2]);
        const auto* pairs = reinterpret_cast<const WordPair*>(view.identifiers);
        const auto [nx, ny, nz] = h.nodes;
        parallel_for(device.threads, count_[2], 1, [&, nx = nx, ny = ny, nz = nz](std::int64_t k, std::int64_t) {
            for (int z = int(k) * edge; z < std::min((int(k) + 1) * edge, nz); ++z)
                for (int y = 0; y < ny; ++y) {
                    const WordPair* row = pairs + (std::size_t(z) * ny + y) * nx;
                    std::uint8_t* to = glows_.data() + (std::size_t(k) * count_[1] + y / edge) * count_[0];
                    for (int x = 0; x < nx; ++x) to[x / edge] |= glows[row[x].forward] | glows[row[x].backward];
                }
        });
    }

    /// Whether one may glow among the nodes that samples at voxel coordinates [low, low + cell_edge] read.
    bool any(const kernel::GridView& grid, const std::array<int, 3>& low) const {
        std::array<int, 3> first, last;
        const float scale[] = {grid.nodes_per_voxel.x, grid.nodes_per_voxel.y, grid.nodes_per_voxel.z};
        const float shift[] = {grid.shift.x, grid.shift.y, grid.shift.z};
        for (int a = 0; a < 3; ++a) {
            const double from = double(low[a]) * scale[a] + shift[a], to = from + double(cell_edge) * scale[a];
            first[a] = std::clamp(int(std::floor(from - 1e-3)) / edge, 0, count_[a] - 1);
            last[a] = std::clamp((int(std::floor(to + 1e-3)) + 1) / edge, 0, count_[a] - 1);
        }
        for (int z = first[2]; z <= last[2]; ++z)
            for (int y = first[1]; y <= last[1]; ++y)
                for (int x = first[0]; x <= last[0]; ++x)
                    if (glows_[(std::size_t(z) * count_[1] + y) * count_[0] + x]) return true;
        return false;
    }

private:
    static constexpr int edge = 4;
    std::array<int, 3> count_;
    std::vector<std::uint8_t> glows_;
};

}  // namespace

std::vector<std::uint8_t> glowing_occupancy(const Device& device, const Medium::Data& medium, const LocalHistograms& h,
                                            const kernel::HistogramView& view) {
    const DeviceVolume::Data& volume = medium.volume.data();
    CellRanges ranges = volume.cells;
    const GlowingNodes nodes(device, h, view);
    constexpr float lit = std::numeric_limits<float>::quiet_NaN();
    const auto [nx, ny, nz] = ranges.count;
    parallel_for(device.threads, nz, 1, [&, nx = nx, ny = ny](std::int64_t z, std::int64_t) {
        float* low = ranges.low.data() + std::size_t(z) * ny * nx;
        for (int y = 0; y < ny; ++y)
            for (int x = 0; x < nx; ++x, ++low)
                if (nodes.any(view.grid, {x * cell_edge, y * cell_edge, int(z) * cell_edge})) *low = lit;
    });
    const RangeTest visible = visible_range(medium.table);
    double occupied = 0;
    return make_occupancy(
        ranges, [&](float low, float high) { return std::isnan(low) || visible(low, high); }, volume.device.threads,
        occupied);
}

}  // namespace chiaro

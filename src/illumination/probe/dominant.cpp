#include "illumination/probe/dominant.h"

#include <algorithm>

#include "illumination/probe/data.h"
#include "illumination/probe/light.h"
#include "illumination/sh/directions.h"

namespace chiaro {
namespace {

constexpr int cells_x = 128, cells_y = 64;

/// Mean radiance.
double luminance_of(const ProbePiece& piece) {
    double sum = 0;
    for (int c = 0; c < 3; ++c) sum += luminance_weights[c] * piece.light[c];
    return piece.share > 0 ? sum / piece.share : 0;
}

/// What pixels of one cell add up to; the moment is of directions by luminance.
struct ProbeCell {
    ProbePiece sum;
    Vec3 moment;
};

/// Pixels larger than a cell are cut into pieces.
std::vector<ProbeCell> gather(const ProbeImage& image) {
    std::vector<ProbeCell> cells(std::size_t(cells_x) * cells_y);
    const int cut_x = 1 + (cells_x - 1) / image.width, cut_y = 1 + (cells_y - 1) / image.height;
    const int fine_x = cut_x * image.width, fine_y = cut_y * image.height;
    for (int y = 0; y < fine_y; ++y) {
        const double top = image.polar_angle(double(y) / cut_y), bottom = image.polar_angle(double(y + 1) / cut_y);
        const double share = (std::cos(top) - std::cos(bottom)) / (2.0 * fine_x), middle = (top + bottom) / 2;
        const double z = std::cos(middle), r = std::sin(middle);
        ProbeCell* row = cells.data() + std::size_t(y) * cells_y / fine_y * cells_x;
        for (int x = 0; x < fine_x; ++x) {
            const float* pixel = image.rgb.data() + 3 * (std::size_t(y / cut_y) * image.width + x / cut_x);
            auto& [sum, moment] = row[std::int64_t(x) * cells_x / fine_x];
            const double phi = image.azimuth((x + 0.5) / cut_x);
            moment = moment + (share * (1e-6 + luminance(pixel))) * Vec3{r * std::cos(phi), r * std::sin(phi), z};
            for (int c = 0; c < 3; ++c) sum.light[c] += share * pixel[c];
            sum.share += share;
        }
    }
    return cells;
}

/// Two by two.
std::vector<ProbeCell> halved(const std::vector<ProbeCell>& cells) {
    std::vector<ProbeCell> half(cells.size() / 4);
    for (std::size_t i = 0; i < cells.size(); ++i) {
        auto& [sum, moment] = half[i / cells_x / 2 * (cells_x / 2) + i % cells_x / 2];
        moment = moment + cells[i].moment;
        for (int c = 0; c < 3; ++c) sum.light[c] += cells[i].sum.light[c];
        sum.share += cells[i].sum.share;
    }
    return half;
}

std::vector<ProbePiece> pieces_of(const std::vector<ProbeCell>& cells) {
    std::vector<ProbePiece> pieces;
    for (const auto& [sum, moment] : cells)
        if (sum.share != 0) pieces.push_back({normalized(moment), sum.light, sum.share});
    return pieces;
}

std::optional<DominantLight> take_dominant_light(std::vector<ProbePiece>& cells) {
    // A disc of 8° about the brightest piece, above the mean of the ring from 8° to 16° about it, is taken as one light
    // of its own if it is more than a tenth of all light. Pieces are 2.8° wide, so the disc holds some 25 of them. The
    // three numbers are as in the first version; how they were chosen is not recorded.
    constexpr double near = 0.99027, around = 0.96126;  // cos 8°, cos 16°
    const auto dimmer = [](const ProbePiece& a, const ProbePiece& b) { return luminance_of(a) < luminance_of(b); };
    const Vec3 brightest = std::max_element(cells.begin(), cells.end(), dimmer)->direction;
    ProbePiece ring;
    double all = 0, excess = 0;
    for (const ProbePiece& cell : cells) {
        const double cosine = dot(cell.direction, brightest);
        all += cell.share * luminance_of(cell);
        if (cosine >= near || cosine < around) continue;
        ring.share += cell.share;
        for (int c = 0; c < 3; ++c) ring.light[c] += cell.light[c];
    }
    DominantLight dominant{{}, {}};
    std::vector<ProbePiece> rest = cells;
    for (ProbePiece& cell : rest) {
        if (dot(cell.direction, brightest) < near) continue;
        const double more = cell.share * std::max(luminance_of(cell) - luminance_of(ring), 0.0);
        excess += more;
        dominant.direction = dominant.direction + more * cell.direction;
        for (int c = 0; c < 3; ++c) {
            const double kept = std::min(cell.light[c], ring.light[c] / ring.share * cell.share);
            dominant.light[c] += cell.light[c] - kept;
            cell.light[c] = kept;
        }
    }
    if (!(excess > 0.1 * all)) return {};
    dominant.direction = normalized(dominant.direction);
    cells = std::move(rest);
    return dominant;
}

/// Where Σ light max(0, d·ω)^5 is largest: a highlight of the default exponent, (n·h)^20, is that wide about the
/// mirrored eye. Each step of d ~ Σ light max(0, d·ω)^4 ω climbs; from the best of 200 it takes a few to a tenth of a
/// degree.
Vec3 find_shining(const std::vector<ProbePiece>& pieces) {
    const auto climb = [&](Vec3 from) {
        Vec3 sum;
        for (const ProbePiece& piece : pieces) {
            const double cosine = std::max(dot(piece.direction, from), 0.0);
            sum = sum + (piece.share * luminance_of(piece) * std::pow(cosine, 4)) * piece.direction;
        }
        return sum;
    };
    Vec3 best{0, 0, 1};
    double most = 0;
    for (const Vec3 d : fibonacci_directions(200))
        if (const double light = dot(climb(d), d); light > most) most = light, best = d;
    for (int step = 0; step < 30 && most > 0; ++step) best = normalized(climb(best));
    return best;
}

}  // namespace

ProbePieces pieces_of_probe(const Probe::Data& probe) {
    const std::vector<ProbeCell> cells = gather(probe.image);
    ProbePieces pieces{pieces_of(cells), pieces_of(halved(cells)), {}, {}, {}};
    pieces.shining = find_shining(pieces.all);
    pieces.rest = pieces.all;
    pieces.dominant = take_dominant_light(pieces.rest);
    return pieces;
}

Vec3 shining_direction(const Lighting& lighting, Vec3 orbit_up) {
    return turned(world_from_probe(lighting.probe.rotation_deg, orbit_up),
                  lighting_probe(lighting).data().pieces().shining);
}

std::optional<DominantLight> dominant_light(const Lighting& lighting, Vec3 orbit_up, const Geometry& geometry) {
    const Probe probe = lighting_probe(lighting);
    std::optional<DominantLight> found = probe.data().pieces().dominant;
    if (!found) return {};
    found->direction = turned(grid_from_probe(lighting, orbit_up, geometry), found->direction);
    for (double& channel : found->light) channel *= probe_gain(lighting);
    return found;
}

}  // namespace chiaro

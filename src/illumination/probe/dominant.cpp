#include "illumination/probe/dominant.h"

#include <algorithm>
#include <bit>
#include <span>

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

double light_of(const ProbePiece& piece) { return piece.share * luminance_of(piece); }
double light_of(const std::vector<ProbePiece>& pieces) {
    double all = 0;
    for (const ProbePiece& piece : pieces) all += light_of(piece);
    return all;
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

/// What lies around a place, between two angles' cosines.
ProbePiece ring_around(const std::vector<ProbePiece>& pieces, Vec3 middle, double near, double around) {
    ProbePiece ring;
    for (const ProbePiece& piece : pieces) {
        const double cosine = dot(piece.direction, middle);
        if (cosine >= near || cosine < around) continue;
        ring.share += piece.share;
        for (int c = 0; c < 3; ++c) ring.light[c] += piece.light[c];
    }
    return ring;
}

/// Leaves of a piece what the ring is at most, channel by channel, and returns the rest.
ProbePiece take_excess(ProbePiece& piece, const ProbePiece& ring) {
    ProbePiece excess = piece;
    for (int c = 0; c < 3; ++c) {
        piece.light[c] = std::min(piece.light[c], ring.light[c] / ring.share * piece.share);
        excess.light[c] -= piece.light[c];
    }
    return excess;
}

std::optional<DominantLight> take_dominant_light(std::vector<ProbePiece>& cells) {
    // A disc of 8° about the brightest piece, above the mean of the ring from 8° to 16° about it, is taken as one light
    // of its own if it is more than a tenth of all light, and twice as bright as the ring: a corner of a wide lamp is
    // not. Pieces are 2.8° wide, so the disc holds some 25 of them. The first three numbers are as in the first
    // version; how they were chosen is not recorded.
    constexpr double near = 0.99027, around = 0.96126;  // cos 8°, cos 16°
    const auto dimmer = [](const ProbePiece& a, const ProbePiece& b) { return luminance_of(a) < luminance_of(b); };
    const Vec3 brightest = std::max_element(cells.begin(), cells.end(), dimmer)->direction;
    const ProbePiece ring = ring_around(cells, brightest, near, around);
    double excess = 0;
    DominantLight dominant{{}, {}};
    ProbePiece disc;
    std::vector<ProbePiece> rest = cells;
    for (ProbePiece& cell : rest) {
        if (dot(cell.direction, brightest) < near) continue;
        const double more = cell.share * std::max(luminance_of(cell) - luminance_of(ring), 0.0);
        excess += more;
        dominant.direction = dominant.direction + more * cell.direction;
        disc.share += cell.share;
        for (int c = 0; c < 3; ++c) disc.light[c] += cell.light[c];
        const ProbePiece taken = take_excess(cell, ring);
        for (int c = 0; c < 3; ++c) dominant.light[c] += taken.light[c];
    }
    if (!(excess > 0.1 * light_of(cells) && luminance_of(disc) > 2 * luminance_of(ring))) return {};
    dominant.direction = normalized(dominant.direction);
    cells = std::move(rest);
    return dominant;
}

/// Cut in two of the same light, where it is widest, `cuts` times (Debevec 2005, "A Median Cut Algorithm for Light
/// Probe Sampling"); a single piece becomes two halves.
void cut_by_median(std::span<ProbePiece> pieces, int cuts, std::vector<std::vector<ProbePiece>>& parts) {
    if (cuts == 0) {
        parts.emplace_back(pieces.begin(), pieces.end());
        return;
    }
    if (pieces.size() == 1) {
        ProbePiece half = pieces[0];
        for (double& channel : half.light) channel /= 2;
        half.share /= 2;
        for (int i = 0; i < 2; ++i) cut_by_median({&half, 1}, cuts - 1, parts);
        return;
    }
    double all = 0;
    Vec3 sum, squares;
    for (const ProbePiece& piece : pieces) {
        all += light_of(piece), sum = sum + light_of(piece) * piece.direction;
        for (int axis = 0; axis < 3; ++axis)
            squares[axis] += light_of(piece) * piece.direction[axis] * piece.direction[axis];
    }
    int widest = 0;
    const auto spread = [&](int axis) { return squares[axis] - sum[axis] * sum[axis] / all; };
    for (int axis = 1; axis < 3; ++axis)
        if (spread(axis) > spread(widest)) widest = axis;
    std::stable_sort(pieces.begin(), pieces.end(), [&](const ProbePiece& a, const ProbePiece& b) {
        return a.direction[widest] < b.direction[widest];
    });
    std::size_t first = 0;
    double below = 0;
    while (first + 1 < pieces.size() && (first == 0 || below + light_of(pieces[first]) / 2 < all / 2))
        below += light_of(pieces[first++]);
    cut_by_median(pieces.first(first), cuts - 1, parts);
    cut_by_median(pieces.subspan(first), cuts - 1, parts);
}

DominantLight together(const std::vector<ProbePiece>& pieces) {
    DominantLight sum{{}, {}};
    for (const ProbePiece& piece : pieces) {
        sum.direction = sum.direction + light_of(piece) * piece.direction;
        for (int c = 0; c < 3; ++c) sum.light[c] += piece.light[c];
    }
    sum.direction = normalized(sum.direction);
    return sum;
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

/// The excess within 30° of a place over what lies around, if it is more than a seventh of all light: a studio's soft
/// box. Taken out of `pieces`.
Lamp take_lamp(std::vector<ProbePiece>& pieces, Vec3 middle, double all) {
    constexpr double near = 0.86603, around = 0.76604;  // cos 30°, cos 40°
    const ProbePiece ring = ring_around(pieces, middle, near, around);
    std::vector<ProbePiece> lit, rest = pieces;
    double excess = 0;
    for (ProbePiece& left : rest) {
        if (dot(left.direction, middle) < near) continue;
        const ProbePiece taken = take_excess(left, ring);
        if (!(luminance_of(taken) > 0)) continue;
        excess += light_of(taken);
        lit.push_back(taken);
    }
    if (!(excess > all / 7)) return {};
    pieces = std::move(rest);
    Lamp lamp;
    std::vector<std::vector<ProbePiece>> parts;
    cut_by_median(lit, std::countr_zero(unsigned(lamp_parts)), parts);
    for (std::vector<ProbePiece>& part : parts) {
        std::vector<std::vector<ProbePiece>> rays;
        ShadowedLight& shadowed = lamp.emplace_back(ShadowedLight{together(part), {}});
        cut_by_median(part, std::countr_zero(unsigned(rays_per_part)), rays);
        for (const auto& ray : rays) shadowed.rays.push_back(together(ray).direction);
    }
    return lamp;
}

/// `shining`: that of the pieces.
std::vector<Lamp> find_lamps(std::vector<ProbePiece> pieces, Vec3 shining) {
    const double all = light_of(pieces);
    std::vector<Lamp> lamps;
    while (lamps.size() < max_lamps) {
        Lamp lamp = take_lamp(pieces, lamps.empty() ? shining : find_shining(pieces), all);
        if (lamp.empty()) break;
        lamps.push_back(std::move(lamp));
    }
    return lamps;
}

}  // namespace

ProbePieces pieces_of_probe(const Probe::Data& probe) {
    const std::vector<ProbeCell> cells = gather(probe.image);
    ProbePieces pieces{pieces_of(cells), pieces_of(halved(cells)), {}, {}, {}, {}};
    pieces.shining = find_shining(pieces.all);
    pieces.rest = pieces.all;
    pieces.dominant = take_dominant_light(pieces.rest);
    if (const auto& sun = pieces.dominant)
        pieces.lamps = {{{*sun, {sun->direction}}}};
    else
        pieces.lamps = find_lamps(pieces.all, pieces.shining);
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

std::vector<Lamp> lamps_of(const Lighting& lighting, Vec3 orbit_up, const Geometry& geometry) {
    const Probe probe = lighting_probe(lighting);
    const double gain = probe_gain(lighting);
    const Axes turn = grid_from_probe(lighting, orbit_up, geometry);
    std::vector<Lamp> lamps = probe.data().pieces().lamps;
    for (Lamp& lamp : lamps)
        for (auto& [light, rays] : lamp) {
            light.direction = turned(turn, light.direction);
            for (double& channel : light.light) channel *= gain;
            for (Vec3& ray : rays) ray = turned(turn, ray);
        }
    return lamps;
}

}  // namespace chiaro

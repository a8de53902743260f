#include "illumination/transport/incident.h"

#include <algorithm>

#include "illumination/probe/data.h"
#include "illumination/probe/light.h"

namespace chiaro {
namespace {

constexpr int cells_x = 128, cells_y = 64;

/// A piece of the probe's sphere.
struct Piece {
    Vec3 direction;                 ///< unit, grid axes
    std::array<double, 3> light{};  ///< ∫ L dω / 4π
    double share = 0;               ///< of the sphere

    double luminance() const {  ///< mean radiance
        double sum = 0;
        for (int c = 0; c < 3; ++c) sum += luminance_weights[c] * light[c];
        return share > 0 ? sum / share : 0;
    }
};

/// Pixels larger than a cell are cut into pieces.
std::vector<Piece> gather(const ProbeImage& image, const Axes& grid_from_probe, double gain) {
    std::vector<Piece> cells(std::size_t(cells_x) * cells_y);
    std::vector<Vec3> moments(cells.size());
    const int cut_x = 1 + (cells_x - 1) / image.width, cut_y = 1 + (cells_y - 1) / image.height;
    const int fine_x = cut_x * image.width, fine_y = cut_y * image.height;
    for (int y = 0; y < fine_y; ++y) {
        const double top = image.polar_angle(double(y) / cut_y), bottom = image.polar_angle(double(y + 1) / cut_y);
        const double share = (std::cos(top) - std::cos(bottom)) / (2.0 * fine_x), middle = (top + bottom) / 2;
        const double z = std::cos(middle), r = std::sin(middle);
        Piece* row = cells.data() + std::size_t(y) * cells_y / fine_y * cells_x;
        for (int x = 0; x < fine_x; ++x) {
            const float* pixel = image.rgb.data() + 3 * (std::size_t(y / cut_y) * image.width + x / cut_x);
            Piece& cell = row[std::int64_t(x) * cells_x / fine_x];
            const double phi = image.azimuth((x + 0.5) / cut_x);
            Vec3& moment = moments[std::size_t(&cell - cells.data())];
            moment = moment + (share * (1e-6 + luminance(pixel))) * Vec3{r * std::cos(phi), r * std::sin(phi), z};
            for (int c = 0; c < 3; ++c) cell.light[c] += gain * share * pixel[c];
            cell.share += share;
        }
    }
    for (std::size_t i = 0; i < cells.size(); ++i) cells[i].direction = turned(grid_from_probe, normalized(moments[i]));
    std::erase_if(cells, [](const Piece& cell) { return cell.share == 0; });
    return cells;
}

std::optional<DominantLight> take_dominant_light(std::vector<Piece>& cells) {
    // A disc of 8° about the brightest piece, above the mean of the ring from 8° to 16° about it, is taken as one light
    // of its own if it is more than a tenth of all light. Pieces are 2.8° wide, so the disc holds some 25 of them. The
    // three numbers are as in the first version; how they were chosen is not recorded.
    constexpr double near = 0.99027, around = 0.96126;  // cos 8°, cos 16°
    const auto dimmer = [](const Piece& a, const Piece& b) { return a.luminance() < b.luminance(); };
    const Vec3 brightest = std::max_element(cells.begin(), cells.end(), dimmer)->direction;
    Piece ring;
    double all = 0, excess = 0;
    for (const Piece& cell : cells) {
        const double cosine = dot(cell.direction, brightest);
        all += cell.share * cell.luminance();
        if (cosine >= near || cosine < around) continue;
        ring.share += cell.share;
        for (int c = 0; c < 3; ++c) ring.light[c] += cell.light[c];
    }
    DominantLight dominant{{}, {}};
    std::vector<Piece> rest = cells;
    for (Piece& cell : rest) {
        if (dot(cell.direction, brightest) < near) continue;
        const double more = cell.share * std::max(cell.luminance() - ring.luminance(), 0.0);
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

}  // namespace

IncidentLight incident_light(const Lighting& lighting, Vec3 orbit_up, const Geometry& geometry,
                             const std::vector<Vec3>& directions) {
    const Probe probe = lighting_probe(lighting);
    const Axes turn = composed(grid_from_world(geometry), world_from_probe(lighting.probe.rotation_deg, orbit_up));
    std::vector<Piece> cells = gather(probe.data().image, turn, probe_gain(lighting));
    IncidentLight incident{std::vector<IncidentRay>(directions.size()), take_dominant_light(cells)};
    for (const Piece& cell : cells) {
        std::size_t nearest = 0;
        double best = -2;
        for (std::size_t i = 0; i < directions.size(); ++i)
            if (const double cosine = dot(directions[i], cell.direction); cosine > best) best = cosine, nearest = i;
        incident.rays[nearest].share += cell.share;
        for (int c = 0; c < 3; ++c) incident.rays[nearest].light[c] += cell.light[c];
    }
    return incident;
}

}  // namespace chiaro

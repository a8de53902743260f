// Sums over the probe's pieces, each given to the nearest direction.
#include "illumination/transport/incident.h"

#include "illumination/probe/data.h"
#include "illumination/probe/light.h"

namespace chiaro {

IncidentLight incident_light(const Lighting& lighting, Vec3 orbit_up, const Geometry& geometry,
                             const std::vector<Vec3>& directions) {
    const Axes turn = grid_from_probe(lighting, orbit_up, geometry);
    const double gain = probe_gain(lighting);
    const Probe probe = lighting_probe(lighting);
    IncidentLight incident{std::vector<IncidentRay>(directions.size()), dominant_light(lighting, orbit_up, geometry)};
    for (const ProbePiece& piece : probe.data().pieces().rest) {
        const Vec3 from = turned(turn, piece.direction);
        std::size_t nearest = 0;
        double best = -2;
        for (std::size_t i = 0; i < directions.size(); ++i)
            if (const double cosine = dot(directions[i], from); cosine > best) best = cosine, nearest = i;
        incident.rays[nearest].share += piece.share;
        for (int c = 0; c < 3; ++c) incident.rays[nearest].light[c] += gain * piece.light[c];
    }
    return incident;
}

}  // namespace chiaro

// What stands out in a probe as a light with shadows of its own: a sun, or a lamp.
#pragma once
#include <chiaro/lighting.h>

#include <array>
#include <optional>
#include <vector>

namespace chiaro {

/// A piece of the probe's sphere, some 3° wide.
struct ProbePiece {
    Vec3 direction;                 ///< unit
    std::array<double, 3> light{};  ///< ∫ L dω / 4π
    double share = 0;               ///< of the sphere
};

struct DominantLight {
    Vec3 direction;               ///< unit, towards it
    std::array<double, 3> light;  ///< ∫ L dω / 4π

    bool operator==(const DominantLight&) const = default;
};

/// A light whose shadow is found along rays of its own: a sun, or a part of a lamp. Rays count alike.
struct ShadowedLight {
    DominantLight light;
    std::vector<Vec3> rays;  ///< unit, towards it
};
/// A sun, or the parts of a lamp wider than that.
using Lamp = std::vector<ShadowedLight>;
inline constexpr int max_lamps = 2, lamp_parts = 4, rays_per_part = 8;

/// A probe in pieces, in its own frame, as it was loaded. Kept by Probe::Data::pieces.
struct ProbePieces {
    std::vector<ProbePiece> all;
    std::vector<ProbePiece> coarse;  ///< some 6° wide
    /// The brightest place where the excess within 8° over what lies around makes up a tenth of all light.
    std::optional<DominantLight> dominant;
    std::vector<ProbePiece> rest;  ///< all without it
    std::vector<Lamp> lamps;       ///< the dominant light alone; where there is none, what stands out most
    Vec3 shining;                  ///< unit: from where a wide highlight shows most light
};

/// Cost: a look at each pixel.
ProbePieces pieces_of_probe(const Probe::Data& probe);

/// `shining` as `lighting` turns it, world.
Vec3 shining_direction(const Lighting& lighting, Vec3 orbit_up);

/// The dominant light as `lighting` turns and exposes it, grid axes; none of most probes.
std::optional<DominantLight> dominant_light(const Lighting& lighting, Vec3 orbit_up, const Geometry& geometry);
/// ProbePieces::lamps, at most `max_lamps`, turned and exposed likewise.
std::vector<Lamp> lamps_of(const Lighting& lighting, Vec3 orbit_up, const Geometry& geometry);

}  // namespace chiaro

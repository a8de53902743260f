// The light on the floor under a medium, kept as a picture of it.
#pragma once
#include <chiaro/device.h>
#include <chiaro/lighting.h>

#include <memory>
#include <mutex>
#include <vector>

#include "illumination/floor/floor.h"
#include "illumination/visibility/density.h"

namespace chiaro {

struct TransportNodes;

/// What shines on the floor, and whether the subject's shadow falls there.
enum class FloorShadow {
    none,   ///< even light, no shadow
    white,  ///< even light: ambient occlusion
    probe   ///< the probe's
};

/// How well it is found.
struct FloorQuality {
    int edge = 256;  ///< points a side of the map: as many as pixels of a small picture's floor
    int rays = 256;  ///< drawn by their light: 9° apart over an even sky, .3° in a lamp 5° wide
    bool operator==(const FloorQuality&) const = default;
};
inline constexpr FloorQuality coarse_floor{128, 64};

/// What is asked for.
struct FloorQuestion {
    FloorShadow shadow = FloorShadow::none;
    FloorQuality quality;
    const TransportNodes* scattered = nullptr;  ///< light that matter has scattered; null: none is known
    bool operator==(const FloorQuestion&) const = default;
};

/// E/π over the floor, `edge` points a side from -FloorView::end to +end radii along u (fastest) and v.
struct LitFloor {
    kernel::FloorView view;
    int edge = 0;
    std::vector<float> light;  ///< three channels, one after the other
};

/// Of one medium. What was found last is kept: a turned camera costs nothing.
class FloorLight {
public:
    /// Null where nothing is visible. Cost of the first: the density of 128 nodes along the longest side; of every
    /// other light rays × points × the nodes that a ray passes, some .1 core-s (coarse: 6 ms). Throws
    /// Error{interrupted}.
    std::shared_ptr<const LitFloor> light(const Device& device, const Medium::Data& medium, const Lighting& lighting,
                                          Vec3 up, const FloorQuestion& question, Progress& progress) const;

private:
    struct Inputs {
        Probe probe;
        double rotation_deg, exposure_stops, strength;
        Vec3 up;
        FloorQuestion question;
        bool operator==(const Inputs&) const = default;
    };
    mutable std::mutex mutex_;
    mutable std::shared_ptr<const Density> density_;
    mutable std::optional<std::pair<Vec3, std::optional<Floor>>> floor_;  ///< of an up
    mutable std::optional<Inputs> of_;
    mutable std::shared_ptr<const LitFloor> kept_;
};

}  // namespace chiaro

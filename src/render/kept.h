// What a session keeps of its stages.
#pragma once
#include <chiaro/render.h>

#include <cstdint>
#include <optional>
#include <tuple>

namespace chiaro {

using Version = std::uint64_t;

/// Of the light all around, what a field may hold: how bright it is is a factor.
struct HeldLight {
    Probe probe;
    double rotation_deg = 0;
    Vec3 up;
    FloorSettings floor;
    bool operator==(const HeldLight&) const = default;
};
inline HeldLight held_light(const Lighting& lighting, const IlluminationSettings& settings) {
    if (!holds_light(settings)) return {};
    return {lighting.loaded_probe, lighting.probe.rotation_deg, *lighting.probe_up, lighting.floor};
}

/// A stage's result, kept with the inputs that made it.
template <class Result, class... Inputs>
struct Kept {
    Result result;
    std::optional<std::tuple<Inputs...>> inputs;
    Version version = 0;  ///< names the result among the inputs of the stages to its right
};

struct Classified {
    TransferFunction tf;
    Medium medium;
};

struct Cast {
    DeviceFrame frame;
    RenderStatistics render_statistics;
};

}  // namespace chiaro

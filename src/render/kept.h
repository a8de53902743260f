// What a session keeps of its stages.
#pragma once
#include <chiaro/render.h>

#include <cstdint>
#include <optional>
#include <tuple>

#include "illumination/probe/lights.h"

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

/// What the loaded probe was made from.
inline std::tuple<std::string, std::vector<Light>> probe_inputs(const Lighting& lighting) {
    const bool is_of_lights = lighting.probe.source == lights_probe;
    return {lighting.probe.source, is_of_lights ? lighting.lights : std::vector<Light>()};
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

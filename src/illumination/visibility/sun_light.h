// A sun's light on a surface: its own share of each node, by straight rays, for sixteen harmonics blur its shadow.
#pragma once
#include "kernel/math.h"
#include "kernel/vec.h"

namespace chiaro::kernel {

struct SunLight {
    const std::uint8_t* nodes = nullptr;  ///< transmittance towards it × 255; nullptr: there is no sun
    Float3 direction{0, 0, 0};            ///< unit, towards it, in the axes of the grid
    Float3 light{0, 0, 0};                ///< E of a surface that faces it

    /// Share of its light between eight nodes; without a sun 0.
    CHIARO_INLINE float arriving(const std::int64_t (&of)[8], const float (&weights)[8]) const {
        float sum = 0;
        if (nodes)
            for (int i = 0; i < 8; ++i) sum = mad(weights[i], float(nodes[of[i]]), sum);
        return sum / 255;
    }
    /// E is added to the three channels: what arrives × `shown`, and `clear` of all of it; to `open` all of it.
    CHIARO_INLINE void add_to(float* e, float* open, float arriving, const float (&normal)[3], float shown,
                              float clear) const {
        const float cosine = normal[0] * direction.x + normal[1] * direction.y + normal[2] * direction.z;
        if (cosine <= 0) return;
        const float of_light = cosine * mad(arriving, shown, clear);
        e[0] = mad(of_light, light.x, e[0]), e[1] = mad(of_light, light.y, e[1]), e[2] = mad(of_light, light.z, e[2]);
        open[0] = mad(cosine, light.x, open[0]), open[1] = mad(cosine, light.y, open[1]);
        open[2] = mad(cosine, light.z, open[2]);
    }
};

}  // namespace chiaro::kernel

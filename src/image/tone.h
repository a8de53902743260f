// The film curve.
#pragma once
#include <algorithm>

#include "kernel/lanes.h"

namespace chiaro {

/// Linear light to linear light in [0, 1]: the rational fit to the ACES reference rendering by Narkowicz 2015, "ACES
/// Filmic Tone Mapping Curve", y = x (2.51 x + 0.03) / (x (2.43 x + 0.59) + 0.14), clamped. Its peak is 1.03, and it is
/// below 0 only for negative light, so what is outside [0, 10] is as good as its ends.
CHIARO_INLINE float aces(float x) {
    const float light = std::clamp(x, 0.0f, 10.0f);  // NaN stays
    return std::min(light * (2.51f * light + 0.03f) / (light * (2.43f * light + 0.59f) + 0.14f), 1.0f);
}

}  // namespace chiaro

// Where two surfaces are nearer to each other than V is read off one of them.
#pragma once
#include "kernel/row.h"

namespace chiaro::kernel {

/// V is read past matter there, or in it: then it is read nearer, of nodes by the air in them. The constants are tuned
/// on tests/live_geometry_test.cpp; of a free surface nothing changes, since half of everything is seen off it.
struct CrowdedNodes {
    const float* depth = nullptr;  ///< of each node's edge; nullptr: V is read at one distance everywhere
    float lift_edges = 0;          ///< V is read so far off a surface

    /// 0: where V is read is nothing but air; 1: other matter is there. `seen`: the mean of V there.
    CHIARO_INLINE float share(float seen, const std::int64_t (&nodes)[8], const float (&weights)[8]) const {
        if (!depth || seen >= max_seen) return 0;
        float around = 0;
        for (int i = 0; i < 8; ++i) around = mad(weights[i], depth[nodes[i]], around);
        return min(around * 20, 1.0f) * min((max_seen - seen) * 20, 1.0f);
    }
    /// Each sixth of an optical depth takes a node's weight to 1/e. They still add up to 1.
    template <class Sixteen>
    CHIARO_INLINE void weigh_by_air(const std::int64_t (&of)[8], float (&weights)[8]) const {
        float numbers[16] = {};
        for (int i = 0; i < 8; ++i) numbers[i] = depth[of[i]];
        const Sixteen air = exp2(Sixteen(-6 * 1.442695f) * min(loaded<Sixteen>(numbers), Sixteen(4.0f)));
        store(air, numbers);
        float sum = 0;
        for (int i = 0; i < 8; ++i) sum += weights[i] *= numbers[i];
        for (int i = 0; i < 8; ++i) weights[i] /= sum;
    }

private:
    static constexpr float max_seen = 0.47f;  ///< a free surface's softest edges leave .48
};

}  // namespace chiaro::kernel

// Light on the faces of opaque cells, and what they send back of it. Numbers of a face: RGB, and what it weighs.
#pragma once
#include "kernel/lanes.h"

namespace chiaro::kernel {

inline constexpr std::int32_t face_floats = 4, cell_floats = 6 * face_floats;

/// Faces by which a ray towards an octant leaves a cell behind: those that look the other way.
CHIARO_INLINE std::int32_t face_left(std::int32_t octant, std::int32_t axis) {
    return 2 * axis + !(octant >> axis & 1);
}

/// An octant in which a cell looks like those in front of it.
struct OpaqueCover {
    std::int32_t id, octant, in_front[3], count;
};

/// Mean radiance of what arrived on a face from all groups of directions, added in their order.
struct FaceKernel {
    const float* arriving;  ///< [group][cell][face][4]
    std::int64_t group;     ///< numbers of a group
    std::int32_t groups;
    const float* first;  ///< of uncollided light, to be added to; nullptr: this is it
    float* faces;
    float* mean;  ///< running; nullptr: none
    float share;  ///< in the running mean

    CHIARO_INLINE void operator()(std::int64_t face) const {
        const std::int64_t at = face * face_floats;
        float sum[face_floats]{};
        for (std::int32_t g = 0; g < groups; ++g)
            for (std::int32_t c = 0; c < face_floats; ++c) sum[c] += arriving[g * group + at + c];
        for (std::int32_t c = 0; c < 3; ++c) {
            const float found = sum[3] > 0 ? sum[c] / sum[3] : 0, light = first ? first[at + c] + found : found;
            faces[at + c] = light;
            if (mean) mean[at + c] += share * (light - mean[at + c]);
        }
    }
};

/// What each cell sends back of the light on its faces, as a ray towards an octant finds it.
struct ReflectKernel {
    static constexpr std::int32_t octants = 8;
    const std::uint8_t* open;  ///< [cell]: its faces in the open
    const float* reflectance;  ///< [cell][3]
    const float* faces;
    std::int64_t listed;
    float* emission;  ///< [octant][listed][4]

    CHIARO_INLINE void operator()(std::int64_t i) const {
        const std::int64_t cell = i / octants;
        const std::int32_t octant = std::int32_t(i % octants);
        float count = 0, sum[3]{};
        for (std::int32_t axis = 0; axis < 3; ++axis) {
            const std::int32_t face = face_left(octant, axis);
            if (!(open[cell] >> face & 1)) continue;
            count += 1;
            for (std::int32_t c = 0; c < 3; ++c) sum[c] += faces[cell * cell_floats + face * face_floats + c];
        }
        float* to = emission + (octant * listed + cell) * face_floats;
        for (std::int32_t c = 0; c < 3 && count > 0; ++c) to[c] = reflectance[3 * cell + c] * (sum[c] / count);
    }
};

/// After that: covers look at cells that are none in their octant.
struct CoverKernel {
    const OpaqueCover* covers;
    std::int64_t listed;
    float* emission;

    CHIARO_INLINE void operator()(std::int64_t i) const {
        const OpaqueCover& cover = covers[i];
        float* seen = emission + cover.octant * listed * face_floats;
        for (std::int32_t c = 0; c < 3; ++c) {
            float sum = 0;
            for (std::int32_t front = 0; front < cover.count; ++front)
                sum += seen[std::int64_t(cover.in_front[front]) * face_floats + c];
            seen[std::int64_t(cover.id) * face_floats + c] = sum / float(cover.count);
        }
    }
};

}  // namespace chiaro::kernel

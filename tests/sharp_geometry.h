// Soft-edged surfaces in a volume, and the white light on them by sharp geometry: no volume in the truth but for a
// layer's optical depth.
#pragma once
#include <random>

#include "surface_subject.h"

namespace chiaro::testing {

/// What of the light from all sides reaches a place, by directions drawn with its cosine.
template <class Sees>
inline double share_seen(Vec3 normal, Vec3 along, const Sees& sees) {
    std::mt19937 random(2);
    std::uniform_real_distribution<double> uniform;
    const Vec3 across = cross(normal, along);
    constexpr int count = 40000;
    int seen = 0;
    for (int i = 0; i < count; ++i) {
        const double z = std::sqrt(uniform(random)), phi = 2 * pi * uniform(random), r = std::sqrt(1 - z * z);
        seen += sees(z * normal + r * std::cos(phi) * along + r * std::sin(phi) * across);
    }
    return double(seen) / count;
}

/// Whether the way from p along w leaves the volume before it has gone `t` on.
inline bool leaves_before(Vec3 p, Vec3 w, double t) {
    for (int axis = 0; axis < 3; ++axis) {
        const double at = p[axis] + t * w[axis];
        if (at < 0 || at > n - 1) return true;
    }
    return false;
}

struct SharpScene {
    Volume volume;
    Look look;
    double truth;  ///< share of the light that arrives there
};

/// A plate leaves the floor under it what comes in from the sides; of one voxel it is not opaque.
inline SharpScene under_plate(double edge, double thick, double gap, double noise = 0) {
    const Vec3 floor{31.7, 31.9, 20.3};
    return {volume_of(
                [&](Vec3 p) {
                    const double z = p.z - floor.z, plate = std::abs(z - gap - thick / 2) - thick / 2;
                    return logistic(std::min(z, plate), edge);
                },
                noise),
            {floor + Vec3{0, 0, gap / 2}, {0, 0, 1}, {1, 0, 0}, 6},
            share_seen({0, 0, 1}, {1, 0, 0}, [&](Vec3 w) { return leaves_before(floor, w, gap / w.z); })};
}

/// A slot 16 deep.
inline SharpScene bottom_of_slot(double edge, double wide, double noise = 0) {
    constexpr double deep = 16;
    const Vec3 floor{31.7, 31.9, 40.3};
    return {volume_of(
                [&](Vec3 p) {
                    const double block = p.z - floor.z - deep,
                                 slot = std::max(std::abs(p.x - floor.x) - wide / 2, floor.z - p.z);  // < 0 within
                    return logistic(std::max(block, -slot), edge);
                },
                noise),
            {floor + Vec3{0, 0, deep / 2}, {0, 0, 1}, {1, 0, 0}, std::min(wide / 8, 0.25)},
            share_seen({0, 0, 1}, {1, 0, 0}, [&](Vec3 w) {
                const double t = deep / w.z;
                return std::abs(t * w.x) < wide / 2 || leaves_before(floor, w, wide / 2 / std::abs(w.x));
            })};
}

/// The optical depth straight up through a volume: edges make a layer denser than a sharp one of its opacity.
inline double depth_through(const Volume& volume) {
    const auto voxels = volume.as<std::uint8_t>();
    double depth = 0;
    constexpr double step = 0.01;
    for (double z = 0; z < n - 1; z += step) {
        const int i = int(z);
        const auto at = [&](int k) { return double(voxels[(std::size_t(k) * n + 32) * n + 32]); };
        const double value = at(i) + (z - i) * (at(i + 1) - at(i));
        depth -= step * std::log1p(-std::min(value / 200, 1.0) * 0.95);
    }
    return depth;
}

/// A translucent layer, two voxels thick, over a floor; to be shown by skin(0, 200).
inline SharpScene under_layer(double edge, double opacity, double gap) {
    const Vec3 floor{31.7, 31.9, 20.3};
    const auto layer = [&](Vec3 p) {
        return logistic(std::abs(p.z - floor.z - gap - 1) - 1, edge, opacity / 0.95 * 200);
    };
    const double depth = depth_through(volume_of(layer));
    std::mt19937 random(3);
    std::uniform_real_distribution<double> uniform;
    return {volume_of([&](Vec3 p) { return std::max(logistic(p.z - floor.z, edge), layer(p)); }),
            {floor + Vec3{0, 0, std::min(gap / 2, 1.5)}, {0, 0, 1}, {1, 0, 0}, 6},
            share_seen({0, 0, 1}, {1, 0, 0}, [&](Vec3 w) {
                double through = 1;  // of the layer, before the border
                while (through > 0 && leaves_before(floor, w, (gap + 2 * through) / w.z)) through -= 0.02;
                return uniform(random) < std::exp(-std::max(through, 0.0) * depth / w.z);
            })};
}

/// Air between two walls, that goes on to the volume's border.
struct Wedge {
    Vec3 crease = normalized(Vec3{0.2, 0.9, 0.3}), n1, n2, along;

    explicit Wedge(double degrees) {
        const double half = degrees / 360 * pi;
        const Vec3 up = normalized(cross(crease, Vec3{1, 0, 0})), side = cross(crease, up);
        n1 = std::cos(half) * side + std::sin(half) * up, n2 = -std::cos(half) * side + std::sin(half) * up;
        along = cross(crease, n1);
        if (dot(along, up) < 0) along = -1.0 * along;
    }
    Volume volume(double edge, double noise) const {
        return volume_of([&](Vec3 p) { return logistic(std::min(dot(p - centre, n1), dot(p - centre, n2)), edge); },
                         noise);
    }
    double truth(double from_crease) const {
        const Vec3 p = centre + from_crease * along;
        return share_seen(n1, along, [&](Vec3 w) {
            const double down = dot(w, n2);
            return down >= 0 || leaves_before(p, w, -dot(p - centre, n2) / down);
        });
    }
};

}  // namespace chiaro::testing

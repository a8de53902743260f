// Volumes of several values a voxel, taken apart, and volumes brought onto another's grid.
#include <chiaro/error.h>
#include <chiaro/volume.h>

#include <algorithm>
#include <cmath>
#include <thread>

#include "core/threads.h"

namespace chiaro {
namespace {

Volume header_of(const Volume& volume) {
    Volume one = make_volume(volume.dimensions, volume.type);
    one.slope = volume.slope, one.intercept = volume.intercept, one.geometry = volume.geometry;
    one.source = volume.source, one.format = volume.format, one.modality = volume.modality;
    one.moments = volume.moments, one.key_values = volume.key_values;
    one.has_own_colors = volume.has_own_colors;
    return one;
}

/// Out of each voxel's values, of type T, one.
template <class T, class Value>
void fill_by(const Volume& volume, Value&& value, Volume& one) {
    const T* from = volume.as<T>().data();
    for (T& to : one.as<T>()) to = value(from), from += volume.components;
}

/// ITU-R BT.709's weights; grey stays exactly what it is.
template <class T>
T luminance(const T* rgb) {
    if (rgb[0] == rgb[1] && rgb[1] == rgb[2]) return rgb[0];
    const double y = 0.2126 * double(rgb[0]) + 0.7152 * double(rgb[1]) + 0.0722 * double(rgb[2]);
    return T(std::is_integral_v<T> ? std::nearbyint(y) : y);
}

/// Alpha, or luminance where there is none that says anything.
template <class T>
void fill_opacity(const Volume& volume, Volume& opacity) {
    const auto all = volume.as<T>();
    bool varies = false;
    if (volume.components == 4)
        for (std::size_t i = 3; i < all.size() && !varies; i += 4) varies = all[i] != all[3];
    opacity.component_infos = {{varies ? "alpha" : "luminance", {}}};
    if (volume.components == 4 && !varies)
        opacity.notes.push_back("its alpha is the same everywhere: opacity is found by luminance");
    fill_by<T>(
        volume, [varies](const T* v) { return varies ? v[3] : luminance(v); }, opacity);
}

/// The values of a volume between its voxels, in index space; outside it the least.
template <class T>
struct Interpolated {
    const Volume& volume;
    double outside;

    double at(Vec3 p) const {
        const auto& n = volume.dimensions;
        std::array<int, 3> low{};
        Vec3 t;
        for (int a = 0; a < 3; ++a) {
            if (!(p[a] >= -0.5) || p[a] > n[std::size_t(a)] - 0.5) return outside;
            const double c = std::clamp(p[a], 0.0, double(n[std::size_t(a)] - 1));
            low[std::size_t(a)] = std::min(int(c), std::max(n[std::size_t(a)] - 2, 0));
            t[a] = c - low[std::size_t(a)];
        }
        double sum = 0;
        for (int corner = 0; corner < 8; ++corner) {
            std::array<int, 3> i = low;
            double weight = 1;
            for (int a = 0; a < 3; ++a) {
                const bool upper = corner >> a & 1;
                weight *= upper ? t[a] : 1 - t[a];
                if (upper) i[std::size_t(a)] = std::min(i[std::size_t(a)] + 1, n[std::size_t(a)] - 1);
            }
            if (weight > 0) sum += weight * double(volume.as<T>()[(std::size_t(i[2]) * n[1] + i[1]) * n[0] + i[0]]);
        }
        return sum;
    }
};

template <class T>
void fill_from(const Volume& volume, int threads, Volume& out) {
    const auto voxels = volume.as<T>();
    T least = std::numeric_limits<T>::max();
    for (const T v : voxels)
        if (v < least) least = v;  // not for NaN
    const Interpolated<T> values{volume, double(least)};
    const auto [nx, ny, nz] = out.dimensions;
    const Geometry own = volume.geometry.in_frame(out.geometry.world);
    parallel_for(threads, std::int64_t(ny) * nz, 16, [&, nx = nx, ny = ny](std::int64_t first, std::int64_t end) {
        for (auto row = first; row < end; ++row)
            for (int x = 0; x < nx; ++x) {
                const Vec3 world = out.geometry.world_from_voxel({double(x), double(row % ny), double(row / ny)});
                const double value = values.at(own.voxel_from_world(world));
                out.as<T>()[std::size_t(row) * nx + x] = T(std::is_integral_v<T> ? std::nearbyint(value) : value);
            }
    });
}

}  // namespace

std::vector<Volume> components_of(const Volume& volume) {
    const bool colors = volume.has_own_colors;
    if (colors && volume.components != 3 && volume.components != 4)
        throw Error(ErrorCode::input, volume.source + " has " + std::to_string(volume.components) +
                                          " values a voxel, where colours are three or four");
    std::vector<Volume> all;
    with_voxel_type(volume.type, [&](auto voxel) {
        using T = decltype(voxel);
        if (colors) fill_opacity<T>(volume, all.emplace_back(header_of(volume)));
        for (int c = 0; c < (colors ? 3 : volume.components); ++c) {
            Volume& one = all.emplace_back(header_of(volume));
            if (!volume.component_infos.empty()) one.component_infos = {volume.component_infos[std::size_t(c)]};
            fill_by<T>(
                volume, [c](const T* values) { return values[c]; }, one);
        }
    });
    all.front().notes.insert(all.front().notes.begin(), volume.notes.begin(), volume.notes.end());
    return all;
}

bool has_grid_of(const Volume& volume, const Volume& other) {
    if (volume.dimensions != other.dimensions) return false;
    const Geometry own = volume.geometry.in_frame(other.geometry.world);
    const Vec3 last{double(other.dimensions[0] - 1), double(other.dimensions[1] - 1), double(other.dimensions[2] - 1)};
    const double near_mm = 0.01 * other.geometry.smallest_spacing_mm();
    for (int corner = 0; corner < 8; ++corner) {
        Vec3 p;
        for (int a = 0; a < 3; ++a) p[a] = corner >> a & 1 ? last[a] : 0;
        if (length(own.world_from_voxel(p) - other.geometry.world_from_voxel(p)) > near_mm) return false;
    }
    return true;
}

Volume resampled(const Volume& volume, const Volume& onto) {
    Volume out = header_of(volume);
    out.dimensions = onto.dimensions, out.geometry = onto.geometry;
    out.voxels = VoxelBuffer(out.voxel_count() * size_of(out.type));
    out.notes = volume.notes, out.component_infos = volume.component_infos;
    with_voxel_type(volume.type, [&](auto voxel) {
        fill_from<decltype(voxel)>(volume, int(std::max(1u, std::thread::hardware_concurrency())), out);
    });
    return out;
}

}  // namespace chiaro

#include "memory_budget.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <type_traits>

#include "io/memory.h"
#include "volume/bricks.h"

namespace chiaro::server {
namespace {

constexpr int smallest_side = 64;  // below which nothing is gained

/// A mean as the type holds it.
template <class T>
T stored(double mean) {
    if constexpr (std::is_integral_v<T>)
        return T(std::floor(mean + 0.5));
    else
        return T(mean);
}

template <class T>
void average(const Volume& from, Volume& to) {
    const auto source = from.as<T>();
    const auto [nx, ny, nz] = from.dimensions;
    T* out = to.as<T>().data();
    const int parts = from.components;
    for (int z = 0; z < nz; z += 2)
        for (int y = 0; y < ny; y += 2)
            for (int x = 0; x < nx; x += 2)
                for (int part = 0; part < parts; ++part) {
                    double sum = 0;
                    int count = 0;
                    for (int k = z; k < std::min(z + 2, nz); ++k)
                        for (int j = y; j < std::min(y + 2, ny); ++j)
                            for (int i = x; i < std::min(x + 2, nx); ++i, ++count)
                                sum += double(source[((std::size_t(k) * ny + j) * nx + i) * parts + part]);
                    *out++ = stored<T>(sum / count);
                }
}

/// Bricks beside the voxels that were read, the coefficients of their spline, and the light of the default method.
double needed_beyond(const Volume& volume) {
    return 2 * brick_bytes(volume) + light_bytes({.method = Method::spao}, double(volume.voxel_count()));
}

constexpr double transport_cell_bytes = 55 * sizeof(float);  ///< of a light grid's cell (src/illumination/transport)

}  // namespace

double brick_bytes(const Volume& volume) {
    double bytes = brick_voxels * double(std::min(size_of(volume.type), sizeof(float)));
    for (const int n : volume.dimensions) bytes *= brick_count(n);
    return bytes;
}

OutOfMemory::OutOfMemory(double needed, double free)
    : Error(ErrorCode::output, fmt::format("Needs {:.1f} GB, {:.1f} GB are free.", needed / 1e9, free / 1e9)) {}

double free_memory() {
    const double free = double(available_memory());
    const char* limit = std::getenv("CHIARO_VIEW_MEMORY");
    return limit ? std::min(free, std::atof(limit) * (1 << 20)) : free;
}

void check_memory(double needed) {
    if (const double free = free_memory(); needed > free) throw OutOfMemory(needed, free);
}

double light_bytes(const IlluminationSettings& settings, double cells) {
    switch (settings.method) {
        case Method::spao:  // opacity, accessibility, what is lifted: 2 bytes each
            return 6 * cells;
        case Method::visibility: {  // the same opacity; harmonics and light of the nodes
            const VisibilitySettings& v = settings.visibility;
            const double bytes = v.storage == ShStorage::u8 ? 1 : v.storage == ShStorage::f16 ? 2 : 4;
            return 2 * cells + cells / std::pow(v.subsample, 3) * (v.bands * v.bands * bytes + 8);
        }
        case Method::histogram:  // identifiers, and sums over them while they are found
            return 2 * cells + 16 * cells / std::pow(settings.histogram.subsample, 3);
        case Method::reference:
            return is_path_traced(settings) ? cells / 16 : 8 * cells;
        case Method::transport:  // opacity, from which the light grid is made; no grid is finer than the volume
            return 2 * cells + transport_cell_bytes * std::min(cells, std::pow(settings.transport.grid, 3));
        default:
            return 0;
    }
}

Volume halved(const Volume& volume) {
    std::array<int, 3> size = volume.dimensions;
    Vec3 first, spacing = volume.geometry.spacing_mm;
    for (int axis = 0; axis < 3; ++axis) {
        if (size[axis] == 1) continue;
        size[axis] = (size[axis] + 1) / 2;
        first[axis] = 0.5, spacing[axis] *= 2;
    }
    Volume half = make_volume(size, volume.type);
    half.components = volume.components, half.slope = volume.slope, half.intercept = volume.intercept;
    half.source = volume.source, half.format = volume.format, half.modality = volume.modality;
    half.notes = volume.notes, half.key_values = volume.key_values;
    half.voxels = VoxelBuffer(half.voxel_count() * std::size_t(half.components) * size_of(half.type));
    half.geometry = volume.geometry;
    half.geometry.origin_mm = volume.geometry.world_from_voxel(first);
    half.geometry.spacing_mm = spacing;
    with_voxel_type(volume.type, [&](auto zero) { average<decltype(zero)>(volume, half); });
    return half;
}

Fitted fit(Volume& volume, int least) {
    Fitted fitted{volume.dimensions, volume.dimensions, free_memory()};
    const auto is_small = [&] { return std::ranges::max(volume.dimensions) <= smallest_side; };
    for (int times = 0; !is_small() && (times < least || needed_beyond(volume) > free_memory()); ++times)
        volume = halved(volume);
    fitted.to = volume.dimensions;
    return fitted;
}

}  // namespace chiaro::server

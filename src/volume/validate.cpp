#include "volume/validate.h"

#include <chiaro/error.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace chiaro {
namespace {

bool finite(const Vec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

std::string text_of(const Vec3& v) { return fmt::format("({}, {}, {})", v.x, v.y, v.z); }

[[noreturn]] void refuse(const std::string& sentence) { throw Error(ErrorCode::input, sentence); }

}  // namespace

std::uint64_t checked_bytes(const std::array<std::int64_t, 3>& dimensions, std::int64_t components, VoxelType type) {
    for (const auto n : dimensions)
        if (n < 1 || n > 65535)
            refuse(fmt::format("states {} x {} x {} voxels, but every dimension must be in 1..65535", dimensions[0],
                               dimensions[1], dimensions[2]));
    if (components < 1 || components > 65535)
        refuse(fmt::format("states {} values per voxel, not 1..65535", components));
    std::uint64_t bytes = size_of(type) * std::uint64_t(components);
    for (const auto n : dimensions)
        if (__builtin_mul_overflow(bytes, std::uint64_t(n), &bytes))
            refuse("states more voxels than can be counted in 64 bits");
    return bytes;
}

std::uint64_t check_header(const Volume& volume) {
    check_geometry(volume.geometry);
    if (!std::isfinite(volume.slope) || !std::isfinite(volume.intercept))
        refuse(fmt::format("states the slope {} and the intercept {}, which are not both finite", volume.slope,
                           volume.intercept));
    const auto& n = volume.dimensions;
    return checked_bytes({n[0], n[1], n[2]}, volume.components, volume.type);
}

void check_geometry(const Geometry& geometry) {
    const Vec3& spacing = geometry.spacing_mm;
    if (!finite(geometry.origin_mm)) refuse("has an origin " + text_of(geometry.origin_mm) + " that is not finite");
    if (!finite(spacing) || !(spacing.x > 0 && spacing.y > 0 && spacing.z > 0))
        refuse("has a spacing " + text_of(spacing) + " that is not positive");
    const auto [least, most] = std::minmax({spacing.x, spacing.y, spacing.z});
    if (least < 1e-12 || most > 1e12 || most > 1e6 * least)
        refuse("has a spacing " + text_of(spacing) + " mm beyond 1e-12..1e12 mm or the ratio 1e6 between its axes");
    for (const Vec3& axis : geometry.direction)
        if (!finite(axis) || std::abs(length(axis) - 1) > 1e-3)
            refuse("has a direction " + text_of(axis) + " that is not a unit vector");
    const auto& [a, b, c] = geometry.direction;
    if (std::abs(dot(a, cross(b, c))) < 1e-6) refuse("has singular directions: its three axes lie in one plane");
}

void check_values(const Volume& volume, double min, double max) {
    if (!std::isfinite(min) || !std::isfinite(max))
        refuse(fmt::format("{}: the slope {} and the intercept {} make values of its voxels that are not finite",
                           volume.source.empty() ? "the volume" : volume.source, volume.slope, volume.intercept));
}

void set_steps(Geometry& geometry, const std::array<Vec3, 3>& steps_mm) {
    for (int axis = 0; axis < 3; ++axis) {
        const double step = length(steps_mm[axis]);
        if (!std::isfinite(step) || !(step > 0))
            refuse(fmt::format("has a step {} along axis {} that is not a direction", text_of(steps_mm[axis]), axis));
        geometry.spacing_mm[axis] = step;
        geometry.direction[axis] = (1 / step) * steps_mm[axis];
    }
    check_geometry(geometry);
}

}  // namespace chiaro

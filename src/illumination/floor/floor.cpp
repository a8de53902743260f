#include "illumination/floor/floor.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "classify/clip.h"
#include "illumination/probe/data.h"
#include "illumination/probe/light.h"
#include "volume/device_view.h"
#include "volume/float3.h"

namespace chiaro {
namespace {

constexpr double visible_opacity = 0.1, faint_opacity = 0.01;  // over the length that opacities belong to

/// Opacity of a stored value: 1 within an isosurface.
class Opacity {
public:
    explicit Opacity(const Medium::Data& medium) : table_(medium.table) {
        if (medium.shape.mode != Mode::iso) return;
        const DeviceVolume::Data& volume = medium.volume.data();
        const auto by_value = [](const IsoSurface& a, const IsoSurface& b) { return a.value < b.value; };
        const auto& surfaces = medium.shape.iso;
        iso_ = (std::min_element(surfaces.begin(), surfaces.end(), by_value)->value - volume.offset) / volume.scale;
        upwards_ = volume.scale > 0;
    }
    /// `factor`: of the extinction.
    double operator()(float stored, float factor) const {
        if (iso_) return (upwards_ ? stored >= *iso_ : stored <= *iso_) ? 1 : 0;
        return -std::expm1(-double(table_.at(stored).extinction_per_mm) * double(factor) * table_.unit_mm);
    }

private:
    const OpticalTable& table_;
    std::optional<double> iso_;
    bool upwards_ = true;
};

/// An occupied cell, and the lowest point of its box.
struct Cell {
    std::array<int, 3> first;  ///< voxel
    double lowest_mm;
};

/// The occupied cells, the lowest first, and all that they take up across `up`.
class OccupiedCells {
public:
    OccupiedCells(const Medium::Data& medium, const Axes& axes) : geometry_(medium.volume.geometry()), axes_(axes) {
        const auto& n = medium.volume.data().dimensions;
        const auto& count = medium.volume.data().cells.count;
        for (int z = 0; z < count[2]; ++z)
            for (int y = 0; y < count[1]; ++y)
                for (int x = 0; x < count[0]; ++x)
                    if (medium.cells[(std::size_t(z) * count[1] + y) * count[0] + x] & 1)
                        add({x * cell_edge, y * cell_edge, z * cell_edge}, n);
        std::stable_sort(all_.begin(), all_.end(),
                         [](const Cell& a, const Cell& b) { return a.lowest_mm < b.lowest_mm; });
    }
    const std::vector<Cell>& all() const { return all_; }
    Vec3 middle() const { return 0.5 * (low_ + high_); }  ///< along the axes, mm
    double radius_mm() const { return 0.5 * std::hypot(high_.x - low_.x, high_.y - low_.y); }

private:
    void add(const std::array<int, 3>& first, const std::array<int, 3>& n) {
        double lowest = 1e300;
        for (int corner = 0; corner < 8; ++corner) {
            Vec3 p;
            for (int a = 0; a < 3; ++a) p[a] = std::min(first[a] + (corner >> a & 1 ? cell_edge : 0), n[a] - 1);
            const Vec3 world = geometry_.world_from_voxel(p);
            for (int a = 0; a < 3; ++a) {
                const double along = dot(axes_[a], world);
                low_[a] = std::min(low_[a], along), high_[a] = std::max(high_[a], along);
            }
            lowest = std::min(lowest, dot(axes_[2], world));
        }
        all_.push_back({first, lowest});
    }

    const Geometry& geometry_;
    const Axes& axes_;
    std::vector<Cell> all_;
    Vec3 low_{1e300, 1e300, 1e300}, high_{-1e300, -1e300, -1e300};
};

/// Height of the lowest voxel that has so much opacity, and of what goes on below it; infinite where there is none.
template <class Voxel>
double lowest_voxel(const Medium::Data& medium, Vec3 up, const std::vector<Cell>& cells, double least_opacity) {
    const DeviceVolume::Data& volume = medium.volume.data();
    const kernel::VolumeView<Voxel> view = view_of<Voxel>(volume);
    const std::vector<HalfSpace> kept = half_spaces(medium.shape.clip, volume.geometry, volume.dimensions);
    const auto is_clipped = [&](Vec3 p) {
        return std::any_of(kept.begin(), kept.end(), [&](const HalfSpace& k) { return dot(k.normal, p) > k.d; });
    };
    const auto is_in_box = [&](Vec3 p) {
        for (int a = 0; a < 3; ++a)
            if (p[a] < 0 || p[a] > volume.dimensions[std::size_t(a)] - 1) return false;
        return true;
    };
    const Opacity opacity(medium);
    const auto is_visible = [&](Vec3 p) {
        const kernel::Vec3<float> point = view.clamp(kernel::Vec3<float>{float(p.x), float(p.y), float(p.z)});
        const auto at = view.locate(point, view.voxel(point));
        if (view.is_mixed())
            return !is_clipped(p) && -std::expm1(-view.matter_at(at).a * medium.table.unit_mm) >= least_opacity;
        const float value = view.value(at);
        return !is_clipped(p) && opacity(value, view.has_factor() ? view.factor_at(at, value) : 1) >= least_opacity;
    };
    constexpr int steps = 8;  // of a voxel, down which what is visible goes on
    const double voxel_mm = volume.geometry.smallest_spacing_mm();
    const Vec3 down = volume.geometry.voxel_from_world_vector(-voxel_mm / steps * up);
    const auto depth_below = [&](Vec3 p) {
        int k = 0;
        while (k < steps && is_in_box(p + down) && is_visible(p + down)) p = p + down, ++k;
        return k * voxel_mm / steps;
    };
    double lowest = INFINITY;
    for (const Cell& cell : cells) {
        if (cell.lowest_mm >= lowest + voxel_mm) break;
        constexpr int edge = cell_edge + 1;
        for (int i = 0; i < edge * edge * edge; ++i) {
            Vec3 p;
            for (int a = 0, in = i; a < 3; ++a, in /= edge) p[a] = cell.first[std::size_t(a)] + in % edge;
            const double height = dot(up, volume.geometry.world_from_voxel(p));
            if (height < lowest + voxel_mm && is_in_box(p) && is_visible(p))
                lowest = std::min(lowest, height - depth_below(p));
        }
    }
    return lowest;
}

}  // namespace

Axes Floor::axes(Vec3 up) {
    const Vec3 u = orbit_direction(0, 0, up);
    return {u, cross(normalized(up), u), normalized(up)};
}

Vec3 Floor::point(double u, double v) const {
    const Axes along = axes(up);
    return centre + radius_mm * u * along[0] + radius_mm * v * along[1];
}

std::optional<Floor> find_floor(const Medium::Data& medium, Vec3 up) {
    const Axes axes = Floor::axes(up);
    const OccupiedCells cells(medium, axes);
    for (const double least : {visible_opacity, faint_opacity, 1e-6}) {
        const double height = with_stored_voxel(medium.volume.data(), [&](auto voxel) {
            return lowest_voxel<decltype(voxel)>(medium, axes[2], cells.all(), least);
        });
        if (!std::isfinite(height)) continue;
        const Vec3 middle = cells.middle();
        return Floor{axes[2], height, middle.x * axes[0] + middle.y * axes[1] + height * axes[2],
                     std::max(cells.radius_mm(), medium.volume.geometry().smallest_spacing_mm())};
    }
    return std::nullopt;
}

kernel::FloorView view_of(const Floor& floor, const Geometry& geometry) {
    const auto [u, v, up] = Floor::axes(floor.up);
    // Of a linear function of the world, mm: its change per voxel, and its value at voxel (0, 0, 0).
    const auto per_voxel = [&](Vec3 axis, double scale) {
        Vec3 change;
        for (int a = 0; a < 3; ++a) {
            Vec3 step{0, 0, 0};
            step[a] = 1;
            change[a] = scale * dot(axis, geometry.world_from_voxel_vector(step));
        }
        return float3(change);
    };
    const Vec3 first = geometry.origin_mm - floor.centre;
    const double per_mm = 1 / floor.radius_mm;
    return {.on = true,
            .rise = per_voxel(floor.up, 1),
            .rise_0 = float(dot(floor.up, first)),
            .along_u = per_voxel(u, per_mm),
            .along_v = per_voxel(v, per_mm),
            .u_0 = float(per_mm * dot(u, first)),
            .v_0 = float(per_mm * dot(v, first)),
            .up = float3(floor.up)};
}

namespace {

/// The picture's upper half, and below it what an open floor reflects. A row that the horizon passes through is cut.
Probe with_floor_below(const ProbeImage& image, double albedo) {
    const int width = image.width, height = image.height % 2 ? 2 * image.height : image.height;
    const auto row_of = [&](int y) { return image.height == height ? y : y / 2; };
    std::vector<float> rgb(std::size_t(3) * width * height);
    double irradiance[3] = {0, 0, 0};
    for (int y = 0; y < height / 2; ++y) {
        const double top = std::cos(std::numbers::pi * y / height),
                     bottom = std::cos(std::numbers::pi * (y + 1) / height);
        const double cosine = std::numbers::pi / width * (top * top - bottom * bottom);  // ∫ cos θ dω of a pixel
        const float* from = &image.rgb[std::size_t(3) * width * row_of(y)];
        std::copy_n(from, 3 * width, &rgb[std::size_t(3) * width * y]);
        for (int x = 0; x < 3 * width; ++x) irradiance[x % 3] += cosine * from[x];
    }
    for (std::size_t i = std::size_t(3) * width * (height / 2); i < rgb.size(); ++i)
        rgb[i] = float(albedo / std::numbers::pi * irradiance[i % 3]);
    return Probe(width, height, std::move(rgb));
}

}  // namespace

Probe Probe::Data::above_floor(double albedo) const {
    const std::lock_guard lock(floor_.mutex);
    if (floor_.albedo != albedo) floor_.probe = with_floor_below(image, albedo), floor_.albedo = albedo;
    return floor_.probe;
}

Lighting above_floor(const Lighting& lighting) {
    if (!lighting.floor.show) return lighting;
    Lighting above = lighting;
    above.probe.exposure = exposure_stops(lighting);
    above.loaded_probe = lighting_probe(lighting).data().above_floor(lighting.floor.albedo);
    return above;
}

}  // namespace chiaro

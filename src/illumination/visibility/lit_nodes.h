// Visibility meets a light: what arrives at every node. Found again only where the light has changed.
#pragma once
#include <chiaro/device.h>
#include <chiaro/lighting.h>

#include <memory>
#include <mutex>
#include <optional>

#include "illumination/probe/lambert.h"
#include "illumination/probe/light.h"
#include "illumination/visibility/field.h"
#include "illumination/visibility/nodes.h"

namespace chiaro {

/// A probe's light, turned as it is to be seen.
struct ProbeLight {
    const Lighting& lighting;
    Vec3 orbit_up;
    const Geometry& geometry;
    bool surfaces;          ///< where matter has them, by Lambert's law
    bool particles = true;  ///< E of the nodes, too; transport has its own
};

/// Where most of a probe's light comes from.
struct MainLight {
    Vec3 direction;  ///< unit, world, towards the light
    double share;    ///< 0: from everywhere alike, 1: from this direction alone
};

/// Node edges off a surface where light is read: there the nodes around see past the surface's skin, and what lies
/// beside it still shades. Tuned on tests/live_surfaces_test.cpp: at 1.25 a ball is 1 % too dark, at 2 furrows 2 % too
/// bright.
inline constexpr double surface_lift = 1.5;
/// The same where other matter is nearer than that: tuned on tests/live_geometry_test.cpp.
inline constexpr double crowded_lift = 0.75;

/// E of the nodes, and what else the ray caster reads.
struct LitLight {
    VoxelBuffer light;
    std::vector<kernel::NormalLight> surface;       ///< over an unfolded octahedron
    std::vector<std::vector<std::uint8_t>> sunlit;  ///< of each sun or lamp: [node][part]
    kernel::VisibilityView view;
    MainLight main;
};

class LitNodes : public std::enable_shared_from_this<LitNodes> {
public:
    LitNodes(const Device& device, VisibilityNodes nodes) : device_(device), nodes_(std::move(nodes)) {}

    /// What arrives of a light: the last one is kept, so that a turned camera costs nothing. Cost of another: nodes ×
    /// 50 instructions, some 2 ms for surfaces, and nodes × some 10 ns for a sun that has moved (50 for each lamp). The
    /// view is valid as long as the result is.
    std::shared_ptr<const LitLight> light(const ProbeLight& probe) const;
    const VisibilityNodes& nodes() const { return nodes_; }
    std::size_t bytes() const { return nodes_.bytes() + nodes_.grid.size() * 4 * sizeof(std::uint16_t); }

private:
    /// All that the light at the nodes depends on.
    struct Inputs {
        Probe probe;
        double rotation_deg, exposure_stops, strength;
        Vec3 orbit_up;
        Axes rows;  ///< from the world's axes to the grid's
        bool surfaces, particles;

        bool operator==(const Inputs&) const = default;
    };
    std::shared_ptr<const LitLight> find(const ProbeLight& probe) const;
    void light_all(const kernel::LightKernel& light) const;
    void light_particles(const ShLight& from, const LambertTable& table, LitLight& lit) const;
    /// T towards each part, the mean over its rays: [node][part].
    std::vector<std::uint8_t> sunlit(const Lamp& lamp, double node_edges) const;

    Device device_;
    VisibilityNodes nodes_;
    mutable std::mutex mutex_;  ///< of what is kept
    mutable std::optional<Inputs> of_;
    mutable std::shared_ptr<const LitLight> kept_;
};

}  // namespace chiaro

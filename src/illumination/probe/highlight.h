// What a highlight shows of a probe.
#pragma once
#include <chiaro/geometry.h>
#include <chiaro/lighting.h>

#include <array>
#include <memory>
#include <vector>

#include "illumination/probe/highlight_view.h"
#include "illumination/probe/reflection_table.h"

namespace chiaro {

struct ProbePieces;

/// All that a highlight depends on beside the probe.
struct HighlightKey {
    double strength, shininess;
    Vec3 to_eye;  ///< unit, in the probe's own frame: along the camera's axis

    bool operator==(const HighlightKey&) const = default;
};

/// For Blinn's lobe of one strength and shininess.
struct Highlight {
    HighlightKey key;
    ReflectionTable reflection;
    int edge;                                    ///< nodes a side
    std::vector<std::array<float, 4>> radiance;  ///< over an unfolded octahedron, u fastest
};

/// Of each direction r of the probe's frame the mean radiance, weighted by (n·ω) (n·h)^s, that a surface shows whose
/// normal n mirrors the eye to r; s is a whole number, at most 1000. Cost: some 5 ms of CPU time up to a shininess of
/// 80, 80 ms beyond. Kept by Probe::Data::highlight.
Highlight highlight_of_probe(const ProbePieces& pieces, const HighlightKey& key);

/// Null without a highlight. `to_eye`: world.
std::shared_ptr<const Highlight> highlight_of(const Lighting& lighting, Vec3 orbit_up, Vec3 to_eye);
/// Valid as long as the highlight is. `eye_mm`: world; without perspective far away.
kernel::HighlightView view_of(const Highlight& highlight, const Lighting& lighting, Vec3 orbit_up, Vec3 eye_mm,
                              const Geometry& geometry);

}  // namespace chiaro

// A probe's light times the cosine of a surface, as spherical harmonics: E = (ρ/π) Σ V_lm [L max(0, n·ω)]_lm.
#pragma once
#include <chiaro/lighting.h>

#include <span>

#include "illumination/probe/dominant.h"
#include "illumination/sh/rotation.h"

namespace chiaro {

/// Direction of node (i, j) of an unfolded octahedron of edge × edge nodes, unit: the inverse of octahedral().
Vec3 octahedron_node(int i, int j, int edge);

/// The bracket for normals n over an unfolded octahedron (octahedron.h): node (i, j) is the normal at u = i / (edge -
/// 1), v = j / (edge - 1); between them bilinear.
struct LambertTable {
    using Entry = std::array<std::array<float, max_coefficients>, 3>;  ///< per channel

    int edge = 0;                ///< nodes a side
    std::vector<Entry> entries;  ///< u fastest

    Vec3 normal(int i, int j) const { return octahedron_node(i, j, edge); }
    /// The look-up that a ray caster does, for one normal of any length.
    Entry at(Vec3 normal) const;
};

/// In the probe's own frame, by a sum over the picture's light gathered in 128 × 64 cells. Kept by
/// Probe::Data::lambert.
LambertTable lambert_of_probe(const Probe::Data& probe);

/// min(.45 / mean, 1.2 / largest) in stops, to a hundredth, of E/π in luminance over all normals: a matte white ball in
/// this light is .45 bright on the whole, and nowhere brighter than 1.2 (so that one of albedo .8 is not burnt out). 0
/// for a black one.
double suitable_stops_of_probe(const Probe::Data& probe);

/// Normals and coefficients in the axes of the voxel grid; turned, exposed and windowed as in sh_light. A turned light
/// is the probe's own table looked up at the normal turned back, its coefficients turned. Cost: some 2 ms of CPU
/// time, 811 kB; once a probe .2 s for its own table.
/// `left_out`: lights that are not counted.
LambertTable lambert_table(const Lighting& lighting, Vec3 orbit_up, const Geometry& geometry, ShWindow window,
                           int bands = max_bands, std::span<const Lamp> left_out = {});

}  // namespace chiaro

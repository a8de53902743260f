// A torso as a CT with contrast medium shows it, on a table: something of every value that a look is made for. Not
// anatomy: ellipsoids, tubes and plates, in HU and millimetres, +x to the patient's left, +y to the back, +z up.
#include <cmath>
#include <numbers>
#include <vector>

#include "samples/sample.h"

namespace chiaro {
namespace {

constexpr double torso_edge_mm = 360;

double depth_in_ellipsoid(Vec3 p, Vec3 centre, Vec3 radii) {
    const Vec3 q = p - centre, unit{q.x / radii.x, q.y / radii.y, q.z / radii.z};
    const Vec3 slope{unit.x / radii.x, unit.y / radii.y, unit.z / radii.z};
    const double r = length(unit);
    return r > 1e-6 ? r * (1 - r) / length(slope) : radii.x;  // to first order
}

struct Tube {
    Vec3 from, to;
    double radius;
    double depth(Vec3 p) const {
        const Vec3 along = to - from;
        const double t = std::clamp(dot(p - from, along) / dot(along, along), 0.0, 1.0);
        return radius - length(p - from - t * along);
    }
};
using Tree = std::vector<Tube>;

double depth_in(const Tree& tree, Vec3 p) {
    double depth = -1e9;
    for (const Tube& tube : tree) depth = std::max(depth, tube.depth(p));
    return depth;
}

/// Each branch forks in two that turn away from each other, now to one side, now to the other.
void grow(Tree& tree, Vec3 from, Vec3 along, double radius, int forks) {
    const Vec3 to = from + along;
    tree.push_back({from, to, radius});
    if (forks == 0) return;
    const Vec3 d = normalized(along);
    const Vec3 side = normalized(cross(d, forks % 2 ? Vec3{0.2, 1, 0.3} : Vec3{0.3, 0.2, 1}));
    for (const double turn : {-0.75, 0.55})
        grow(tree, to, 0.78 * length(along) * normalized(d + turn * side), 0.72 * radius, forks - 1);
}

struct Torso {
    static constexpr double air = -1000, lung = -860, fat = -100, skin = 10, muscle = 55, soft = 35, liver = 105,
                            marrow = 260, cortex = 750, contrast = 330, vein = 190, plastic = -350;
    Tree bronchi, arteries, coronaries, portal, aorta;

    Torso() {
        for (const double side : {-1.0, 1.0}) {
            grow(bronchi, {0, 5, 62}, {30 * side, 4, -20}, 6, 4);
            grow(arteries, {8 * side, -8, 44}, {34 * side, 2, -6}, 7, 6);
        }
        bronchi.push_back({{0, 5, 62}, {0, 5, 190}, 8});
        grow(coronaries, {8, -52, 38}, {14, -8, -16}, 2.6, 4);
        grow(coronaries, {0, -46, 36}, {-12, -6, -16}, 2.4, 3);
        grow(portal, {-10, 8, -110}, {-26, -6, 5}, 6, 5);
        // Up from the heart, over the arch, down along the spine.
        Vec3 last{0, -20, 30};
        for (int i = 0; i <= 12; ++i) {
            const double turn = std::numbers::pi * i / 12;
            const Vec3 next{12.0 * i / 12, 12 - 34 * std::cos(turn), 66 + 26 * std::sin(turn)};
            aorta.push_back({last, next, 11});
            last = next;
        }
        aorta.push_back({last, {12, 40, -180}, 10});
    }

    double ribs(Vec3 p, double depth) const {
        const double beside = std::abs(p.y - 30) < 120 && std::abs(p.x) > 14 ? 1 : 0;
        const double height = p.z + 0.45 * p.y, nearest = height - 27 * std::round(height / 27);
        return beside > 0 && p.z > -95 ? 5.5 - std::hypot(nearest, 1.3 * (depth - 21)) : -1e9;
    }
    double spine(Vec3 p) const {
        const double disc = std::abs(p.z / 30 - std::round(p.z / 30)) * 30;
        const double body = std::min((disc < 12 ? 18.0 : 14.0) - std::hypot(p.x, p.y - 58), 180 - std::abs(p.z));
        const double process = std::min({5 - std::abs(p.x), p.y - 58, 88 - p.y, 8 - std::abs(disc - 4)});
        return std::max(body, process);
    }

    double at(Vec3 p, double voxel_mm) const {
        double value = air;
        const auto put = [&](double inside, double depth_mm) {
            value += (inside - value) * coverage(depth_mm / (2 * voxel_mm));  // as unsharp as a scanner
        };
        put(plastic,
            std::min({6 - std::abs(p.y - 124 + 0.0006 * p.x * p.x), 165 - std::abs(p.x), 175 - std::abs(p.z)}));
        const double shoulders = 1 - 0.25 * std::pow(std::max(0.0, (p.z - 90) / 90), 2);
        const double wall =
            std::min(depth_in_ellipsoid({p.x, p.y, 0}, {}, {152 * shoulders, 100, 1e6}), 165 - std::abs(p.z));
        if (wall < -voxel_mm) return value;
        put(skin, wall), put(fat, wall - 2.5), put(muscle, wall - 10), put(fat, wall - 28), put(soft, wall - 30);
        for (const double side : {-1.0, 1.0})
            put(lung, std::min(depth_in_ellipsoid(p, {64 * side, 8, 45}, {46, 58, 92}), wall - 30));
        const double in_liver = std::min(depth_in_ellipsoid(p, {-48, -6, -108}, {76, 62, 44}), wall - 30);
        put(liver, in_liver);
        const double in_heart = depth_in_ellipsoid(p, {16, -24, 0}, {46, 40, 46});
        put(80, in_heart), put(contrast, depth_in_ellipsoid(p, {26, -26, -4}, {25, 22, 29})),
            put(contrast - 60, depth_in_ellipsoid(p, {-8, -22, 6}, {13, 20, 24}));
        if (std::abs(p.z - 45) < 110) {
            put(contrast, depth_in(arteries, p));
            const double tube = depth_in(bronchi, p);
            put(soft, tube + 2), put(air, tube);
        }
        if (in_liver > -10) put(vein, std::min(depth_in(portal, p), in_liver - 3));
        if (in_heart > -20) put(contrast + 20, depth_in(coronaries, p));
        // The aneurysm: a clot around what still flows.
        const double bulge = depth_in_ellipsoid(p, {14, 24, -122}, {26, 24, 34});
        put(90, bulge), put(contrast, depth_in(aorta, p)), put(contrast, bulge - 9);
        const double bone =
            std::max({spine(p), ribs(p, wall),
                      std::min({9 - std::abs(p.x), 4.5 - std::abs(wall - 17), p.y < 0 ? 1e9 : -1e9, p.z + 60})});
        put(cortex, bone), put(marrow, bone - 2.5);
        return value;
    }

    /// The structure that a place belongs to, 0 for none.
    int label(Vec3 p) const {
        const double shoulders = 1 - 0.25 * std::pow(std::max(0.0, (p.z - 90) / 90), 2);
        const double wall =
            std::min(depth_in_ellipsoid({p.x, p.y, 0}, {}, {152 * shoulders, 100, 1e6}), 165 - std::abs(p.z));
        if (wall < 0) return 0;
        int found = 0;
        const auto put = [&](int number, double depth_mm) {
            if (depth_mm > 0) found = number;
        };
        put(1, std::min(depth_in_ellipsoid(p, {64, 8, 45}, {46, 58, 92}), wall - 30));
        put(2, std::min(depth_in_ellipsoid(p, {-64, 8, 45}, {46, 58, 92}), wall - 30));
        const double in_liver = std::min(depth_in_ellipsoid(p, {-48, -6, -108}, {76, 62, 44}), wall - 30);
        put(3, in_liver), put(4, depth_in_ellipsoid(p, {16, -24, 0}, {46, 40, 46}));
        if (std::abs(p.z - 45) < 110) put(5, depth_in(arteries, p)), put(6, depth_in(bronchi, p) + 2);
        if (in_liver > 0) put(7, std::min(depth_in(portal, p), in_liver - 3));
        put(8, std::max(depth_in_ellipsoid(p, {14, 24, -122}, {26, 24, 34}), depth_in(aorta, p)));
        const double breastbone =
            std::min({9 - std::abs(p.x), 4.5 - std::abs(wall - 17), p.y < 0 ? 1e9 : -1e9, p.z + 60});
        put(9, std::max(ribs(p, wall), breastbone)), put(10, spine(p));
        return found;
    }
};

SampleVoxels make_organs(int size) {
    const Torso torso;
    const double voxel_mm = torso_edge_mm / size;
    const auto at = [=](int i) { return (i + 0.5) * voxel_mm - torso_edge_mm / 2; };
    return generate<std::uint8_t>([=](int i, int j, int k) { return torso.label({at(i), at(j), at(k)}); });
}

SampleVoxels make_torso(int size) {
    const Torso torso;
    const double voxel_mm = torso_edge_mm / size;
    const auto at = [=](int i) { return (i + 0.5) * voxel_mm - torso_edge_mm / 2; };
    return generate<std::int16_t>([=](int i, int j, int k) {
        return std::lround(torso.at({at(i), at(j), at(k)}, voxel_mm));
    });
}

void place_organs(Volume& volume) {
    const double voxel_mm = torso_edge_mm / volume.dimensions[0], first = 0.5 * voxel_mm - torso_edge_mm / 2;
    volume.geometry.spacing_mm = {voxel_mm, voxel_mm, voxel_mm};
    volume.geometry.origin_mm = {first, first, first};
    volume.geometry.world = World::lps;
}
void place_torso(Volume& volume) {
    place_organs(volume);
    volume.modality = "CT";
}

/// Skin and muscle left out: bone, vessels and liver.
TransferFunction torso_transfer_function() {
    TransferFunction tf;
    tf.opacity_unit_is_mm = true;
    constexpr Rgb liver{0.55, 0.24, 0.17}, blood{0.80, 0.13, 0.10}, bone{0.94, 0.90, 0.80}, ivory{0.98, 0.96, 0.90};
    tf.points = {{75, liver, 0},     {100, liver, 0.1}, {130, liver, 0.1}, {180, blood, 0.04},
                 {260, blood, 0.14}, {360, blood, 0.2}, {460, bone, 0.6},  {900, ivory, 0.95}};
    return tf;
}

/// Everything but what no structure has.
TransferFunction organs_transfer_function() {
    TransferFunction tf;
    constexpr Rgb white{0.9, 0.9, 0.9};
    tf.points = {{0.5, white, 0}, {0.5, white, 0.9}, {10, white, 0.9}};
    return tf;
}

}  // namespace

Sample organs_sample() {
    return {
        {"organs",
         "labels of what is in torso: 1 and 2 lungs, 3 liver, 4 heart, 5 arteries, 6 airways, 7 portal vein, 8 aorta, "
         "9 ribs, 10 spine",
         128, true},
        make_organs,
        organs_transfer_function,
        place_organs};
}

Sample torso_sample() {
    return {
        {"torso", "a torso in HU with contrast medium, on a table, for the looks of CT; no anatomy to learn from", 128},
        make_torso,
        torso_transfer_function,
        place_torso};
}

}  // namespace chiaro

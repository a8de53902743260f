// Measurements and notes in a volume, as a scene keeps them. Pictures are made without them; who shows them draws them.
#pragma once
#include <chiaro/geometry.h>

#include <array>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace chiaro {

enum class MarkKind { distance, polyline, angle, ball, box, profile, arrow, text };

/// Of an angle the second point is its corner; of a ball the points are its centre and one on its surface, of a box two
/// opposite corners; an arrow points at its first.
struct Mark {
    MarkKind kind = MarkKind::distance;
    std::vector<Vec3> points_mm;  ///< world
    std::string text{};           ///< what people call it, or say there
    bool operator==(const Mark&) const = default;
};

inline constexpr std::size_t max_marks = 1000, max_mark_points = 1000, max_mark_text = 1000;

/// How many points a kind has: at least, at most.
constexpr std::array<std::size_t, 2> mark_points(MarkKind kind) {
    switch (kind) {
        case MarkKind::polyline:
            return {2, max_mark_points};
        case MarkKind::angle:
            return {3, 3};
        case MarkKind::text:
            return {1, 1};
        default:
            return {2, 2};
    }
}

}  // namespace chiaro

// Which directions a sweep takes together, and what each needs to know.
#pragma once
#include <chiaro/geometry.h>

#include <array>
#include <span>
#include <vector>

#include "core/host_array.h"
#include "core/line_allocator.h"
#include "illumination/sh/basis.h"
#include "illumination/visibility/sweep_kernel.h"
#include "illumination/visibility/swept_places.h"

namespace chiaro {

/// The axes of a sweep: planes are perpendicular to `major`, rows lie along `u`.
struct SweepAxes {
    int major, u, v;
    int sign;  ///< of the directions' major component: the light comes from that end
};

/// Where cells lie that are `strides` apart along x, y and z, the first of all at `origin`.
kernel::SweptPlaces places_of(const SweepAxes& axes, int steps, const std::array<std::int64_t, 3>& strides,
                              std::int64_t origin = 0);

/// A direction as a sweep sees it, per step from one plane to the next.
struct SweepDirection {
    int index;      ///< among all
    double du, dv;  ///< nodes to the side, in [-1, 1]
    double length;  ///< node edges, 1 to √3
};

/// The directions that share a major axis and its sign, in the order of packs.
struct SweepGroup {
    SweepAxes axes;
    std::vector<SweepDirection> directions;
};
std::vector<SweepGroup> sweep_groups(const std::vector<Vec3>& directions);

/// Directions of a group that visibility takes together.
struct DirectionBatch {
    SweepAxes axes;
    std::span<const SweepDirection> directions;  ///< of the group
};
std::vector<DirectionBatch> direction_batches(const std::vector<SweepGroup>& groups);

/// What is asked for: harmonics of V over all directions, or the mean of V over those of each part.
struct SweptDirections {
    std::vector<Vec3> towards;   ///< grid axes, unit, towards the light
    std::vector<int> part = {};  ///< of each; none: harmonics are asked for

    SweptDirections(std::vector<Vec3> all) : towards(std::move(all)) {}
    SweptDirections(std::vector<Vec3> all, std::vector<int> parts) : towards(std::move(all)), part(std::move(parts)) {}
    /// What V of the direction weighs in a number of a node.
    void weigh(int direction, std::array<double, max_coefficients>& weights) const;
};

/// w Y_lm of some directions, each weighing 4π / N, or what they weigh in their part, for the kernel.
class BatchHarmonics {
public:
    /// `lanes` directions are told; those beyond `chosen` weigh nothing.
    BatchHarmonics(const SweptDirections& all, std::span<const SweepDirection> chosen, int coefficients);
    void add_to(HostArrays& arrays) const {
        arrays.add(of_direction_);
        arrays.add(sum_);
    }
    kernel::Harmonics view() const { return {of_direction_.data(), sum_.data(), count_, coefficients_}; }

private:
    LineVector<float> of_direction_;
    std::vector<float> sum_;
    int count_, coefficients_;
};

/// Packs of sixteen directions for planes whose rows are `row` nodes apart.
class SweepPacks {
public:
    /// V starts `start` node edges from a node (on a cube of that half edge).
    SweepPacks(std::span<const SweepDirection> directions, int row, double start);
    /// What the packs point into.
    void add_to(HostArrays& arrays) const { arrays.add(numbers_); }
    const kernel::SweepPack* data() const { return packs_.data(); }
    int count() const { return int(packs_.size()); }
    int lanes() const { return count() * kernel::SweepPack::width; }

private:
    void add(std::span<const SweepDirection> directions, int row, double start);

    struct Numbers {
        float weights[kernel::SweepPack::max_taps][kernel::SweepPack::width];
        float before[kernel::SweepPack::width], outer[kernel::SweepPack::width], inner[kernel::SweepPack::width];
    };
    LineVector<Numbers> numbers_;
    std::vector<kernel::SweepPack> packs_;
};

}  // namespace chiaro

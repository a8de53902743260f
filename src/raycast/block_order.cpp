#include <chiaro/error.h>
#include <chiaro/render.h>

#include <algorithm>

namespace chiaro {
namespace {

/// What a plane across an axis parts, by voxels: blocks that end before it lie on its low side.
struct Plane {
    std::size_t axis = 0;
    int at = 0;
    std::size_t low = 0;  ///< blocks on that side; 0: no plane parts them
};

class Order {
public:
    Order(std::span<const Placement> blocks, const Geometry& whole, const Camera& camera) : blocks_(blocks) {
        const bool is_parallel = camera.projection == Projection::orthographic;
        eye_ = whole.voxel_from_world(camera.eye);
        const Vec3 ahead = whole.voxel_from_world_vector(camera.forward);
        for (int a = 0; is_parallel && a < 3; ++a) eye_[a] = ahead[a] > 0 ? -1e30 : 1e30;  // infinitely far behind
    }

    /// Sorts numbers of blocks, each of which owns voxels.
    void sort(std::span<int> numbers) const {
        if (numbers.size() < 2) return;
        const Plane plane = parting(numbers);
        if (plane.low == 0)
            throw Error(ErrorCode::usage, "blocks that no plane parts have no order in which rays meet them");
        const auto is_low = [&](int block) { return end(block, plane.axis) <= plane.at; };
        const bool low_first = eye_[int(plane.axis)] < plane.at;
        std::stable_partition(numbers.begin(), numbers.end(), [&](int block) { return is_low(block) == low_first; });
        const std::size_t nearer = low_first ? plane.low : numbers.size() - plane.low;
        sort(numbers.first(nearer));
        sort(numbers.subspan(nearer));
    }

private:
    int first(int block, std::size_t axis) const { return blocks_[std::size_t(block)].own_first[axis]; }
    int end(int block, std::size_t axis) const { return blocks_[std::size_t(block)].own_end[axis]; }

    /// The plane that cuts no block and parts them most evenly.
    Plane parting(std::span<const int> numbers) const {
        Plane best;
        std::vector<int> sorted(numbers.begin(), numbers.end());
        for (std::size_t axis = 0; axis < 3; ++axis) {
            std::sort(sorted.begin(), sorted.end(), [&](int a, int b) { return first(a, axis) < first(b, axis); });
            int reached = end(sorted[0], axis);
            for (std::size_t low = 1; low < sorted.size(); ++low) {
                const int next = first(sorted[low], axis);
                const auto evenness = [&](std::size_t n) { return std::min(n, sorted.size() - n); };
                if (reached <= next && (best.low == 0 || evenness(low) > evenness(best.low))) best = {axis, next, low};
                reached = std::max(reached, end(sorted[low], axis));
            }
        }
        return best;
    }

    std::span<const Placement> blocks_;
    Vec3 eye_;  ///< voxels
};

}  // namespace

std::vector<int> front_to_back(std::span<const Placement> blocks, const Geometry& whole, const Camera& camera) {
    std::vector<int> numbers(blocks.size());
    for (std::size_t i = 0; i < numbers.size(); ++i) numbers[i] = int(i);
    const auto owns_any = [&](int block) { return blocks[std::size_t(block)].owns_any(); };
    const auto empty = std::stable_partition(numbers.begin(), numbers.end(), owns_any);
    Order(blocks, whole, camera).sort(std::span(numbers.begin(), empty));
    return numbers;
}

}  // namespace chiaro

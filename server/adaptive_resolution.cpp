#include "adaptive_resolution.h"

#include <algorithm>
#include <cmath>

namespace chiaro::server {

// `comfortable` and `weight_of_newest` were chosen by eye as far as history shows: sizes go up later than they go down,
// so that they do not alternate, and a mean over some two frames follows a scene that becomes slower.
constexpr int max_steps = 4;          // a quarter a side
constexpr double comfortable = 0.75;  // of the target: so much must be left before a size goes up again
constexpr double weight_of_newest = 0.4;

double AdaptiveResolution::expected(double pixels) const { return known_ ? per_pixel_ * pixels : 0; }

std::pair<int, int> AdaptiveResolution::size(int width, int height) {
    const auto pixels = [&](int steps) { return double(width) * height * std::exp2(-steps); };
    if (known_) {
        while (steps_ < max_steps && expected(pixels(steps_)) > target_seconds) ++steps_;
        while (steps_ > 0 && expected(pixels(steps_ - 1)) < comfortable * target_seconds) --steps_;
    }
    const double scale = std::exp2(-0.5 * steps_);
    return {std::max(1, int(std::lround(width * scale))), std::max(1, int(std::lround(height * scale)))};
}

void AdaptiveResolution::learn(double pixels, double seconds) {
    const double seen = seconds / std::max(1.0, pixels);
    per_pixel_ = known_ ? per_pixel_ + weight_of_newest * (seen - per_pixel_) : seen;
    known_ = true;
}

}  // namespace chiaro::server

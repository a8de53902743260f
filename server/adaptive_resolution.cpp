#include "adaptive_resolution.h"

#include <algorithm>
#include <cmath>

namespace chiaro::server {

// `comfortable` and `weight_of_newest` were chosen by eye as far as history shows: sizes go up later than they go down,
// so that they do not alternate, and a mean over some two frames follows a scene that becomes slower.
constexpr int max_steps = 4;          // a quarter a side
constexpr double comfortable = 0.75;  // of the target: so much must be left before a size goes up again
constexpr double weight_of_newest = 0.4;
constexpr int least_width = 640;  // that a slow way may lead to

/// Qualities of drafts, with the share of the bytes of the first that they take (measured on a brain, a torso and
/// tubes).
struct Quality {
    int quality;
    double bytes;
};
constexpr Quality qualities[] = {{70, 1}, {50, 0.72}, {35, 0.56}};

double AdaptiveResolution::expected(double pixels) const { return known_ ? per_pixel_ * pixels : 0; }

DraftSize AdaptiveResolution::size(int width, int height, const LinkState& link) {
    // Far away size matters more than rate, as a picture is under way for longer than it is drawn.
    const double target = link.is_slow() ? 0.045 + 0.2 * std::min(link.round_trip, 0.5) : target_seconds;
    const auto pixels = [&](int steps) { return double(width) * height * std::exp2(-steps); };
    if (known_) {
        while (steps_ < max_steps && expected(pixels(steps_)) > target) ++steps_;
        while (steps_ > 0 && expected(pixels(steps_ - 1)) < comfortable * target) --steps_;
    }
    const auto at = [&](int steps, int quality) {
        const double scale = std::exp2(-0.5 * steps);
        return DraftSize{std::max(1, int(std::lround(width * scale))), std::max(1, int(std::lround(height * scale))),
                         quality};
    };
    DraftSize draft = at(steps_, qualities[0].quality);
    for (int steps = steps_; steps <= max_steps; ++steps)
        for (const auto& [quality, bytes] : qualities) {
            const DraftSize other = at(steps, quality);
            if (steps > steps_ && other.width < least_width) return draft;
            draft = other;
            if (bytes_per_pixel_ * bytes * pixels(steps) <= link.draft_bytes()) return draft;
        }
    return draft;
}

void AdaptiveResolution::learn_bytes(const DraftSize& draft, std::size_t bytes) {
    double share = 1;
    for (const auto& [quality, of_it] : qualities)
        if (quality == draft.quality) share = of_it;
    const double seen = double(bytes) / share / (double(draft.width) * draft.height);
    bytes_per_pixel_ = bytes_per_pixel_ > 0 ? bytes_per_pixel_ + weight_of_newest * (seen - bytes_per_pixel_) : seen;
}

void AdaptiveResolution::learn(double pixels, double seconds) {
    const double seen = seconds / std::max(1.0, pixels);
    per_pixel_ = known_ ? per_pixel_ + weight_of_newest * (seen - per_pixel_) : seen;
    known_ = true;
}

}  // namespace chiaro::server

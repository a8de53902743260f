#include "adaptive_resolution.h"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace chiaro::server {

// `comfortable` and `weight_of_newest` were chosen by eye as far as history shows: sizes go up later than they go down,
// so that they do not alternate, and a mean over some two frames follows a scene that becomes slower.
constexpr double comfortable = 0.75;  // of the target: so much must be left before a size goes up again
constexpr double weight_of_newest = 0.4;
// Widths that drafts on a slow way do not go below, for the way's sake or, where they take `patience` at most, the
// time's: those asked for at 5 and 2 Mbit/s (docs/viewer.md).
constexpr int least_width = 640, least_narrow_width = 480;
constexpr double narrow = 312e3;  // bytes a second
constexpr double patience = 0.1;  // seconds

/// What a draft may be, each quicker than the one before: its side is the canvas's over √2^shrinks.
struct Rung {
    int shrinks;
    double step_factor;
};
constexpr Rung ladder[] = {{0, 1}, {1, 1}, {1, 2}, {2, 2}, {3, 2}, {3, 4}, {4, 4}};
constexpr int last_rung = int(std::size(ladder)) - 1;
// Of a frame's time, with samples twice as far apart (measured on shells and tubes of 256³, .59 to .66), and four
// times, of every other voxel (shells of 512³, .25).
constexpr double of_coarse = 0.62, of_coarsest = 0.25;

double cost(const DraftSize& draft) {
    const double share = draft.step_factor > 2 ? of_coarsest : draft.step_factor > 1 ? of_coarse : 1;
    return std::max(1.0, double(draft.width) * draft.height) * share;
}

/// Qualities of drafts, with the share of the bytes of the first that they take (measured on a brain, a torso and
/// tubes).
struct Quality {
    int quality;
    double bytes;
};
constexpr Quality qualities[] = {{70, 1}, {50, 0.72}, {35, 0.56}, {25, 0.45}};

/// Of the canvas's sides; at `least` where only the next one would be below.
double scale_of(int rung, double least) {
    const double scale = std::exp2(-0.5 * ladder[rung].shrinks);
    return rung > 0 && scale > least && std::exp2(-0.5) * scale < least ? least : scale;
}

double AdaptiveResolution::expected(const DraftSize& draft) const { return known_ ? per_pixel_ * cost(draft) : 0; }

DraftSize AdaptiveResolution::size(int width, int height, const LinkState& link) {
    // Far away size matters more than rate, as a picture is under way for longer than it is drawn.
    const double target = link.is_slow() ? 0.045 + 0.2 * std::min(link.round_trip, 0.5) : target_seconds;
    const int least = !link.is_slow() ? 0 : link.bytes_per_second < narrow ? least_narrow_width : least_width;
    const auto at = [&](int rung, int quality) {
        const double scale = scale_of(rung, double(least) / width);
        return DraftSize{std::max(1, int(std::lround(width * scale))), std::max(1, int(std::lround(height * scale))),
                         quality, ladder[rung].step_factor};
    };
    const int best = qualities[0].quality;
    if (known_) {
        while (rung_ < last_rung && expected(at(rung_, best)) > target) ++rung_;
        while (rung_ > 0 && expected(at(rung_ - 1, best)) < comfortable * target) --rung_;
    }
    int first = rung_;
    while (first > 0 && at(first, best).width < least && expected(at(first - 1, best)) < patience) --first;
    DraftSize draft = at(first, best);
    for (int rung = first; rung <= last_rung; ++rung) {
        if (rung > first && ladder[rung].shrinks == ladder[rung - 1].shrinks) continue;  // as many bytes
        for (const auto& [quality, bytes] : qualities) {
            const DraftSize other = at(rung, quality);
            if (rung > first && other.width < least) return draft;
            draft = other;
            if (bytes_per_pixel_ * bytes * draft.width * draft.height <= link.draft_bytes()) return draft;
        }
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

void AdaptiveResolution::learn(const DraftSize& draft, double seconds) {
    const double seen = seconds / cost(draft);
    per_pixel_ = known_ ? per_pixel_ + weight_of_newest * (seen - per_pixel_) : seen;
    known_ = true;
}

}  // namespace chiaro::server

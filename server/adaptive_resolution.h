// How large a picture may be while something moves.
#pragma once
#include <cstddef>

#include "link_pace.h"

namespace chiaro::server {

/// A picture while something moves: its size, the quality of its JPEG, and how much further apart the samples of a ray
/// are than in the final picture.
struct DraftSize {
    int width, height, quality;
    double step_factor = 1;
};

/// Sizes go down from the canvas's by √2 a side, to a quarter of it, so that a frame takes a thirtieth of a second by
/// what the last ones took (an eighteenth on a slow way of 50 ms, a thirteenth on one of 150); from the first step on,
/// before sizes become smaller still, samples are twice as far apart, and four times at last, where large volumes are
/// drawn by every other voxel; and further, with lower qualities, so that it has no more bytes than the way to the page
/// has room for, but for that never below 640 pixels across.
class AdaptiveResolution {
public:
    static constexpr double target_seconds = 1.0 / 30;

    /// What to draw of a canvas of this size.
    DraftSize size(int width, int height, const LinkState& link);
    /// What a picture is thought to take; 0 before anything is known.
    double expected(const DraftSize& draft) const;
    void learn(const DraftSize& draft, double seconds);
    void learn_bytes(const DraftSize& draft, std::size_t bytes);
    void forget() { known_ = false; }

private:
    bool known_ = false;
    double per_pixel_ = 0;        ///< seconds, at the final picture's step
    double bytes_per_pixel_ = 0;  ///< at the best quality; 0: not known
    int rung_ = 3;                ///< of the ladder of sizes, 0: the canvas's
};

}  // namespace chiaro::server

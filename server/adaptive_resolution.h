// How large a picture may be while something moves.
#pragma once
#include <utility>

namespace chiaro::server {

/// Sizes go down from the canvas's by √2 a side, to a quarter of it, so that a frame takes a thirtieth of a second by
/// what the last ones took.
class AdaptiveResolution {
public:
    static constexpr double target_seconds = 1.0 / 30;

    /// The size to draw at.
    std::pair<int, int> size(int width, int height);
    /// What a picture of so many pixels is thought to take; 0 before anything is known.
    double expected(double pixels) const;
    void learn(double pixels, double seconds);
    void forget() { known_ = false; }

private:
    bool known_ = false;
    double per_pixel_ = 0;  ///< seconds
    int steps_ = 2;         ///< of √2 below the canvas
};

}  // namespace chiaro::server

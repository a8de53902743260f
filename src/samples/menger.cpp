// The Menger sponge of level 4: a solid that is all cavities, for ambient occlusion.
#include "samples/sample.h"

namespace chiaro {
namespace {

constexpr int cells = 81;  // 3⁴ along an edge of the sponge, with one cell of air around it

/// A cell is drilled away if at any level two of its three coordinates are in the middle third.
bool solid(int x, int y, int z) {
    if (std::min({x, y, z}) < 0 || std::max({x, y, z}) >= cells) return false;
    for (; x > 0 || y > 0 || z > 0; x /= 3, y /= 3, z /= 3)
        if ((x % 3 == 1) + (y % 3 == 1) + (z % 3 == 1) >= 2) return false;
    return true;
}

SampleVoxels make_menger(int size) {
    const auto cell = [=](int i) {
        return int((2 * std::int64_t(i) + 1) * (cells + 2) / (2 * std::int64_t(size))) - 1;
    };
    return generate<std::uint8_t>([=](int i, int j, int k) { return solid(cell(i), cell(j), cell(k)) ? 255 : 0; });
}

TransferFunction menger_transfer_function() {
    constexpr Rgb ivory{0.93, 0.88, 0.78};
    TransferFunction tf;
    tf.points = {{0, ivory, 0}, {100, ivory, 0}, {155, ivory, 0.9}, {255, ivory, 1}};
    return tf;
}

}  // namespace

Sample menger_sample() {
    return {{"menger", "the Menger sponge of level 4", 249}, make_menger, menger_transfer_function};
}

}  // namespace chiaro

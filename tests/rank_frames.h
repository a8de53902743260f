// Light and frames of ranks beside those of one.
#pragma once
#include <chiaro/image.h>
#include <gtest/gtest.h>

#include <cmath>

#include "illumination/field.h"
#include "rank_threads.h"

namespace chiaro::testing {

template <class T>
std::vector<std::byte> bytes_of(const std::vector<T>& values) {
    const auto bytes = std::as_bytes(std::span(values));
    return {bytes.begin(), bytes.end()};
}
inline std::vector<std::byte> bytes_of(const LitNodes& nodes) {
    const VoxelBuffer& kept = nodes.nodes().harmonics;
    return {kept.data(), kept.data() + kept.size()};
}
/// All that is found of light but spao's, which is of a rank's own cells.
inline std::vector<std::byte> found(const IlluminationField& field) {
    if (const auto& visibility = field.data().visibility) return bytes_of(*visibility);
    if (!field.data().transport) return {};
    const TransportNodes& nodes = field.data().transport->nodes();
    std::vector<std::byte> all = bytes_of(nodes.light);
    for (const auto& more : {bytes_of(nodes.moment), bytes_of(nodes.weight), bytes_of(*nodes.seen)})
        all.insert(all.end(), more.begin(), more.end());
    return all;
}

inline Frame blended(const std::vector<Frame>& frames, const std::vector<int>& order) {
    Frame all(frames[0].width, frames[0].height);
    for (const int block : order)
        for (std::size_t p = 0; p < all.rgba.size(); p += 4) {
            const float left = 1 - all.rgba[p + 3];
            for (std::size_t c = 0; c < 4; ++c) all.rgba[p + c] += left * frames[std::size_t(block)].rgba[p + c];
        }
    return all;
}

/// Over the pixels that are covered, of 255.
inline void check_same(const Frame& together, const Frame& one) {
    double most = 0, sum = 0;
    std::size_t covered = 0;
    for (std::size_t i = 0; i < together.rgba.size(); ++i) {
        if (one.rgba[i / 4 * 4 + 3] == 0) {
            ASSERT_EQ(together.rgba[i], 0);
            continue;
        }
        const double off = 255 * std::abs(double(together.rgba[i]) - one.rgba[i]);
        most = std::max(most, off), sum += off, ++covered;
    }
    ASSERT_GT(covered, 10000u);
    if (std::getenv("CHIARO_SHOW")) std::printf("max %.4f mean %.5f of 255\n", most, sum / double(covered));
    EXPECT_LE(most, 0.5);
    EXPECT_LE(sum / double(covered), 0.02);
}

}  // namespace chiaro::testing

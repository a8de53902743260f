// What ranks that are processes take beyond the voxels that they hold.
#include <chiaro/text.h>
#include <gtest/gtest.h>

#include "rank_work.h"

using namespace chiaro;
using namespace chiaro::testing;

namespace {

// 1.4 times the block with its ghosts, the field, and what finding the field takes, which is the same for any number of
// ranks: visibility 8 bytes a node beside those of the field, and two planes of 80 directions; transport keeps what its
// next edit starts from.
TEST(RanksMemory, IsOfTheBlockAndTheField) {
    constexpr int edge = 192;
    constexpr double mib = 1 << 20, picture = 480 * 360 * 16, rest = 12 * mib;
    const double nodes = std::pow(edge / 2, 3), plane = std::pow(edge / 2 + 2, 2), cells = std::pow(64, 3);
    const Volume whole = float_tubes(edge);
    const std::pair<Method, double> methods[]{
        {Method::spao, 0}, {Method::visibility, 8 * nodes + 640 * plane}, {Method::transport, 530 * cells}};
    for (const auto& [method, found_by] : methods)
        for (const int ranks : {1, 2, 8}) {
            SCOPED_TRACE(std::string(to_text(method)) + " by " + std::to_string(ranks) + " ranks");
            for (const RankCost& cost : costs_of(whole, {.method = method}, ranks, ghosts_of(method))) {
                ASSERT_TRUE(cost.is_done);
                EXPECT_LE(cost.peak_bytes, 1.4 * cost.block_bytes + cost.field_bytes + found_by + picture + rest);
                EXPECT_GT(cost.peak_bytes, 0.9 * cost.block_bytes);
                if (std::getenv("CHIARO_SHOW"))
                    std::printf("%s %d: peak %.1f, block %.1f, field %.1f MiB\n", to_text(method).c_str(), ranks,
                                cost.peak_bytes / mib, cost.block_bytes / mib, cost.field_bytes / mib);
            }
        }
}

// What ranks tell each other is coarse: each sends its share of it, and gets the others'.
TEST(RanksMemory, SendsNoVoxels) {
    const Volume whole = float_tubes(96);
    for (const Method method : {Method::spao, Method::visibility, Method::transport})
        for (const RankCost& cost : costs_of(whole, {.method = method}, 4, ghosts_of(method))) {
            ASSERT_TRUE(cost.is_done);
            EXPECT_GT(cost.sent, 1000);
            EXPECT_GT(cost.received, cost.sent);
            if (method != Method::transport) {  // its 64 cells are half as many as these voxels
                EXPECT_LT(cost.sent + cost.received, 0.4 * double(whole.voxels.size()));
            }
        }
}

}  // namespace

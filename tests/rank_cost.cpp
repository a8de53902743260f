// What each of several ranks pays for light: rank_cost METHOD RANKS SIZE [GHOSTS] for scripts/cluster_cost. A line of
// JSON: of the sample `tubes` of SIZE³ floats, cut as evenly as it goes, light and a picture of 480 × 360 by one thread
// each.
#include <chiaro/camera.h>
#include <chiaro/render.h>
#include <chiaro/samples.h>
#include <chiaro/text.h>
#include <fmt/format.h>

#include <cstdlib>

#include "rank_work.h"

using namespace chiaro;
using namespace chiaro::testing;

int main(int argc, char** argv) try {
    if (argc < 4) return std::fprintf(stderr, "rank_cost METHOD RANKS SIZE [GHOSTS]\n"), 2;
    const int ranks = std::atoi(argv[2]), size = std::atoi(argv[3]);
    IlluminationSettings settings;
    from_text(argv[1], settings.method);
    const int ghosts = argc > 4 ? std::atoi(argv[4]) : ghosts_of(settings.method);
    for (const RankCost& cost : costs_of(float_tubes(size), settings, ranks, ghosts)) {
        if (!cost.is_done) return 1;
        fmt::print(
            "{{\"method\": \"{}\", \"ranks\": {}, \"size\": {}, \"cpu_seconds\": {:.4f}, \"peak_bytes\": {:.0f}, "
            "\"sent\": {:.0f}, \"received\": {:.0f}, \"block_bytes\": {:.0f}, \"field_bytes\": {:.0f}}}\n",
            argv[1], ranks, size, cost.cpu_seconds, cost.peak_bytes, cost.sent, cost.received, cost.block_bytes,
            cost.field_bytes);
    }
    return 0;
} catch (const std::exception& error) {
    return std::fprintf(stderr, "%s\n", error.what()), 1;
}

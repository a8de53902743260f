#include "illumination/histogram/prepare.h"

#include <chiaro/error.h>
#include <fmt/format.h>

#include "illumination/histogram/cache.h"
#include "illumination/histogram/emission.h"
#include "illumination/histogram/exact_kernel.h"
#include "illumination/histogram/fast.h"
#include "illumination/histogram/random.h"

namespace chiaro {
namespace {

/// Cells from a cell to the next strong edge along one direction, or to the border.
int steps_to_edge(const BinnedCells& cells, std::array<int, 3> at, int axis, int sign, int most, float strong) {
    for (int step = 0; step < most; ++step, at[axis] += sign) {
        if (at[axis] < 0 || at[axis] >= cells.grid.count[axis]) return step;
        const auto g = cells.gradient(at[0], at[1], at[2]);
        if (g[0] * g[0] + g[1] * g[1] + g[2] * g[2] > strong * strong) return step;
    }
    return most;
}

void check_within(const char* name, int value, int least, int most) {
    if (value < least || value > most)
        throw Error(ErrorCode::usage, fmt::format("{} {}: must be {} to {}", name, value, least, most));
}

/// What only flags and scene files are held to so far; and all that can be refused before long work.
void check_settings(const HistogramSettings& settings) {
    check_within("hist-radius", settings.radius, 0, kernel::BallView::max_reach);
    check_within("hist-clusters", settings.clusters, 1, 4096);
    check_within("hist-packed-bins", settings.packed_bins, 2, 256);
    check_within("hist-subsample", settings.subsample, 1, 4);
    if (settings.subsample == 3)  // nodes lie alike in every block
        throw Error(ErrorCode::usage, "hist-subsample 3: must be 1, 2 or 4");
    if (settings.effects.emission && !settings.emission.empty()) EmissionMapping{settings.emission};
}

}  // namespace

int proposed_radius(const DeviceVolume& volume) {
    // Of 4096 random cells; an edge is strong where it changes the value by an eighth of its range, and cells in the
    // lowest sixteenth are taken as empty. Chosen by eye as far as history shows.
    constexpr int probes = 4096, least = 4, most = 32;
    Progress progress;
    const BinnedCells cells = bin_cells(volume.data().device, volume.data(), progress);
    const auto [nx, ny, nz] = cells.grid.count;
    const float strong = float(cells.binning.count) / 8;
    double sum = 0;
    int count = 0;
    for (std::uint64_t i = 0; i < probes; ++i) {
        const std::array at{int(random_share(3 * i) * nx), int(random_share(3 * i + 1) * ny),
                            int(random_share(3 * i + 2) * nz)};
        // From where there is something: those in the emptiest bins do not count.
        if (cells.data()[cells.grid.index(at[0], at[1], at[2])] <= cells.binning.count / 16) continue;
        for (int axis = 0; axis < 3; ++axis)
            for (const int sign : {-1, 1}) sum += steps_to_edge(cells, at, axis, sign, most, strong), ++count;
    }
    return count == 0 ? HistogramSettings().radius : std::clamp(int(std::lround(sum / count)), least, most);
}

std::shared_ptr<const LocalHistograms> prepare_histograms(const Device& device, const DeviceVolume& volume,
                                                          HistogramSettings settings, StageTimer& timer,
                                                          std::vector<std::string>& notes, Progress& progress) {
    check_settings(settings);
    const DeviceVolume::Data& data = volume.data();
    if (settings.radius == 0) {
        settings.radius = proposed_radius(volume);
        notes.push_back(fmt::format("hist-radius {} proposed by the data", settings.radius));
    }
    const HistogramCache cache(settings.cache, data, settings);
    auto found = timer("histogram cache", [&] { return cache.read(notes); });
    if (found) {
        // Only what cannot be found again at once is kept.
        found->radius = settings.radius, found->subsample = settings.subsample;
        timer("histogram lift", [&] {
            const BinnedCells cells = bin_cells(device, data, progress);
            found->grid = cells.grid, found->binning = cells.binning;
            normal_offset_identifiers(device, cells, *found);
        });
        return std::make_shared<const LocalHistograms>(std::move(*found));
    }
    auto made = std::make_shared<LocalHistograms>(find_local_histograms(device, data, settings, timer, progress));
    timer("histogram keep", [&] { cache.write(*made, notes); });
    return made;
}

}  // namespace chiaro

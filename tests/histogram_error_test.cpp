// The default path's occlusion against direct sums, on real heads.
#include <chiaro/io.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>

#include "devices.h"
#include "occlusion_error.h"

using namespace chiaro;
using chiaro::testing::tested_device;

namespace {

class HistogramErrorTest : public ::testing::TestWithParam<const char*> {};

/// Every other slice, row and column, which is what a test has time for: an eighth of the volume, as structured.
Volume halved(const Volume& volume) {
    const auto [nx, ny, nz] = volume.dimensions;
    Volume out = make_volume({nx / 2, ny / 2, nz / 2}, volume.type);
    out.slope = volume.slope, out.intercept = volume.intercept, out.geometry = volume.geometry;
    const std::size_t size = size_of(volume.type);
    std::size_t to = 0;
    for (int z = 0; z < nz / 2; ++z)
        for (int y = 0; y < ny / 2; ++y)
            for (int x = 0; x < nx / 2; ++x, to += size)
                std::copy_n(volume.voxels.data() + ((std::size_t(2 * z) * ny + 2 * y) * nx + 2 * x) * size, size,
                            out.voxels.data() + to);
    return out;
}

TEST_P(HistogramErrorTest, OcclusionIsNearDirectSums) {
    const char* folder = std::getenv("CHIARO_DATA_DIR");
    if (!folder || !std::filesystem::exists(std::filesystem::path(folder) / "volumes" / GetParam()))
        GTEST_SKIP() << "skipped: no data";
    Progress progress;
    const Volume volume =
        halved(read_volume((std::filesystem::path(folder) / "volumes" / GetParam()).string(), {}, progress));
    const Statistics statistics = measure(volume);
    const DeviceVolume voxels = upload(tested_device(), volume);
    StageTimer timer;
    const LocalHistograms h =
        find_local_histograms(tested_device(), voxels.data(), {.radius = 16, .cache = "none"}, timer, progress);
    const auto functions = bench::four_functions(statistics.min, statistics.p999);
    const auto errors = bench::occlusion_errors(voxels, h, functions, 2000);
    for (std::size_t f = 0; f < functions.size(); ++f) {
        EXPECT_LT(errors[f].rmse, 0.03) << functions[f].first;
        EXPECT_LT(std::abs(errors[f].bias), 0.01) << functions[f].first;
        RecordProperty(functions[f].first, std::to_string(errors[f].rmse));
    }
}

INSTANTIATE_TEST_SUITE_P(Heads, HistogramErrorTest, ::testing::Values("head_unc.nii.gz", "cthead.nrrd"));

}  // namespace

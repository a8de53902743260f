// Pictures of a GPU against the CPU's.
#pragma once
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "cuda/device_cache.h"
#include "fixtures.h"
#ifdef CHIARO_CUDA_EMULATED
#include <cuda_runtime_api.h>
#endif

namespace chiaro::testing {

#ifdef CHIARO_CUDA_EMULATED
inline constexpr double tolerance = 0;
#else
inline constexpr double tolerance = 1e-4;  // square roots and quotients are rounded alike, so usually 0 too
#endif

/// What a GPU's threads do too: one pixel at a time.
inline Device cpu() { return Device::cpu(2, Isa::scalar); }

class Gpus : public ::testing::Test {
protected:
    void SetUp() override {
        if (list_gpus().empty()) GTEST_SKIP() << "skipped: no CUDA device";
        gpu = Device::cuda(0, cpu());
    }

#ifdef CHIARO_CUDA_EMULATED
    void TearDown() override { EXPECT_GT(cuda_emulated::gpu().launches, launches_) << "the GPU did nothing"; }
    const std::size_t launches_ = cuda_emulated::gpu().launches;
#endif

    /// The same shot by both; returns the CPU's.
    Frame expect_same(Shot shot, const Volume& volume, const IlluminationSettings& light = {}) {
        shot.device = cpu();
        const Frame expected = shot.lit(volume, light);
        shot.device = gpu;
        const Difference d = difference(shot.lit(volume, light), expected, tolerance);
        EXPECT_EQ(d.pixels_beyond, 0) << "by up to " << d.max;
        EXPECT_GT(mean_alpha(expected), 0.02);
        return expected;
    }

    /// The same field by both.
    void expect_same_field(const Medium& medium, const IlluminationSettings& light, const std::string& what) {
        Progress progress;
        const ComputedField expected = compute_field(cpu(), medium, {}, {}, light, progress);
        const ComputedField found = compute_field(gpu, medium, {}, {}, light, progress);
        const auto a = expected.volume.as<float>(), b = found.volume.as<float>();
        ASSERT_EQ(a.size(), b.size());
        double worst = 0;
        for (std::size_t i = 0; i < a.size(); ++i) worst = std::max(worst, std::abs(double(a[i]) - b[i]));
        EXPECT_LE(worst, tolerance) << what;
    }

    Device gpu;
};

template <class Voxel>
Volume shells_of(int n, double scale = 1) {
    return sampled<Voxel>({n, n + 3, n - 5}, [&](double x, double y, double z) { return scale * shells(x, y, z, n); });
}

/// Shells that nothing passes through.
inline TransferFunction walls() {
    TransferFunction tf;
    tf.points = {{0, {0, 0, 0}, 0}, {100, {0.9, 0.6, 0.3}, 0}, {101, {0.9, 0.6, 0.3}, 0.999}, {255, {0.3, 0.9, 1}, 1}};
    return tf;
}

inline Shot shaded() {
    Shot shot;
    shot.lighting.shading = Shading::phong;
    return shot;
}

}  // namespace chiaro::testing

// What an edit, a turned light or an interruption leaves for the next light by transport, and its first picture.
#include <chiaro/chiaro.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "classify/medium.h"
#include "fixtures.h"
#include "illumination/transport/coarse_to_fine.h"
#include "illumination/transport/transport.h"

using namespace chiaro;
using namespace chiaro::testing;

namespace {

/// Fog in which an opaque slab stands.
Volume slab_in_fog() {
    return sampled<std::uint8_t>({48, 48, 48},
                                 [](double x, double y, double) { return x > 20 && x < 27 && y > 8 ? 200 : 100; });
}

class TransportEdit : public ::testing::Test {
protected:
    TransportEdit() {
        tf_.points = {{0, {0.9, 0.7, 0.5}, 0}, {100, {0.9, 0.7, 0.5}, 0.03}, {200, {0.9, 0.7, 0.5}, 0.999}};
    }

    Medium medium() const { return classify(volume_, tf_, Shape{}); }
    /// All fields of a light, the last one converged; stopped by `most` of them.
    std::vector<TransportNodes> refine(const Medium& medium, int most = 1000) {
        std::vector<TransportNodes> fields;
        Progress progress;
        StageTimer timer;
        const auto keep = [&](TransportNodes nodes, bool) {
            fields.push_back(std::move(nodes));
            if (int(fields.size()) == most) progress.cancel();
        };
        const auto go = [&] {
            refine_transport(device_, medium.data(), lighting_, settings_, {}, surfaces_, {0, 0, 1}, keep, timer,
                             progress, &memory_);
        };
        if (most < 1000)
            EXPECT_THROW(go(), Error);
        else
            go();
        return fields;
    }
    static double distance(const TransportNodes& found, const TransportNodes& ground_truth) {
        double errors = 0, squares = 0;
        for (std::size_t i = 0; i < ground_truth.light.size(); ++i)
            errors += std::pow(found.light[i] - ground_truth.light[i], 2),
                squares += std::pow(ground_truth.light[i], 2);
        return std::sqrt(errors / squares);
    }

    Device device_ = tested_device();
    DeviceVolume volume_ = upload(device_, slab_in_fog());
    TransferFunction tf_;
    Lighting lighting_;
    TransportSettings settings_{.grid = 48, .error = 1e-4};
    SurfaceModel surfaces_ = SurfaceModel::none;
    TransportMemory memory_;
};

}  // namespace

TEST_F(TransportEdit, DetailOfTheSameLightIsThatLight) {
    const Medium shown = medium();
    const TransportNodes fine = refine(shown).back(), half = memory_.half->nodes();
    const TransportNodes found = with_detail(*memory_.fine->matter(), half, {fine, half}, device_);
    EXPECT_LT(distance(found, fine), 1e-3);
    EXPECT_EQ(found.result, fine.result);
    double errors = 0;
    for (std::size_t i = 0; i < fine.moment.size(); ++i) errors += std::pow(found.moment[i] - fine.moment[i], 2);
    EXPECT_LT(std::sqrt(errors / double(fine.moment.size())), 5e-3);
}

TEST_F(TransportEdit, TheFirstImageAfterAnEditIsNearerThanTheLastBefore) {
    const TransportNodes before = refine(medium()).back();
    tf_.points[1].opacity = 0.045;
    const std::vector<TransportNodes> fields = refine(medium());
    ASSERT_EQ(fields[0].grid.count, before.grid.count);
    EXPECT_LT(distance(fields[0], fields.back()), 0.25 * distance(before, fields.back()));
    EXPECT_LT(distance(fields[0], fields.back()), 0.02);
}

TEST_F(TransportEdit, ATurnedLightMeetsTheSameMatter) {
    lighting_.probe.source = "sky";
    lighting_.loaded_probe = load_probe("sky");
    const Medium shown = medium();
    refine(shown);
    const SharedTransportMedium matter = memory_.fine->matter(), half = memory_.half->matter();
    lighting_.probe.rotation_deg = 120;
    const std::vector<TransportNodes> fields = refine(shown);
    EXPECT_EQ(memory_.fine->matter(), matter);
    EXPECT_EQ(memory_.half->matter(), half);
    memory_ = {};
    EXPECT_LT(distance(fields.back(), refine(shown).back()), 5e-3);
}

TEST_F(TransportEdit, WhatSurfacesSeeIsFoundAgainOnlyForOtherOpacities) {
    surfaces_ = SurfaceModel::automatic;
    settings_ = {.grid = 24, .error = 0.01};
    const TransportNodes before = refine(medium()).back();
    tf_.points[1].rgb = {0.2, 0.4, 0.9};
    const std::vector<TransportNodes> recoloured = refine(medium());
    EXPECT_EQ(recoloured.back().seen, before.seen);
    memory_ = {};
    const TransportNodes afresh = refine(medium()).back();
    EXPECT_LT(distance(recoloured.back(), afresh), 0.02);
    tf_.points[1].opacity = 0.05;
    const TransportNodes denser = refine(medium()).back();
    ASSERT_NE(denser.seen, afresh.seen);
    memory_ = {};
    const auto numbers = [](const TransportNodes& nodes) { return nodes.seen->nodes().harmonics.data(); };
    const TransportNodes again = refine(medium()).back();
    ASSERT_EQ(again.seen->nodes().harmonics.size(), denser.seen->nodes().harmonics.size());
    EXPECT_EQ(std::memcmp(numbers(again), numbers(denser), again.seen->nodes().harmonics.size()), 0);
    EXPECT_NE(std::memcmp(numbers(again), numbers(afresh), again.seen->nodes().harmonics.size()), 0);
}

TEST_F(TransportEdit, InterruptedLightIsWhatTheNextStartsFrom) {
    refine(medium());
    tf_.points[1].opacity = 0.06;
    const Medium edited = medium();
    refine(edited, 1);  // before the fine grid is swept: nothing new to start from
    EXPECT_NE(memory_.medium.lock().get(), &edited.data());
    refine(edited, 2);
    EXPECT_EQ(memory_.medium.lock().get(), &edited.data());
    EXPECT_LT(memory_.fine->iterations(), 8);
}

TEST_F(TransportEdit, AnotherVolumeTakesNoDetail) {
    refine(medium());
    volume_ =
        upload(device_, sampled<std::uint8_t>({48, 48, 48}, [](double x, double, double) { return x < 9 ? 200 : 0; }));
    EXPECT_EQ(refine(medium())[0].grid.count[0], 24);
}

// Visibility in spherical harmonics against rays: what each way reaches, on samples and on crops of CT.
#include <gtest/gtest.h>

#include <cstdlib>

#include "devices.h"
#include "visibility_metric.h"

using namespace chiaro;
using namespace chiaro::bench;
using chiaro::testing::tested_device;

namespace {

/// Relative L2 of 16 coefficients, in percent, that may not be passed; 64³ cells of which 1600 are asked, 400
/// directions.
struct Bounds {
    const char* name;
    double sweep, sheared, hierarchical, full;
};
constexpr Bounds all_bounds[] = {{"cornell", 4, 8, 50, 6},
                                 {"fog", 0.5, 0.3, 0.5, 0.5},
                                 {"engine", 2, 1.5, 2, 1.5},
                                 {"bonsai", 2, 2, 2, 2},
                                 {"cthead", 4.5, 6, 6, 5}};

class VisibilityError : public ::testing::TestWithParam<Bounds> {
protected:
    void SetUp() override {
        const char* data = std::getenv("CHIARO_DATA_DIR");
        volumes_ = data ? std::filesystem::path(data) / "volumes" : "";
        subject_ = find_lit_subject(tested_device(), volumes_, GetParam().name, 64, 64, progress_);
        if (!subject_) GTEST_SKIP() << "skipped: no data";
        metric_.emplace(*subject_, 1, 100, 2048, progress_);
    }
    Harmonics found(VisibilityTraversal traversal) const { return metric_->found_by({.traversal = traversal}); }
    double percent(VisibilityTraversal traversal) const {
        return 100 * metric_->relative_error(found(traversal), metric_->by_rays());
    }

    Progress progress_;
    std::filesystem::path volumes_;
    std::optional<LitSubject> subject_;
    std::optional<VisibilityErrorMetric> metric_;
};

TEST_P(VisibilityError, OfCoefficientsIsWhatWasReached) {
    const double sweep = percent(VisibilityTraversal::sweep), steps = percent(VisibilityTraversal::hierarchical),
                 full = percent(VisibilityTraversal::full);
    EXPECT_LT(sweep, GetParam().sweep);
    EXPECT_LT(percent(VisibilityTraversal::sheared), GetParam().sheared);
    EXPECT_LT(steps, GetParam().hierarchical);
    EXPECT_LT(full, GetParam().full);
    // No worse than the pyramid's, or so small that it does not matter.
    EXPECT_LT(sweep, std::max(steps, 0.5));
    RecordProperty("percent", std::to_string(sweep) + " " + std::to_string(steps) + " " + std::to_string(full));
}

TEST_P(VisibilityError, OfLightIsSmallUnderProbes) {
    const Harmonics sweep = found(VisibilityTraversal::sweep);
    for (const NamedLight& light : judging_lights(volumes_))
        EXPECT_LT(100 * metric_->light_error(sweep, metric_->by_rays(), light.light), GetParam().sweep) << light.name;
}

INSTANTIATE_TEST_SUITE_P(Subjects, VisibilityError, ::testing::ValuesIn(all_bounds),
                         [](const auto& subject) { return std::string(subject.param.name); });

}  // namespace

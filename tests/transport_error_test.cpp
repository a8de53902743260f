// Transport against light's own paths: light in the air of samples and, where there is data, of CT, at 64 cells.
#include <gtest/gtest.h>

#include <cstdlib>

#include "devices.h"
#include "transport_metric.h"

using namespace chiaro;
using namespace chiaro::bench;
using chiaro::testing::tested_device;

namespace {

/// Most of the error of light in the air, of Σ ground truth² and of Σ ground truth; docs/theory/transport.md, and what
/// sixty-four points of 512 paths each leave unsure.
struct Bounds {
    const char* name;
    double albedo, relative, bias;
};
constexpr Bounds all_bounds[] = {{"cornell", 0.8, 0.05, 0.03},  {"cornell", 0.95, 0.05, 0.03},
                                 {"fog", 0.8, 0.01, 0.005},     {"engine", 0.8, 0.02, 0.015},
                                 {"engine", 0.95, 0.02, 0.015}, {"head", 0.8, 0.02, 0.015},
                                 {"head", 0.95, 0.02, 0.015}};

class TransportError : public ::testing::TestWithParam<Bounds> {
protected:
    void SetUp() override {
        const char* data = std::getenv("CHIARO_DATA_DIR");
        const std::filesystem::path volumes = data ? std::filesystem::path(data) / "volumes" : "";
        subject_ = find_scattering_subject(tested_device(), volumes, GetParam().name, progress_);
        if (!subject_) GTEST_SKIP() << "skipped: no data";
    }

    Progress progress_;
    std::optional<ScatteringSubject> subject_;
};

TEST_P(TransportError, OfLightInTheAirIsSmall) {
    const ScatteringCase which{.albedo = GetParam().albedo};
    const TransportErrorMetric::Effort effort{.air = 64, .matter = 0, .paths = 512, .paths_a_pixel = 1};
    const TransportErrorMetric metric(*subject_, which, effort, progress_);
    const MeanRadianceError error = metric.in_air(metric.nodes(64, 16)), once = metric.in_air(metric.nodes(64, 0));
    RecordProperty("relative", std::to_string(error.relative));
    RecordProperty("bias", std::to_string(error.bias));
    EXPECT_LT(error.relative, GetParam().relative) << error.bias << " " << error.noise;
    EXPECT_LT(std::abs(error.bias), GetParam().bias);
    EXPECT_GT(once.relative, 2 * GetParam().relative) << "light that is scattered once is no answer";
}

INSTANTIATE_TEST_SUITE_P(Subjects, TransportError, ::testing::ValuesIn(all_bounds), [](const auto& each) {
    return each.param.name + std::to_string(int(100 * each.param.albedo));
});

}  // namespace

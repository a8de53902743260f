// Ambient occlusion by filtering against rays: how far each model is from the ground truth, on samples and on crops of
// CT.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>

#include "access_error.h"
#include "devices.h"

using namespace chiaro;
using namespace chiaro::bench;
using chiaro::testing::tested_device;

namespace {

/// RMSE of the corrected model as it is by default, and of the published with full N-buffers.
struct Rivals {
    double corrected, paper;
    double ratio() const { return corrected / paper; }
};

class SpaoError : public ::testing::TestWithParam<std::string> {
protected:
    void SetUp() override {
        const char* data = std::getenv("CHIARO_DATA_DIR");
        const std::filesystem::path volumes = data ? std::filesystem::path(data) / "volumes" : "";
        subject_ = find_lit_subject(tested_device(), volumes, GetParam(), 64, 48, progress_);
        if (!subject_) GTEST_SKIP() << "skipped: no data";
    }

    Rivals rivals(ReferenceQuantity quantity) {
        const bool is_obscurance = quantity == ReferenceQuantity::obscurance;
        const CellValues& opacity = subject_->opacity.values;
        const CellMask counts =
            is_obscurance ? CellMask(opacity.grid.size(), 1) : cells_with_normal(opacity, least_normal);
        const CellValues ground_truth = subject_->ground_truth(quantity, 256, progress_);
        const auto rmse = [&](SpaoSettings spao) {
            spao.normal_factor = is_obscurance ? 0 : 1;
            return error_of(subject_->field({.method = Method::spao, .spao = spao}, progress_), ground_truth, counts)
                .rmse;
        };
        return {rmse({}), rmse({.filter = SpaoFilter::nbuffer, .model = SpaoModel::paper})};
    }
    bool has_normals() const {
        const CellMask mask = cells_with_normal(subject_->opacity.values, least_normal);
        return std::find(mask.begin(), mask.end(), 1) != mask.end();
    }

    static constexpr double least_normal = 0.1;
    Progress progress_;
    std::optional<LitSubject> subject_;
};

TEST_P(SpaoError, TheCorrectedModelIsNearerToRaysThanThePapers) {
    const Rivals found = rivals(ReferenceQuantity::obscurance);
    EXPECT_LT(found.ratio(), 0.5) << found.corrected << " " << found.paper;
}

/// Bounds whose geometric mean is one half.
double max_of_papers(const std::string& subject) {
    if (subject == "cornell") return 0.33;
    if (subject == "engine") return 0.50;
    if (subject == "bonsai") return 0.72;
    return 0.52;
}

TEST_P(SpaoError, TheCorrectedModelIsNearerToHemispheresOfRays) {
    if (!has_normals()) GTEST_SKIP() << "no surface";
    const Rivals found = rivals(ReferenceQuantity::ao);
    EXPECT_LT(found.ratio(), max_of_papers(GetParam())) << found.corrected << " " << found.paper;
}

INSTANTIATE_TEST_SUITE_P(Subjects, SpaoError, ::testing::ValuesIn(lit_subjects()),
                         [](const auto& subject) { return subject.param; });

}  // namespace

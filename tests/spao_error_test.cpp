// Ambient occlusion by filtering against rays: how far each model is from the truth, on samples and on crops of CT.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>

#include "access_error.h"

using namespace chiaro;
using namespace chiaro::bench;

namespace {

/// RMSE of the corrected model as it is by default, and of the paper's with full N-buffers.
struct Rivals {
    double corrected, paper;
    double ratio() const { return corrected / paper; }
};

class SpaoError : public ::testing::TestWithParam<std::string> {
protected:
    void SetUp() override {
        const char* data = std::getenv("CHIARO_DATA_DIR");
        subject_ = find_lit_subject(Device::cpu(2), data ? data : "", GetParam(), 64, 48, progress_);
        if (!subject_) GTEST_SKIP() << "skipped: no data";
    }

    Rivals rivals(ReferenceQuantity quantity) {
        const bool is_obscurance = quantity == ReferenceQuantity::obscurance;
        const CellValues& opacity = subject_->opacity.values;
        const CellMask counts =
            is_obscurance ? CellMask(opacity.grid.size(), 1) : cells_with_normal(opacity, least_normal);
        const CellValues truth = subject_->truth(quantity, 256, progress_);
        const auto rmse = [&](SpaoSettings spao) {
            spao.normal_factor = is_obscurance ? 0 : 1;
            return error_of(subject_->field({Method::spao, spao, {}}, progress_), truth, counts).rmse;
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

/// What was reached, and a tenth more: docs/theory/spao.md has the figures.
double most(const std::string& subject, ReferenceQuantity quantity) {
    const bool ao = quantity == ReferenceQuantity::ao;
    if (subject == "cornell") return ao ? 0.30 : 0.25;
    if (subject == "fog") return 0.30;
    if (subject == "engine") return ao ? 0.80 : 0.54;
    if (subject == "bonsai") return ao ? 2.15 : 0.70;  // too dark between many small leaves
    return ao ? 1.00 : 1.20;                           // too dark between bones
}

TEST_P(SpaoError, ObscuranceOfTheCorrectedModelAgainstThePapers) {
    const Rivals found = rivals(ReferenceQuantity::obscurance);
    RecordProperty("ratio", std::to_string(found.ratio()));
    EXPECT_LT(found.ratio(), most(GetParam(), ReferenceQuantity::obscurance)) << found.corrected << " " << found.paper;
}

TEST_P(SpaoError, AmbientOcclusionOfTheCorrectedModelAgainstThePapers) {
    if (!has_normals()) GTEST_SKIP() << "no surface";
    const Rivals found = rivals(ReferenceQuantity::ao);
    RecordProperty("ratio", std::to_string(found.ratio()));
    EXPECT_LT(found.ratio(), most(GetParam(), ReferenceQuantity::ao)) << found.corrected << " " << found.paper;
}

INSTANTIATE_TEST_SUITE_P(Subjects, SpaoError, ::testing::ValuesIn(lit_subjects()),
                         [](const auto& subject) { return subject.param; });

}  // namespace

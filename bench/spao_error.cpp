// Ambient occlusion by filtering against rays: every model and filter, on samples and on crops of CT.
#include <chiaro/text.h>
#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "access_error.h"
#include "rows.h"
#include "turntable.h"

namespace chiaro::bench {
namespace {

/// A subject with its ground truths, each traced once.
class Measured {
public:
    Measured(const Setup& setup, const std::string& name)
        : rays_(setup.quick ? 64 : 1024),
          progress_(setup.progress),
          subject_(find_lit_subject(setup.device, setup.data, name, setup.quick ? 32 : 64, setup.quick ? 24 : 48,
                                    setup.progress)) {
        if (!subject_) return;
        everywhere_ = CellMask(subject_->opacity.values.grid.size(), 1);
        visible_ = visible_cells(subject_->opacity.values);
        with_normal_ = cells_with_normal(subject_->opacity.values, 0.1);
    }

    explicit operator bool() const { return subject_.has_value(); }

    Row row(const std::string& name, ReferenceQuantity quantity, const SpaoSettings& spao) {
        const CellValues found = subject_->field({.method = Method::spao, .spao = spao}, progress_);
        const CellValues& ground_truth = ground_truth_of(quantity);
        const bool is_obscurance = quantity == ReferenceQuantity::obscurance;
        const CellMask& counts = is_obscurance ? everywhere_ : with_normal_;
        if (std::none_of(counts.begin(), counts.end(), [](auto counted) { return counted != 0; }))
            return {name, "RMSE", {}, {}, {}, "skipped: no cell with |n| >= 0.1"};
        const AccessError all = error_of(found, ground_truth, counts);
        const AccessError visible = error_of(found, ground_truth, visible_);
        return {name,
                "RMSE",
                {all.rmse, all.rmse, all.rmse, 1},
                {},
                {},
                fmt::format("{}; bias {:+.4f}; correlation {:.3f}; SSIM {:.3f}; visible cells: RMSE {:.4f}",
                            is_obscurance ? "all cells" : "cells with |n| >= 0.1", all.bias, all.correlation,
                            mean_ssim(found, ground_truth), visible.rmse)};
    }

private:
    const CellValues& ground_truth_of(ReferenceQuantity quantity) {
        const auto known = ground_truths_.find(quantity);
        if (known != ground_truths_.end()) return known->second;
        return ground_truths_.emplace(quantity, subject_->ground_truth(quantity, rays_, progress_)).first->second;
    }

    int rays_;
    Progress& progress_;
    std::optional<LitSubject> subject_;
    CellMask everywhere_, visible_, with_normal_;
    std::map<ReferenceQuantity, CellValues> ground_truths_;
};

}  // namespace

std::vector<Case> spao_error_cases(const Setup& setup) {
    std::vector<Case> cases;
    for (const std::string& subject : lit_subjects()) {
        const Shared<Measured> measured([&setup, subject] { return Measured(setup, subject); });
        for (const auto& [quantity, factor] : {std::pair{ReferenceQuantity::obscurance, 0.0},
                                               {ReferenceQuantity::ao, 1.0},
                                               {ReferenceQuantity::ao_cosine, 1.0}})
            for (const SpaoModel model : {SpaoModel::paper, SpaoModel::thick, SpaoModel::corrected})
                for (const SpaoFilter filter : {SpaoFilter::automatic, SpaoFilter::nbuffer, SpaoFilter::mipmap}) {
                    const std::string name = fmt::format("spao-error/{}/{}/{}-{}", subject, to_text(quantity),
                                                         to_text(model), to_text(filter));
                    const SpaoSettings spao{.filter = filter, .normal_factor = factor, .model = model};
                    const auto measure = [=, quantity = quantity]() -> std::vector<Row> {
                        if (!*measured) return {{name, "RMSE", {}, {}, {}, no_data}};
                        return {(*measured).row(name, quantity, spao)};
                    };
                    cases.push_back({{name}, measure});
                }
    }
    return cases;
}

}  // namespace chiaro::bench

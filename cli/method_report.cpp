#include "method_report.h"

#include <chiaro/sheet.h>
#include <chiaro/text.h>
#include <fmt/format.h>

#include <algorithm>

namespace chiaro::cli {
namespace {

std::string seconds_text(double seconds) {
    return seconds < 1 ? fmt::format("{:.0f} ms", 1000 * seconds) : fmt::format("{:.1f} s", seconds);
}

std::string bytes_text(std::size_t bytes) { return fmt::format("{:.1f} MB", double(bytes) / 1e6); }

}  // namespace

double full_difference(const MethodComparison& comparison) {
    double full = 0;
    for (const MethodImage& image : comparison.images)
        full = std::max(full, difference_scale(image.frame, comparison.reference.frame));
    return full;
}

std::vector<std::string> cells_of(const MethodImage& p) {
    return {to_text(p.method),
            seconds_text(p.light_seconds),
            seconds_text(p.frame_seconds),
            bytes_text(p.light_bytes),
            fmt::format("{:.4f}", p.distance.rmse),
            fmt::format("{:.1f} dB", p.distance.psnr),
            fmt::format("{:.3f}", p.distance.ssim),
            fmt::format("{:+.4f}", p.distance.bias)};
}
std::string reference_sentence(const MethodComparison& c) {
    return fmt::format("reference: {} paths a pixel in {}, noise {:.4f}", c.paths,
                       seconds_text(c.reference.frame_seconds), c.noise);
}

std::string table_of(const MethodComparison& comparison) {
    std::string text;
    const auto line = [&](const auto& cells) {
        std::size_t column = 0;
        for (const auto& cell : cells) text += column++ ? fmt::format("{:>10}", cell) : fmt::format("{:<11}", cell);
        text += '\n';
    };
    line(headings);
    for (const MethodImage& image : comparison.images) line(cells_of(image));
    return text + reference_sentence(comparison) + '\n';
}

Json json_of(const MethodComparison& comparison) {
    Json json;
    json["reference"] = {{"paths", comparison.paths},
                         {"frame_seconds", comparison.reference.frame_seconds},
                         {"noise", comparison.noise}};
    json["methods"] = Json::array();
    for (const MethodImage& p : comparison.images)
        json["methods"].push_back({{"method", to_text(p.method)},
                                   {"light_seconds", p.light_seconds},
                                   {"frame_seconds", p.frame_seconds},
                                   {"light_bytes", p.light_bytes},
                                   {"rmse", p.distance.rmse},
                                   {"psnr", p.distance.psnr},
                                   {"ssim", p.distance.ssim},
                                   {"max", p.distance.max},
                                   {"bias", p.distance.bias}});
    return json;
}

Image sheet_of(const MethodComparison& comparison) {
    const double full = full_difference(comparison);
    const Frame& ground_truth = comparison.reference.frame;
    std::vector<std::vector<SheetCell>> rows(2);
    for (const MethodImage& p : comparison.images) {
        rows[0].push_back({develop(p.frame, {}), std::string(to_text(p.method))});
        rows[1].push_back({difference_image(p.frame, ground_truth, full),
                           fmt::format("rmse {:.4f} ssim {:.3f}", p.distance.rmse, p.distance.ssim)});
    }
    rows[0].push_back({develop(ground_truth, {}), fmt::format("reference noise {:.4f}", comparison.noise)});
    rows[1].push_back({{}, ""});
    return contact_sheet(rows);
}

}  // namespace chiaro::cli

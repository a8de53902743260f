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
        full = std::max(full, difference_scale(image.frame, truth_of(comparison, image)));
    return full;
}

std::vector<std::string> cells_of(const MethodImage& p) {
    return {to_text(p.method),
            seconds_text(p.light_seconds),
            seconds_text(p.frame_seconds),
            bytes_text(p.light_bytes),
            fmt::format("{:.4f}", p.distance.rmse),
            fmt::format("{:.1f} %", 100 * p.block_error),
            fmt::format("{:.1f} dB", p.distance.psnr),
            fmt::format("{:.3f}", p.distance.ssim),
            fmt::format("{:+.4f}", p.distance.bias)};
}
std::vector<std::string> reference_sentences(const MethodComparison& comparison) {
    std::vector<std::string> sentences;
    for (const MethodReference& r : comparison.references)
        sentences.push_back(fmt::format("reference (light {}): {} paths a pixel in {}, noise {:.4f}", r.light, r.paths,
                                        seconds_text(r.image.frame_seconds), r.noise));
    return sentences;
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
    for (const std::string& sentence : reference_sentences(comparison)) text += sentence + '\n';
    return text;
}

Json json_of(const MethodComparison& comparison) {
    Json json;
    json["references"] = Json::array();
    for (const MethodReference& r : comparison.references)
        json["references"].push_back(
            {{"light", r.light}, {"paths", r.paths}, {"frame_seconds", r.image.frame_seconds}, {"noise", r.noise}});
    json["methods"] = Json::array();
    for (const MethodImage& p : comparison.images)
        json["methods"].push_back({{"method", to_text(p.method)},
                                   {"reference", p.reference},
                                   {"light_seconds", p.light_seconds},
                                   {"frame_seconds", p.frame_seconds},
                                   {"light_bytes", p.light_bytes},
                                   {"rmse", p.distance.rmse},
                                   {"block_error", p.block_error},
                                   {"psnr", p.distance.psnr},
                                   {"ssim", p.distance.ssim},
                                   {"max", p.distance.max},
                                   {"bias", p.distance.bias}});
    return json;
}

Image sheet_of(const MethodComparison& comparison) {
    const double full = full_difference(comparison);
    std::vector<std::vector<SheetCell>> rows(2);
    for (const MethodImage& p : comparison.images) {
        rows[0].push_back({develop(p.frame, {}), std::string(to_text(p.method))});
        rows[1].push_back({difference_image(p.frame, truth_of(comparison, p), full),
                           fmt::format("rmse {:.4f} ssim {:.3f}", p.distance.rmse, p.distance.ssim)});
    }
    for (const MethodReference& r : comparison.references) {
        rows[0].push_back({develop(r.image.frame, {}), fmt::format("reference noise {:.4f}", r.noise)});
        rows[1].push_back({{}, r.light});
    }
    return contact_sheet(rows);
}

}  // namespace chiaro::cli

#include <chiaro/error.h>
#include <chiaro/sheet.h>

#include <algorithm>
#include <cmath>

#include "core/srgb.h"
#include "image/caption.h"

namespace chiaro {
namespace {

constexpr int gap = 8;
constexpr std::uint8_t paper = 32;

double luminance_difference(const Frame& a, const Frame& b, std::size_t pixel) {
    return luminance(&a.rgba[4 * pixel]) - luminance(&b.rgba[4 * pixel]);
}

void check_same_size(const Frame& a, const Frame& b) {
    if (a.width != b.width || a.height != b.height)
        throw Error(ErrorCode::input, "pictures of different sizes cannot be compared");
}

void paste(Image& sheet, const Image& image, int x, int y) {
    const int channels = image.has_alpha ? 4 : 3;
    for (int j = 0; j < image.height; ++j)
        for (int i = 0; i < image.width; ++i) {
            const std::uint8_t* from = image.pixels.data() + channels * (std::size_t(j) * image.width + i);
            std::uint8_t* to = sheet.pixels.data() + 3 * (std::size_t(y + j) * sheet.width + x + i);
            const int alpha = image.has_alpha ? from[3] : 255;
            for (int c = 0; c < 3; ++c) to[c] = std::uint8_t((from[c] * alpha + paper * (255 - alpha) + 127) / 255);
        }
}

}  // namespace

Image difference_image(const Frame& frame, const Frame& ground_truth, double full) {
    check_same_size(frame, ground_truth);
    Image image{frame.width, frame.height, false, {}};
    image.pixels.resize(frame.rgba.size() / 4 * 3);
    for (std::size_t p = 0; p < frame.rgba.size() / 4; ++p) {
        const double share = std::clamp(luminance_difference(frame, ground_truth, p) / full, -1.0, 1.0);
        const double strong[3] = {share > 0 ? 0.70 : 0.02, share > 0 ? 0.01 : 0.19, share > 0 ? 0.07 : 0.58};
        for (int c = 0; c < 3; ++c)
            image.pixels[3 * p + c] = std::uint8_t(255 * (1 + std::abs(share) * (strong[c] - 1)) + 0.5);
    }
    return image;
}

double difference_scale(const Frame& frame, const Frame& ground_truth, double share) {
    check_same_size(frame, ground_truth);
    std::vector<double> sizes(frame.rgba.size() / 4);
    for (std::size_t p = 0; p < sizes.size(); ++p) sizes[p] = std::abs(luminance_difference(frame, ground_truth, p));
    const auto at = sizes.begin() + std::ptrdiff_t(double(sizes.size() - 1) * (1 - share));
    std::nth_element(sizes.begin(), at, sizes.end());
    const double least = std::max(*at, 1e-6), decade = std::pow(10, std::floor(std::log10(least)));
    for (double step : {1.0, 2.0, 5.0})
        if (least <= step * decade * (1 + 1e-9)) return step * decade;
    return 10 * decade;
}

Image contact_sheet(const std::vector<std::vector<SheetCell>>& rows) {
    int width = 0, height = 0;
    std::size_t columns = 0;
    for (const auto& row : rows) {
        columns = std::max(columns, row.size());
        for (const SheetCell& cell : row) {
            if (cell.image.width == 0) continue;
            if (width && (width != cell.image.width || height != cell.image.height))
                throw Error(ErrorCode::input, "a contact sheet takes pictures of one size");
            width = cell.image.width, height = cell.image.height;
        }
    }
    const int step_x = width + gap, step_y = height + caption_height + 2 * gap;
    Image sheet{gap + int(columns) * step_x, gap + int(rows.size()) * step_y, false, {}};
    sheet.pixels.assign(std::size_t(3) * sheet.width * sheet.height, paper);
    for (std::size_t j = 0; j < rows.size(); ++j)
        for (std::size_t i = 0; i < rows[j].size(); ++i) {
            const int x = gap + int(i) * step_x, y = gap + int(j) * step_y;
            paste(sheet, rows[j][i].image, x, y);
            const auto letters = std::size_t(std::max(width / caption_width, 0));
            write_caption(sheet, x, y + height + gap / 2, rows[j][i].caption.substr(0, letters));
        }
    return sheet;
}

}  // namespace chiaro

// What `chiaro compare VOLUME --methods` tells: a table, and a sheet of pictures.
#pragma once
#include <chiaro/comparison.h>

#include <string>
#include <vector>

#include "json.h"

namespace chiaro::cli {

/// The figures of one method, as people read them, in the order of `headings`.
inline constexpr const char* headings[] = {"method", "light", "frame", "memory", "RMSE", "PSNR", "SSIM", "bias"};
std::vector<std::string> cells_of(const MethodImage& image);
std::string reference_sentence(const MethodComparison& comparison);
/// The difference that is shown in full colour, one for all methods: the largest that any of them needs.
double full_difference(const MethodComparison& comparison);

/// One line for each method, the reference last.
std::string table_of(const MethodComparison& comparison);

/// {"reference": {...}, "methods": [{"method", "light_seconds", "frame_seconds", "light_bytes", "rmse", ...}]}
Json json_of(const MethodComparison& comparison);

/// The pictures and, below them, where each is brighter or darker than the reference, all to one scale.
Image sheet_of(const MethodComparison& comparison);

}  // namespace chiaro::cli

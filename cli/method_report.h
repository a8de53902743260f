// What `chiaro compare VOLUME --methods` tells: a table, and a sheet of pictures.
#pragma once
#include <chiaro/comparison.h>

#include <string>
#include <vector>

#include "json.h"

namespace chiaro::cli {

/// The figures of one method, as people read them, in the order of `headings`.
inline constexpr const char* headings[] = {"method", "light", "frame", "memory", "RMSE",
                                           "8 x 8",  "PSNR",  "SSIM",  "bias"};
std::vector<std::string> cells_of(const MethodImage& image);
/// A line for each reference.
std::vector<std::string> reference_sentences(const MethodComparison& comparison);
/// The difference that is shown in full colour, one for all methods: the largest that any of them needs.
double full_difference(const MethodComparison& comparison);
/// The picture that a method is judged by.
inline const Frame& truth_of(const MethodComparison& comparison, const MethodImage& image) {
    return comparison.references[image.reference].image.frame;
}

/// One line for each method, the references last.
std::string table_of(const MethodComparison& comparison);

/// {"references": [{"light", "paths", "frame_seconds", "noise"}], "methods": [{"method", "reference", "light_seconds",
/// "frame_seconds", "light_bytes", "rmse", ...}]}; "reference" of a method is its place in the list.
Json json_of(const MethodComparison& comparison);

/// The pictures and, below them, where each is brighter or darker than the reference, all to one scale.
Image sheet_of(const MethodComparison& comparison);

}  // namespace chiaro::cli

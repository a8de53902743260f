// "Did you mean": the nearest of the words that would have been right.
#pragma once
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace chiaro {

/// Insertions, deletions, substitutions and swaps of neighbours that turn `a` into `b`, ignoring the case of ASCII
/// letters (Damerau-Levenshtein distance, optimal string alignment). Cost |a| |b|.
int edit_distance(std::string_view a, std::string_view b);

/// The candidate nearest to `word` (the first of equals; of the first 10000), unless all differ in more than a third of
/// its letters. `word` of more than 64 bytes has none.
std::optional<std::string> nearest_word(std::string_view word, std::span<const std::string> candidates);

/// "; did you mean 'X'?" to append to a message, or nothing.
std::string did_you_mean(std::string_view word, std::span<const std::string> candidates);

/// The same for a file that is not there: the nearest name in its folder (of the first 10000).
std::string did_you_mean_file(const std::filesystem::path& missing);

}  // namespace chiaro

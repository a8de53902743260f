#include "core/did_you_mean.h"

#include "core/text.h"

#include <algorithm>
#include <vector>

namespace chiaro {
namespace {

constexpr std::size_t max_candidates = 10000;

char lower(char c) { return c >= 'A' && c <= 'Z' ? char(c - 'A' + 'a') : c; }

}  // namespace

int edit_distance(std::string_view a, std::string_view b) {
    // Three rows of the table of distances between prefixes: the swap looks two rows back.
    std::vector<int> before(b.size() + 1), above(b.size() + 1), row(b.size() + 1);
    for (std::size_t j = 0; j <= b.size(); ++j) above[j] = int(j);
    for (std::size_t i = 1; i <= a.size(); ++i) {
        row[0] = int(i);
        for (std::size_t j = 1; j <= b.size(); ++j) {
            const int substituted = above[j - 1] + (lower(a[i - 1]) != lower(b[j - 1]));
            row[j] = std::min({above[j] + 1, row[j - 1] + 1, substituted});
            if (i > 1 && j > 1 && lower(a[i - 1]) == lower(b[j - 2]) && lower(a[i - 2]) == lower(b[j - 1]))
                row[j] = std::min(row[j], before[j - 2] + 1);
        }
        before.swap(above);
        above.swap(row);
    }
    return above[b.size()];
}

std::optional<std::string> nearest_word(std::string_view word, std::span<const std::string> candidates) {
    if (word.size() > 64) return std::nullopt;  // no name is that long; the cost is bounded
    const std::string* best = nullptr;
    int best_distance = std::max(1, int(word.size()) / 3) + 1;
    for (const std::string& candidate : candidates.first(std::min(candidates.size(), max_candidates))) {
        // Each letter more or less is an edit: a long name from a file is not looked at.
        if (std::max(word.size(), candidate.size()) - std::min(word.size(), candidate.size()) >=
            std::size_t(best_distance))
            continue;
        const int distance = edit_distance(word, candidate);
        if (distance < best_distance) {
            best = &candidate;
            best_distance = distance;
        }
    }
    return best ? std::optional(*best) : std::nullopt;
}

std::string did_you_mean(std::string_view word, std::span<const std::string> candidates) {
    const auto nearest = nearest_word(word, candidates);
    return nearest ? "; did you mean '" + *nearest + "'?" : "";
}

std::string did_you_mean_file(const std::filesystem::path& missing) {
    std::error_code unreadable;
    std::vector<std::string> names;
    const std::filesystem::path folder = missing.has_parent_path() ? missing.parent_path() : ".";
    for (std::filesystem::directory_iterator i(folder, unreadable), end;
         !unreadable && i != end && names.size() < max_candidates; i.increment(unreadable))
        if (i->path().filename() != missing.filename()) names.push_back(i->path().filename());
    std::sort(names.begin(), names.end());
    return one_line(did_you_mean(missing.filename().string(), names));
}

}  // namespace chiaro

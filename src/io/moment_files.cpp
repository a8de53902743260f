#include "io/moment_files.h"

#include <chiaro/error.h>
#include <fmt/format.h>

#include <algorithm>
#include <charconv>

#include "core/text.h"

namespace chiaro {
namespace fs = std::filesystem;
namespace {

/// A name with one {t}, or {t:03} for three digits or more, in one of its parts: folders or the file.
struct Pattern {
    fs::path folder;            ///< that the part lies in
    std::string before, after;  ///< the number, within the part
    fs::path rest;              ///< behind the part
    std::size_t digits = 0;     ///< at least; 0: as many as the number has
};

std::optional<Pattern> pattern_of(const std::string& name) {
    const std::size_t open = name.find("{t"), close = name.find('}', open);
    if (open == name.npos || close == name.npos || name.find("{t", open + 1) != name.npos) return {};
    Pattern pattern;
    const std::string inside = name.substr(open + 2, close - open - 2);
    if (!inside.empty()) {
        if (inside.size() != 3 || !inside.starts_with(":0") || inside[2] < '1' || inside[2] > '9') return {};
        pattern.digits = std::size_t(inside[2] - '0');
    }
    const std::size_t slash = name.rfind('/', open), begin = slash == name.npos ? 0 : slash + 1;
    const std::size_t end = std::min(name.find('/', close), name.size());
    pattern.folder = slash == name.npos ? "." : name.substr(0, begin);
    pattern.before = name.substr(begin, open - begin);
    pattern.after = name.substr(close + 1, end - close - 1);
    pattern.rest = end < name.size() ? name.substr(end + 1) : "";
    return pattern;
}

struct MomentFile {
    std::int64_t number;
    std::string name;
};

std::optional<std::int64_t> number_in(const std::string& name, const Pattern& pattern) {
    const std::size_t around = pattern.before.size() + pattern.after.size();
    if (name.size() <= around || !name.starts_with(pattern.before) || !name.ends_with(pattern.after)) return {};
    const std::string_view digits = std::string_view(name).substr(pattern.before.size(), name.size() - around);
    std::int64_t number = 0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), number);
    if (error != std::errc() || end != digits.data() + digits.size() || digits[0] == '-') return {};
    const std::size_t shortest = fmt::format("{}", number).size();
    return digits.size() == std::max(pattern.digits, shortest) ? std::optional(number) : std::nullopt;
}

std::vector<MomentFile> files_of(const Pattern& pattern) {
    std::vector<MomentFile> files;
    std::error_code error;
    for (const auto& entry : fs::directory_iterator(pattern.folder, error))
        if (const auto number = number_in(entry.path().filename().string(), pattern))
            if (const fs::path file = pattern.rest.empty() ? entry.path() : entry.path() / pattern.rest;
                fs::exists(file, error))
                files.push_back({*number, file.string()});
    std::sort(files.begin(), files.end(), [](auto& a, auto& b) { return a.number < b.number; });
    return files;
}

/// Numbers that are missing between those of files: "3, 7 to 9".
std::string gaps_between(const std::vector<MomentFile>& files) {
    std::string gaps;
    for (std::size_t i = 1; i < files.size(); ++i) {
        const std::int64_t first = files[i - 1].number + 1, last = files[i].number - 1;
        if (first > last) continue;
        if (gaps.size() > 80) return gaps + ", ...";
        gaps += gaps.empty() ? "" : ", ";
        gaps += first == last ? fmt::format("{}", first) : fmt::format("{} to {}", first, last);
    }
    return gaps;
}

}  // namespace

std::vector<std::string> moment_files(const std::string& name) {
    std::vector<std::string> names;
    if (const auto pattern = pattern_of(name))
        for (const MomentFile& file : files_of(*pattern)) names.push_back(file.name);
    return names;
}

bool is_moment_pattern(const std::string& name) {
    std::error_code error;
    return pattern_of(name) && !fs::exists(name, error);
}

Volume read_moment_file(const std::string& pattern, const ReadOptions& options,
                        const std::function<Volume(const std::string& file, const ReadOptions&)>& read) {
    const auto files = files_of(*pattern_of(pattern));
    const auto refuse = [&](const std::string& sentence) {
        throw Error(ErrorCode::input, fmt::format("cannot read '{}': {}", one_line(pattern), sentence));
    };
    if (files.empty()) refuse("no file has such a name with a number in the place of {t}");
    const std::size_t count = files.size();
    if (std::size_t(options.time) >= count)
        refuse(
            fmt::format("there are {} files, moments 0 to {}, and none of number {}", count, count - 1, options.time));
    ReadOptions one = options;
    one.time = 0;
    const MomentFile& file = files[std::size_t(options.time)];
    Volume volume = read(file.name, one);
    if (volume.moments.count > 1) refuse("each of its files holds several moments: name one of them");
    volume.moments = {.count = int(count), .shown = options.time, .times = {}, .unit = "file"};
    for (const MomentFile& each : files) volume.moments.times.push_back(double(each.number));
    if (const std::string gaps = gaps_between(files); !gaps.empty())
        volume.notes.push_back(
            fmt::format("the files of number {} are missing; moments are counted without them", gaps));
    return volume;
}

}  // namespace chiaro

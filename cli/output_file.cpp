#include "output_file.h"

#include <chiaro/error.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <span>
#include <vector>

#include "core/atomic_file.h"
#include "core/did_you_mean.h"

namespace chiaro::cli {
namespace fs = std::filesystem;

void check_folder_of(const fs::path& path) {
    const fs::path folder = path.has_parent_path() ? path.parent_path() : ".";
    std::error_code ignored;
    if (!fs::is_directory(folder, ignored))
        throw Error(ErrorCode::output, fmt::format("{}: there is no folder {}", path.string(), folder.string()));
    if (access(folder.c_str(), W_OK) != 0)
        throw Error(ErrorCode::output,
                    fmt::format("{}: the folder {} cannot be written to", path.string(), folder.string()));
}

void check_output(const fs::path& path, std::initializer_list<std::string_view> endings) {
    if (path.empty()) throw Error(ErrorCode::usage, "-o FILE is missing: it names the file to write");
    const std::string ending = path.extension();
    if (std::find(endings.begin(), endings.end(), ending) == endings.end())
        throw Error(ErrorCode::usage,
                    fmt::format("{}: the name must end in {}{}", path.string(), fmt::join(endings, " or "),
                                did_you_mean(ending, std::vector<std::string>(endings.begin(), endings.end()))));
    check_folder_of(path);
    std::error_code ignored;
    if (fs::is_directory(path, ignored)) throw Error(ErrorCode::output, fmt::format("{}: is a folder", path.string()));
}

void write_text(const fs::path& path, std::string_view text) {
    AtomicFile file(path);
    file.write(std::as_bytes(std::span(text)));
    file.commit();
}

FramePattern::FramePattern(const std::string& text) {
    const std::size_t open = text.find('{'), close = text.find('}');
    before_ = text.substr(0, open);
    if (open == text.npos && close == text.npos) return;
    has_placeholder_ = true;
    const auto refuse = [&] {
        throw Error(ErrorCode::usage,
                    fmt::format("{}: the only placeholders are {{frame}} and {{t}} or, with digits, {{frame:03}} and "
                                "{{t:03}}, one of them",
                                text));
    };
    if (open == text.npos || close == text.npos || close < open) refuse();
    const std::string inside = text.substr(open + 1, close - open - 1), name = inside.substr(0, inside.find(':'));
    after_ = text.substr(close + 1);
    is_of_moments_ = name == "t";
    if (const std::string digits = inside.substr(name.size()); !digits.empty()) {
        if (digits.size() != 3 || !digits.starts_with(":0") || !std::isdigit(static_cast<unsigned char>(digits[2])))
            refuse();
        digits_ = std::size_t(digits[2] - '0');
    }
    if ((name != "frame" && name != "t") || after_.find_first_of("{}") != after_.npos) refuse();
}

fs::path FramePattern::operator()(int frame) const {
    if (!has_placeholder_) return before_;
    return fmt::format("{}{:0{}}{}", before_, frame, digits_, after_);
}

}  // namespace chiaro::cli

// Files that the tool writes: checked before long work, written whole or not at all.
#pragma once
#include <filesystem>
#include <initializer_list>
#include <string>
#include <string_view>

namespace chiaro::cli {

/// Throws Error{usage} unless the path has one of the endings, Error{output} unless its folder can take a file.
void check_output(const std::filesystem::path& path, std::initializer_list<std::string_view> endings);
/// The latter alone.
void check_folder_of(const std::filesystem::path& path);

/// Throws Error{output}.
void write_text(const std::filesystem::path& path, std::string_view text);

/// A name with at most one placeholder for the number of a frame: {frame}, or {frame:03} for three digits or more;
/// or {t} for that of a moment, likewise.
class FramePattern {
public:
    /// Throws Error{usage} for any other brace.
    explicit FramePattern(const std::string& text);

    bool has_placeholder() const { return has_placeholder_; }
    bool is_of_moments() const { return is_of_moments_; }
    std::filesystem::path operator()(int frame) const;

private:
    std::string before_, after_;
    std::size_t digits_ = 1;
    bool has_placeholder_ = false, is_of_moments_ = false;
};

}  // namespace chiaro::cli

// Films by the program ffmpeg, where it is installed.
#pragma once
#include <chiaro/export.h>
#include <chiaro/image.h>

#include <filesystem>
#include <memory>

namespace chiaro {

/// Whether the program is in PATH.
CHIARO_EXPORT bool has_ffmpeg();

/// Writes pictures of one size as a film; the path's ending says how: .mp4, .mkv or .webm. The file appears when it is
/// finished, or not at all.
class VideoWriter {
public:
    /// Throws Error{usage} for another ending, Error{output} where ffmpeg is missing or cannot be started.
    CHIARO_EXPORT VideoWriter(const std::filesystem::path& path, int width, int height, double fps);
    CHIARO_EXPORT ~VideoWriter();
    VideoWriter(const VideoWriter&) = delete;
    VideoWriter& operator=(const VideoWriter&) = delete;

    /// Throws Error{output} with what ffmpeg said, Error{usage} for a picture of another size.
    CHIARO_EXPORT void write(const Image& image);
    /// Throws Error{output}.
    CHIARO_EXPORT void finish();

private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace chiaro

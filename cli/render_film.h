// chiaro render --film: keyframes to pictures, or to a film.
#pragma once
#include <string>

#include "common.h"

namespace chiaro::cli {

/// Writes each frame (a name with {frame}; whole ones of the same scenes are kept) or a film (.mp4, .mkv, .webm).
/// Throws Error{usage} for a name that is neither.
void render_film(const std::string& film, const std::string& data, const std::string& output,
                 const CommonOptions& common);

}  // namespace chiaro::cli

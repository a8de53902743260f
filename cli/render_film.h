// chiaro render --film: keyframes to pictures, or to a film.
#pragma once
#include <chiaro/session.h>

#include <string>

#include "common.h"

namespace chiaro::cli {

/// Writes each frame (a name with {frame}; whole ones of the same scenes are kept) or a film (.mp4, .mkv, .webm).
/// A volume that does not fit is read by bricks, but where keys are of several moments. Throws Error{usage} for a name
/// that is neither.
void render_film(const std::string& film, const std::string& data, const std::string& output,
                 const PagingSettings& paging, const CommonOptions& common);

}  // namespace chiaro::cli

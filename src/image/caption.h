// Small words in a picture.
#pragma once
#include <chiaro/image.h>

#include <string_view>

namespace chiaro {

/// A letter with the gap to its neighbours, in pixels.
inline constexpr int caption_width = 12, caption_height = 18;

/// Writes a line of light letters, 10 x 14 pixels each, with its upper left corner at (x, y); what lies beyond the
/// image is left out. Knows a-z (A-Z as these), 0-9 and . - + %; anything else is a blank.
void write_caption(Image& image, int x, int y, std::string_view text);

}  // namespace chiaro

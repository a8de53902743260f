// The marks of a scene file.
#pragma once
#include <chiaro/scene.h>

#include "render/scene_keys.h"

namespace chiaro {

/// Throws Error{input} that names the mark and what is wrong with it.
std::vector<Mark> read_marks(const ReadJson& root);
void write_marks(const std::vector<Mark>& marks, Json& root);

}  // namespace chiaro

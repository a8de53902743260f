// What a scene file changes of its labels' looks.
#pragma once
#include <chiaro/scene.h>

#include "render/scene_keys.h"

namespace chiaro {

/// Throws Error{input} that names the change and what is wrong with it.
std::vector<LabelChange> read_label_changes(const ReadJson& root);
void write_label_changes(const std::vector<LabelChange>& changes, Json& root);

}  // namespace chiaro

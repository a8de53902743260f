// Several channels as one medium: extinctions add, colours are means weighted by extinction.
#pragma once
#include "classify/medium.h"

namespace chiaro {

/// Of one or more on one grid, in one stored type; in any order the same bits. `labels`: that lie in them, or null.
Medium mixed(const Device& device, std::vector<std::shared_ptr<const Medium::Data>> channels, const Shape& shape,
             const Progress& progress, std::shared_ptr<const LabelBricks> labels = nullptr);

}  // namespace chiaro

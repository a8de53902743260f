// Voxels as they lie in a file, read where they are needed.
#pragma once
#include <chiaro/brick_source.h>

#include "io/wire.h"

namespace chiaro {

/// `header`: of the file's own type, which need not be the source's. Throws Error{input} where the file cannot be
/// opened; `read` where it ends too early.
std::shared_ptr<const BrickSource> open_file_source(const Volume& header, const VoxelsInFile& voxels);

}  // namespace chiaro

// Bricks of what is kept in chunks, which the isolated programs decode.
#pragma once
#include <chiaro/brick_source.h>

#include "io/chunk_server.h"

namespace chiaro {

/// As source_of_chunks. `finish` adds to the header what is known beside the file. Throws as decode_isolated, for what
/// is not kept in chunks, too.
std::shared_ptr<const BrickSource> open_chunk_source(const DecodeRequest& request, const ReadOptions& options,
                                                     const std::function<void(Volume&)>& finish);

}  // namespace chiaro

// Bricks of what is kept in chunks, which the isolated programs decode.
#pragma once
#include <chiaro/brick_source.h>

#include "io/chunk_server.h"

namespace chiaro {

/// The file's levels, and coarser ones of every second voxel of its coarsest and so on. What was decoded last is kept,
/// up to 256 MiB. `finish` adds to the header what is known beside the file. Throws as decode_isolated, for what is not
/// kept in chunks, too; `read` as ChunkServer::decode.
std::shared_ptr<const BrickSource> open_chunk_source(const DecodeRequest& request, const ReadOptions& options,
                                                     const std::function<void(Volume&)>& finish);

}  // namespace chiaro

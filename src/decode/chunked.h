// Volumes that are kept in chunks: boxes of voxels, each of which is decoded without the others.
#pragma once
#include "decode/output.h"

#include <span>
#include <vector>

namespace chiaro::decode {

class ChunkedFile {
public:
    virtual ~ChunkedFile() = default;
    /// All of level 0 but its voxels.
    const Volume& header() const { return header_; }
    const std::vector<ChunkedLevel>& levels() const { return levels_; }
    /// Fills `to` with one component of a whole chunk, x fastest, in the machine's byte order; whatever lies beyond the
    /// border of the array means nothing. False where the chunk was never written: `to` holds the fill value then.
    /// Throws Error{input}.
    virtual bool read(int level, const std::array<int, 3>& chunk, int component, std::span<std::byte> to) = 0;

protected:
    Volume header_;
    std::vector<ChunkedLevel> levels_;
};

/// An edge of as many chunks side by side as make 32 voxels, or reach the far border: what is worth to be asked for.
int grown_edge(int edge, int border);

/// The whole of level 0, with its voxels in `output`'s memory file.
Volume read_whole(ChunkedFile& file, Output& output);

/// Tells header and levels, then answers each request for a chunk, with component 0 in the memory file, until there are
/// no more. A chunk that cannot be read is one sentence; each may take `cpu_seconds`.
void serve(ChunkedFile& file, unsigned cpu_seconds, Output& output);

}  // namespace chiaro::decode

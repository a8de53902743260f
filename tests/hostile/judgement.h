// What became of a file.
#pragma once
#include "hostile/seeds.h"

#include <chiaro/volume.h>

#include <cstdint>
#include <filesystem>

namespace hostile {

struct Judgement {
    bool is_read = false;
    std::uint64_t contents = 0;  ///< of what was read: two equal ones mean equal voxels, points, pixels...
    std::string sentence;        ///< of a refusal
    bool is_doubted = false;     ///< read, with a note that the file may be cut
    std::uint64_t notes = 0;     ///< what was told of the file: two equal ones mean equal notes
    std::string fault;           ///< what is wrong with the refusal itself: its code, its form; else ""
};

/// Reads volumes in some way: through the helper program, or here. A program of its own may end without an exception.
using VolumeReader = std::function<chiaro::Volume(const std::string& path)>;

/// What a volume may take: `others`, but little where it is sparse, as a bit that is flipped makes its box as large as
/// is permitted.
std::uint64_t permitted_bytes(const std::string& path, std::uint64_t others);

/// Does what the program would do next with what was read.
using VolumeUser = std::function<void(chiaro::Volume&&)>;

/// Writes `bytes` as the seed's file, and those beside it, into `folder`, reads it as the program would, and judges: a
/// refusal must be Error{input} in one line that names the file.
Judgement judgement_of(const Seed& seed, const std::string& bytes, const std::filesystem::path& folder,
                       const VolumeReader& read_volume, const VolumeUser& use = {});

}  // namespace hostile

// The voxels of the simple formats: one or more files, plain, deflated or text.
#pragma once
#include "decode/byte_source.h"
#include "decode/output.h"

#include <vector>

namespace chiaro::decode {

enum class Encoding { raw, deflated, text };

/// Runs of bytes of one moment after the other, again and again.
struct MomentAxis {
    std::uint64_t count = 1, wanted = 0;
    std::uint64_t run = 0;  ///< bytes of one moment before the next one's begin
};

/// Where and how voxels lie. With several files each holds an equal share.
struct Payload {
    std::vector<std::filesystem::path> files;
    std::uint64_t offset = 0;  ///< bytes of the file before the (compressed) data
    std::uint64_t skip = 0;    ///< bytes of the inflated data before the first voxel
    Encoding encoding = Encoding::raw;
    bool big_endian = false;
    std::uint64_t volumes = 1;     ///< in the data
    MomentAxis moments{};          ///< along which these are ordered, where there are several
    bool more_may_follow = false;  ///< behind the voxels, and means nothing
};

/// Allocates and fills the voxels of `volume`, whose shape is set. Throws Error{input} before it allocates anything
/// when the files cannot hold as much as the header states, and when they turn out to hold less.
void read_voxels(const Payload& payload, Volume& volume, Output& output);

/// How text goes on behind the last number that was asked for.
struct TextEnd {
    bool behind_digit = false;  ///< not at all: the number may have had more digits
    bool has_more = false;      ///< with something else than blanks
};

/// Fill voxels that are allocated, from text or from bytes. Throw Error{input} where the source ends before.
TextEnd fill_from_text(ByteSource& source, VoxelType type, std::span<std::byte> to, Output& output,
                       const MomentAxis& moments = {});
void fill_from_bytes(ByteSource& source, bool big_endian, VoxelType type, std::span<std::byte> to, Output& output);

/// Throws Error{input} where a header states `bytes` of voxels and the file can hold no more than `most`.
void check_capacity(std::uint64_t bytes, std::uint64_t most);

/// Swaps the bytes of every value in place: voxels are kept in the machine's (little-endian) order.
void swap_bytes(std::span<std::byte> bytes, std::size_t value_size);

/// How the library names what it was handed on standard input.
constexpr const char* standard_input = "/proc/self/fd/0";

/// The place of a detached data file. Throws Error{input} for absolute paths, for `..`, and for links that lead out of
/// the header's folder: a header from elsewhere must not read other files of this machine.
std::filesystem::path confined(const std::filesystem::path& header, const std::string& name);

/// A list of files named by a printf-like pattern with one %d, from `first` to `last` by `step`.
std::vector<std::string> expand_pattern(const std::string& pattern, std::int64_t first, std::int64_t last,
                                        std::int64_t step);

}  // namespace chiaro::decode

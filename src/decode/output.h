// Where a decoder puts what it found: voxels into the memory file, words into the message pipe.
#pragma once
#include <chiaro/error.h>
#include <chiaro/volume.h>

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "io/wire.h"

namespace chiaro::decode {

/// Refuses the file: `sentence` continues "cannot read 'name': ".
[[noreturn]] inline void refuse(const std::string& sentence) { throw Error(ErrorCode::input, sentence); }

/// More voxels than are permitted.
struct TooLarge : Error {
    using Error::Error;
};

inline constexpr const char* not_in_place = "its voxels do not lie in one file as they are";
inline constexpr const char* not_in_chunks = "its voxels are not kept in chunks";

class Output {
public:
    /// With room for no bytes voxels are not asked for, but where they lie.
    explicit Output(std::uint64_t max_bytes, int moment = 0) : max_bytes_(max_bytes), moment_(moment) {}

    /// Says that the file holds `count` moments, and which of them is wanted, from 0: that one's number.
    /// Throws Error{input} where there is none of that number.
    std::uint64_t choose_moment(std::uint64_t count, Volume& volume) const;

    /// For a file whose voxels become a part of others': in this program's own memory, and nothing is told.
    Output aside() const {
        Output other(max_bytes_);
        other.is_aside_ = true;
        return other;
    }

    bool asks_for_place() const { return max_bytes_ == 0; }
    /// Whether voxels that lie in one file as they are may stay there, for the library to read.
    bool takes_place() const { return !is_aside_; }
    /// Told with the header, in the place of voxels. Throws as allocate.
    void lie_at(const Volume& volume, VoxelsInFile place);
    const std::optional<VoxelsInFile>& place() const { return place_; }
    /// Gives `volume` its voxels, mapped from the memory file. Throws Error{input} for a header that makes no sense or
    /// takes more than the permitted bytes; the caller has already made sure that its file can hold that much.
    void allocate(Volume& volume);
    void progress(double fraction);
    /// Says that bytes come, of which nobody knows how many.
    void go_on();
    /// Says which of many files is being worked on, so that a crash can be pinned on it.
    void at(const std::string& file);
    void succeed(const Volume& volume);
    /// What is served by chunks; then that a chunk lies in the memory file.
    void succeed(const Volume& header, const std::vector<ChunkedLevel>& levels);
    void chunk(bool was_written);
    void fail(const std::string& sentence, bool is_too_large = false);

private:
    /// Of a header that makes sense, the bytes of its voxels, which are permitted or not asked for.
    std::uint64_t checked_room(const Volume& volume) const;
    bool may_report();

    std::uint64_t max_bytes_;
    int moment_;
    bool is_aside_ = false;
    std::optional<VoxelsInFile> place_;
    std::chrono::steady_clock::time_point last_report_{};
};

/// Whether values of a voxel of which nothing is said are colours: three or four bytes.
inline bool are_colors_untold(const Volume& volume) {
    return volume.type == VoxelType::u8 && (volume.components == 3 || volume.components == 4);
}

/// Moments that are `step` apart, where that is a step; and not of so many that they would fill a page.
void set_even_times(Moments& moments, double first, double step, const std::string& unit);

}  // namespace chiaro::decode

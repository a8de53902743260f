// chiaro-decode: decodes one volume in a process of its own, so that a damaged or hostile file harms nothing else.
//
//   chiaro-decode FORMAT PATH PART MAX_BYTES CPU_SECONDS MOMENT [serve]
//
// Of voxels that lie in one file as they are it tells the place; with 0 for MAX_BYTES it refuses all others. With
// `serve` it decodes chunks, one for each line of its standard input, each within CPU_SECONDS.
//
// Started by the library (io/helper.cpp), which hands over a memory file for the voxels and a pipe for messages
// (io/wire.h). Formats that need a library have a program each, chiaro-decode-dicom and so on, which this one becomes:
// loading GDCM alone takes longer than reading a small volume.
#include "decode/limits.h"
#include "decode/output.h"
#include "decode/readers.h"

#include <fcntl.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <exception>
#include <string>

#include "core/truncated_file.h"
#include "io/wire.h"

namespace {

using namespace chiaro;

constexpr const char* missing_vdb =
    ": it is built where libopenvdb is found, packages have it as chiaro-openvdb, and the Python package has none";

/// Goes on as the program for one format, with the same arguments and open files. Returns only where there is none.
void become_program_for(const std::string& format, char** argv) {
    for (const char* known : {"dicom", "tiff", "hdf5", "zarr", "vdb"})
        if (format == known) {
            const auto self = std::filesystem::read_symlink("/proc/self/exe");
            execv((self.string() + "-" + format).c_str(), argv);
        }
}

/// Bytes of a file, the most there can be of anything else. Libraries that read by themselves would not see a cut
/// (core/truncated_file.h).
std::uintmax_t size_of(const char* path) {
    std::error_code none;
    return std::filesystem::is_regular_file(path, none) ? std::filesystem::file_size(path, none) : UINTMAX_MAX;
}

/// A Zarr store or an OpenVDB file alone is all that its reader sees; of a store on a server there is nothing here to
/// see.
decode::Limits limits_of(const std::string& format, const std::string& path, std::uint64_t max_bytes,
                         unsigned cpu_seconds, bool serves) {
    decode::Limits limits{max_bytes, cpu_seconds, serves};
    if (format != "zarr" && format != "vdb") return limits;
    limits.permissions.reads_all = false;
    if (wire::is_url(path))
        limits.last_descriptor = wire::fetch_descriptor;
    else
        limits.permissions.readable = {path};
    return limits;
}

}  // namespace

int main(int argc, char** argv) {
    const bool serves = argc == 8 && std::string(argv[7]) == "serve";
    if ((argc != 7 && !serves) || fcntl(wire::voxels_descriptor, F_GETFD) < 0 ||
        fcntl(wire::messages_descriptor, F_GETFD) < 0) {
        std::fputs("chiaro-decode is started by chiaro; it does nothing on its own\n", stderr);
        return 2;
    }
    const std::string format = argv[1];
    const decode::Reader reader = decode::find_reader(format);
    if (!reader) become_program_for(format, argv);
    const std::uint64_t max_bytes = std::strtoull(argv[4], nullptr, 10);
    const auto cpu_seconds = unsigned(std::strtoul(argv[5], nullptr, 10));
    decode::limit_this_process(limits_of(format, argv[2], max_bytes, cpu_seconds, serves));
    decode::Output output(max_bytes, int(std::strtol(argv[6], nullptr, 10)));
    try {
        if (!reader)
            decode::refuse("the program chiaro-decode-" + format + " is missing beside chiaro-decode" +
                           (format == "vdb" ? missing_vdb : ""));
        if (serves) {
            const decode::ChunkedOpener open = decode::find_chunked_opener(format);
            if (!open) decode::refuse(decode::not_in_chunks);
            decode::serve(*open(argv[2], argv[3], output), cpu_seconds, output);
            return 0;
        }
        const std::uintmax_t size = size_of(argv[2]);
        Volume volume = reader(argv[2], argv[3], output);
        if (volume.moments.count == 1) output.choose_moment(1, volume);
        if (size_of(argv[2]) < size) decode::refuse(was_cut);
        output.succeed(volume);
    } catch (const decode::TooLarge& error) {
        output.fail(error.what(), true);
    } catch (const std::bad_alloc&) {
        output.fail("decoding it takes more memory than is permitted");
    } catch (const std::exception& error) {
        output.fail(error.what());
    }
    return 0;
}

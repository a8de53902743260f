// chiaro-decode: decodes one volume in a process of its own, so that a damaged or hostile file harms nothing else.
//
//   chiaro-decode FORMAT PATH SERIES MAX_BYTES CPU_SECONDS
//
// Started by the library (io/helper.cpp), which hands over a memory file for the voxels and a pipe for messages
// (io/wire.h).
#include "decode/limits.h"
#include "decode/output.h"
#include "decode/readers.h"

#include <fcntl.h>

#include <cstdio>
#include <cstdlib>
#include <exception>
#include <string>

#include "io/wire.h"

namespace {

using namespace chiaro;

Volume read(const std::string& format, const std::string& path, const std::string& series, decode::Output& output) {
    if (format == "nrrd") return decode::read_nrrd(path, output);
    if (format == "meta") return decode::read_meta(path, output);
    if (format == "nifti") return decode::read_nifti(path, output);
    if (format == "dicom") return decode::read_dicom(path, series, output);
    decode::refuse("the decoder knows no format '" + format + "'");
}

}  // namespace

int main(int argc, char** argv) {
    if (argc != 6 || fcntl(wire::voxels_descriptor, F_GETFD) < 0 || fcntl(wire::messages_descriptor, F_GETFD) < 0) {
        std::fputs("chiaro-decode is started by chiaro; it does nothing on its own\n", stderr);
        return 2;
    }
    const std::uint64_t max_bytes = std::strtoull(argv[4], nullptr, 10);
    decode::limit_this_process({max_bytes, unsigned(std::strtoul(argv[5], nullptr, 10))});
    decode::Output output(max_bytes);
    try {
        output.succeed(read(argv[1], argv[2], argv[3], output));
    } catch (const std::bad_alloc&) {
        output.fail("decoding it takes more memory than is permitted");
    } catch (const std::exception& error) {
        output.fail(error.what());
    }
    return 0;
}

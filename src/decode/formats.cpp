// What chiaro-decode itself reads: the formats of our own code.
#include "decode/readers.h"

namespace chiaro::decode {

Reader find_reader(std::string_view format) {
    if (format == "nrrd") return read_nrrd;
    if (format == "meta") return read_meta;
    if (format == "nifti") return read_nifti;
    if (format == "vti") return read_vti;
    if (format == "vtk") return read_vtk;
    return nullptr;
}

ChunkedOpener find_chunked_opener(std::string_view) { return nullptr; }

}  // namespace chiaro::decode

// The text part of an NRRD file (http://teem.sourceforge.net/nrrd/format.html).
#pragma once
#include "decode/text.h"

#include <filesystem>

namespace chiaro::decode {

struct NrrdHeader {
    Fields fields;                        ///< names in lower case
    Fields key_values;                    ///< as written with :=
    std::vector<std::string> data_files;  ///< lines after `data file: LIST`
    std::uint64_t data_offset = 0;        ///< first byte behind the header
};

/// Throws Error{input} for what is no NRRD header.
NrrdHeader read_nrrd_header(const std::filesystem::path& path);

}  // namespace chiaro::decode

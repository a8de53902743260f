// The binary header of NIfTI-1 and NIfTI-2, in the machine's byte order.
#pragma once
#include <array>
#include <cstdint>
#include <filesystem>
#include <string>

namespace chiaro::decode {

/// The fields that matter here, named as the standard names them.
struct NiftiHeader {
    int size = 0;  ///< of the header: 348 or 540
    bool big_endian = false, detached = false;
    std::array<std::int64_t, 8> dim{};
    int datatype = 0, bitpix = 0, qform_code = 0, sform_code = 0, xyzt_units = 0;
    std::array<double, 8> pixdim{};
    double vox_offset = 0, scl_slope = 0, scl_inter = 0, toffset = 0;
    std::array<double, 3> quatern{}, qoffset{};
    std::array<std::array<double, 4>, 3> srow{};
    std::string description;
};

/// Reads it from a file that may be gzipped. Throws Error{input} for what is no NIfTI.
NiftiHeader read_nifti_header(const std::filesystem::path& path);

/// Whether the file starts like gzip.
bool is_gzip(const std::filesystem::path& path);

}  // namespace chiaro::decode

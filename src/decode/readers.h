// The formats that the helper decodes. Each reader returns the whole header with the voxels in `output`'s memory file,
// keeps the stored type and the file's own world frame, and throws Error{input} for everything wrong with the file.
#pragma once
#include "decode/output.h"

#include <filesystem>
#include <string>

namespace chiaro::decode {

/// NRRD, attached or detached; raw, gzip, ascii.
Volume read_nrrd(const std::filesystem::path& path, Output& output);
/// MetaImage: .mha and .mhd; raw, compressed, ascii.
Volume read_meta(const std::filesystem::path& path, Output& output);
/// NIfTI-1 and NIfTI-2: .nii, .nii.gz, and .hdr with .img.
Volume read_nifti(const std::filesystem::path& path, Output& output);
/// A folder of DICOM slices (`series`: UID, number in the order of size, or empty for the largest), or one file.
Volume read_dicom(const std::filesystem::path& path, const std::string& series, Output& output);

}  // namespace chiaro::decode

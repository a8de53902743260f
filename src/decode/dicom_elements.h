// The headers of a DICOM file's elements, before GDCM sees them.
#pragma once
#include <filesystem>

namespace chiaro::decode {

/// Throws Error{input} for an element that one data set states twice (GDCM would take the first and say nothing), and
/// for fragments of pixels that reach behind the file's end. Goes only as far as the headers can be understood: what
/// else is wrong is for GDCM to find.
void check_dicom_elements(const std::filesystem::path& path);

}  // namespace chiaro::decode

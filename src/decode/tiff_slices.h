// Which pages of TIFF files are the slices of a volume, in order.
#pragma once
#include "decode/output.h"
#include "decode/tiff_layout.h"
#include "decode/tiff_page.h"

#include <filesystem>
#include <vector>

namespace chiaro::decode {

struct Slice {
    std::filesystem::path path;
    std::uint64_t directory = 0;  ///< where the page's directory lies in the file
    TiffPage page;
};

/// Of a file all full pages, of a folder the first ones of its files. Throws Error{input} where there is none, or one
/// is damaged.
std::vector<Slice> slices_of(const std::filesystem::path& path, Volume& volume, Output& output);

/// The pages of the files that a description names, in its order; `slices` where they all lie in one or are not all
/// there, which is told.
std::vector<Slice> planes_in_files(std::vector<Slice> slices, const TiffLayout& layout, Volume& volume, Output& output);

/// Keeps the kind of which there are most, and names what is left out.
void keep_one_kind(std::vector<Slice>& slices, Volume& volume);

}  // namespace chiaro::decode

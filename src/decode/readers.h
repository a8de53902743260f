// The formats that the helper programs decode. Each reader returns the whole header with the voxels in `output`'s
// memory file, or tells their place; it keeps the stored type and the file's own world frame, and throws Error{input}
// for everything wrong with the file.
#pragma once
#include "decode/chunked.h"
#include "decode/output.h"

#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

namespace chiaro::decode {

/// `part` says which of several volumes a file holds: a DICOM series, an HDF5 dataset; empty where there is one.
using Reader = Volume (*)(const std::filesystem::path& path, const std::string& part, Output& output);

/// The reader of a format, or nullptr. Each program has one definition: formats.cpp for what our own code reads, and
/// one beside the reader for formats that need a library.
Reader find_reader(std::string_view format);

/// Opens what is kept in chunks.
using ChunkedOpener = std::unique_ptr<ChunkedFile> (*)(const std::filesystem::path& path, const std::string& part,
                                                       Output& output);
/// Of a format, or nullptr; each program has one definition of this, too.
ChunkedOpener find_chunked_opener(std::string_view format);

/// NRRD, attached or detached; raw, gzip, ascii.
Volume read_nrrd(const std::filesystem::path& path, const std::string& part, Output& output);
/// MetaImage: .mha and .mhd; raw, compressed, ascii.
Volume read_meta(const std::filesystem::path& path, const std::string& part, Output& output);
/// NIfTI-1 and NIfTI-2: .nii, .nii.gz, and .hdr with .img.
Volume read_nifti(const std::filesystem::path& path, const std::string& part, Output& output);
/// VTK's XML image data: ascii, base64 or appended; zlib, LZ4 and LZMA blocks.
Volume read_vti(const std::filesystem::path& path, const std::string& part, Output& output);
/// VTK's legacy structured points: ascii or binary.
Volume read_vtk(const std::filesystem::path& path, const std::string& part, Output& output);
/// A folder of DICOM slices (`part`: UID, number in the order of size, or empty for the largest), or one file.
Volume read_dicom(const std::filesystem::path& path, const std::string& part, Output& output);
/// A folder of TIFF slices in the natural order of their names, or one file of several pages.
Volume read_tiff(const std::filesystem::path& path, const std::string& part, Output& output);
/// A dataset of an HDF5 file (`part`: its path, or empty for the only one that can be a volume).
Volume read_hdf5(const std::filesystem::path& path, const std::string& part, Output& output);
/// OME-Zarr of versions 0.4 and 0.5, or one Zarr array, in a folder (`part`: the path of an image or an array in it,
/// and a channel behind '@'; empty: what the folder is).
Volume read_zarr(const std::filesystem::path& path, const std::string& part, Output& output);
/// A grid of an OpenVDB file (`part`: its name, with or without a '/' before it; empty: the first of floats or
/// doubles).
Volume read_vdb(const std::filesystem::path& path, const std::string& part, Output& output);

}  // namespace chiaro::decode

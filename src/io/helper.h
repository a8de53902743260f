// The isolated program that decodes files, seen from the library.
#pragma once
#include <chiaro/io.h>

#include <string>
#include <utility>

#include "io/wire.h"

namespace chiaro {

struct DecodeRequest {
    std::string format;  ///< as decode/main.cpp names them
    std::string path;
    std::string name;         ///< for messages
    std::string part;         ///< a DICOM series, an HDF5 dataset; empty: whatever there is
    int standard_input = -1;  ///< a file that the helper finds as its standard input, if any
};

/// Starts chiaro-decode, waits for it within the limits of `options`, and checks what it returns against the memory
/// that it filled. Throws Error{input} with one sentence for everything that goes wrong with the file, a crash
/// included; Error{interrupted} when cancelled; Error{internal} when the program is not installed.
Volume decode_isolated(const DecodeRequest& request, const ReadOptions& options, Progress& progress);

/// What a volume is and where its voxels lie, of those that lie in one file as they are, in the folder of the file that
/// was named or below it. Throws as decode_isolated, for all others, too.
std::pair<Volume, VoxelsInFile> locate_isolated(const DecodeRequest& request, const ReadOptions& options,
                                                Progress& progress);

}  // namespace chiaro

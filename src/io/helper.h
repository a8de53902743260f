// The isolated program that decodes files, seen from the library.
#pragma once
#include <chiaro/error.h>
#include <chiaro/io.h>

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <utility>
#include <vector>

#include "io/helper_process.h"
#include "io/wire.h"

namespace chiaro {

struct DecodeRequest {
    std::string format;  ///< as decode/main.cpp names them
    std::string path;
    std::string name;             ///< for messages
    std::string part;             ///< a DICOM series, an HDF5 dataset; empty: whatever there is
    int standard_input = -1;      ///< a file that the helper finds as its standard input, if any
    bool may_be_private = false;  ///< of a URL: its host may be of this machine or a private net

    bool is_on_server() const { return wire::is_url(path); }
};

/// The helper is gone, or of no more use.
struct HelperLost : Error {
    using Error::Error;
};

/// Waits within the limits of `options` for the helper's next answer that is no word about its progress.
/// Throws Error{input} with what it says is wrong; HelperLost where it ends, halts or says what makes no sense;
/// Error{interrupted} when cancelled.
nlohmann::json next_answer(HelperProcess& helper, const DecodeRequest& request, const ReadOptions& options,
                           Progress& progress);

/// What the helper's arguments are.
std::vector<std::string> helper_arguments(const DecodeRequest& request, const ReadOptions& options,
                                          std::uint64_t max_bytes);

/// "cannot read 'NAME': SENTENCE", made harmless.
std::string sentence_about(const DecodeRequest& request, const std::string& sentence);

/// Starts chiaro-decode, waits for it within the limits of `options`, and checks what it returns against the memory
/// that it filled. Throws Error{input} with one sentence for everything that goes wrong with the file, a crash
/// included; Error{interrupted} when cancelled; Error{internal} when the program is not installed.
Volume decode_isolated(const DecodeRequest& request, const ReadOptions& options, Progress& progress);

/// What a volume is and where its voxels lie, of those that lie in one file as they are, in the folder of the file that
/// was named or below it. Throws as decode_isolated, for all others, too.
std::pair<Volume, VoxelsInFile> locate_isolated(const DecodeRequest& request, const ReadOptions& options,
                                                Progress& progress);

}  // namespace chiaro

// Generated volumes: exact functions of position, at any size.
#pragma once
#include <chiaro/brick_source.h>
#include <chiaro/export.h>
#include <chiaro/progress.h>
#include <chiaro/transfer_function.h>
#include <chiaro/volume.h>

#include <memory>
#include <string>
#include <vector>

namespace chiaro {

struct SampleInfo {
    std::string name, sentence;
    int default_size;
    /// Voxels name materials: what lies between two values is neither, and pictures classify before they interpolate.
    bool names_materials = false;
};
CHIARO_EXPORT std::vector<SampleInfo> list_samples();

/// Generates a sample as a cube of `size` voxels (0: its default size). Throws Error{usage} for an unknown name (with
/// "did you mean") or a size outside 2..4096.
CHIARO_EXPORT Volume make_sample(const std::string& name, int size = 0);
/// The same, reported as "sample". Throws Error{interrupted} when cancelled.
CHIARO_EXPORT Volume make_sample(const std::string& name, int size, Progress& progress);

/// The sample by bricks (chiaro/brick_source.h), of which none is made before it is read. Throws Error{usage} as
/// make_sample, for a size outside 2..16384.
CHIARO_EXPORT std::shared_ptr<const BrickSource> open_sample(const std::string& name, int size = 0);

/// The transfer function a sample is shown with by default.
CHIARO_EXPORT TransferFunction sample_transfer_function(const std::string& name);

}  // namespace chiaro

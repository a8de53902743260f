// Volumes in and out.
#pragma once
#include <chiaro/brick_source.h>
#include <chiaro/export.h>
#include <chiaro/progress.h>
#include <chiaro/volume.h>

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace chiaro {

/// How a headerless file is laid out; what is missing is taken from a name such as `head_256x256x113_uint16.raw`.
struct RawLayout {
    std::optional<std::array<int, 3>> dimensions;
    std::optional<VoxelType> type;
    std::optional<Vec3> spacing_mm;
    bool big_endian = false;
    std::uint64_t offset = 0;  ///< bytes before the first voxel
    bool operator==(const RawLayout&) const = default;
};

/// What three or four values of a voxel are: what the file says - where it says nothing, of 8 bits, colours -, colours
/// whatever it says, or channels.
enum class ComponentsAs { automatic, rgb, channels };

struct ReadOptions {
    RawLayout raw;
    /// Of a DICOM folder: its UID, or its number in the order of size (1 = largest); empty: the largest.
    std::string series;
    std::optional<std::pair<double, double>> rescale;  ///< slope and intercept where a file lacks them
    int time = 0;                                      ///< which of several moments, from 0
    ComponentsAs components_as = ComponentsAs::automatic;
    /// Whether the host that a URL names may be this machine or in a private net. Say it of what your user names, not
    /// of what a file or a page does.
    bool private_addresses = false;
    double seconds = 120;         ///< wall time allowed to decode
    double stall_seconds = 15;    ///< allowed without any progress
    std::uint64_t max_bytes = 0;  ///< largest decoded volume; 0: what the machine's memory allows
    /// A larger one is mapped from a nameless file in this folder; empty: it is refused.
    std::filesystem::path spill{};
};

/// Reads a file, a folder of DICOM slices, the URL of a Zarr store, `sample:NAME[:SIZE]`, or `-` (NRRD on standard
/// input). Of what changes with time, in one file or in files that a pattern names (`scan_{t:03}.nrrd`), it reads the
/// moment `options.time`. Files are decoded by the isolated helper program `chiaro-decode`: whatever they hold, this
/// call either returns a consistent volume or throws. NaN and infinite voxels are kept, and counted in `notes`. Throws
/// Error{input} for everything wrong with the file, Error{interrupted} when cancelled.
CHIARO_EXPORT Volume read_volume(const std::string& name, const ReadOptions& options, Progress& progress);
/// What `read_volume` reads whole, piece by piece: samples (up to 16384 voxels an axis, where read_volume makes at most
/// 4096), raw files, NRRD, MetaImage, NIfTI-1/2 and legacy VTK whose voxels lie in one file as they are, OME-Zarr,
/// HDF5, TIFF and OpenVDB. Levels: of a sample, the same sample at half the size, and so on; of OME-Zarr its own; else
/// every second voxel, and so on, of axes whose voxels are not twice as wide as others already. Of numbers wider than
/// 16 bits floats are kept; of several values a voxel, the first. Headers and chunks are decoded by isolated helper
/// programs; the bytes of other voxels, in which nothing can be wrong but their number, are read by this process. Null
/// for what can be read as a whole only. Throws as read_volume.
CHIARO_EXPORT std::shared_ptr<const BrickSource> open_brick_source(const std::string& name, const ReadOptions& options);

/// A volume's name `file:/part` or `file#part` as file and /part, where there is such a file and none of the whole
/// name; else the name.
CHIARO_EXPORT std::pair<std::string, std::string> split_volume_name(const std::string& name);

/// The files of a pattern such as `scan_{t:03}.nrrd`, in the order of their numbers: each is one moment. Empty for a
/// name that is no pattern, or of no files.
CHIARO_EXPORT std::vector<std::string> moment_files(const std::string& name);

enum class NrrdEncoding { raw, gzip };

/// Writes NRRD with geometry and key/values, whole or not at all. Slope and intercept other than 1 and 0 are applied
/// (integers that stay integers in 16 bits are kept as such, else float32). Throws Error{output}.
CHIARO_EXPORT void write_nrrd(const Volume& volume, const std::filesystem::path& path, NrrdEncoding encoding);
/// The same, reported as "write". Throws Error{interrupted} when cancelled.
CHIARO_EXPORT void write_nrrd(const Volume& volume, const std::filesystem::path& path, NrrdEncoding encoding,
                              Progress& progress);

/// A format for `--list-formats` and for messages.
struct FormatInfo {
    std::string name, extensions, note;
};
CHIARO_EXPORT std::vector<FormatInfo> list_formats();

}  // namespace chiaro

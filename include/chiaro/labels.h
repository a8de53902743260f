// Labels: which structure of a segmentation each voxel belongs to, and how each structure is shown.
#pragma once
#include <chiaro/export.h>
#include <chiaro/io.h>
#include <chiaro/transfer_function.h>

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace chiaro {

/// One structure of a segmentation, and how it is shown.
struct Label {
    std::uint32_t value = 0;  ///< as in the file; 0 is what no structure has
    std::string name{};
    Rgb rgb{1, 1, 1};    ///< sRGB, [0, 1]
    double tint = 1;     ///< [0, 1]: how much of the transfer function's colour this one replaces
    double opacity = 1;  ///< [0, 1], multiplies the extinction
    bool show = true;    ///< what is not shown casts no shadow either
    std::optional<TransferFunction> transfer{};  ///< in the place of the volume's; at most `max_label_transfers` differ
    bool operator==(const Label&) const = default;
};

inline constexpr std::size_t max_label_transfers = 7;

/// What is said of one label's look, or of all but 0; what is empty stays as it is.
struct LabelChange {
    std::optional<std::uint32_t> value;  ///< none: every label but 0
    std::optional<Rgb> rgb;
    std::optional<double> tint, opacity;
    std::optional<bool> show;
    bool operator==(const LabelChange&) const = default;
};
/// Labels, by value, with changes, one after the other. Values that no label has are passed over.
CHIARO_EXPORT std::vector<Label> with_changes(std::vector<Label> labels, const std::vector<LabelChange>& changes);

/// Names and colours of labels, as a file has them.
struct LabelTable {
    std::vector<Label> labels;       ///< by value, each value once
    std::string format;              ///< a name of list_label_formats
    std::vector<std::string> notes;  ///< what was assumed or is not kept, a sentence each
};

inline constexpr std::size_t max_labels = 65535;  ///< beside 0

/// A volume of labels: for each voxel the number of its label in `labels`.
struct LabelVolume {
    std::array<int, 3> dimensions{0, 0, 0};  ///< x, y, z; x is fastest in memory
    Geometry geometry;
    VoxelBuffer voxels;                 ///< uint16
    std::vector<Label> labels;          ///< first 0, then those that occur, by value
    std::vector<std::uint64_t> counts;  ///< voxels of each
    std::string source;
    std::vector<std::string> notes;

    std::span<const std::uint16_t> numbers() const {
        return {reinterpret_cast<const std::uint16_t*>(voxels.data()), voxels.size() / 2};
    }
};

/// Formats of label tables, in the order in which they are tried.
CHIARO_EXPORT std::vector<FormatInfo> list_label_formats();

/// Reads a text of any listed format, recognised by the ending of its name and its content. An alpha of another program
/// says how much of the colour lies over the picture: it becomes `tint`. What other programs say of the value 0 is of
/// its name alone: what no structure has is shown as without labels. Whatever the text holds, this returns a table of
/// at most 65536 labels or throws Error{input} with one sentence that names the place.
CHIARO_EXPORT LabelTable parse_label_table(const std::string& text, const std::string& name);
/// Reads a file of at most 16 MiB, the header of a .seg.nrrd, or "totalsegmentator": the classes of its task "total".
CHIARO_EXPORT LabelTable read_label_table(const std::string& name);

/// Reads labels from any format that read_volume reads: whole numbers from 0 to 2^32 - 1, of any type, at most 65535
/// others than 0; of a .seg.nrrd with its names, and its layers laid over each other: where segments overlap, the one
/// listed last wins, and a note says how many voxels. `table`: as for read_label_table, or empty. Labels without a name
/// are "label N", each in a colour of its own. Throws Error{input}, or Error{interrupted} when cancelled.
CHIARO_EXPORT LabelVolume read_labels(const std::string& name, const std::string& table, const ReadOptions& options,
                                      Progress& progress);
/// The same of a volume that is in memory.
CHIARO_EXPORT LabelVolume make_labels(const Volume& volume, const LabelTable* table, Progress& progress);

/// From voxels of a volume to voxels of the labels: p_label = offset + Σ_a p_volume[a] axes[a].
struct LabelPlacement {
    Vec3 offset;
    std::array<Vec3, 3> axes;
    bool is_same_grid = false;
};
/// LPS and RAS are brought together; where one of the two frames is unknown, labels of as many voxels lie voxel on
/// voxel. Throws Error{input} where the two do not belong to the same body: an unknown frame and other dimensions, or
/// boxes that do not meet.
CHIARO_EXPORT LabelPlacement place_labels(const LabelVolume& labels, const std::array<int, 3>& dimensions,
                                          const Geometry& geometry);

}  // namespace chiaro

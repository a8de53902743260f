// What an edit of the transfer function costs until its light is there: twenty edits, each another.
#pragma once
#include <chiaro/medium.h>

#include "rows.h"

namespace chiaro::bench {

/// Edit i of a function, the same each time: a point is moved up or down, the window is shifted, or all opacities are
/// new.
TransferFunction edited(const TransferFunction& tf, int i);
/// The same of colours alone.
TransferFunction recoloured(const TransferFunction& tf, int i);

/// A volume and the function that is edited.
struct EditedVolume {
    DeviceVolume volume;
    TransferFunction tf;
    bool is_surface = false;  ///< an isosurface, whose value is edited, is what is seen
};
/// "shells", or "fog" of its shape, of so many voxels along an edge; "head_ct_512": none without the data.
std::optional<EditedVolume> edited_volume(const Setup& setup, const std::string& name, int size);

/// light(medium, soon): all that follows; it calls soon() where coarse light is there. A row: wall time, the worst of
/// twenty as its greatest, core-ms in its note; and where there is coarse light, `row`/coarse.
using LightAfterEdit = std::function<void(const Medium&, const std::function<void()>& soon)>;
std::vector<Row> measure_edits(const std::string& row, const EditedVolume& subject, const LightAfterEdit& light,
                               TransferFunction (*edit)(const TransferFunction&, int) = edited);
/// The same by `illuminate`, each edit from the light of the one before. Without the data: rows that say so.
std::vector<Row> measure_edits(const Setup& setup, const std::string& row, const std::string& volume, int size,
                               const IlluminationSettings& settings,
                               TransferFunction (*edit)(const TransferFunction&, int) = edited);

}  // namespace chiaro::bench

// What stands behind a Prepared.
#pragma once
#include <chiaro/lighting.h>

#include "illumination/histogram/histograms.h"

namespace chiaro {

struct Prepared::Data {
    DeviceVolume volume;  ///< whose voxels were counted
    std::shared_ptr<const LocalHistograms> histograms;
    std::vector<Stage> stages;
    std::vector<std::string> notes;
};

}  // namespace chiaro

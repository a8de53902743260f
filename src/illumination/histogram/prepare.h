// Local histograms from a cache, or found and put there.
#pragma once
#include <memory>
#include <string>

#include "illumination/histogram/histograms.h"

namespace chiaro {

/// `notes` receives what a user should know: a damaged file that was found again, a folder that cannot be written.
std::shared_ptr<const LocalHistograms> prepare_histograms(const Device& device, const DeviceVolume& volume,
                                                          HistogramSettings settings, StageTimer& timer,
                                                          std::vector<std::string>& notes, Progress& progress);

}  // namespace chiaro

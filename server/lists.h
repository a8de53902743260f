// What a page is told before anything else: what there is to set, and what there is to choose from.
#pragma once
#include <chiaro/device.h>

#include "json.h"

namespace chiaro::server {

/// Settings as <chiaro/describe.h> tells them, methods, presets, probes, samples, formats, the device.
Json lists(const Device& device);

}  // namespace chiaro::server

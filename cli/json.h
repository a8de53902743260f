// JSON that the tool writes.
#pragma once
#include "io/volume_json.h"

namespace chiaro::cli {

using Json = OrderedJson;

}  // namespace chiaro::cli

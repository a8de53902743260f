#include "classify/presets.h"
namespace chiaro {
std::span<const ColorMapRow> color_map_rows() {
    static const std::vector<ColorMapRow> rows{{"gray", "0:000000 1:ffffff"}};
    return rows;
}
}  // namespace chiaro

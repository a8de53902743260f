// A first picture after a change, before the fine grid is swept: light of the coarse one, with detail from before.
#pragma once
#include "illumination/transport/matter.h"

namespace chiaro {

/// Light of both grids when it was last found on both.
struct LightBefore {
    TransportNodes fine, half;
};

/// Whether light on the grids of `fine` and `half` can take its detail from there.
bool has_detail_for(const LightBefore& before, const CellGrid& fine, const CellGrid& half);

/// What cells of the coarse grid cannot tell - which side of a wall they light, shadows of thin things - it said as
/// wrongly before, so the error is known:
///
///     J = J½ D,      D = J before / J½ before, per channel, at most 16,
///
/// J½ trilinear between the coarse nodes; moments alike, by the difference, scaled by J / J before. Cells that have
/// become opaque, or open, are as the coarse grid has them. Cost: some 24 loads a node and channel, a few core-ms at
/// 64³.
TransportNodes with_detail(const TransportMedium& fine, const TransportNodes& half, const LightBefore& before,
                           const Device& device);

}  // namespace chiaro

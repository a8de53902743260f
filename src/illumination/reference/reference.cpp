#include "illumination/reference/reference.h"
namespace chiaro {
CellValues reference_accessibility(const Device&, const Medium::Data&, const CellOpacity&, const ReferenceSettings&,
                                   const BlockMap&, Steps&, Progress&) {
    throw Error(ErrorCode::internal, "not written yet");
}
}  // namespace chiaro

#include "blend.h"

#include <IceT.h>
#include <chiaro/error.h>

#include <algorithm>

#include "vtkIceTContext.h"
#include "vtkMultiProcessController.h"

namespace chiaro::from_paraview {

FloatBlend::FloatBlend() { context_->SetController(vtkMultiProcessController::GetGlobalController()); }
FloatBlend::~FloatBlend() = default;

void FloatBlend::operator()(Frame& frame, const std::vector<int>& order) {
    context_->MakeCurrent();
    icetResetTiles();
    icetAddTile(0, 0, frame.width, frame.height, 0);
    icetStrategy(ICET_STRATEGY_SEQUENTIAL);
    icetCompositeMode(ICET_COMPOSITE_MODE_BLEND);
    icetSetColorFormat(ICET_IMAGE_COLOR_RGBA_FLOAT);
    icetSetDepthFormat(ICET_IMAGE_DEPTH_NONE);
    icetEnable(ICET_ORDERED_COMPOSITE);
    const std::vector<IceTInt> ranks(order.begin(), order.end());
    icetCompositeOrder(ranks.data());
    const IceTDouble as_it_is[16]{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
    const IceTFloat nothing[4]{};
    const IceTImage blended = icetCompositeImage(frame.rgba.data(), nullptr, nullptr, as_it_is, as_it_is, nothing);
    if (const IceTEnum error = icetGetError(); error != ICET_NO_ERROR)
        throw Error(ErrorCode::internal, "IceT could not blend the frames: error " + std::to_string(error));
    if (context_->GetController()->GetLocalProcessId() == 0)
        std::copy_n(icetImageGetColorcf(blended), frame.rgba.size(), frame.rgba.data());
}

}  // namespace chiaro::from_paraview

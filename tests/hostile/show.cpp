#include "hostile/show.h"

#include <chiaro/chiaro.h>

#include <cmath>

namespace hostile {

using namespace chiaro;

void show(Volume&& volume) {
    Session session(Device::cpu(1));
    Progress progress;
    session.show(std::move(volume), progress);
    const Statistics& range = session.statistics();
    for (const double value : {range.min, range.max, range.p1, range.p50, range.p99, range.p999})
        if (!std::isfinite(value)) throw Error(ErrorCode::internal, "its range is not finite");
    Scene scene;
    scene.width = 16, scene.height = 12;
    session.render(scene, progress);
}

}  // namespace hostile

#include "illumination/field.h"

namespace chiaro {

IlluminationField::IlluminationField() : data_(std::make_shared<Data>()) {}

std::vector<MethodInfo> list_methods() {
    return {{"none", "All light arrives everywhere; only the shading model acts."}};
}

Prepared prepare(const DeviceVolume&, const IlluminationSettings&, Progress&) { return {}; }

bool illuminate(const Device&, const Medium&, const Prepared&, const Lighting&, const IlluminationSettings& settings,
                const Sink& sink, Progress& progress) {
    if (progress.cancelled()) return false;
    switch (settings.method) {
        case Method::none:
            sink(IlluminationField());
            break;
    }
    return true;
}

}  // namespace chiaro

#include <cmath>

#include "illumination/histogram/prepare.h"
#include "illumination/prepared.h"

namespace chiaro {

std::size_t Prepared::bytes() const { return data_ && data_->histograms ? data_->histograms->bytes() : 0; }
const std::vector<Stage>& Prepared::stages() const {
    static const std::vector<Stage> none;
    return data_ ? data_->stages : none;
}
const std::vector<std::string>& Prepared::notes() const {
    static const std::vector<std::string> none;
    return data_ ? data_->notes : none;
}

IlluminationSettings preparation_of(const IlluminationSettings& settings) {
    IlluminationSettings only;
    if (settings.method != Method::histogram) return only;
    only.method = Method::histogram;
    const HistogramSettings& from = settings.histogram;
    HistogramSettings& to = only.histogram;
    to.radius = from.radius, to.clusters = from.clusters, to.packed_bins = from.packed_bins;
    to.packing = from.packing, to.metric = from.metric, to.path = from.path, to.subsample = from.subsample;
    to.cache = from.cache, to.channel = from.channel;
    return only;
}

Prepared prepare(const DeviceVolume& volume, const IlluminationSettings& settings, Progress& progress) {
    return prepare(volume.data().device, volume, settings, progress);
}

Prepared prepare(const Device& device, const DeviceVolume& volume, const IlluminationSettings& settings,
                 Progress& progress) {
    if (settings.method != Method::histogram) return {};
    auto data = std::make_shared<Prepared::Data>();
    data->volume = volume;
    StageTimer timer;
    data->histograms = prepare_histograms(device, volume, settings.histogram, timer, data->notes, progress);
    data->stages = timer.take();
    return Prepared(std::move(data));
}

}  // namespace chiaro

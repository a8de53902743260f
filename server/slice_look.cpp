#include "slice_look.h"

#include <algorithm>
#include <cmath>

#include "core/srgb.h"

namespace chiaro::server {
namespace {

SliceChannel seen(const Channel& channel) {
    const auto& points = channel.transfer.points;
    const auto densest =
        std::max_element(points.begin(), points.end(), [](auto& a, auto& b) { return a.opacity < b.opacity; });
    SliceChannel seen{{}, points.front().value, points.back().value, densest->rgb};
    if (!(seen.high > seen.low)) seen.high = seen.low + 1;
    for (double& c : seen.color) {
        if (channel.transfer.rgb_space == RgbSpace::linear) c = srgb_from_linear(c);
        c *= std::min(1.0, channel.gain);
    }
    return seen;
}

SliceTone tone_of(const Json& request, const Scene& scene, const Session& session) {
    const Json& window = request.contains("window") ? request["window"] : Json();
    if (!window.is_array() || window.size() != 2 || !window[0].is_number() || !window[1].is_number())
        throw Error(ErrorCode::usage, "window: must be [centre, width]");
    const double centre = window[0].get<double>(), width = window[1].get<double>();
    SliceTone tone{centre - width / 2, centre + width / 2, {}};
    if (scene.transfer.points) tone.colors = session.resolve(scene.transfer);
    if (scene.transfer.threshold) std::tie(tone.shown_low, tone.shown_high) = *scene.transfer.threshold;
    return tone;
}

}  // namespace

Slice Values::slice(const SlicePlane& plane, SliceSampling sampling, bool finest, Progress& progress) const {
    if (source) return chiaro::slice(*source, volume, plane, sampling, finest, progress);
    return chiaro::slice(volume, plane, sampling);
}

Image SliceLook::drawn(const Values& values, const SlicePlane& plane, SliceSampling sampling,
                       Progress& progress) const {
    Image image;
    if (channels.empty()) {
        image = develop(values.slice(plane, sampling, false, progress), tone);
    } else {
        std::vector<SliceChannel> filled = channels;
        for (std::size_t i = 0; i < filled.size(); ++i) filled[i].slice = slice(volumes[i], plane, sampling);
        image = develop(filled);
    }
    if (labels) lay_over(image, slice(*labels, values.volume, plane), looks, opacity);
    return image;
}

SliceLook slice_look(const Json& request, const Scene& scene, const Session& session, Progress& progress) {
    SliceLook look;
    const std::vector<Channel> channels = session.channels(scene);
    if (channels.size() > 1) {
        for (const Channel& channel : channels)
            look.channels.push_back(seen(channel)), look.volumes.push_back(channel.volume);
    } else {
        look.tone = tone_of(request, scene, session);
    }
    if (request.contains("label_opacity") && (look.labels = session.labels(scene, progress))) {
        look.looks = with_changes(look.labels->labels, scene.labels.changes);
        look.opacity = number_in(request, "label_opacity", 0, 1);
    }
    return look;
}

}  // namespace chiaro::server

// What a session makes of several channels.
#include "render/session_state.h"

namespace chiaro {

TransferFunction Session::State::transfer_of_opacity(const Scene& scene) const {
    if (own_color == OwnColor::by_value)
        return transfer_function_of_channel(channels_of(scene, 2)[0], 0, 2, scene.transfer, subject);
    return own_color == OwnColor::by_alpha ? of_alpha(scene.transfer, subject) : of_luminance(scene.transfer, subject);
}

Classified Session::State::in_own_colors(const Scene& scene, const Shape& shape, const Progress& progress) const {
    if (own_color == OwnColor::by_value) {
        OwnColors own{.opacity = upload.result, .transfer = transfer_of_opacity(scene), .rgb = {}};
        own.value = others[0].volume;
        own.colors = transfer_function_of_channel(channels_of(scene, 2)[1], 1, 2, scene.transfer, others[0].subject);
        return {own.transfer, chiaro::classify(device, own, shape, progress)};
    }
    if (!scene.channels.empty())
        throw Error(ErrorCode::usage,
                    "a volume in its own colours has no channels to set: --channels-as channels shows its values "
                    "as such");
    OwnColors own{.opacity = upload.result,
                  .transfer = transfer_of_opacity(scene),
                  .rgb = {others[0].volume, others[1].volume, others[2].volume}};
    double most = 0;
    for (const OtherChannel& color : others) most = std::max(most, color.subject.statistics.max);
    own.white = white_of(most);
    return {own.transfer, chiaro::classify(device, own, shape, progress)};
}

std::vector<Channel> Session::State::channels(const Scene& scene) const {
    if (own_color != OwnColor::none) return {{upload.result, transfer_of_opacity(scene), 1}};
    std::vector<Channel> all;
    const auto is_file = [](const ChannelSettings& c) { return !c.file.empty(); };
    const auto files = std::count_if(scene.channels.begin(), scene.channels.end(), is_file);
    const auto components = std::ptrdiff_t(others.size() + 1) - files;
    if (components < 1)
        throw Error(ErrorCode::usage,
                    fmt::format("the scene has {} channels of other files, where {} were read", files, others.size()));
    const std::vector<ChannelSettings> settings = channels_of(scene, int(components));
    for (std::size_t i = 0; i < settings.size(); ++i) {
        const Subject& its = i ? others[i - 1].subject : subject;
        all.push_back({i ? others[i - 1].volume : upload.result,
                       transfer_function_of_channel(settings[i], i, settings.size(), scene.transfer, its),
                       settings[i].show ? settings[i].gain : 0});
    }
    return all;
}

Classified Session::State::classified_channels(const Scene& scene, const Shape& shape, const Progress& progress) const {
    const std::vector<Channel> mixed = channels(scene);
    return {mixed.front().transfer, chiaro::classify(device, mixed, shape, progress)};
}

}  // namespace chiaro

#include "volumes.h"

#include <chiaro/chiaro.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/user_cache.h"
#include "io/volume_json.h"
#include "memory_budget.h"

namespace chiaro::server {
namespace {

constexpr std::size_t bin_count = 512;
constexpr double longest_reading = 3600;  // seconds

/// Equal bins over [least, greatest], of values after slope and intercept.
Json finer_histogram(const Volume& volume, double least, double greatest) {
    std::vector<std::uint64_t> counts(bin_count);
    const double per_value = greatest > least ? double(bin_count) / (greatest - least) : 0;
    with_voxel_type(volume.type, [&](auto zero) {
        for (const auto stored : volume.as<decltype(zero)>()) {
            const double value = volume.slope * double(stored) + volume.intercept;
            if (std::isfinite(value))
                ++counts[std::size_t(std::clamp((value - least) * per_value, 0.0, double(bin_count - 1)))];
        }
    });
    return {{"min", least}, {"max", greatest}, {"counts", counts}};
}

Json sections_told(const Geometry& geometry) {
    Json list = Json::array();
    for (const Section& s : sections_of(geometry))
        list.push_back({{"name", s.name},
                        {"axis", s.axis},
                        {"right", server::json_of(s.right)},
                        {"down", server::json_of(s.down)}});
    return list;
}

/// `measured`: the voxels that its values are told of.
Json told(const Volume& volume, const Volume& measured) {
    const Statistics statistics = measure(measured);
    const Guess guessed = guess(measured, statistics);
    Json json = Json::parse(info_of(volume, statistics, guessed).dump(-1, ' ', false, Json::error_handler_t::replace));
    json["statistics"] = &volume == &measured ? "exact" : "sampled";
    json["histogram512"] = finer_histogram(measured, statistics.min, statistics.max);
    // What only seems to be CT has no unit, unless its values are those of HU: then it is shown as bone.
    const bool is_ct = volume.modality == "CT" || guessed.preset == "ct-bone";
    json["unit"] = is_ct && statistics.hu_zero == 0 ? "HU" : "";
    json["bytes"] = volume.voxels.size();
    const std::string name = std::filesystem::path(volume.source).filename().string();
    json["sections"] = sections_told(volume.geometry);
    json["name"] = name.empty() ? volume.source : name;
    return json;
}

Json told(const Volume& volume) { return told(volume, volume); }

/// What is to be known of each channel's values; of the first it is told already.
Json told_channels(const std::vector<Volume>& channels, const Json& first) {
    Json list = Json::array();
    for (std::size_t i = 0; i < channels.size(); ++i) {
        const Json all = i ? told(channels[i]) : first;
        Json one;
        for (const char* key : {"range", "percentiles", "histogram512", "type", "unit"}) one[key] = all[key];
        list.push_back(std::move(one));
    }
    return list;
}

/// What files say nothing of is taken as 1; coordinates of a body are in millimetres.
bool states_spacing(const Volume& volume) {
    return volume.geometry.world != World::unknown || !(volume.geometry.spacing_mm == Vec3{1, 1, 1});
}

/// What makes two volumes the same: name, options, stated geometry, and how often it is halved; all moments are one.
std::string key_of(const Scene& scene, int halvings = 0) {
    Scene only;
    only.volume = scene.volume, only.read = scene.read, only.stated = scene.stated;
    only.read.time = 0;
    for (const ChannelSettings& channel : scene.channels)
        if (!channel.file.empty()) only.channels.push_back({.file = channel.file});
    return fmt::format("{} {}", halvings, to_json(only));
}

/// A sample is made at any size that is asked for: no more than there is memory.
void check_sample(const std::string& name) {
    const std::size_t colon = name.rfind(':');
    if (!name.starts_with("sample:") || colon == 6) return;
    const double size = std::atof(name.c_str() + colon + 1);
    check_memory(10 * size * size * size);
}

std::shared_ptr<const Loaded> page(const Scene& scene, const std::shared_ptr<const BrickSource>& source, Device device,
                                   const PagingSettings& paging, int halvings, Progress& progress) {
    auto loaded = std::make_shared<Loaded>(Loaded{scene, Session(device), {}, halvings});
    loaded->session.show(source, paging, progress);
    // Of the level that has been read, or of one that takes no time.
    const auto& levels = source->levels();
    const auto whole = std::ranges::find(levels, loaded->session.volume().dimensions(), &SourceLevel::dimensions);
    const int level = std::max(small_level(*source), int(whole - levels.begin()));
    loaded->told = told(source->header(), read_level(*source, level, progress));
    loaded->told["bytes"] = loaded->session.volume().bytes();
    for (const SourceLevel& one : levels) loaded->told["levels"].push_back(one.dimensions);
    loaded->told["spacing_stated"] = states_spacing(source->header());
    loaded->told["reduced"] = nullptr;
    loaded->told["exact"] = loaded->session.volume().is_exact();
    return loaded;
}

/// What a volume may take as a whole, and what one by bricks is given.
struct Budgets {
    PagingSettings whole, bricks;

    /// An eighth for each halving.
    Budgets(const PagingSettings& asked, int halvings) : whole(asked) {
        // Of a file of 29 GB the level that is read before there is a picture then has 384³ voxels and takes .9 s; with
        // half of 21 GB it had 768³ and took 13 s.
        constexpr double max_unasked = 0x1p32;
        const double bytes = asked.memory_bytes ? double(asked.memory_bytes) : 0.5 * free_memory();
        const auto shared = [&](double all) {
            return std::max<std::uint64_t>(1, std::uint64_t(std::ldexp(all, -3 * halvings)));
        };
        bricks = whole;
        whole.memory_bytes = shared(bytes);
        bricks.memory_bytes = asked.memory_bytes ? whole.memory_bytes : shared(std::min(bytes, max_unasked));
    }
};

std::shared_ptr<const Loaded> read(const Scene& scene, Device device, const Budgets& budgets, int halvings,
                                   Progress& progress) {
    const auto source = paged_volume(scene, budgets.whole);
    if (source && source->header().moments.count == 1)
        return page(scene, source, device, budgets.bricks, halvings, progress);
    check_sample(scene.volume);
    Scene reading = scene;  // which shows how far it is and can be cancelled
    reading.read.time = 0;
    reading.read.seconds = longest_reading,
    reading.read.max_bytes = std::max<std::uint64_t>(1, std::uint64_t(free_memory()));
    reading.read.spill = user_cache();
    std::vector<Volume> channels = read_channels(reading, progress);
    Volume& volume = channels.front();
    const bool is_spacing_stated = states_spacing(volume);
    const Fitted fitted = fit(volume, halvings);
    if (channels.size() > 1 && fitted.is_reduced())
        throw Error(ErrorCode::output, fmt::format("{}: {} channels of {} voxels do not fit in the memory that is free",
                                                   scene.volume, channels.size(), fmt::join(fitted.from, " x ")));
    Json json = told(volume);
    if (channels.size() > 1 && !volume.has_own_colors) json["channels"] = told_channels(channels, json);
    json["spacing_stated"] = is_spacing_stated;
    json["reduced"] = nullptr;
    if (fitted.is_reduced()) json["reduced"] = {{"from", fitted.from}, {"to", fitted.to}, {"bytes", fitted.free}};
    auto loaded = std::make_shared<Loaded>(Loaded{scene, Session(device), std::move(json), halvings});
    loaded->source.read.time = 0;
    loaded->session.show(std::move(channels), progress);
    loaded->told["exact"] = loaded->session.volume().is_exact() && !fitted.is_reduced();
    return loaded;
}

/// Of a volume in memory: never reduced, and its voxels stay.
std::shared_ptr<const Loaded> take(const Scene& scene, Device device, const Volume& volume, Progress& progress) {
    Json json = told(volume);
    json["spacing_stated"] = states_spacing(volume);
    json["reduced"] = nullptr;
    json.erase("moments");  // there are no others to be read
    auto loaded = std::make_shared<Loaded>(Loaded{scene, Session(device), std::move(json), 0});
    loaded->session.show(volume, progress);
    loaded->told["exact"] = loaded->session.volume().is_exact();
    return loaded;
}

}  // namespace

std::shared_ptr<const Loaded> Volumes::find(const Scene& scene) const {
    const std::lock_guard lock(mutex_);
    const auto found = entries_.find(key_of(scene));
    return found == entries_.end() ? nullptr : found->second.loaded.lock();
}

std::shared_ptr<const Loaded> Volumes::load(const Scene& scene, Progress& progress, int halvings) {
    const std::string key = key_of(scene, halvings);
    std::unique_lock lock(mutex_);
    while (entries_[key].is_reading) {
        changed_.wait_for(lock, std::chrono::milliseconds(50));
        progress.check();
        if (const Entry& entry = entries_[key]; entry.is_reading && !entry.stage.empty())
            progress.report(entry.stage, entry.fraction);
    }
    if (auto loaded = entries_[key].loaded.lock()) return loaded;
    std::erase_if(entries_,
                  [](const auto& entry) { return !entry.second.is_reading && entry.second.loaded.expired(); });
    entries_[key].is_reading = true;
    lock.unlock();
    Progress told([&](std::string_view stage, double fraction) {
        if (progress.cancelled()) told.cancel();
        progress.report(stage, fraction);
        const std::lock_guard telling(mutex_);
        entries_[key].stage = stage, entries_[key].fraction = fraction;
    });
    std::shared_ptr<const Loaded> loaded;
    const auto done = [&] {
        lock.lock();
        entries_[key] = {loaded, false, {}, 0};
        changed_.notify_all();
    };
    try {
        const Budgets budgets(paging_, halvings);
        if (!held_.is_of(scene.volume))
            loaded = read(scene, device_, budgets, halvings, told);
        else if (held_.source && !fits(*held_.source, budgets.whole))
            loaded = page(scene, held_.source, device_, budgets.bricks, halvings, told);
        else if (held_.volume)
            loaded = take(scene, device_, *held_.volume, told);
        else
            loaded = take(scene, device_, read_level(*held_.source, 0, told), told);
    } catch (...) {
        done();
        throw;
    }
    done();
    return loaded;
}

Json scene_json(const Scene& scene, const Session& session) {
    Scene complete = scene;
    stand_by_frame(complete, session.volume().geometry().world);
    complete.transfer.points = session.resolve(scene.transfer);
    complete.transfer.source.clear();
    complete.transfer.opacity_unit.reset(), complete.transfer.opacity_unit_mm.reset();
    const std::vector<Channel> channels = session.channels(scene);
    if (channels.size() > 1) {
        const auto is_file = [](const ChannelSettings& c) { return !c.file.empty(); };
        const auto files = std::count_if(scene.channels.begin(), scene.channels.end(), is_file);
        complete.channels = channels_of(scene, int(channels.size() - std::size_t(files)));
        for (std::size_t i = 0; i < channels.size(); ++i) {
            complete.channels[i].transfer = {};
            complete.channels[i].transfer.points = channels[i].transfer;
        }
        complete.transfer.points = channels.front().transfer;
    }
    return Json::parse(to_json(complete));
}

}  // namespace chiaro::server

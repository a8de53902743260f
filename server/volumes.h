// Volumes in memory, each once, however many views show it.
#pragma once
#include <chiaro/session.h>

#include <condition_variable>
#include <map>
#include <memory>
#include <mutex>
#include <string>

#include "json.h"

namespace chiaro::server {

/// A volume that was read, and what a page is told of it.
struct Loaded {
    Scene source;      ///< its volume and how it was read, at moment 0; the rest as initially
    Session session;   ///< shows it; others are made beside it
    Json told;         ///< VOLUME of the protocol
    int halvings = 0;  ///< that were asked for
    int moments() const { return told.contains("moments") ? told["moments"]["count"].get<int>() : 1; }
};

/// What scenes of a volume of its name show, without looking for a file.
struct HeldVolume {
    std::shared_ptr<const Volume> volume;
    std::shared_ptr<const BrickSource> source;  ///< of one that is read by bricks
    bool is_of(const std::string& name) const {
        return (volume && volume->source == name) || (source && source->header().source == name);
    }
};

class Volumes {
public:
    explicit Volumes(Device device, HeldVolume held = {}, PagingSettings paging = {})
        : device_(device), held_(std::move(held)), paging_(paging) {}

    /// The scene's volume: the one in memory, or read now; where another thread is reading it that is waited for.
    /// Where it would not fit it is read by bricks; what cannot be is halved (memory_budget.h). `halvings`: it is
    /// halved so often at least; by bricks, that much less memory is taken. Throws as read_volume.
    std::shared_ptr<const Loaded> load(const Scene& scene, Progress& progress, int halvings = 0);
    /// If it is in memory.
    std::shared_ptr<const Loaded> find(const Scene& scene) const;
    const Device& device() const { return device_; }

private:
    struct Entry {
        std::weak_ptr<const Loaded> loaded;
        bool is_reading = false;
        std::string stage;  ///< of the reading, for those who wait for it
        double fraction = 0;
    };

    Device device_;
    HeldVolume held_;
    PagingSettings paging_;
    mutable std::mutex mutex_;
    std::condition_variable changed_;
    std::map<std::string, Entry> entries_;
};

/// The scene complete with the points of its transfer function, as SCENE of the protocol.
Json scene_json(const Scene& scene, const Session& session);

}  // namespace chiaro::server

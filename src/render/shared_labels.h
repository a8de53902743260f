// The labels of a volume, read once for all sessions that show it.
#pragma once
#include <chiaro/scene.h>

#include <memory>
#include <mutex>
#include <string>
#include <tuple>

#include "render/appearance.h"

namespace chiaro {

/// Keeps those that were asked for last. Calls may come from any thread; who comes while another reads waits.
class SharedLabels {
public:
    /// The scene's, without its changes; null: it has none. Throws as read_labels.
    std::shared_ptr<const LabelVolume> find(const Scene& scene, Progress& progress) {
        if (!scene.labels.any()) return nullptr;
        Key key = key_of(scene);
        if (scene.labels.loaded && !std::get<bool>(key)) return scene.labels.loaded;
        const std::lock_guard lock(mutex_);
        if (!labels_ || key != key_) {
            labels_.reset();
            labels_ = std::make_shared<const LabelVolume>(read_labels(scene, progress));
            key_ = std::move(key);
        }
        return labels_;
    }

    /// What they are made from.
    using Key = std::tuple<std::string, std::string, std::shared_ptr<const LabelVolume>, bool>;
    static Key key_of(const Scene& scene) {
        return {scene.labels.source, scene.labels.table, scene.labels.loaded, are_labels_alone(scene)};
    }

private:
    std::mutex mutex_;
    Key key_;
    std::shared_ptr<const LabelVolume> labels_;
};

}  // namespace chiaro

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
        if (scene.labels.source.empty()) return nullptr;
        const std::lock_guard lock(mutex_);
        Key key(scene.labels.source, scene.labels.table, are_labels_alone(scene));
        if (!labels_ || key != key_) {
            labels_.reset();
            labels_ = std::make_shared<const LabelVolume>(read_labels(scene, progress));
            key_ = std::move(key);
        }
        return labels_;
    }

private:
    using Key = std::tuple<std::string, std::string, bool>;
    std::mutex mutex_;
    Key key_;
    std::shared_ptr<const LabelVolume> labels_;
};

}  // namespace chiaro

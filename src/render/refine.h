// Pictures of a volume that does not fit in memory: from a coarse level of it, which does, to the level at which a
// voxel is about a pixel, of which only what is seen is read.
#pragma once
#include <chiaro/brick_source.h>
#include <chiaro/scene.h>
#include <chiaro/session.h>

#include <functional>
#include <memory>
#include <mutex>
#include <optional>

#include "volume/exact_ranges.h"
#include "volume/paged_level.h"

namespace chiaro {

/// What a picture is drawn from - the medium of the whole level, and its light - and where to.
struct Drawing {
    const Device& device;
    const Medium& medium;
    const IlluminationField& field;
    const Lighting& lighting;
    const Camera& camera;
    const Scene& scene;
    DeviceFrame& frame;
    RenderStatistics& statistics;
};

/// Of one volume, for all sessions that share it: one at a time draws finer levels.
class Refiner {
public:
    Refiner(std::shared_ptr<const BrickSource> source, const PagingSettings& settings);

    /// The finest level that is there as a whole: what values, looks and light are found from.
    int whole_level() const { return whole_level_; }
    const SourceLevel& finest() const { return source_->levels().front(); }

    /// The whole level, just uploaded, with the range that all voxels have, where these are to be read.
    DeviceVolume with_exact_range(const DeviceVolume& whole, Progress& progress);

    /// Draws the finest level that the picture asks for and the budget allows. `report.level` is the whole level where
    /// that is it, or where the scene's settings ask for all voxels: then the frame is still to be drawn. `coarser` is
    /// called with each coarser level's picture in the frame, from the level that was drawn last on, and with what is
    /// there of a level of which much is missing. Waits for other sessions. Throws Error{interrupted} when cancelled:
    /// what was read by then stays.
    PagingReport render(const Drawing& drawing, Progress& progress, const std::function<void()>& coarser = {});
    /// Draws at once, of what has been read. False where that would look no better than the whole level, or another
    /// session is drawing: then the frame is still to be drawn.
    bool draw_what_is_there(const Drawing& drawing, Progress& progress);

    const std::shared_ptr<const BrickSource>& source() const { return source_; }

private:
    int wanted_level(const Drawing& drawing) const;
    std::int32_t room_at(int level, const DeviceVolume& whole) const;
    bool open(int level, const Medium& medium);
    bool draw(int level, const Drawing& drawing, Progress& progress, const std::function<void()>& incomplete);
    PagingReport report(int level, std::string stopped_by) const;

    std::shared_ptr<const BrickSource> source_;
    std::timed_mutex drawing_;
    double memory_bytes_;
    bool is_exact_;
    int finest_level_, whole_level_;
    std::optional<BrickRanges> exact_;  // of the finest level
    std::optional<PagedLevel> level_;   // with what has been read of it
    Medium looks_, medium_;             // of the whole level, when medium_ of level_ was made
};

/// What a user should know of it.
std::vector<std::string> notes_of(const PagingReport& report);

/// Its transfer function, where that has opacities of voxels, as of those of the finest level.
TransferFunction of_finest_voxels(TransferFunction tf, const SourceLevel& finest);

}  // namespace chiaro

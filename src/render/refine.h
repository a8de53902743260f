// Pictures of a volume that does not fit in memory: from a coarse level of it, which does, to the level at which a
// voxel is about a pixel, of which only what is seen is read.
#pragma once
#include <chiaro/brick_source.h>
#include <chiaro/scene.h>
#include <chiaro/session.h>

#include <memory>
#include <optional>

#include "volume/exact_ranges.h"
#include "volume/paged_level.h"

namespace chiaro {

class Refiner {
public:
    Refiner(std::shared_ptr<const BrickSource> source, const PagingSettings& settings);

    /// The finest level that is there as a whole: what values, looks and light are found from.
    int whole_level() const { return whole_level_; }
    const SourceLevel& finest() const { return source_->levels().front(); }

    /// The whole level, just uploaded, with the range that all voxels have, where these are to be read.
    DeviceVolume with_exact_range(const DeviceVolume& whole, Progress& progress);

    /// Draws the finest level that the picture asks for and the budget allows. False where that is the whole level, or
    /// where the scene's settings ask for all voxels: then `frame` is still to be drawn.
    /// `medium`: of the whole level; `field`: its light. Throws Error{interrupted} when cancelled.
    bool render(const Device& device, const Medium& medium, const IlluminationField& field, const Lighting& lighting,
                const Camera& camera, const Scene& scene, DeviceFrame& frame, RenderStatistics& statistics,
                Progress& progress);

    const PagingReport& report() const { return report_; }

private:
    int wanted_level(const Medium::Data& medium, const Camera& camera, const Scene& scene) const;
    std::int32_t room_at(int level, const DeviceVolume& whole) const;
    bool open(int level, const Medium& medium);
    bool read_what_is_seen(const Device& device, const IlluminationField& field, const Lighting& lighting,
                           const Camera& camera, const RaySettings& rays, DeviceFrame& frame,
                           RenderStatistics& statistics, Progress& progress);
    void tell(int level, std::string stopped_by);

    std::shared_ptr<const BrickSource> source_;
    double memory_bytes_;
    bool is_exact_;
    int finest_level_, whole_level_;
    std::optional<BrickRanges> exact_;  // of the finest level
    std::optional<PagedLevel> level_;   // with what has been read of it
    Medium looks_, medium_;             // of the whole level, when medium_ of level_ was made
    PagingReport report_;
};

/// What a user should know of it.
std::vector<std::string> notes_of(const PagingReport& report);

/// Its transfer function, where that has opacities of voxels, as of those of the finest level.
TransferFunction of_finest_voxels(TransferFunction tf, const SourceLevel& finest);

}  // namespace chiaro

#include "render/refine.h"

#include <chiaro/text.h>
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>

#include "classify/paged_medium.h"
#include "io/memory.h"

namespace chiaro {
namespace {

constexpr double pixels_a_voxel = 1.5;         // at most, where something is seen
constexpr double share_of_whole = 1.0 / 3;     // of the budget, for the level that is there as a whole
constexpr double share_of_table = 1.0 / 4;     // of what is left, at most, for the table of a level's bricks
constexpr double share_of_decoded = 1.0 / 16;  // for what the source keeps, at most
constexpr double share_of_fetched = 1.0 / 8;   // ... of what came over a network
constexpr int far_edge = 256;                  // of what is read as a whole over a network
constexpr double max_slots = 8e6;              // whose cells 32 bits can number

int level_within(const BrickSource& source, int finest, double bytes) {
    const auto& levels = source.levels();
    int level = finest;
    const auto fits = [&] {
        return whole_volume_bytes(levels[std::size_t(level)].dimensions, source.header().type) <= bytes;
    };
    while (level + 1 < int(levels.size()) && !fits()) ++level;
    return level;
}

/// Why a picture is drawn of the whole level; empty: it need not be.
std::string needs_whole_level(const Scene& scene, const Medium::Data& medium) {
    const Method method = scene.illumination.method;
    if (scene.mode == Mode::mip || scene.mode == Mode::minip || scene.mode == Mode::mean)
        return "a value of whole rays is looked for";
    if (is_path_traced(scene.illumination)) return "paths are traced";
    if (method == Method::histogram) return "light is found by local histograms";
    if (scene.sampling.classification == Classification::preintegrated) return "steps are pre-integrated";
    if (medium.volume.data().factor) return "opacity goes by gradient";
    if (medium.volume.data().mixture) return "labels lie in it";
    if (scene.lighting.floor.show) return "a floor is looked for";
    if (scene.clip.largest) return "the largest piece is looked for";
    if (scene.interpolation != Interpolation::linear) return "values are not linear between voxels";
    return {};
}

/// How long a pixel is where the nearest visible cell is seen; 0: the eye is in one, or nothing is seen.
double least_pixel_mm(const Medium::Data& medium, const Camera& camera, int height, double half_width) {
    const DeviceVolume::Data& volume = medium.volume.data();
    const auto [nx, ny, nz] = volume.cells.count;
    const double a_pixel = 2 * camera.half_height / height;
    if (camera.projection == Projection::orthographic) return a_pixel;
    const double radius_mm = 0.5 * length(volume.geometry.world_from_voxel_vector({cell_edge, cell_edge, cell_edge}));
    double nearest = std::numeric_limits<double>::infinity();
    std::size_t cell = 0;
    for (int z = 0; z < nz; ++z)
        for (int y = 0; y < ny; ++y)
            for (int x = 0; x < nx; ++x, ++cell) {
                if (!(medium.cells[cell] & 1)) continue;
                const Vec3 centre{(x + 0.5) * cell_edge, (y + 0.5) * cell_edge, (z + 0.5) * cell_edge};
                const Vec3 from_eye = volume.geometry.world_from_voxel(centre) - camera.eye;
                const double depth = dot(from_eye, camera.forward);
                if (depth <= -radius_mm || depth - radius_mm >= nearest) continue;
                const double across = std::abs(dot(from_eye, camera.right) - camera.centre_x * depth),
                             upwards = std::abs(dot(from_eye, camera.up) - camera.centre_y * depth);
                const double wide = depth + radius_mm;  // the cell's corners may be seen where its centre is not
                if (across > half_width * wide + radius_mm || upwards > camera.half_height * wide + radius_mm) continue;
                nearest = std::max(depth - radius_mm, 0.0);
            }
    return std::isfinite(nearest) ? a_pixel * nearest : 0;
}

/// By which rays tell where they come through; pictures are the same.
RaySettings telling(RaySettings rays) {
    rays.skip_empty = true;
    return rays;
}

}  // namespace

TransferFunction of_finest_voxels(TransferFunction tf, const SourceLevel& finest) {
    if (!tf.opacity_unit_is_mm) tf.opacity_unit *= finest.geometry.smallest_spacing_mm();
    tf.opacity_unit_is_mm = true;
    return tf;
}

std::vector<std::string> notes_of(const PagingReport& report) {
    const auto why = [&]() -> std::string {
        if (report.stopped_by == "pixels") return "a voxel is about a pixel";
        if (report.stopped_by == "level") return "--level asks for no finer one";
        if (report.stopped_by == "volume") return "the finest";
        if (report.stopped_by == "memory") return "--memory has no room for what is seen of a finer one";
        return report.stopped_by + ", for which a level must be there as a whole";
    };
    std::vector<std::string> notes{fmt::format("level {} of 0 to {} is drawn, {} voxels: {}; light of level {}",
                                               report.level, report.levels - 1, to_text(report.dimensions), why(),
                                               report.light_level)};
    notes.insert(notes.end(), report.faults.begin(), report.faults.end());
    return notes;
}

double PagingSettings::budget_bytes() const {
    return memory_bytes > 0 ? double(memory_bytes) : 0.5 * double(available_memory());
}

namespace {

/// Whether a level as a whole would have a picture wait for a network.
bool is_too_far(const BrickSource& source, int level, const PagingSettings& settings) {
    const auto& n = source.levels()[std::size_t(level)].dimensions;
    return source.is_far() && !settings.exact && *std::max_element(n.begin(), n.end()) > far_edge;
}

}  // namespace

bool fits(const BrickSource& source, const PagingSettings& settings) {
    return settings.finest_level == 0 && !is_too_far(source, 0, settings) &&
           whole_volume_bytes(source.header().dimensions, source.header().type) <= settings.budget_bytes();
}

Refiner::Refiner(std::shared_ptr<const BrickSource> source, const PagingSettings& settings)
    : source_(std::move(source)),
      memory_bytes_(settings.budget_bytes()),
      is_exact_(settings.exact),
      finest_level_(std::min(settings.finest_level, int(source_->levels().size()) - 1)),
      whole_level_(level_within(*source_, finest_level_, memory_bytes_)) {
    memory_bytes_ -= double(
        source_->keep_decoded(std::size_t((source_->is_far() ? share_of_fetched : share_of_decoded) * memory_bytes_)));
    if (whole_level_ > finest_level_)
        whole_level_ = level_within(*source_, finest_level_, share_of_whole * memory_bytes_);
    while (whole_level_ + 1 < int(source_->levels().size()) && is_too_far(*source_, whole_level_, settings))
        ++whole_level_;
}

DeviceVolume Refiner::with_exact_range(const DeviceVolume& whole, Progress& progress) {
    if (!is_exact_) return whole;
    exact_ = exact_ranges(*source_, whole.data(), progress);
    // Nobody else has it yet.
    auto& data = const_cast<DeviceVolume::Data&>(whole.data());
    data.stored_min = std::min(data.stored_min, exact_->least);
    data.stored_max = std::max(data.stored_max, exact_->largest);
    return whole;
}

int Refiner::wanted_level(const Drawing& drawing) const {
    const Camera& camera = drawing.camera;
    const Scene& scene = drawing.scene;
    const double half_width =
        camera.half_width > 0 ? camera.half_width : camera.half_height * scene.width / scene.height;
    const double pixel_mm = least_pixel_mm(drawing.medium.data(), camera, scene.height, half_width);
    const auto is_fine = [&](int level) {
        for (int axis = 0; axis < 3; ++axis) {
            const double spacing = source_->levels()[std::size_t(level)].geometry.spacing_mm[axis];
            if (spacing > pixels_a_voxel * pixel_mm && spacing > finest().geometry.spacing_mm[axis]) return false;
        }
        return true;
    };
    int level = whole_level_;
    while (level > finest_level_ && !is_fine(level)) --level;
    return level;
}

/// How many bricks the budget has room for; 0: not even for the table.
std::int32_t Refiner::room_at(int level, const DeviceVolume& whole) const {
    const auto& levels = source_->levels();
    double bricks = 1;
    for (const int n : levels[std::size_t(level)].dimensions) bricks *= brick_count(n);
    const double left =
        memory_bytes_ - whole_volume_bytes(levels[std::size_t(whole_level_)].dimensions, source_->header().type);
    const double table = bricks * double(PagedLevel::bytes_of_entry);
    if (table > share_of_table * left) return 0;
    return std::int32_t(std::min({(left - table) / double(PagedLevel::bytes_of_brick(whole.data().stored)), bricks,
                                  double(PagedLevel::max_room(whole))}));
}

/// Makes it the level that is read; what was read of it before stays. False where there is no room.
bool Refiner::open(int level, const Medium& medium) {
    const bool is_kept = level_ && level_->level() == level;
    if (is_kept && &looks_.data() == &medium.data()) return true;
    if (!is_kept) {
        level_.reset();
        const DeviceVolume& whole = medium.data().volume;
        const std::int32_t room = room_at(level, whole);
        if (room < 1) return false;
        level_.emplace(source_, level, whole, room);
    }
    medium_ = paged_medium(*level_, medium, exact_ ? &*exact_ : nullptr);
    looks_ = medium;
    return true;
}

/// Casts rays until they miss nothing; without light, which hides no brick, while they may miss many. False where there
/// is no room. `incomplete` is called with a first picture of which much is missing.
bool Refiner::draw(int level, const Drawing& d, Progress& progress, const std::function<void()>& incomplete) {
    if (!open(level, d.medium)) return false;
    const Lighting plain{.shading = Shading::none};
    constexpr std::size_t few = 16;  // of so many one is missing
    bool is_lit = level_->bricks_there() > 0;
    for (bool is_first = true;; is_first = false) {
        level_->forget_seen();
        d.statistics = raycast(d.device, medium_, is_lit ? d.field : IlluminationField(), is_lit ? d.lighting : plain,
                               d.camera, telling(d.scene.sampling), d.frame, progress);
        progress.check();
        const std::vector<std::int64_t> missing = level_->missing();
        const bool misses_many = few * missing.size() > level_->bricks_there();
        if (incomplete && is_first && is_lit && misses_many) incomplete();
        if (!missing.empty() && !level_->read(missing, progress)) return false;
        if (missing.empty() && is_lit) return true;
        is_lit = few * missing.size() <= level_->bricks_there();
    }
}

PagingReport Refiner::report(int level, std::string stopped_by) const {
    PagingReport report{.level = level,
                        .levels = int(source_->levels().size()),
                        .light_level = whole_level_,
                        .dimensions = source_->levels()[std::size_t(level)].dimensions,
                        .stopped_by = std::move(stopped_by),
                        .bricks = 0,
                        .bricks_read = 0,
                        .faults = {}};
    if (!level_ || level == whole_level_) return report;
    report.bricks = level_->bricks_there(), report.bricks_read = level_->bricks_read();
    report.faults = level_->faults();
    if (const std::size_t lost = level_->bricks_lost(); lost > report.faults.size())
        report.faults.push_back(std::to_string(lost) + " bricks cannot be read: a coarser level stands for them");
    return report;
}

PagingReport Refiner::render(const Drawing& drawing, Progress& progress, const std::function<void()>& coarser) {
    const int wanted = wanted_level(drawing);
    std::string stopped_by = wanted > finest_level_ ? "pixels" : finest_level_ > 0 ? "level" : "volume";
    if (wanted == whole_level_) return report(wanted, std::move(stopped_by));
    if (std::string whole = needs_whole_level(drawing.scene, drawing.medium.data()); !whole.empty())
        return report(whole_level_, std::move(whole));
    std::unique_lock lock(drawing_, std::defer_lock);
    while (!lock.try_lock_for(std::chrono::milliseconds(20))) progress.check();
    int level = wanted;
    if (coarser) {
        level = level_ && level_->level() >= wanted ? level_->level() : std::max(wanted, whole_level_ - 1);
        bool has_room = true;
        for (; level > wanted && (has_room = draw(level, drawing, progress, coarser)); --level) coarser();
        if (!has_room) ++level, stopped_by = "memory";
    }
    for (; level < whole_level_ && !draw(level, drawing, progress, coarser); ++level) stopped_by = "memory";
    return report(level, std::move(stopped_by));
}

bool Refiner::draw_what_is_there(const Drawing& d, Progress& progress) {
    const std::unique_lock lock(drawing_, std::try_to_lock);
    if (!lock || !level_) return false;
    // A draft has fewer pixels than the picture whose voxels are there; finer ones would take too many steps.
    constexpr int finer = 2;
    if (level_->level() + finer < wanted_level(d) || !needs_whole_level(d.scene, d.medium.data()).empty()) return false;
    open(level_->level(), d.medium);
    d.statistics =
        raycast(d.device, medium_, d.field, d.lighting, d.camera, telling(d.scene.sampling), d.frame, progress);
    return true;
}

}  // namespace chiaro

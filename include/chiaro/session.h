// One viewer's state: each stage's result, kept with the inputs that made it.
#pragma once
#include <chiaro/brick_source.h>
#include <chiaro/device.h>
#include <chiaro/export.h>
#include <chiaro/medium.h>
#include <chiaro/scene.h>

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace chiaro {

/// Receives a picture that a better one follows.
using Preview = std::function<void(const Image&)>;

/// How a volume that does not fit is read.
struct PagingSettings {
    std::uint64_t memory_bytes = 0;  ///< what it may take; 0: half of what is free
    int finest_level = 0;            ///< no finer one is drawn
    /// All voxels are read once: the range of values, and which bricks are empty, are not those of a coarse level.
    bool exact = false;
    double budget_bytes() const;
};
/// Whether its pictures, light included, fit in the budget as a whole, and nothing coarser was asked for.
CHIARO_EXPORT bool fits(const BrickSource& source, const PagingSettings& settings);
/// The scene's volume where it is to be read by bricks; null: as a whole, as channels and moments in files of their own
/// are. Throws Error{usage} for a level that it has not, and as open_brick_source.
CHIARO_EXPORT std::shared_ptr<const BrickSource> paged_volume(const Scene& scene, const PagingSettings& settings);

/// What the last picture of such a volume was drawn from.
struct PagingReport {
    int level = 0, levels = 1;               ///< drawn, of so many; 0: the finest
    int light_level = 0;                     ///< whose grid light was found on; values and looks, too
    std::array<int, 3> dimensions{0, 0, 0};  ///< of the level drawn
    /// What no finer level was drawn for: "pixels" (a voxel is less than 1.5 of them), "level" (as asked), "volume"
    /// (there is none), "memory", or why all voxels are needed.
    std::string stopped_by;
    std::size_t bricks = 0, bricks_read = 0;  ///< of the level, in memory and since it was opened; 0: it is whole
    std::vector<std::string> faults;          ///< what cannot be read, a sentence each
};

/// What lights a draft: the last light that was computed, whatever for (none at first); the scene's own; or the scene's
/// own as far as every other voxel tells, an eighth of the work.
enum class DraftLight { last, own, soon };

/// Renders scenes one after the other and redoes only the stages to the right of what changed: an edit of the transfer
/// function starts at `classify`, a camera move is `raycast` and `develop`.
class Session {
public:
    /// On a GPU with a stream of its own.
    CHIARO_EXPORT explicit Session(const Device& device);
    CHIARO_EXPORT ~Session();
    CHIARO_EXPORT Session(Session&&) noexcept;

    /// Takes the volume that later scenes show (read_volume or make_sample gave it). Of a block of a volume
    /// (Volume::placement) nothing is measured: scenes give a transfer function and an interpolation.
    CHIARO_EXPORT void show(Volume&& volume, Progress& progress);
    /// The same of a volume that stays as it is, as one must whose voxels are borrowed and wanted later.
    CHIARO_EXPORT void show(const Volume& volume, Progress& progress);
    /// Takes the channels that later scenes show together, on one grid (read_channels). Two of which the first has
    /// `has_own_colors`: the first one's transfer function gives the opacity, the second one's the colour.
    CHIARO_EXPORT void show(std::vector<Volume>&& channels, Progress& progress);
    /// Takes another moment of the volume that is shown. What the values mean - their range, looks, noise - stays what
    /// show() found, so that all moments look alike; light is found anew. Throws Error{input} unless it has the same
    /// dimensions.
    CHIARO_EXPORT void show_moment(Volume&& volume, Progress& progress);
    CHIARO_EXPORT void show_moment(const Volume& volume, Progress& progress);
    /// The same of a volume that is read by bricks: a level that fits in a third of the budget as a whole, from which
    /// values, looks and light are found, and of finer ones what pictures show. A GPU has none of it: the CPU does all.
    /// Throws as BrickSource::read.
    CHIARO_EXPORT void show(std::shared_ptr<const BrickSource> source, const PagingSettings& settings,
                            Progress& progress);
    /// Promises that all renders to come look like the first one but for the camera, as the frames of a turntable do:
    /// voxels that cannot be seen are then given back. Renders with another transfer function, shape or classification,
    /// or light that needs all voxels, and fields throw Error{internal}.
    CHIARO_EXPORT void expect_one_look();
    /// Another session of the volume that this one shows: the voxels are shared, nothing else. May be called while this
    /// one renders, but not while it is given a volume.
    CHIARO_EXPORT Session share_volume() const;

    /// `preview` is handed the picture with each coarse light that comes before the finest (visibility, and each
    /// iteration of transport), while that is still being found; and with each pass of paths (reference). The first of
    /// coarse light is a draft: where the scene's interpolation is automatic it is linear there. Of a volume that is
    /// read by bricks, with each coarser level on the way to the one that is drawn, too.
    CHIARO_EXPORT const Image& render(const Scene& scene, Progress& progress, const Preview& preview = {});
    /// What can be shown at once. Of the reference's radiance one path a pixel. Where the scene's interpolation is
    /// automatic it is linear here. Of a volume that is read by bricks: what has been read. Of one of 220³ voxels or
    /// more, where samples are two voxels apart and pixels as large as voxels: every other voxel, without light or in
    /// its own spao, unless `light` is own. `coarse` is handed drafts in coarse light that comes before the scene's
    /// own, which take a quarter of the time at most. What render keeps stays kept.
    CHIARO_EXPORT const Image& preview(const Scene& scene, Progress& progress, DraftLight light = DraftLight::last,
                                       const Preview& coarse = {});
    /// Whether DraftLight::soon is another light than DraftLight::own: ambient occlusion (spao) in a volume of one
    /// value, of 220³ voxels or more.
    CHIARO_EXPORT bool is_lit_soon(const Scene& scene) const;
    /// Finds all that a render of the scene starts from, its light included, and draws nothing. Where ranks share the
    /// volume (Device::ranks) this is collective, as show() is; a render afterwards is not.
    CHIARO_EXPORT void find_light(const Scene& scene, Progress& progress);
    /// Whether a render would have to find light first.
    CHIARO_EXPORT bool needs_light(const Scene& scene) const;
    /// What the scene's lighting method computes for the shown volume. Throws as chiaro::compute_field.
    CHIARO_EXPORT ComputedField compute_field(const Scene& scene, Progress& progress);

    /// The scene's camera with the ball that one picture of what is shown fits: for pictures of other moments, too.
    CHIARO_EXPORT CameraSettings fit(const Scene& scene, Progress& progress);
    /// The scene's camera with the ball that all frames of a turntable fit (fit_camera). Of one picture renders find
    /// it themselves, each anew where the scene's camera has none yet: who wants it found once keeps camera().
    CHIARO_EXPORT CameraSettings fit_all_around(const Scene& scene, Progress& progress);
    /// Of the last render or preview, in stops.
    CHIARO_EXPORT double probe_exposure() const;
    /// The scene's, with the ball that the last render or preview fitted.
    CHIARO_EXPORT const CameraSettings& camera() const;
    /// The scene of the last render or preview with what that found: its camera, how the probe stands (stand_by_frame),
    /// and its exposure.
    CHIARO_EXPORT Scene as_seen(Scene scene) const;

    /// Of the last render; while `preview` is called with paths, theirs. A GPU brings it when it is first asked for.
    CHIARO_EXPORT const Frame& frame() const;
    /// The same with `depth_mm` (find_depth), which is found when first asked for. Throws Error{internal} where there
    /// is none: before the first render, or after a preview of other matter.
    CHIARO_EXPORT const Frame& frame_with_depth(Progress& progress);
    /// Of the last render or field, in order; a stage whose kept result served took 0. What a stage consists of follows
    /// it.
    CHIARO_EXPORT const std::vector<Stage>& stages() const;
    /// What is shown: of several channels the first; of a volume that is read by bricks the level that is there whole,
    /// while `finest` is the grid of level 0 and `source` where its voxels are read from (null: it is there whole).
    CHIARO_EXPORT const DeviceVolume& volume() const;
    CHIARO_EXPORT SourceLevel finest() const;
    CHIARO_EXPORT std::shared_ptr<const BrickSource> source() const;
    CHIARO_EXPORT std::vector<DeviceVolume> volumes() const;  ///< of all its channels
    CHIARO_EXPORT const Medium& medium() const;               ///< of the last render or preview
    CHIARO_EXPORT const IlluminationField& light() const;     ///< of the last render
    /// What a user should know: of what was prepared, of the device.
    CHIARO_EXPORT std::vector<std::string> notes() const;
    /// Of the last render of a volume that is read by bricks; none: it is there as a whole.
    CHIARO_EXPORT std::optional<PagingReport> paging() const;
    CHIARO_EXPORT RenderStatistics render_statistics() const;  ///< of the last render; its paths, as frame()
    CHIARO_EXPORT std::size_t light_bytes() const;  ///< held: what the last render's lighting prepared, and its light
    CHIARO_EXPORT const Statistics& statistics() const;  ///< of the shown volume
    /// What the scene shows of the volume's channels; of a volume of one value that one. Throws Error{usage} where the
    /// scene has others than were read.
    CHIARO_EXPORT std::vector<Channel> channels(const Scene& scene) const;
    /// The scene's labels with the looks of their table, read where they were not yet, once for all sessions that share
    /// the volume; null: it has none. May be called while this one renders. Throws as read_labels.
    CHIARO_EXPORT std::shared_ptr<const LabelVolume> labels(const Scene& scene, Progress& progress) const;
    /// What the settings ask for, of the shown volume. Throws as load_transfer_function.
    CHIARO_EXPORT TransferFunction resolve(const TransferSettings& settings) const;
    /// The one the last render used, window and unit applied.
    CHIARO_EXPORT const TransferFunction& transfer_function() const;
    CHIARO_EXPORT const Guess& guess() const;  ///< what the shown volume seems to be

private:
    struct State;
    std::unique_ptr<State> state_;
};

/// A whole picture in one call: read, the six pipeline stages, done.
CHIARO_EXPORT Image render_image(const Device& device, const Scene& scene, Progress& progress);

}  // namespace chiaro

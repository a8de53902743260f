// Everything that a picture needs, and its JSON form.
#pragma once
#include <chiaro/camera.h>
#include <chiaro/error.h>
#include <chiaro/export.h>
#include <chiaro/image.h>
#include <chiaro/io.h>
#include <chiaro/labels.h>
#include <chiaro/lighting.h>
#include <chiaro/marks.h>
#include <chiaro/render.h>
#include <chiaro/slice.h>
#include <chiaro/transfer_function.h>

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace chiaro {

/// Where the transfer function comes from and what is done to it.
struct TransferSettings {
    std::string source;                                  ///< file, preset or colour map; empty: guessed from the data
    std::optional<TransferFunction> points;              ///< given in the scene itself; wins over `source`
    std::optional<std::pair<double, double>> window;     ///< centre, width
    std::optional<std::pair<double, double>> threshold;  ///< low, high; outside is transparent
    double opacity_scale = 1;                            ///< multiplies the extinction
    std::optional<double> opacity_unit;     ///< in units of the smallest voxel size; replaces the function's own
    std::optional<double> opacity_unit_mm;  ///< in mm; one of the two at most
    bool operator==(const TransferSettings&) const = default;
};

/// Structures that lie in the volume (docs/labels.md); in a volume that is its own labels nothing else is shown.
struct LabelSettings {
    std::string source;                ///< as for read_labels; empty: none
    std::string table;                 ///< as for read_label_table; empty: none
    std::vector<LabelChange> changes;  ///< of what the table says; at most `max_labels`
    /// In the place of source and table labels that are in memory (make_labels), which scene files do not hold. Where
    /// `source` is the volume's name, too, the volume is its own labels.
    std::shared_ptr<const LabelVolume> loaded{};
    bool any() const { return loaded || !source.empty(); }
    bool operator==(const LabelSettings&) const = default;
};

/// What a scene file expects of its volume. Size and type are checked; the spacing replaces the file's.
struct ExpectedVolume {
    std::optional<std::array<int, 3>> dimensions;
    std::optional<VoxelType> type;
    std::optional<Vec3> spacing_mm;
    bool operator==(const ExpectedVolume&) const = default;
};

/// One of several values of a voxel, and how it looks.
struct ChannelSettings {
    std::string file;           ///< as Scene::volume; empty: the next component of the volume itself
    std::string name;           ///< empty: "channel 1" and so on
    TransferSettings transfer;  ///< none named: of the first channel the scene's, else a ramp in a colour of its own
    double gain = 1;            ///< as Channel
    bool show = true;           ///< false: as gain 0
    bool operator==(const ChannelSettings&) const = default;
};

/// The same scene gives the same picture.
struct Scene {
    std::string volume;  ///< as for read_volume; relative names are resolved by read_scene
    ExpectedVolume stated;
    ReadOptions read;
    LabelSettings labels;
    TransferSettings transfer;
    std::vector<ChannelSettings> channels;  ///< what is said of them; components that are not listed are shown, too
    Mode mode = Mode::dvr;
    std::vector<IsoSurface> iso;  ///< for Mode::iso
    Clip clip;
    Interpolation interpolation = Interpolation::automatic;  ///< of a scene file that names none: linear
    CameraSettings camera;
    Lighting lighting;
    IlluminationSettings illumination{.method = Method::spao};  ///< of a scene file that names none: none
    RaySettings sampling;
    ToneMap output;  ///< its `color` is the scene's colour mode
    int width = 1024, height = 768;
    SliceSettings slices;     ///< of viewers: this and what follows
    std::vector<Mark> marks;  ///< at most `max_marks`
};

/// The probe that the settings name: as load_probe of their source, or, called "lights", one of the lighting's own
/// lights, which then must be fixed to the world's directions. Throws as load_probe, and Error{usage}.
CHIARO_EXPORT Probe load_probe(const Lighting& lighting);

/// What a volume is shown with where nothing else is said: from where its frame has it, with the probe beside that
/// (`by_frame` of either), samples that name materials (SampleInfo) pre-classified.
CHIARO_EXPORT Scene scene_of_volume(const std::string& volume);

/// Puts what a volume's frame says in the place of `by_frame`: where the camera looks from (look_from), and the probe
/// turned so that its lights stand beside that view as they do around volumes without an anatomical frame.
CHIARO_EXPORT void stand_by_frame(Scene& scene, World world);

/// Throws Error{code} when settings contradict each other.
CHIARO_EXPORT void check(const Scene& scene, ErrorCode code);

/// Reads the scene's volume. The size and type that the scene states are checked; its spacing replaces the file's (and
/// a note says so where the two differ). Throws Error{input}, or Error{interrupted} when cancelled.
CHIARO_EXPORT Volume read_volume(const Scene& scene, Progress& progress);

/// All of the scene's channels on the volume's grid: its components, then the files of `channels`, resampled where
/// their grid is another (which a note of theirs says). Throws as read_volume, and Error{input} for more than
/// `max_channels`.
CHIARO_EXPORT std::vector<Volume> read_channels(const Scene& scene, Progress& progress);
/// What the scene says of its channels, one for each, where the volume itself has so many components.
CHIARO_EXPORT std::vector<ChannelSettings> channels_of(const Scene& scene, int components);
/// Reads the scene's labels, without its changes. Throws as read_labels of a file.
CHIARO_EXPORT LabelVolume read_labels(const Scene& scene, Progress& progress);

/// The scene with its files named as seen from a folder, to be kept in a file there.
CHIARO_EXPORT Scene seen_from(Scene scene, const std::filesystem::path& folder);

/// Reads a scene file (docs/scene.md), the scene that a PNG or OpenEXR file of ours carries, or ParaView's state
/// (.pvsm, read_paraview_state). A relative volume is looked up beside the file, then in `data_folder`. `notes`: of a
/// state what is left out; else the keys that this version does not know, as of parse_scene. Throws Error{input}.
CHIARO_EXPORT Scene read_scene(const std::filesystem::path& file, const std::filesystem::path& data_folder,
                               std::vector<std::string>& notes);
/// The first volume that a state file of ParaView (.pvsm) shows, as a scene: its file, colour map, camera, background
/// and, of the representation Chiaro, settings. `notes`: what is left out, a sentence each. Throws Error{input}.
CHIARO_EXPORT Scene read_paraview_state(const std::filesystem::path& file, const std::filesystem::path& data_folder,
                                        std::vector<std::string>& notes);
/// The scene as JSON; parse_scene of it gives the same scene. Of keys that this version does not know, `unknown_keys`
/// names the first eight, the last of them with how many others there are.
CHIARO_EXPORT std::string to_json(const Scene& scene);
CHIARO_EXPORT Scene parse_scene(const std::string& json, const std::filesystem::path& folder,
                                const std::filesystem::path& data_folder, std::vector<std::string>& unknown_keys);

}  // namespace chiaro

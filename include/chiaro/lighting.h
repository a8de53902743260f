// Light, shading and the choice of an illumination method.
#pragma once
#include <chiaro/export.h>
#include <chiaro/medium.h>
#include <chiaro/probe.h>
#include <chiaro/settings.h>
#include <chiaro/transfer_function.h>

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace chiaro {

enum class Shading { none, lambert, phong };

/// Stops, or (none) as much as suits the probe: one from a file is as bright as min(.45 / mean, 1.2 / largest) makes
/// it, of E/π in luminance over all normals; built-in ones are as they are.
struct ProbeExposure {
    std::optional<double> stops;
    ProbeExposure() = default;
    ProbeExposure(double given) : stops(given) {}
    bool operator==(const ProbeExposure&) const = default;
};

/// The environment map (HDRI, light probe) that lights the volume, and how it is turned in the world.
struct ProbeSettings {
    std::string source;       ///< a file, or one of list_probes(); empty: the lighting method's own default
    double rotation_deg = 0;  ///< added to the azimuth of what the probe shows
    ProbeExposure exposure;   ///< its light is multiplied by 2^stops
    bool background = false;  ///< the picture shows it behind the volume
    /// Not a setting: nobody said how it is turned, so the volume's frame does (stand_by_frame).
    bool by_frame = false;
    bool operator==(const ProbeSettings&) const = default;
};

/// A matte floor under the lowest of what is visible, perpendicular to the light's up (Camera::orbit_up): it takes
/// shadows and reflects light; it fades out around the subject, and is not seen from below.
struct FloorSettings {
    bool show = false;
    double albedo = 0.5;
    bool operator==(const FloorSettings&) const = default;
};

/// Along the camera's axis (a headlight), from a direction, or from a place; as bright at any distance.
struct Light {
    bool headlight = true;                      ///< else azimuth and elevation, or a position
    double azimuth_deg = 0, elevation_deg = 0;  ///< towards the light, in the orbit's angles, fixed to the world
    Rgb color{1, 1, 1};                         ///< sRGB, as picked; beyond 1: brighter
    std::optional<Vec3> position_mm{};          ///< of a point light, world
    bool operator==(const Light&) const = default;
};
inline constexpr int max_lights = 8;

/// Lights with Blinn-Phong reflection (Blinn 1977), whose shares add up, and what lights from all around.
struct Lighting {
    Shading shading = Shading::phong;
    double ambient = 0.2, diffuse = 0.7, specular = 0.3, shininess = 20;
    std::vector<Light> lights{Light{}};  ///< at most `max_lights`
    double strength = 1;                 ///< of the illumination method: A' = 1 - strength (1 - A)
    ProbeSettings probe;
    FloorSettings floor;
    Probe loaded_probe;            ///< of `probe.source`; none: a white one where an environment map is needed
    std::optional<Vec3> probe_up;  ///< for `illuminate`: Camera::orbit_up of the picture; none: +z
    bool operator==(const Lighting&) const = default;
};

/// What the exposure of its probe is, in stops: auto is found from the loaded probe, once (some 10 core-ms).
CHIARO_EXPORT double exposure_stops(const Lighting& lighting);

/// The methods that this build has; a new one is one new value and one new folder.
enum class Method { none, spao, visibility, histogram, transport, reference };

/// How the means over cubes are found: all at full resolution, by mipmaps, by N-buffers over some mipmaps, exactly from
/// a table of sums, or (automatic) by a fused sweep over blocks that keeps no level.
enum class SpaoFilter { automatic, nbuffer, mipmap, hybrid, exact };
/// The published product over shells (paper); the same with each shell's thickness as exponent; and the product per
/// octant.
enum class SpaoModel { paper, thick, corrected };

/// Smooth probabilistic ambient occlusion (Kroes, Schut and Eisemann, GPU Zen).
struct SpaoSettings {
    SpaoFilter filter = SpaoFilter::automatic;
    int levels = 7;            ///< shells: cubes of width 2^0 to 2^levels cells
    int mip_levels = 1;        ///< of the hybrid: mipmaps before the N-buffers
    double normal_factor = 1;  ///< 0: obscurance (over all directions), else ambient occlusion (over those outwards)
    SpaoModel model = SpaoModel::corrected;
    bool operator==(const SpaoSettings&) const = default;
};

/// How the transmittance towards a direction is found: plane by plane for all nodes at once, interpolating what the
/// plane before holds (sweep) or along straight rays through one lattice (sheared); or node by node, with steps that
/// grow through a pyramid (hierarchical), or by steps of one cell (full).
enum class VisibilityTraversal { sweep, sheared, hierarchical, full };
/// The level that a growing step reads: the published log2 of it, or one below. With `corrected` matter that has a
/// surface is also lit as a surface: looked up one voxel outwards (normal offset), by Lambert's law.
enum class VisibilityModel { corrected, paper };
/// Factors per band that trade ringing for sharpness.
enum class ShWindow { none, hann, lanczos };
enum class ShStorage { u8, f16, f32 };

/// Directions over the sphere: one Fibonacci set for all nodes, or one of several jittered sets for each.
struct ShSampling {
    bool jittered = false;
    int sets = 16;  ///< of the jittered
    bool operator==(const ShSampling&) const = default;
};

/// Visibility in spherical harmonics (Ritschel 2007).
struct VisibilitySettings {
    int bands = 4;         ///< 2 or 4: bands² coefficients a node
    int directions = 400;  ///< N
    int subsample = 2;     ///< 1, 2, 4 or 8: a node for so many cells per axis
    VisibilityTraversal traversal = VisibilityTraversal::sweep;
    ShSampling sampling;
    VisibilityModel model = VisibilityModel::corrected;
    ShWindow window = ShWindow::none;
    ShStorage storage = ShStorage::u8;
    bool operator==(const VisibilitySettings&) const = default;
};

/// How the histograms around each cell are found: by box filters fitted to 1/d² and the first moment of direction
/// (fast); all cells of the spherical neighbourhood alike, from the neighbour's (sweep: no weights, no hemispheres); or
/// cell by cell.
enum class HistogramPath { fast, sweep, exact };
/// How bins are joined before histograms are compared: the smallest into its neighbours (paper), evenly, or so that the
/// volume's cumulative histogram changes least.
enum class HistogramPacking { paper, uniform, cumulative };
/// The distance of two histograms: of Euclid, the sum or the largest of the differences.
enum class HistogramMetric { l2, l1, lmax };
/// Light is exp(-r O), with O the fraction of matter around; or the published 1 - O, mixed as luma and chroma.
enum class HistogramModel { corrected, paper };

/// What is shown of the light that histograms know; each alone, or together.
struct HistogramEffects {
    bool ao = true, bleeding = true, scattering = false, emission = false;
    bool operator==(const HistogramEffects&) const = default;
};

/// Local histograms (Ropinski et al. 2008): found once for a volume, whatever its transfer function.
struct HistogramSettings {
    int radius = 16;  ///< of the spherical neighbourhood of a cell, in units of the smallest voxel size; 0: proposed
                      ///< from the data
    int clusters = 2048;   ///< size of the codebook: histograms that stand for all
    int packed_bins = 64;  ///< in which histograms are compared
    HistogramPacking packing = HistogramPacking::uniform;
    HistogramMetric metric = HistogramMetric::l2;
    HistogramPath path = HistogramPath::fast;
    int subsample = 1;  ///< 1, 2 or 4: identifiers at every so many cells per axis
    HistogramModel model = HistogramModel::corrected;
    HistogramEffects effects;
    double anisotropy = 0;  ///< g of Henyey and Greenstein, > 0: forward
    std::string emission;   ///< "LO:HI=STRENGTH" in data units, or a file of lines "VALUE STRENGTH"
    std::string cache;      ///< folder of prepared volumes; "": the user's own; "none"
    int channel = 0;        ///< of several channels: whose values are counted, from 1; 0: refused
    bool operator==(const HistogramSettings&) const = default;
};

/// What rays find out for every voxel: the mean transmittance over all directions, over those outwards, over those
/// weighted by their cosine, or its 16 coefficients in spherical harmonics (a field only, no picture); or along paths
/// that scatter: for every voxel the mean radiance J over all directions (the fluence rate over 4π; a field only), for
/// every pixel radiance (a picture only, no field).
enum class ReferenceQuantity { obscurance, ao, ao_cosine, visibility, mean_radiance, radiance };
/// Whether the extinction is constant in each voxel or interpolated between them.
enum class ReferenceMedium { voxels, trilinear };

/// The ground truth, by brute force: rays in all directions from every voxel, or paths through every pixel.
struct ReferenceSettings {
    int rays = 256;                             ///< or paths from a voxel, through a pixel
    std::optional<ReferenceQuantity> quantity;  ///< missing: radiance for a picture, obscurance for a field
    ReferenceMedium medium = ReferenceMedium::voxels;
    double start_half_voxels = 1;  ///< rays begin this far from the centre, in half voxel widths
    int subsample = 1;             ///< only every so many voxels per axis; between them trilinear (harmonics: one node)
    std::optional<double> time_s;  ///< of radiance and mean radiance: no more paths after this time,
    std::optional<double> error;   ///< nor when the RMS standard error over the RMS luminance is so small
    bool operator==(const ReferenceSettings&) const = default;
};

/// Multiple scattering by discrete ordinates (S_N): iterated sweeps in few directions.
struct TransportSettings {
    int grid = 64;                ///< cells of the light grid on the long axis
    int directions = 24;          ///< of scattered light, an iteration
    int first_directions = 200;   ///< of uncollided light
    std::optional<double> error;  ///< no more iterations once one changes less (relative RMS of J)
    bool operator==(const TransportSettings&) const = default;
};

/// How often light is scattered beyond the first time.
struct Bounces {
    std::optional<int> most;  ///< none: until it has left or is spent
    bool operator==(const Bounces&) const = default;
};

/// How light is scattered, for the methods that follow it: transport and reference.
struct ScatteringSettings {
    Bounces bounces;          ///< 0: single scattering, which shows colours as they are
    double albedo_max = 0.9;  ///< else the albedo is the colour, scaled down to this where a channel is above
    std::uint64_t seed = 0;   ///< of all that is drawn at random
    double anisotropy = 0;    ///< g of Henyey and Greenstein in (-1, 1), forwards above 0; for callers of the library
    /// Of the largest channel of an albedo; none where light is scattered once, which shows colours as they are.
    std::optional<double> albedo_limit() const { return bounces.most == 0 ? std::nullopt : std::optional(albedo_max); }
    bool operator==(const ScatteringSettings&) const = default;
};

/// What light meets: particles everywhere, or surfaces where opacity rises steeply (docs/theory/light.md).
enum class SurfaceModel { none, automatic };

struct IlluminationSettings {
    Method method = Method::none;
    std::optional<SurfaceModel> surfaces;  ///< missing: automatic, but for the reference's mean radiance none
    SpaoSettings spao;
    VisibilitySettings visibility;
    HistogramSettings histogram;
    TransportSettings transport;
    ReferenceSettings reference;
    ScatteringSettings scattering;
    bool operator==(const IlluminationSettings&) const = default;
};

/// The one that is asked for, or the method's own. With none all methods light particles: accessibility is neither
/// read at a normal offset nor scaled, visibility is the published model's.
inline SurfaceModel surface_model(const IlluminationSettings& settings) {
    const bool is_field =
        settings.method == Method::reference && settings.reference.quantity == ReferenceQuantity::mean_radiance;
    return settings.surfaces.value_or(is_field ? SurfaceModel::none : SurfaceModel::automatic);
}
inline bool shows_surfaces(const IlluminationSettings& settings) {
    return surface_model(settings) == SurfaceModel::automatic;
}

/// Whether a field holds the light of a probe, so that `illuminate` depends on it; others are lit when they are seen.
inline bool holds_light(const IlluminationSettings& settings) { return settings.method == Method::transport; }

/// Whether a picture comes from trace_paths, which needs no field, rather than from raycast.
inline bool is_path_traced(const IlluminationSettings& settings) {
    return settings.method == Method::reference &&
           settings.reference.quantity.value_or(ReferenceQuantity::radiance) == ReferenceQuantity::radiance;
}

struct MethodInfo {
    std::string name, sentence;
};
CHIARO_EXPORT std::vector<MethodInfo> list_methods();

/// What depends on the data alone: local histograms; empty for other methods. Cheap to copy.
class Prepared {
public:
    struct Data;  // src/illumination/prepared.h
    Prepared() = default;
    explicit Prepared(std::shared_ptr<const Data> data) : data_(std::move(data)) {}
    const Data& data() const { return *data_; }
    explicit operator bool() const { return data_ != nullptr; }

    CHIARO_EXPORT std::size_t bytes() const;                 ///< held, beside the volume
    CHIARO_EXPORT const std::vector<Stage>& stages() const;  ///< how long each step took
    /// What a user should know: a damaged cache, a folder not writable.
    CHIARO_EXPORT const std::vector<std::string>& notes() const;

private:
    std::shared_ptr<const Data> data_;
};

/// The light that a method computed, looked up by the ray caster at every sample. Cheap to copy.
class IlluminationField {
public:
    struct Data;                        // src/illumination/field.h
    CHIARO_EXPORT IlluminationField();  ///< no illumination method: all light arrives
    explicit IlluminationField(std::shared_ptr<const Data> data) : data_(std::move(data)) {}
    const Data& data() const { return *data_; }

    CHIARO_EXPORT std::size_t bytes() const;                 ///< held for the ray caster
    CHIARO_EXPORT bool is_coarse() const;                    ///< whether a finer one follows
    CHIARO_EXPORT const std::vector<Stage>& stages() const;  ///< how long each step took

private:
    std::shared_ptr<const Data> data_;
};

/// What a method computed, to be kept or measured.
struct ComputedField {
    Volume volume;              ///< float32 on the grid of the voxels or of nodes; key_values tell how it was made
    std::vector<Stage> stages;  ///< how long each step took
};

/// Receives a coarse field, then finer ones.
using Sink = std::function<void(IlluminationField)>;

/// What the method needs to know of the data, whatever its transfer function. Cost: histograms some seconds for 256³,
/// or reading some megabytes where they were prepared before (HistogramSettings::cache); nothing for other methods.
/// Throws Error{interrupted} when cancelled.
CHIARO_EXPORT Prepared prepare(const DeviceVolume& volume, const IlluminationSettings& settings, Progress& progress);
/// The same by another device than the volume's, as `classify` has it.
CHIARO_EXPORT Prepared prepare(const Device& device, const DeviceVolume& volume, const IlluminationSettings& settings,
                               Progress& progress);

/// The settings that `prepare` depends on, all others at their defaults: what was prepared serves while these are
/// equal.
CHIARO_EXPORT IlluminationSettings preparation_of(const IlluminationSettings& settings);

/// A radius for local histograms, in units of the smallest voxel size: how far cells are from the next strong edge, on
/// average.
CHIARO_EXPORT int proposed_radius(const DeviceVolume& volume);

/// Hands at least one field to `sink` unless cancelled, which it is between the iterations of transport too. Of
/// `lighting` only what a field holds counts: for transport the probe, turned but not exposed, else nothing. `warm`: a
/// field of the same volume, whose light transport starts from (an edit, a turned probe); whatever it is, the last
/// field is that of a start from nothing within what an iteration still changes. Returns false when cancelled.
CHIARO_EXPORT bool illuminate(const Device& device, const Medium& medium, const Prepared& prepared,
                              const Lighting& lighting, const IlluminationSettings& settings, const Sink& sink,
                              Progress& progress, const IlluminationField& warm = {});

/// The method's own result for every voxel, neither read at a normal offset nor scaled as a picture needs it:
/// accessibility, 1 = all light arrives; of transport J, the mean radiance (three components, 1 in an empty white
/// probe), at the cells of its own grid; of the reference's quantity visibility, 16 components in spherical harmonics,
/// a node for every `subsample`³ cells; of its mean radiance J too, at the centres of `subsample`³ voxels. Throws
/// Error{usage} for a method that computes no field and for maxima along rays (which have no place that could be lit),
/// Error{interrupted} when cancelled.
CHIARO_EXPORT ComputedField compute_field(const Device& device, const Medium& medium, const Prepared& prepared,
                                          const Lighting& lighting, const IlluminationSettings& settings,
                                          Progress& progress);

}  // namespace chiaro

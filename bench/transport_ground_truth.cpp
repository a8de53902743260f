#include "transport_ground_truth.h"

#include <chiaro/samples.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>

#include "turntable.h"
#include "volume/device_view.h"

namespace chiaro::bench {
namespace {

/// How a subject is made and seen.
struct Recipe {
    const char *name, *file;  ///< no file: a sample
    CameraSettings camera;
};

const std::vector<Recipe>& recipes() {
    static const std::vector<Recipe> list{
        {"cornell", "", {.azimuth_deg = 270, .elevation_deg = 0}},
        {"fog", "", {}},
        {"engine", "engine.nrrd", {.zoom = 1 / 0.62}},
        {"carp", "carp.nii.gz", {.azimuth_deg = 20, .elevation_deg = 15, .zoom = 1.8, .up = Vec3{0, 0, -1}}},
        {"head", "cthead.nrrd", {.azimuth_deg = 215, .elevation_deg = 20, .zoom = 1.5, .up = Vec3{0, 0, -1}}}};
    return list;
}

/// Bone, in the stored values of cthead.
TransferFunction bone() {
    TransferFunction tf;
    tf.points = {{1150, {1, 0.95, 0.85}, 0}, {1350, {1, 0.95, 0.85}, 1}};
    return tf;
}

/// The value of the first material; the others follow one by one.
constexpr int first_value = 4090;

/// The sample's values, 40 apart, moved together. Between air and a wall lie all values below the wall's: as they are,
/// its neighbours' colours would cover each wall with an opaque skin, and the box were white. Moved to 200, 201 ...
/// they would still cover the ball with a quarter of an optical depth. The first slice is air: camera paths enter
/// voxels at their centres, which in a wall's front are dark.
Volume tidy_cornell(const Volume& cornell) {
    Volume tidy = make_volume(cornell.dimensions, VoxelType::u16);
    tidy.geometry = cornell.geometry;
    const auto [nx, ny, nz] = cornell.dimensions;
    const auto from = cornell.as<std::uint8_t>();
    const auto to = tidy.as<std::uint16_t>();
    for (std::size_t i = 0; i < from.size(); ++i) {
        const bool in_front = i / std::size_t(nx) % std::size_t(ny) == 0;
        to[i] = std::uint16_t(from[i] == 0 || in_front ? 0 : first_value - 1 + from[i] / 40);
    }
    return tidy;
}

/// The sample's colours for these values; nothing just below the first.
TransferFunction tidy_cornell(const TransferFunction& cornell) {
    TransferFunction tf;
    tf.points.push_back({first_value - 0.1, cornell.points[0].rgb, 0});
    for (int i = 0; i < 5; ++i)
        for (const double value : {first_value + i - (i == 0 ? 0.1 : 0.5), first_value + i + 0.5})
            tf.points.push_back({value, cornell.points[std::size_t(4 * i)].rgb, 1});
    return tf;
}

TransferFunction transfer_of(const std::string& name, const Volume& volume) {
    if (name == "head") return bone();
    if (name == "carp") return preset("micro-ct", measure(volume));
    if (const auto of_scene = scene_function(name)) return *of_scene;
    const TransferFunction tf = sample_transfer_function(name);
    return name == "cornell" ? tidy_cornell(tf) : tf;
}

TransferFunction painted(TransferFunction tf) {
    for (ControlPoint& point : tf.points) {
        const double most = std::max({point.rgb[0], point.rgb[1], point.rgb[2]});
        for (double& channel : point.rgb) channel = most > 0 ? channel / most : 1;
    }
    return tf;
}

/// Words from a counter (the finaliser of SplitMix64: Steele, Lea and Flood 2014).
std::uint64_t word(std::uint64_t counter) {
    std::uint64_t z = (counter + 1) * 0x9e3779b97f4a7c15u;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
}

bool read_floats(const std::filesystem::path& path, std::vector<float>& values) {
    std::ifstream file(path, std::ios::binary);
    file.read(reinterpret_cast<char*>(values.data()), std::streamsize(values.size() * sizeof(float)));
    return bool(file) && file.peek() == std::ifstream::traits_type::eof();
}

void write_floats(const std::filesystem::path& path, const std::vector<float>& values) {
    const std::filesystem::path part = path.string() + ".part";
    std::ofstream file(part, std::ios::binary);
    file.write(reinterpret_cast<const char*>(values.data()), std::streamsize(values.size() * sizeof(float)));
    file.close();
    if (file) std::filesystem::rename(part, path);
}

}  // namespace

DeviceVolume ScatteringSubject::voxels() const { return medium.data().volume; }

const std::vector<std::string>& scattering_subjects() {
    static const std::vector<std::string> names = [] {
        std::vector<std::string> list;
        for (const Recipe& recipe : recipes()) list.emplace_back(recipe.name);
        return list;
    }();
    return names;
}

std::optional<ScatteringSubject> find_scattering_subject(const Device& device, const std::filesystem::path& data,
                                                         const std::string& name, Progress& progress) {
    constexpr int sample_size = 128;
    for (const Recipe& recipe : recipes()) {
        if (name != recipe.name) continue;
        const auto file = *recipe.file ? real_file(data, recipe.file) : std::filesystem::path();
        if (!file) return std::nullopt;
        Volume volume =
            *recipe.file ? read_volume(file->string(), ReadOptions{}, progress) : make_sample(name, sample_size);
        if (name == "cornell") volume = tidy_cornell(volume);
        ScatteringSubject subject{.name = name, .device = device, .paint = painted(transfer_of(name, volume))};
        subject.scene.camera = recipe.camera;
        subject.scene.width = 160, subject.scene.height = 120;
        subject.scene.lighting.shading = Shading::none;
        subject.scene.sampling.classification = Classification::preintegrated;
        subject.scene.sampling.early_termination = 0;
        subject.medium = classify(upload(device, std::move(volume)), subject.paint, Shape{});
        return subject;
    }
    return std::nullopt;
}

std::string ScatteringCase::name() const {
    return fmt::format("{}-albedo{}-start{}{}", probe, albedo, start_half_voxels,
                       bounces ? fmt::format("-bounces{}", *bounces) : "");
}

IlluminationSettings ScatteringCase::settings(Method method) const {
    IlluminationSettings settings{.method = method, .surfaces = SurfaceModel::none};
    settings.reference.start_half_voxels = start_half_voxels;
    settings.scattering.albedo_max = albedo;
    settings.scattering.bounces.most = bounces;
    return settings;
}

Lighting ScatteringCase::lighting() const {
    Lighting lighting{.shading = Shading::none};
    lighting.probe.source = probe;
    lighting.loaded_probe = load_probe(probe);
    return lighting;
}

const OpticalTable::Entry& entry_at(const Medium& medium, Vec3 p) {
    const Medium::Data& data = medium.data();
    const double value = with_stored_voxel(data.volume.data(), [&](auto voxel) {
        const auto view = view_of<decltype(voxel)>(data.volume.data());
        const auto q = view.clamp(kernel::Vec3<float>(float(p.x), float(p.y), float(p.z)));
        return double(view.value(view.locate(q, view.voxel(q))));
    });
    const auto last = double(data.table.entries.size() - 1);
    return data.table.entries[std::size_t(std::clamp(data.table.index_of(value) + 0.5, 0.0, last))];
}

MeasuredPoints measured_points(const ScatteringSubject& subject, int air, int matter) {
    MeasuredPoints points;
    const auto n = subject.voxels().dimensions();
    const double edge = subject.voxels().geometry().smallest_spacing_mm();
    std::uint64_t counter = 0;
    const auto place = [&](int axis) { return double(word(counter++) >> 11) * 0x1p-53 * n[axis] - 0.5; };
    constexpr int max_tries = 1'000'000;
    for (int i = 0; i < max_tries && int(points.air.size() + points.matter.size()) < air + matter; ++i) {
        const Vec3 p{place(0), place(1), place(2)};
        const double extinction = entry_at(subject.medium, p).extinction_per_mm;
        const bool is_air = extinction == 0;
        if (extinction * edge > 1) continue;
        std::vector<Vec3>& kind = is_air ? points.air : points.matter;
        if (int(kind.size()) < (is_air ? air : matter)) kind.push_back(p);
    }
    return points;
}

GroundTruthCache::GroundTruthCache() {
    if (const char* folder = std::getenv("CHIARO_TRUTH_DIR")) folder_ = folder;
}

std::filesystem::path GroundTruthCache::place(const std::string& name) const {
    if (folder_.empty()) return {};
    std::filesystem::create_directories(folder_);
    return folder_ / name;
}

MeanRadiance GroundTruthCache::mean_radiance(const ScatteringSubject& subject, const ScatteringCase& which,
                                             const std::string& points, const std::vector<Vec3>& at, int paths,
                                             Progress& progress) const {
    const auto file = place(fmt::format("{}-{}-{}{}-{}.points", subject.name, which.name(), points, at.size(), paths));
    std::vector<float> kept(4 * at.size());
    MeanRadiance mean_radiance;
    if (!file.empty() && read_floats(file, kept)) {
        for (std::size_t i = 0; i < kept.size(); i += 4) {
            mean_radiance.mean.push_back({kept[i], kept[i + 1], kept[i + 2]});
            mean_radiance.error.push_back(kept[i + 3]);
        }
        return mean_radiance;
    }
    IlluminationSettings settings = which.settings(Method::reference);
    settings.reference.rays = paths;
    mean_radiance =
        trace_mean_radiance(subject.device, subject.medium, which.lighting(), {0, 0, 1}, at, settings, progress);
    progress.check();
    for (std::size_t i = 0; i < at.size(); ++i) {
        for (std::size_t c = 0; c < 3; ++c) kept[4 * i + c] = float(mean_radiance.mean[i][c]);
        kept[4 * i + 3] = float(mean_radiance.error[i]);
    }
    if (!file.empty()) write_floats(file, kept);
    return mean_radiance;
}

std::pair<Frame, PathStatistics> GroundTruthCache::image(const ScatteringSubject& subject, const ScatteringCase& which,
                                                         int paths, Progress& progress) const {
    const Scene& scene = subject.scene;
    const auto file =
        place(fmt::format("{}-{}-{}x{}-{}.picture", subject.name, which.name(), scene.width, scene.height, paths));
    Frame frame(scene.width, scene.height);
    std::vector<float> kept(frame.rgba.size() + 2);
    PathStatistics statistics{.samples = paths};
    if (!file.empty() && read_floats(file, kept)) {
        std::copy_n(kept.begin(), frame.rgba.size(), frame.rgba.begin());
        statistics.noise = kept[frame.rgba.size()], statistics.relative_noise = kept[frame.rgba.size() + 1];
        return {std::move(frame), statistics};
    }
    IlluminationSettings settings = which.settings(Method::reference);
    settings.reference.rays = paths;
    const DeviceVolume voxels = subject.voxels();
    const Camera camera = make_camera(scene.camera, voxels.geometry(), voxels.dimensions());
    statistics =
        trace_paths(subject.device, subject.medium, which.lighting(), camera, scene.sampling, settings, frame, progress)
            .paths;
    progress.check();
    std::copy(frame.rgba.begin(), frame.rgba.end(), kept.begin());
    kept[frame.rgba.size()] = float(statistics.noise), kept[frame.rgba.size() + 1] = float(statistics.relative_noise);
    if (!file.empty()) write_floats(file, kept);
    return {std::move(frame), statistics};
}

}  // namespace chiaro::bench

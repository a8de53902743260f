// What multiple scattering is measured against: volumes, points in them and pictures of them, by light's own paths.
#pragma once
#include <chiaro/device.h>
#include <chiaro/render.h>
#include <chiaro/scene.h>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "classify/medium.h"

namespace chiaro::bench {

/// A classified volume and how it is looked at. Its colours are painted so that the brightest channel is 1: what
/// `albedo_max` says is then the albedo.
struct ScatteringSubject {
    std::string name;
    Device device;
    TransferFunction paint;
    Medium medium;
    Scene scene;  ///< 160 × 120

    DeviceVolume voxels() const;
};

/// "cornell" and "fog" (samples, 128³), "engine", "carp" and "head" (of the folder `data`).
const std::vector<std::string>& scattering_subjects();
/// Nothing when the volume is not there.
std::optional<ScatteringSubject> find_scattering_subject(const Device& device, const std::filesystem::path& data,
                                                         const std::string& name, Progress& progress);

/// The light, and how much of it is scattered on.
struct ScatteringCase {
    std::string probe = "white";
    double albedo = 0.8;
    double start_half_voxels = 0;  ///< how much matter around each collision is passed over
    std::optional<int> bounces;

    std::string name() const;
    IlluminationSettings settings(Method method) const;
    Lighting lighting() const;
};

/// Where J is asked for: voxels; in the air (no extinction), and in matter that light enters: at most 1 deep over a
/// voxel edge (none in cornell).
struct MeasuredPoints {
    std::vector<Vec3> air, matter;
};
MeasuredPoints measured_points(const ScatteringSubject& subject, int air, int matter);

/// What light meets at a point, voxels.
const OpticalTable::Entry& entry_at(const Medium& medium, Vec3 p);

/// Truths cost minutes: those found are kept in the folder that CHIARO_TRUTH_DIR names, if it does.
class GroundTruthCache {
public:
    GroundTruthCache();
    explicit GroundTruthCache(std::filesystem::path folder) : folder_(std::move(folder)) {}

    /// J at points by so many paths from each.
    MeanRadiance mean_radiance(const ScatteringSubject& subject, const ScatteringCase& which, const std::string& points,
                               const std::vector<Vec3>& at, int paths, Progress& progress) const;
    /// The picture by so many paths a pixel; its noise beside it.
    std::pair<Frame, PathStatistics> image(const ScatteringSubject& subject, const ScatteringCase& which, int paths,
                                           Progress& progress) const;

private:
    std::filesystem::path place(const std::string& name) const;
    std::filesystem::path folder_;  ///< "": nothing is kept
};

}  // namespace chiaro::bench

// How far visibility in spherical harmonics is from rays: at nodes chosen at random, through the density that a method
// follows light through, and through the whole volume.
#pragma once
#include "access_error.h"
#include "illumination/probe/light.h"
#include "illumination/reference/visibility.h"
#include "illumination/visibility/density.h"

namespace chiaro::bench {

/// Runs of sixteen nodes along x, by coefficient.
using Harmonics = std::vector<RunHarmonics>;

/// Two probes, one with a tiny sun: files of the folder beside that of the volumes, or our own.
struct NamedLight {
    std::string name;
    ShLight light;
};
std::vector<NamedLight> judging_lights(const std::filesystem::path& volumes);

class VisibilityErrorMetric {
public:
    /// Nodes for `subsample`³ cells of the subject; `runs` of sixteen nodes, `rays` from each.
    VisibilityErrorMetric(const LitSubject& subject, int subsample, int runs, int rays, Progress& progress);

    /// What a method finds at the chosen nodes.
    Harmonics found_by(const VisibilitySettings& settings) const;
    /// The same as pictures keep it: in the settings' storage.
    Harmonics kept_by(const VisibilitySettings& settings) const;
    /// What rays find: through the same density, and through the cells of the full resolution (the same at 1:1).
    const Harmonics& by_rays() const { return by_rays_; }
    const Harmonics& in_full() const { return in_full_.empty() ? by_rays_ : in_full_; }

    /// √(Σ (found - ground truth)² / Σ ground truth²) over nodes and coefficients.
    double relative_error(const Harmonics& found, const Harmonics& ground_truth) const;
    /// RMSE over nodes and channels of E = Σ V_lm L_lm / 4π, as a share of what arrives in the open.
    double light_error(const Harmonics& found, const Harmonics& ground_truth, const ShLight& light) const;

private:
    template <class Visit>
    void for_each_node(const Visit& visit) const;
    ShField field_by(const VisibilitySettings& settings) const;
    Harmonics at_runs(const ShField& field) const;
    double start() const { return 0.5 / subsample_; }

    Device device_;
    int subsample_;
    Progress& progress_;
    Density density_;
    std::vector<std::array<int, 3>> runs_;  ///< first nodes
    Harmonics by_rays_, in_full_;
};

}  // namespace chiaro::bench

// What labels cost: the same view of a volume with them and without.
#include <fmt/format.h>

#include <cmath>

#include "turntable.h"

namespace chiaro::bench {
namespace {

/// Every voxel belongs to the nearest of `count` places, which lie side by side as seen from the front.
std::shared_ptr<const LabelVolume> labels_of(const Volume& volume, int count, int hidden, Progress& progress) {
    const auto [nx, ny, nz] = volume.dimensions;
    const int columns = int(std::lround(std::sqrt(count))), rows = (count + columns - 1) / columns;
    VoxelBuffer voxels(std::size_t(nx) * std::size_t(ny) * std::size_t(nz));
    std::vector<Vec3> places;
    for (int i = 0; i < count; ++i)
        places.push_back({(i % columns + 0.5 + 0.3 * std::sin(7.0 * i)) * nx / columns,
                          (0.5 + 0.3 * std::sin(3.0 * i)) * ny,
                          (i / columns + 0.5 + 0.3 * std::sin(5.0 * i)) * nz / rows});
    std::size_t to = 0;
    for (int z = 0; z < nz; ++z)
        for (int y = 0; y < ny; ++y)
            for (int x = 0; x < nx; ++x) {
                double nearest = 1e9;
                for (std::size_t i = 0; i < places.size(); ++i) {
                    const Vec3 d = places[i] - Vec3{double(x), double(y), double(z)};
                    if (dot(d, d) < nearest) nearest = dot(d, d), voxels.data()[to] = std::byte(i + 1);
                }
                ++to;
            }
    Volume made;
    made.dimensions = volume.dimensions, made.geometry = volume.geometry, made.type = VoxelType::u8;
    made.voxels = std::move(voxels);
    LabelTable table;
    for (int i = 1; i <= hidden; ++i) table.labels.push_back({.value = std::uint32_t(4 * i), .show = false});
    return std::make_shared<const LabelVolume>(make_labels(made, hidden ? &table : nullptr, progress));
}

struct Look {
    const char* name;
    int labels, hidden;
    const char* asked;
};
constexpr Look looks[] = {{"labels/one", 1, 0, "at most 1.1"},
                          {"labels/hundred", 100, 0, "at most 1.4"},
                          {"labels/hundred-some-hidden", 100, 20, ""}};

/// Shaded frames without light, from two sides; only the rays are cast anew.
class LabelFrames {
public:
    explicit LabelFrames(const Setup& setup)
        : progress_(setup.progress), volume_(make_sample("torso", setup.quick ? 48 : 160)), plain_(setup.device) {
        scene_.illumination.method = Method::none;
        scene_.interpolation = Interpolation::linear;
        scene_.width = setup.quick ? 128 : 640, scene_.height = setup.quick ? 96 : 520;
        plain_.show(volume_, progress_);
        scene_.camera = plain_.fit(scene_, progress_);
        for (const Look& look : looks) sessions_.push_back({plain_.share_volume(), labels(look)});
    }

    /// `look`: -1 for none.
    double milliseconds(int look) {
        Session& session = look < 0 ? plain_ : sessions_[std::size_t(look)].session;
        Scene scene = scene_;
        if (look >= 0) scene.labels.loaded = sessions_[std::size_t(look)].labels;
        return turned_frame_ms(session, std::move(scene), progress_);
    }

private:
    struct Labelled {
        Session session;
        std::shared_ptr<const LabelVolume> labels;
    };
    std::shared_ptr<const LabelVolume> labels(const Look& look) {
        return labels_of(volume_, look.labels, look.hidden, progress_);
    }

    Progress& progress_;
    const Volume volume_;
    Session plain_;
    Scene scene_;
    std::vector<Labelled> sessions_;
};

}  // namespace

std::vector<Case> label_cases(const Setup& setup) {
    std::vector<std::string> names;
    for (const Look& look : looks) names.push_back(look.name);
    const auto rows = [&setup] {
        LabelFrames frames(setup);
        std::vector<Measure> measures;
        for (int look = -1; look < int(std::size(looks)); ++look)
            measures.push_back([&frames, look] { return frames.milliseconds(look); });
        const std::vector<Series> series = in_turns(setup.runs, measures);
        std::vector<Row> found;
        for (std::size_t i = 0; i < std::size(looks); ++i)
            found.push_back({looks[i].name, "ms/frame", spread_of(series[i + 1]),
                             median_ratio(series[i + 1], series[0]), "no labels", looks[i].asked});
        return found;
    };
    return {{names, rows}};
}

}  // namespace chiaro::bench

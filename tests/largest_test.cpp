// --largest against a plain flood fill, and as a part of the medium that every method sees.
#include <queue>
#include <random>

#include "classify/kinds.h"
#include "classify/largest.h"
#include "fixtures.h"
#include "volume/device_view.h"

using namespace chiaro;
using chiaro::testing::tested_device;
using chiaro::testing::two_materials;

namespace {

std::size_t index(const std::array<int, 3>& n, int x, int y, int z) { return (std::size_t(z) * n[1] + y) * n[0] + x; }

/// The largest set of voxels that are connected through faces, by breadth-first search; the first of equals.
std::vector<std::uint8_t> flooded(const std::vector<std::uint8_t>& solid, const std::array<int, 3>& n) {
    std::vector<int> label(solid.size());
    int labels = 0, best = 0;
    std::size_t most = 0;
    for (std::size_t seed = 0; seed < solid.size(); ++seed) {
        if (!solid[seed] || label[seed]) continue;
        std::queue<std::size_t> open({seed});
        label[seed] = ++labels;
        std::size_t size = 0;
        for (; !open.empty(); open.pop(), ++size) {
            const std::size_t at = open.front();
            const int place[3] = {int(at % n[0]), int(at / n[0] % n[1]), int(at / (std::size_t(n[0]) * n[1]))};
            for (int axis = 0; axis < 3; ++axis)
                for (const int step : {-1, 1}) {
                    int next[3] = {place[0], place[1], place[2]};
                    next[axis] += step;
                    if (next[axis] < 0 || next[axis] >= n[axis]) continue;
                    const std::size_t to = index(n, next[0], next[1], next[2]);
                    if (solid[to] && !label[to]) label[to] = labels, open.push(to);
                }
        }
        if (size > most) most = size, best = labels;
    }
    std::vector<std::uint8_t> largest(solid.size());
    for (std::size_t i = 0; i < solid.size(); ++i) largest[i] = best && label[i] == best;
    return largest;
}

std::vector<std::uint8_t> noise(const std::array<int, 3>& n, double share, unsigned seed) {
    std::mt19937 random(seed);
    std::bernoulli_distribution is_set(share);
    std::vector<std::uint8_t> voxels;
    voxels.resize(std::size_t(n[0]) * n[1] * n[2]);
    for (auto& voxel : voxels) voxel = is_set(random);
    return voxels;
}

/// Two balls, the right one larger, a plate below and some specks.
Volume things() {
    return chiaro::testing::sampled<std::uint8_t>({70, 41, 38}, [](double x, double y, double z) {
        const auto ball = [&](double cx, double r) {
            return 220 * std::clamp(r + 0.5 - std::hypot(x - cx, y - 18, z - 20), 0.0, 1.0);
        };
        const double plate = y > 36 && y < 39 ? 130 : 0, speck = std::fmod(x * 7 + y * 13 + z * 29, 97) < 1 ? 130 : 0;
        return std::max({ball(16, 11), ball(48, 14), plate, speck});
    });
}

/// The same with what is not the larger ball made invisible, as --largest says.
Volume larger_ball(const Clip& clip = {}) {
    Volume volume = things();
    const auto& n = volume.dimensions;
    auto voxels = volume.as<std::uint8_t>();
    const auto opacity = [&](std::size_t i) { return evaluate(two_materials(), voxels[i]).opacity; };
    std::vector<std::uint8_t> solid(voxels.size());
    const int y1 = clip.box ? int((*clip.box)[3] * (n[1] - 1)) : n[1];
    for (std::size_t i = 0; i < voxels.size(); ++i) solid[i] = opacity(i) >= 0.1 && int(i / n[0] % n[1]) <= y1;
    const auto kept = flooded(solid, n);
    std::vector<std::size_t> goes;
    for (int z = 0; z < n[2]; ++z)
        for (int y = 0; y < n[1]; ++y)
            for (int x = 0; x < n[0]; ++x) {
                const std::size_t i = index(n, x, y, z);
                int off = 3;  // from the piece, along the axis on which it is farthest
                for (int k = -2; k <= 2; ++k)
                    for (int j = -2; j <= 2; ++j)
                        for (int h = -2; h <= 2; ++h)
                            if (x + h >= 0 && x + h < n[0] && y + j >= 0 && y + j < n[1] && z + k >= 0 &&
                                z + k < n[2] && kept[index(n, x + h, y + j, z + k)])
                                off = std::min(off, std::max({std::abs(h), std::abs(j), std::abs(k)}));
                const bool shows = opacity(i) > 0, stays = kept[i] || (!solid[i] && off <= (shows ? 2 : 1));
                if (!stays) goes.push_back(i);
            }
    for (const std::size_t i : goes) voxels[i] = std::min<std::uint8_t>(voxels[i], 60);
    return volume;
}

}  // namespace

TEST(Largest, FindsWhatAFloodFillFinds) {
    unsigned seed = 0;
    for (const std::array<int, 3> n : {std::array{1, 1, 1}, std::array{17, 1, 1}, std::array{9, 14, 1},
                                       std::array{12, 9, 15}, std::array{31, 20, 11}})
        for (const double share : {0.0, 0.05, 0.3, 0.32, 0.5, 1.0}) {
            const auto voxels = noise(n, share, ++seed);
            const Pieces pieces = find_pieces(voxels, n);
            EXPECT_EQ(pieces.is_of_largest, flooded(voxels, n)) << seed;
            EXPECT_EQ(pieces.largest,
                      std::size_t(std::count(pieces.is_of_largest.begin(), pieces.is_of_largest.end(), 1)));
            EXPECT_LE(pieces.second, pieces.largest);
        }
}

/// Every method, paths and maxima see the same medium as if the file held nothing else: bit for bit.
TEST(Largest, IsAPartOfTheMedium) {
    const Device device = tested_device();
    const DeviceVolume whole = upload(device, things()), alone = upload(device, larger_ball());
    Progress progress;
    for (const Mode mode : {Mode::dvr, Mode::mip}) {
        Shape shape{.mode = mode}, largest = shape;
        largest.clip.largest = true;
        const Medium expected = classify(alone, two_materials(), shape),
                     found = classify(whole, two_materials(), largest);
        EXPECT_EQ(found.data().cells, expected.data().cells) << "occupancy";
        EXPECT_LT(found.occupied_fraction(), classify(whole, two_materials(), shape).occupied_fraction());
        for (const Method method :
             {Method::none, Method::spao, Method::visibility, Method::transport, Method::reference}) {
            if (mode == Mode::mip && method != Method::none) continue;
            IlluminationSettings settings{.method = method};
            settings.reference.rays = 4;
            const auto picture = [&](const Medium& medium) {
                const Camera camera = make_camera({}, whole.geometry(), whole.dimensions());
                Frame frame(48, 36);
                IlluminationField field;
                const auto keep = [&](IlluminationField finer) { field = std::move(finer); };
                if (is_path_traced(settings))
                    trace_paths(device, medium, {}, camera, {}, settings, frame, progress);
                else {
                    illuminate(device, medium, Prepared(), {}, settings, keep, progress);
                    raycast(device, medium, field, {}, camera, {}, frame, progress);
                }
                return frame.rgba;
            };
            EXPECT_EQ(picture(found), picture(expected)) << to_text(method);
        }
    }
}

/// A ball in matter of a value between two visible ranges, in a thin shell of the lower one.
template <class T>
Volume ball_in_shell() {
    return chiaro::testing::sampled<T>({44, 44, 44}, [](double x, double y, double z) {
        const double r = std::hypot(x - 22, y - 22, z - 22);
        return r < 11 ? 220.0 : r < 14 ? 160.0 : r < 15 ? 110.0 : 0.0;
    });
}

/// A wall between a value below all visible ranges and one between them, and a speck.
Volume wall() {
    return chiaro::testing::sampled<std::uint8_t>({40, 40, 40}, [](double x, double y, double z) {
        if (x == 35 && y == 5 && z == 5) return 110.0;
        return x < 17 ? 0.0 : x < 23 ? 220.0 : 160.0;
    });
}

/// At no point that is far enough from the piece, between voxels neither: linear values read voxels up to one away,
/// splines up to two, and voxels within two of the piece may stay as they are.
TEST(Largest, NothingIsSeenOfTheOthers) {
    std::mt19937 random(7);
    for (const Volume& volume : {things(), ball_in_shell<std::uint8_t>(), ball_in_shell<float>(), wall()})
        for (const Interpolation interpolation : {Interpolation::linear, Interpolation::cubic, Interpolation::smooth}) {
            const int off = interpolation == Interpolation::linear ? 3 : 5;
            Shape shape{.interpolation = interpolation};
            shape.clip.largest = true;
            const DeviceVolume whole = upload(tested_device(), volume);
            const Medium medium = classify(whole, two_materials(), shape);
            const Kinds kinds(medium.data());
            const auto& n = volume.dimensions;
            std::vector<std::uint8_t> solid;
            with_voxel_type(volume.type, [&](auto zero) {
                for (const auto stored : volume.as<decltype(zero)>())
                    solid.push_back(evaluate(two_materials(), double(stored)).opacity >= 0.1);
            });
            const auto kept = flooded(solid, n);
            const auto is_far = [&](const kernel::Vec3<float>& p) {
                const auto from = [&](float at) { return std::max(int(std::floor(at)) - off + 1, 0); };
                const auto to = [&](float at, int size) { return std::min(int(std::ceil(at)) + off - 1, size - 1); };
                for (int z = from(p.z); z <= to(p.z, n[2]); ++z)
                    for (int y = from(p.y); y <= to(p.y, n[1]); ++y)
                        for (int x = from(p.x); x <= to(p.x, n[0]); ++x)
                            if (kept[index(n, x, y, z)]) return false;
                return true;
            };
            int far = 0, seen = 0;
            with_stored_voxel(medium.data().volume.data(), [&](auto zero) {
                const auto view = view_of<decltype(zero)>(medium.data().volume.data());
                for (int i = 0; i < 30000; ++i) {
                    const auto along = [&](int size) {
                        return std::uniform_real_distribution<float>(0, float(size - 1))(random);
                    };
                    const kernel::Vec3<float> p{along(n[0]), along(n[1]), along(n[2])};
                    if (!is_far(p)) continue;
                    ++far;
                    seen += kinds.of(view.value(view.locate(p, view.voxel(p)))) != 0;
                }
            });
            EXPECT_GT(far, 3000);
            EXPECT_EQ(seen, 0) << int(interpolation) << " " << to_text(volume.dimensions) << " " << int(volume.type);
        }
}

/// What the clip cuts away connects nothing, and counts for nothing.
TEST(Largest, IsLookedForAfterClipping) {
    Clip clip;
    clip.box = std::array{0.0, 1.0, 0.0, 0.55, 0.0, 1.0};
    Shape expected{.clip = clip}, found = expected;
    found.clip.largest = true;
    chiaro::testing::Shot shot;
    shot.shape = expected;
    const Frame a = shot(larger_ball(clip));
    shot.shape = found;
    EXPECT_EQ(shot(things()).rgba, a.rgba);
}

TEST(Largest, OfSurfacesKeepsTheLowest) {
    chiaro::testing::Shot shot;
    shot.shape.mode = Mode::iso;
    shot.shape.iso = {{.value = 100}, {.value = 180}};
    const double all = chiaro::testing::mean_alpha(shot(things()));
    shot.shape.clip.largest = true;
    const double one = chiaro::testing::mean_alpha(shot(things()));
    EXPECT_GT(one, 0);
    EXPECT_LT(one, 0.7 * all);
}

TEST(Largest, AFunctionThatShowsEverythingLeavesNothingOut) {
    Shape shape;
    shape.clip.largest = true;
    const DeviceVolume volume = upload(tested_device(), things());
    // One piece: nothing has to go.
    EXPECT_NO_THROW(classify(volume, chiaro::testing::constant(0.5), shape));
    TransferFunction faint = chiaro::testing::constant(0.01);
    faint.points.back().opacity = 0.9;
    EXPECT_THROW(classify(volume, faint, shape), Error);
}

TEST(Largest, IsSuggestedWhereThereIsATable) {
    const Volume torso = make_sample("torso", 64);
    EXPECT_GT(detached_share(torso, measure(torso)), 0.02);
    const Volume tubes = make_sample("tubes", 32);
    EXPECT_EQ(detached_share(tubes, measure(tubes)), 0) << "no CT";
}

// Rays through one channel in which labels lie, maxima of what labels show, and changes of their looks.
#include <cstring>

#include "classify/labels/fields.h"
#include "labelled_case.h"

using namespace chiaro;
using namespace chiaro::testing;

namespace {

/// Pieces of a ball of any size, of five labels.
Labelled pieces(std::vector<Label> table) {
    Labelled made(
        {72, 70, 68}, [](double x, double y, double z) { return (int(x) / 13 + int(y) / 17 + int(z) / 11) % 5; },
        std::move(table));
    made.volume = sampled<std::uint8_t>({72, 70, 68}, [](double x, double y, double z) {
        return std::clamp(6 * (38 - length(Vec3{x - 35.2, y - 34.7, z - 33.1})), 0.0, 250.0);
    });
    made.tf.points = {{20, {0.9, 0.7, 0.4}, 0}, {120, {0.4, 0.8, 0.6}, 0.2}, {200, {0.8, 0.3, 0.2}, 0.05}};
    return made;
}

Frame picture_of(const Medium& medium, const RaySettings& rays) {
    const DeviceVolume::Data& volume = medium.data().volume.data();
    Frame frame(90, 70);
    Progress progress;
    raycast(tested_device(), medium, IlluminationField(), {}, make_camera({}, volume.geometry, volume.dimensions), rays,
            frame, progress);
    return frame;
}

double farthest(const Frame& a, const Frame& b) {
    double most = 0;
    for (std::size_t i = 0; i < a.rgba.size(); ++i) most = std::max(most, std::abs(double(a.rgba[i]) - b.rgba[i]));
    return most;
}

}  // namespace

TEST(Labelled, LabelsThatChangeNothingAreTheSamePictureBitForBit) {
    Labelled ball = pieces({nothing(true)});
    for (std::uint32_t v = 1; v < 5; ++v) ball.table.push_back({.value = v, .rgb = red, .tint = v < 3 ? 0 : 1.0});
    ball.numbers = sampled<std::uint8_t>({72, 70, 68}, [](double x, double y, double z) {
        return x + y + z < 8 ? 4 : x < 30 ? 1 : 2;  // what is tinted lies where nothing is
    });
    const DeviceVolume uploaded = upload(tested_device(), ball.volume);
    for (const Classification by : {Classification::post, Classification::pre})
        EXPECT_EQ(picture_of(ball.medium(), {.classification = by}).rgba,
                  picture_of(classify(uploaded, ball.tf, {}), {.classification = by}).rgba);
}

/// One channel in which labels lie has a march of its own; a second one that shows nothing takes the other way.
TEST(Labelled, OneChannelIsDrawnAsAMixtureIs) {
    const std::vector<Label> tints{nothing(true),
                                   {.value = 1, .rgb = red},
                                   {.value = 2, .rgb = blue, .tint = 0.5},
                                   {.value = 3, .tint = 0},
                                   {.value = 4, .rgb = {0, 1, 0}}};
    std::vector<Label> cut = tints;
    cut[1].show = false, cut[2].opacity = 0.3;
    Progress progress;
    for (const auto& table : {tints, cut})
        for (const Mode mode : {Mode::dvr, Mode::additive}) {
            Labelled ball = pieces(table);
            ball.shape.mode = mode;
            const DeviceVolume uploaded = upload(tested_device(), ball.volume);
            const LabelVolume labels = labels_of(ball.numbers, table);
            const auto bricks = label_bricks(labels, labels.labels, uploaded, ColorMode::linear, 2, progress);
            const std::vector<Channel> two{{uploaded, ball.tf, 1}, {uploaded, constant(0), 1}};
            const Medium mixture =
                with_labels(tested_device(), classify(tested_device(), two, ball.shape, progress), bricks, progress);
            const Medium medium = ball.medium();
            ASSERT_EQ(mixture.data().channels.size(), 2u);
            for (const bool skips : {true, false}) {
                const RaySettings rays{.skip_empty = skips};
                EXPECT_LE(farthest(picture_of(medium, rays), picture_of(mixture, rays)), 1e-3) << int(mode);
            }
            EXPECT_EQ(picture_of(medium, {.skip_empty = true}).rgba, picture_of(medium, {.skip_empty = false}).rgba);
        }
}

TEST(Labelled, MaximaAreOfWhatIsShown) {
    // Bright, hidden and in front: what lies behind is seen, in its tint.
    Labelled slabs({20, 20, 30}, [](double, double, double z) { return z < 10   ? 1
                                                                       : z < 20 ? 2
                                                                                : 0; },
                   {nothing(true), {.value = 1, .show = false}, {.value = 2, .rgb = blue}});
    slabs.volume = sampled<std::uint8_t>({20, 20, 30}, [](double, double, double z) {
        return z < 10 ? 200 : z < 20 ? 100 : 20;
    });
    slabs.tf.points = {{0, white, 0}, {200, white, 1}};
    const Camera along_z{.eye = {9.5, 9.5, 100},
                         .forward = {0, 0, -1},
                         .right = {1, 0, 0},
                         .up = {0, 1, 0},
                         .projection = Projection::orthographic,
                         .half_height = 3};
    for (const Mode mode : {Mode::mip, Mode::minip}) {
        slabs.shape.mode = mode;
        const Frame frame = slabs.picture(along_z, {}, {}, 4);
        const float* middle = &frame.rgba[4 * (4 * 2 + 2)];
        if (mode == Mode::mip)  // up to the border, where values are already half way to what is hidden
            EXPECT_TRUE(middle[3] >= 0.49 && middle[3] <= 0.76) << middle[3];
        else
            EXPECT_NEAR(middle[3], 0.1, 0.01);
        EXPECT_NEAR(middle[0], mode == Mode::mip ? 0 : middle[3], 0.01) << to_text(mode);
        EXPECT_NEAR(middle[2], middle[3], 0.01) << to_text(mode);
    }
    slabs.table[1].show = true, slabs.table[1].tint = 0, slabs.shape.mode = Mode::mip;
    EXPECT_GT(slabs.picture(along_z, {}, {}, 4).rgba[4 * (4 * 2 + 2) + 3], 0.9);
    for (Label& label : slabs.table) label.show = false;
    slabs.table.push_back({.value = 9});
    EXPECT_EQ(mean_alpha(slabs.picture(along_z, {}, {}, 4)), 0);
}

TEST(Labelled, AChangeIsDoneWhereItIsSeenBitForBit) {
    const std::array<int, 3> n{150, 140, 70};
    std::vector<Label> table{nothing(true)};
    for (std::uint32_t v = 1; v < 9; ++v) table.push_back({.value = v, .rgb = {v / 8.0, 1 - v / 8.0, 0.5}});
    Labelled blocks(
        {75, 70, 70}, [](double, double, double) { return 0; }, table);
    blocks.numbers =
        sampled<std::uint8_t>(n, [](double x, double y, double) { return x < 70 ? 1 + int(y) / 40 : 5 + int(y) / 40; });
    blocks.volume.geometry.spacing_mm = {2, 2, 1};  // another grid
    const DeviceVolume uploaded = upload(tested_device(), blocks.volume);
    const auto labels = std::make_shared<const LabelVolume>(labels_of(blocks.numbers, table));
    Progress progress;
    LabelBorders borders;
    std::vector<Label> looks = labels->labels, before;
    LabelFields fields = make_label_fields(*labels, looks, ColorMode::linear, 2, progress);
    const auto expect_same = [](const VoxelBuffer& a, const VoxelBuffer& b) {
        ASSERT_EQ(a.size(), b.size());
        if (a.size()) EXPECT_EQ(std::memcmp(a.data(), b.data(), a.size()), 0);
    };
    const std::function<void()> changes[] = {[] {},
                                             [&] { looks[3].show = false; },
                                             [&] { looks[6].rgb = red; },
                                             [&] { looks[3].show = true, looks[8].show = false; },
                                             [&] { looks[0].show = false; },
                                             [&] { looks[2].opacity = 0.5; },
                                             [&] { looks[2].opacity = 1, looks[8].show = true; }};
    std::size_t partly = 0;
    for (const auto& change : changes) {
        before = looks;
        change();
        const auto found = borders.find(labels, looks, uploaded, ColorMode::linear, 2, progress);
        const auto anew = label_bricks(*labels, looks, uploaded, ColorMode::linear, 2, progress);
        expect_same(found->distance, anew->distance), expect_same(found->share, anew->share);
        expect_same(found->tint, anew->tint);
        EXPECT_EQ(found->cells, anew->cells);
        const auto tiles = renew_label_fields(fields, *labels, before, looks, ColorMode::linear, 2, progress);
        const auto redone = std::size_t(std::count(tiles.begin(), tiles.end(), 1));
        partly += redone > 0 && redone < tiles.size();
    }
    EXPECT_GE(partly, 3u);
}

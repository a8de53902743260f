// What a session shows at once: of a large volume every other voxel, in its light.
#include <chiaro/samples.h>
#include <chiaro/session.h>
#include <gtest/gtest.h>

#include <cmath>

#include "classify/medium.h"
#include "devices.h"
#include "illumination/cells/spare_values.h"

using namespace chiaro;
using chiaro::testing::tested_device;

namespace {

struct SessionDrafts : ::testing::Test {
    Progress progress;
    Session session{tested_device()};
    Scene scene;

    void SetUp() override {
        if (tested_device().has_gpu()) GTEST_SKIP() << "a GPU draws and lights all voxels";
        scene.volume = "sample:shells:224";
        scene.width = 40, scene.height = 30;
        scene.illumination.method = Method::spao;
        scene.interpolation = Interpolation::linear;
        session.show(make_sample("ball", 24), progress);
        EXPECT_FALSE(session.is_lit_soon(scene)) << "a small volume is lit at once";
        session.show(make_sample("shells", 224), progress);
        session.render(scene, progress);
    }
};

/// Mean, in 255ths.
double apart(const Image& a, const Image& b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.pixels.size(); ++i) sum += std::abs(a.pixels[i] - b.pixels[i]);
    return sum / double(a.pixels.size());
}

}  // namespace

TEST_F(SessionDrafts, LargeVolumesAreLitSoonByEveryOtherVoxel) {
    ASSERT_TRUE(session.is_lit_soon(scene));
    for (const double scale : {0.8, 0.5}) {
        scene.transfer.opacity_scale = scale;
        const Image soon = session.preview(scene, progress, DraftLight::soon);
        EXPECT_TRUE(session.needs_light(scene)) << "what render keeps stays kept";
        const Image own = session.preview(scene, progress, DraftLight::own);
        EXPECT_GT(apart(soon, own), 0) << "another light";
        EXPECT_LT(apart(soon, own), 1.5) << "but nearly the same, in 255ths";
        EXPECT_EQ(session.render(scene, progress).pixels, own.pixels);
    }
    scene.mode = Mode::mip, scene.transfer.opacity_scale = 0.7;  // shows no light
    EXPECT_EQ(session.preview(scene, progress, DraftLight::soon).pixels,
              session.preview(scene, progress, DraftLight::own).pixels);
}

TEST_F(SessionDrafts, CoarseDraftsOfLargeVolumesAreOfEveryOtherVoxel) {
    scene.width = 120, scene.height = 90;
    for (const Method method : {Method::none, Method::spao}) {
        scene.illumination.method = method;
        scene.camera.fit_centre.reset();
        session.preview(scene, progress, DraftLight::own);
        scene.camera = session.camera();  // what it fits is known from now on
        const auto voxels_across = [&] { return session.medium().data().volume.dimensions()[0]; };
        Scene coarse = scene;
        coarse.sampling.step_voxels = 2;
        const Image every_other = session.preview(coarse, progress);
        EXPECT_EQ(voxels_across(), 112);
        const Image whole = session.preview(coarse, progress, DraftLight::own);
        EXPECT_EQ(voxels_across(), 224);
        EXPECT_GT(apart(every_other, whole), 0);
        EXPECT_LT(apart(every_other, whole), 3) << "in 255ths";
        session.preview(scene, progress);
        EXPECT_EQ(voxels_across(), 224) << "samples half a voxel apart miss none";
        coarse.camera.zoom *= 4;
        session.preview(coarse, progress);
        EXPECT_EQ(voxels_across(), 224) << "where a voxel is several pixels";
        coarse.camera.zoom = scene.camera.zoom, coarse.clip.largest = true;
        session.preview(coarse, progress);
        EXPECT_EQ(voxels_across(), 224) << "where one voxel may hold a piece together";
    }
}

TEST(SessionDraftsInCoarseLight, ComeBeforeThoseInTheOwn) {
    Progress progress;
    Session session(tested_device());
    session.show(make_sample("ball", 24), progress);
    Scene scene;
    scene.volume = "sample:ball:24";
    scene.width = 40, scene.height = 30;
    for (const Method method : {Method::visibility, Method::transport}) {
        scene.illumination.method = method;
        scene.illumination.transport = {.grid = 24, .directions = 24, .first_directions = 100};
        std::vector<Image> coarse;
        const Image own =
            session.preview(scene, progress, DraftLight::own, [&](const Image& i) { coarse.push_back(i); });
        ASSERT_FALSE(coarse.empty());
        EXPECT_GT(apart(coarse.front(), own), 0);
        EXPECT_FALSE(session.needs_light(scene));
        EXPECT_EQ(session.preview(scene, progress).pixels, own.pixels);
        session.preview(scene, progress, DraftLight::own, [](const Image&) { FAIL() << "there is no coarser light"; });
    }
}

TEST(SpareValues, MemoryIsKeptForALargeGridAndItsEveryOtherCell) {
    // Where it is to be written it holds what was there before; memory that is mapped anew is 0.
    const auto first_of = [](int edge, std::uint16_t written) {
        CellGrid grid;
        grid.count = {edge, edge, edge};
        CellValues values = values_to_write(grid, BlockMap(grid.count, true), false, 2);
        const std::uint16_t before = values.data()[grid.index(1, 1, 1)];
        values.data()[grid.index(1, 1, 1)] = written;
        return before;
    };
    first_of(201, 1), first_of(101, 2);
    for (int i = 0; i < 3; ++i) {
        EXPECT_EQ(first_of(201, 1), 1);
        EXPECT_EQ(first_of(101, 2), 2);
    }
    EXPECT_EQ(first_of(133, 3), 0);
    EXPECT_EQ(first_of(201, 1), 0) << "given back: it was another volume's";
}

// Real volumes (CHIARO_DATA_DIR) in pictures: true proportions along every axis, and anatomy on its side.
#include "fixtures.h"
#include "volume_files.h"

using namespace chiaro;
using namespace volume_files;
using chiaro::testing::Shot;

namespace {

std::string data_file(const std::string& name) {
    const char* data = std::getenv("CHIARO_DATA_DIR");
    return data ? (fs::path(data) / "volumes" / name).string() : "";
}

/// What is covered of a picture: bounds and centre of the opacity in a part of it, in pixels.
struct Silhouette {
    int left = 1 << 20, right = -1, top = 1 << 20, bottom = -1;
    double sum = 0, x = 0, y = 0;

    explicit Silhouette(const Frame& frame, int first_row = 0, int last_row = 1 << 20) {
        for (int row = first_row; row < std::min(frame.height, last_row); ++row)
            for (int column = 0; column < frame.width; ++column) {
                const double alpha = frame.rgba[4 * std::size_t(row * frame.width + column) + 3];
                if (alpha < 0.5) continue;
                left = std::min(left, column), right = std::max(right, column);
                top = std::min(top, row), bottom = std::max(bottom, row);
                sum += alpha, x += alpha * column, y += alpha * row;
            }
        x /= sum, y /= sum;
    }
};

Shot orthographic() {
    Shot shot{.width = 400, .height = 400};
    shot.camera.projection = Projection::orthographic;
    shot.rays = {.step_voxels = 1, .early_termination = 0.005};
    return shot;
}

/// From one of the named sides, everything within [low, high] opaque.
Frame from_side(const Volume& volume, View view, double low, double high) {
    Shot shot = orthographic();
    shot.camera.view = view;
    shot.tf = chiaro::testing::constant(1);
    shot.shape = {.threshold_low = low, .threshold_high = high};
    return shot(volume);
}

class Proportions : public ::testing::TestWithParam<const char*> {};

}  // namespace

/// Seen along each index axis, a volume that is opaque throughout is a rectangle of spacing x (n - 1).
TEST_P(Proportions, AreTrueAlongEveryAxis) {
    const std::string file = data_file(GetParam());
    if (file.empty()) GTEST_SKIP() << "skipped: no data";
    const Volume volume = read(file);
    const Geometry& g = volume.geometry;
    const auto span = [&](int axis) { return (volume.dimensions[std::size_t(axis)] - 1) * g.spacing_mm[axis]; };
    const double diagonal = std::hypot(span(0), span(1), span(2));
    Shot shot = orthographic();
    shot.tf = chiaro::testing::constant(1);
    const DeviceVolume uploaded = upload(shot.device, volume);
    for (int axis = 0; axis < 3; ++axis) {
        const int across = (axis + 1) % 3, upwards = (axis + 2) % 3;
        const auto& n = volume.dimensions;
        shot.camera.target = g.world_from_voxel({0.5 * (n[0] - 1), 0.5 * (n[1] - 1), 0.5 * (n[2] - 1)});
        shot.camera.eye = *shot.camera.target + diagonal * g.direction[std::size_t(axis)];
        shot.camera.up = g.direction[std::size_t(upwards)];
        const Silhouette seen(shot(uploaded));
        const double mm = diagonal / shot.height;  // a pixel
        EXPECT_NEAR(seen.right - seen.left + 1, span(across) / mm, 1.5) << "across, along axis " << axis;
        EXPECT_NEAR(seen.bottom - seen.top + 1, span(upwards) / mm, 1.5) << "upwards, along axis " << axis;
    }
}

INSTANTIATE_TEST_SUITE_P(Data, Proportions,
                         ::testing::Values("engine.nrrd", "bonsai.nrrd", "aneurism.nrrd", "cthead.nrrd",
                                           "head_unc.nii.gz", "head_ct_512.nrrd", "carp.nii.gz", "heptane.nrrd",
                                           "smoke.nrrd", "brain_mri.nii.gz", "fetal_brain_mri.nrrd", "t1_slab_dicom",
                                           "chest_lidc.mha", "tooth.nhdr", "neghip_64x64x64_uint8.raw"),
                         [](const auto& row) {
                             return std::string(row.param).substr(0, std::string(row.param).find('.'));
                         });

/// The brainstem and the cerebellum lie below and behind: on the right of the view from the left.
TEST(RealAnatomy, CerebellumIsLowAndBehind) {
    const std::string file = data_file("brain_mri.nii.gz");
    if (file.empty()) GTEST_SKIP() << "skipped: no data";
    const Frame frame = from_side(read(file), View::left, 40, 1e9);
    const Silhouette brain(frame);
    const int height = brain.bottom - brain.top;
    const Silhouette lowest(frame, brain.bottom - height / 5);
    EXPECT_GT(lowest.x, brain.x + 0.1 * (brain.right - brain.left));
}

/// The slices of the series are tilted so that the forehead's end is the higher one.
TEST(RealAnatomy, SlabIsHigherInFront) {
    const std::string file = data_file("t1_slab_dicom");
    if (file.empty()) GTEST_SKIP() << "skipped: no data";
    const Frame frame = from_side(read(file), View::left, 10, 1e9);
    const Silhouette slab(frame);
    const int middle = int(std::lround(slab.y));
    EXPECT_LT(Silhouette(frame, 0, middle).x, slab.x);
    EXPECT_GT(Silhouette(frame, middle).x, slab.x);
}

/// The heart lies to the patient's left: on the right of the view from the front. The lungs beside it are transparent,
/// and the ribs before and behind them the same on both sides.
TEST(RealAnatomy, HeartIsOnTheRightSeenFromTheFront) {
    const std::string file = data_file("chest_lidc.mha");
    if (file.empty()) GTEST_SKIP() << "skipped: no data";
    const Frame frame = from_side(read(file), View::anterior, 110, 1e9);
    const Silhouette chest(frame);
    const int height = chest.bottom - chest.top, midline = frame.width / 2;
    const auto covered = [&](int first, int last) {
        double sum = 0;
        for (int row = chest.top + height / 3; row < chest.top + 2 * height / 3; ++row)
            for (int column = first; column < last; ++column)
                sum += frame.rgba[4 * std::size_t(row * frame.width + column) + 3];
        return sum;
    };
    const double right = covered(midline + 10, midline + 60), left = covered(midline - 60, midline - 10);
    EXPECT_GT(right, 1.15 * left);
}

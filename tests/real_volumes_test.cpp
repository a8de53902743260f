// The volumes of the test-data folder (CHIARO_DATA_DIR): what its README states of each.
#include "volume_files.h"

using namespace chiaro;
using namespace volume_files;

namespace {

struct Row {
    std::string file;
    std::array<int, 3> dimensions;
    VoxelType type;
    Vec3 spacing_mm;
    std::array<double, 6> range;  ///< min, p1, p50, p99, p99.9, max of the stored values
    double tolerance = 1;         ///< of p99 and p99.9, which the README has from a sample of the voxels
    World world = World::unknown;
};

const Row rows[] = {
    {"engine.nrrd", {256, 256, 128}, VoxelType::u8, {1, 1, 1}, {0, 0, 2, 187, 255, 255}},
    {"bonsai.nrrd", {256, 256, 256}, VoxelType::u8, {1, 1, 1}, {0, 0, 0, 204, 222, 255}},
    {"aneurism.nrrd", {256, 256, 256}, VoxelType::u8, {1, 1, 1}, {0, 0, 0, 1, 255, 255}},
    {"cthead.nrrd", {256, 256, 113}, VoxelType::u16, {1, 1, 2}, {0, 0, 52, 2294, 2715, 3272}},
    {"head_unc.nii.gz", {208, 256, 225}, VoxelType::u8, {1, 1, 1}, {0, 0, 0, 177, 203, 255}, 1, World::ras},
    {"head_ct_512.nrrd", {512, 512, 262}, VoxelType::u16, {0.683594, 0.683594, 1}, {24, 24, 24, 2124, 2532, 4095}},
    {"carp.nii.gz", {256, 512, 256}, VoxelType::u8, {1, 1, 1}, {0, 0, 0, 103, 156, 254}, 1, World::ras},
    {"heptane.nrrd", {302, 302, 302}, VoxelType::u8, {1, 1, 1}, {0, 0, 0, 152, 246, 255}},
    {"smoke.nrrd", {100, 100, 40}, VoxelType::f32, {0.01, 0.01, 0.01}, {0, 0, 0, 0.843, 1, 1}, 0.001},
    {"brain_mri.nii.gz", {301, 370, 316}, VoxelType::u8, {0.5, 0.5, 0.5}, {0, 0, 0, 117, 120, 130}, 1, World::ras},
    {"fetal_brain_mri.nrrd",
     {117, 159, 126},
     VoxelType::f32,
     {0.859375, 0.859375, 0.859375},
     {0, 0, 36.74, 545.6, 640.6, 710.7},
     0.1,
     World::lps},
    {"t1_head_dicom",
     {274, 384, 384},
     VoxelType::i16,
     {0.699988, 0.666667, 0.666667},
     {0, 0, 0, 76, 84, 278},
     1,
     World::lps},
    {"t1_slab_dicom",
     {274, 384, 24},
     VoxelType::i16,
     {0.699988, 0.666667, 0.666667},
     {0, 0, 1, 72, 80, 179},
     1,
     World::lps},
    {"chest_lidc.mha",
     {256, 256, 133},
     VoxelType::u8,
     {1.40625, 1.40625, 2.5},
     {0, 0, 0, 132, 255, 255},
     1,
     World::lps},
    {"tooth.nhdr", {103, 94, 161}, VoxelType::u16, {1, 1, 1}, {0, 360, 405, 1218, 1253, 1300}},
    {"neghip_64x64x64_uint8.raw", {64, 64, 64}, VoxelType::u8, {1, 1, 1}, {0, 0, 0, 255, 255, 255}},
};

class RealVolume : public testing::TestWithParam<Row> {
protected:
    /// Where the file of the row is; the packed series is unpacked into `folder_`.
    std::string path() {
        const char* data = std::getenv("CHIARO_DATA_DIR");
        if (!data) return {};
        const fs::path volumes = fs::path(data) / "volumes";
        if (GetParam().file != "t1_head_dicom") return (volumes / GetParam().file).string();
        const std::string unpack =
            "cd '" + folder_.name() + "' && cmake -E tar xf '" + (volumes / "t1_head_dicom.zip").string() + "'";
        EXPECT_EQ(std::system(unpack.c_str()), 0);
        return (folder_ / "t1_head_dicom").string();
    }

private:
    Folder folder_;
};

}  // namespace

TEST_P(RealVolume, IsWhatItsReadmeStates) {
    const std::string name = path();
    if (name.empty()) GTEST_SKIP() << "skipped: no data";
    const Row& row = GetParam();
    Volume volume = read(name);
    EXPECT_EQ(volume.dimensions, row.dimensions);
    EXPECT_EQ(volume.type, row.type);
    EXPECT_EQ(volume.geometry.world, row.world);
    expect_near(volume.geometry.spacing_mm, row.spacing_mm, 1e-5);
    volume.slope = 1;  // the table is of stored values
    volume.intercept = 0;
    const auto s = measure(volume);
    const double found[] = {s.min, s.p1, s.p50, s.p99, s.p999, s.max};
    for (std::size_t i = 0; i < 6; ++i) EXPECT_NEAR(found[i], row.range[i], row.tolerance) << "entry " << i;
}

INSTANTIATE_TEST_SUITE_P(Data, RealVolume, testing::ValuesIn(rows), [](const auto& row) {
    std::string name = row.param.file.substr(0, row.param.file.find('.'));
    return name;
});

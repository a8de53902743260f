// Truths of smooth probabilistic ambient occlusion (spec: closed forms), and that its filters agree.
#include <chiaro/text.h>
#include <gtest/gtest.h>

#include <random>

#include "fixtures.h"
#include "illumination/field.h"
#include "illumination/spao/means.h"
#include "illumination/spao/spao.h"

namespace chiaro {
namespace {

using testing::tested_device;
using Cells = std::array<int, 3>;
using Opacity = std::function<double(int x, int y, int z)>;

CellOpacity opacity_from(const Cells& count, const Opacity& alpha) {
    CellGrid grid;
    grid.count = count;
    CellOpacity opacity{CellValues(grid), BlockMap(count, true)};
    for (int z = 0; z < count[2]; ++z)
        for (int y = 0; y < count[1]; ++y)
            for (int x = 0; x < count[0]; ++x) opacity.values.data()[grid.index(x, y, z)] = cell_value(alpha(x, y, z));
    return opacity;
}

/// Soft blobs and hard walls, no symmetry; not a multiple of the block.
CellOpacity clutter(const Cells& count = {45, 39, 51}) {
    return opacity_from(count, [](int x, int y, int z) {
        const double soft = 0.5 + 0.5 * std::sin(0.31 * x + 0.2) * std::sin(0.23 * y + 0.7) * std::sin(0.27 * z);
        const bool wall = (x > 30 && x < 33) || (y == 12 && z < 30) || (x + y + z) % 37 == 0;
        return wall ? 1.0 : soft > 0.6 ? 0.4 * soft : 0.0;
    });
}

struct Occlusion {
    CellGrid grid;
    std::vector<double> access;
    double operator()(int x, int y, int z) const { return access[grid.index(x, y, z)]; }
};

Occlusion occlusion(const CellOpacity& opacity, const SpaoSettings& settings, const Device& device = tested_device()) {
    StageTimer timer;
    Progress progress;
    const BlockMap all(opacity.values.grid.count, true);
    const CellValues values = spao_accessibility(device, opacity, settings, all, timer, progress);
    Occlusion result{values.grid, {}};
    for (std::size_t i = 0; i < values.grid.size(); ++i) result.access.push_back(values.data()[i] / 65535.0);
    return result;
}

double rms(const Occlusion& a, const Occlusion& b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.access.size(); ++i) sum += std::pow(a.access[i] - b.access[i], 2);
    return std::sqrt(sum / double(a.access.size()));
}

constexpr SpaoFilter all_filters[] = {SpaoFilter::automatic, SpaoFilter::nbuffer, SpaoFilter::mipmap,
                                      SpaoFilter::hybrid, SpaoFilter::exact};
constexpr SpaoFilter exact_filters[] = {SpaoFilter::nbuffer, SpaoFilter::exact};
constexpr SpaoModel all_models[] = {SpaoModel::paper, SpaoModel::thick, SpaoModel::corrected};

SpaoSettings with(SpaoFilter filter, SpaoModel model, int levels, double normal_factor = 0) {
    return {.filter = filter, .levels = levels, .normal_factor = normal_factor, .model = model};
}

TEST(Spao, NothingOccludesEmptySpace) {
    const CellOpacity empty = opacity_from({37, 20, 9}, [](int, int, int) { return 0.0; });
    for (const SpaoFilter filter : all_filters)
        for (const SpaoModel model : all_models)
            for (const double factor : {0.0, 1.0, 2.0})
                for (const double a : occlusion(empty, with(filter, model, 5, factor)).access) ASSERT_EQ(a, 1);
}

TEST(Spao, HomogeneousInteriorIsAPowerOfItsTransparency) {
    constexpr double alpha = 0.03;
    const CellOpacity fog = opacity_from({40, 40, 40}, [](int, int, int) { return alpha; });
    for (const SpaoFilter filter : all_filters) {
        const int levels = 4;  // cubes of half width 8: well inside
        EXPECT_NEAR(occlusion(fog, with(filter, SpaoModel::paper, levels))(20, 20, 20), std::pow(1 - alpha, levels),
                    2e-4);
        EXPECT_NEAR(occlusion(fog, with(filter, SpaoModel::corrected, levels))(20, 20, 20),
                    std::pow(1 - alpha, std::exp2(levels - 1) - 0.5), 5e-4);
        double exponent = 0;
        for (int l = 0; l < levels; ++l) exponent += std::pow(std::exp2(l - 1), 0.75);
        EXPECT_NEAR(occlusion(fog, with(filter, SpaoModel::thick, levels))(20, 20, 20), std::pow(1 - alpha, exponent),
                    5e-4);
    }
}

TEST(Spao, OneOpaqueVoxelShadesItsNeighboursByTheirShareOfTheFirstShell) {
    const CellOpacity one =
        opacity_from({21, 21, 21}, [](int x, int y, int z) { return x == 10 && y == 10 && z == 10; });
    for (const SpaoFilter filter : exact_filters) {
        const Occlusion a = occlusion(one, with(filter, SpaoModel::paper, 1));
        EXPECT_NEAR(a(10, 10, 10), 1, 5e-5);  // nothing occludes itself
        EXPECT_NEAR(a(11, 10, 10), 1 - 4.0 / 56, 5e-5);
        EXPECT_NEAR(a(11, 9, 10), 1 - 2.0 / 56, 5e-5);
        EXPECT_NEAR(a(11, 9, 11), 1 - 1.0 / 56, 5e-5);
        EXPECT_NEAR(a(12, 10, 10), 1, 5e-5);
    }
}

TEST(Spao, HalfSpace) {
    const CellOpacity half = opacity_from({40, 40, 48}, [](int, int, int z) { return z < 24; });
    for (const SpaoFilter filter : exact_filters)
        EXPECT_NEAR(occlusion(half, with(filter, SpaoModel::paper, 1))(20, 20, 24), 5.0 / 7, 5e-5);
    for (const SpaoFilter filter : all_filters) {
        // Just above the surface everything outwards is open; the normal points out, not in.
        EXPECT_NEAR(occlusion(half, with(filter, SpaoModel::corrected, 4, 1))(20, 20, 24), 1, 1e-3);
        // The sweep interpolates what lies further out, across the surface too.
        const double below = filter == SpaoFilter::automatic ? 0.65 : 0.4;
        EXPECT_LT(occlusion(half, with(filter, SpaoModel::corrected, 4, 1))(20, 20, 23), below);
        // The published cubes leave the matter when they move outwards.
        EXPECT_GT(occlusion(half, with(filter, SpaoModel::paper, 4, 1))(20, 20, 24),
                  occlusion(half, with(filter, SpaoModel::paper, 4, 0))(20, 20, 24) + 0.2);
    }
    // On the plane itself exactly half of the octants are open.
    Progress progress;
    const SummedOpacity sums(tested_device(), half.values, progress);
    const kernel::ExactKernel kernel{sums.view(), 4, kernel::SpaoProduct::corrected, 0};
    EXPECT_NEAR(kernel(kernel::Vec3<float>(20, 20, 23.5f)), 0.5, 1e-6);
}

TEST(Spao, MeansAreThoseOfBoxesAtAnyPositionAcrossTheBorderToo) {
    const CellOpacity opacity = clutter({23, 18, 29});
    StageTimer timer;
    Progress progress;
    const SpaoLevels levels(tested_device(), opacity, 0, 6, timer, progress);
    const SummedOpacity sums(tested_device(), opacity.values, progress);
    const kernel::StoredLevels view = levels.view();
    std::mt19937 random(1);
    std::uniform_real_distribution<float> anywhere(-20, 45);
    for (int i = 0; i < 20000; ++i) {
        const int level = i % 7;
        const kernel::Vec3<float> p(anywhere(random), anywhere(random), anywhere(random));
        const double box = sums.view().mean(std::exp2(level), p.x, p.y, p.z);
        ASSERT_NEAR(view.mean(level, p) / 65535, box / 65535, 1e-4) << "level " << level;
    }
}

TEST(Spao, SumsAreThoseOfEveryCell) {
    const CellOpacity opacity = clutter({7, 6, 5});
    Progress progress;
    const SummedOpacity sums(tested_device(), opacity.values, progress);
    double all = 0;
    for (std::size_t i = 0; i < opacity.values.grid.size(); ++i) all += opacity.values.data()[i];
    EXPECT_NEAR(sums.view().mean(8, 3, 2.5, 2) * 512, all, 1e-6 * all);
    EXPECT_NEAR(sums.view().mean(1, 2, 3, 4), opacity.values.data()[opacity.values.grid.index(2, 3, 4)], 1e-6);
}

/// A row of cells, as drawn on paper: buffers of windows of 1, 2 and 4 cells that begin at each.
TEST(Spao, NBuffersOfARowByHand) {
    const double row[] = {0, 1, 1, 0, 0, 0, 1, 0};
    const CellOpacity opacity = opacity_from({8, 1, 1}, [&](int x, int, int) { return row[x]; });
    StageTimer timer;
    Progress progress;
    const SpaoLevels levels(tested_device(), opacity, 0, 2, timer, progress);
    const double two[] = {0.5, 1, 0.5, 0, 0, 0.5, 0.5, 0}, four[] = {0.5, 0.5, 0.25, 0.25, 0.25, 0.25, 0.25, 0};
    for (int x = 0; x < 8; ++x) {
        // Of one row in an empty space, a window of 2 or 4 cells holds half or a quarter along y and along z.
        EXPECT_NEAR(levels.view().mean(1, kernel::Vec3<float>(x + 0.5f, 0, 0)) / 65535, two[x] / 4, 3e-5);
        EXPECT_NEAR(levels.view().mean(2, kernel::Vec3<float>(x + 1.5f, 0, 0)) / 65535, four[x] / 16, 3e-5);
    }
}

TEST(Spao, FiltersAgreeWithExactBoxes) {
    const CellOpacity opacity = clutter();
    for (const SpaoModel model : all_models)
        for (const double factor : {0.0, 1.0}) {
            const Occlusion ground_truth = occlusion(opacity, with(SpaoFilter::exact, model, 5, factor));
            const auto error = [&](SpaoFilter filter) {
                return rms(ground_truth, occlusion(opacity, with(filter, model, 5, factor)));
            };
            EXPECT_LT(error(SpaoFilter::nbuffer), 4e-4);
            EXPECT_LT(error(SpaoFilter::automatic), 0.06);
            EXPECT_LT(error(SpaoFilter::hybrid), 0.06);
            EXPECT_LT(error(SpaoFilter::mipmap), 0.09);
        }
}

TEST(Spao, AnyNumberOfLevels) {
    const CellOpacity opacity = clutter({20, 35, 11});
    for (const int levels : {1, 2, 3, 4, 7, 10}) {
        const Occlusion ground_truth = occlusion(opacity, with(SpaoFilter::exact, SpaoModel::corrected, levels));
        EXPECT_LT(rms(ground_truth, occlusion(opacity, with(SpaoFilter::automatic, SpaoModel::corrected, levels))),
                  0.03)
            << levels;
        EXPECT_LT(rms(ground_truth, occlusion(opacity, with(SpaoFilter::nbuffer, SpaoModel::corrected, levels))), 1e-3)
            << levels;
    }
}

TEST(Spao, SameBitsOnEveryInstructionSetAndNumberOfThreads) {
    const CellOpacity opacity = clutter();
    for (const SpaoFilter filter : {SpaoFilter::automatic, SpaoFilter::nbuffer, SpaoFilter::mipmap})
        for (const SpaoModel model : all_models)
            for (const double factor : {0.0, 1.0}) {
                const SpaoSettings settings = with(filter, model, 6, factor);
                const Occlusion first = occlusion(opacity, settings, Device::cpu(1, Isa::scalar));
                for (const Isa isa : available_isas())
                    EXPECT_EQ(first.access, occlusion(opacity, settings, Device::cpu(3, isa)).access) << name_of(isa);
            }
}

TEST(Spao, AxesAreAlike) {
    const Cells count{41, 34, 37};
    const CellOpacity opacity = clutter(count);
    const auto& values = opacity.values;
    const CellOpacity turned = opacity_from({count[1], count[2], count[0]}, [&](int x, int y, int z) {
        return values.data()[values.grid.index(z, x, y)] / 65535.0;
    });
    for (const SpaoModel model : all_models) {
        const Occlusion a = occlusion(opacity, with(SpaoFilter::automatic, model, 6, model == SpaoModel::corrected));
        const Occlusion b = occlusion(turned, with(SpaoFilter::automatic, model, 6, model == SpaoModel::corrected));
        for (int z = 0; z < count[2]; ++z)
            for (int y = 0; y < count[1]; ++y)
                for (int x = 0; x < count[0]; ++x) ASSERT_NEAR(a(x, y, z), b(y, z, x), 2e-3);
    }
}

TEST(Spao, MoreMatterDarkens) {
    const CellOpacity less = clutter();
    const CellOpacity more = opacity_from(less.values.grid.count, [&](int x, int y, int z) {
        return std::min(1.0, less.values.data()[less.values.grid.index(x, y, z)] / 65535.0 + (x > 20 ? 0.2 : 0));
    });
    const SpaoSettings settings = with(SpaoFilter::exact, SpaoModel::corrected, 5);
    const Occlusion a = occlusion(less, settings), b = occlusion(more, settings);
    double mean = 0;
    for (std::size_t i = 0; i < a.access.size(); ++i) mean += a.access[i] - b.access[i];
    EXPECT_GT(mean / double(a.access.size()), 0.05);
}

TEST(Spao, OnlyTheAskedBlocksAreFilledAndTheyAreTheSame) {
    const CellOpacity opacity = clutter({70, 40, 66});
    const SpaoSettings settings = with(SpaoFilter::automatic, SpaoModel::corrected, 7, 1);
    const Occlusion all = occlusion(opacity, settings);
    BlockMap some(opacity.values.grid.count);
    some(1, 0, 1) = 1;
    StageTimer timer;
    Progress progress;
    const CellValues part = spao_accessibility(tested_device(), opacity, settings, some, timer, progress);
    for (int z = 32; z < 64; ++z)
        for (int y = 0; y < 32; ++y)
            for (int x = 32; x < 64; ++x)
                ASSERT_EQ(part.data()[part.grid.index(x, y, z)] / 65535.0, all(x, y, z)) << x << " " << y << " " << z;
    EXPECT_EQ(part.data()[part.grid.index(5, 5, 5)], 0);
}

TEST(Spao, CancelsAndNamesItsSteps) {
    const CellOpacity opacity = clutter();
    StageTimer timer;
    Progress progress;
    const BlockMap all(opacity.values.grid.count, true);
    spao_accessibility(tested_device(), opacity, with(SpaoFilter::nbuffer, SpaoModel::paper, 3), all, timer, progress);
    std::vector<std::string> names;
    for (const Stage& stage : timer.take()) names.push_back(stage.name);
    EXPECT_EQ(names, (std::vector<std::string>{"spao level 0", "spao level 1", "spao level 2", "spao level 3",
                                               "spao combine"}));
    progress.cancel();
    for (const SpaoFilter filter : all_filters)
        EXPECT_THROW(
            spao_accessibility(tested_device(), opacity, with(filter, SpaoModel::paper, 5), all, timer, progress),
            Error);
}

TransferFunction opaque_above(double value) {
    TransferFunction tf;
    tf.points = {{value, {1, 1, 1}, 0}, {value + 1, {1, 1, 1}, 1}};
    return tf;
}

TEST(Spao, AnOpenFlatSurfaceKeepsItsBrightness) {
    const Volume volume =
        testing::sampled<std::uint8_t>({40, 40, 40}, [](double, double, double z) { return z < 20 ? 200 : 0; });
    testing::Shot shot;
    shot.tf = opaque_above(100);
    shot.camera.elevation_deg = 90;
    shot.camera.zoom = 4;
    for (const Mode mode : {Mode::dvr, Mode::iso})
        for (const SpaoFilter filter : {SpaoFilter::automatic, SpaoFilter::hybrid})
            for (const double factor : {0.0, 0.5, 1.0}) {
                shot.shape.mode = mode;
                if (mode == Mode::iso) shot.shape.iso = {{.value = 100, .color = Rgb{1, 1, 1}}};
                const SpaoSettings spao = with(filter, SpaoModel::corrected, 5, factor);
                const Frame bright = shot.lit(volume, {}),
                            shaded = shot.lit(volume, {.method = Method::spao, .spao = spao});
                const std::size_t centre = 4 * (std::size_t(shot.height / 2) * shot.width + shot.width / 2);
                EXPECT_NEAR(shaded.rgba[centre] / bright.rgba[centre], 1, 0.02) << to_text(filter) << factor;
            }
}

TEST(Spao, WhereASurfaceLiesOnTheCoarserGridsDoesNotMatter) {
    for (int surface = 17; surface <= 25; ++surface) {
        const CellOpacity half = opacity_from({64, 64, 64}, [&](int, int, int z) { return z < surface; });
        const Occlusion a = occlusion(half, with(SpaoFilter::automatic, SpaoModel::corrected, 6, 1));
        EXPECT_GT(a(32, 32, surface), 0.98) << surface;
        EXPECT_NEAR(occlusion(half, with(SpaoFilter::automatic, SpaoModel::corrected, 6))(32, 32, surface), 0.5, 0.02);
    }
}

TEST(Spao, WhatIsClippedOrThresholdedCastsNoShadow) {
    // A lid over a floor: with the lid gone, the floor is open.
    const Volume volume = testing::sampled<std::uint8_t>({48, 48, 48}, [](double, double, double z) {
        return z < 16 ? 200 : z > 20 && z < 24 ? 120 : 0;
    });
    testing::Shot shot;
    shot.tf = opaque_above(100);
    const auto access = [&](const Shape& shape) {
        Progress progress;
        const Medium medium = classify(upload(shot.device, volume), shot.tf, shape);
        const CellOpacity opacity = cell_opacity(medium.data(), progress);
        return occlusion(opacity, with(SpaoFilter::automatic, SpaoModel::corrected, 5, 1))(24, 24, 16);
    };
    Shape clipped, thresholded;
    clipped.clip.box = {0, 1, 0, 1, 0, 0.4};
    thresholded.threshold_low = 150;
    EXPECT_LT(access({}), 0.5);
    EXPECT_GT(access(clipped), 0.95);
    EXPECT_GT(access(thresholded), 0.95);
}

TEST(Spao, ThickSlicesAreLitAsTheCubicVoxelsTheyStandFor) {
    const auto ball = [](double x, double y, double z) {
        return 250 - 12 * std::sqrt(std::pow(x - 31.5, 2) + std::pow(y - 31.5, 2) + std::pow(z - 31.5, 2));
    };
    const Volume cubic = testing::sampled<float>({64, 64, 64}, ball);
    Volume thick =
        testing::sampled<float>({64, 64, 32}, [&](double x, double y, double z) { return ball(x, y, 2 * z + 0.5); });
    thick.geometry.spacing_mm = {1, 1, 2};
    const auto access = [&](const Volume& volume) {
        Progress progress;
        const Medium medium = classify(upload(tested_device(), volume), opaque_above(100), {});
        return occlusion(cell_opacity(medium.data(), progress),
                         with(SpaoFilter::automatic, SpaoModel::corrected, 6, 0));
    };
    const Occlusion a = access(cubic), b = access(thick);
    EXPECT_EQ(b.grid.count, (Cells{64, 64, 64}));
    EXPECT_LT(rms(a, b), 0.02);
}

TEST(Spao, CellsStayFewWhateverTheSpacing) {
    Geometry geometry;
    geometry.spacing_mm = {1e-3, 1, 1000};
    const CellGrid wild = make_cell_grid({16, 16, 16}, geometry);
    EXPECT_LE(wild.size(), 64 * 4096u);
    EXPECT_GE(wild.count[0], 1);
    geometry.spacing_mm = {0.5, 0.5, 2};
    const CellGrid thick = make_cell_grid({40, 30, 20}, geometry);
    EXPECT_EQ(thick.count, (Cells{40, 30, 80}));
    EXPECT_EQ(thick.edge_mm, 0.5);
    EXPECT_EQ(make_cell_grid({40, 30, 20}, Geometry{}).is_voxel_grid, true);
}

TEST(Spao, MemoryOfAnAnswerThatWentLeavesNothingBehind) {
    const Volume volume = testing::sampled<std::uint8_t>({70, 70, 70}, [](double x, double, double) { return 3 * x; });
    const DeviceVolume uploaded = upload(tested_device(), volume);
    const auto values_above = [&](double threshold) {
        Progress progress;
        const Medium medium = classify(uploaded, opaque_above(threshold), {});
        std::vector<std::uint16_t> values;
        illuminate(
            tested_device(), medium, Prepared(), Lighting(), {.method = Method::spao},
            [&](const IlluminationField& field) {
                const CellValues& access = *field.data().access;
                values.assign(access.data(), access.data() + access.grid.size());
            },
            progress);
        return values;
    };
    const auto first = values_above(180);
    EXPECT_NE(values_above(20), first);
    EXPECT_EQ(values_above(180), first);
}

TEST(Spao, StrengthBlendsTowardsFullLight) {
    const Volume volume = testing::sampled<std::uint8_t>(
        {40, 40, 40}, [](double x, double y, double z) { return testing::shells(x, y, z, 40); });
    testing::Shot shot;
    const IlluminationSettings spao{.method = Method::spao};
    const Frame none = shot.lit(volume, {}), full = shot.lit(volume, spao);
    shot.lighting.strength = 0.5;
    const Frame half = shot.lit(volume, spao);
    shot.lighting.strength = 0;
    EXPECT_LT(testing::difference(none, shot.lit(volume, spao), 1e-6).max, 1e-6);
    for (std::size_t i = 0; i < none.rgba.size(); ++i)
        ASSERT_NEAR(half.rgba[i], (none.rgba[i] + full.rgba[i]) / 2, 1e-5);
    EXPECT_GT(testing::difference(none, full, 1e-3).max, 0.05);
}

}  // namespace
}  // namespace chiaro

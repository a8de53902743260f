// What a GPU finds after an edit, number by number against the CPU's.
#include <random>

#include "classify/medium.h"
#include "cuda_case.h"
#include "illumination/cells/opacity.h"
#include "illumination/histogram/optics.h"
#include "illumination/reference/extinction.h"
#include "illumination/transport/gpu.h"
#include "illumination/transport/grid.h"
#include "illumination/transport/matter.h"
#include "illumination/visibility/density.h"

using namespace chiaro;
using namespace chiaro::testing;

TEST_F(Gpus, ClassifyAsTheCpuDoes) {
    const auto cells = [](const Device& device, const Volume& volume, const TransferFunction& tf, const Shape& shape) {
        const Medium medium = classify(upload(device, volume), tf, shape);
        return std::pair(medium.data().cells, medium.occupied_fraction());
    };
    std::mt19937 random(7);
    const auto specks = [&](double, double, double) { return random() % 3000 == 0 ? 200.0 : 0.0; };
    const auto blob = [](double x, double y, double z) { return x + y + z < 90 && x > 20 ? 150.0 : 20.0; };
    const Shape surfaces{.mode = Mode::iso, .iso = {{.value = 90}, {.value = 180}}};
    for (const Volume& volume : {sampled<std::uint8_t>({150, 61, 9}, specks), sampled<float>({700, 30, 40}, blob),
                                 shells_of<std::uint16_t>(60), sampled<std::uint8_t>({5, 3, 2}, specks)})
        for (const Shape& shape : {Shape{}, surfaces})
            for (const TransferFunction& tf : {two_materials(), constant(0), constant(0.5)})
                EXPECT_EQ(cells(gpu, volume, tf, shape), cells(cpu(), volume, tf, shape));
}

#ifdef CHIARO_CUDA_EMULATED
TEST_F(Gpus, ClassifyOnTheStreamOfTheirOwnSession) {
    const DeviceVolume voxels = upload(gpu, shells_of<std::uint8_t>(40));
    const Device other = gpu.with_own_stream();
    classify(other, voxels, two_materials(), {});
    EXPECT_EQ(cuda_emulated::gpu().last_stream, other.stream->handle());
    classify(voxels, two_materials(), {});
    EXPECT_EQ(cuda_emulated::gpu().last_stream, gpu.stream->handle());
}
#endif

namespace {

/// Of every type, cubes and others, with a last voxel beyond the last brick and without.
std::vector<Volume> volumes_of_every_sort() {
    std::vector<Volume> volumes;
    volumes.push_back(shells_of<std::uint8_t>(37));
    volumes.push_back(shells_of<std::uint16_t>(34));
    volumes.push_back(shells_of<float>(33));
    for (std::size_t i = 0; i < 3; ++i) {
        volumes.push_back(Volume());
        Volume& thick = volumes.back();
        thick = i == 0 ? shells_of<std::uint8_t>(30) : i == 1 ? shells_of<std::uint16_t>(30) : shells_of<float>(30);
        thick.geometry.spacing_mm = {1, 1.3, 2.5};
        thick.slope = -1, thick.intercept = 255;
    }
    return volumes;
}

std::vector<Shape> shapes_of_every_sort() {
    return {{},
            {.clip = {.box = std::array{0.0, 0.5, 0.1, 1.0, 0.0, 1.0}, .planes = {{{1, 1, 0}, 40}}}},
            {.mode = Mode::iso, .iso = {{.value = 90, .opacity = 0.5}, {.value = 180}}}};
}

}  // namespace

TEST_F(Gpus, StopLightInCellsAsTheCpuDoes) {
    const auto opacity = [](const Device& device, const Volume& volume, const Shape& shape) {
        Progress progress;
        return cell_opacity(classify(upload(device, volume), two_materials(), shape).data(), progress);
    };
    for (const Volume& volume : volumes_of_every_sort())
        for (const Shape& shape : shapes_of_every_sort()) {
            const CellOpacity expected = opacity(cpu(), volume, shape), found = opacity(gpu, volume, shape);
            const std::size_t cells = expected.values.grid.size();
            EXPECT_TRUE(std::equal(found.values.data(), found.values.data() + cells, expected.values.data()));
            EXPECT_GT(std::count(expected.values.data(), expected.values.data() + cells, 0), 100);
            EXPECT_GT(*std::max_element(expected.values.data(), expected.values.data() + cells), 10000);
        }
}

TEST_F(Gpus, MeetTheDensityThatTheCpuMeets) {
    Progress progress;
    for (const Volume& volume : volumes_of_every_sort())
        for (const Shape& shape : shapes_of_every_sort())
            for (const int subsample : {1, 2, 8}) {
                const auto density = [&](const Device& device) {
                    const Medium medium = classify(upload(device, volume), two_materials(), shape);
                    return density_for(medium.data(), subsample, device, progress);
                };
                const Density expected = density(cpu()), found = density(gpu);
                const std::span<const float> a(expected.data(), expected.grid.size());
                for (std::size_t i = 0; i < a.size(); ++i) ASSERT_NEAR(found.data()[i], a[i], tolerance);
                EXPECT_GT(*std::max_element(a.begin(), a.end()), 0.1);
                const Density coarse = halved(expected, cpu(), progress), on_gpu = halved(found, gpu, progress);
                for (std::size_t i = 0; i < coarse.grid.size(); ++i)
                    ASSERT_NEAR(on_gpu.data()[i], coarse.data()[i], tolerance);
            }
}

TEST_F(Gpus, FindVisibilityByEveryTraversal) {
    IlluminationSettings light{.method = Method::visibility};
    const Volume volume = shells_of<std::uint8_t>(27);
    const Medium medium = classify(upload(gpu, volume), two_materials(), {});
    for (const auto traversal :
         {VisibilityTraversal::sheared, VisibilityTraversal::hierarchical, VisibilityTraversal::full}) {
        light.visibility = {.directions = 60, .traversal = traversal};
        for (const int bands : {2, 4})
            for (const bool jittered : {false, true}) {
                light.visibility.bands = bands;
                light.visibility.sampling = {.jittered = jittered, .sets = 3};
                expect_same_field(medium, light, fmt::format("traversal {}, {} bands", int(traversal), bands));
            }
        expect_same(shaded(), volume, light);
    }
    light.visibility = {.directions = 300, .subsample = 1, .traversal = VisibilityTraversal::sheared};
    expect_same_field(medium, light, "several batches");
}

TEST_F(Gpus, LayOutTransportsGridAsTheCpuDoes) {
    Progress progress;
    std::size_t boundary_cells = 0;
    auto volumes = volumes_of_every_sort();
    volumes.push_back(sampled<std::uint8_t>({48, 40, 44}, [](double x, double, double) { return x > 17 ? 200 : 0; }));
    for (const Volume& volume : volumes)
        for (const Shape& shape : shapes_of_every_sort())
            for (const int cells : {40, 20, 13, 5}) {  // a cell a node, 2, 3, many
                const TransferFunction tf = &volume == &volumes.back() ? walls() : two_materials();
                const auto grid = [&](const Device& device) {
                    const Medium medium = classify(upload(device, volume), tf, shape);
                    return light_grid(medium.data(), cells, 0.6, device, progress);
                };
                const LightGrid expected = grid(cpu()), found = grid(gpu);
                EXPECT_EQ(found.boundary_cells, expected.boundary_cells);
                boundary_cells += expected.boundary_cells.size();
                for (std::size_t i = 0; i < expected.extinction.grid.size(); ++i) {
                    ASSERT_NEAR(found.extinction.data()[i], expected.extinction.data()[i], tolerance);
                    for (std::size_t c = 0; c < 3; ++c)
                        ASSERT_NEAR(found.albedo[c][i], expected.albedo[c][i], tolerance);
                }
                EXPECT_GT(*std::max_element(expected.albedo[0], expected.albedo[0] + expected.albedo.nodes), 0.1f);
            }
    EXPECT_GT(boundary_cells, 50u);
}

TEST_F(Gpus, KnowTheMatterThatTransportMeets) {
    Progress progress;
    const Volume volume = shells_of<std::uint8_t>(30);
    const auto expect_near = [](const auto& found, const auto& expected) {
        ASSERT_EQ(found.size(), expected.size());
        for (std::size_t i = 0; i < expected.size(); ++i) ASSERT_NEAR(found[i], expected[i], tolerance);
    };
    for (const TransferFunction& tf : {two_materials(), walls()}) {
        const auto matter = [&](const Device& device) {
            const Medium medium = classify(upload(device, volume), tf, {});
            return matter_of(device, medium.data(), 40, {}, progress);
        };
        const SharedTransportMedium whole[]{matter(cpu()), matter(gpu)};
        const SharedTransportMedium half[]{halved(whole[0], cpu(), progress), halved(whole[1], gpu, progress)};
        for (const SharedTransportMedium* both : {whole, half}) {
            const TransportMedium &expected = *both[0], &found = *both[1];
            EXPECT_EQ(found.opaque.nodes(), expected.opaque.nodes());
            expect_near(found.weight, expected.weight);
            expect_near(unlit_nodes(found).result, unlit_nodes(expected).result);
            for (std::size_t c = 0; c < 3; ++c) expect_near(found.albedo()[c], expected.albedo()[c]);
            expect_near(found.swept.extinction().along_x, expected.swept.extinction().along_x);
            expect_near(found.swept.extinction().along_y, expected.swept.extinction().along_y);
        }
    }
}

#ifdef CHIARO_CUDA_EMULATED
TEST_F(Gpus, KeepTheColoursOfTransportsGrid) {
    Progress progress;
    const Medium medium = classify(upload(gpu, shells_of<std::uint8_t>(50)), walls(), {});
    const cuda_emulated::Gpu& emulated = cuda_emulated::gpu();
    const std::size_t before = emulated.downloaded_bytes;
    const SharedTransportMedium matter = matter_of(gpu, medium.data(), 60, {}, progress);
    const std::size_t nodes = matter->weight.size(),
                      shown = matter->opaque.count() + matter->grid.boundary_cells.size();
    EXPECT_GT(shown, 0u);
    EXPECT_LE(emulated.downloaded_bytes - before, 5 * nodes + 12 * shown) << "density, and where skins are";
    const std::size_t sent = emulated.uploaded_bytes;
    const GpuTransport transport(gpu, matter->swept);
    EXPECT_LE(emulated.uploaded_bytes - sent, 7 * nodes + 200 * shown) << "opaque cells, with a halo";
}
#endif

TEST_F(Gpus, FindWhatStopsTheReferencesRays) {
    Progress progress;
    const auto expect_same = [&](const auto& cells_by) {
        const ExtinctionCells expected = cells_by(cpu()), found = cells_by(gpu);
        HostArrays arrays;
        found.add_to(arrays), arrays.fetch();
        for (int axis = 0; axis < 3; ++axis) {
            EXPECT_EQ(found.low(axis), expected.low(axis));
            EXPECT_EQ(found.high(axis), expected.high(axis));
        }
        EXPECT_GT(expected.high(0), expected.low(0));
        const std::size_t count = std::size_t(expected.slice()) * expected.count()[2];
        double worst = 0;
        for (std::size_t i = 0; i < count; ++i)
            worst = std::max(worst, std::abs(double(found.address()[i]) - expected.address()[i]));
        EXPECT_LE(worst, tolerance);
    };
    Volume thick = shells_of<float>(40);
    thick.geometry.spacing_mm = {1, 1.3, 2.5};
    const Shape clipped{.clip = {.planes = {{{1, 2, 1}, 70}}}};
    const Shape surface{.mode = Mode::iso, .iso = {{.value = 90, .opacity = 0.5}}};
    const DeviceVolume cubes = upload(gpu, shells_of<std::uint8_t>(40)), others = upload(gpu, thick);
    for (const Medium& medium : {classify(cubes, two_materials(), {}), classify(others, two_materials(), clipped),
                                 classify(others, two_materials(), surface)})
        for (const int stride : {1, 3}) {
            const CellOpacity opacity = cell_opacity(medium.data(), progress);
            expect_same([&](const Device& device) {
                return ExtinctionCells(medium.data(), opacity, stride, device, progress);
            });
            const Density density = density_for(medium.data(), 2, gpu, progress);
            expect_same([&](const Device& device) { return ExtinctionCells(density, stride, device, progress); });
        }
}

TEST_F(Gpus, FollowTheRaysOfTheReference) {
    using enum ReferenceQuantity;
    IlluminationSettings light{.method = Method::reference};
    Volume thick = shells_of<float>(20);
    thick.geometry.spacing_mm = {1, 1.3, 2.5};
    const Shape surface{.mode = Mode::iso, .iso = {{.value = 90, .opacity = 0.5}}};
    const DeviceVolume cubes = upload(gpu, shells_of<std::uint8_t>(20)), others = upload(gpu, thick);
    for (const Medium& medium : {classify(cubes, two_materials(), {}), classify(others, two_materials(), surface)})
        for (const auto matter : {ReferenceMedium::voxels, ReferenceMedium::trilinear})
            for (const auto quantity : {obscurance, ao, ao_cosine, visibility})
                for (const int subsample : {1, 4}) {  // a last node off the rhythm of the others
                    light.reference = {.rays = 8, .quantity = quantity, .medium = matter, .subsample = subsample};
                    const auto what = fmt::format("quantity {}, medium {}", int(quantity), int(matter));
                    expect_same_field(medium, light, what);
                }
}

TEST_F(Gpus, OccludeAsTheCpuDoes) {
    IlluminationSettings light{.method = Method::spao};
    const Medium medium = classify(upload(gpu, shells_of<std::uint8_t>(40)), two_materials(), {});
    for (const SpaoModel model : {SpaoModel::paper, SpaoModel::thick, SpaoModel::corrected})
        for (const SpaoFilter filter :
             {SpaoFilter::automatic, SpaoFilter::nbuffer, SpaoFilter::mipmap, SpaoFilter::hybrid, SpaoFilter::exact})
            for (const double normal_factor : {0.0, 1.0}) {
                light.spao.model = model, light.spao.filter = filter, light.spao.normal_factor = normal_factor;
                const auto what = fmt::format("model {}, filter {}, F {}", int(model), int(filter), normal_factor);
                expect_same_field(medium, light, what);
            }
    light.spao = {};
    for (const int levels : {1, 2, 3}) {  // no coarser grid, one
        light.spao.levels = levels;
        expect_same_field(medium, light, fmt::format("{} levels", levels));
    }
}

TEST_F(Gpus, OccludeBlocksOfEverySort) {
    IlluminationSettings light{.method = Method::spao};
    const Volume longer = sampled<std::uint8_t>({131, 33, 17}, [](double x, double y, double z) {
        return x > 70 && x < 90 ? 0 : 128 + 100 * std::sin(x / 5) * std::sin(y / 3) * std::cos(z / 4);
    });
    expect_same_field(classify(upload(gpu, longer), two_materials(), {}), light, "a long volume");
    expect_same_field(classify(upload(gpu, longer), constant(0), {}), light, "nothing to see");
    const Shape surface{.mode = Mode::iso, .iso = {{.value = 90, .opacity = 0.5}}};
    expect_same_field(classify(upload(gpu, longer), two_materials(), surface), light, "a surface");
    Shot shot = shaded();  // only pieces of blocks are seen
    light.spao.filter = SpaoFilter::automatic;
    expect_same(shot, shells_of<std::uint8_t>(70), light);
}

TEST_F(Gpus, SumTheWordsOfLocalHistograms) {
    std::mt19937 random(3);
    const auto h = std::make_shared<LocalHistograms>();
    h->codewords = 37, h->stride = 112, h->binning.count = 100;
    for (int i = 0; i < h->codewords * h->stride; ++i) h->shares.push_back(std::uint16_t(random()));
    for (int w = 0; w < h->codewords; ++w) h->scale.push_back(1e-6f * float(1 + w));
    BinOptics optics;
    for (int j = 0; j < h->binning.count; ++j) {
        optics.alpha.push_back(j < 20 || j > 70 ? 0 : float(random() % 100) / 100);
        optics.rgb.push_back({float(j) / 100, 0.5f, 1});
    }
    const auto expected = codeword_sums(cpu(), *h, optics), found = codeword_sums(gpu, *h, optics);
    ASSERT_EQ(found.size(), 37u);
    for (std::size_t w = 0; w < found.size(); ++w)
        for (std::size_t c = 0; c < 4; ++c) {
            EXPECT_GT(expected[w][c], 0);
            EXPECT_NEAR(found[w][c], expected[w][c], tolerance * expected[w][c]);
        }
    const auto copied = gpu.stream->device_cache()->copied_bytes();
    EXPECT_EQ(copied, h->shares.size() * sizeof h->shares[0]);
    optics.alpha[50] = 1;  // an edit brings only its weights
    codeword_sums(gpu, *h, optics);
    EXPECT_EQ(gpu.stream->device_cache()->copied_bytes(), copied);
}

// Values between voxels on GPUs: splines, and those of texture units against exact ones.
#include <random>

#include "cuda_case.h"

using namespace chiaro;
using namespace chiaro::testing;

namespace {

constexpr double max_off = 3.0 / 256;  ///< of what eight voxels span: three weights of 8 fractional bits

/// Values that have nothing to do with each other, from 0 to 255.
template <class Voxel>
Volume noise(std::array<int, 3> size) {
    std::mt19937 random(11);
    return sampled<Voxel>(size, [&](double, double, double) { return double(random() % 256); });
}

Shot by_texture(Shot shot) {
    shot.shape.interpolation = Interpolation::texture;
    return shot;
}

double rms(const Frame& a, const Frame& b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.rgba.size(); ++i) sum += std::pow(double(a.rgba[i]) - b.rgba[i], 2);
    return std::sqrt(sum / double(a.rgba.size()));
}

}  // namespace

// Splines are the kernels' own: the bits of the CPU, and of thick slices, too.
TEST_F(Gpus, EveryInterpolation) {
    for (const Interpolation interpolation : {Interpolation::cubic, Interpolation::smooth}) {
        Shot shot = shaded();
        shot.shape.interpolation = interpolation;
        expect_same(shot, shells_of<std::uint8_t>(40));
        expect_same(shot, shells_of<float>(40));
        Volume thick = shells_of<std::uint16_t>(40);
        thick.geometry.spacing_mm = {1, 1, 2};
        expect_same(shot, thick);
    }
}

// Shown as they are, the largest values differ by no more than each value may.
TEST_F(Gpus, TextureUnitsKeepToTheirWeights) {
    Shot shot{.device = gpu, .shape = {.mode = Mode::mip}};
    shot.tf.rgb_space = RgbSpace::linear;
    shot.tf.points = {{0, {0, 0, 0}, 1}, {255, {1, 1, 1}, 1}};
    for (const auto size : {std::array{40, 43, 35}, std::array{33, 1, 65}, std::array{2, 64, 32}})
        for (const Volume& volume : {noise<std::uint8_t>(size), noise<std::uint16_t>(size), noise<float>(size)}) {
            const Difference found = difference(by_texture(shot)(volume), shot(volume), 0);
            EXPECT_LT(found.max, max_off + 1.0 / 2048);  // and an entry of the table
            EXPECT_GT(found.max, 1e-4);                  // it is another way
        }
}

TEST_F(Gpus, TextureUnitsShowTheSameThings) {
    const Volume volume = shells_of<std::uint8_t>(40);
    const auto expect_alike = [&](Shot shot, const IlluminationSettings& light, double least) {
        shot.device = gpu;
        const Frame exact = shot.lit(volume, light);
        const double found = rms(by_texture(shot).lit(volume, light), exact);
        EXPECT_LT(found, 0.004) << to_text(light.method) << ", " << to_text(shot.rays.classification);
        EXPECT_GT(found, least);
        EXPECT_GT(mean_alpha(exact), 0.02);
    };
    Shot shot = shaded();
    for (const auto classification : {Classification::post, Classification::pre, Classification::preintegrated}) {
        shot.rays.classification = classification;  // of voxels these, which the units give as they are
        expect_alike(shot, {}, classification == Classification::pre ? 0 : 1e-6);
    }
    shot.rays.classification = Classification::post;
    expect_alike(shot, {.method = Method::spao}, 1e-6);
    expect_alike(shot, {.method = Method::visibility, .visibility = {.directions = 50}}, 1e-6);
    shot.shape = {.mode = Mode::iso, .iso = {{.value = 90, .opacity = 0.5}, {.value = 180}}};
    expect_alike(shot, {}, 1e-6);
}

TEST_F(Gpus, TextureUnitsMeetTheLightOfLocalHistograms) {
    const Volume volume = shells_of<std::uint8_t>(28);
    const Camera camera = make_camera({}, volume.geometry, volume.dimensions);
    for (const std::string emission : {"", "160:255=20"}) {
        IlluminationSettings light{.method = Method::histogram};
        light.histogram.radius = 4, light.histogram.clusters = 32, light.histogram.cache = "none";
        light.histogram.emission = emission, light.histogram.effects.emission = !emission.empty();
        Progress progress;
        const DeviceVolume voxels = upload(gpu, volume);
        const Medium medium = classify(voxels, two_materials(), {});
        const Medium by_texture = classify(voxels, two_materials(), {.interpolation = Interpolation::texture});
        IlluminationField field;
        const auto keep = [&](IlluminationField f) { field = std::move(f); };
        illuminate(gpu, medium, prepare(voxels, light, progress), {}, light, keep, progress);
        Frame exact(61, 47), found(61, 47), unlit(61, 47);
        raycast(gpu, medium, field, {}, camera, {}, exact, progress);
        raycast(gpu, by_texture, field, {}, camera, {}, found, progress);
        raycast(gpu, by_texture, {}, {}, camera, {}, unlit, progress);
        EXPECT_LT(rms(found, exact), 0.004) << emission;
        EXPECT_GT(rms(found, exact), 1e-6) << emission;
        EXPECT_GT(rms(unlit, exact), 2 * rms(found, exact)) << "the light";
    }
}

TEST_F(Gpus, AloneHaveTextureUnits) {
    const Volume volume = shells_of<std::uint8_t>(40);
    const Frame exact = expect_same(shaded(), volume);
    Shot shot = by_texture(shaded());
    shot.device = cpu();
    EXPECT_EQ(difference(shot(volume), exact, 0).max, 0);
}

#ifdef CHIARO_CUDA_EMULATED
TEST_F(Gpus, KeepATextureAsLongAsItsVolume) {
    const auto held = [] { return cuda_emulated::gpu().held_bytes; };
    Shot shot = by_texture(shaded());
    shot.device = gpu;
    const auto bytes_of = [&](const Volume& volume) {
        const DeviceVolume voxels = upload(gpu, volume);
        shot(voxels);
        const auto once = held();
        shot(voxels);
        EXPECT_EQ(held(), once);
        return once;
    };
    const auto first = bytes_of(shells_of<std::uint16_t>(40));
    EXPECT_EQ(bytes_of(shells_of<std::uint16_t>(40)), first);
}

/// What is shown where a GPU that was chosen by itself, or named, has no such texture; `limit` and `lift` set what it
/// may have.
void expect_exact(const Device& named, const std::function<void(std::size_t bytes)>& limit,
                  const std::function<void()>& normal_offset, const std::string& why) {
    const Volume volume = shells_of<std::uint16_t>(60);
    Shot shot = by_texture(shaded());
    shot.device = cpu();
    const Frame expected = shot(volume);
    for (const Device& device : {named.with_own_stream(), choose_device(cpu()).device}) {
        shot.device = device;
        const DeviceVolume voxels = upload(shot.device, volume);
        limit(voxels.bytes());
        const auto launches = cuda_emulated::gpu().launches;
        EXPECT_EQ(difference(shot(voxels), expected, 0).max, 0);
        normal_offset();
        EXPECT_GT(cuda_emulated::gpu().launches, launches);
        EXPECT_TRUE(device.stream->given_up().empty());
        EXPECT_NE(device.note().find(why), std::string::npos) << device.note();
        EXPECT_NE(device.note().find("; samples are interpolated exactly, not by texture units"), std::string::npos);
        EXPECT_GT(difference(shot(voxels), expected, 0).max, 0);
        EXPECT_EQ(device.note(), "");
    }
}

TEST_F(Gpus, WithoutRoomForATextureInterpolateExactly) {
    cuda_emulated::Gpu& emulated = cuda_emulated::gpu();
    const auto limit = [&](std::size_t bytes) { emulated.memory_bytes = emulated.held_bytes + bytes + (300 << 10); };
    const auto normal_offset = [&] { emulated.memory_bytes = cuda_emulated::Gpu().memory_bytes; };
    expect_exact(gpu, limit, normal_offset, "MiB more do not fit");
}

TEST_F(Gpus, WithShorterTexturesInterpolateExactly) {
    cuda_emulated::Gpu& emulated = cuda_emulated::gpu();
    const auto normal_offset = [&] { emulated.texture_edge = cuda_emulated::Gpu().texture_edge; };
    expect_exact(
        gpu, [&](std::size_t) { emulated.texture_edge = 62; }, normal_offset,
        "cuda:0 (Emulated): textures have at most 62 voxels along y, and the volume has 63");
}
#endif

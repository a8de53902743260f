// Pictures of a GPU against the CPU's: on each GPU there is, and again (cuda_emulated_test) on one of
// emulated, where the bits must be the same.
#include <cstring>
#include <thread>

#include "classify/medium.h"
#include "cuda_case.h"
#include "illumination/transport/solver.h"

using namespace chiaro;
using namespace chiaro::testing;

TEST_F(Gpus, VolumesOfEveryTypeOfVoxel) {
    expect_same(shaded(), shells_of<std::uint8_t>(70));
    expect_same(shaded(), shells_of<std::uint16_t>(40));
    expect_same(shaded(), shells_of<float>(40));
}

TEST_F(Gpus, EveryMode) {
    const Volume volume = shells_of<std::uint8_t>(40);
    Shot shot = shaded();
    shot.shape = {.mode = Mode::iso, .iso = {{.value = 90, .opacity = 0.5}, {.value = 180}}};
    expect_same(shot, volume);
    shot.shape = {.mode = Mode::mip};
    expect_same(shot, volume);
    shot.shape = {.clip = {.box = std::array{0.0, 0.5, 0.1, 1.0, 0.0, 1.0}, .planes = {{{1, 1, 0}, 40}}}};
    expect_same(shot, volume);
}

TEST_F(Gpus, EveryWayOfClassifyingAndCompositing) {
    const Volume volume = shells_of<std::uint8_t>(40);
    for (const auto classification : {Classification::post, Classification::pre, Classification::preintegrated})
        for (const auto compositing : {Compositing::front_to_back, Compositing::back_to_front}) {
            Shot shot = shaded();
            shot.rays.classification = classification;
            shot.rays.compositing = compositing;
            expect_same(shot, volume);
        }
}

TEST_F(Gpus, SeveralRaysAPixelEarlyEndsNoSkippingRaster) {
    const Volume volume = shells_of<std::uint8_t>(40);
    Shot shot = shaded();
    shot.rays = {.step_voxels = 0.7, .samples_per_pixel = 3, .early_termination = 0.01, .skip_empty = false};
    expect_same(shot, volume);
    shot.rays.ray_setup = RaySetup::raster;
    expect_same(shot, volume);
    shot.camera.projection = Projection::orthographic;
    expect_same(shot, volume);
}

// The reads at a sample of fields are gathers around it: those of the last node too.
TEST_F(Gpus, EveryKindOfLight) {
    const Volume volume = shells_of<std::uint8_t>(36);
    const Shot shot = shaded();
    const Frame plain = expect_same(shot, volume);
    for (const Method method : {Method::spao, Method::visibility, Method::transport}) {
        IlluminationSettings light{.method = method};
        light.visibility.directions = 50;
        light.transport.grid = 16;
        for (const auto storage : {ShStorage::u8, ShStorage::f32}) {
            light.visibility.storage = storage;
            EXPECT_GT(difference(expect_same(shot, volume, light), plain, 0.01).pixels_beyond, 50);
        }
        Shot surfaces = shot;  // visibility by the sample's own normal
        surfaces.shape = {.mode = Mode::iso, .iso = {{.value = 90}}};
        expect_same(surfaces, volume, light);
    }
}

TEST_F(Gpus, SweepVisibilityToTheSameCoefficients) {
    IlluminationSettings light{.method = Method::visibility};
    const Medium medium = classify(upload(gpu, shells_of<std::uint8_t>(36)), two_materials(), {});
    for (const int bands : {2, 4})
        for (const int directions : {24, 600}) {  // one batch of each side, and several
            light.visibility.bands = bands, light.visibility.directions = directions;
            expect_same_field(medium, light, fmt::format("{} bands, {} directions", bands, directions));
        }
}

namespace {

struct Transported {
    TransferFunction tf = two_materials();
    Lighting lighting;
    TransportSettings settings{.grid = 30};
    ScatteringSettings scattering;

    /// Some iterations, and some of a solver that starts from that.
    TransportNodes by(const Device& device, const Volume& volume, int iterations) const {
        Progress progress;
        const Medium medium = classify(upload(device, volume), tf, {});
        TransportSolver first = solver(device, medium, nullptr);
        for (int i = 0; i < iterations; ++i) first.iterate(progress);
        const TransportNodes warm = first.nodes();
        TransportSolver second = solver(device, medium, &warm);
        for (int i = 0; i < iterations; ++i) second.iterate(progress);
        return second.nodes();
    }
    TransportSolver solver(const Device& device, const Medium& medium, const TransportNodes* warm) const {
        Progress progress;
        return {device, medium.data(), lighting, settings, scattering, {0, 0, 1}, progress, warm};
    }
};

Probe with_a_dominant_light() {
    std::vector<float> rgb(3 * 64 * 128, 0.1f);
    for (int x = 0; x < 4; ++x)
        rgb[std::size_t(3 * (128 * 20 + x))] = 1000, rgb[std::size_t(3 * (128 * 20 + x) + 2)] = 500;
    return {128, 64, rgb};
}

double difference_of(const std::vector<float>& a, const std::vector<float>& b) {
    EXPECT_EQ(a.size(), b.size());
    double worst = 0;
    for (std::size_t i = 0; i < a.size(); ++i) worst = std::max(worst, std::abs(double(a[i]) - b[i]));
    return worst;
}

void expect_same_transport(const Device& gpu, const Transported& scene, const Volume& volume) {
    const TransportNodes expected = scene.by(cpu(), volume, 3), found = scene.by(gpu, volume, 3);
    EXPECT_LE(difference_of(found.light, expected.light), tolerance);
    EXPECT_LE(difference_of(found.moment, expected.moment), tolerance);
    EXPECT_LE(difference_of(found.result, expected.result), tolerance);
    EXPECT_NEAR(found.change, expected.change, tolerance);
    EXPECT_EQ(found.iterations, expected.iterations);
    EXPECT_GT(expected.change, 0);
    EXPECT_GT(difference_of(expected.light, std::vector<float>(expected.light.size(), 1)), 0.1);
}

}  // namespace

TEST_F(Gpus, TransportToTheSameNodes) {
    const Volume volume = shells_of<std::uint8_t>(30);  // no two of its edges alike
    Transported scene;
    const auto has_opaque_cells = [&] { return !scene.by(gpu, volume, 0).result.empty(); };
    expect_same_transport(gpu, scene, volume);
    scene.tf = walls();
    EXPECT_TRUE(has_opaque_cells());
    expect_same_transport(gpu, scene, volume);
    scene.scattering.bounces.most = 3;
    expect_same_transport(gpu, scene, volume);
    EXPECT_FALSE(has_opaque_cells());
    scene.scattering = {.albedo_max = 0.99, .anisotropy = 0.5};
    scene.tf = constant(0.03, {0.9, 0.5, 0.2});
    expect_same_transport(gpu, scene, volume);
    EXPECT_FALSE(has_opaque_cells());
}

TEST_F(Gpus, TransportOfEveryProbe) {
    const Volume volume = shells_of<std::uint8_t>(16);
    Transported scene{.settings = {.grid = 20}};
    for (const bool is_walled : {false, true})
        for (const Probe& probe : {load_probe("sky"), load_probe("studio"), with_a_dominant_light()}) {
            scene.tf = is_walled ? walls() : two_materials();
            scene.lighting.loaded_probe = probe;
            expect_same_transport(gpu, scene, volume);
        }
}

TEST_F(Gpus, TransportInFewDirectionsAndInMany) {
    const Volume volume = shells_of<std::uint8_t>(24);
    Transported scene{.settings = {.grid = 14, .directions = 4, .first_directions = 3}};  // no light from some sides
    expect_same_transport(gpu, scene, volume);
    scene.tf = walls();
    expect_same_transport(gpu, scene, volume);
    scene.settings.directions = 90, scene.settings.first_directions = 600;  // more than are swept at once
    expect_same_transport(gpu, scene, volume);
}

TEST_F(Gpus, TransportStopsWhenCancelledAndGoesOn) {
    const Volume volume = shells_of<std::uint8_t>(24);
    const Medium medium = classify(upload(gpu, volume), two_materials(), {});
    TransportSolver cancelled = Transported().solver(gpu, medium, nullptr);
    TransportSolver through = Transported().solver(gpu, medium, nullptr);
    Progress progress;
    Progress cancelling([&](std::string_view, double) { cancelling.cancel(); });
    cancelled.iterate(progress), through.iterate(progress);
    EXPECT_THROW(cancelled.iterate(cancelling), Error);
    EXPECT_EQ(cancelled.iterations(), 1);
    cancelled.iterate(progress), through.iterate(progress);
    EXPECT_EQ(cancelled.nodes().light, through.nodes().light);
}

TEST_F(Gpus, LocalHistogramsThatEmission) {
    const Volume volume = shells_of<std::uint8_t>(32);
    IlluminationSettings light{.method = Method::histogram};
    light.histogram.radius = 4, light.histogram.clusters = 64, light.histogram.cache = "none";
    for (const std::string emission : {"", "160:255=20"}) {
        light.histogram.emission = emission;
        light.histogram.effects.emission = !emission.empty();
        Progress progress;
        Frame frames[2] = {Frame(61, 47), Frame(61, 47)};
        for (const bool on_gpu : {false, true}) {
            const Device device = on_gpu ? gpu : cpu();
            const DeviceVolume voxels = upload(device, volume);
            const Medium medium = classify(voxels, two_materials(), {});
            const Prepared prepared = prepare(voxels, light, progress);
            IlluminationField field;
            illuminate(
                device, medium, prepared, {}, light, [&](IlluminationField f) { field = f; }, progress);
            const Camera camera = make_camera({}, volume.geometry, volume.dimensions);
            raycast(device, medium, field, {}, camera, {}, frames[on_gpu], progress);
        }
        EXPECT_EQ(difference(frames[1], frames[0], tolerance).pixels_beyond, 0) << emission;
        EXPECT_GT(mean_alpha(frames[0]), 0.02);
    }
}

TEST_F(Gpus, PathsThroughCloudsAndToSurfaces) {
    const Volume volume = shells_of<std::uint8_t>(32);
    for (const std::string probe : {"white", "studio"})
        for (const Mode mode : {Mode::dvr, Mode::iso}) {
            const Medium medium = classify(upload(gpu, volume), two_materials(), {.mode = mode, .iso = {{90}}});
            Lighting lighting{.probe = {.source = probe}, .loaded_probe = load_probe(probe)};
            IlluminationSettings light{.method = Method::reference};
            light.reference.rays = 3;
            const Camera camera = make_camera({}, volume.geometry, volume.dimensions);
            Progress progress;
            Frame expected(45, 37), frame(45, 37);
            const RenderStatistics counted =
                trace_paths(cpu(), medium, lighting, camera, {}, light, expected, progress);
            const RenderStatistics render_statistics =
                trace_paths(gpu, medium, lighting, camera, {}, light, frame, progress);
            EXPECT_EQ(difference(frame, expected, tolerance).pixels_beyond, 0) << probe;
            EXPECT_NEAR(double(render_statistics.samples), double(counted.samples),
                        tolerance * double(counted.samples));
            EXPECT_NEAR(render_statistics.paths.noise, counted.paths.noise, tolerance);
            EXPECT_GT(mean_alpha(expected), 0.02);
        }
}

TEST_F(Gpus, LightAtPoints) {
    const Volume volume = shells_of<std::uint8_t>(32);
    const Medium medium = classify(upload(gpu, volume), two_materials(), {});
    const std::vector<Vec3> points{{16, 16, 16}, {5, 6, 7}, {-3, 12, 30}};
    IlluminationSettings light{.method = Method::reference};
    light.reference.rays = 2000;
    Progress progress;
    const MeanRadiance expected = trace_mean_radiance(cpu(), medium, {}, {0, 0, 1}, points, light, progress);
    const MeanRadiance found = trace_mean_radiance(gpu, medium, {}, {0, 0, 1}, points, light, progress);
    for (std::size_t i = 0; i < points.size(); ++i)
        for (int c = 0; c < 3; ++c) EXPECT_NEAR(found.mean[i][c], expected.mean[i][c], tolerance);
}

TEST_F(Gpus, CountTheSamplesThatTheCpuCounts) {
    const Volume volume = shells_of<std::uint8_t>(40);
    const Medium medium = classify(upload(gpu, volume), two_materials(), {});
    const Camera camera = make_camera({}, volume.geometry, volume.dimensions);
    Progress progress;
    Frame frame(61, 47);
    const auto samples = [&](const Device& device) {
        return raycast(device, medium, {}, {}, camera, {}, frame, progress).samples;
    };
    const auto expected = samples(cpu());
    EXPECT_GT(expected, 10000u);
    EXPECT_NEAR(double(samples(gpu)), double(expected), tolerance * double(expected));
}

// A session keeps on the GPU what its stages keep on the host: neither an edit nor another camera brings anything but
// the table.
TEST_F(Gpus, AreHandedOnlyWhatChanged) {
    const auto copied = [&] { return gpu.stream->device_cache()->copied_bytes(); };
    const auto of_device_cache = [&](auto&& act) { return act(), copied(); };
    const Volume volume = shells_of<std::uint8_t>(40);
    const DeviceVolume voxels = upload(gpu, volume);
    Progress progress;
    Frame frame(61, 47);
    CameraSettings from;
    const auto show = [&](const Medium& medium) {
        raycast(gpu, medium, {}, {}, make_camera(from, volume.geometry, volume.dimensions), {}, frame, progress);
    };
    const Medium medium = classify(voxels, two_materials(), {});
    const auto first = of_device_cache([&] { show(medium); });
    EXPECT_GT(first, volume.voxels.size());
    from.azimuth_deg = 80;
    EXPECT_EQ(of_device_cache([&] { show(medium); }), first);
    const Medium edited = classify(voxels, constant(0.1), {});
    const auto second = of_device_cache([&] { show(edited); });
    EXPECT_EQ(second, first);  // its cells were found there
    const auto beside = gpu.with_own_stream();
    raycast(beside, medium, {}, {}, make_camera(from, volume.geometry, volume.dimensions), {}, frame, progress);
    EXPECT_EQ(copied(), second);  // another stream shares it
}

TEST_F(Gpus, AreHandedThePreintegratedTableOnce) {
    const Volume volume = shells_of<std::uint8_t>(40);
    const Medium medium = classify(upload(gpu, volume), two_materials(), {});
    Progress progress;
    Frame frame(61, 47);
    CameraSettings from;
    const auto copied_for = [&](double azimuth_deg, double step_voxels) {
        from.azimuth_deg = azimuth_deg;
        const auto before = gpu.stream->device_cache()->copied_bytes();
        raycast(gpu, medium, {}, {}, make_camera(from, volume.geometry, volume.dimensions),
                {.step_voxels = step_voxels, .classification = Classification::preintegrated}, frame, progress);
        return gpu.stream->device_cache()->copied_bytes() - before;
    };
    const std::size_t table = 128 * 128 * 4 * sizeof(float);  // at least
    EXPECT_GT(copied_for(0, 0.5), volume.voxels.size() + table);
    EXPECT_EQ(copied_for(80, 0.5), 0u);
    EXPECT_GT(copied_for(80, 1), table);
    EXPECT_GT(copied_for(80, 0.5), table);  // only the last is kept
}

// Light that was found on the GPU is there for its rays.
TEST_F(Gpus, KeepTheLightThatTheyFound) {
    const auto copied = [&] { return gpu.stream->device_cache()->copied_bytes(); };
    const Volume volume = shells_of<std::uint8_t>(100);
    const Medium medium = classify(upload(gpu, volume), two_materials(), {});
    Progress progress;
    Frame frame(61, 47);
    const auto show = [&](const IlluminationField& field) {
        raycast(gpu, medium, field, {}, make_camera({}, volume.geometry, volume.dimensions), {}, frame, progress);
    };
    show({});
    const auto before = copied();
    IlluminationField field;
    const auto keep = [&](IlluminationField found) { field = found; };
    illuminate(gpu, medium, {}, {}, {.method = Method::spao}, keep, progress);
    EXPECT_EQ(copied(), before);  // cells' opacities were found there
    show(field);
    const auto with_surfaces = copied();
    EXPECT_LT(with_surfaces - before, field.bytes() / 4);  // the tables that tell surfaces
    illuminate(gpu, medium, {}, {}, {.method = Method::spao}, keep, progress);
    show(field);
    EXPECT_EQ(copied(), with_surfaces);
    const Device another = Device::cuda(0, cpu());  // which knows nothing of that
    Frame elsewhere(61, 47);
    raycast(another, medium, field, {}, make_camera({}, volume.geometry, volume.dimensions), {}, elsewhere, progress);
    EXPECT_EQ(elsewhere.rgba, frame.rgba);
    raycast(cpu(), medium, field, {}, make_camera({}, volume.geometry, volume.dimensions), {}, elsewhere, progress);
    EXPECT_EQ(difference(elsewhere, frame, tolerance).pixels_beyond, 0);
}

TEST_F(Gpus, SessionsOfOneVolumeSideBySide) {
    Scene scene;
    scene.width = 61, scene.height = 47, scene.interpolation = Interpolation::linear;
    scene.illumination.method = Method::spao;
    scene.transfer.points = two_materials();
    Progress progress;
    Session expected(cpu()), one(gpu);
    expected.show(shells_of<std::uint8_t>(40), progress);
    one.show(shells_of<std::uint8_t>(40), progress);
    const Image image = expected.render(scene, progress);
    EXPECT_EQ(one.render(scene, progress).pixels, image.pixels);
    EXPECT_EQ(one.render_statistics().samples, expected.render_statistics().samples);
    const auto copied = gpu.stream->device_cache()->copied_bytes();
    Session two = one.share_volume();
    std::thread other([&] {
        for (int turn = 0; turn < 3; ++turn) EXPECT_EQ(two.render(scene, progress).pixels, image.pixels);
    });
    Scene turned = scene;
    for (int turn = 0; turn < 3; ++turn) {
        turned.camera.azimuth_deg = 40 * turn;
        one.render(turned, progress);
    }
    other.join();
    EXPECT_LT(gpu.stream->device_cache()->copied_bytes() - copied,
              copied / 2);  // the voxels are shared, light is each one's own
    EXPECT_EQ(one.preview(scene, progress).pixels, image.pixels);
}

TEST_F(Gpus, LetGoOfWhatIsGone) {
    const auto held = [&] { return gpu.stream->device_cache()->held_bytes(); };
    Shot shot = shaded();
    shot.device = gpu;
    shot(shells_of<std::uint8_t>(40));
    const auto small = held();
    for (int i = 0; i < 3; ++i) shot(shells_of<std::uint8_t>(40));
    EXPECT_EQ(held(), small);
}

TEST_F(Gpus, StopWhenCancelled) {
    const Volume volume = shells_of<std::uint8_t>(40);
    const Medium medium = classify(upload(gpu, volume), two_materials(), {});
    Frame frame(1200, 1000);  // more than are done at once
    Progress progress([&](std::string_view, double) { progress.cancel(); });
    const Camera camera = make_camera({}, volume.geometry, volume.dimensions);
    EXPECT_FALSE(raycast(gpu, medium, {}, {}, camera, {}, frame, progress).complete);
}

TEST_F(Gpus, StopBetweenThePassesOfLight) {
    const Medium medium = classify(upload(gpu, shells_of<std::uint8_t>(40)), two_materials(), {});
    const auto never = [](IlluminationField) { FAIL() << "light without an end"; };
    for (int reports : {1, 3}) {
        Progress progress([&](std::string_view stage, double) {
            if (stage == "spao" && --reports == 0) progress.cancel();
        });
        EXPECT_FALSE(illuminate(gpu, medium, {}, {}, {.method = Method::spao}, never, progress));
        EXPECT_EQ(reports, 0);
    }
}

// Several channels as one medium: the sum of media of one colour, closed forms of several colours, any order.
#include <chiaro/error.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "fixtures.h"
#include "raycast/matter.h"

using namespace chiaro;
using namespace chiaro::testing;

namespace {

constexpr int n = 28;

/// A ball that fades out, in whole numbers, so that sums of two are exact.
double ball(double x, double y, double z, double at_x, double at_z) {
    const double r = std::sqrt(std::pow(x - at_x, 2) + std::pow(y - 13.5, 2) + std::pow(z - at_z, 2)) / 9;
    return r < 1 ? std::round(100 * std::pow(1 - r * r, 2)) : 0;
}
double ball_a(double x, double y, double z) { return ball(x, y, z, 10, 12); }
double ball_b(double x, double y, double z) { return ball(x, y, z, 17, 16); }

/// Extinction per voxel that is proportional to the value.
TransferFunction linear(double extinction_of_one, Rgb rgb, double most = 200) {
    TransferFunction tf;
    tf.rgb_space = RgbSpace::linear;
    for (int i = 0; i <= 200; ++i)
        tf.points.push_back({most * i / 200, rgb, -std::expm1(-extinction_of_one * most * i / 200)});
    return tf;
}

struct Look {
    Method method = Method::none;
    Shape shape;
    RaySettings rays;
    Shading shading = Shading::phong;
    int paths = 64;
    double albedo_max = 0.9;
    int counted = 0;  ///< of histograms
};

Frame picture(const Medium& medium, const DeviceVolume& volume, const Look& look) {
    const Device device = tested_device();
    Progress progress;
    const Camera camera = make_camera(CameraSettings(), volume.geometry(), volume.dimensions());
    Lighting lighting{.shading = look.shading};
    if (look.method != Method::none && look.method != Method::spao) lighting.loaded_probe = load_probe("sky");
    lighting.probe_up = camera.orbit_up;
    IlluminationSettings settings{.method = look.method};
    settings.reference.rays = look.paths;
    settings.scattering.albedo_max = look.albedo_max;
    Frame frame(40, 32);
    if (look.method == Method::reference) {
        trace_paths(device, medium, lighting, camera, look.rays, settings, frame, progress);
        return frame;
    }
    settings.histogram.channel = look.counted, settings.histogram.cache = "none", settings.histogram.clusters = 64;
    const Prepared prepared = prepare(volume, settings, progress);
    IlluminationField field;
    EXPECT_TRUE(illuminate(
        device, medium, prepared, lighting, settings, [&](IlluminationField f) { field = std::move(f); }, progress));
    raycast(device, medium, field, lighting, camera, look.rays, frame, progress);
    return frame;
}

Frame picture(const std::vector<Channel>& channels, const Look& look) {
    return picture(classify(tested_device(), channels, look.shape), channels.front().volume, look);
}

template <class T, class Function>
DeviceVolume uploaded(Function&& f) {
    return upload(tested_device(), sampled<T>({n, n, n}, f));
}

double largest_difference(const Frame& a, const Frame& b) {
    double largest = 0;
    for (std::size_t i = 0; i < a.rgba.size(); ++i)
        largest = std::max(largest, std::abs(double(a.rgba[i]) - double(b.rgba[i])));
    return largest;
}

std::vector<Channel> three_channels() {
    const auto volumes = alike({uploaded<std::uint8_t>(ball_a), uploaded<std::uint16_t>(ball_b),
                                uploaded<std::uint8_t>([](double x, double y, double) { return ball_a(x, y, 18); })});
    return {{volumes[0], linear(0.004, {0.9, 0.2, 0.1})},
            {volumes[1], linear(0.003, {0.1, 0.8, 0.3})},
            {volumes[2], linear(0.006, {0.2, 0.3, 1.0})}};
}

/// Three values a voxel as colours, opacity linear in luminance.
OwnColors in_colors(const std::array<std::function<double(double, double, double)>, 3>& rgb, double extinction_of_one) {
    Volume volume = make_volume({n, n, n}, VoxelType::u8);
    volume.components = 3, volume.has_own_colors = true;
    volume.voxels = VoxelBuffer(3 * volume.voxel_count());
    for (std::size_t i = 0; i < volume.voxel_count(); ++i)
        for (std::size_t c = 0; c < 3; ++c)
            volume.as<std::uint8_t>()[3 * i + c] = std::uint8_t(rgb[c](i % n, i / n % n, i / n / n));
    std::vector<DeviceVolume> on_device;
    for (Volume& one : components_of(volume)) on_device.push_back(upload(tested_device(), std::move(one)));
    return {.opacity = on_device[0],
            .transfer = linear(extinction_of_one, {1, 0, 1}, 255),
            .rgb = {on_device[1], on_device[2], on_device[3]}};
}

double linear_of(double byte) {
    const double c = byte / 255;
    return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
}

/// A function of y between its values at voxels.
template <class Values>
double between(const Values& values, double y) {
    const double below = std::floor(y);
    return std::lerp(values(0, below, 0), values(0, below + 1, 0), y - below);
}

/// A ray along y sees what the test's own march in double precision does; `at`: extinction per voxel, and colour.
template <class At>
void expect_the_march(const Medium& medium, double within, const At& at) {
    Frame frame(1, 1);
    Progress progress;
    raycast(tested_device(), medium, IlluminationField(), {.shading = Shading::none}, along_y(13.5, 13.5),
            {.step_voxels = 0.1, .early_termination = 0}, frame, progress);
    constexpr int steps = 27 * 2000;
    double clear = 1;
    Rgb rgb{};
    for (int i = 0; i < steps; ++i) {
        const auto [kappa, color] = at((i + 0.5) * 27.0 / steps);
        const double alpha = -std::expm1(-kappa * 27.0 / steps);
        for (std::size_t c = 0; c < 3; ++c) rgb[c] += clear * alpha * color[c];
        clear *= 1 - alpha;
    }
    for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(frame.rgba[c], rgb[c], within) << c;
    EXPECT_NEAR(frame.rgba[3], 1 - clear, within);
    EXPECT_GT(1 - clear, 0.5);
}

template <class T>
void expect_the_sum(Method method, Interpolation interpolation = Interpolation::linear) {
    const TransferFunction tf = linear(0.003, {0.8, 0.7, 0.6});
    Look look{.method = method};
    look.shape.interpolation = interpolation;
    const Frame two = picture({{uploaded<T>(ball_a), tf}, {uploaded<T>(ball_b), tf}}, look);
    const Frame one = picture(
        {{uploaded<T>([](double x, double y, double z) { return ball_a(x, y, z) + ball_b(x, y, z); }), tf}}, look);
    EXPECT_GT(*std::max_element(one.rgba.begin(), one.rgba.end()), 0.2f);
    EXPECT_LT(largest_difference(one, two), 1.0 / 255) << int(method) << " " << sizeof(T) << " " << int(interpolation);
}

}  // namespace

TEST(Channels, AreTheSumOfMediaOfOneColour) {
    for (const Method method : {Method::none, Method::spao, Method::visibility, Method::transport})
        expect_the_sum<std::uint8_t>(method);
    expect_the_sum<std::uint16_t>(Method::visibility);
    expect_the_sum<float>(Method::visibility);
    expect_the_sum<float>(Method::transport);
    expect_the_sum<std::uint8_t>(Method::none, Interpolation::cubic);
}

TEST(Channels, AreTheSumForPathsToo) {
    const TransferFunction tf = linear(0.003, {0.8, 0.7, 0.6});
    const Look look{.method = Method::reference, .paths = 256};
    const Frame two = picture({{uploaded<std::uint8_t>(ball_a), tf}, {uploaded<std::uint8_t>(ball_b), tf}}, look);
    const Frame one = picture(
        {{uploaded<std::uint8_t>([](double x, double y, double z) { return ball_a(x, y, z) + ball_b(x, y, z); }), tf}},
        look);
    double bias = 0, squares = 0, light = 0;
    for (std::size_t i = 0; i < one.rgba.size(); ++i) {
        const double off = double(two.rgba[i]) - double(one.rgba[i]);
        bias += off, squares += off * off, light += double(one.rgba[i]);
    }
    const double count = double(one.rgba.size());
    EXPECT_GT(light / count, 0.01);
    // Pixels are independent: three standard errors of the mean of the differences (channels of a pixel are not, so
    // those count four times).
    EXPECT_LT(std::abs(bias) / count, 3 * std::sqrt(4 * squares) / count);
    EXPECT_LT(std::sqrt(squares / count), 0.05);
}

TEST(Channels, AreTheTestsOwnMarchAlongARay) {
    // Boxes that overlap, and slopes, along y.
    const auto box = [](double, double y, double) { return y >= 5 && y <= 15 ? 120.0 : 0.0; };
    const auto hill = [](double, double y, double) { return std::round(100 * std::exp(-std::pow((y - 16) / 5, 2))); };
    const Rgb red{0.9, 0.1, 0.2}, blue{0.1, 0.3, 0.8};
    const double of_box = 0.0009, of_hill = 0.0016;
    const std::vector<Channel> channels{{uploaded<std::uint8_t>(box), linear(of_box, red)},
                                        {uploaded<std::uint8_t>(hill), linear(of_hill, blue), 1.5}};
    expect_the_march(classify(tested_device(), channels, {}), 1e-3, [&](double y) {
        const double a = of_box * between(box, y), b = 1.5 * of_hill * between(hill, y);
        Rgb mean{};
        for (std::size_t c = 0; c < 3 && a + b > 0; ++c) mean[c] = (a * red[c] + b * blue[c]) / (a + b);
        return std::pair(a + b, mean);
    });
}

TEST(Channels, InAnyOrderAndWithHiddenOnesAreTheSameBits) {
    const std::vector<Channel> channels = three_channels();
    const auto expect_same = [&](const Look& look) {
        const Frame first = picture(channels, look);
        std::vector<Channel> turned{channels[2], channels[0], channels[1]};
        EXPECT_EQ(picture(turned, look).rgba, first.rgba);
        turned = {channels[1], channels[2], channels[0]};
        EXPECT_EQ(picture(turned, look).rgba, first.rgba);
        const Frame two = picture({channels[0], channels[1]}, look);
        std::vector<Channel> hidden = channels;
        hidden[2].gain = 0;
        EXPECT_EQ(picture(hidden, look).rgba, two.rgba);
        EXPECT_GT(largest_difference(first, two), 0.02);
        hidden[1].gain = 0;
        EXPECT_EQ(picture(hidden, look).rgba, picture({channels[0]}, look).rgba);
    };
    expect_same({.method = Method::visibility});
    expect_same({.method = Method::transport});
    expect_same({.shape = {.mode = Mode::mip}});
    expect_same({.shape = {.mode = Mode::additive}});
    expect_same({.rays = {.classification = Classification::pre, .compositing = Compositing::back_to_front}});
}

TEST(Channels, OneAloneIsTheVolumeItself) {
    const DeviceVolume volume = uploaded<std::uint8_t>(ball_a);
    const TransferFunction tf = linear(0.01, {0.9, 0.2, 0.1});
    Look look{.method = Method::spao};
    const Frame alone = picture({{volume, tf, 1}, {volume, tf, 0}}, look);
    EXPECT_EQ(picture({{volume, tf}}, look).rgba, alone.rgba);
    look.shape.opacity_scale = 0.5;
    const Frame thinner = picture({{volume, tf}}, look);
    look.shape.opacity_scale = 1;
    EXPECT_EQ(picture({{volume, tf, 0.5}}, look).rgba, thinner.rgba);
}

TEST(Channels, SkipOnlyWhatIsEmptyInAll) {
    Look look{.method = Method::spao};
    const Frame skipping = picture(three_channels(), look);
    look.rays.skip_empty = false;
    EXPECT_EQ(picture(three_channels(), look).rgba, skipping.rgba);
}

TEST(Channels, AddUpInMaximaWithTheirGain) {
    std::vector<Channel> channels = three_channels();
    const Look look{.shape = {.mode = Mode::mip}};
    const Frame both = picture({channels[0], channels[1]}, look), a = picture({channels[0]}, look),
                b = picture({channels[1]}, look);
    channels[1].gain = 2;
    const Frame brighter = picture({channels[0], channels[1]}, look);
    for (std::size_t i = 0; i < both.rgba.size(); ++i) {
        if (i % 4 == 3) continue;
        EXPECT_NEAR(both.rgba[i], a.rgba[i] + b.rgba[i], 1e-6);
        EXPECT_NEAR(brighter.rgba[i], a.rgba[i] + 2 * b.rgba[i], 1e-6);
    }
}

TEST(Channels, AlbedosAreLimitedAfterTheMean) {
    // Half white, half black: .5, which is no more than .6, though white alone is.
    const kernel::StepOfMatter step{1, 0.6f};
    const kernel::Rgba mean = step.of<float>(kernel::Rgba{1, 1, 1, 2}, false);
    EXPECT_NEAR(mean.r / mean.a, 0.5, 1e-6);
    const kernel::Rgba bright = step.of<float>(kernel::Rgba{2, 1, 0, 2}, false);
    EXPECT_NEAR(bright.r / bright.a, 0.6, 1e-6);
    EXPECT_NEAR(bright.g / bright.a, 0.3, 1e-6);
    EXPECT_NEAR(bright.a, -std::expm1(-2), 1e-6);
}

TEST(OwnColors, AreTheTestsOwnMarchAlongARay) {
    const auto red = [](double, double y, double) { return std::round(40 + 7 * y); };
    const auto green = [](double, double y, double) { return y >= 5 && y <= 15 ? 200.0 : 30.0; };
    const auto blue = [](double, double y, double) { return std::round(220 * std::exp(-std::pow((y - 16) / 5, 2))); };
    const auto luminance = [&](double, double y, double) {
        return std::round(0.2126 * red(0, y, 0) + 0.7152 * green(0, y, 0) + 0.0722 * blue(0, y, 0));
    };
    const double of_one = 0.0012;
    expect_the_march(classify(tested_device(), in_colors({red, green, blue}, of_one), {}), 1.0 / 255, [&](double y) {
        const Rgb rgb{linear_of(between(red, y)), linear_of(between(green, y)), linear_of(between(blue, y))};
        return std::pair(of_one * between(luminance, y), rgb);
    });
}

// Opacity by one value, colour by another.
TEST(OwnColors, ByAnotherValueAreTheTestsOwnMarch) {
    const auto hill = [](double, double y, double) { return std::round(150 * std::exp(-std::pow((y - 13) / 6, 2))); };
    const auto rise = [](double, double y, double) { return std::round(9 * y); };
    const double of_one = 0.0016;
    OwnColors own{.opacity = uploaded<std::uint8_t>(hill), .transfer = linear(of_one, {0, 1, 0}), .rgb = {}};
    own.value = uploaded<std::uint8_t>(rise);
    own.colors.rgb_space = RgbSpace::linear, own.colors.points = {{0, {0.9, 0.1, 0}, 1}, {250, {0.1, 0.2, 1}, 1}};
    expect_the_march(classify(tested_device(), own, {}), 2e-3, [&](double y) {
        return std::pair(of_one * between(hill, y), evaluate(own.colors, between(rise, y)).rgb);
    });
    EXPECT_THROW(classify(tested_device(), own, {.mode = Mode::mip}), Error);
}

// Greys are the volume of their value in grey, for every light.
TEST(OwnColors, GreysAreGrey) {
    const auto grey = [](double x, double y, double z) { return 2 * ball_a(x, y, z); };
    const OwnColors own = in_colors({grey, grey, grey}, 0.004);
    TransferFunction tf = linear(0.004, {}, 255);
    tf.rgb_space = RgbSpace::srgb;
    for (ControlPoint& point : tf.points) point.rgb.fill(point.value / 255);
    const auto expect_same = [&](const Look& look, double most) {
        const Frame colors = picture(classify(tested_device(), own, look.shape), own.opacity, look);
        const Frame scalar = picture(classify(tested_device(), own.opacity, tf, look.shape), own.opacity, look);
        EXPECT_GT(*std::max_element(scalar.rgba.begin(), scalar.rgba.end()), 0.1f);
        EXPECT_LT(largest_difference(colors, scalar), most) << int(look.method) << " " << int(look.shape.mode);
    };
    for (const Method method : {Method::none, Method::spao, Method::visibility, Method::transport, Method::histogram})
        expect_same({.method = method}, method == Method::histogram ? 6.0 / 255 : 1.0 / 255);
    expect_same({.shape = {.mode = Mode::additive}}, 1.0 / 255);
    expect_same({.rays = {.classification = Classification::pre}}, 1.0 / 255);
    expect_same({.method = Method::reference, .paths = 256}, 0.1);
}

TEST(OwnColors, OfWholeRaysAreEachTheirOwn) {
    const OwnColors own =
        in_colors({ball_a, ball_b, [](double x, double y, double z) { return 2 * ball_b(x, y, z); }}, 0.01);
    const Frame frame =
        picture(classify(tested_device(), own, {.mode = Mode::mip}), own.opacity, {.shape = {.mode = Mode::mip}});
    float most[3]{};
    for (std::size_t i = 0; i < frame.rgba.size(); ++i)
        if (i % 4 < 3) most[i % 4] = std::max(most[i % 4], frame.rgba[i]);
    EXPECT_NEAR(most[0], linear_of(100), 0.01);
    EXPECT_NEAR(most[1], linear_of(100), 0.01);
    EXPECT_NEAR(most[2], linear_of(196), 0.02);
}

TEST(OwnColors, WhatOpacityIsBy) {
    Volume volume = make_volume({2, 1, 1}, VoxelType::u8);
    volume.components = 4, volume.has_own_colors = true;
    volume.voxels = VoxelBuffer(8);
    const auto set = [&](std::array<int, 8> v) {
        return std::copy(v.begin(), v.end(), volume.as<std::uint8_t>().begin()), components_of(volume);
    };
    auto parts = set({255, 0, 0, 10, 7, 7, 7, 200});
    ASSERT_EQ(parts.size(), 4u);
    EXPECT_EQ(parts[0].component_infos[0].name, "alpha");
    EXPECT_EQ(parts[0].as<std::uint8_t>()[1], 200);
    EXPECT_EQ(parts[1].as<std::uint8_t>()[0], 255);
    parts = set({255, 0, 0, 255, 7, 7, 7, 255});  // says nothing
    EXPECT_EQ(parts[0].component_infos[0].name, "luminance");
    EXPECT_EQ(parts[0].as<std::uint8_t>()[0], 54);
    volume.components = 2;
    EXPECT_THROW(components_of(volume), Error);
}

TEST(OwnColors, WhatIsOfOneValueIsRefused) {
    const OwnColors own = in_colors({ball_a, ball_b, ball_a}, 0.01);
    EXPECT_THROW(classify(tested_device(), own, {.mode = Mode::iso, .iso = {{.value = 50}}}), Error);
    EXPECT_THROW(classify(tested_device(), own, {.clip = {.largest = true}}), Error);
}

// Light by the channel that is counted: of two of which one is empty, that of the other alone.
TEST(Channels, AreLitByTheHistogramsOfOne) {
    const DeviceVolume volume = uploaded<std::uint8_t>(ball_a),
                       empty = uploaded<std::uint8_t>([](double, double, double) { return 0.0; });
    const TransferFunction tf = linear(0.01, {0.9, 0.6, 0.3});
    const Look look{.method = Method::histogram, .counted = 1};
    const Frame one = picture({{volume, tf}}, look), two = picture({{volume, tf}, {empty, tf}}, look);
    EXPECT_GT(*std::max_element(one.rgba.begin(), one.rgba.end()), 0.2f);
    EXPECT_LT(largest_difference(one, two), 6.0 / 255);
    // Of an empty one all is open.
    EXPECT_GT(largest_difference(two, picture({{empty, tf}, {volume, tf}}, look)), 0.02);
}

TEST(Channels, WhatIsOfOneValueIsRefused) {
    const auto refused = [&](const Look& look, const std::string& part) {
        try {
            picture(three_channels(), look);
            ADD_FAILURE() << part;
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), ErrorCode::usage);
            EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << error.what();
        }
    };
    refused({.rays = {.classification = Classification::preintegrated}}, "post and pre");
    refused({.method = Method::histogram}, "--hist-channel");
    refused({.shape = {.mode = Mode::iso, .iso = {{.value = 50}}}}, "one channel");
    refused({.shape = {.clip = {.largest = true}}}, "one channel");
}

// The same voxels at the same place of a body, told in LPS and in RAS.
TEST(Channels, FramesOfOneBodyAreBroughtTogether) {
    Volume lps = make_volume({4, 3, 2}, VoxelType::u8);
    lps.geometry.world = World::lps, lps.geometry.origin_mm = {5, 7, 11};
    const auto voxels = lps.as<std::uint8_t>();
    for (std::size_t i = 0; i < voxels.size(); ++i) voxels[i] = std::uint8_t(i);
    Volume ras = make_volume(lps.dimensions, VoxelType::u8);
    ras.geometry = lps.geometry.in_frame(World::ras);
    EXPECT_EQ(ras.geometry.origin_mm, (Vec3{-5, -7, 11}));
    EXPECT_TRUE(has_grid_of(ras, lps));
    ras.geometry.world = World::lps;
    EXPECT_FALSE(has_grid_of(ras, lps));
    ras.geometry.world = World::ras;
    std::copy(voxels.begin(), voxels.end(), ras.as<std::uint8_t>().begin());
    const Volume onto = resampled(ras, lps);
    EXPECT_EQ(onto.geometry, lps.geometry);
    const auto found = onto.as<std::uint8_t>();
    EXPECT_TRUE(std::equal(voxels.begin(), voxels.end(), found.begin()));
}

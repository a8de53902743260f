// What a value looks like: evaluation, JSON, presets and guesses.
#include <chiaro/error.h>
#include <chiaro/samples.h>
#include <chiaro/transfer_function.h>
#include <gtest/gtest.h>
#include <unistd.h>
#include <random>

#include <cmath>
#include <fstream>
#include <limits>

using namespace chiaro;

namespace {

TransferFunction ramp() {
    TransferFunction tf;
    tf.points = {{0, {0, 0, 0}, 0}, {10, {1, 0.5, 0}, 0.5}, {10, {0, 0, 1}, 1}, {20, {0, 0, 1}, 0}};
    return tf;
}

template <class Attempt>
std::string sentence(const Attempt& attempt, ErrorCode code = ErrorCode::input) {
    try {
        attempt();
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), code);
        return error.what();
    }
    ADD_FAILURE() << "no error";
    return "";
}

std::string refusal(const std::string& json) {
    return sentence([&] { parse_transfer_function(json, "tf.json"); });
}

Statistics statistics(double min, double p1, double p50, double p99, double p999, double max) {
    Statistics data;
    data.min = min, data.p1 = p1, data.p50 = p50, data.p99 = p99, data.p999 = p999, data.max = max;
    return data;
}

const Statistics bytes = statistics(0, 2, 10, 180, 202, 255);

}  // namespace

TEST(TransferFunction, InterpolatesAndStaysConstantOutside) {
    const TransferFunction tf = ramp();
    EXPECT_EQ(evaluate(tf, -5).opacity, 0);
    EXPECT_DOUBLE_EQ(evaluate(tf, 4).opacity, 0.2);
    EXPECT_DOUBLE_EQ(evaluate(tf, 4).rgb[1], 0.2);
    EXPECT_NEAR(evaluate(tf, std::nextafter(10, 0)).opacity, 0.5, 1e-12);  // a step: left of it ...
    EXPECT_EQ(evaluate(tf, 10).opacity, 1);                                // ... and from it on
    EXPECT_DOUBLE_EQ(evaluate(tf, 15).opacity, 0.5);
    EXPECT_EQ(evaluate(tf, 1e30).rgb, (Rgb{0, 0, 1}));
    EXPECT_EQ(evaluate(tf, 7).value, 7);
}

TEST(TransferFunction, ValidateNamesWhatIsWrong) {
    EXPECT_NO_THROW(validate(ramp()));
    const auto broken = [](auto change) {
        TransferFunction tf = ramp();
        tf.name = "x";
        change(tf);
        return sentence([&] { validate(tf); });
    };
    EXPECT_EQ(broken([](auto& tf) { tf.points.clear(); }),
              "transfer function 'x': has no points: must have at least one");
    EXPECT_EQ(broken([](auto& tf) { tf.points[1].opacity = 1.5; }),
              "transfer function 'x': points[1].opacity is 1.5: must be in [0, 1]");
    EXPECT_EQ(broken([](auto& tf) { tf.points[0].rgb[2] = -0.1; }),
              "transfer function 'x': points[0].rgb is -0.1: must be in [0, 1]");
    EXPECT_EQ(broken([](auto& tf) { tf.points[2].opacity = std::nan(""); }),
              "transfer function 'x': points[2].opacity is nan: must be in [0, 1]");
    EXPECT_EQ(broken([](auto& tf) { tf.points[3].value = 9; }),
              "transfer function 'x': points[3].value is 9: must not fall below the 10 before it");
    EXPECT_EQ(broken([](auto& tf) { tf.points[3].value = HUGE_VAL; }),
              "transfer function 'x': points[3].value is inf: must be finite");
    EXPECT_EQ(broken([](auto& tf) { tf.opacity_unit = 0; }),
              "transfer function 'x': opacity unit is 0: must be greater than 0");
}

TEST(TransferFunction, WindowMovesAndStretches) {
    const TransferFunction tf = with_window(ramp(), 40, 400);
    EXPECT_DOUBLE_EQ(tf.points.front().value, -160);
    EXPECT_DOUBLE_EQ(tf.points[1].value, 40);
    EXPECT_DOUBLE_EQ(tf.points.back().value, 240);
    EXPECT_EQ(tf.points[1].rgb, ramp().points[1].rgb);
    TransferFunction single;
    single.points = {{5, {1, 1, 1}, 1}};
    EXPECT_EQ(with_window(single, 7, 2).points[0].value, 7);
    EXPECT_EQ(sentence([] { with_window(ramp(), 0, -3); }, ErrorCode::usage),
              "window width -3: must be greater than 0");
    EXPECT_THROW(with_window(ramp(), std::nan(""), 1), Error);
}

TEST(TransferFunctionJson, RoundTrips) {
    TransferFunction tf = ramp();
    EXPECT_EQ(parse_transfer_function(to_json(tf), ""), tf);
    tf.name = "Knochen \"hell\" ü";
    tf.rgb_space = RgbSpace::linear;
    tf.opacity_unit = 0.1;
    tf.opacity_unit_is_mm = true;
    tf.points[0].value = -1024.1;
    tf.points[0].rgb = {1.0 / 3, 0.1, 2.0 / 3};
    tf.points[0].name = "Blätter";
    EXPECT_EQ(parse_transfer_function(to_json(tf), ""), tf);
}

TEST(TransferFunctionJson, ReadsASceneObject) {
    const TransferFunction tf = parse_transfer_function(
        R"({"opacity_unit_distance": 2, "points": [{"value": 25, "rgb": [0.2, 0.8, 0.3], "opacity": 0.04}]})", "scene");
    EXPECT_EQ(tf.opacity_unit, 2);
    EXPECT_FALSE(tf.opacity_unit_is_mm);
    EXPECT_EQ(tf.points[0], (ControlPoint{25, {0.2, 0.8, 0.3}, 0.04}));
    const TransferFunction plain =
        parse_transfer_function(R"({"points": [{"value": 0, "rgb": [0, 0, 0], "opacity": 0}]})", "");
    EXPECT_EQ(plain.opacity_unit, 1);
    EXPECT_FALSE(plain.opacity_unit_is_mm);
}

TEST(TransferFunctionJson, RefusesWithOneSentence) {
    const std::string point = R"({"value": 0, "rgb": [0, 0, 0], "opacity": 0})";
    EXPECT_EQ(refusal("[]"), "tf.json: is array: must be an object");
    EXPECT_EQ(refusal("{}"), "tf.json: lacks 'points'");
    EXPECT_EQ(refusal(R"({"points": {}})"), "tf.json: points is object: must be an array");
    EXPECT_EQ(refusal(R"({"points": []})"), "tf.json: points has 0 entries: must have 1..65536");
    EXPECT_EQ(refusal(R"({"points": [], "pionts": 1})"), "tf.json: unknown key 'pionts'; did you mean 'points'?");
    EXPECT_EQ(refusal(R"({"points": [7]})"), "tf.json: points[0] is number: must be an object");
    EXPECT_EQ(refusal(R"({"points": [{"value": 0, "rgb": [0, 0, 0]}]})"), "tf.json: points[0] lacks 'opacity'");
    EXPECT_EQ(refusal(R"({"points": [{"value": "0", "rgb": [0, 0, 0], "opacity": 0}]})"),
              "tf.json: points[0].value is string: must be a number");
    EXPECT_EQ(refusal(R"({"points": [{"value": 0, "rgb": [0, 0], "opacity": 0}]})"),
              "tf.json: points[0].rgb has 2 numbers: must have 3");
    EXPECT_EQ(refusal(R"({"points": [{"value": 0, "rgb": [0, 0, null], "opacity": 0}]})"),
              "tf.json: points[0].rgb[2] is null: must be a number");
    EXPECT_EQ(refusal(R"({"points": [{"value": 0, "rgb": [0, 0, 0], "opacity": 0, "alpha": 1}]})"),
              "tf.json: points[0] has unknown key 'alpha'");
    EXPECT_EQ(refusal(R"({"points": [{"value": 0, "rgb": [0, 0, 2], "opacity": 0}]})"),
              "tf.json: transfer function: points[0].rgb is 2: must be in [0, 1]");
    EXPECT_EQ(refusal(R"({"opacity_unit_mm": 1, "opacity_unit_distance": 1, "points": [)" + point + "]}"),
              "tf.json: has both 'opacity_unit_distance' and 'opacity_unit_mm': must be one of the two");
    EXPECT_EQ(refusal(R"({"opacity_unit_mm": -1, "points": [)" + point + "]}"),
              "tf.json: opacity_unit_mm is -1: must be greater than 0");
    EXPECT_EQ(refusal(R"({"rgb_space": "hsv", "points": [)" + point + "]}"),
              "tf.json: rgb_space is 'hsv': must be 'srgb' or 'linear'");
    const std::string nest = std::string(200000, '[') + std::string(200000, ']');  // nothing may recurse into it
    EXPECT_EQ(refusal(R"({"points": [{"value": 0, "opacity": 0, "rgb": )" + nest + "}]}"),
              "tf.json: points[0].rgb has 1 numbers: must have 3");
    const std::string deep(1000000, '[');
    for (const char* garbage :
         {"", "{", "nonsense", "{\"points\": [1e999]}", "\xff\xfe", "{\"points\": [{]}", deep.c_str()})
        EXPECT_TRUE(refusal(garbage).starts_with("tf.json: is not JSON: ")) << std::string(garbage, 0, 20);
}

TEST(TransferFunctionJson, LoadsFilesAndPresets) {
    const auto path = std::filesystem::temp_directory_path() / ("chiaro-tf-" + std::to_string(getpid()) + ".json");
    const auto load = [&](const std::string& text) {
        std::ofstream(path) << text;
        return load_transfer_function(path.string(), bytes);
    };
    EXPECT_EQ(load(to_json(ramp())), ramp());
    EXPECT_EQ(load(R"({"preset": "viridis"})"), preset("viridis", bytes));
    EXPECT_EQ(load_transfer_function("ct-bone", bytes), preset("ct-bone", bytes));
    EXPECT_NE(sentence([&] { load(R"({"preset": "viridis", "points": []})"); }).find("unknown key 'points'"),
              std::string::npos);
    EXPECT_NE(sentence([&] { load("{"); }).find(path.string()), std::string::npos);
    std::filesystem::remove(path);
    EXPECT_EQ(sentence([&] { load_transfer_function("no/such.json", bytes); }),
              "cannot read 'no/such.json': no such file");
    EXPECT_EQ(sentence([&] { load_transfer_function("/tmp", bytes); }), "cannot read '/tmp': Is a directory");
}

TEST(Presets, AreValidAndNamed) {
    for (const PresetInfo& info : list_presets()) {
        const TransferFunction tf = preset(info.name, bytes);
        EXPECT_NO_THROW(validate(tf)) << info.name;
        EXPECT_EQ(tf.name, info.name);
        EXPECT_FALSE(info.sentence.empty());
        double highest = 0;
        for (const ControlPoint& point : tf.points) highest = std::max(highest, point.opacity);
        EXPECT_GT(highest, 0) << info.name;
        EXPECT_EQ(evaluate(tf, info.stretched ? bytes.min : -1024).opacity, 0)
            << info.name << ": background or air is seen";
    }
    EXPECT_EQ(sentence([] { preset("ct-bnoe", bytes); }, ErrorCode::usage),
              "unknown transfer function 'ct-bnoe'; did you mean 'ct-bone'?");
    EXPECT_THROW(preset("", bytes), Error);
    EXPECT_EQ(preset("sample:cornell", bytes), sample_transfer_function("cornell"));
}

TEST(Presets, OnlyThoseOfCtKeepTheirValues) {
    const Statistics other = statistics(-1000, -900, 0, 3000, 4000, 9000);
    for (const PresetInfo& info : list_presets()) {
        const TransferFunction a = preset(info.name, bytes), b = preset(info.name, other);
        EXPECT_EQ(info.stretched, info.modality != "CT" || info.name == "ct-8bit") << info.name;
        if (!info.stretched) {
            EXPECT_EQ(a, b);
            EXPECT_TRUE(a.opacity_unit_is_mm) << "HU belong to matter of any spacing";
            Statistics moved = bytes;
            moved.hu_zero = 1024;
            const TransferFunction c = preset(info.name, moved);
            for (std::size_t i = 0; i < a.points.size(); ++i)
                EXPECT_EQ(c.points[i].value, a.points[i].value + 1024) << info.name;
            continue;
        }
        // The same place between the ends: the 1st and 99.9th percentile, for colour maps the smallest and largest
        // value.
        const bool map = info.modality.empty();
        const double low = map ? 0 : 2, high = map ? 255 : 202, other_low = map ? -1000 : -900,
                     other_high = map ? 9000 : 4000;
        for (std::size_t i = 0; i < a.points.size(); ++i)
            EXPECT_NEAR((a.points[i].value - low) / (high - low),
                        (b.points[i].value - other_low) / (other_high - other_low), 1e-9);
    }
}

TEST(Presets, SurviveDataOfOneValue) {
    for (const PresetInfo& info : list_presets()) {
        EXPECT_NO_THROW(validate(preset(info.name, statistics(7, 7, 7, 7, 7, 7)))) << info.name;
        const TransferFunction sparse = preset(info.name, statistics(0, 0, 0, 0, 0, 255));
        if (info.stretched) {
            EXPECT_GT(evaluate(sparse, 255).opacity, evaluate(sparse, 1).opacity) << info.name;
        }
    }
}

namespace {

struct Case {
    const char* what;
    VoxelType type;
    World world;
    const char* modality;
    Statistics data;
    const char* wanted_modality;
    const char* wanted_preset;
};

/// Type, frame and statistics of public volumes that most renderers are tried on.
const Case cases[] = {
    {"engine", VoxelType::u8, World::unknown, "", statistics(0, 0, 2, 187, 255, 255), "micro-CT", "micro-ct"},
    {"bonsai", VoxelType::u8, World::unknown, "", statistics(0, 0, 0, 204, 222, 255), "micro-CT", "micro-ct"},
    {"aneurism", VoxelType::u8, World::unknown, "", statistics(0, 0, 0, 1, 255, 255), "angiography", "mr-angio"},
    {"head, 8 bit", VoxelType::u8, World::ras, "", statistics(0, 0, 0, 0.694, 0.796, 1), "CT", "ct-8bit"},
    {"carp", VoxelType::u8, World::ras, "", statistics(0, 0, 0, 103, 156, 254), "CT", "ct-8bit"},
    {"chest, 8 bit", VoxelType::u8, World::lps, "", statistics(0, 0, 0, 132, 255, 255), "CT", "ct-8bit"},
    {"cadaver head", VoxelType::u16, World::unknown, "", statistics(0, 0, 52, 2294, 2715, 3272), "CT", "micro-ct"},
    {"head, 12 bit", VoxelType::u16, World::unknown, "", statistics(24, 24, 24, 2124, 2532, 4095), "CT", "micro-ct"},
    {"head, HU", VoxelType::u16, World::unknown, "", statistics(-1000, -1000, -1000, 1100, 1508, 3071), "CT",
     "ct-bone"},
    {"CT as float", VoxelType::f32, World::lps, "", statistics(-1024, -1000, -200, 900, 1500, 3000), "CT", "ct-bone"},
    {"CT with padding", VoxelType::i16, World::lps, "CT", statistics(-2000, -2000, -900, 900, 1500, 2500), "CT",
     "ct-bone"},
    {"CT without rescale", VoxelType::u16, World::lps, "CT", statistics(0, 0, 100, 1900, 2500, 2800), "CT", "micro-ct"},
    {"tooth", VoxelType::u16, World::unknown, "", statistics(0, 360, 405, 1218, 1253, 1300), "micro-CT", "micro-ct"},
    {"brain", VoxelType::u8, World::ras, "", statistics(0, 0, 0, 117, 120, 130), "MR", "mr-brain"},
    {"fetal brain", VoxelType::f32, World::lps, "", statistics(0, 0, 36.74, 545.6, 640.6, 710.7), "MR", "mr-brain"},
    {"T1 series", VoxelType::i16, World::lps, "MR", statistics(0, 0, 0, 76, 84, 278), "MR", "mr-brain"},
    {"smoke", VoxelType::f32, World::unknown, "", statistics(0, 0, 0, 0.843, 1, 1), "simulation", "simulation"},
};

}  // namespace

TEST(Guess, KnowsTheUsualVolumes) {
    for (const Case& c : cases) {
        Volume volume = make_volume({1, 1, 1}, c.type);
        volume.geometry.world = c.world;
        volume.modality = c.modality;
        const Guess guessed = guess(volume, c.data);
        EXPECT_EQ(guessed.modality, c.wanted_modality) << c.what;
        EXPECT_EQ(guessed.preset, c.wanted_preset) << c.what;
        EXPECT_FALSE(guessed.reason.empty());
        EXPECT_EQ(guessed.reason.find("rescale") != std::string::npos,
                  guessed.modality == "CT" && guessed.preset == "micro-ct")
            << c.what;
        EXPECT_NO_THROW(preset(guessed.preset, c.data));
    }
}

TEST(Guess, FindsTheLookOfASampleAgain) {
    const Volume volume = make_sample("tubes", 16);
    EXPECT_EQ(guess(volume, bytes).preset, "sample:tubes");
    EXPECT_EQ(preset("sample:tubes", bytes), sample_transfer_function("tubes"));
}

namespace {

/// Whole numbers that are normally distributed about some values, in the given shares.
struct Peak {
    double value, spread, share;
};
Volume with_peaks(VoxelType type, std::initializer_list<Peak> peaks, double least, double most) {
    constexpr int n = 40;
    Volume volume = make_volume({n, n, n}, type);
    std::mt19937 random(1);
    std::uniform_real_distribution<double> share(0, 1);
    with_voxel_type(type, [&](auto zero) {
        using T = decltype(zero);
        auto voxels = volume.as<T>();
        for (auto& voxel : voxels) {
            double left = share(random);
            const Peak* peak = peaks.begin();
            while (peak + 1 != peaks.end() && left > peak->share) left -= peak++->share;
            const double value = std::normal_distribution<double>(peak->value, peak->spread)(random);
            voxel = T(std::lround(std::clamp(value, least, most)));
        }
        voxels[0] = T(most);
    });
    return volume;
}

Guess guess_of(const Volume& volume) { return guess(volume, measure(volume)); }

}  // namespace

TEST(Guess, OneValueAloneIsNoAngiography) {
    EXPECT_EQ(guess_of(with_peaks(VoxelType::u8, {{77, 0, 1}}, 77, 77)).reason, "all values are the same");
}

TEST(Guess, ACtWithoutItsUnitIsKnownByItsAir) {
    const auto zero_of = [](std::initializer_list<Peak> peaks) {
        return measure(with_peaks(VoxelType::u16, peaks, 0, 3500)).hu_zero;
    };
    EXPECT_EQ(zero_of({{24, 12, 0.5}, {930, 20, 0.1}, {1064, 20, 0.3}, {1500, 300, 0.1}}), 1024);
    EXPECT_EQ(zero_of({{0, 12, 0.5}, {905, 20, 0.1}, {1040, 20, 0.3}, {1500, 300, 0.1}}), 1000);
    EXPECT_EQ(zero_of({{0, 0, 0.5}, {24, 4, 0.1}, {1064, 20, 0.3}, {1500, 300, 0.1}}), 1024) << "padded by 0";
    EXPECT_EQ(zero_of({{24, 12, 0.5}, {600, 50, 0.5}}), 0) << "no tissue";
    EXPECT_EQ(zero_of({{400, 30, 0.8}, {1100, 40, 0.2}}), 0) << "no air";
    const Volume ct = with_peaks(VoxelType::u16, {{24, 12, 0.5}, {1064, 20, 0.4}, {1500, 300, 0.1}}, 0, 3500);
    EXPECT_EQ(guess_of(ct).preset, "ct-bone");
    EXPECT_NE(guess_of(ct).reason.find("HU + 1024"), std::string::npos) << guess_of(ct).reason;
    // Its looks are moved, by whatever name they are asked for.
    EXPECT_EQ(evaluate(preset("ct-bones", measure(ct)), 1024 + 700).opacity,
              evaluate(preset("ct-bone", bytes), 700).opacity);
    Volume scaled = with_peaks(VoxelType::u16, {{24, 12, 0.5}, {1064, 20, 0.4}, {1500, 300, 0.1}}, 0, 3500);
    scaled.intercept = -1024;
    EXPECT_EQ(measure(scaled).hu_zero, 0) << "in HU already";
    EXPECT_EQ(guess_of(scaled).preset, "ct-bone");
}

TEST(Guess, LooksAtValuesNamesAndFormats) {
    Volume density = make_volume({50, 50, 50}, VoxelType::u8);
    std::mt19937 random(2);
    for (auto& voxel : density.as<std::uint8_t>())
        voxel = std::uint8_t(std::min(255.0, std::exponential_distribution<double>(1 / 20.0)(random)));
    EXPECT_EQ(guess_of(density).preset, "simulation");
    density.format = "TIFF";
    EXPECT_EQ(guess_of(density).preset, "fluorescence");
    const Volume solid = with_peaks(VoxelType::u8, {{3, 2, 0.7}, {140, 10, 0.3}}, 0, 255);
    EXPECT_EQ(guess_of(solid).preset, "micro-ct");
    const Volume vessels = with_peaks(VoxelType::u8, {{0, 0, 0.993}, {250, 3, 0.007}}, 0, 255);
    EXPECT_EQ(guess_of(vessels).preset, "mr-angio");
    Volume named = make_volume({8, 8, 8}, VoxelType::f32);
    for (std::size_t i = 0; i < 512; ++i) named.as<float>()[i] = float(i % 97);
    named.geometry.world = World::lps;
    const auto called = [&](const char* name) { return named.source = name, guess_of(named).preset; };
    EXPECT_EQ(called("scans/subject_T2.nii"), "mr-t2-brain");
    EXPECT_EQ(called("fdg-PET.nrrd"), "pet");
    EXPECT_EQ(called("carpet.nrrd"), "mr-brain") << "a word, not a part of one";
    for (const auto& [modality, look] :
         {std::pair("PT", "pet"), std::pair("US", "us-fetal"), std::pair("XA", "mr-angio")}) {
        named.modality = modality;
        EXPECT_EQ(guess_of(named).preset, look);
    }
}

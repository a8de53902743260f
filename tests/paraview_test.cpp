// ParaView's colour maps. Every file here was written for these tests.
#include <random>

#include "io/transfer/color_space.h"
#include "transfer_texts.h"

using namespace chiaro;
using namespace chiaro::testing;

TEST(ParaView, ReadsColoursAndOpacitiesAsOneList) {
    const TransferFile file = parsed(R"([ { "Name": "two",
        "ColorSpace": "RGB", "NanColor": [1, 1, 0],
        "RGBPoints": [10, 0, 0, 0,   30, 1, 0.5, 0,],
        "Points": [10, 0, 0.5, 0,  20, 0.5, 0.5, 0,  30, 0.5, 0.5, 0,  30, 1, 0.5, 0, ], }, ])",
                                     "x.json");
    EXPECT_EQ(file.format, "ParaView");
    EXPECT_FALSE(file.stretched);
    EXPECT_EQ(file.function.name, "two");
    const std::vector<ControlPoint> wanted{
        {10, {0, 0, 0}, 0}, {20, {0.5, 0.25, 0}, 0.5}, {30, {1, 0.5, 0}, 0.5}, {30, {1, 0.5, 0}, 1}};
    EXPECT_EQ(file.function.points, wanted);
    EXPECT_EQ(file.function.opacity_unit, 1);
    EXPECT_FALSE(file.function.opacity_unit_is_mm);
    EXPECT_EQ(notes(file), "its colour for values that are no numbers is not kept\n");
}

TEST(ParaView, StretchesMapsForAnyData) {
    const TransferFile file = parsed(paraview("RGB", "-1, 0, 0, 1,  0, 1, 1, 1,  1, 1, 0, 0"), "x.json");
    EXPECT_TRUE(file.stretched);
    const std::vector<ControlPoint> wanted{
        {0, {0, 0, 1}, 0}, {20, {0.2, 0.2, 1}, 0}, {100, {1, 1, 1}, 0.25 * 4 / 9}, {200, {1, 0, 0}, 0.25}};
    ASSERT_EQ(file.function.points.size(), wanted.size());
    for (std::size_t i = 0; i < wanted.size(); ++i) {
        EXPECT_NEAR(file.function.points[i].value, wanted[i].value, 1e-12);
        EXPECT_NEAR(file.function.points[i].opacity, wanted[i].opacity, 1e-12);
        for (int c = 0; c < 3; ++c) EXPECT_NEAR(file.function.points[i].rgb[c], wanted[i].rgb[c], 1e-12);
    }
    EXPECT_NE(notes(file).find("stretched"), std::string::npos);
    EXPECT_NE(notes(file).find("no opacity"), std::string::npos);
}

TEST(ParaView, BendsOpacityAsVtk) {
    const auto opacities = [](const std::string& points) {
        const TransferFile file =
            parsed(paraview("RGB", "0, 0, 0, 0, 100, 0, 0, 0", ", \"Points\": [" + points + "]"), "x.json");
        std::vector<std::pair<double, double>> list;
        for (const auto& p : file.function.points) list.emplace_back(p.value, p.opacity);
        return list;
    };
    using List = std::vector<std::pair<double, double>>;
    EXPECT_EQ(opacities("0, 0, 0.25, 0, 100, 1, 0.5, 0"), (List{{0, 0}, {25, 0.5}, {100, 1}}));
    EXPECT_EQ(opacities("0, 0, 0.75, 1, 100, 1, 0.5, 0"), (List{{0, 0}, {75, 0}, {75, 1}, {100, 1}}));
    const List curved = opacities("0, 0, 0.5, 0.5, 100, 1, 0.5, 0");
    EXPECT_GT(curved.size(), 5u);
    const auto at = [&](double x) {
        for (std::size_t i = 1; i < curved.size(); ++i)
            if (x <= curved[i].first)
                return std::lerp(curved[i - 1].second, curved[i].second,
                                 (x - curved[i - 1].first) / (curved[i].first - curved[i - 1].first));
        return 1.0;
    };
    for (double u = 0.01; u < 1; u += 0.01) {  // from the published description: power, then Hermite
        const double s = u < 0.5 ? 0.5 * std::pow(2 * u, 6) : 1 - 0.5 * std::pow(2 - 2 * u, 6);
        const double y = (-2 * s * s * s + 3 * s * s) + 0.5 * (2 * s * s * s - 3 * s * s + s);
        EXPECT_NEAR(at(100 * u), y, transfer_sampling_error) << u;
    }
    EXPECT_NEAR(at(50), 0.5, transfer_sampling_error);
}

TEST(ParaView, MixesInItsColourSpaces) {
    const auto middle = [](const std::string& space, const std::string& colors, const std::string& more = "") {
        return evaluate(parsed(paraview(space, colors, more), "x.json").function, 50).rgb;
    };
    const auto near = [](const Rgb& is, const Rgb& wanted, double tolerance) {
        for (int c = 0; c < 3; ++c) EXPECT_NEAR(is[c], wanted[c], tolerance);
    };
    const std::string red_green = "0, 1, 0, 0, 100, 0, 1, 0", red_blue = "0, 1, 0, 0, 100, 0, 0, 1";
    near(middle("RGB", red_green), {0.5, 0.5, 0}, 1e-12);
    near(middle("HSV", red_green), {1, 1, 0}, 0.001);
    near(middle("HSV", red_blue), {0, 1, 0}, 0.001);
    near(middle("HSV", red_blue, R"(, "HSVWrap": 1)"), {1, 0, 1}, 0.001);
    near(middle("Wrapped", red_blue), {1, 0, 1}, 0.001);
    // L* = 50: Y = (66/116)^3 = 0.18419, sRGB 0.46633
    near(middle("Lab", "0, 0, 0, 0, 100, 1, 1, 1"), {0.46633, 0.46633, 0.46633}, 0.001);
    near(middle("CIELAB", "0, 0, 0, 0, 100, 1, 1, 1"), {0.46633, 0.46633, 0.46633}, 0.001);
}

TEST(ParaView, DivergesAsMorelandsTable) {
    const TransferFunction tf =
        parsed(paraview("Diverging", "0, 0.231373, 0.298039, 0.752941, 100, 0.705882, 0.0156863, 0.14902"), "x.json")
            .function;
    const std::pair<double, Rgb> table[] = {// of the paper, in 255ths
                                            {0, {59, 76, 192}},      {12.5, {98, 130, 234}}, {25, {141, 176, 254}},
                                            {37.5, {184, 208, 249}}, {50, {221, 221, 221}},  {75, {244, 154, 123}},
                                            {100, {180, 4, 38}}};
    for (const auto& [value, rgb] : table)
        for (int c = 0; c < 3; ++c) EXPECT_NEAR(evaluate(tf, value).rgb[c] * 255, rgb[c], 1.5) << value << " " << c;
}

TEST(ParaView, SamplesCurvedSpacesWithinTheBound) {
    std::mt19937 random(7);
    const auto component = [&] { return std::round(std::uniform_real_distribution<>(0, 1)(random) * 1e4) / 1e4; };
    const std::pair<const char*, ColorSpace> spaces[] = {{"HSV", ColorSpace::hsv},
                                                         {"Wrapped", ColorSpace::hsv_wrapped},
                                                         {"Lab", ColorSpace::lab},
                                                         {"Diverging", ColorSpace::diverging}};
    for (const auto& [name, space] : spaces)
        for (int i = 0; i < 12; ++i) {
            const Rgb a{component(), component(), component()}, b{component(), component(), component()};
            const std::string text = fmt::format("0, {}, 100, {}", fmt::join(a, ","), fmt::join(b, ","));
            const TransferFunction tf = parsed(paraview(name, text), "x.json").function;
            const auto exact = [&, space = space](double t) { return t == 0 ? a : t == 1 ? b : mixed(space, a, b, t); };
            EXPECT_LE(worst(tf, 0, 100, exact), transfer_sampling_error) << name << " " << text;
            EXPECT_LE(tf.points.size(), 1100u);
        }
}

TEST(ParaView, StepsKeepTheColourOfEachLabel) {
    const TransferFunction tf = parsed(paraview("Step", "0, 1, 0, 0, 1, 0, 1, 0, 2, 0, 0, 1"), "x.json").function;
    EXPECT_EQ(evaluate(tf, 0).rgb, (Rgb{1, 0, 0}));
    EXPECT_EQ(evaluate(tf, 0.5).rgb, (Rgb{0, 1, 0}));
    EXPECT_EQ(evaluate(tf, 1).rgb, (Rgb{0, 1, 0}));
    EXPECT_EQ(evaluate(tf, 1.5).rgb, (Rgb{0, 0, 1}));
    EXPECT_EQ(evaluate(tf, 2).rgb, (Rgb{0, 0, 1}));
}

TEST(ParaView, PlacesCategories) {
    const TransferFile file = parsed(
        R"({"IndexedColors": [1, 0, 0, 0, 1, 0, 0, 0, 1], "Annotations": ["10", "ten", "20", "twenty", "40", "forty"]})",
        "x.json");
    const std::vector<ControlPoint> wanted{{5, {1, 0, 0}, 0},     {15, {1, 0, 0}, 0},    {15, {0, 1, 0}, 0.25},
                                           {30, {0, 1, 0}, 0.25}, {30, {0, 0, 1}, 0.25}, {50, {0, 0, 1}, 0.25}};
    EXPECT_EQ(file.function.points, wanted);
    const TransferFile counted = parsed(R"({"IndexedColors": [1, 0, 0, 0, 1, 0]})", "x.json");
    EXPECT_EQ(evaluate(counted.function, 0).rgb, (Rgb{1, 0, 0}));
    EXPECT_EQ(evaluate(counted.function, 1).rgb, (Rgb{0, 1, 0}));
    EXPECT_NE(notes(counted).find("the first stands for 0"), std::string::npos);
}

TEST(ParaView, ChoosesAmongSeveral) {
    const std::string text = R"([{"Name": "Folder"}, {"Name": "Cool", "RGBPoints": [5, 0, 0, 1]},
                                 {"Name": "Warm", "RGBPoints": [5, 1, 0, 0]}])";
    const TransferFile first = parsed(text, "x.json");
    EXPECT_EQ(first.function.name, "Cool");
    EXPECT_EQ(first.functions, (std::vector<std::string>{"Cool", "Warm"}));
    EXPECT_NE(notes(first).find("holds 2 colour maps: took 'Cool'; FILE#NAME or FILE#2 takes another (Warm)"),
              std::string::npos)
        << notes(first);
    EXPECT_EQ(parsed(text, "x.json#Warm").function.name, "Warm");
    EXPECT_EQ(parsed(text, "x.json#2").function.name, "Warm");
    EXPECT_EQ(refusal(text, "x.json#Worm"), "x.json: has no function 'Worm'; did you mean 'Warm'?");
    EXPECT_EQ(refusal(text, "x.json#3"), "x.json: has no function number 3: must be 1 to 2");
    EXPECT_EQ(refusal(R"({"RGBPoints": [5, 0, 0, 1]})", "x.json#Cool"),
              "x.json: holds one function: there is no 'Cool' to choose");
}

TEST(ParaView, RefusesWithOneSentence) {
    EXPECT_EQ(refusal(paraview("RGB", "0, 0, 0"), "x.json"),
              "x.json: [0].RGBPoints has 3 numbers: must have 4 for each point: value, red, green and blue");
    EXPECT_EQ(refusal(paraview("RGB", "0, 0, 0, 2"), "x.json"), "x.json: [0].RGBPoints[3] is 2: must be in [0, 1]");
    EXPECT_EQ(refusal(paraview("RGB", "0, 0, 0, null"), "x.json"),
              "x.json: [0].RGBPoints[3] is null: must be a number");
    EXPECT_EQ(refusal(paraview("RGB", "1e305, 0, 0, 0"), "x.json"),
              "x.json: [0].RGBPoints[0] is 1e+305: must be in [-1e300, 1e300]");
    EXPECT_TRUE(refusal(paraview("Divergent", "0, 0, 0, 0"), "x.json").ends_with("; did you mean 'Diverging'?"));
    EXPECT_EQ(refusal(paraview("RGB", "0, 0, 0, 0", R"(, "Points": [0, 0, 0.5])"), "x.json"),
              "x.json: [0].Points has 3 numbers: must have 4 for each point: value, opacity, midpoint and sharpness");
    EXPECT_EQ(refusal(paraview("RGB", "0, 0, 0, 0", R"(, "Points": [0, 0, 0.5, 7])"), "x.json"),
              "x.json: [0].Points[3] is 7: must be in [0, 1]");
    EXPECT_EQ(refusal(R"([{"Name": "x"}])", "x.json"),
              "x.json: holds no colour map: none of its entries has 'RGBPoints' or 'IndexedColors'");
    EXPECT_EQ(refusal(R"({"ColorSpace": "RGB", "RGBPoint": [0, 0, 0, 0]})", "x.json"),
              "x.json: lacks 'RGBPoints' and 'IndexedColors'; did you mean 'RGBPoints'?");
    EXPECT_TRUE(refusal(R"([{"RGBPoints": [1, 2 3]}])", "x.json").starts_with("x.json: is not JSON: "));
    EXPECT_TRUE(refusal(R"([{"RGBPoints": [NaN, 0, 0, 0]}])", "x.json").starts_with("x.json: is not JSON: "));
}

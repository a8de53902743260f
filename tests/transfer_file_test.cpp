// Transfer functions of other programs. Every file here was written for these tests.
#include <random>

#include "fixtures.h"
#include "transfer_texts.h"

using namespace chiaro;
using namespace chiaro::testing;

// ---- 3D Slicer

namespace {
const char* const slicer_lines =
    "1\n1\n0.9\n0.1\n0.2\n10\n"
    "6 -1000 0 40 0.2 300 0.6\n"
    "4 0 1 255 0.5\n"
    "8 -1000 0 0 0 300 1 1 0.5\n";
}

TEST(Slicer, CountsNumbersNotPoints) {
    const TransferFile file = parsed(slicer_lines, "ct.vp");
    EXPECT_EQ(file.format, "Slicer");
    const double t = 1040.0 / 1300;
    const std::vector<ControlPoint> wanted{{-1000, {0, 0, 0}, 0}, {40, {t, t, 0.5 * t}, 0.2}, {300, {1, 1, 0.5}, 0.6}};
    EXPECT_EQ(file.function.points, wanted);
    EXPECT_EQ(file.function.opacity_unit, 1);
    EXPECT_TRUE(file.function.opacity_unit_is_mm);
    EXPECT_EQ(notes(file),
              "its shading is no part of a transfer function: --ambient 0.1 --diffuse 0.9 --specular 0.2 --shininess "
              "10 gives it\n");
    EXPECT_EQ(file.function.gradient, (std::vector<GradientPoint>{{0, 1}, {255, 0.5}}));
}

TEST(Slicer, RefusesLinesWithOneSentence) {
    const auto with = [](const std::string& from, const std::string& to) {
        std::string text = slicer_lines;
        return refusal(text.replace(text.find(from), from.size(), to), "a.vp");
    };
    EXPECT_EQ(with("6 -1000", "3 -1000"),
              "a.vp: line 7 (scalar opacity) says 3 numbers and has 6: the count is of numbers, not of points");
    EXPECT_EQ(with("6 -1000 0 40", "5 -1000 40"),
              "a.vp: line 7 (scalar opacity) has 5 numbers: must have a multiple of 2, and at least one point");
    EXPECT_EQ(with("40 0.2", "40 1.2"), "a.vp: line 7 (scalar opacity) number 4 is 1.2: must be in [0, 1]");
    EXPECT_EQ(with("40 0.2", "nan 0.2"), "a.vp: line 7 (scalar opacity) has 'nan': must be numbers");
    EXPECT_EQ(with("0.9", "0.9 1"), "a.vp: line 3 (diffuse) has 2 numbers: must have 1");
    EXPECT_EQ(with("8 -1000 0 0 0 300 1 1 0.5\n", ""),
              "a.vp: ends after 8 lines: must have 9, the last of them colour");
    EXPECT_EQ(with("8 -1000 0 0 0 300 1 1 0.5", "0"),
              "a.vp: line 9 (colour) has 0 numbers: must have a multiple of 4, and at least one point");
    EXPECT_EQ(refusal(std::string(slicer_lines) + "1\n", "a.vp"), "a.vp: goes on after line 9, which must be the last");
    EXPECT_EQ(refusal("", "a.vp"), "a.vp: ends after 0 lines: must have 9, the last of them colour");
}

TEST(Slicer, ReadsJsonWithItsUnit) {
    const TransferFile file = parsed(R"({"@schema": "x", "volumeProperties": [{"components": [{
        "scalarOpacityUnitDistance": 0.25, "shade": false,
        "rgbTransferFunction": {"type": "colorTransferFunction", "points": [
            {"x": 0, "color": [0, 0, 0]}, {"x": 100, "color": [1, 0.5, 0], "midpoint": 0.5, "sharpness": 0}]},
        "scalarOpacity": {"type": "piecewiseLinearFunction", "points": [
            {"x": 100, "y": 1}, {"x": 0, "y": 0, "midpoint": 0.5, "sharpness": 1}]},
        "gradientOpacity": {"points": [{"x": 0, "y": 1}]}}]}]})",
                                     "ct.vp.json");
    EXPECT_EQ(file.format, "Slicer JSON");
    const std::vector<ControlPoint> wanted{
        {0, {0, 0, 0}, 0}, {50, {0.5, 0.25, 0}, 0}, {50, {0.5, 0.25, 0}, 1}, {100, {1, 0.5, 0}, 1}};
    EXPECT_EQ(file.function.points, wanted);
    EXPECT_EQ(file.function.opacity_unit, 0.25);
    EXPECT_TRUE(file.function.opacity_unit_is_mm);
    EXPECT_EQ(notes(file), "");
    EXPECT_EQ(
        refusal(
            R"({"volumeProperties": [{"components": [{"rgbTransferFunction": {"points": []}, "scalarOpacity": {}}]}]})",
            "a.json"),
        "a.json: volumeProperties[0].components[0].rgbTransferFunction.points has 0 entries: must have 1..65536");
    EXPECT_EQ(refusal(R"({"volumeProperties": []})", "a.json"),
              "a.json: volumeProperties must be an array of at least one object");
}

// ---- Inviwo

namespace {
std::string inviwo(const std::string& head, const std::string& points) {
    return "<?xml version=\"1.0\" ?>\n<InviwoWorkspace version=\"2\">\n" + head + "<Points>\n" + points +
           "</Points>\n</InviwoWorkspace>\n";
}
std::string point(double at, double red, double alpha) {
    return fmt::format("<Point><pos content=\"{}\" /><rgba x=\"{}\" y=\"0.5\" z=\"0\" w=\"{}\" /></Point>\n", at, red,
                       alpha);
}
}  // namespace

TEST(Inviwo, StretchesSharesAndMasks) {
    const TransferFile file =
        parsed(inviwo("<maskMin content=\"0.25\" /><maskMax content=\"1\" /><type content=\"0\" />",
                      point(0, 0, 0) + point(0.5, 1, 0.5)),
               "a.itf");
    EXPECT_EQ(file.format, "Inviwo");
    EXPECT_TRUE(file.stretched);
    const std::vector<ControlPoint> wanted{{0, {0.5, 0.5, 0}, 0},
                                           {50, {0.5, 0.5, 0}, 0},
                                           {50, {0.5, 0.5, 0}, 0.25},
                                           {100, {1, 0.5, 0}, 0.5},
                                           {200, {1, 0.5, 0}, 0.5}};
    EXPECT_EQ(file.function.points, wanted);
}

TEST(Inviwo, KeepsAbsoluteValues) {
    const TransferFile file =
        parsed(inviwo("<maskMin content=\"-1.7976931348623157e+308\" /><maskMax content=\"1.7976931348623157e+308\" />"
                      "<type content=\"1\" />",
                      point(-100, 0, 0) + point(400, 1, 0.5)),
               "a.itf");
    EXPECT_FALSE(file.stretched);
    EXPECT_EQ(file.function.points, (std::vector<ControlPoint>{{-100, {0, 0.5, 0}, 0}, {400, {1, 0.5, 0}, 0.5}}));
}

TEST(Inviwo, ReadsTheOlderRoot) {
    const TransferFile file = parsed(R"(<InviwoTreeData version="1.0"><maskMin content="0"/><maskMax content="1"/>
        <dataPoints><point><pos x="0" y="0.5"/><rgba x="1" y="0" z="0" w="0.5"/></point>
        <point><pos x="1" y="1"/><rgba x="0" y="0" z="1" w="1"/></point></dataPoints>
        <interpolationType_ content="0"/></InviwoTreeData>)",
                                     "unnamed");
    EXPECT_EQ(file.format, "Inviwo");
    EXPECT_EQ(file.function.points, (std::vector<ControlPoint>{{0, {1, 0, 0}, 0.5}, {200, {0, 0, 1}, 1}}));
}

TEST(Inviwo, RefusesWithOneSentence) {
    EXPECT_EQ(refusal(inviwo("", point(1.5, 0, 0)), "a.itf"), "a.itf: line 4 <pos> content is 1.5: must be in [0, 1]");
    EXPECT_EQ(refusal(inviwo("", point(0.5, 2, 0)), "a.itf"), "a.itf: line 4 <rgba> x is 2: must be in [0, 1]");
    EXPECT_EQ(refusal(inviwo("", point(0.5, NAN, 0)), "a.itf"), "a.itf: line 4 <rgba> x is 'nan': must be a number");
    EXPECT_EQ(refusal(inviwo("", "<Point><rgba/></Point>"), "a.itf"), "a.itf: line 4 <Point> lacks <pos>");
    EXPECT_EQ(refusal(inviwo("", ""), "a.itf"), "a.itf: line 3 <Points> has no points: must have at least one");
    EXPECT_EQ(refusal(inviwo("<type content=\"2\" />", ""), "a.itf"),
              "a.itf: line 3 <type> content is 2: must be 0 (relative) or 1 (absolute)");
    EXPECT_EQ(refusal("<svg/>", "a.itf"),
              "a.itf: begins with <svg>: must be InviwoWorkspace or InviwoTreeData or TransferFunction");
    EXPECT_TRUE(refusal("<InviwoWorkspace>\n<Points>", "a.itf").starts_with("a.itf: is not XML: line 2: "));
    EXPECT_EQ(refusal("hello", "a.itf"), "a.itf: is not XML");
}

// ---- Voreen

namespace {
std::string voreen(const std::string& head, const std::string& keys) {
    return "<?xml version=\"1.0\" ?>\n<VoreenData version=\"1\">\n<TransFuncIntensity>\n" + head + "\n<Keys>\n" + keys +
           "</Keys></TransFuncIntensity></VoreenData>";
}
std::string key(double at, int red, int alpha, int right_alpha = -1) {
    const bool split = right_alpha >= 0;
    const std::string right =
        split ? fmt::format("<colorR r=\"{}\" g=\"0\" b=\"0\" a=\"{}\" />", red, right_alpha) : "";
    return fmt::format(
        "<key><intensity value=\"{}\" /><split value=\"{}\" />"
        "<colorL r=\"{}\" g=\"0\" b=\"0\" a=\"{}\" />{}</key>\n",
        at, split, red, alpha, right);
}
}  // namespace

TEST(Voreen, ReadsKeysDomainAndThresholds) {
    const TransferFile file = parsed(voreen(R"(<domain x="-100" y="300" /><threshold x="0" y="0.75" />)",
                                            key(0, 0, 0) + key(0.5, 255, 0, 51) + key(1, 255, 51)),
                                     "a.tfi");
    EXPECT_EQ(file.format, "Voreen");
    EXPECT_FALSE(file.stretched);
    const std::vector<ControlPoint> wanted{{-100, {0, 0, 0}, 0},  {100, {1, 0, 0}, 0}, {100, {1, 0, 0}, 0.2},
                                           {200, {1, 0, 0}, 0.2}, {200, {1, 0, 0}, 0}, {300, {1, 0, 0}, 0}};
    EXPECT_EQ(file.function.points, wanted);
}

TEST(Voreen, StretchesWithoutDomain) {
    const std::string keys = key(0.25, 255, 51) + key(0.75, 0, 255);
    const std::vector<ControlPoint> wanted{
        {0, {1, 0, 0}, 0.2}, {50, {1, 0, 0}, 0.2}, {150, {0, 0, 0}, 1}, {200, {0, 0, 0}, 1}};
    EXPECT_EQ(parsed(voreen("", keys), "a.tfi").function.points, wanted);
    EXPECT_EQ(parsed(voreen(R"(<domain x="0" y="1" />)", keys), "a.tfi").function.points, wanted);
    const TransferFile older = parsed(voreen(R"(<lower value="0.5" /><upper value="1" />)", keys), "unnamed");
    EXPECT_EQ(older.format, "Voreen");
    EXPECT_EQ(evaluate(older.function, 99).opacity, 0);
    EXPECT_NEAR(evaluate(older.function, 100).opacity, 0.6, 1e-12);
}

TEST(Voreen, BendsByGamma) {
    const TransferFunction tf =
        parsed(voreen(R"(<gammaValue value="2" /><domain x="0" y="100" />)", key(0, 0, 0) + key(1, 255, 255)), "a.tfi")
            .function;
    const double bound = transfer_sampling_error;
    EXPECT_LE(worst(tf, 0, 100, [](double t) { return Rgb{t * t, 0, 0}; }), bound);
    EXPECT_NEAR(evaluate(tf, 50).opacity, 0.25, bound);
}

TEST(Voreen, RefusesWithOneSentence) {
    EXPECT_EQ(refusal(voreen("", key(0.5, 256, 0)), "a.tfi"), "a.tfi: line 6 <colorL> r is 256: must be in [0, 255]");
    EXPECT_EQ(refusal(voreen("", key(2, 0, 0)), "a.tfi"), "a.tfi: line 6 <intensity> value is 2: must be in [0, 1]");
    EXPECT_EQ(refusal(voreen("", ""), "a.tfi"), "a.tfi: line 5 <Keys> has no keys: must have at least one");
    EXPECT_EQ(refusal(voreen(R"(<threshold x="0.7" y="0.2" />)", key(0, 0, 0)), "a.tfi"),
              "a.tfi: line 3 <TransFuncIntensity> has thresholds from 0.7 to 0.2: must rise");
    EXPECT_EQ(refusal(voreen(R"(<domain x="5" y="5" />)", key(0, 0, 0)), "a.tfi"),
              "a.tfi: line 4 <domain> is 5 to 5: must rise");
    EXPECT_EQ(refusal("<VoreenData/>", "a.tfi"),
              "a.tfi: line 1 <VoreenData> holds no one-dimensional function of keys");
}

// ---- all of them

TEST(TransferFile, KnowsFormatsByEndingAndContent) {
    EXPECT_EQ(list_transfer_formats().size(), 6u);
    EXPECT_EQ(parsed(to_json(preset("ct-bone", bytes)), "a.json").format, "Chiaro");
    EXPECT_EQ(parsed(R"({"preset": "viridis"})", "a.json").function, preset("viridis", bytes));
    EXPECT_EQ(parse_transfer_file(slicer_lines, "pasted", bytes, "Slicer").function.points.size(), 3u);
    EXPECT_EQ(refusal("hello", "pasted"),
              "pasted: is none of the transfer-function formats Slicer JSON, Slicer, Inviwo, Voreen, ParaView, Chiaro");
    EXPECT_EQ(refusal("", "pasted"), "pasted: is empty");
    EXPECT_THROW(parse_transfer_file("", "x", bytes, "Slicr"), Error);
}

TEST(TransferFile, GoesToParaViewAndBack) {
    for (const char* name : {"ct-bone", "mr-brain", "sample:cornell", "viridis"}) {
        const TransferFunction tf = preset(name, bytes);
        const TransferFile back = parsed(to_paraview_json(tf), "a.json");
        EXPECT_EQ(back.format, "ParaView");
        EXPECT_EQ(back.function, tf) << name;
        EXPECT_EQ(notes(back), "") << name;
    }
    TransferFunction linear;
    linear.rgb_space = RgbSpace::linear;
    linear.points = {{0, {0, 0, 0}, 0}, {200, {1, 0.2, 0.6}, 1}};
    const TransferFunction back = parsed(to_paraview_json(linear), "a.json").function;
    const auto exact = [](double t) {
        const auto srgb = [](double c) { return c <= 0.0031308 ? 12.92 * c : 1.055 * std::pow(c, 1 / 2.4) - 0.055; };
        return Rgb{srgb(t), srgb(0.2 * t), srgb(0.6 * t)};
    };
    EXPECT_LE(worst(back, 0, 200, exact), transfer_sampling_error);
    EXPECT_NEAR(evaluate(back, 50).opacity, 0.25, 1e-12);
}

TEST(TransferFile, GivesTheSameImage) {
    const Volume volume =
        sampled<std::uint8_t>({24, 24, 24}, [](double x, double y, double z) { return shells(x, y, z, 24); });
    Shot shot;
    const Frame own = shot(volume);
    shot.tf = parsed(to_paraview_json(shot.tf), "a.json").function;
    EXPECT_EQ(shot(volume).rgba, own.rgba);  // the same bits
    EXPECT_GT(mean_alpha(own), 0.05);
    // The two materials again, as 3D Slicer would write them; spacing is 1 mm, so the units agree.
    shot.tf = parsed(
                  "1\n0\n0\n0\n0\n0\n10 60 0 110 0.15 150 0 170 0 220 0.7\n2 0 1\n"
                  "20 60 0.2 0.4 0.9 110 0.2 0.4 0.9 150 0.3 0.8 0.3 170 0.9 0.4 0.1 220 0.9 0.4 0.1\n",
                  "a.vp")
                  .function;
    EXPECT_EQ(shot(volume).rgba, own.rgba);
}

TEST(TransferFile, SurvivesHugeAndHostileTexts) {
    std::string many = "[{\"RGBPoints\": [";
    for (int i = 0; i < 70000; ++i) many += std::to_string(i) + ",0,0,0,";
    EXPECT_EQ(refusal(many + "]}]", "a.json"), "a.json: [0].RGBPoints has 70000 points: must have 1..65536");
    std::string zigzag = R"([{"ColorSpace": "Lab", "RGBPoints": [)";
    for (int i = 0; i < 60000; ++i) zigzag += fmt::format("{0},{1},{1},{1},", i, i % 2);
    EXPECT_EQ(refusal(zigzag + "]}]", "a.json"), "a.json: [0].RGBPoints needs more than 65536 points");
    EXPECT_EQ(refusal(std::string(1000000, '['), "a.json"), "a.json: is nested more than 64 deep");
    EXPECT_EQ(refusal(std::string((16 << 20) + 1, ' '), "a.json"),
              "a.json: is larger than 16 MiB, which no transfer function needs");
    std::string keys;
    for (int i = 0; i < 60000; ++i) keys += key(i / 6e4, i % 256, 0);
    EXPECT_EQ(parsed(voreen("", keys), "a.tfi").function.points.size(), 60001u);
    std::string deep;
    for (int i = 0; i < 200000; ++i) deep += "<InviwoWorkspace>";
    EXPECT_TRUE(refusal(deep, "a.itf").starts_with("a.itf: is not XML: "));
    for (int i = 0; i < 200000; ++i) deep += "</InviwoWorkspace>";
    EXPECT_TRUE(refusal(deep, "a.itf").ends_with("lacks <Points>"));
    EXPECT_EQ(
        refusal(std::string("{\"ColorSpace\": \"\x1b[31m\", \"RGBPoints\": [0, 0, 0, 0]}"), "a.json").find('\x1b'),
        std::string::npos);
}

/// The entry for fuzzing: whatever the bytes are, a valid function or an Error of input.
TEST(TransferFile, MutantsAreReadOrRefused) {
    const std::pair<const char*, std::string> seeds[] = {
        {"a.vp", slicer_lines},
        {"a.itf", inviwo("<maskMin content=\"0.2\" />", point(0, 0, 0) + point(1, 1, 1))},
        {"a.tfi", voreen(R"(<gammaValue value="2" /><domain x="0" y="9" />)", key(0, 0, 0) + key(1, 255, 255, 3))},
        {"a.json",
         paraview("Diverging", "0, 0.2, 0.3, 0.7, 9, 0.7, 0, 0.1", R"(, "Points": [0, 0, 0.3, 0.4, 9, 1, 0, 1])")},
        {"a.vp.json", R"({"volumeProperties": [{"components": [{"rgbTransferFunction": {"points": [{"x": 1,
            "color": [0, 1, 0]}]}, "scalarOpacity": {"points": [{"x": 2, "y": 1}]}}]}]})"}};
    std::mt19937 random(11);
    const std::string alphabet = "0123456789.-+eE,[]{}<>/\"= \n\tnax\xff";
    int read = 0, refused = 0;
    for (int i = 0; i < 3000; ++i) {
        const auto& [name, seed] = seeds[i % std::size(seeds)];
        std::string text = seed;
        for (unsigned edits = 1 + random() % 3; edits > 0 && !text.empty(); --edits) {
            const std::size_t at = random() % text.size();
            switch (random() % 4) {
                case 0:
                    text[at] = alphabet[random() % alphabet.size()];
                    break;
                case 1:
                    text.insert(at, 1, alphabet[random() % alphabet.size()]);
                    break;
                case 2:
                    text.erase(at, 1 + random() % 5);
                    break;
                case 3:
                    text.insert(at, text.substr(random() % text.size(), random() % 20));
                    break;
            }
        }
        try {
            const TransferFile file = parsed(text, name);
            EXPECT_NO_THROW(validate(file.function));
            EXPECT_LE(file.function.points.size(), 65536u);
            ++read;
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), ErrorCode::input) << error.what();
            EXPECT_TRUE(std::string(error.what()).starts_with(name)) << error.what();
            ++refused;
        }
    }
    EXPECT_GT(read, 100);
    EXPECT_GT(refused, 1000);
}

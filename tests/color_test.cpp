// Colours: names, the sRGB curve and the colour maps.
#include <chiaro/error.h>
#include <chiaro/transfer_function.h>
#include <gtest/gtest.h>

#include "core/srgb.h"

using namespace chiaro;

namespace {

Rgb bytes(int r, int g, int b) { return {r / 255.0, g / 255.0, b / 255.0}; }

Rgb map_at(const std::string& name, double position) {
    Statistics data;
    data.min = -1, data.max = 3;
    return evaluate(preset(name, data), -1 + 4 * position).rgb;
}

void expect_near(const Rgb& a, const Rgb& b, double tolerance, const std::string& what) {
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(a[c], b[c], tolerance) << what << ", component " << c;
}

std::string refusal(const std::string& text) {
    try {
        parse_color(text);
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::usage);
        return error.what();
    }
    ADD_FAILURE() << "no error for " << text;
    return "";
}

}  // namespace

TEST(Srgb, RoundTrips) {
    for (int i = 0; i <= 1000; ++i) EXPECT_NEAR(srgb_from_linear(linear_from_srgb(i / 1000.0)), i / 1000.0, 1e-7);
    EXPECT_NEAR(linear_from_srgb(0.5), 0.21404114, 1e-8);
    EXPECT_NEAR(srgb_from_linear(0.18), 0.46135613, 1e-8);
    EXPECT_EQ(linear_from_srgb(0), 0);
    EXPECT_NEAR(linear_from_srgb(1), 1, 1e-15);
}

TEST(Color, Names) {
    EXPECT_EQ(parse_color("black"), bytes(0, 0, 0));
    EXPECT_EQ(parse_color("White"), bytes(255, 255, 255));
    EXPECT_EQ(parse_color("rebeccapurple"), bytes(0x66, 0x33, 0x99));
    EXPECT_EQ(parse_color("DarkSlateGrey"), parse_color("darkslategray"));
    EXPECT_EQ(parse_color("tomato"), bytes(255, 99, 71));
    EXPECT_EQ(parse_color("yellowgreen"), bytes(154, 205, 50));
    EXPECT_EQ(parse_color("aliceblue"), bytes(240, 248, 255));
}

TEST(Color, NumbersAndHex) {
    EXPECT_EQ(parse_color("#102030"), bytes(16, 32, 48));
    EXPECT_EQ(parse_color("#fFf"), bytes(255, 255, 255));
    EXPECT_EQ(parse_color("#1a9"), bytes(0x11, 0xaa, 0x99));
    EXPECT_EQ(parse_color("0.25,1,0"), (Rgb{0.25, 1, 0}));
}

TEST(Color, RefusesTheRest) {
    EXPECT_EQ(refusal("tomatoe"), "colour 'tomatoe' is unknown; did you mean 'tomato'?");
    for (const char* text : {"", "#", "#12", "#12345", "#1234567", "#ggg", "#-12", "1,2", "1,0,0,0", "2,0,0",
                             "-0.1,0,0", "nan,0,0", "a,b,c", "1,0,", "1, 0,0"})
        EXPECT_NE(refusal(text).find("must be"), std::string::npos) << text;
}

TEST(ColorMaps, HitKnownColours) {  // within the error that color_maps.cpp states: 0.025, and 8 bit rounding
    const struct {
        const char* name;
        double position;
        Rgb rgb;
    } anchors[] = {{"viridis", 0, bytes(68, 1, 84)},        {"viridis", 0.5, bytes(33, 145, 140)},
                   {"viridis", 1, bytes(253, 231, 37)},     {"plasma", 0, bytes(13, 8, 135)},
                   {"plasma", 0.5, bytes(204, 71, 120)},    {"plasma", 1, bytes(240, 249, 33)},
                   {"inferno", 0.5, bytes(188, 55, 84)},    {"inferno", 1, bytes(252, 255, 164)},
                   {"magma", 0.5, bytes(183, 55, 121)},     {"magma", 1, bytes(252, 253, 191)},
                   {"cividis", 0, bytes(0, 34, 78)},        {"cividis", 0.5, bytes(124, 123, 120)},
                   {"turbo", 0, bytes(48, 18, 59)},         {"turbo", 0.5, bytes(164, 252, 60)},
                   {"turbo", 1, bytes(122, 4, 3)},          {"jet", 0, bytes(0, 0, 128)},
                   {"jet", 0.5, bytes(125, 255, 122)},      {"coolwarm", 0, bytes(59, 76, 192)},
                   {"coolwarm", 0.5, bytes(221, 221, 221)}, {"RdBu", 0, bytes(103, 0, 31)},
                   {"Spectral", 1, bytes(94, 79, 162)},     {"Blues", 1, bytes(8, 48, 107)},
                   {"Greys", 0, bytes(255, 255, 255)},      {"rainbow", 0.5, bytes(128, 255, 180)}};
    for (const auto& [name, position, rgb] : anchors) expect_near(map_at(name, position), rgb, 0.029, name);
}

TEST(ColorMaps, FollowTheirFormulas) {
    for (double x = 0; x <= 1; x += 0.01) {
        expect_near(map_at("gray", x), {x, x, x}, 1e-9, "gray");
        expect_near(map_at("cool", x), {x, 1 - x, 1}, 1e-9, "cool");
        expect_near(map_at("spring", x), {1, x, 1 - x}, 1e-9, "spring");
        expect_near(map_at("summer", x), {x, 0.5 + x / 2, 0.4}, 0.003, "summer");
        expect_near(map_at("autumn", x), {1, x, 0}, 1e-9, "autumn");
        expect_near(map_at("winter", x), {0, x, 1 - x / 2}, 0.003, "winter");
        expect_near(map_at("copper", x), {std::min(1.0, 1.2353 * x), 0.7812 * x, 0.4975 * x}, 0.004, "copper");
        expect_near(map_at("cubehelix", x), map_at("cubehelix_r", 1 - x), 1e-9, "cubehelix");
    }
}

TEST(ColorMaps, AllExistWithTheirReverse) {
    Statistics data;
    data.max = 1;
    int maps = 0;
    for (const PresetInfo& info : list_presets()) {
        if (!info.modality.empty()) continue;
        ++maps;
        const TransferFunction forward = preset(info.name, data), back = preset(info.name + "_r", data);
        EXPECT_NO_THROW(validate(back));
        expect_near(forward.points.front().rgb, back.points.back().rgb, 1e-12, info.name);
        for (double x : {0.0, 0.05, 0.1, 0.3, 1.0})  // opacity rises with the value, whichever way the colours run
            EXPECT_NEAR(evaluate(back, x).opacity, evaluate(forward, x).opacity, 1e-9) << info.name;
        EXPECT_EQ(evaluate(forward, 0.1).opacity, 0);
        EXPECT_DOUBLE_EQ(evaluate(forward, 1).opacity, 0.25);
    }
    EXPECT_EQ(maps, 66);
    EXPECT_THROW(preset("viridis_x", data), Error);
}

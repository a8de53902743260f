// Walks every setting that <chiaro/describe.h> tells.
#include <gtest/gtest.h>

#include <map>
#include <set>

#include "changed_scene.h"

using namespace chiaro;

TEST(Settings, AreAllTold) {
    std::set<std::string_view> names;
    std::set<std::pair<std::string_view, std::string_view>> keys;  // methods may share one
    const Scene scene;
    for_each_setting(
        [&](const Setting& s, const auto&...) {
            EXPECT_FALSE(s.sentence.empty()) << s.key;
            EXPECT_NE(s.sentence.back(), '.') << s.key;
            EXPECT_TRUE(s.name.empty() || names.insert(s.name).second) << s.name << " twice";
            for (const std::string_view method : names_of(Method()))
                EXPECT_TRUE(!s.concerns(method) || keys.emplace(method, s.key).second) << s.key << " twice";
            EXPECT_LT(s.lowest, s.highest) << s.key;
        },
        scene);
    EXPECT_GT(names.size(), 35u);
}

TEST(Settings, DefaultsAreInRange) {
    const Scene scene;
    for_each_setting([](const Setting& s,
                        const auto&... fields) { EXPECT_NO_THROW(check_range(s, value_text(s, fields...))) << s.key; },
                     scene);
}

TEST(Settings, RoundTripThroughText) {
    const Scene from = changed_scene();
    std::map<std::string, std::string> given;
    for (const auto& [key, text] : texts_of(from)) given[key] = text;
    Scene to;
    for_each_setting(
        [&](const Setting& s, auto&... fields) {
            if (!s.concerns(to_text(from.illumination.method))) return;
            const auto text = given.find(std::string(s.key));
            if (text != given.end() && !text->second.empty()) set(s, text->second, "test", ErrorCode::usage, fields...);
        },
        to);
    EXPECT_EQ(texts_of(from), texts_of(to));
    EXPECT_EQ(from.camera, to.camera);
    EXPECT_EQ(from.lighting, to.lighting);
    EXPECT_EQ(from.transfer, to.transfer);
}

constexpr Method methods[] = {Method::spao, Method::visibility, Method::histogram, Method::transport,
                              Method::reference};

TEST(Settings, EveryChangeIsSeen) {
    for (const Method method : methods) {
        Scene plain;
        plain.illumination.method = method;
        const auto before = texts_of(plain), after = texts_of(changed_scene(method));
        for (std::size_t i = 0; i < before.size(); ++i) {
            const std::string& key = before[i].first;
            // The method is the same on purpose; the other unit of opacity excludes this one.
            if (key == "lighting.method" || key == "transfer_function.opacity_unit_distance") continue;
            EXPECT_NE(before[i], after[i]);
        }
    }
}

TEST(Settings, RoundTripThroughAScene) {
    for (const Method method : methods) {
        Scene from = changed_scene(method);
        from.camera.view.reset(), from.camera.matrix.reset();
        std::vector<std::string> unknown;
        const Scene to = parse_scene(to_json(from), "", "", unknown);
        EXPECT_EQ(texts_of(from), texts_of(to));
        EXPECT_EQ(from.transfer, to.transfer);
        EXPECT_TRUE(unknown.empty());
        EXPECT_EQ(to_json(from), to_json(to));
    }
}

TEST(Settings, RefusalsNameTheValueAndTheRange) {
    struct Case {
        std::string_view name;
        const char *text, *message;
    };
    const Case cases[] = {
        {"step", "0", "--step 0: must be 0.001 to 100 voxels"},
        {"step", "fine", "--step fine: expected a number"},
        {"step", "nan", "--step nan: expected a number"},
        {"zoom", "0", "--zoom 0: must be 1e-09 to 1000"},
        {"zoom", "1e-309", "--zoom 1e-309: must be 1e-09 to 1000"},  // 1 / it is no number of a scene
        {"size", "0x5", "--size 0x5: must be 1 to 16384 pixels"},
        {"size", "1024", "--size 1024: expected WIDTHxHEIGHT"},
        {"size", "10.5x4", "--size 10.5x4: expected a whole number"},
        {"window", "40", "--window 40: expected two numbers A,B"},
        {"up", "w", "--up w: expected three numbers X,Y,Z or an axis such as -z"},
        {"projection", "perspectiv",
         "--projection perspectiv: must be perspective, orthographic; did you mean 'perspective'?"},
        {"sh-bands", "3", "--sh-bands 3: must be 2, 4"},
        {"sh-sampling", "fibonacci:4", "--sh-sampling fibonacci:4: only jittered takes a number of sets"},
        {"raw-spacing", "-z", "--raw-spacing -z: must be above 0 mm"},
        {"light", "left", "--light left: expected headlight, AZ,EL[,COLOR] or at:X,Y,Z[,COLOR]"},
    };
    for (const auto& [name, text, message] : cases) {
        Scene scene;
        std::string said;
        for_each_setting(
            [&](const Setting& s, auto&... fields) {
                if (s.name != name) return;
                try {
                    set(s, text, "--" + std::string(name) + " " + text, ErrorCode::usage, fields...);
                } catch (const Error& error) {
                    said = error.what();
                }
            },
            scene);
        EXPECT_EQ(said, message);
    }
}

TEST(Settings, LightsAndColorsReadAsWritten) {
    Light light;
    from_text("-30,20,red", light);
    EXPECT_EQ(light, (Light{.headlight = false, .azimuth_deg = -30, .elevation_deg = 20, .color = {1, 0, 0}}));
    from_text("10,20", light);
    EXPECT_EQ(light.color, (Rgb{1, 1, 1}));
    from_text("headlight,0.5,1,0", light);
    EXPECT_EQ(light, (Light{.color = {0.5, 1, 0}}));
    Vec3 up;
    from_text("-y", up);
    EXPECT_EQ(up, (Vec3{0, -1, 0}));
}

TEST(Settings, AnOlderNameOfMeanRadianceIsAccepted) {
    for (const char* name : {"mean-radiance", "fluence"}) {
        ReferenceQuantity quantity{};
        from_text(name, quantity);
        EXPECT_EQ(quantity, ReferenceQuantity::mean_radiance);
        EXPECT_EQ(to_text(quantity), "mean-radiance");
    }
}

// Slices, values and places on surfaces as messages: what the library says, within bounds, and a sentence beyond them.
#include <gtest/gtest.h>

#include "server_case.h"

using namespace chiaro;
using namespace chiaro::testing;

namespace {

const Json across_z{{"centre", {15.5, 15.5, 16}}, {"right", {1, 0, 0}}, {"down", {0, 1, 0}}};

Json wanted(const Json& more = Json::object()) {
    Json request{{"type", "slice"}, {"plane", across_z}, {"size", {32, 32}}, {"window", {127.5, 255}}};
    request.update(more);
    return request;
}

}  // namespace

TEST(ServerSlices, ANearestOnesValuesAndPictureAreTheVolumes) {
    const Server server;
    Json scene;
    Page page = server.ready(scene);
    const Volume ball = make_sample("ball", 32);
    const Json told = page.ask(wanted({{"values", true}, {"sampling", "nearest"}}));
    ASSERT_EQ(told["type"], "answer") << told;
    ASSERT_EQ(told["values"].size(), 1024u);
    for (std::size_t i = 0; i < 1024; ++i) ASSERT_EQ(told["values"][i], int(ball.as<std::uint8_t>()[16 * 1024 + i]));

    page.send([&] {
        Json request = wanted({{"lossless", true}});
        request["id"] = 77;
        return request;
    }());
    const auto frame = page.find([](const Message& m) { return m.is_frame && m.json["kind"] == "slice"; });
    ASSERT_TRUE(frame);
    EXPECT_EQ(frame->json["n"], 77);
    EXPECT_EQ(frame->json["type"], "png");
    write_file(server.folder / "slice.png", frame->image);
    const Image image = read_png(server.folder / "slice.png");
    ASSERT_EQ(image.width, 32);
    for (std::size_t i = 0; i < 1024; ++i) ASSERT_EQ(image.pixels[3 * i], ball.as<std::uint8_t>()[16 * 1024 + i]);
}

TEST(ServerSlices, ColoursAreThoseOfTheFunctionThatComesAlong) {
    const Server server;
    Json scene;
    Page page = server.ready(scene);
    page.send(wanted({{"id", 5}, {"lossless", true}, {"transfer_function", scene["transfer_function"]}}));
    const auto frame = page.find([](const Message& m) { return m.is_frame && m.json["kind"] == "slice"; });
    ASSERT_TRUE(frame);
    write_file(server.folder / "slice.png", frame->image);
    const Image image = read_png(server.folder / "slice.png");
    const std::size_t middle = 3 * (16 * 32 + 16);  // the ball is .88, .54, .3
    EXPECT_EQ(image.pixels[middle], 224);
    EXPECT_EQ(image.pixels[middle + 1], 138);
}

TEST(ServerSlices, RegionsAndPlacesOnSurfaces) {
    const Server server;
    Json scene;
    Page page = server.ready(scene);
    const Json centre{15.5, 15.5, 15.5};
    const Json inside = page.ask({{"type", "region"}, {"shape", "ball"}, {"centre", centre}, {"radius", 6}});
    ASSERT_EQ(inside["type"], "answer") << inside;
    EXPECT_EQ(inside["mean"], 200);
    EXPECT_EQ(inside["deviation"], 0);
    EXPECT_EQ(inside["percentiles"]["50"], 200);
    EXPECT_EQ(inside["volume_mm3"], inside["count"]);
    const Json box =
        page.ask({{"type", "region"}, {"shape", "box"}, {"corner", {0, 0, 0}}, {"opposite", {31, 31, 31}}});
    EXPECT_EQ(box["count"], 32768);
    EXPECT_EQ(box["exact_mm3"], 31 * 31 * 31);
    const Json empty = page.ask({{"type", "region"}, {"shape", "ball"}, {"centre", {900, 0, 0}}, {"radius", 6}});
    EXPECT_EQ(empty["type"], "error");
    EXPECT_EQ(empty["sentence"], "region: no voxel's centre lies in it");
    const Json on = page.ask({{"type", "snap"}, {"at", {15.5 + 12.6, 15.5, 15.5}}, {"reach_mm", 3}});
    ASSERT_EQ(on["hit"], true);
    EXPECT_NEAR(on["at"][0].get<double>(), 15.5 + 12, 0.1);
    EXPECT_EQ(page.ask({{"type", "snap"}, {"at", centre}, {"reach_mm", 3}})["hit"], false);
}

TEST(ServerSlices, GradientsAreTheLibrarysCountsByLogarithm) {
    const Server server;
    Json scene;
    Page page = server.ready(scene);
    Progress progress;
    const GradientHistogram expected =
        gradient_histogram(upload(Device::cpu(1), make_sample("ball", 32)), 256, 128, progress);
    const std::uint64_t most = *std::max_element(expected.counts.begin(), expected.counts.end());
    for (const int id : {31, 32}) {  // the second time it is kept
        page.send({{"type", "gradients"}, {"id", id}});
        const auto frame = page.find([](const Message& m) { return m.is_frame && m.json["kind"] == "gradients"; });
        ASSERT_TRUE(frame);
        EXPECT_EQ(frame->json["n"], id);
        write_file(server.folder / "gradients.png", frame->image);
        const Image image = read_png(server.folder / "gradients.png");
        ASSERT_EQ(image.width, expected.columns);
        ASSERT_EQ(image.height, 128);
        for (std::size_t i = 0; i < expected.counts.size(); ++i) {
            const std::size_t row = 127 - i / std::size_t(image.width), column = i % std::size_t(image.width);
            ASSERT_NEAR(image.pixels[3 * (row * std::size_t(image.width) + column)],
                        255 * std::log1p(double(expected.counts[i])) / std::log1p(double(most)), 0.5001);
        }
        const auto told = page.find([&](const Message& m) { return !m.is_frame && m.json["re"] == id; });
        ASSERT_TRUE(told);
        EXPECT_EQ(told->json["values"], Json({expected.value_low, expected.value_high}));
        EXPECT_EQ(told->json["steepest"], expected.steepest);
    }
    EXPECT_EQ(page.ask({{"type", "gradients"}})["type"], "answer");
}

TEST(ServerSlices, WhatIsBeyondBoundsIsRefusedInASentence) {
    const Server server;
    Json scene;
    Page page = server.ready(scene);
    const auto refused = [&](const Json& request, const std::string& part) {
        const Json told = page.ask(request);
        EXPECT_EQ(told["type"], "error") << request;
        EXPECT_NE(told["sentence"].get<std::string>().find(part), std::string::npos) << told;
    };
    refused(wanted({{"size", {5000, 5}}}), "size");
    refused(wanted({{"size", {512, 512}}, {"values", true}}), "65536");
    refused(wanted({{"plane", 3}}), "plane");
    refused(wanted({{"plane", {{"centre", {1, 2}}, {"right", {1, 0, 0}}, {"down", {0, 1, 0}}}}}), "centre");
    refused(wanted({{"plane", {{"centre", {1, 2, 1e300}}, {"right", {1, 0, 0}}, {"down", {0, 1, 0}}}}}), "centre");
    refused(wanted({{"window", {1, 0}}}), "window");
    refused(wanted({{"window", "wide"}}), "window");
    refused(wanted({{"sampling", "cubic"}}), "linear");
    refused(wanted({{"pane", 16}}), "pane");
    refused(wanted({{"transfer_function", {{"points", {{{"value", 1}}}}}}}), "");
    refused({{"type", "region"}, {"shape", "cone"}}, "shape");
    refused({{"type", "region"}, {"shape", "ball"}, {"centre", {0, 0, 0}}, {"radius", -1}}, "radius");
    refused({{"type", "snap"}, {"at", {0, 0, 0}}, {"reach_mm", "far"}}, "reach_mm");
    refused({{"type", "snap"}, {"at", {0, 0, 0}}, {"reach_mm", 1}, {"normal", {0, 0, 0}}}, "normal");
    const Server none("");
    Page empty = none.page();
    EXPECT_EQ(empty.ask(wanted())["sentence"], "no volume is open");
}

TEST(ServerSlices, WhatIsKeptIsRestoredAndMarksToo) {
    const Server server;
    Json scene;
    {
        Page page = server.ready(scene);
        scene["slices"] = {{"layout", "linked"}, {"at", {1, 2, 3}}};
        scene["marks"] = Json::array({{{"kind", "distance"}, {"points", {{0, 0, 0}, {3, 4, 0}}}}});
        EXPECT_EQ(page.ask({{"type", "keep"}, {"scene", scene}})["type"], "answer");
        Json wrong = scene;
        wrong["marks"][0]["points"] = 7;
        EXPECT_EQ(page.ask({{"type", "keep"}, {"scene", wrong}})["type"], "error");
    }
    Page again = server.page("view-one", "&take=1");
    const auto hello = again.find([](const Message& m) { return !m.is_frame && m.json["type"] == "hello"; });
    ASSERT_TRUE(hello);
    EXPECT_EQ(hello->json["restored"], true);
    EXPECT_EQ(hello->json["scene"]["slices"]["at"], Json({1, 2, 3}));
    EXPECT_EQ(hello->json["scene"]["marks"], scene["marks"]);
    EXPECT_EQ(hello->json["volume"]["sections"].size(), 3u);
    EXPECT_EQ(hello->json["volume"]["exact"], true);
}

TEST(ServerSlices, LabelsAreListedFoundAndLaidOver) {
    const Server server("sample:torso:32");
    Json scene;
    Page page = server.ready(scene);
    const Json labels{{"file", "sample:organs:32"}};
    const Json told = page.ask({{"type", "labels"}, {"labels", labels}});
    ASSERT_EQ(told["type"], "answer") << told;
    Progress progress;
    const LabelVolume organs = read_labels("sample:organs:32", "", {}, progress);
    ASSERT_EQ(told["labels"].size(), organs.labels.size());
    for (std::size_t i = 0; i < organs.labels.size(); ++i) {
        EXPECT_EQ(told["labels"][i]["name"], organs.labels[i].name);
        EXPECT_EQ(told["labels"][i]["voxels"], organs.counts[i]);
    }
    const Volume torso = make_sample("torso", 32);
    const auto numbers = organs.numbers();
    for (const int i : {0, 5000, 16000, 17000, 20000}) {
        const Vec3 at = torso.geometry.world_from_voxel({double(i % 32), double(i / 32 % 32), double(i / 1024)});
        const Json found = page.ask({{"type", "label"}, {"at", {at.x, at.y, at.z}}, {"labels", labels}});
        EXPECT_EQ(found["value"], organs.labels[numbers[std::size_t(i)]].value) << found;
    }
    int id = 900;
    const auto sent = [&](const Json& more) {
        const Vec3 middle = torso.geometry.world_from_voxel({15.5, 15.5, 16});
        const double step = torso.geometry.spacing_mm.x;
        Json request{{"type", "slice"}, {"id", ++id}, {"lossless", true}, {"size", {32, 32}}, {"window", {0, 400}}};
        request["plane"] = {
            {"centre", {middle.x, middle.y, middle.z}}, {"right", {step, 0, 0}}, {"down", {0, step, 0}}};
        request.update(more);
        page.send(request);
        const auto frame = page.find([](const Message& m) { return m.is_frame && m.json["kind"] == "slice"; });
        return frame ? frame->image : std::string();
    };
    const std::string plain = sent(Json::object());
    ASSERT_FALSE(plain.empty());
    EXPECT_NE(sent({{"labels", labels}, {"label_opacity", 0.5}}), plain);
    Json hidden = labels;
    hidden["changes"] = {{{"show", false}}};
    EXPECT_EQ(sent({{"labels", hidden}, {"label_opacity", 0.5}}), plain);
    EXPECT_EQ(page.ask({{"type", "labels"}})["sentence"], "labels: the scene has none");
    const Json outside = page.ask({{"type", "labels"}, {"labels", {{"file", "/etc/hostname"}}}});
    EXPECT_EQ(outside["sentence"], "/etc/hostname: lies outside the folders that the viewer was started with");
    const Json table =
        page.ask({{"type", "labels"}, {"labels", {{"file", "sample:organs"}, {"table", "/etc/passwd"}}}});
    EXPECT_EQ(table["sentence"], "/etc/passwd: lies outside the folders that the viewer was started with");
}

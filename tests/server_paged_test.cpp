// The viewer on a volume that does not fit: opened by bricks, refined where it is looked at, measured voxel by voxel.
#include <chiaro/view.h>
#include <gtest/gtest.h>

#include "server/json.h"
#include "server_case.h"

using namespace chiaro;
using namespace chiaro::testing;
using server::json_of;

namespace {

constexpr PagingSettings little{.memory_bytes = 36 << 20};
const std::string volume = "sample:shells:224";

/// The message that tells the volume.
Json opened(Page& page) {
    const auto told = page.find(
        [](const Message& m) { return !m.is_frame && m.json.contains("volume") && m.json["volume"].is_object(); });
    return told ? told->json : Json();
}

/// Of which the finest level's voxels are several pixels.
Json near(Json scene) {
    scene["camera"]["fit"] = "volume", scene["camera"]["fit_scale"] = 1.0 / 6;
    scene["sampling"]["interpolation"] = "linear";
    scene["lighting"] = {{"method", "none"}};
    return scene;
}

}  // namespace

TEST(ServerPaged, ShowsTheFinestLevelWhereItIsLookedAt) {
    const Server server(volume, false, little);
    Page page = server.page();
    Json message = opened(page);
    const Json told = message["volume"], scene = message["scene"];
    ASSERT_TRUE(told.is_object());
    EXPECT_EQ(told["dimensions"], Json({224, 224, 224}));
    EXPECT_EQ(told["statistics"], "sampled");
    EXPECT_EQ(told["levels"], Json({{224, 224, 224}, {112, 112, 112}, {56, 56, 56}}));
    EXPECT_TRUE(told["reduced"].is_null());

    page.send(state(1, near(scene), 80, 60));
    const auto last = page.of_stage(1, "final");
    ASSERT_TRUE(last);
    EXPECT_NE(last->json["notes"].dump().find("level 0 of 0 to 2 is drawn"), std::string::npos) << last->json;
    write_file(server.folder / "final.png", last->image);
    std::vector<std::string> unknown;
    Scene whole = parse_scene(near(scene).dump(), {}, {}, unknown);
    whole.width = 80, whole.height = 60;
    Session session(Device::cpu(2));
    Progress progress;
    session.show(make_sample("shells", 224), progress);
    EXPECT_EQ(read_png(server.folder / "final.png").pixels, session.render(whole, progress).pixels);

    const Json saved = page.ask({{"type", "save"}, {"scene", near(scene)}, {"size", {80, 60}}});
    ASSERT_EQ(saved["type"], "answer") << saved;
    const auto answer = http(server.port, "GET", saved["url"].get<std::string>(), "");
    write_file(server.folder / "saved.png", answer.body);
    EXPECT_EQ(read_png(server.folder / "saved.png").pixels, session.render(whole, progress).pixels);
}

TEST(ServerPaged, PlacesAndValuesAreThoseOfTheFinestLevel) {
    const Server server(volume, false, little);
    Json scene;
    Page page = server.ready(scene);
    const Volume shells = make_sample("shells", 224);
    const Json plane{{"centre", json_of(shells.geometry.world_from_voxel({111.5, 111.5, 100}))},
                     {"right", json_of(shells.geometry.world_from_voxel_vector({1, 0, 0}))},
                     {"down", json_of(shells.geometry.world_from_voxel_vector({0, 1, 0}))}};
    const Json slice = page.ask(
        {{"type", "slice"}, {"plane", plane}, {"size", {224, 224}}, {"values", true}, {"sampling", "nearest"}});
    ASSERT_EQ(slice["values"].size(), 224u * 224) << slice;
    for (std::size_t i = 0; i < 224 * 224; ++i)
        ASSERT_EQ(slice["values"][i], int(shells.as<std::uint8_t>()[100 * 224 * 224 + i])) << i;

    const Vec3 middle = shells.geometry.world_from_voxel({140, 100, 90});
    const Json region = page.ask({{"type", "region"}, {"shape", "ball"}, {"centre", json_of(middle)}, {"radius", 20}});
    ASSERT_EQ(region["type"], "answer") << region;
    Progress progress;
    const RegionValues values = measure(upload(Device::cpu(2), shells), BallRegion{middle, 20}, progress);
    EXPECT_EQ(region["count"], values.count);
    EXPECT_EQ(region["mean"], values.mean);

    page.send(state(1, near(scene), 80, 60));
    ASSERT_TRUE(page.of_stage(1, "final"));
    const Json picked = page.ask({{"type", "pick"}, {"x", 40}, {"y", 30}});
    ASSERT_EQ(picked["hit"], true) << picked;
    const Json& at = picked["world_mm"];
    const Vec3 voxel = shells.geometry.voxel_from_world({at[0], at[1], at[2]});
    for (int axis = 0; axis < 3; ++axis)
        EXPECT_NEAR(picked["voxel"][std::size_t(axis)].get<double>(), voxel[axis], 1e-9);
}

/// What does not fit in the memory that is free, where nothing is said; "half" takes an eighth of it.
TEST(ServerPaged, TheMemoryThatIsFreeDecides) {
    setenv("CHIARO_VIEW_MEMORY", "60", 1);  // MiB
    {
        const Server server(volume);
        Json scene;
        Page page = server.ready(scene);
        const Json half = page.ask({{"type", "open"}, {"half", true}});
        ASSERT_EQ(half["type"], "answer") << half;
        EXPECT_EQ(half["volume"]["dimensions"], Json({224, 224, 224}));
        EXPECT_EQ(half["volume"]["statistics"], "sampled");
        page.send(state(1, scene, 60, 40));
        EXPECT_TRUE(page.of_stage(1, "final"));
    }
    unsetenv("CHIARO_VIEW_MEMORY");
}

/// A program that has a source of bricks shows it, by a name of its own.
TEST(ServerPaged, OfAProgramWithASourceOfItsOwn) {
    ViewSettings settings;
    settings.scene = scene_of_volume("sample:shells:224");
    settings.source = open_sample("shells", 224);
    settings.paging = little;
    settings.device = Device::cpu(2);
    ViewServer server(settings);
    const std::string url = server.url();
    Page page(server.port(), url.substr(url.find("token=") + 6, 32), "view-one", "");
    Json message = opened(page);
    ASSERT_TRUE(message.is_object());
    EXPECT_EQ(message["volume"]["statistics"], "sampled");
    page.send(state(1, near(message["scene"]), 80, 60));
    const auto last = page.of_stage(1, "final");
    ASSERT_TRUE(last);
    EXPECT_NE(last->json["notes"].dump().find("level 0 of 0 to 2 is drawn"), std::string::npos) << last->json;
}

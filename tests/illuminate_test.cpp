// Fields: what a lighting method computes, from the library and from the tool.
#include <chiaro/describe.h>
#include <chiaro/error.h>
#include <chiaro/session.h>

#include <algorithm>
#include <cstring>

#include "fixtures.h"
#include "tool_case.h"

namespace {

using namespace chiaro;
using chiaro::testing::tested_device;
using chiaro::testing::two_materials;

constexpr const char* by_rays = "--lighting reference --reference-rays 8 ";

/// A ball in voxels twice as thick as wide.
Volume thick_ball() {
    Volume volume = chiaro::testing::sampled<std::uint8_t>(
        {20, 18, 9}, [](double x, double y, double z) { return std::hypot(x - 9, y - 9, 2 * (z - 4)) < 7 ? 200 : 0; });
    volume.geometry.spacing_mm = {1.5, 1.5, 3};
    volume.geometry.origin_mm = {-10, 20, 5};
    volume.geometry.world = World::lps;
    return volume;
}

ComputedField field_of(const Volume& volume, const IlluminationSettings& settings, const Shape& shape = {}) {
    Progress progress;
    const Device device = tested_device();
    const DeviceVolume voxels = upload(device, volume);
    return compute_field(device, classify(voxels, two_materials(), shape), prepare(voxels, settings, progress), {},
                         settings, progress);
}

IlluminationSettings reference(ReferenceSettings settings) {
    return {.method = Method::reference, .reference = settings};
}

TEST(ComputeField, LiesWhereTheVolumeLies) {
    const Volume volume = thick_ball();
    const ComputedField field = field_of(volume, reference({.rays = 64}));
    EXPECT_EQ(field.volume.dimensions, volume.dimensions);
    EXPECT_EQ(field.volume.geometry, volume.geometry);
    EXPECT_EQ(field.volume.type, VoxelType::f32);
    const auto access = field.volume.as<float>();
    const auto at = [&](int x, int y, int z) { return access[std::size_t((z * 18 + y) * 20 + x)]; };
    for (float a : access) ASSERT_TRUE(a >= 0 && a <= 1);
    EXPECT_LT(at(9, 9, 4), 0.05);  // deep inside
    EXPECT_GT(at(0, 0, 0), 0.9);   // every voxel is filled, also where nothing can be seen
    EXPECT_NEAR(at(1, 9, 4), at(17, 9, 4), 0.03);
    EXPECT_NEAR(at(9, 9, 0), at(9, 9, 8), 0.03);
}

TEST(IlluminateAgain, AnEditThatChangesNoVoxelsOpacityLeavesVisibility) {
    const Device device = tested_device();
    const DeviceVolume voxels = upload(device, thick_ball());
    IlluminationSettings settings{.method = Method::visibility};
    settings.visibility.subsample = 1;
    Progress progress;
    /// How many fields come, and whether V was swept for.
    const auto found = [&](const TransferFunction& tf, IlluminationField& field) {
        int fields = 0;
        const IlluminationField warm = field;
        const auto keep = [&](IlluminationField better) { field = std::move(better), ++fields; };
        illuminate(device, classify(voxels, tf, Shape{}), Prepared(), Lighting(), settings, keep, progress, warm);
        const bool swept = std::any_of(field.stages().begin(), field.stages().end(),
                                       [](const Stage& stage) { return stage.name == "visibility"; });
        return std::pair(fields, swept);
    };
    IlluminationField field;
    TransferFunction tf = two_materials();
    EXPECT_EQ(found(tf, field), std::pair(4, true));
    tf.points.push_back({250, {1, 1, 1}, tf.points.back().opacity});  // no voxel is above 200
    ASSERT_LT(tf.points[tf.points.size() - 2].value, 250);
    tf.points.push_back({251, {1, 1, 1}, 0.9});
    EXPECT_EQ(found(tf, field), std::pair(1, false));
    EXPECT_FALSE(field.is_coarse());
    settings.visibility.directions = 200;
    EXPECT_EQ(found(tf, field), std::pair(4, true)) << "it is asked for in another way";
    for (ControlPoint& point : tf.points) point.opacity *= 0.9;
    EXPECT_EQ(found(tf, field), std::pair(4, true));
}

TEST(ComputeField, TellsHowItWasMade) {
    const ComputedField field =
        field_of(thick_ball(), reference({.rays = 3, .quantity = ReferenceQuantity::ao_cosine}));
    const auto& told = field.volume.key_values;
    EXPECT_EQ(told.at("chiaro_lighting"), "reference");
    EXPECT_EQ(told.at("chiaro_reference_rays"), "3");
    EXPECT_EQ(told.at("chiaro_reference_quantity"), "ao-cosine");
    EXPECT_EQ(told.at("chiaro_reference_medium"), "voxels");
    EXPECT_GT(std::stod(told.at("chiaro_seconds")), 0);
    EXPECT_FALSE(told.contains("chiaro_spao_levels"));
    std::string names;
    for (const Stage& stage : field.stages) names += stage.name + " ";
    EXPECT_EQ(names, "opacity extinction rays voxels ");
}

TEST(ComputeField, IsNeitherMovedNorScaled) {
    // On an opaque plane half of all directions are open, in it few; a picture shows 1 for both.
    const Volume ground =
        chiaro::testing::sampled<std::uint8_t>({40, 40, 8}, [](double, double, double z) { return z < 4 ? 220 : 0; });
    const ComputedField field = field_of(ground, reference({.rays = 512}), {.opacity_scale = 100});
    EXPECT_NEAR(field.volume.as<float>()[(4 * 40 + 20) * 40 + 20], 0.5, 0.03);
    EXPECT_NEAR(field.volume.as<float>()[(3 * 40 + 20) * 40 + 20], 1 / 6.0, 0.03);
}

TEST(ComputeField, RefusesWhatHasNoField) {
    const auto sentence = [](const IlluminationSettings& settings, const Shape& shape) -> std::string {
        try {
            field_of(thick_ball(), settings, shape);
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), ErrorCode::usage);
            return error.what();
        }
        return "";
    };
    EXPECT_NE(sentence({}, {}).find("lighting method none computes no field"), std::string::npos);
    EXPECT_NE(sentence(reference({}), {.mode = Mode::mip}).find("value of a whole ray"), std::string::npos);
}

TEST(ComputeField, ASessionGivesTheSame) {
    Progress progress;
    Session session(tested_device());
    session.show(thick_ball(), progress);
    Scene scene;
    scene.interpolation = Interpolation::linear;
    scene.illumination = reference({.rays = 8});
    scene.transfer.points = two_materials();
    const ComputedField field = session.compute_field(scene, progress);
    const ComputedField direct = field_of(thick_ball(), scene.illumination);
    EXPECT_EQ(std::memcmp(field.volume.voxels.data(), direct.volume.voxels.data(), field.volume.voxels.size()), 0);
    std::string names;
    for (const Stage& stage : session.stages()) names += stage.name + " ";
    EXPECT_EQ(names, "measure upload prepare classify illuminate opacity extinction rays voxels ");
    session.render(scene, progress);
    EXPECT_EQ(session.stages()[3].seconds, 0) << "classified already";
    Progress cancelled;
    cancelled.cancel();
    EXPECT_THROW(session.compute_field(scene, cancelled), Error);
}

TEST(SessionStages, TellTheStepsOfTheLight) {
    Progress progress;
    Session session(tested_device());
    session.show(make_sample("ball", 24), progress);
    Scene scene;
    scene.volume = "sample:ball:24", scene.width = 40, scene.height = 30;
    scene.interpolation = Interpolation::linear;
    scene.camera.fit = Fit::volume;
    scene.illumination = reference({.rays = 8, .quantity = ReferenceQuantity::obscurance});
    const auto told = [&] {
        session.render(scene, progress);
        std::string names;
        for (const Stage& stage : session.stages()) names += stage.name + (stage.seconds > 0 ? "* " : " ");
        return names.substr(names.find("classify"));
    };
    EXPECT_EQ(told(), "classify* illuminate* opacity* extinction* rays* surfaces* raycast* develop* ");
    scene.camera.azimuth_deg += 10;
    EXPECT_EQ(told(), "classify illuminate opacity extinction rays surfaces raycast* develop* ");
}

using Illuminate = ToolTest;

TEST_F(Illuminate, WritesTheFieldOfTheLibrary) {
    write_nrrd(thick_ball(), folder / "ball.nrrd", NrrdEncoding::raw);
    write("tf.json", to_json(two_materials()));
    const std::string line = std::string("illuminate ball.nrrd --interpolation linear --transfer tf.json ") + by_rays;
    const Said said = tool(line + "-o f.nrrd --stats s.json --quiet");
    ASSERT_EQ(said.code, 0) << said.err;
    EXPECT_EQ(said.err + said.out, "");
    EXPECT_EQ(tool(line + "-o g.nrrd --encoding gzip --threads 1 --isa scalar").code, 0);
    EXPECT_EQ(tool("compare f.nrrd g.nrrd --fail-above max=0").code, 0);

    Progress progress;
    const Volume written = read_volume((folder / "f.nrrd").string(), {}, progress);
    const Volume direct = field_of(thick_ball(), reference({.rays = 8})).volume;
    ASSERT_EQ(written.dimensions, direct.dimensions);
    EXPECT_EQ(written.geometry, direct.geometry);
    EXPECT_EQ(std::memcmp(written.voxels.data(), direct.voxels.data(), direct.voxels.size()), 0);
    EXPECT_EQ(written.key_values.at("chiaro_lighting"), "reference");
    EXPECT_EQ(written.key_values.at("chiaro_reference_rays"), "8");
    EXPECT_TRUE(written.key_values.contains("chiaro_seconds"));
    const auto scene = nlohmann::json::parse(written.key_values.at("chiaro_scene"));
    EXPECT_EQ(scene["volume"]["file"], "ball.nrrd");

    std::string names;
    const auto stats = json("s.json");
    for (const auto& stage : stats["stages"]) names += stage["name"].get<std::string>() + " ";
    EXPECT_EQ(names, "read measure upload prepare classify illuminate opacity extinction rays voxels write ");
}

TEST_F(Illuminate, TakesScenesAndModes) {
    write("s.json", R"({"volume": {"file": "sample:ball:16"}, "lighting": {"method": "reference", "rays": 8}})");
    EXPECT_EQ(tool("illuminate --scene s.json -o a.nrrd").code, 0);
    EXPECT_EQ(tool("illuminate --scene s.json -o b.nrrd --reference-rays 9").code, 0);
    EXPECT_NE(read("a.nrrd"), read("b.nrrd"));
    EXPECT_EQ(tool("illuminate --scene s.json -o c.nrrd --mode iso --iso 100 --clip-box 0,1,0,1,0,0.5").code, 0);
    EXPECT_EQ(tool("illuminate --scene s.json -o d.nrrd --verbose").code, 0);
    EXPECT_EQ(tool("compare a.nrrd d.nrrd --fail-above max=0").code, 0);
    EXPECT_EQ(tool("compare a.nrrd c.nrrd --fail-above max=0").code, 5);
}

TEST_F(Illuminate, RefusesInOneLine) {
    struct Case {
        const char* arguments;
        int code;
        const char* message;
    };
    const Case cases[] = {
        {"illuminate --lighting reference -o f.nrrd", 2, "give either a VOLUME or --scene FILE"},
        {"illuminate sample:ball:16 --lighting none -o f.nrrd", 2, "--lighting none computes no field"},
        {"illuminate sample:ball:16 --lighting referense -o f.nrrd", 2, "did you mean 'reference'?"},
        {"illuminate sample:ball:16 --lighting reference", 2, "-o FILE is missing"},
        {"illuminate sample:ball:16 --lighting reference -o f.png", 2, "f.png: the name must end in .nrrd"},
        {"illuminate sample:ball:16 --lighting reference -o no/f.nrrd", 4, "there is no folder no"},
        {"illuminate sample:ball:16 --lighting reference -o f.nrrd --mode mip", 2,
         "--mode mip: a value of a whole ray"},
        {"illuminate sample:ball:16 --lighting reference -o f.nrrd --mode iso", 2, "give --iso VALUE"},
        {"illuminate sample:ball:16 --lighting reference -o f.nrrd --encoding zip", 2, "must be raw, gzip"},
        {"illuminate sample:ball:16 --lighting reference -o f.nrrd --azimuth 5", 2, "unknown option '--azimuth'"},
        {"illuminate sample:ball:16 --lighting reference -o f.nrrd --reference-rays 0", 2, "must be 1 to 65536"},
        {"illuminate sample:ball:16 --lighting reference -o f.nrrd --stats no/s.json", 4, "there is no folder no"},
        {"illuminate none.nrrd --lighting reference -o f.nrrd", 3, "none.nrrd"},
    };
    for (const auto& [arguments, code, message] : cases) {
        const Said said = tool(arguments);
        EXPECT_EQ(said.code, code) << arguments << "\n" << said.err;
        EXPECT_NE(said.err.find(message), said.err.npos) << arguments << "\n" << said.err;
        EXPECT_EQ(std::count(said.err.begin(), said.err.end(), '\n'), 1) << arguments << "\n" << said.err;
        EXPECT_EQ(files(), "") << arguments;
    }
}

TEST_F(Illuminate, AnInterruptLeavesNothingHalfWritten) {
    using namespace std::chrono_literals;
    const std::string endless = "illuminate sample:fog:64 --lighting reference --reference-rays 65536 -o f.nrrd";
    write("f.nrrd", "the field before");
    const Said said = tool(endless, SIGINT, 500ms);
    EXPECT_EQ(said.code, 130);
    EXPECT_EQ(said.err, "chiaro: interrupted\n");
    EXPECT_EQ(read("f.nrrd"), "the field before");
    EXPECT_EQ(files(), "f.nrrd");
}

}  // namespace

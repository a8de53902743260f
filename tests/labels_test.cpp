// Label tables of other programs, and volumes of labels. Every file here was written for these tests.
#include <chiaro/error.h>
#include <chiaro/labels.h>

#include "tool_case.h"
#include "volume_files.h"

using namespace chiaro;
using volume_files::Folder;

namespace {

std::string refusal(const std::function<void()>& call) {
    try {
        call();
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::input);
        return error.what();
    }
    return "no refusal";
}
std::string refused(const std::string& text, const std::string& name) {
    return refusal([&] { parse_label_table(text, name); });
}
Rgb bytes(int r, int g, int b) { return {r / 255.0, g / 255.0, b / 255.0}; }

Volume volume_of(std::array<int, 3> dimensions, const std::vector<int>& values, VoxelType type = VoxelType::u8) {
    Volume volume = make_volume(dimensions, type);
    volume.source = "organs";
    with_voxel_type(type, [&](auto zero) {
        const auto out = volume.as<decltype(zero)>();
        for (std::size_t i = 0; i < out.size(); ++i) out[i] = decltype(zero)(values[i % values.size()]);
    });
    return volume;
}
LabelVolume labels_of(const Volume& volume, const LabelTable* table = nullptr) {
    Progress progress;
    return make_labels(volume, table, progress);
}

}  // namespace

TEST(LabelTables, OursHasAllThatIsShown) {
    const LabelTable table = parse_label_table(
        R"({"labels": [{"value": 7, "name": "right", "rgb": [0, 0.5, 1], "tint": 0.25, "opacity": 0.5, "show": false},
                       {"value": 1, "name": "left"}, {"value": 0, "show": false}]})",
        "own.json");
    EXPECT_EQ(table.format, "Chiaro");
    ASSERT_EQ(table.labels.size(), 3);
    EXPECT_FALSE(table.labels[0].show);  // our own tables may hide what no structure has
    EXPECT_EQ(table.labels[0].tint, 0);
    EXPECT_EQ(table.labels[1].name, "left");
    EXPECT_EQ(table.labels[1].tint, 1);
    EXPECT_EQ(table.labels[2], (Label{7, "right", {0, 0.5, 1}, 0.25, 0.5, false}));
    const Label own = parse_label_table(
                          R"({"labels": [{"value": 1, "transfer_function": {"points": [
                              {"value": 0, "rgb": [1, 0, 0], "opacity": 0}, {"value": 9, "rgb": [1, 0, 0], "opacity": 1}]}}]})",
                          "own.json")
                          .labels[0];
    ASSERT_TRUE(own.transfer);
    EXPECT_EQ(own.transfer->points[1].value, 9);
    EXPECT_EQ(own.tint, 0);  // its colours are the function's
    EXPECT_NE(refused(R"({"labels": [{"value": 1, "transfer_function": {"points": []}}]})", "a.json").find("labels[0]"),
              std::string::npos);
}

TEST(LabelTables, OursIsRefusedInASentence) {
    EXPECT_EQ(refused(R"({"labels": [{"name": "a"}]})", "a.json"), "a.json: labels[0] lacks 'value'");
    EXPECT_EQ(refused(R"({"labels": [{"value": 1.5}]})", "a.json"),
              "a.json: labels[0].value is 1.5: must be a whole number from 0 to 4294967295");
    EXPECT_EQ(refused(R"({"labels": [{"value": 1, "opacity": 2}]})", "a.json"),
              "a.json: labels[0].opacity is 2: must be in [0, 1]");
    EXPECT_EQ(refused(R"({"labels": [{"value": 1, "colour": 2}]})", "a.json"),
              "a.json: labels[0] has unknown key 'colour'");
    EXPECT_EQ(refused(R"({"labels": [{"value": 1}, {"value": 1}]})", "a.json"), "a.json: states the label 1 twice");
    EXPECT_EQ(refused(R"({"labels": []})", "a.json"), "a.json: holds no label");
    EXPECT_TRUE(refused(R"({"labels": [)", "a.json").starts_with("a.json: is not JSON"));
}

TEST(LabelTables, ListsOfClasses) {
    for (const char* text : {R"({"labels": {"background": 0, "spleen": 1, "liver": 5}, "file_ending": ".nii.gz"})",
                             R"({"labels": {"0": "background", "1": "spleen", "5": "liver"}})"}) {
        const LabelTable table = parse_label_table(text, "dataset.json");
        ASSERT_EQ(table.labels.size(), 3) << text;
        EXPECT_EQ(table.labels[2].value, 5);
        EXPECT_EQ(table.labels[2].name, "liver");
        EXPECT_NE(table.labels[1].rgb, table.labels[2].rgb);
    }
}

TEST(LabelTables, ItkSnap) {
    const LabelTable table = parse_label_table(
        "################################################\n# IDX   -R-  -G-  -B-  -A--  VIS MSH  LABEL\n\n"
        "    0     0    0    0        0  0  0    \"Clear Label\"\n"
        "    3   255   51    0      0.5  1  1    \"left # ventricle (LV)\"\r\n"
        "\n    1     0  102  255        1  0  1    \"aorta\"   # a comment\n",
        "heart.label");
    EXPECT_EQ(table.format, "ITK-SNAP");
    ASSERT_EQ(table.labels.size(), 3);
    EXPECT_TRUE(table.labels[0].show);  // what is no structure is shown as without labels
    EXPECT_EQ(table.labels[0].tint, 0);
    EXPECT_EQ(table.labels[1], (Label{1, "aorta", bytes(0, 102, 255), 1, 1, false}));
    EXPECT_EQ(table.labels[2], (Label{3, "left # ventricle (LV)", bytes(255, 51, 0), 0.5, 1, true}));
    EXPECT_EQ(parse_label_table("1 2 3 4 1 1 1 \"a\"\n", "labels.txt").format, "ITK-SNAP");
    EXPECT_EQ(parse_label_table("1 2 3 4 255 1 1 \"a\"\n", "labels.txt").labels[0].tint, 1);
    EXPECT_EQ(refused("1 2 3 4 1 1 1 \"a\n", "a.label"), "a.label: line 1 begins a name with \" that it does not end");
    EXPECT_EQ(refused("1 2 3\n", "a.label"), "a.label: line 1 has 3 words: must have IDX R G B A VIS MSH and a name");
    EXPECT_EQ(refused("# x\n1 2 300 4 1 1 1 \"a\"\n", "a.label"),
              "a.label: line 2 has the green '300': must be a number in [0, 255]");
    EXPECT_EQ(refused("-1 2 3 4 1 1 1 \"a\"\n", "a.label"),
              "a.label: line 1 has the label '-1': must be a whole number from 0 to 4294967295");
}

TEST(LabelTables, SlicerColorTable) {
    const LabelTable table = parse_label_table(
        "# Color table file /tmp/organs.ctbl\n# 3 values\n0 background 0 0 0 0\n"
        "1 right_kidney 185 102 83 255\n\n2 \"vena_cava inf\" 0 151 206 51\n",
        "organs.ctbl");
    EXPECT_EQ(table.format, "3D Slicer");
    ASSERT_EQ(table.labels.size(), 3);
    EXPECT_EQ(table.labels[1], (Label{1, "right kidney", bytes(185, 102, 83), 1, 1, true}));
    EXPECT_EQ(table.labels[2], (Label{2, "vena_cava inf", bytes(0, 151, 206), 0.2, 1, true}));
}

TEST(LabelTables, FreeSurferAlphaIsTransparency) {
    const LabelTable table = parse_label_table(
        "#$Id: FreeSurferColorLUT.txt $\n#No. Label Name:                R   G   B   A\n\n"
        "0   Unknown                     0   0   0   0\n"
        "17  Left-Hippocampus            220 216 20  0\n18  Left-Amygdala 103 255 255 255\n",
        "FreeSurferColorLUT.txt");
    EXPECT_EQ(table.format, "FreeSurfer");
    ASSERT_EQ(table.labels.size(), 3);
    EXPECT_EQ(table.labels[1], (Label{17, "Left-Hippocampus", bytes(220, 216, 20), 1, 1, true}));
    EXPECT_EQ(table.labels[2].tint, 0);
    EXPECT_EQ(refused("17 Left-Hippocampus 300 216 20 0\n", "lut.txt"),
              "lut.txt: line 1 has the red '300': must be a number in [0, 255]");
    EXPECT_EQ(refused(" \n", "lut.txt"), "lut.txt: is empty");
    EXPECT_EQ(refused("# nothing\n", "lut.txt"), "lut.txt: holds no label");
}

TEST(LabelTables, TotalSegmentator) {
    const LabelTable table = read_label_table("totalsegmentator");
    ASSERT_EQ(table.labels.size(), 117);
    const std::map<std::uint32_t, std::string> known{
        {1, "spleen"},        {5, "liver"},       {26, "vertebrae_S1"},  {31, "vertebrae_L1"},
        {50, "vertebrae_C1"}, {51, "heart"},      {69, "humerus_left"},  {79, "spinal_cord"},
        {90, "brain"},        {92, "rib_left_1"}, {115, "rib_right_12"}, {117, "costal_cartilages"}};
    for (const auto& [value, name] : known) EXPECT_EQ(table.labels[value - 1].name, name) << value;
    EXPECT_EQ(refusal([] { read_label_table("totalsegmentatr"); }),
              "cannot read 'totalsegmentatr': no such file; did you mean 'totalsegmentator'?");
}

TEST(LabelTables, AnyBytesGiveATableOrASentence) {
    const std::vector<std::pair<std::string, std::string>> good{
        {R"({"labels": [{"value": 1, "name": "a", "rgb": [1, 0, 0]}]})", "a.json"},
        {"1 2 3 4 1 1 1 \"a\"\n", "a.label"},
        {"1 right_kidney 185 102 83 255\n", "a.ctbl"},
        {"NRRD0004\nSegment0_Name:=a\nSegment0_Color:=1 0 0\nSegment0_LabelValue:=1\n\n", "a.seg.nrrd"}};
    for (const auto& [text, name] : good)
        for (std::size_t i = 0; i < text.size(); ++i)
            for (const char c : {'\0', '\xff', '"', '9', '-', '\n'}) {
                std::string bad = text;
                bad[i] = c;
                try {
                    parse_label_table(bad, name);
                } catch (const Error& error) {
                    EXPECT_EQ(error.code(), ErrorCode::input);
                    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
                }
            }
}

TEST(Labels, AreNumberedByValueWhateverTheirType) {
    for (const VoxelType type : {VoxelType::u8, VoxelType::i8, VoxelType::u16, VoxelType::i16, VoxelType::u32,
                                 VoxelType::i32, VoxelType::u64, VoxelType::i64, VoxelType::f32, VoxelType::f64}) {
        const LabelVolume labels = labels_of(volume_of({4, 2, 1}, {0, 0, 100, 7, 7, 7, 0, 100}, type));
        ASSERT_EQ(labels.labels.size(), 3) << name_of(type);
        EXPECT_EQ(labels.labels[1].value, 7);
        EXPECT_EQ(labels.labels[2].name, "label 100");
        EXPECT_EQ(labels.counts, (std::vector<std::uint64_t>{3, 3, 2}));
        const auto n = labels.numbers();
        EXPECT_EQ(std::vector<int>(n.begin(), n.end()), (std::vector<int>{0, 0, 2, 1, 1, 1, 0, 2}));
    }
}

TEST(Labels, WhatIsNoneIsASentence) {
    Volume halves = volume_of({2, 1, 1}, {1, 3}, VoxelType::f32);
    halves.slope = 0.5;
    EXPECT_EQ(refusal([&] { labels_of(halves); }),
              "organs: holds 0.5, which is no label: labels are whole numbers from 0 to 4294967295");
    EXPECT_EQ(refusal([] {
                  labels_of(volume_of({2, 1, 1}, {1, -3}, VoxelType::i16));
              }),
              "organs: holds -3, which is no label: labels are whole numbers from 0 to 4294967295");
    Volume nan = volume_of({2, 1, 1}, {0}, VoxelType::f32);
    nan.as<float>()[1] = NAN;
    EXPECT_TRUE(refusal([&] { labels_of(nan); }).starts_with("organs: holds nan, which is no label"));
}

TEST(Labels, SixtyFiveThousand) {
    std::vector<int> values(65536);
    for (int i = 0; i < 65536; ++i) values[std::size_t(i)] = 3 * i;
    Volume most = volume_of({256, 256, 1}, values, VoxelType::u32);
    const LabelVolume labels = labels_of(most);
    EXPECT_EQ(labels.labels.size(), 65536);
    EXPECT_EQ(labels.labels.back().value, 3 * 65535);
    EXPECT_EQ(labels.numbers()[65535], 65535);
    most.as<std::uint32_t>()[0] = 1;  // one more, and no 0
    EXPECT_EQ(refusal([&] { labels_of(most); }), "organs: holds more than 65535 labels");
}

TEST(Labels, SegmentsOfSlicerWithOverlap) {
    const Folder folder;
    const std::string header =
        "NRRD0004\ntype: unsigned char\ndimension: 4\nspace: left-posterior-superior\nsizes: 2 2 2 1\n"
        "space directions: none (1,0,0) (0,1,0) (0,0,1)\nkinds: list domain domain domain\nencoding: raw\n"
        "space origin: (0,0,0)\n"
        "Segment0_Name:=Head\nSegment0_Color:=0.5 0.25 0\nSegment0_LabelValue:=1\nSegment0_Layer:=0\n"
        "Segment1_Name:=Mass, left\nSegment1_Color:=0 1 0\nSegment1_LabelValue:=1\nSegment1_Layer:=1\n"
        "Segment2_Name:=Eye\nSegment2_LabelValue:=2\nSegment2_Layer:=0\n\n";
    const std::string file = folder.write("a.seg.nrrd", header + std::string("\x01\x00\x01\x01\x02\x01\x00\x00", 8));
    Progress progress;
    const LabelVolume labels = read_labels(file, "", {}, progress);
    const auto n = labels.numbers();
    EXPECT_EQ(std::vector<int>(n.begin(), n.end()), (std::vector<int>{1, 2, 3, 0}));  // Eye is listed after Mass
    ASSERT_EQ(labels.labels.size(), 4);
    EXPECT_EQ(labels.labels[1].name, "Head");
    EXPECT_EQ(labels.labels[1].rgb, (Rgb{0.5, 0.25, 0}));
    EXPECT_EQ(labels.labels[2].name, "Mass, left");
    ASSERT_EQ(labels.notes.size(), 1);
    EXPECT_EQ(labels.notes[0],
              "its segments lie in 2 layers: their labels are 1 to 3, in the order of the list; in 2 voxels segments "
              "overlap, and the last listed one is shown");
    EXPECT_EQ(refusal([&] { read_label_table(file); }),
              file + ": has segments in several layers: it names those of its own voxels only");
}

TEST(Labels, FramesComeTogether) {
    Volume ct = volume_of({8, 8, 8}, {0});
    ct.geometry.world = World::lps, ct.geometry.origin_mm = {-10, -20, 5};
    Volume organs = volume_of({4, 4, 4}, {0, 1});
    organs.geometry = {{2, 2, 2}, {9.5, 19.5, 5.5}, {{{-1, 0, 0}, {0, -1, 0}, {0, 0, 1}}}, World::ras};
    const LabelPlacement placed = place_labels(labels_of(organs), ct.dimensions, ct.geometry);
    EXPECT_FALSE(placed.is_same_grid);
    for (int axis = 0; axis < 3; ++axis) {
        EXPECT_NEAR(placed.offset[axis], -0.25, 1e-12);
        EXPECT_NEAR(placed.axes[std::size_t(axis)][axis], 0.5, 1e-12);
    }
    organs.geometry.world = World::unknown;
    EXPECT_EQ(
        refusal([&] { place_labels(labels_of(organs), ct.dimensions, ct.geometry); }),
        "organs: its labels lie in no known frame, the volume in a known one: only where both have as many voxels "
        "do they belong together without a frame");
    organs.geometry.world = World::ras, organs.geometry.origin_mm = {500, 0, 0};
    EXPECT_EQ(refusal([&] { place_labels(labels_of(organs), ct.dimensions, ct.geometry); }),
              "organs: its labels lie beside the volume: the two are not of the same frame");
    const LabelVolume same = labels_of(volume_of({8, 8, 8}, {0, 1}));
    EXPECT_TRUE(place_labels(same, ct.dimensions, ct.geometry).is_same_grid);
}

TEST_F(ToolTest, InfoListsLabels) {
    write("table.json", R"({"labels": [{"value": 200, "name": "sphere", "rgb": [0, 0, 1], "show": false}]})");
    const Said said = tool("info sample:cornell:32 --label-table table.json");
    EXPECT_EQ(said.code, 0) << said.err;
    EXPECT_NE(said.out.find("#0000ff"), std::string::npos) << said.out;
    EXPECT_NE(said.out.find("sphere (not shown)"), std::string::npos) << said.out;
    EXPECT_NE(said.out.find("labels have no name in the table"), std::string::npos) << said.out;
    const auto json = nlohmann::json::parse(tool("info sample:ball:16 --labels sample:cornell:16 --json").out);
    std::uint64_t voxels = 0;
    for (const auto& label : json["labels"]) voxels += label["voxels"].get<std::uint64_t>();
    EXPECT_EQ(voxels, 16 * 16 * 16);
    const Said none = tool("info sample:ball:16 --labels sample:fog:16");
    EXPECT_EQ(none.code, 3);
    EXPECT_NE(none.err.find("which is no label"), std::string::npos) << none.err;
}

TEST(Labels, ChangesAreMadeOneAfterTheOther) {
    const std::vector<Label> labels{{.value = 0, .tint = 0}, {.value = 3}, {.value = 9}};
    const auto changed = with_changes(labels, {{.show = false}, {.value = 9, .tint = 0.5, .show = true}, {.value = 4}});
    EXPECT_EQ(changed[0], labels[0]) << "0 is no structure: it is named where it is meant";
    EXPECT_FALSE(changed[1].show);
    EXPECT_EQ(changed[2], (Label{.value = 9, .tint = 0.5}));
    EXPECT_FALSE(with_changes(labels, {{.value = 0, .show = false}})[0].show);
}

TEST(Labels, ChangesOfASceneAreRefusedInASentence) {
    const auto told = [](const std::string& changes) {
        std::vector<std::string> unknown;
        const std::string labels = R"("labels": {"file": "sample:organs", "changes": )" + changes + "}}";
        return refusal([&] { parse_scene(R"({"volume": {"file": "sample:torso"}, )" + labels, {}, {}, unknown); });
    };
    EXPECT_EQ(told("{}"), "labels.changes: must be a list of at most 65535");
    EXPECT_EQ(told("[{}, 3]"), "labels.changes[1]: must be an object");
    EXPECT_EQ(told(R"([{"value": -1}])"), "labels.changes[0]: value: must be a whole number from 0 to 4294967295");
    EXPECT_EQ(told(R"([{"tint": 1.5}])"), "labels.changes[0]: tint: must be from 0 to 1");
    EXPECT_EQ(told(R"([{"rgb": [1, 2]}])"), "labels.changes[0]: rgb: must be three numbers");
    EXPECT_EQ(told(R"([{"show": 1}])"), "labels.changes[0]: show: must be true or false");
    std::vector<std::string> unknown;
    EXPECT_EQ(refusal([&] {
                  parse_scene(R"({"volume": {"file": "sample:torso"}, "labels": {"changes": [{"value": 1}]}})", {}, {},
                              unknown);
              }),
              "labels.changes: there are no labels that could be changed (labels.file)");
}

// Transfer functions of other programs through the tool: render, convert, scenes.
#include "tool_case.h"

namespace {

class TransferTool : public ToolTest {
protected:
    void SetUp() override {
        ToolTest::SetUp();
        write("maps.json", R"([{"Name": "Cold", "RGBPoints": [0, 0, 0, 1, 255, 1, 1, 1]},
                               {"Name": "Warm", "RGBPoints": [0, 1, 0, 0, 255, 1, 1, 1],},])");
        write("ct.vp", "1\n0\n0\n0\n0\n0\n4 0 0 255 0.5\n2 0 1\n8 0 1 0 0 255 1 1 1\n");
        write("a.itf",
              "<InviwoWorkspace><Points><Point><pos content=\"0.5\"/><rgba x=\"1\" y=\"0\" z=\"0\" w=\"0.5\"/></Point>"
              "</Points></InviwoWorkspace>");
        write("a.tfi",
              "<VoreenData><T><domain x=\"0\" y=\"255\"/><Keys><key><intensity value=\"0\"/><split value=\"false\"/>"
              "<colorL r=\"255\" g=\"0\" b=\"0\" a=\"99\"/></key></Keys></T></VoreenData>");
    }
    std::string render(const std::string& transfer) {
        return "render sample:ball:16 --size 32x32 --lighting none --transfer " + transfer;
    }
};

}  // namespace

TEST_F(TransferTool, RendersWithEach) {
    for (const char* file : {"maps.json", "maps.json#Warm", "ct.vp", "a.itf", "a.tfi"}) {
        const Said said = tool(render(file) + " -o a.png");
        EXPECT_EQ(said.code, 0) << file << said.err;
    }
    const Said said = tool(render("maps.json") + " -o a.png");
    EXPECT_NE(said.err.find("maps.json: holds 2 colour maps: took 'Cold'"), said.err.npos) << said.err;
    EXPECT_EQ(tool(render("maps.json") + " -o a.png --quiet").err, "");
    const Said wrong = tool(render("maps.json#Wram") + " -o b.png");
    EXPECT_EQ(wrong.code, 3);
    EXPECT_EQ(wrong.err, "chiaro: maps.json: has no function 'Wram'; did you mean 'Warm'?\n");
    EXPECT_EQ(tool(render("none.vp") + " -o b.png").code, 3);
}

TEST_F(TransferTool, ConvertsToBothAndBack) {
    EXPECT_EQ(tool("convert ct.vp own.json").code, 0);
    EXPECT_EQ(json("own.json")["opacity_unit_mm"], 1.0);
    EXPECT_EQ(tool("convert own.json map.paraview.json").code, 0);
    EXPECT_EQ(json("map.paraview.json")[0]["RGBPoints"], nlohmann::json({0, 1, 0, 0, 255, 1, 1, 1}));
    EXPECT_EQ(tool("convert map.paraview.json --to chiaro again.json").code, 0);
    EXPECT_EQ(json("again.json"), json("own.json"));
    EXPECT_EQ(tool("convert ct-bone bone.json --to paraview").code, 0);
    EXPECT_TRUE(json("bone.json").is_array());
    EXPECT_EQ(tool("convert ct-bone bone.json --to vtk").code, 2);
    EXPECT_NE(tool("--list-formats").out.find("3D Slicer"), std::string::npos);
}

TEST_F(TransferTool, GivesTheSameImageConverted) {
    tool("convert maps.json#Warm own.json");
    EXPECT_EQ(tool(render("maps.json#2") + " -o a.exr").code, 0);
    EXPECT_EQ(tool(render("own.json") + " -o b.exr").code, 0);
    EXPECT_EQ(tool("compare a.exr b.exr --fail-above max=0").code, 0);
}

TEST_F(TransferTool, ScenesNameOneOfSeveral) {
    std::filesystem::create_directory(folder / "below");
    EXPECT_EQ(tool(render("maps.json#Warm") + " -o below/a.png").code, 0);
    EXPECT_EQ(tool("render --scene below/a.png -o b.png").code, 0);
    EXPECT_EQ(tool("compare below/a.png b.png --fail-above max=0").code, 0);
    write("below/scene.json",
          R"({"chiaro": 1, "volume": {"file": "sample:ball:16"}, "transfer_function": {"file": "../maps.json#Warm"}})");
    EXPECT_EQ(tool("render --scene below/scene.json --size 16x16 -o c.png").code, 0);
}

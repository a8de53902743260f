// Every name that can be mistyped: the tool says which one was meant.
#include "tool_case.h"

#include <chiaro/chiaro.h>

namespace {

using DidYouMean = ToolTest;

TEST_F(DidYouMean, EveryNameThatCanBeMistyped) {
    write("bonsai.json", R"({"volume": {"file": "sample:ball:8"}, "transfer_function": {"preset": "grey"}})");
    write("glow.txt", "1 2\n");
    write("key.json", R"({"volume": {"file": "sample:ball:8"}, "camera": {"azimuth_dge": 3}})");
    write("value.json", R"({"volume": {"file": "sample:ball:8"}, "lighting": {"method": "visibilty"}})");
    write("point.json", R"({"points": [{"value": 1, "rbg": [0, 0, 0], "opacity": 1}]})");
    write("head.nhdr", "NRRD0004\n");
    const std::string render = "render sample:ball:8 --size 8x8 -o p.png ";
    struct Case {
        std::string arguments;
        int code;
        const char* meant;
    };
    const Case cases[] = {
        {"rendr", 2, "render"},
        {"--versoin", 2, "--version"},
        {render + "--elevaton 3", 2, "--elevation"},
        {"info sample:bal", 2, "ball"},
        {"info sample:ball:8 --raw-type unit8", 2, "uint8"},
        {"info haed.nhdr", 3, "head.nhdr"},
        {"render sample:ball:8 -o p.pgn", 2, ".png"},
        {"convert sample:ball:8 a.nrdr", 2, ".nrrd"},
        {"convert sample:ball:8 a.nrrd --encoding gzp", 2, "gzip"},
        {render + "--transfer virids", 2, "viridis"},
        {render + "--transfer virids_r", 2, "viridis_r"},
        {render + "--transfer ct-bnoe", 2, "ct-bone"},
        {render + "--transfer ./pont.json", 3, "point.json"},
        {render + "--transfer point.json", 3, "rgb"},
        {render + "--lighting refrence", 2, "reference"},
        {render + "--spao-filter mimap", 2, "mipmap"},
        {render + "--hist-effects ao,bleding", 2, "bleeding"},
        {render + "--classification pots", 2, "post"},
        {render + "--background tomatoe", 2, "tomato"},
        {render + "--mode iso --iso 3,gren", 2, "green"},
        {render + "--probe stduio", 2, "studio"},
        {render + "--probe ./bonsia.json", 3, "bonsai.json"},
        {render + "--lighting histogram --hist-effects glow --glow glwo.txt", 3, "glow.txt"},
        {render + "--device cpuu", 2, "cpu"},
        {render + "--progress allways", 2, "always"},
        {render + "--isa sclar", 2, "scalar"},
        {"render --scene bonsia.json -o p.png", 3, "bonsai.json"},
        {"render --scene value.json -o p.png", 3, "visibility"},
        {"compare p.png p.png --fail-above rsme=1", 2, "rmse"},
        {"compare sample:ball:8 --methods spoa", 2, "spao"},
        {"bench pipelin", 2, "pipeline"},
    };
    ASSERT_EQ(tool(render).code, 0);
    for (const auto& [arguments, code, meant] : cases) {
        const Said said = tool(arguments);
        EXPECT_EQ(said.code, code) << arguments << "\n" << said.err;
        EXPECT_NE(said.err.find(std::string("did you mean '") + meant + "'?"), said.err.npos) << arguments << "\n"
                                                                                              << said.err;
    }
    const Said key = tool("render --scene key.json -o p.png --size 8x8");
    EXPECT_EQ(key.err, "chiaro: key.json: unknown key camera.azimuth_dge; did you mean 'azimuth_deg'?\n");
}

TEST_F(DidYouMean, NothingWhereNothingIsNear) {
    for (const char* arguments : {"info quite-another.nrrd", "render sample:ball -o p.png --transfer xylophone"})
        EXPECT_EQ(tool(arguments).err.find("did you mean"), std::string::npos) << arguments;
}

}  // namespace

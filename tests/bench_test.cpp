// chiaro bench as a script sees it, and the arithmetic of what it tells.
#include "tool_case.h"

namespace {

class Bench : public ToolTest {
protected:
    /// The rows of a quick run.
    nlohmann::json rows(const std::string& arguments) {
        const Said said = tool("bench --quick --json found.json " + arguments);
        EXPECT_EQ(said.code, 0) << said.err;
        return said.code == 0 ? json("found.json").at("rows") : nlohmann::json::array();
    }
};

TEST_F(Bench, TellsTheMachineBesideTheRows) {
    ASSERT_EQ(tool("bench --quick --threads 1 --filter memcpy --json found.json").code, 0);
    const auto found = json("found.json");
    for (const char* key : {"chiaro", "commit", "machine", "isa"}) EXPECT_TRUE(found.at(key).is_string()) << key;
    EXPECT_EQ(found.at("threads"), 1);
    EXPECT_EQ(found.at("quick"), true);
    ASSERT_EQ(found.at("rows").size(), 1);
    const auto& row = found.at("rows")[0];
    EXPECT_EQ(row.at("name"), "memory/memcpy");
    EXPECT_EQ(row.at("unit"), "GB/s");
    EXPECT_TRUE(row.at("ratio").is_null());
    EXPECT_TRUE(row.at("to").is_string());
    EXPECT_GE(row.at("runs"), 5);
    EXPECT_GT(row.at("min"), 0);
    EXPECT_LE(row.at("min"), row.at("value"));
    EXPECT_LE(row.at("value"), row.at("max"));
}

TEST_F(Bench, SkippingLeavesTheImageAsItIs) {
    const auto found = rows("skipping --filter shells");
    ASSERT_EQ(found.size(), 1);
    EXPECT_EQ(found[0].at("note"), "same picture");
    EXPECT_TRUE(found[0].at("ratio").is_number());
}

TEST_F(Bench, PlaysASeriesThroughTime) {
    const auto found = rows("moments");
    ASSERT_EQ(found.size(), 7);
    for (const auto& row : found) EXPECT_GE(row.at("runs"), 18) << row;
    EXPECT_GT(found[0].at("value"), 0);
}

TEST_F(Bench, LeavesOutWhatHasNoData) {
    unsetenv("CHIARO_DATA_DIR");
    const Said said = tool("bench scenes --quick --filter 'bonsai/step-1/shaded'");
    EXPECT_EQ(said.code, 0);
    EXPECT_NE(said.out.find("skipped: no data"), std::string::npos) << said.out;
}

TEST_F(Bench, RefusesWhatItDoesNotKnow) {
    EXPECT_EQ(tool("bench memry").code, 2);
    EXPECT_NE(tool("bench memry").err.find("did you mean 'memory'"), std::string::npos);
    EXPECT_EQ(tool("bench --filter '('").code, 2);
    EXPECT_EQ(tool("bench --json rows.txt").code, 2);
}

}  // namespace

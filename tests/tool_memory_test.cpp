// How much memory a picture takes, as the tool counts it (stats, peak_memory_bytes).
#include <chiaro/chiaro.h>

#include "tool_case.h"

namespace chiaro {
namespace {

constexpr int size = 256;
constexpr double volume_bytes = 2.0 * size * size * size;

class ToolMemory : public ToolTest {
protected:
    /// Shells of 16 bits, in the scene's look.
    double peak_of(const std::string& look) {
        Volume volume = make_volume({size, size, size}, VoxelType::u16);
        const Volume bytes = make_sample("shells", size);
        std::ranges::copy(bytes.as<std::uint8_t>(), volume.as<std::uint16_t>().begin());
        write_nrrd(volume, folder / "shells.nrrd", NrrdEncoding::raw);
        std::ifstream stream(of_project("bench/scenes/shells256-" + look + ".json"));
        nlohmann::json scene = nlohmann::json::parse(stream);
        scene["volume"] = {{"file", "shells.nrrd"}};
        scene["lighting"] = {{"method", "spao"}};
        write("scene.json", scene.dump());
        return peak("--scene scene.json");
    }

    /// Bytes.
    double peak(const std::string& what) {
        const Said said =
            tool("render " + what + " -o p.png --size 64x48 --threads 2 --device cpu --stats s.json --quiet");
        EXPECT_EQ(said.code, 0) << said.err;
        return json("s.json")["peak_memory_bytes"].get<double>();
    }

    /// Beyond what the program takes for hardly any voxels.
    double ratio_of(const std::string& look) { return (peak_of(look) - peak("sample:shells:8")) / volume_bytes; }
};

// Bricks are 1.34 of it where all of them show something, the value ranges of cells .06. A layer of blocks is an eighth
// of this volume, where it is a sixteenth of one of 512³.
TEST_F(ToolMemory, LightOfFogIsHardlyMoreThanItsAnswer) { EXPECT_LT(ratio_of("fog"), 3.1); }
TEST_F(ToolMemory, LightOfThinShellsIsHardlyMoreThanTheirCells) { EXPECT_LT(ratio_of("sparse"), 2.1); }

}  // namespace
}  // namespace chiaro

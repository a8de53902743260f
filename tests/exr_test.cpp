// From a frame to OpenEXR and back.
#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfOutputFile.h>
#include <ImfTiledOutputFile.h>
#include <chiaro/error.h>
#include <half.h>

#include <cmath>

#include "image/exr.h"
#include "tool_case.h"

using namespace chiaro;

namespace {

/// Light of every size, exact in half precision where `half_too`.
Frame lights(int width, int height, bool half_too = false) {
    Frame frame(width, height);
    for (std::size_t i = 0; i < frame.rgba.size(); ++i)
        frame.rgba[i] = half_too ? float(i % 512) / 256 : std::ldexp(float(i % 97) - 20, int(i % 60) - 30);
    return frame;
}

std::string refusal(std::span<const std::byte> bytes) {
    try {
        decode_exr(bytes, "x.exr");
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::input);
        EXPECT_TRUE(std::string(error.what()).starts_with("x.exr: is ")) << error.what();
        return error.what();
    }
    return "";
}

class Exr : public FolderTest {
protected:
    const std::string file = folder / "a.exr";
};

class ExrTool : public ToolTest {};

/// Channels of `frame` as another program might write them: another type, order, window, tiles.
template <class Output>
void write_foreign(const std::string& file, const Frame& frame, std::string channels, Imf::Header header) {
    std::vector<half> halves(frame.rgba.begin(), frame.rgba.end());
    const Imath::Box2i window = header.dataWindow();
    Imf::FrameBuffer buffer;
    for (char c : channels) {
        const std::string name(1, c);
        header.channels().insert(name, Imf::Channel(Imf::HALF));
        char* first = reinterpret_cast<char*>(halves.data() + std::string("RGBA").find(c));
        buffer.insert(name,
                      Imf::Slice::Make(Imf::HALF, first, window, 4 * sizeof(half), 4 * sizeof(half) * frame.width));
    }
    Output out(file.c_str(), header);
    out.setFrameBuffer(buffer);
    if constexpr (std::is_same_v<Output, Imf::OutputFile>)
        out.writePixels(frame.height);
    else
        out.writeTiles(0, out.numXTiles() - 1, 0, out.numYTiles() - 1);
}

}  // namespace

TEST_F(Exr, RoundTripsLightAndTexts) {
    const Metadata metadata{{"chiaro", "{\"a\": 1,\n \"b\": \"Bäume ☀\"}"}, {"empty", ""}};
    for (auto [width, height] : {std::pair(1, 1), {7, 40}, {300, 33}}) {
        const Frame frame = lights(width, height);
        write_exr(frame, file, metadata);
        const Frame again = read_exr(file);
        EXPECT_EQ(again.width, width);
        EXPECT_EQ(again.height, height);
        EXPECT_EQ(again.rgba, frame.rgba);
        EXPECT_EQ(read_exr_metadata(file), metadata);
    }
    EXPECT_EQ(files(), "a.exr");
}

TEST_F(Exr, ReadsWhatOthersWrite) {
    const Frame frame = lights(50, 20, true);
    const Imath::Box2i window({-3, 100}, {46, 119});
    write_foreign<Imf::OutputFile>(file, frame, "BARG", Imf::Header(Imath::Box2i({0, 0}, {99, 199}), window));
    EXPECT_EQ(read_exr(file).rgba, frame.rgba);
    Imf::Header tiled(50, 20);
    tiled.setTileDescription(Imf::TileDescription(16, 16));
    write_foreign<Imf::TiledOutputFile>(file, frame, "RGBA", tiled);
    EXPECT_EQ(read_exr(file).rgba, frame.rgba);
    write_foreign<Imf::OutputFile>(file, frame, "RGB", Imf::Header(50, 20));
    const Frame opaque = read_exr(file);
    EXPECT_EQ(opaque.rgba[4], frame.rgba[4]);
    EXPECT_EQ(opaque.rgba[7], 1);
    write_foreign<Imf::OutputFile>(file, frame, "RG", Imf::Header(50, 20));
    try {
        read_exr(file);
        ADD_FAILURE() << "no error";
    } catch (const Error& error) {
        EXPECT_NE(std::string(error.what()).find("no channel B"), std::string::npos) << error.what();
    }
}

TEST_F(Exr, RefusesBrokenFiles) {
    const auto whole = encode_exr(lights(40, 30), {{"chiaro", "{}"}});
    EXPECT_EQ(refusal(whole), "");
    for (std::size_t length = 0; length < whole.size(); length += length < 400 ? 1 : 97)
        EXPECT_NE(refusal({whole.data(), length}), "") << length;
    for (std::size_t i = 0; i < 600; ++i)  // the header and the offsets: some changes do no harm, none may crash
        for (int bit : {0, 3, 7}) {
            auto flipped = whole;
            flipped[i] ^= std::byte(1 << bit);
            refusal(flipped);
        }
    EXPECT_EQ(refusal(std::as_bytes(std::span("GIF89a, not what was asked for"))), "x.exr: is not an OpenEXR file");
    EXPECT_THROW(read_exr("/nowhere/a.exr"), Error);
    EXPECT_THROW(encode_exr(Frame(), {}), Error);
    EXPECT_THROW(write_exr(lights(2, 2), "/nowhere/a.exr"), Error);
}

TEST_F(Exr, IsGivenUpWhenCancelled) {
    Progress progress;
    EXPECT_EQ(encode_exr(lights(4, 200), {}, &progress), encode_exr(lights(4, 200), {}));
    progress.cancel();
    try {
        encode_exr(lights(4, 200), {}, &progress);
        ADD_FAILURE() << "was encoded";
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::interrupted);
    }
}

TEST_F(Exr, RefusesAHugeClaim) {
    auto bytes = encode_exr(lights(4, 4), {});
    const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    const std::string_view name("dataWindow\0box2i\0", 17);
    const std::size_t box = text.find(name) + name.size() + 4;  // after the size of the value: xMin, yMin, xMax, yMax
    for (std::size_t maximum : {box + 8, box + 12}) bytes[maximum + 1] = std::byte{0x7f};
    EXPECT_FALSE(refusal(bytes).empty());
    for (std::size_t maximum : {box + 8, box + 12}) bytes[maximum + 2] = std::byte{0x7f};
    EXPECT_FALSE(refusal(bytes).empty());
}

TEST_F(ExrTool, WritesLight) {
    const std::string render = "render sample:menger:16 --size 24x16 --quiet --transfer viridis ";
    EXPECT_EQ(tool(render + "-o a.exr --tone aces --background white").code, 0);
    EXPECT_EQ(tool(render + "-o b.exr --exposure 1").code, 0);
    EXPECT_EQ(tool(render + "-o c.png --exposure 1").code, 0);
    const Frame a = read_exr(folder / "a.exr"), b = read_exr(folder / "b.exr");
    EXPECT_EQ(a.rgba[3], 0);  // the background stays out
    for (std::size_t i = 0; i < a.rgba.size(); ++i) ASSERT_EQ(b.rgba[i], (i % 4 == 3 ? 1 : 2) * a.rgba[i]);
    EXPECT_EQ(develop(b, {}).pixels, read_png(folder / "c.png").pixels);
    const Said again = tool("render --scene b.exr -o again.exr");
    EXPECT_EQ(again.code, 0) << again.err;
    EXPECT_EQ(read("b.exr"), read("again.exr"));
    EXPECT_EQ(tool("compare b.exr again.exr --fail-above max=0").code, 0);
    EXPECT_EQ(tool("compare a.exr b.exr --fail-above max=0").code, 5);
    EXPECT_EQ(tool("compare a.exr c.png").code, 2);
    write("broken.exr", "v/1\x01 and no more");
    const Said said = tool("compare a.exr broken.exr");
    EXPECT_EQ(said.code, 3);
    EXPECT_EQ(std::count(said.err.begin(), said.err.end(), '\n'), 1) << said.err;
}

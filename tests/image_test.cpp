// From a frame to a PNG and back.
#include <chiaro/error.h>
#include <chiaro/image.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstring>
#include <fstream>

#include "core/srgb.h"
#include "image/png.h"
#include "image/tone.h"

using namespace chiaro;
namespace fs = std::filesystem;

namespace {

/// An empty folder that goes with the test.
struct Folder {
    fs::path path = fs::temp_directory_path() / ("chiaro-image-test-" + std::to_string(getpid()));
    Folder() {
        fs::remove_all(path);
        fs::create_directory(path);
    }
    ~Folder() { fs::remove_all(path); }
    int entries() const { return int(std::distance(fs::directory_iterator(path), {})); }
};

Frame one_pixel(float r, float g, float b, float a) {
    Frame frame(1, 1);
    frame.rgba = {r, g, b, a};
    return frame;
}

Image pattern(int width, int height, bool alpha) {
    Image image{width, height, alpha, {}};
    for (int i = 0; i < width * height * (alpha ? 4 : 3); ++i) image.pixels.push_back(std::uint8_t(i * 37 + i / 251));
    return image;
}

/// Runs `attempt`, which must throw, and hands back its error.
template <class Attempt>
Error error_of(const Attempt& attempt) {
    try {
        attempt();
    } catch (const Error& error) {
        return error;
    }
    ADD_FAILURE() << "no error";
    return {ErrorCode::internal, ""};
}

}  // namespace

TEST(Develop, EncodesEveryLinearValueAsTheCurveDoes) {
    const int n = 100000;
    Frame frame(n, 1);
    for (int i = 0; i < n; ++i) frame.rgba[4 * i] = frame.rgba[4 * i + 1] = frame.rgba[4 * i + 2] = float(i) / (n - 1);
    const Image image = develop(frame, {});
    int off = 0;
    for (int i = 0; i < n; ++i)
        off += image.pixels[3 * i] != int(255 * srgb_from_linear(double(frame.rgba[4 * i])) + 0.5);
    EXPECT_LE(off, 2);  // only where float and double fall on two sides of a threshold
    for (int code = 0; code < 256; ++code) {
        const auto linear = float(linear_from_srgb(code / 255.0));
        EXPECT_EQ(develop(one_pixel(linear, linear, linear, 1), {}).pixels[0], code);
    }
}

TEST(Develop, CompositesOverTheBackgroundInLinearLight) {
    ToneMap tone;
    tone.background = {1, 0.5, 0};
    const Image image = develop(one_pixel(0.25f, 0.25f, 0.25f, 0.5f), tone);
    ASSERT_EQ(image.pixels.size(), 3u);
    EXPECT_EQ(image.pixels[0], int(255 * srgb_from_linear(0.75) + 0.5));
    EXPECT_EQ(image.pixels[1], int(255 * srgb_from_linear(0.25 + 0.5 * linear_from_srgb(0.5)) + 0.5));
    EXPECT_EQ(image.pixels[2], int(255 * srgb_from_linear(0.25) + 0.5));
}

TEST(Develop, DisplayModeTakesColoursAsTheyAre) {
    ToneMap tone;
    tone.color = ColorMode::display;
    tone.background = {1, 1, 1};
    const Image image = develop(one_pixel(0.1f, 0.2f, 0, 0.5f), tone);
    EXPECT_EQ(image.pixels[0], 153);  // 0.6
    EXPECT_EQ(image.pixels[1], 179);  // 0.7 * 255 = 178.5
    EXPECT_EQ(image.pixels[2], 128);
}

TEST(Develop, TransparentKeepsStraightAlpha) {
    ToneMap tone;
    tone.transparent = true;
    const Image image = develop(one_pixel(0.25f, 0.5f, 0, 0.5f), tone);
    ASSERT_TRUE(image.has_alpha);
    EXPECT_EQ(image.pixels[0], int(255 * srgb_from_linear(0.5) + 0.5));
    EXPECT_EQ(image.pixels[1], 255);
    EXPECT_EQ(image.pixels[3], 128);
    EXPECT_EQ(develop(one_pixel(0, 0, 0, 0), tone).pixels, (std::vector<std::uint8_t>{0, 0, 0, 0}));
}

TEST(Develop, SurvivesWhatIsNoColour) {
    const float nan = std::nanf(""), infinity = HUGE_VALF;
    for (ColorMode mode : {ColorMode::linear, ColorMode::display}) {
        ToneMap tone;
        tone.color = mode;
        EXPECT_EQ(develop(one_pixel(nan, infinity, -1, 1), tone).pixels, (std::vector<std::uint8_t>{0, 255, 0}));
        EXPECT_EQ(develop(Frame(0, 0), tone).pixels.size(), 0u);
    }
}

TEST(Develop, AStopDoublesTheLight) {
    ToneMap brighter, darker;
    brighter.exposure_stops = 1, darker.exposure_stops = -2;
    brighter.background = darker.background = {0, 0, 1};
    const Frame frame = one_pixel(0.125f, 0.25f, 0.375f, 0.75f);
    for (const auto& [tone, factor] : {std::pair(brighter, 2.0), std::pair(darker, 0.25)}) {
        const Image image = develop(frame, tone);
        EXPECT_EQ(image.pixels[0], int(255 * srgb_from_linear(factor * 0.125) + 0.5));
        EXPECT_EQ(image.pixels[1], int(255 * srgb_from_linear(factor * 0.25) + 0.5));
        EXPECT_EQ(image.pixels[2], int(255 * srgb_from_linear(std::min(1.0, factor * 0.375 + 0.25)) + 0.5));
    }
    brighter.color = ColorMode::display;
    EXPECT_EQ(develop(frame, brighter).pixels, (std::vector<std::uint8_t>{64, 128, 255}));
}

TEST(Develop, TheFilmCurveRisesFromBlackToWhite) {
    EXPECT_EQ(aces(0), 0);
    EXPECT_EQ(aces(-5), 0);
    EXPECT_EQ(aces(HUGE_VALF), 1);
    EXPECT_NEAR(aces(1), 2.54 / 3.16, 1e-6);  // the formula at 1
    float before = 0;
    for (float x = 0; x < 20; x += 0.001f) {
        EXPECT_GE(aces(x), before) << x;
        EXPECT_LE(aces(x), 1) << x;
        before = aces(x);
    }
    ToneMap tone;
    tone.tone = Tone::aces;
    EXPECT_EQ(develop(one_pixel(std::nanf(""), HUGE_VALF, -1, 1), tone).pixels, (std::vector<std::uint8_t>{0, 255, 0}));
    tone.exposure_stops = 2;
    EXPECT_EQ(develop(one_pixel(0.25f, 0, 0, 1), tone).pixels[0], int(255 * srgb_from_linear(2.54 / 3.16) + 0.5));
}

TEST(Develop, ATransparentImageLooksAsIfMadeForItsBackground) {
    ToneMap tone;
    tone.tone = Tone::aces, tone.exposure_stops = 1, tone.background = {0.5, 0.5, 0.5};
    for (float alpha : {0.0f, 0.25f, 0.5f, 1.0f}) {
        const Frame frame = one_pixel(0.6f * alpha, 0.1f * alpha, 2 * alpha, alpha);
        tone.transparent = false;
        const Image opaque = develop(frame, tone);
        tone.transparent = true;
        const Image clear = develop(frame, tone);
        const double a = clear.pixels[3] / 255.0;
        for (int c = 0; c < 3; ++c) {
            const double over = a * linear_from_srgb(clear.pixels[c] / 255.0) + (1 - a) * linear_from_srgb(0.5);
            EXPECT_NEAR(255 * srgb_from_linear(over), opaque.pixels[c], 1.5) << alpha;
        }
    }
}

TEST(Png, RoundTripsPixelsAndTexts) {
    const Folder folder;
    const Metadata metadata{
        {"Software", "Chiaro"}, {"chiaro:scene", "{\"a\": 1,\n \"b\": \"x\"}"}, {"Title", "Bäume ☀"}, {"Empty", ""}};
    for (bool alpha : {false, true})
        for (int width : {1, 7, 300}) {
            const Image image = pattern(width, 11, alpha);
            const fs::path file = folder.path / "picture.png";
            write_png(image, file, metadata);
            const Image again = read_png(file);
            EXPECT_EQ(again.width, width);
            EXPECT_EQ(again.height, 11);
            EXPECT_EQ(again.has_alpha, alpha);
            EXPECT_EQ(again.pixels, image.pixels);
            EXPECT_EQ(read_png_metadata(file), metadata);
        }
    EXPECT_EQ(folder.entries(), 1);  // no temporary file stays behind
}

TEST(Png, SaysItIsSrgb) {
    const auto bytes = encode_png(pattern(3, 3, false), {});
    const std::string text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    EXPECT_NE(text.find("sRGB"), std::string::npos);
}

TEST(Png, RefusesWhatCannotBeWritten) {
    EXPECT_EQ(error_of([] { encode_png(Image{}, {}); }).code(), ErrorCode::output);
    EXPECT_EQ(error_of([] { encode_png(Image{4, 4, false, {1, 2, 3}}, {}); }).code(), ErrorCode::output);
    EXPECT_EQ(error_of([] { encode_png(pattern(2, 2, false), {{"", "x"}}); }).code(), ErrorCode::output);
    EXPECT_EQ(error_of([] { encode_png(pattern(2, 2, false), {{" padded ", "x"}}); }).code(), ErrorCode::output);
}

TEST(Png, IsGivenUpWhenCancelled) {
    Progress progress;
    const auto path = std::filesystem::temp_directory_path() / "chiaro-cancelled.png";
    EXPECT_EQ(encode_png(pattern(3, 3, false), {}, &progress), encode_png(pattern(3, 3, false)));
    progress.cancel();
    try {
        write_png(pattern(3, 3, false), path, {}, &progress);
        ADD_FAILURE() << "was written";
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::interrupted);
    }
    EXPECT_FALSE(std::filesystem::exists(path));
}

TEST(Png, LeavesNothingWhereItCannotWrite) {
    const Folder folder;
    const Image image = pattern(64, 64, false);
    const Error missing = error_of([&] { write_png(image, folder.path / "no" / "a.png"); });
    EXPECT_EQ(missing.code(), ErrorCode::output);
    EXPECT_NE(std::string(missing.what()).find("a.png"), std::string::npos);
    EXPECT_EQ(error_of([&] { write_png(image, folder.path); }).code(), ErrorCode::output);
    EXPECT_EQ(error_of([&] { write_png(image, "/dev/full"); }).code(), ErrorCode::output);
    EXPECT_EQ(error_of([&] { write_png(image, "/proc/a.png"); }).code(), ErrorCode::output);  // read-only, even to root
    EXPECT_TRUE(fs::is_character_file("/dev/full"));
    EXPECT_EQ(folder.entries(), 0);
}

TEST(Png, KeepsTheOldFileWhenTheDiskIsFull) {
    const Folder folder;
    const fs::path file = folder.path / "picture.png";
    write_png(pattern(8, 8, false), file);
    std::signal(SIGXFSZ, SIG_IGN);
    rlimit before{};
    getrlimit(RLIMIT_FSIZE, &before);
    const rlimit full{1000, before.rlim_max};  // as a full disk: the write stops half way
    setrlimit(RLIMIT_FSIZE, &full);
    const Error error = error_of([&] { write_png(pattern(200, 200, true), file); });
    setrlimit(RLIMIT_FSIZE, &before);
    EXPECT_EQ(error.code(), ErrorCode::output);
    EXPECT_EQ(folder.entries(), 1);
    EXPECT_EQ(read_png(file).pixels, pattern(8, 8, false).pixels);
}

TEST(Png, RefusesBrokenFiles) {
    const auto whole = encode_png(pattern(50, 50, false), {});
    for (std::size_t length = 0; length < whole.size(); length += 13)
        EXPECT_EQ(error_of([&] { decode_png({whole.data(), length}, "cut.png"); }).code(), ErrorCode::input) << length;
    auto flipped = whole;
    flipped[whole.size() / 2] ^= std::byte{1};
    EXPECT_EQ(error_of([&] { decode_png(flipped, "flipped.png"); }).code(), ErrorCode::input);
    const Error garbage =
        error_of([&] { decode_png(std::as_bytes(std::span("GIF89a, not what was asked for")), "x.png"); });
    EXPECT_STREQ(garbage.what(), "x.png: is not a PNG file");
    EXPECT_EQ(error_of([] { read_png("/nowhere/a.png"); }).code(), ErrorCode::input);
    EXPECT_EQ(error_of([] { read_png("/dev/zero"); }).code(), ErrorCode::input);
}

TEST(Png, RefusesAHugeClaim) {  // 60000 x 60000 in the header of a small file
    auto bytes = encode_png(pattern(4, 4, false), {});
    const unsigned char header[] = {'I', 'H', 'D', 'R', 0, 0, 0xea, 0x60, 0, 0, 0xea, 0x60, 8, 2, 0, 0, 0};
    std::memcpy(bytes.data() + 12, header, sizeof header);
    std::uint32_t crc = ~0u;
    for (unsigned char byte : header) {
        crc ^= byte;
        for (int bit = 0; bit < 8; ++bit) crc = crc >> 1 ^ (crc & 1 ? 0xedb88320u : 0);
    }
    for (int i = 0; i < 4; ++i) bytes[29 + i] = std::byte(~crc >> (24 - 8 * i));
    const Error error = error_of([&] { decode_png(bytes, "huge.png"); });
    EXPECT_NE(std::string(error.what()).find("too short for its pixels"), std::string::npos) << error.what();
}

// Found by fuzzing: libpng clears what a chunk says that it takes before it reads it.
TEST(Png, TakesNoMemoryForAHugeChunk) {
    auto bytes = encode_png(pattern(4, 4, false), {{"chiaro", "a scene"}});
    const auto name = std::search(bytes.begin(), bytes.end(), std::begin("tEXt"), std::begin("tEXt") + 4,
                                  [](std::byte a, char b) { return a == std::byte(b); });
    ASSERT_NE(name, bytes.end());
    *(name - 4) = std::byte{0x60};  // 1.6 GB
    rusage before{}, after{};
    getrusage(RUSAGE_SELF, &before);
    EXPECT_EQ(error_of([&] { decode_png(bytes, "huge.png"); }).code(), ErrorCode::input);
    getrusage(RUSAGE_SELF, &after);
    EXPECT_LT(after.ru_maxrss - before.ru_maxrss, 256 << 10) << "KiB";
}

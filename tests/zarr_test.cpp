// Zarr stores of both versions, however their chunks are stored; what is hostile ends in a sentence.
#include "zarr_files.h"

#include <blosc.h>
#include <chiaro/error.h>
#include <lz4.h>
#include <sys/stat.h>
#include <zstd.h>

#include <cmath>
#include <map>

using namespace chiaro;
using namespace volume_files;

namespace {

std::string packed(const std::string& bytes, const std::string& codec, int value_bytes) {
    std::string out(bytes.size() + 1024 + BLOSC_MAX_OVERHEAD, '\0');
    if (codec == "zlib" || codec == "gzip") return deflated(bytes, codec == "zlib" ? 15 : 31);
    if (codec.empty()) return bytes;
    if (codec == "zstd") {
        out.resize(ZSTD_compress(out.data(), out.size(), bytes.data(), bytes.size(), 3));
    } else if (codec == "lz4") {
        const int size = LZ4_compress_default(bytes.data(), out.data() + 4, int(bytes.size()), int(out.size() - 4));
        out.replace(0, 4, bytes_of(std::uint32_t(bytes.size()))).resize(std::size_t(size) + 4);
    } else {
        out.resize(std::size_t(blosc_compress_ctx(5, BLOSC_SHUFFLE, std::size_t(value_bytes), bytes.size(),
                                                  bytes.data(), out.data(), out.size(), "zstd", 0, 1)));
    }
    return out;
}

/// 5 x 7 x 6 voxels (z, y, x) in chunks that reach over each border.
const Sizes shape{5, 7, 6}, chunk{2, 3, 4};

template <class T>
std::vector<T> values() {
    return ramp<T>(5 * 7 * 6, T(3));
}

/// All ways in which one array can be stored.
std::map<std::string, ZarrLayout> layouts() {
    std::map<std::string, ZarrLayout> all;
    for (const int version : {2, 3}) {
        const std::string v = "v" + std::to_string(version) + " ";
        for (const std::string codec : {"", "gzip", "zstd", "blosc"})
            all[v + "by " + codec] = {
                .shape = shape, .chunk = chunk, .version = version, .codec = codec, .pack = packed};
        const ZarrLayout plain = all[v + "by gzip"];
        (all[v + "big endian"] = plain).is_big_endian = true;
        (all[v + "reversed"] = plain).order = {2, 1, 0};
        (all[v + "by /"] = plain).separator = '/';
        (all[v + "one plane a chunk"] = plain).chunk = {1, 7, 6};
        (all[v + "one large chunk"] = plain).chunk = {64, 64, 64};
    }
    for (const std::string codec : {"zlib", "lz4"}) (all["v2 by " + codec] = all["v2 by gzip"]).codec = codec;
    ZarrLayout& turned = all["v3 transposed"] = all["v3 by zstd"];
    turned.order = {1, 2, 0}, turned.is_big_endian = true, turned.has_checksum = true;
    for (const bool first : {false, true}) {
        ZarrLayout& sharded = all[first ? "v3 sharded, index first" : "v3 sharded"] = all["v3 by blosc"];
        sharded.shard = {4, 6, 4}, sharded.index_is_first = first, sharded.has_checksum = true, sharded.separator = '/';
    }
    return all;
}

std::string refusal(const std::string& name) {
    try {
        read(name);
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::input);
        return error.what();
    }
    ADD_FAILURE() << name << " was accepted";
    return {};
}

void expect_refused(const std::string& name, const std::string& part) {
    const std::string sentence = refusal(name);
    EXPECT_NE(sentence.find(part), std::string::npos) << sentence;
    EXPECT_EQ(sentence.find("crashed"), std::string::npos) << sentence;
}

std::string all_notes(const Volume& volume) { return fmt::format("{}", fmt::join(volume.notes, "; ")); }

/// The metadata of a group with levels, of version 0.4.
std::string group_04(const std::string& axes, const std::string& datasets, const std::string& more = "") {
    return fmt::format(R"({{"multiscales": [{{"version": "0.4", "axes": [{}], "datasets": [{}]{}}}]}})", axes, datasets,
                       more);
}

std::string axis(const std::string& name, const std::string& type, const std::string& unit = "") {
    return fmt::format(R"({{"name": "{}", "type": "{}"{}}})", name, type,
                       unit.empty() ? "" : fmt::format(R"(, "unit": "{}")", unit));
}

std::string dataset(const std::string& path, const std::string& scale, const std::string& translation = "") {
    return fmt::format(
        R"({{"path": "{}", "coordinateTransformations": [{{"type": "scale", "scale": {}}}{}]}})", path, scale,
        translation.empty() ? "" : fmt::format(R"(, {{"type": "translation", "translation": {}}})", translation));
}

const std::string zyx = axis("z", "space", "micrometer") + ", " + axis("y", "space", "micrometer") + ", " +
                        axis("x", "space", "micrometer");

/// Left for another reader, with its numbers (browser/stores.test.mjs).
template <class T>
void keep(const Folder& store, const std::string& name) {
    const char* where = std::getenv("CHIARO_KEEP_STORES");
    if (!where) return;
    const fs::path to = fs::path(where) / (zarr_type<T>(3, false) + " " + name);
    fs::create_directories(to);
    fs::copy(store / "a", to / "a", fs::copy_options::recursive);
    const auto numbers = values<T>();
    std::ofstream(to / "numbers", std::ios::binary)
        .write(reinterpret_cast<const char*>(numbers.data()), std::streamsize(numbers.size() * sizeof(T)));
}

template <class T>
class ZarrOf : public ::testing::Test {};
using Types = ::testing::Types<std::uint8_t, std::int8_t, std::uint16_t, std::int16_t, std::uint32_t, std::int32_t,
                               std::uint64_t, std::int64_t, float, double>;

}  // namespace

TYPED_TEST_SUITE(ZarrOf, Types);

TYPED_TEST(ZarrOf, HoldsTheSameHoweverItIsStored) {
    for (const auto& [name, layout] : layouts()) {
        const Folder folder;
        write_zarr(folder, "a", layout, values<TypeParam>());
        const Volume volume = read(folder / "a");
        ASSERT_EQ(volume.dimensions, (std::array{6, 7, 5})) << name;
        ASSERT_EQ(voxels_of<TypeParam>(volume), values<TypeParam>()) << name;
        EXPECT_EQ(volume.format, "OME-Zarr");
        std::string file_name = name;
        std::ranges::replace(file_name, '/', '_');
        keep<TypeParam>(folder, file_name);
    }
}

TEST(Zarr, ChunksThatWereNeverWrittenHoldTheFillValue) {
    const auto expected = [](float fill) {
        auto all = values<float>();
        for (std::size_t i = 0; i < all.size(); ++i)
            if (i / 42 < 2 && i / 6 % 7 < 3 && i % 6 < 4) all[i] = fill;
        return all;
    };
    for (const std::string name : {"v2 by zstd", "v3 by zstd", "v3 sharded"})
        for (const auto& [fill, value] : std::map<std::string, float>{{"-7.5", -7.5F}, {"null", 0.F}, {"3", 3.F}}) {
            const Folder folder;
            ZarrLayout layout = layouts().at(name);
            layout.fill = fill;
            layout.is_missing = [](const Sizes& at) { return at == Sizes{0, 0, 0}; };
            write_zarr(folder, "a", layout, values<float>());
            const Volume volume = read(folder / "a");
            EXPECT_EQ(voxels_of<float>(volume), expected(value)) << name << fill;
            EXPECT_NE(all_notes(volume).find("1 of 18 chunks were never written"), std::string::npos);
        }
    const Folder folder;
    ZarrLayout layout = layouts().at("v3 by gzip");
    layout.fill = "\"NaN\"", layout.is_missing = [](const Sizes& at) { return at == Sizes{0, 0, 0}; };
    write_zarr(folder, "a", layout, values<float>());
    EXPECT_TRUE(std::isnan(voxels_of<float>(read(folder / "a"))[0]));
}

TEST(Zarr, AxesLieWhereTheyAreDeclared) {
    const Folder folder;
    const ZarrLayout layout = layouts().at("v2 by gzip");  // 5 x 7 x 6 as declared
    write_zarr(folder, "a/full", layout, values<std::uint16_t>());
    folder.write("a/.zgroup", R"({"zarr_format": 2})");
    const std::string more = R"(, "coordinateTransformations": [{"type": "scale", "scale": [10, 10, 10]},
                               {"type": "translation", "translation": [1000, 0, 0]}])";
    folder.write("a/.zattrs", group_04(axis("x", "space", "micrometer") + ", " + axis("z", "space", "micrometer") +
                                           ", " + axis("y", "space", "millimeter"),
                                       dataset("full", "[2, 3, 4]", "[5, 0, 1]"), more));
    const Volume volume = read(folder / "a");
    EXPECT_EQ(volume.dimensions, (std::array{5, 6, 7}));
    EXPECT_EQ(volume.as<std::uint16_t>()[(4 * 6 + 2) * 5 + 3], values<std::uint16_t>()[(3 * 7 + 4) * 6 + 2]);
    const auto& [spacing, origin, direction, world] = volume.geometry;
    EXPECT_DOUBLE_EQ(spacing.x, 0.02);
    EXPECT_DOUBLE_EQ(spacing.y, 40);
    EXPECT_DOUBLE_EQ(spacing.z, 0.03);
    EXPECT_DOUBLE_EQ(origin.x, 0.05 + 1);
    EXPECT_DOUBLE_EQ(origin.y, 10);
}

TEST(Zarr, MomentsAndChannelsArePicked) {
    const Folder folder;
    ZarrLayout layout = layouts().at("v3 by gzip");
    layout.shape = {2, 3, 2, 3, 4}, layout.chunk = {1, 2, 2, 2, 4};
    const auto all = ramp<std::uint8_t>(2 * 3 * 24);
    write_zarr(folder, "a/0", layout, all);
    folder.write(
        "a/zarr.json",
        fmt::format(R"({{"zarr_format": 3, "node_type": "group", "attributes": {{"ome": {{"version": "0.5", {},
                            "omero": {{"channels": [{{"label": "DAPI"}}, {{"label": "GFP", "color": "00FF33"}}, {{}}]}}}}}}}})",
                    R"("multiscales": [{"axes": [)" + axis("t", "time", "second") + ", " + axis("c", "channel") + ", " +
                        zyx + R"(], "datasets": [)" + dataset("0", "[0.5, 1, 1, 1, 1]") + "]}]"));
    const std::string name = (folder / "a").string();
    ReadOptions second;
    second.time = 1;
    Progress progress;
    const Volume volume = read_volume(name, second, progress);
    EXPECT_EQ(volume.components, 3);
    ASSERT_EQ(volume.component_infos.size(), 3u);
    EXPECT_EQ(volume.component_infos[0], (ComponentInfo{"DAPI", {}}));
    EXPECT_EQ(volume.component_infos[1], (ComponentInfo{"GFP", std::array{0.0, 1.0, 0.2}}));
    EXPECT_EQ(volume.moments, (Moments{2, 1, {0, 0.5}, "s"}));
    EXPECT_EQ(int(volume.voxels.data()[3 * 5 + 2]), 3 * 24 + 2 * 24 + 5);
    for (const std::string part : {"#@GFP", "#0@1", "#/0@1", ":/0@GFP"})
        EXPECT_EQ(int(read(name + part).voxels.data()[5]), 24 + 5) << part;
    expect_refused(name + "#@red", "has no channel 'red', but 3, counted from 0: DAPI, GFP");
    expect_refused(name + "#1", "holds no Zarr metadata at '1'");
    second.time = 2;
    EXPECT_THROW(read_volume(name, second, progress), Error);
}

TEST(Zarr, ImagesLabelsAndArraysAreListedAndPicked) {
    const Folder folder;
    const ZarrLayout layout = layouts().at("v2 by gzip");
    folder.write("a/.zgroup", R"({"zarr_format": 2})");
    for (const std::string image : {"0", "1", "0/labels/cells"}) {
        write_zarr(folder, "a/" + image + "/s0", layout, values<std::uint16_t>());
        folder.write("a/" + image + "/.zattrs", group_04(zyx, dataset("s0", "[1, 1, 1]")));
    }
    const std::string name = (folder / "a").string();
    const std::string notes = all_notes(read(name));
    EXPECT_NE(notes.find("holds 2 images; the first is shown (STORE#PATH is another: 0, 1)"), std::string::npos)
        << notes;
    const Volume first = read(name + "#0");
    EXPECT_NE(all_notes(first).find("0/labels/cells"), std::string::npos) << all_notes(first);
    EXPECT_DOUBLE_EQ(first.geometry.spacing_mm.x, 1e-3);
    EXPECT_DOUBLE_EQ(read(name + "#0/s0").geometry.spacing_mm.x, 1e-3) << "a level of an image, by its name";
    EXPECT_EQ(read(name + "#0/labels/cells").dimensions, first.dimensions);
    folder.write("b/.zgroup", R"({"zarr_format": 2})");
    for (const std::string array : {"b/u", "b/v"}) write_zarr(folder, array, layout, values<std::uint16_t>());
    expect_refused(folder / "b", "holds 2 arrays; name one as STORE#PATH: u, v");
    EXPECT_EQ(read((folder / "b").string() + "#v").dimensions[0], 6);
}

TEST(Zarr, WhatIsHostileIsRefusedInOneSentence) {
    const Folder folder;
    const auto v2 = zarr_files(layouts().at("v2 by zstd"), values<std::uint16_t>());
    const auto sharded = zarr_files(layouts().at("v3 sharded"), values<std::uint16_t>());
    int number = 0;
    const auto store = [&](const auto& files, const std::string& changed,
                           const std::function<void(std::string&)>& change) {
        const std::string name = "s" + std::to_string(number++);
        for (auto [file, bytes] : files) {
            if (file == changed) change(bytes);
            folder.write(name + "/" + file, bytes);
        }
        return (folder / name).string();
    };
    const auto replaced = [](const std::string& from, const std::string& to) {
        return [=](std::string& bytes) {
            ASSERT_NE(bytes.find(from), std::string::npos) << from;
            bytes.replace(bytes.find(from), from.size(), to);
        };
    };
    const std::string meta = ".zarray";
    expect_refused(store(v2, meta, replaced("[5, 7, 6]", "[5, 7, 1000000000000]")), "every dimension");
    expect_refused(store(v2, meta, replaced("[5, 7, 6]", "[5, 7, -6]")), "no size");
    expect_refused(store(v2, meta, replaced("[5, 7, 6]", "[7, 6]")), "another number of axes");
    expect_refused(store(v2, meta, replaced("[2, 3, 4]", "[2000, 3000, 4000]")), "more than the 1024 MiB");
    expect_refused(store(v2, meta, replaced("[2, 3, 4]", "[0, 3, 4]")), "no size");
    expect_refused(store(v2, meta, replaced("<u2", "<c8")), "type '<c8'");
    expect_refused(store(v2, meta, replaced("zstd", "lzma")), "is compressed by 'lzma'");
    expect_refused(store(v2, meta, replaced("\"filters\": null", R"("filters": [{"id": "delta"}])")), "filter 'delta'");
    expect_refused(store(v2, meta, replaced("\"order\": \"C\"", "\"order\": \"C\", \"order\": \"F\"")), "twice");
    expect_refused(store(v2, meta, replaced("\"dtype\": ", "\"type\": ")), "a member is missing");
    expect_refused(store(v2, meta, replaced("\"fill_value\": 0", "\"fill_value\": 70000")), "fill value 70000");
    expect_refused(store(v2, meta, [](std::string& s) { s = std::string(100, '['); }), "nested");
    expect_refused(store(v2, "1.0.0", [](std::string& s) { s.resize(s.size() - 3); }), "'1.0.0'");
    expect_refused(store(v2, "1.0.0", [](std::string& s) { s.clear(); }), "'1.0.0'");
    expect_refused(store(v2, "1.0.0", [](std::string& s) { s = std::string(1 << 20, 'x'); }), "at most");
    expect_refused(store(sharded, "c/0/0/0", [](std::string& s) { s.back() ^= 1; }), "wrong checksum");
    expect_refused(store(sharded, "c/0/0/0", [](std::string& s) { s[20] ^= 1; }), "c/0/0/0");
    expect_refused(store(sharded, "c/0/0/0", [](std::string& s) { s.resize(20); }), "less than its index takes");
    expect_refused(store(sharded, "zarr.json", replaced("[4, 6, 4]", "[5, 6, 4]")), "no multiple");
    const std::string linked = store(v2, "", [](std::string&) {});
    fs::remove(linked + "/0.0.0"), fs::create_symlink("/etc/passwd", linked + "/0.0.0");
    expect_refused(linked, "symbolic link");
    fs::remove(linked + "/0.0.0"), mkfifo((linked + "/0.0.0").c_str(), 0600);
    expect_refused(linked, "no regular file");
    folder.write("out/.zattrs", group_04(zyx, dataset("../s0", "[1, 1, 1]")));
    expect_refused(folder / "out", "leads out of its folder");
    folder.write("empty/.zarray", v2[0].second);
    expect_refused(folder / "empty", "holds no chunk");
    folder.write("turned/.zattrs",
                 group_04(zyx, R"({"path": "0", "coordinateTransformations": [{"type": "affine"}]})"));
    folder.write("turned/0/.zarray", v2[0].second);
    expect_refused(folder / "turned", "'affine'");
}

// VTK image data: XML in every encoding, and legacy structured points.
#include "vtk_files.h"

#include <chiaro/error.h>
#include <lz4.h>
#include <lzma.h>

using namespace chiaro;
using namespace volume_files;

namespace {

std::string zlib(const std::string& bytes) { return deflated(bytes, 15); }

std::string lz4(const std::string& bytes) {
    std::string to(std::size_t(LZ4_compressBound(int(bytes.size()))), '\0');
    to.resize(std::size_t(LZ4_compress_default(bytes.data(), to.data(), int(bytes.size()), int(to.size()))));
    return to;
}

std::string lzma(const std::string& bytes) {
    std::string to(lzma_stream_buffer_bound(bytes.size()), '\0');
    std::size_t size = 0;
    lzma_easy_buffer_encode(5, LZMA_CHECK_CRC32, nullptr, reinterpret_cast<const std::uint8_t*>(bytes.data()),
                            bytes.size(), reinterpret_cast<std::uint8_t*>(to.data()), &size, to.size());
    to.resize(size);
    return to;
}

struct Coding {
    const char* compressor;
    std::string (*compress)(const std::string&);
};
const Coding codings[] = {
    {"", nullptr}, {"vtkZLibDataCompressor", zlib}, {"vtkLZ4DataCompressor", lz4}, {"vtkLZMADataCompressor", lzma}};

void expect_place(const Volume& volume) {
    EXPECT_EQ(volume.dimensions, (std::array{4, 3, 2}));
    EXPECT_EQ(volume.format, "VTK");
    EXPECT_EQ(volume.geometry.world, World::unknown);
    expect_near(volume.geometry.spacing_mm, {0.5, 2, 3});
    expect_near(volume.geometry.origin_mm, {1, 2, 3});
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

}  // namespace

TEST(Vti, EveryEncodingCompressionAndByteOrder) {
    const Folder folder;
    const auto values = ramp<std::int16_t>(24, -9);
    for (const auto& [compressor, compress] : codings)
        for (const auto& [format, encoding] : {std::pair{"appended", "raw"}, {"appended", "base64"}, {"binary", ""}})
            for (const bool big_endian : {false, true})
                for (const bool wide : {false, true})
                    for (const std::size_t block : {7, 8, 48, 1000}) {  // uneven, even, one, and a larger one
                        if (!compress && block != 7) continue;
                        const Vti file{.arrays = {{"Int16", "density", bytes_of_all(values, big_endian)}},
                                       .format = format,
                                       .encoding = encoding,
                                       .big_endian = big_endian,
                                       .wide_header = wide,
                                       .compressor = compressor,
                                       .compress = compress,
                                       .block = block};
                        const auto volume = read(folder.write("a.vti", file.bytes()));
                        EXPECT_EQ(voxels_of<std::int16_t>(volume), values) << file.bytes();
                        expect_place(volume);
                        EXPECT_TRUE(volume.notes.empty());
                    }
}

TEST(Vti, AsciiAndTypes) {
    const Folder folder;
    const Vti floats{
        .arrays = {{"Float32", "a", "0.5 -1e3 nan 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18 19 20\n21 22 23"}},
        .format = "ascii"};
    const auto volume = read(folder.write("a.vti", floats.bytes()));
    EXPECT_EQ(volume.as<float>()[1], -1000);
    EXPECT_EQ(volume.as<float>()[23], 23);
    EXPECT_TRUE(has_note(volume, "1 voxels are not finite"));
    const auto doubles = ramp<double>(24, 0.25);
    EXPECT_EQ(voxels_of<double>(
                  read(folder.write("b.vti", Vti{.arrays = {{"Float64", "a", bytes_of_all(doubles)}}}.bytes()))),
              doubles);
    const auto wide = ramp<std::uint64_t>(24, std::uint64_t(1) << 60);
    EXPECT_EQ(voxels_of<std::uint64_t>(
                  read(folder.write("c.vti", Vti{.arrays = {{"UInt64", "a", bytes_of_all(wide)}}}.bytes()))),
              wide);
}

TEST(Vti, PlaceFollowsExtentAndDirection) {
    const Folder folder;
    const Vti file{.extent = "2 5 -1 1 10 11",
                   .more = R"( Origin="1 2 3" Spacing="0.5 2 3" Direction="0 -1 0 1 0 0 0 0 1")"};
    const auto volume = read(folder.write("a.vti", file.bytes()));
    expect_near(volume.geometry.direction[0], {0, 1, 0});  // the columns of the matrix
    expect_near(volume.geometry.direction[1], {-1, 0, 0});
    expect_near(volume.geometry.origin_mm, {1 + 2, 2 + 1, 3 + 30});
}

TEST(Vti, ChoosesTheActiveArrayAndNamesTheOthers) {
    const Folder folder;
    const std::string other(24, 'o'), cells(6, 'c');
    Vti file{.arrays = {{"UInt8", "first", other}, VtiArray{}, {"UInt8", "of cells", cells, 1, true}},
             .scalars = "density"};
    auto volume = read(folder.write("a.vti", file.bytes()));
    EXPECT_EQ(volume.as<std::uint8_t>()[1], 'b');
    EXPECT_TRUE(has_note(volume, "shows the array 'density'; also here: 'first', 'of cells' (cells)"));
    file.scalars = "";
    EXPECT_EQ(read(folder.write("a.vti", file.bytes())).as<std::uint8_t>()[1], 'o');
    file.arrays.erase(file.arrays.begin(), file.arrays.begin() + 2);
    volume = read(folder.write("a.vti", file.bytes()));
    EXPECT_EQ(volume.dimensions, (std::array{3, 2, 1}));
    EXPECT_EQ(volume.as<std::uint8_t>()[5], 'c');
    expect_near(volume.geometry.origin_mm, {1.25, 3, 4.5});
}

TEST(Vti, RefusesWhatLies) {
    const Folder folder;
    const auto expect = [&](const std::string& bytes, const std::string& part) {
        EXPECT_NE(refusal(folder.write("a.vti", bytes)).find(part), std::string::npos) << part << "\n" << bytes;
    };
    const auto with = [](auto change) {
        Vti file;
        change(file);
        return file.bytes();
    };
    const auto replaced = [](std::string bytes, const std::string& from, const std::string& to) {
        return bytes.replace(bytes.find(from), from.size(), to);
    };
    expect(with([](Vti& f) { f.extent = "0 60000 0 60000 0 60000"; }), "where its extent needs");
    expect(with([](Vti& f) { f.extent = "0 99999 0 2 0 1"; }), "1..65535");
    expect(with([](Vti& f) { f.extent = "3 0 0 2 0 1"; }), "makes no sense");
    expect(with([](Vti& f) { f.extent = "0 3 0 2"; }), "WholeExtent has 4");
    expect(with([](Vti& f) { f.more = R"( Spacing="0 1 1")"; }), "spacing");
    expect(with([](Vti& f) { f.more = R"( Spacing="nan 1 1")"; }), "spacing");
    expect(with([](Vti& f) { f.more = R"( Direction="1 0 0 1 0 0 0 0 1")"; }), "has a direction");
    expect(with([](Vti& f) { f.more = R"( Direction="1 1 0 0 0 0 0 0 1")"; }), "singular directions");
    expect(with([](Vti& f) { f.arrays[0].type = "Bit"; }), "type 'Bit'");
    expect(with([](Vti& f) { f.arrays.clear(); }), "no array");
    expect(with([](Vti& f) { f.arrays[0].components = 3; }), "where its extent needs 72");
    expect(with([](Vti& f) { f.format = "binary", f.arrays[0].values.pop_back(); }), "where its extent needs 24");
    expect(with([](Vti& f) { f.format = "ascii", f.arrays[0].values = "1 2 3"; }), "");
    expect(with([](Vti& f) {
               f.format = "ascii", f.arrays[0].values = "1 2 300 4 5 6 7 8 9 0 1 2 3 4 5 6 7 8 9 0 1 2 3 4";
           }),
           "'300'");
    expect(with([](Vti& f) { f.compressor = "vtkOwnCompressor"; }), "vtkOwnCompressor");
    expect(with([](Vti& f) { f.compressor = "vtkZLibDataCompressor"; }), "");
    expect(with([](Vti& f) { f.compressor = "vtkZLibDataCompressor", f.compress = [](auto& s) { return s; }; }),
           "damaged");
    expect(replaced(Vti{}.bytes(), "offset=\"0\"", "offset=\"99\""), "at offset 99");
    expect(replaced(Vti{}.bytes(), "offset=\"0\"", "offset=\"-1\""), "at offset -1");
    expect(replaced(Vti{}.bytes(), "\"ImageData\"", "\"PolyData\""), "'PolyData'");
    expect(replaced(Vti{}.bytes(), "</VTKFile>", ""), "truncated");
    expect(replaced(Vti{}.bytes(), "</ImageData>", ""), "XML");
    Vti text{.format = "binary"};
    expect(replaced(text.bytes(), base64(text.count(24) + text.arrays[0].values), "!!!!"), "base64");
    std::string deep = Vti{.format = "binary"}.bytes();
    for (int i = 0; i < 300000; ++i) deep += "<a>";
    expect(deep, "XML");
}

TEST(Vtk, BinaryAndAsciiOfEveryType) {
    const Folder folder;
    const auto shorts = ramp<std::int16_t>(24, -7);
    auto volume = read(folder.write("a.vtk", vtk_file()));
    EXPECT_EQ(voxels_of<std::int16_t>(volume), shorts);
    expect_place(volume);
    std::string text;
    for (const auto value : shorts) text += std::to_string(value) + " ";
    volume = read(folder.write("a.vtk", vtk_start(false) + "POINT_DATA 24\n" + vtk_scalars("short 1", text)));
    EXPECT_EQ(voxels_of<std::int16_t>(volume), shorts);
    const auto floats = ramp<float>(24, 0.5F);
    volume = read(folder.write("a.vtk", vtk_start(true) + "POINT_DATA 24\n" +
                                            vtk_scalars("float", bytes_of_all(floats, true)) +
                                            "\nMETADATA\nINFORMATION 0\n\n"));
    EXPECT_EQ(voxels_of<float>(volume), floats);
    EXPECT_TRUE(volume.notes.empty());
    volume = read(folder.write(
        "a.vtk", vtk_start(true) + "POINT_DATA 24\n" + vtk_scalars("unsigned_char", std::string(24, 'u'))));
    EXPECT_EQ(volume.type, VoxelType::u8);
}

TEST(Vtk, FieldsCellsAndTablesAreTold) {
    const Folder folder;
    const auto shorts = ramp<std::int16_t>(24, 3);
    const std::string field = "FIELD FieldData 2\nother 1 24 float\n" + bytes_of_all(ramp<float>(24), true) +
                              "\nsecond 3 24 unsigned_char\n" + std::string(72, '\n') + "\n";
    const std::string before = "FIELD FieldData 1\nTIME 1 1 double\n" + bytes_of(1.5, true) + "\n";
    const std::string table = "LOOKUP_TABLE mine 2\n" + std::string(8, '\n') + "\n";
    auto volume = read(folder.write("a.vtk", vtk_start(true) + before + "POINT_DATA 24\n" + field +
                                                 vtk_scalars("short", bytes_of_all(shorts, true)) + "\n" + table));
    EXPECT_EQ(voxels_of<std::int16_t>(volume), shorts);
    EXPECT_TRUE(has_note(volume, "also here: 'other', 'second'"));
    volume = read(folder.write("a.vtk", vtk_start(true) + "CELL_DATA 6\n" + vtk_scalars("char", "abcdef")));
    EXPECT_EQ(volume.dimensions, (std::array{3, 2, 1}));
    EXPECT_EQ(volume.type, VoxelType::i8);
    expect_near(volume.geometry.origin_mm, {1.25, 3, 4.5});
    volume = read(folder.write("a.vtk", vtk_start(false) + "POINT_DATA 24\nFIELD f 1\nvalues 1 24 int\n" +
                                            "1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18 19 20 21 22 23 24"));
    EXPECT_EQ(volume.as<std::int32_t>()[23], 24);
}

TEST(Vtk, RefusesWhatLies) {
    const Folder folder;
    const std::string values = bytes_of_all(ramp<std::int16_t>(24), true);
    const auto expect = [&](const std::string& bytes, const std::string& part) {
        EXPECT_NE(refusal(folder.write("a.vtk", bytes)).find(part), std::string::npos) << part;
    };
    const std::string start = vtk_start(true);
    const auto with = [&](const std::string& line) {  // in place of the one with its keyword
        const auto at = start.find(line.substr(0, line.find(' ')));
        return start.substr(0, at) + line + start.substr(start.find('\n', at));
    };
    expect(vtk_start(true, "STRUCTURED_GRID") + "POINT_DATA 24\n" + vtk_scalars("short", values), "STRUCTURED_POINTS");
    expect(start + "POINT_DATA 24\n" + vtk_scalars("bit", values), "type 'bit'");
    expect(start + "POINT_DATA 23\n" + vtk_scalars("short", values), "");
    expect(start + "POINT_DATA 23\n" + vtk_scalars("short", values.substr(2)), "where its dimensions need 24");
    expect(start + "POINT_DATA 24\n" + vtk_scalars("short", values.substr(1)), "truncated");
    expect(start + "POINT_DATA 99999999999999999\n" + vtk_scalars("short", values), "POINT_DATA");
    expect(start + "POINT_DATA -1\n" + vtk_scalars("short", values), "POINT_DATA");
    expect(start + "POINT_DATA 24\nFIELD f 1\nx 65535 1099511627776 double\n" + values, "truncated");
    expect(with("DIMENSIONS 60000 60000 60000") + "POINT_DATA 24\n" + vtk_scalars("short", values),
           "need 216000000000000");
    expect(with("SPACING 1 0 1") + "POINT_DATA 24\n" + vtk_scalars("short", values), "spacing");
    expect(start + "SPACING 1 1 1\nPOINT_DATA 24\n" + vtk_scalars("short", values), "states its spacing twice");
    expect(start + "NONSENSE 1\n", "NONSENSE");
    expect(start, "no array");
    expect("# vtk DataFile Version 3.0\nx\nBINARY\n", "no DATASET");
    expect(vtk_start(false) + "POINT_DATA 24\n" + vtk_scalars("short", "1 2 3"), "truncated");
}

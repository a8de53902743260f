// TIFF: folders of slices and files of pages, whatever libtiff can write.
#include "refusal.h"
#include "tiff_files.h"
#include "tiff_pages.h"

#include <chiaro/error.h>

using namespace chiaro;
using namespace volume_files;

namespace {

constexpr int width = 40, height = 33;

template <class T>
T value_at(int x, int y, int z, int sample) {
    return T(x + 3 * y + 50 * z + 7 * sample);
}

template <class T>
void write_pages(const std::string& name, const TiffStorage& storage, int pages) {
    write_tiff<T>(name, storage, {width, height, pages}, value_at<T>);
}

template <class T>
void expect_pages(const Volume& volume, int pages) {
    ASSERT_EQ(volume.dimensions, (std::array{width, height, pages}));
    ASSERT_EQ(volume.type, voxel_type_of<T>());
    std::size_t i = 0;
    for (int z = 0; z < pages; ++z)
        for (int y = 0; y < height; ++y)
            for (int x = 0; x < width; ++x) ASSERT_EQ(volume.as<T>()[i++], value_at<T>(x, y, z, 0)) << x << " " << y;
}

template <class T>
class TiffOf : public ::testing::Test {};
using Types = ::testing::Types<std::uint8_t, std::int8_t, std::uint16_t, std::int16_t, std::uint32_t, std::int32_t,
                               float, double>;

}  // namespace

TYPED_TEST_SUITE(TiffOf, Types);

TYPED_TEST(TiffOf, StripsTilesByteOrderAndBigTiff) {
    const Folder folder;
    const std::string name = (folder / "a.tif").string();
    for (const bool tiled : {false, true})
        for (const char* mode : {"w", "wb", "w8", "w8b"})
            for (const int compression : {COMPRESSION_NONE, COMPRESSION_LZW, COMPRESSION_ADOBE_DEFLATE}) {
                write_pages<TypeParam>(name, {.compression = compression, .tiled = tiled, .mode = mode}, 3);
                expect_pages<TypeParam>(read(name), 3);
            }
}

TEST(Tiff, EveryCompressionOfLibtiff) {
    const Folder folder;
    const std::string name = (folder / "a.tif").string();
    for (const int compression : {COMPRESSION_NONE, COMPRESSION_LZW, COMPRESSION_PACKBITS, COMPRESSION_DEFLATE,
                                  COMPRESSION_ADOBE_DEFLATE, COMPRESSION_LZMA, COMPRESSION_ZSTD, COMPRESSION_LERC})
        for (const bool tiled : {false, true})
            for (const int predictor : {1, 2}) {
                if (!TIFFIsCODECConfigured(std::uint16_t(compression))) continue;
                write_pages<std::uint16_t>(name, {.compression = compression, .tiled = tiled, .predictor = predictor},
                                           2);
                SCOPED_TRACE(compression);
                expect_pages<std::uint16_t>(read(name), 2);
                const std::string whole = content_of(name);
                refusal(folder.write("cut.tif", whole.substr(0, whole.size() / 2)));
                refusal(folder.write("cut.tif", whole.substr(0, whole.size() - 1)));
            }
    write_pages<std::uint8_t>(name, {.compression = COMPRESSION_JPEG}, 1);  // not exact, but close
    const auto jpeg = read(name);
    for (std::size_t i = 0; i < jpeg.voxel_count(); ++i)
        EXPECT_NEAR(jpeg.as<std::uint8_t>()[i], value_at<std::uint8_t>(int(i) % width, int(i) / width, 0, 0), 12);
}

TEST(Tiff, ColoursAndOtherValuesOfAPixel) {
    const Folder folder;
    const std::string name = (folder / "a.tif").string();
    const auto expect_values = [&](const Volume& volume, int values) {
        ASSERT_EQ(volume.components, values);
        const auto found = volume.as<std::uint8_t>();
        for (const auto& [x, y, z] : {std::array{5, 0, 0}, {7, 3, 1}})
            for (int s = 0; s < values; ++s)
                EXPECT_EQ(found[std::size_t(((z * height + y) * width + x) * values + s)],
                          value_at<std::uint8_t>(x, y, z, s));
    };
    for (const bool planes : {false, true})
        for (const bool tiled : {false, true})
            for (const int samples : {2, 3, 4}) {
                write_pages<std::uint8_t>(name, {.tiled = tiled, .planes = planes, .samples = samples}, 2);
                const auto volume = read(name);
                expect_values(volume, std::min(samples, 3));  // nothing says that the fourth is alpha
                EXPECT_EQ(volume.has_own_colors, samples > 2);
                EXPECT_EQ(has_note(volume, "in its own colours, its opacity by luminance"), samples > 2);
                EXPECT_EQ(has_note(volume, "4 values a pixel"), samples == 4);
            }
    for (const int kind : {1, 2}) {  // alpha that is multiplied in, and that is not
        write_pages<std::uint8_t>(name, {.samples = 4, .alpha = kind}, 2);
        expect_values(read(name), 4);
        write_pages<std::uint8_t>(name, {.samples = 2, .alpha = kind}, 2);
        expect_values(read(name), 1);
    }
    const auto white = read(folder.write("w.tif", tiff_file({{.photometric = 0}})));
    EXPECT_EQ(white.as<std::uint16_t>()[3], 65535 - 3);
    EXPECT_TRUE(has_note(white, "turned around"));
}

TEST(Tiff, FoldersFollowTheNaturalOrderOfNames) {
    const Folder folder;
    for (const int i : {10, 9, 2, 1, 100}) {
        TiffImage page{.pixels = bytes_of_all(std::vector<std::uint16_t>(12, std::uint16_t(i)))};
        folder.write("slice" + std::to_string(i) + ".tif", tiff_file({page}));
    }
    folder.write("notes.txt", "by hand");
    auto volume = read(folder.name());
    EXPECT_EQ(volume.format, "TIFF");
    ASSERT_EQ(volume.dimensions, (std::array{4, 3, 5}));
    for (const auto& [z, value] : {std::pair{0, 1}, {1, 2}, {2, 9}, {3, 10}, {4, 100}})
        EXPECT_EQ(volume.as<std::uint16_t>()[std::size_t(z) * 12], value);
    folder.write("slice011.TIFF", tiff_file({{.pixels = std::string(4, 'x'), .columns = 2, .rows = 2, .bits = 8}}));
    volume = read(folder.name());
    EXPECT_EQ(volume.dimensions[2], 5);
    EXPECT_TRUE(has_note(volume, "1 pictures of another size or type than 4 x 3 uint16 are left out: slice011.TIFF"));
    folder.write("slice012.tif", "no picture");
    EXPECT_NE(refusal(folder.name()).find("'slice012.tif'"), std::string::npos);
}

TEST(Tiff, ThumbnailsAreNoSlices) {
    const Folder folder;
    const TiffImage small{.pixels = std::string(2, 's'), .columns = 1, .rows = 1, .reduced = true};
    const auto volume = read(folder.write("a.tif", tiff_file({TiffImage{}, small, TiffImage{}})));
    EXPECT_EQ(volume.dimensions, (std::array{4, 3, 2}));
    EXPECT_EQ(volume.as<std::uint16_t>()[13], 1);
}

TEST(Tiff, SpacingIsWhatIsStated) {
    const Folder folder;
    const auto spacing = [&](const TiffImage& page) {
        return read(folder.write("a.tif", tiff_file({page, page}))).geometry.spacing_mm;
    };
    expect_near(spacing({}), {1, 1, 1});
    expect_near(spacing({.x_resolution = 254, .y_resolution = 508, .unit = 2}), {0.1, 0.05, 0.1});
    expect_near(spacing({.x_resolution = 100, .y_resolution = 50, .unit = 3}), {0.1, 0.2, 0.1});
    expect_near(spacing({.x_resolution = 2, .y_resolution = 1, .unit = 1}), {1, 2, 1});
    expect_near(spacing({.description = "ImageJ=1.53t\nimages=2\nslices=2\nunit=\\u00B5m\nspacing=3.5\n",
                         .x_resolution = 4,
                         .y_resolution = 2}),
                {0.00025, 0.0005, 0.0035});
    expect_near(spacing({.description = "ImageJ=1.53t\nimages=2\nslices=2\nunit=mm\nspacing=-2\n",
                         .x_resolution = 4,
                         .y_resolution = 4}),
                {0.25, 0.25, 2});
    const std::string ome =
        R"(<?xml version="1.0"?><OME xmlns="x"><Image ID="0"><Pixels DimensionOrder="XYZCT" SizeX="4")"
        R"( SizeY="3" SizeZ="2" SizeC="1" SizeT="1" PhysicalSizeX="0.5" PhysicalSizeY="0.25")"
        R"( PhysicalSizeZ="2" PhysicalSizeZUnit="mm"/></Image></OME>)";
    expect_near(spacing({.description = ome}), {0.0005, 0.00025, 2});
    TiffImage tags{.x_resolution = 254, .y_resolution = 254, .unit = 2};
    EXPECT_TRUE(
        has_note(read(folder.write("a.tif", tiff_file({tags, tags}))), "distance between slices is not stated"));
    EXPECT_TRUE(has_note(read(folder.write("a.tif", tiff_file({TiffImage{}}))), "size of a pixel is not stated"));
}

TEST(Tiff, HyperstacksGiveTheirChannelsAtTheirFirstTime) {
    const Folder folder;
    const auto pages = [&](const std::string& description) {
        std::vector<TiffImage> all;
        for (int i = 0; i < 12; ++i)
            all.push_back({.pixels = bytes_of_all(std::vector<std::uint16_t>(12, std::uint16_t(i)))});
        all[0].description = description;
        return all;
    };
    const auto firsts = [](const Volume& volume) {
        std::vector<int> values;
        for (int z = 0; z < volume.dimensions[2]; ++z)
            for (int c = 0; c < volume.components; ++c)
                values.push_back(volume.as<std::uint16_t>()[std::size_t(z * 12 * volume.components + c)]);
        return values;
    };
    auto volume = read(folder.write(
        "a.tif", tiff_file(pages("ImageJ=1.53t\nimages=12\nchannels=2\nslices=3\nframes=2\nhyperstack=true\n"))));
    EXPECT_EQ(volume.components, 2);
    EXPECT_EQ(firsts(volume), (std::vector{0, 1, 2, 3, 4, 5}));
    EXPECT_TRUE(volume.component_infos.empty());
    EXPECT_TRUE(has_note(volume, "2 moments in time"));
    volume = read(folder.write(
        "a.tif",
        tiff_file(pages(
            R"(<OME><Image><Pixels DimensionOrder="XYTCZ" SizeZ="3" SizeC="2" SizeT="2">)"
            R"(<Channel Name="DAPI" Color="65535"/><Channel Name="GFP" Color="-16711681"/></Pixels></Image></OME>)"))));
    EXPECT_EQ(firsts(volume), (std::vector{0, 2, 4, 6, 8, 10}));
    using Color = std::array<double, 3>;
    EXPECT_EQ(volume.component_infos, (std::vector<ComponentInfo>{{"DAPI", Color{0, 0, 1}}, {"GFP", Color{1, 0, 1}}}));
    volume = read(folder.write("a.tif", tiff_file(pages("ImageJ=1.53t\nimages=12\nchannels=12\n"))));
    EXPECT_EQ(firsts(volume), (std::vector{0, 1, 2, 3, 4, 5, 6, 7}));
    EXPECT_TRUE(has_note(volume, "holds 12 channels; the first 8 are taken"));
    volume = read(folder.write("a.tif", tiff_file(pages("ImageJ=1.53t\nimages=7\nslices=7\n"))));
    EXPECT_EQ(volume.dimensions[2], 12);
    EXPECT_TRUE(has_note(volume, "states 7 images, but there are 12 pages"));
    volume = read(folder.write("a.tif", tiff_file({{.description = "ImageJ=1.53t\ncf=0\nc0=-32768.0\nc1=1.0\n"}})));
    EXPECT_EQ(volume.intercept, -32768);
}

TEST(Tiff, PlanesThatLieInSeveralFilesAreReadFromAllOfThem) {
    const Folder folder;
    const auto page = [](int value) {
        return TiffImage{.pixels = bytes_of_all(std::vector<std::uint16_t>(12, std::uint16_t(value)))};
    };
    // Each channel in a file of its own, the second's slices from the last to the first.
    const std::string ome =
        R"(<OME><Image><Pixels DimensionOrder="XYZCT" SizeZ="2" SizeC="2" SizeT="1">)"
        R"(<TiffData FirstC="0" IFD="0" PlaneCount="2"><UUID FileName="a.tif">urn:uuid:1</UUID></TiffData>)"
        R"(<TiffData FirstC="1" FirstZ="1" IFD="0"><UUID FileName="b.tif">urn:uuid:2</UUID></TiffData>)"
        R"(<TiffData FirstC="1" FirstZ="0" IFD="1"><UUID FileName="b.tif">urn:uuid:2</UUID></TiffData>)"
        R"(</Pixels></Image></OME>)";
    const auto write = [&](const std::string& name, int first, const std::string& description, int pages = 2) {
        std::vector<TiffImage> all{page(first)};
        all[0].description = description;
        for (int i = 1; i < pages; ++i) all.push_back(page(first + i));
        return folder.write(name, tiff_file(all));
    };
    const std::string a = write("a.tif", 10, ome), b = write("b.tif", 20, ome);
    for (const std::string& name : {a, b}) {
        const Volume volume = read(name);
        EXPECT_EQ(volume.dimensions, (std::array{4, 3, 2}));
        ASSERT_EQ(volume.components, 2);
        const auto found = volume.as<std::uint16_t>();
        EXPECT_EQ((std::array{found[0], found[1], found[24], found[25]}),
                  (std::array<std::uint16_t, 4>{10, 21, 11, 20}));
    }
    write("b.tif", 20, ome, 1);
    expect_refused(a, "names page 1 of 'b.tif', which has 1");
    folder.write("b.tif", "II");
    expect_refused(a, "'b.tif'");
    fs::remove(folder / "b.tif");
    EXPECT_EQ(read(a).components, 1);
    EXPECT_EQ(read(a).dimensions[2], 2);
    EXPECT_TRUE(has_note(read(a), "names pages in 2 files, of which 'b.tif' is not there"));
    std::string climbs = ome;
    climbs.replace(climbs.find("b.tif"), 5, "../b.tif");
    expect_refused(write("a.tif", 10, climbs), "data files must lie in the folder");
    std::string few = ome;
    few.replace(few.find("PlaneCount=\"2\""), 14, "PlaneCount=\"1\"");
    write("b.tif", 20, few);
    expect_refused(write("a.tif", 10, few), "says where 3 of 4 pages lie");
    const std::string elsewhere = R"(<OME><BinaryOnly MetadataFile="all.companion.ome" UUID="urn:uuid:1"/></OME>)";
    EXPECT_TRUE(has_note(read(write("a.tif", 10, elsewhere)), "is told in 'all.companion.ome', which is not read"));
}

TEST(Tiff, LargeStacksOfImageJHaveOneDirectory) {
    const Folder folder;
    for (const bool big_endian : {false, true}) {
        const auto values = ramp<std::uint16_t>(36);
        const std::string all = bytes_of_all(values, big_endian);
        TiffImage first{.pixels = all.substr(0, 24), .description = "ImageJ=1.53t\nimages=3\nslices=3\n"};
        const std::string file = tiff_file({first}, big_endian, all.substr(24));
        EXPECT_EQ(voxels_of<std::uint16_t>(read(folder.write("a.tif", file))), values);
        EXPECT_NE(refusal(folder.write("a.tif", file.substr(0, file.size() - 1))).find("truncated"), std::string::npos);
        first.description = "ImageJ=1.53t\nimages=3\nchannels=3\n";
        const Volume volume = read(folder.write("c.tif", tiff_file({first}, big_endian, all.substr(24))));
        ASSERT_EQ(volume.components, 3);
        for (std::size_t i = 0; i < 36; ++i) EXPECT_EQ(volume.as<std::uint16_t>()[3 * (i % 12) + i / 12], values[i]);
    }
}

// The look-up tables of a composite, as ImageJ writes them behind its description: tags 50838 and 50839.
TEST(Tiff, ImageJsColorsAreThoseOfItsTables) {
    const Folder folder;
    const auto number = [](std::uint32_t n) { return bytes_of(n, true); };
    std::string red(768, '\0'), cyan(768, '\0');
    red[255] = char(255), cyan[511] = char(255), cyan[767] = char(255);
    const std::string header = "IJIJ" + std::string("info") + number(1) + "luts" + number(2);
    const auto colors_of = [&](std::vector<std::uint32_t> counts, std::string metadata, std::uint16_t type) {
        const std::string name = (folder / "a.tif").string();
        static const TIFFFieldInfo tags[] = {
            {50838, -1, -1, TIFF_LONG, FIELD_CUSTOM, 1, 1, const_cast<char*>("IJMetadataByteCounts")},
            {50839, -1, -1, TIFF_BYTE, FIELD_CUSTOM, 1, 1, const_cast<char*>("IJMetadata")}};
        TIFF* file = TIFFOpen(name.c_str(), "wb");
        TIFFMergeFieldInfo(file, tags, 2);
        for (int page = 0; page < 2; ++page) {
            TIFFSetField(file, TIFFTAG_IMAGEWIDTH, 2);
            TIFFSetField(file, TIFFTAG_IMAGELENGTH, 1);
            TIFFSetField(file, TIFFTAG_BITSPERSAMPLE, 8);
            TIFFSetField(file, TIFFTAG_SAMPLESPERPIXEL, 1);
            TIFFSetField(file, TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_MINISBLACK);
            TIFFSetField(file, TIFFTAG_IMAGEDESCRIPTION, "ImageJ=1.53t\nimages=2\nchannels=2\n");
            if (page == 0 && type == TIFF_LONG) TIFFSetField(file, 50838, std::uint32_t(counts.size()), counts.data());
            if (page == 0) TIFFSetField(file, 50839, std::uint32_t(metadata.size()), metadata.data());
            TIFFWriteEncodedStrip(file, 0, const_cast<char*>("ab"), 2);
            TIFFWriteDirectory(file);
        }
        TIFFClose(file);
        return read(name).component_infos;
    };
    using Color = std::array<double, 3>;
    const std::vector<std::uint32_t> counts{20, 4, 768, 768};
    EXPECT_EQ(colors_of(counts, header + "note" + red + cyan, TIFF_LONG),
              (std::vector<ComponentInfo>{{"", Color{1, 0, 0}}, {"", Color{0, 1, 1}}}));
    EXPECT_TRUE(colors_of(counts, header + "note" + red + cyan, 0).empty());  // no counts
    EXPECT_TRUE(colors_of({20, 4, 4000000000u, 768}, header + "note" + red, TIFF_LONG).empty());
    EXPECT_TRUE(colors_of({9999999}, header, TIFF_LONG).empty());
}

TEST(Tiff, RefusesWhatItCannotShow) {
    const Folder folder;
    const auto expect = [&](const TiffImage& page, const std::string& part) {
        const auto sentence = refusal(folder.write("a.tif", tiff_file({page})));
        EXPECT_NE(sentence.find(part), std::string::npos) << sentence;
    };
    expect({.bits = 1}, "bits");
    expect({.bits = 12}, "bits");
    expect({.bits = 16, .format = 3}, "16 bits as floats");
    expect({.photometric = 5}, "photometric");
    expect({.photometric = 2}, "RGB with 1");
    expect({.columns = 60000, .rows = 60000}, "truncated");
    expect({.columns = 70000}, "70000");
    expect({.columns = 0}, "");
    expect({.description = "ImageJ=1\nimages=-4\n"}, "images");
    expect({.description = "ImageJ=1\nimages=999999\n"}, "truncated");
    std::string loop = tiff_file({TiffImage{}, TiffImage{}});
    EXPECT_NO_THROW(read(folder.write("a.tif", loop)));
    const auto next = 8 + 2 + 12 * 10;  // the first page's link to the second: now to itself
    loop.replace(next, 4, bytes_of(std::uint32_t(8)));
    refusal(folder.write("a.tif", loop));
}

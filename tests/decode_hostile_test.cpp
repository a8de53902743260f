// Files that are damaged or lie: each must end in one sentence, soon, and without taking the machine's memory.
#include "hdf5_files.h"
#include "hostile_headers.h"
#include "tiff_files.h"
#include "vdb_bytes.h"
#include "vtk_files.h"

#include <chiaro/error.h>
#include <fmt/format.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>

#include <chrono>
#include <functional>
#include <random>

using namespace chiaro;
using namespace volume_files;

namespace {

std::string gzipped_zeros(std::size_t size) { return deflated(std::string(size, '\0')); }

std::string wrong_checksum(std::string gzip) {
    gzip[gzip.size() - 6] ^= 1;
    return gzip;
}

std::string deflated_block(const std::string& bytes) { return deflated(bytes, 15); }

/// One valid file of every kind.
std::vector<std::pair<std::string, std::string>> valid_files() {
    const auto nifti = Nifti(2, 8);
    const Folder folder;
    const Vti packed{.format = "binary", .compressor = "vtkZLibDataCompressor", .compress = deflated_block};
    std::vector<std::pair<std::string, std::string>> files{
        {"good.nrrd", nrrd_good + "\n" + voxels},
        {"packed.nrrd", nrrd_start + "sizes: 4 3 2\nencoding: gzip\n\n" + deflated(voxels)},
        {"text.nrrd", nrrd_start + "sizes: 2 1 1\nencoding: ascii\n\n1 2"},
        {"good.mha", meta_good + "ElementDataFile = LOCAL\n" + voxels},
        {"packed.mha", meta_good + "CompressedData = True\nElementDataFile = LOCAL\n" + deflated(voxels, 15)},
        {"good.nii", nifti.bytes() + voxels},
        {"good.nii.gz", deflated(nifti.bytes() + voxels)},
        {"good.dcm", Dicom{}.bytes()},
        {"good.tif", tiff_file({TiffImage{}, TiffImage{}})},
        {"good.vti", Vti{}.bytes()},
        {"packed.vti", packed.bytes()},
        {"good.vtk", vtk_file()},
        {"good.h5", hdf5_file(folder, false)},
        {"packed.h5", hdf5_file(folder, true)},
        {"good_4x3x2_uint8.raw", voxels}};
    if (fs::exists(built("chiaro-decode-vdb")))
        for (const std::uint32_t version : {220, 224})
            files.emplace_back(fmt::format("good{}.vdb", version), VdbBytes{version}.bytes());
    return files;
}

struct Hostile {
    std::string name, bytes;
};

std::vector<Hostile> lying_headers() {
    const std::string directions = "space: LPS\nsizes: 4 3 2\nencoding: raw\nspace directions: ";
    const std::string unit = "(1,0,0) (0,1,0) (0,0,1)";
    auto far = Nifti(2, 8), huge = Nifti(2, 8), nan = Nifti(2, 8), bits = Nifti(2, 16), type = Nifti(99, 8),
         singular = Nifti(2, 8), negative = Nifti(2, 8), within = Nifti(2, 8), infinite = Nifti(2, 8),
         zero = Nifti(2, 8);
    for (std::size_t i = 0; i < 3; ++i) huge.set<std::int16_t>(42 + 2 * i, 32767);
    Dicom many_rows, nan_place, flat;
    many_rows.stated_rows = 60000;
    nan_place.position[1] = std::numeric_limits<double>::quiet_NaN();
    flat.orientation = {1, 0, 0, 1, 0, 0};
    Dicom no_spacing;
    no_spacing.row_spacing = 0;
    return {
        {"sizes.nrrd", nrrd_start + "sizes: 100000 100000 100000\nencoding: raw\n\n" + voxels},
        {"huge.nrrd", nrrd_start + "sizes: 60000 60000 60000\nencoding: raw\n\n" + voxels},
        {"hugegzip.nrrd", nrrd_start + "sizes: 60000 60000 60000\nencoding: gzip\n\n" + deflated(voxels)},
        {"hugetext.nrrd", nrrd_start + "sizes: 60000 60000 60000\nencoding: ascii\n\n1 2 3"},
        {"hugedouble.nrrd",
         "NRRD0004\ntype: double\ndimension: 4\nkinds: list space space space\n"
         "sizes: 65535 65535 65535 65535\nendian: little\nencoding: raw\n\n" +
             voxels},
        {"overflow.nrrd", nrrd_start + "sizes: 99999999999999999999 1 1\nencoding: raw\n\n" + voxels},
        {"negative.nrrd", nrrd_start + "sizes: -4 -3 2\nencoding: raw\n\n" + voxels},
        {"zero.nrrd", nrrd_start + "sizes: 0 3 2\nencoding: raw\n\n" + voxels},
        {"dimension.nrrd", "NRRD0004\ntype: uchar\ndimension: 2000000000\nsizes: 4 3 2\nencoding: raw\n\n" + voxels},
        {"nosizes.nrrd", nrrd_start + "encoding: raw\n\n" + voxels},
        {"type.nrrd", "NRRD0004\ntype: block\ndimension: 3\nsizes: 4 3 2\nencoding: raw\n\n" + voxels},
        {"encoding.nrrd", nrrd_start + "sizes: 4 3 2\nencoding: bzip2\n\n" + voxels},
        {"noendian.nrrd", "NRRD0004\ntype: short\ndimension: 3\nsizes: 2 3 2\nencoding: raw\n\n" + voxels},
        {"nanspacing.nrrd", nrrd_good + "spacings: nan 1 1\n\n" + voxels},
        {"zerospacing.nrrd", nrrd_good + "spacings: 1 0 1\n\n" + voxels},
        {"minus.nrrd", nrrd_good + "spacings: 1 -1 1\n\n" + voxels},
        {"few.nrrd", nrrd_good + "spacings: 1 1\n\n" + voxels},
        {"words.nrrd", nrrd_good + "spacings: one two three\n\n" + voxels},
        {"nandirection.nrrd", nrrd_start + directions + "(nan,0,0) (0,1,0) (0,0,1)\n\n" + voxels},
        {"singular.nrrd", nrrd_start + directions + "(1,0,0) (2,0,0) (0,0,1)\n\n" + voxels},
        {"zerodirection.nrrd", nrrd_start + directions + "(0,0,0) (0,1,0) (0,0,1)\n\n" + voxels},
        {"tooMany.nrrd", nrrd_start + directions + unit + " (1,1,1)\n\n" + voxels},
        {"brackets.nrrd", nrrd_start + directions + "((((((((\n\n" + voxels},
        {"nanorigin.nrrd", nrrd_start + directions + unit + "\nspace origin: (0,nan,0)\n\n" + voxels},
        {"skip.nrrd", nrrd_good + "byte skip: 99999999999\n\n" + voxels},
        {"lines.nrrd", nrrd_good + "line skip: 99999999999\n\n" + voxels},
        {"back.nrrd", nrrd_good + "byte skip: -7\n\n" + voxels},
        {"noend.nrrd", nrrd_good + std::string(2 << 20, '#')},
        {"checksum.nrrd", nrrd_start + "sizes: 4 3 2\nencoding: gzip\n\n" + wrong_checksum(deflated(voxels))},
        {"sizes.mha", meta_start + "DimSize = 100000 100000 100000\nElementDataFile = LOCAL\n" + voxels},
        {"huge.mha", meta_start + "DimSize = 60000 60000 60000\nElementDataFile = LOCAL\n" + voxels},
        {"hugepacked.mha", meta_start +
                               "DimSize = 60000 60000 60000\nCompressedData = True\nElementDataFile = LOCAL\n" +
                               deflated(voxels, 15)},
        {"channels.mha", meta_good + "ElementNumberOfChannels = 1000000\nElementDataFile = LOCAL\n" + voxels},
        {"nospacing.mha", meta_good + "ElementSpacing = 1 nan 1\nElementDataFile = LOCAL\n" + voxels},
        {"minus.mha", meta_good + "ElementSpacing = 1 -2 1\nElementDataFile = LOCAL\n" + voxels},
        {"matrix.mha", meta_good + "TransformMatrix = 1 0 0 1 0 0 0 0 1\nElementDataFile = LOCAL\n" + voxels},
        {"nanmatrix.mha", meta_good + "TransformMatrix = nan 0 0 0 1 0 0 0 1\nElementDataFile = LOCAL\n" + voxels},
        {"inforigin.mha", meta_good + "Offset = inf 0 0\nElementDataFile = LOCAL\n" + voxels},
        {"slope.mha", meta_good + "ElementToIntensityFunctionSlope = nan\nElementDataFile = LOCAL\n" + voxels},
        {"object.mha", "ObjectType = Tube\n" + meta_good + "ObjectType = Tube\nElementDataFile = LOCAL\n" + voxels},
        {"nodata.mha", meta_good},
        {"type.mha", "NDims = 3\nElementType = MET_NONE\nDimSize = 4 3 2\nElementDataFile = LOCAL\n" + voxels},
        {"huge.nii", huge.bytes() + voxels},
        {"huge.nii.gz", deflated(huge.bytes() + voxels)},
        {"bits.nii", bits.bytes() + voxels},
        {"type.nii", type.bytes() + voxels},
        {"zero.nii", zero.set<std::int16_t>(44, 0).bytes() + voxels},
        {"negative.nii", negative.set<std::int16_t>(44, -3).bytes() + voxels},
        {"nan.nii", nan.set<float>(80, std::nanf("")).bytes() + voxels},
        {"singular.nii", singular.sform({1, 0, 0, 0, 1, 0, 0, 0, 0, 0, 1, 0}).bytes() + voxels},
        {"infinite.nii", infinite.qform(0, 0, 0, {INFINITY, 0, 0}).bytes() + voxels},
        {"far.nii", far.set<float>(108, 1e12F).bytes() + voxels},
        {"within.nii", within.set<float>(108, 16).bytes() + voxels},
        {"rows.dcm", many_rows.bytes()},
        {"nan.dcm", nan_place.bytes()},
        {"flat.dcm", flat.bytes()},
        {"nospacing.dcm", no_spacing.bytes()},
        {"huge_60000x60000x60000_uint8.raw", voxels},
        {"axis_100000x1x1_uint8.raw", std::string(100000, 'v')},
        {"overflow_99999999999x1x1_uint8.raw", voxels},
    };
}

}  // namespace

TEST(Hostile, EveryFormatCutAnywhere) {
    const Folder folder;
    for (const auto& [name, bytes] : valid_files()) {
        EXPECT_NO_THROW(read(folder.write(name, bytes))) << name;
        for (const std::size_t size :
             {std::size_t(0), std::size_t(1), std::size_t(9), bytes.size() / 3, bytes.size() - 1})
            expect_refused(folder.write("cut" + std::to_string(size) + name, bytes.substr(0, size)));
    }
}

TEST(Hostile, GarbageUnderEveryName) {
    const Folder folder;
    std::mt19937 random(1);
    std::string garbage(5000, '\0');
    for (char& c : garbage) c = char(random());
    for (const std::string ending : {".nrrd", ".nhdr", ".mha", ".mhd", ".nii", ".nii.gz", ".hdr", ".dcm", ".tif",
                                     ".vti", ".vtk", ".h5", ".vdb", ".raw", ".xyz"})
        expect_refused(folder.write("garbage" + ending, garbage));
    for (const auto& [name, bytes] : valid_files())
        if (name != "good_4x3x2_uint8.raw") expect_refused(folder.write("magic" + name, bytes.substr(0, 8) + garbage));
    expect_refused(folder.name());
}

TEST(Hostile, LyingHeaders) {
    const Folder folder;
    for (const auto& [name, bytes] : lying_headers()) expect_refused(folder.write(name, bytes));
}

TEST(Hostile, DetachedDataStayInTheHeadersFolder) {
    const Folder outside, folder;
    const std::string secret = outside.write("secret.raw", voxels);
    fs::create_directory(folder / "sub");
    fs::create_symlink(secret, folder / "link.raw");
    fs::create_directory_symlink(outside.name(), folder / "away");
    folder.write("inside.raw", voxels);
    fs::create_symlink("inside.raw", folder / "near.raw");
    const std::string climbing = std::string("../") + fs::path(outside.name()).filename().string() + "/secret.raw";
    for (const std::string& path :
         {secret, climbing, std::string("sub/../../x.raw"), std::string("link.raw"), std::string("away/secret.raw"),
          std::string("/etc/passwd"), std::string(""), std::string("sub"), std::string("absent.raw")}) {
        expect_refused(folder.write("a.nhdr", nrrd_good + "data file: " + path + "\n"));
        expect_refused(folder.write("b.nhdr", nrrd_good + "data file: LIST\n" + path + "\n"));
        expect_refused(folder.write("c.mhd", meta_good + "ElementDataFile = " + path + "\n"));
        expect_refused(folder.write("d.mhd", meta_good + "ElementDataFile = LIST\n" + path + "\n"));
    }
    for (const std::string pattern :
         {"../s%d.raw 1 2 1", "%s%d 1 2 1", "%n 1 2 1", "%99999d 1 2 1", "s%d.raw 1 9999999999 1", "s%d.raw 2 1 1",
          "s%d.raw 9223372036854775806 9223372036854775807 2"}) {
        expect_refused(folder.write("e.nhdr", nrrd_good + "data file: " + pattern + "\n"));
        expect_refused(folder.write("f.mhd", meta_good + "ElementDataFile = " + pattern + "\n"));
    }
    auto pair = Nifti(2, 8);
    pair.set<float>(108, 0).set<char>(345, 'i');
    fs::create_symlink(secret, folder / "p.img");
    expect_refused(folder.write("p.hdr", pair.bytes().substr(0, 348)));
    EXPECT_NO_THROW(read(folder.write("g.nhdr", nrrd_good + "data file: near.raw\n")));
}

TEST(Hostile, EndlessData) {
    const Folder folder;
    const std::string fifo = (folder / "fifo.nrrd").string();
    ASSERT_EQ(mkfifo(fifo.c_str(), 0600), 0);
    expect_refused(fifo);
    expect_refused("/dev/zero");
    ASSERT_EQ(mkfifo((folder / "data.raw").c_str(), 0600), 0);
    expect_refused(folder.write("detached.nhdr", nrrd_good + "data file: data.raw\n"));
    // 64 MiB of zeros in 64 KiB, where the header promises 24 bytes: read no further than promised.
    const auto bomb =
        read(folder.write("bomb.nrrd", nrrd_start + "sizes: 4 3 2\nencoding: gzip\n\n" + gzipped_zeros(64 << 20)));
    EXPECT_TRUE(has_note(bomb, "more data"));
    const std::string packed = gzipped_zeros(64 << 20);
    expect_refused(folder.write("large.nrrd", nrrd_start + "sizes: 512 512 256\nencoding: gzip\n\n" + packed),
                   {.raw = {}, .series = {}, .rescale = {}, .max_bytes = 16 << 20});
    expect_refused(folder.write("long.nii", std::string("\x1f\x8b", 2) + std::string(1 << 20, '\x1f')));
}

TEST(Hostile, ADecoderThatHangsOrDiesIsOneSentence) {
    const Folder folder;
    const std::string good = folder.write("good.nrrd", nrrd_good + "\n" + voxels);
    const auto decoder = [&](const std::string& script) {
        const std::string path = folder.write("decoder", "#!/bin/sh\n" + script + "\n");
        fs::permissions(path, fs::perms::owner_all);
        setenv("CHIARO_DECODE", path.c_str(), 1);
        Progress progress;
        ReadOptions options;
        options.seconds = 2;
        options.stall_seconds = 0.5;
        try {
            read_volume(good, options, progress);
            ADD_FAILURE() << script;
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), ErrorCode::input) << error.what();
        }
        EXPECT_EQ(waitpid(-1, nullptr, WNOHANG), -1) << "a zombie of: " << script;
    };
    const std::string volume =
        R"({"volume":{"dimensions":[4,3,2],"type":0,"components":1,"slope":1,"intercept":0,"spacing_mm":[1,1,1],)"
        R"("origin_mm":[0,0,0],"direction":[[1,0,0],[0,1,0],[0,0,1]],"world":0,"format":"","modality":"",)"
        R"("notes":[],"key_values":{}}})";
    for (const std::string& script :
         {std::string("exec sleep 60"), std::string("exec 4>&-; exec sleep 60"), std::string("kill -SEGV $$"),
          std::string("exit 0"), std::string("echo garbage >&4"), std::string("echo '{\"volume\": 3}' >&4"),
          std::string("echo '[]' >&4"), std::string("while :; do echo '{\"progress\":0}' >&4; done"),
          std::string("while :; do printf xxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxx >&4; done"),
          fmt::format("echo '{}' >&4", volume)})
        decoder(script);
}

TEST(Hostile, WithoutTheProgramForAFormatASentenceNamesIt) {
    const Folder folder;
    fs::copy(built("chiaro-decode"), folder / "chiaro-decode");
    setenv("CHIARO_DECODE", (folder / "chiaro-decode").c_str(), 1);
    const std::string grid = folder.write("a.vdb", VdbBytes().bytes()),
                      good = folder.write("good.nrrd", nrrd_good + "\n" + voxels);
    Progress progress;
    EXPECT_NO_THROW(read_volume(good, {}, progress));
    try {
        read_volume(grid, {}, progress);
        ADD_FAILURE();
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::input);
        EXPECT_NE(std::string(error.what())
                      .find("chiaro-decode-vdb is missing beside chiaro-decode: it is built where "
                            "libopenvdb is found"),
                  std::string::npos)
            << error.what();
    }
}

TEST(Hostile, ChangedBytesAreOneSentenceAtMost) {
    const Folder folder;
    std::mt19937 random(7);
    for (const auto& [name, bytes] : valid_files())
        for (int round = 0; round < 12; ++round) {
            std::string changed = bytes;
            for (int i = 0; i < 3; ++i) changed[random() % std::min<std::size_t>(changed.size(), 700)] = char(random());
            try {
                read(folder.write(name, changed));
            } catch (const Error& error) {
                EXPECT_EQ(error.code(), ErrorCode::input) << error.what();
                const bool crashed = std::string(error.what()).find("crashed") != std::string::npos;
                EXPECT_TRUE(!crashed || may_crash(name)) << error.what();
            }
        }
}

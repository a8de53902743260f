// Volumes that change with time: which moment is read, from every format that holds several.
#include "tiff_files.h"
#include "volume_files.h"

#include <chiaro/error.h>
#include <fmt/format.h>

using namespace chiaro;
using namespace volume_files;

namespace {

constexpr int count = 5;
constexpr std::size_t voxels = 24;  // 4 x 3 x 2

/// Every voxel of every moment has another value.
std::uint16_t value_of(int moment, std::size_t voxel) { return std::uint16_t(100 * moment + int(voxel)); }

std::vector<std::uint16_t> moment_of(int moment) {
    std::vector<std::uint16_t> values(voxels);
    for (std::size_t i = 0; i < voxels; ++i) values[i] = value_of(moment, i);
    return values;
}

/// All moments, of which `run` voxels of one follow each other before the next one's.
std::vector<std::uint16_t> all_by_runs_of(std::size_t run) {
    std::vector<std::uint16_t> values;
    for (std::size_t first = 0; first < voxels; first += run)
        for (int t = 0; t < count; ++t)
            for (std::size_t i = first; i < first + run; ++i) values.push_back(value_of(t, i));
    return values;
}

Volume read_at(const std::string& name, int time) {
    ReadOptions options;
    options.time = time;
    return read(name, options);
}

std::string refusal_at(const std::string& name, int time) {
    try {
        read_at(name, time);
    } catch (const Error& error) {
        return error.what();
    }
    return "";
}

/// That a file holds them all, in order, and says so.
void expect_moments(const std::string& name, const std::vector<double>& times, const std::string& unit) {
    for (const int t : {0, 3, count - 1}) {
        const Volume volume = read_at(name, t);
        EXPECT_EQ(voxels_of<std::uint16_t>(volume), moment_of(t)) << name << " at " << t;
        EXPECT_EQ(volume.moments.count, count) << name;
        EXPECT_EQ(volume.moments.shown, t);
        EXPECT_EQ(volume.moments.times, times) << name;
        EXPECT_EQ(volume.moments.unit, unit) << name;
        EXPECT_EQ(has_note(volume, "holds 5 moments in time; the first is shown (--time N"), t == 0) << name;
    }
    EXPECT_NE(refusal_at(name, count).find(" 5"), std::string::npos) << refusal_at(name, count);
}

std::string nrrd(const std::string& fields, const std::string& data, const std::string& encoding = "raw") {
    return "NRRD0005\ntype: uint16\ndimension: 4\nendian: little\nencoding: " + encoding + "\n" + fields + "\n" + data;
}

}  // namespace

TEST(Moments, OfNiftiHaveTheirTimes) {
    const Folder folder;
    auto header = Nifti(512, 16);
    header.set<std::int16_t>(40, 4).set<std::int16_t>(48, count).set<float>(92, 50).set<float>(136, 10);
    header.set<std::uint8_t>(123, 2 + 16);  // mm and ms
    const std::string all = bytes_of_all(all_by_runs_of(voxels));
    expect_moments(folder.write("a.nii", header.bytes() + all), {10, 60, 110, 160, 210}, "ms");
    expect_moments(folder.write("a.nii.gz", deflated(header.bytes() + all)), {10, 60, 110, 160, 210}, "ms");
    const auto big = Nifti(512, 16, true).set<std::int16_t>(40, 4).set<std::int16_t>(48, count).bytes();
    expect_moments(folder.write("b.nii", big + bytes_of_all(all_by_runs_of(voxels), true)), {}, "");
    EXPECT_NE(refusal_at(folder.write("c.nii", header.bytes() + all.substr(1)), 0).find("can hold at most"),
              std::string::npos);
}

TEST(Moments, OfNrrdWhereverTimeStands) {
    const Folder folder;
    const struct {
        const char *sizes, *kinds, *spacings;
        std::size_t run;
    } cases[] = {{"4 3 2 5", "domain domain domain time", "1 1 1 0.5", 24},
                 {"4 3 5 2", "domain domain time domain", "1 1 0.5 1", 12},
                 {"4 5 3 2", "domain time domain domain", "1 0.5 1 1", 4},
                 {"5 4 3 2", "time domain domain domain", "0.5 1 1 1", 1}};
    for (const auto& [sizes, kinds, spacings, run] : cases) {
        const std::string fields = fmt::format("sizes: {}\nkinds: {}\nspacings: {}\n", sizes, kinds, spacings);
        const auto all = all_by_runs_of(run);
        std::string text;
        for (const auto value : all) text += std::to_string(value) + " ";
        text.back() = '\n';
        const std::vector<double> times{0, 0.5, 1, 1.5, 2};
        expect_moments(folder.write("raw.nrrd", nrrd(fields, bytes_of_all(all))), times, "");
        expect_moments(folder.write("gz.nrrd", nrrd(fields, deflated(bytes_of_all(all)), "gzip")), times, "");
        expect_moments(folder.write("text.nrrd", nrrd(fields, text, "ascii")), times, "");
        EXPECT_EQ(read_at((folder / "raw.nrrd").string(), 1).geometry.spacing_mm, (Vec3{1, 1, 1}));
    }
}

TEST(Moments, OfNrrdByDirectionsAndSequences) {
    const Folder folder;
    const std::string all = bytes_of_all(all_by_runs_of(1)), slices = bytes_of_all(all_by_runs_of(12));
    const std::string steps = "(2,0,0) (0,3,0) (0,0,4)";
    const std::string fields = "sizes: 4 3 5 2\nspace: LPS\nspace origin: (7,8,9)\n";
    expect_moments(folder.write("a.nrrd", nrrd(fields + "space directions: (2,0,0) (0,3,0) none (0,0,4)\n", slices)),
                   {}, "");
    const std::string four = "sizes: 4 3 5 2\nspace: LPST\nspace origin: (7,8,9,0)\n";
    const std::string path =
        folder.write("b.nrrd", nrrd(four + "space directions: (2,0,0,0) (0,3,0,0) (0,0,0,1) (0,0,4,0)\n", slices));
    expect_moments(path, {}, "");
    EXPECT_EQ(read_at(path, 2).geometry.spacing_mm, (Vec3{2, 3, 4}));
    EXPECT_EQ(read_at(path, 2).geometry.origin_mm, (Vec3{7, 8, 9}));
    const std::string list =
        "sizes: 5 4 3 2\nkinds: list domain domain domain\nspace: LPS\nspace directions: none " + steps + "\n";
    expect_moments(
        folder.write("multivolume.nrrd", nrrd(list + "MultiVolume.FrameIdentifyingDICOMTagName:=TriggerTime\n"
                                                     "MultiVolume.FrameIdentifyingDICOMTagUnits:=ms\n"
                                                     "MultiVolume.FrameLabels:=0,40,80,120,161\n",
                                              all)),
        {0, 40, 80, 120, 161}, "ms");
    EXPECT_EQ(read_at(folder.write("vector.nrrd", nrrd(list, all)), 0).components, 5);  // not a word of time
}

TEST(Moments, OfNrrdInFilesOfTheirOwn) {
    const Folder folder;
    for (int t = 0; t < count; ++t) folder.write(fmt::format("m{}.raw", t), bytes_of_all(moment_of(t)));
    const std::string fields = "sizes: 4 3 2 5\nkinds: domain domain domain time\ndata file: m%d.raw 0 4 1\n";
    expect_moments(folder.write("a.nhdr", nrrd(fields, "")), {}, "");
}

TEST(Moments, OfTiff) {
    const Folder folder;
    const auto pages = [](const std::string& description, auto&& page) {
        std::vector<TiffImage> all(2 * count);
        for (int t = 0; t < count; ++t)
            for (std::size_t z = 0; z < 2; ++z) {
                const auto moment = moment_of(t);
                const auto slice = moment.begin() + std::ptrdiff_t(12 * z);
                all[page(std::size_t(t), z)].pixels = bytes_of_all(std::vector<std::uint16_t>(slice, slice + 12));
            }
        all[0].description = description;
        return tiff_file(all);
    };
    const auto by_time = [](std::size_t t, std::size_t z) { return 2 * t + z; };
    const auto by_slice = [](std::size_t t, std::size_t z) { return std::size_t(count) * z + t; };
    const std::string imagej = "ImageJ=1.53t\nimages=10\nslices=2\nframes=5\nfinterval=0.25\nhyperstack=true\n";
    expect_moments(folder.write("a.tif", pages(imagej, by_time)), {0, 0.25, 0.5, 0.75, 1}, "s");
    const std::string ome = R"(<OME><Image><Pixels DimensionOrder="XYTZC" SizeZ="2" SizeT="5" TimeIncrement="500"
 TimeIncrementUnit="ms"/></Image></OME>)";
    expect_moments(folder.write("b.tif", pages(ome, by_slice)), {0, 0.5, 1, 1.5, 2}, "s");
}

namespace {

/// Two places; moments in no order of files or instances, each picture stating its time by `element`.
template <class Element>
void write_phases(const Folder& folder, Element&& element) {
    for (int t = 0; t < count; ++t)
        for (int z = 0; z < 2; ++z) {
            Dicom slice{.instance = 1 + (7 * (2 * t + z)) % 10, .position = {0, 0, 3.0 * z}};
            const auto all = moment_of(t);
            slice.pixels = {all.begin() + 12 * z, all.begin() + 12 * z + 12};
            slice.functional_groups = element(t, z);
            folder.write(fmt::format("im{}.dcm", (3 * (2 * t + z)) % 10), slice.bytes());
        }
}

}  // namespace

TEST(Moments, OfDicomByTriggerTimeOrTemporalPosition) {
    const Folder trigger, position, untold, uneven;
    // The heart's beats differ a little from slice to slice.
    write_phases(trigger, [](int t, int z) {
        const std::string delay = bytes_of(40.0 * t + 1.5 * z);
        return Dicom::element(0x18, 0x9153, "FD", delay);
    });
    expect_moments(trigger.name(), {0, 40, 80, 120, 160}, "ms");
    write_phases(position, [](int t, int) { return Dicom::element(0x20, 0x100, "IS", std::to_string(t + 1)); });
    expect_moments(position.name(), {1, 2, 3, 4, 5}, "");
    write_phases(untold, [](int, int) { return std::string(); });
    EXPECT_TRUE(has_note(read_at(untold.name(), 0),
                         "8 slices lie at the place of another; no trigger time or temporal position tells when"));
    EXPECT_NE(refusal_at(untold.name(), 1).find("one moment"), std::string::npos);
    write_phases(uneven, [](int t, int) { return Dicom::element(0x20, 0x100, "IS", std::to_string(t + 1)); });
    fs::remove(uneven / "im9.dcm");
    EXPECT_TRUE(has_note(read_at(uneven.name(), 0), "the places have 4 to 5 each"));
}

TEST(Moments, OfFilesThatAPatternNames) {
    const Folder folder;
    const auto one = [](int t) {
        return "NRRD0004\ntype: uint16\ndimension: 3\nendian: little\nencoding: raw\nsizes: 4 3 2\n\n" +
               bytes_of_all(moment_of(t));
    };
    const int numbers[] = {2, 3, 5, 9, 10};  // 4, 6, 7 and 8 are missing
    for (int t = 0; t < count; ++t) folder.write(fmt::format("scan_{:03}.nrrd", numbers[t]), one(t));
    folder.write("scan_7.nrrd", one(0)), folder.write("scan_007b.nrrd", one(0));  // other names
    const std::string pattern = (folder / "scan_{t:03}.nrrd").string();
    expect_moments(pattern, {2, 3, 5, 9, 10}, "file");
    EXPECT_TRUE(has_note(read_at(pattern, 3), "the files of number 4, 6 to 8 are missing"));
    EXPECT_EQ(read_at(pattern, 1).source, pattern);
    EXPECT_EQ(moment_files(pattern).size(), 5u);
    EXPECT_EQ(moment_files((folder / "scan_{t}.nrrd").string()).size(), 1u);  // 7: the others have zeros before
    for (int t = 0; t < count; ++t) folder.write(fmt::format("phase{}/heart.nrrd", t), one(t));
    expect_moments((folder / "phase{t}/heart.nrrd").string(), {0, 1, 2, 3, 4}, "file");
    EXPECT_NE(refusal_at((folder / "none_{t}.nrrd").string(), 0).find("no file has such a name"), std::string::npos);
    EXPECT_NE(refusal_at((folder / "scan_002.nrrd").string(), 1).find("holds one moment in time"), std::string::npos);
    EXPECT_NE(refusal_at("sample:ball:8", 1).find("holds one moment in time"), std::string::npos);
}

// HDF5: datasets by path or alone, of every type and storage; nothing leads out of the file.
#include "hdf5_files.h"

#include <chiaro/error.h>

using namespace chiaro;
using namespace volume_files;

namespace {

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

template <class T>
class Hdf5Of : public ::testing::Test {};
using Types = ::testing::Types<std::uint8_t, std::int8_t, std::uint16_t, std::int16_t, std::uint32_t, std::int32_t,
                               std::uint64_t, std::int64_t, float, double>;

hid_t big_endian(hid_t native) {
    const hid_t type = H5Tcopy(native);
    H5Tset_order(type, H5T_ORDER_BE);
    return type;
}

}  // namespace

TYPED_TEST_SUITE(Hdf5Of, Types);

TYPED_TEST(Hdf5Of, ContiguousChunkedAndBigEndian) {
    const Folder folder;
    const std::string name = (folder / "a.h5").string();
    const auto values = ramp<TypeParam>(2 * 3 * 4);
    const hid_t chunked = H5Pcreate(H5P_DATASET_CREATE);
    const hsize_t chunk[] = {2, 2, 3};  // none of which divides its axis but one
    H5Pset_chunk(chunked, 3, chunk);
    H5Pset_shuffle(chunked);
    H5Pset_deflate(chunked, 4);
    H5Pset_fletcher32(chunked);
    for (const hid_t made : {hid_t(H5P_DEFAULT), chunked})
        for (const hid_t type : {hdf5_type<TypeParam>(), big_endian(hdf5_type<TypeParam>())}) {
            Hdf5(name).template dataset<TypeParam>("group/density", {2, 3, 4}, values, made, type);
            for (const std::string& path : {name + ":/group/density", name}) {
                const auto volume = read(path);
                EXPECT_EQ(volume.dimensions, (std::array{4, 3, 2}));
                EXPECT_EQ(voxels_of<TypeParam>(volume), values);
                EXPECT_EQ(volume.format, "HDF5");
                EXPECT_EQ(volume.source, path);
                EXPECT_EQ(volume.key_values.at("dataset"), "/group/density");
            }
        }
}

TEST(Hdf5Volume, AxesOfOneElementAreDropped) {
    const Folder folder;
    const auto values = ramp<std::uint8_t>(24);
    const std::string name = (folder / "a.h5").string();
    for (const std::vector<hsize_t>& sizes : {std::vector<hsize_t>{1, 2, 3, 4}, {2, 3, 4, 1}, {1, 1, 2, 3, 4, 1}}) {
        Hdf5(name).dataset("exported_data", sizes, values);
        const auto volume = read(name);
        EXPECT_EQ(volume.dimensions, (std::array{4, 3, 2}));
        EXPECT_EQ(voxels_of<std::uint8_t>(volume), values);
    }
    Hdf5(name).dataset("picture", {6, 4}, values);
    EXPECT_EQ(read(name + ":/picture").dimensions, (std::array{4, 6, 1}));
    Hdf5(name).dataset("one", {1, 3, 8}, values);
    EXPECT_EQ(read(name).dimensions, (std::array{8, 3, 1}));
    Hdf5(name).dataset("many", {2, 1, 2, 3, 2, 1, 1, 2}, ramp<std::uint8_t>(48));
    expect_refused(name + ":/many", "2 x 1 x 2 x 3 x 2 x 1 x 1 x 2");
}

TEST(Hdf5Volume, AnAxisBeforeOrBehindThoseInSpaceIsThatOfChannels) {
    const Folder folder;
    const std::string name = (folder / "a.h5").string();
    const auto values = ramp<std::uint16_t>(9 * 10 * 11 * 3);
    Hdf5(name).dataset("last", {1, 9, 10, 11, 3}, values).dataset("first", {3, 1, 9, 10, 11}, values);
    const auto last = read(name + ":/last"), first = read(name + ":/first");
    for (const Volume* volume : {&last, &first}) {
        EXPECT_EQ(volume->dimensions, (std::array{11, 10, 9}));
        ASSERT_EQ(volume->components, 3);
        EXPECT_FALSE(volume->has_own_colors);
    }
    EXPECT_TRUE(has_note(last, "its last axis, of 3, is taken for channels"));
    EXPECT_EQ(voxels_of<std::uint16_t>(last), values);
    for (std::size_t i = 0; i < values.size(); ++i)
        ASSERT_EQ(first.as<std::uint16_t>()[3 * (i % 990) + i / 990], values[i]);
    Hdf5(name).dataset("rgb", {9, 10, 11, 3}, ramp<std::uint8_t>(9 * 10 * 11 * 3));
    EXPECT_TRUE(read(name).has_own_colors);
    Hdf5(name).dataset("nine", {9, 10, 11, 9}, ramp<std::uint8_t>(9 * 10 * 11 * 9));
    expect_refused(name + ":/nine", "at most eight channels");
}

TEST(Hdf5Volume, AxesAreThoseThatTheirTagsName) {
    const Folder folder;
    const std::string name = (folder / "a.h5").string();
    // 5 moments, 2 slices, 3 rows, 4 columns, 2 channels, in three orders.
    const auto value = [](int t, int z, int y, int x, int c) {
        return std::uint16_t((((t * 2 + z) * 3 + y) * 4 + x) * 2 + c);
    };
    const std::map<char, hsize_t> sizes{{'t', 5}, {'z', 2}, {'y', 3}, {'x', 4}, {'c', 2}};
    for (const std::string letters : {"tzyxc", "ctzyx", "zcytx", "xyztc"}) {
        std::vector<hsize_t> size;
        for (const char letter : letters) size.push_back(sizes.at(letter));
        std::vector<std::uint16_t> values;
        std::array<hsize_t, 5> i{};
        for (std::size_t n = 0; n < 240; ++n) {
            for (std::size_t a = 5, rest = n; a-- > 0; rest /= size[a]) i[a] = rest % size[a];
            const auto at = [&](char letter) { return int(i[letters.find(letter)]); };
            values.push_back(value(at('t'), at('z'), at('y'), at('x'), at('c')));
        }
        const hid_t chunked = H5Pcreate(H5P_DATASET_CREATE);
        const std::vector<hsize_t> chunk(5, 2);
        H5Pset_chunk(chunked, 5, chunk.data());
        for (const hid_t made : {hid_t(H5P_DEFAULT), chunked}) {
            Hdf5(name).dataset("data", size, values, made).text("axistags", axistags(letters));
            for (const int t : {0, 3}) {
                ReadOptions options;
                options.time = t;
                const Volume volume = read(name, options);
                ASSERT_EQ(volume.components, 2) << letters;
                EXPECT_EQ(volume.moments.count, 5);
                const auto found = volume.as<std::uint16_t>();
                std::size_t at = 0;
                const auto& n = volume.dimensions;
                for (int z = 0; z < n[2]; ++z)
                    for (int y = 0; y < n[1]; ++y)
                        for (int x = 0; x < n[0]; ++x)
                            for (int c = 0; c < 2; ++c, ++at) {
                                const Vec3 p = volume.geometry.world_from_voxel({double(x), double(y), double(z)});
                                ASSERT_EQ(found[at], value(t, int(p.z), int(p.y), int(p.x), c)) << letters;
                            }
            }
            ReadOptions beyond;
            beyond.time = 5;
            EXPECT_THROW(read(name, beyond), Error);
        }
    }
    // Few channels are no longer taken for what they are not; a lone axis of time or channels is none of space.
    Hdf5(name).dataset("data", {3, 2, 3, 4}, ramp<std::uint8_t>(72)).text("axistags", axistags("tzyx"));
    EXPECT_EQ(read(name).components, 1);
    EXPECT_EQ(read(name).moments.count, 3);
    EXPECT_FALSE(has_note(read(name), "taken for channels"));
    Hdf5(name).dataset("data", {3, 6, 4}, ramp<std::uint8_t>(72)).text("axistags", axistags("cyx"));
    EXPECT_EQ(read(name).components, 3);
    EXPECT_EQ(read(name + ":/data").dimensions, (std::array{4, 6, 1}));
    Hdf5(name).dataset("data", {9, 2, 4, 1}, ramp<std::uint8_t>(72)).text("axistags", axistags("cyxz"));
    expect_refused(name + ":/data", "at most eight channels");
    // What makes no sense says nothing.
    for (const std::string tags : {"", "{", "[1]", R"({"axes": 3})", R"({"axes": [{"key": 3}, {}, 1, 2]})"}) {
        Hdf5(name).dataset("data", {3, 2, 3, 4}, ramp<std::uint8_t>(72)).text("axistags", tags);
        EXPECT_EQ(read(name).components, 3) << tags;
    }
    for (const std::string letters : {"tzyq", "xzyx", "tcxn", "zyx"}) {
        Hdf5(name).dataset("data", {3, 2, 3, 4}, ramp<std::uint8_t>(72)).text("axistags", axistags(letters));
        EXPECT_EQ(read(name).components, 3) << letters;
    }
}

TEST(Hdf5Volume, SpacingFromAttributes) {
    const Folder folder;
    const auto values = ramp<std::uint8_t>(24);
    const std::string name = (folder / "a.h5").string();
    const auto spacing = [&] { return read(name).geometry.spacing_mm; };
    Hdf5(name).dataset("d", {2, 3, 4}, values).attribute("element_size_um", {4, 2, 1});  // z, y, x
    expect_near(spacing(), {0.001, 0.002, 0.004});
    Hdf5(name).dataset("d", {1, 2, 3, 4}, values).attribute("element_size_um", {4, 2, 1});
    expect_near(spacing(), {0.001, 0.002, 0.004});
    Hdf5(name).dataset("d", {1, 2, 3, 4}, values).attribute("spacing", {9, 3, 2, 0.5});
    expect_near(spacing(), {0.5, 2, 3});
    Hdf5(name).dataset("d", {2, 3, 4}, values);
    EXPECT_TRUE(has_note(read(name), "neither element_size_um nor spacing"));
    Hdf5(name).dataset("d", {2, 3, 4}, values).attribute("spacing", {1, 0, 1});
    expect_refused(name, "spacing");
}

TEST(Hdf5Volume, NamesWhatThereIsToChoose) {
    const Folder folder;
    const auto values = ramp<std::uint8_t>(24);
    const std::string name = (folder / "a.h5").string();
    Hdf5(name).dataset("a/raw", {2, 3, 4}, values).dataset("b/labels", {2, 3, 4}, values).dataset("list", {24}, values);
    expect_refused(name, "holds 2 datasets that can be volumes; name one as FILE:/PATH: /a/raw, /b/labels");
    EXPECT_EQ(read(name + ":/b/labels").dimensions[0], 4);
    expect_refused(name + ":/c", "holds no '/c'");
    expect_refused(name + ":/a", "no dataset");
    expect_refused(name + ":/list", "24 elements");
    Hdf5(name).dataset("list", {24}, values);
    expect_refused(name, "none with three axes");
    { const Hdf5 empty(name); }
    expect_refused(name, "holds no dataset");
}

TEST(Hdf5Volume, NothingLeadsOutOfTheFile) {
    const Folder folder;
    const auto values = ramp<std::uint8_t>(24);
    const std::string secret = (folder / "secret.h5").string(), name = (folder / "a.h5").string();
    Hdf5(secret).dataset("d", {2, 3, 4}, values);
    {
        const Hdf5 file(name);
        H5Lcreate_external(secret.c_str(), "/", file.file(), "away", H5P_DEFAULT, H5P_DEFAULT);
        H5Lcreate_soft("/away/d", file.file(), "soft", H5P_DEFAULT, H5P_DEFAULT);
    }
    expect_refused(name + ":/away/d", "link into another file");
    expect_refused(name + ":/soft", "cannot be opened");
    expect_refused(name, "holds no dataset");
    folder.write("values.raw", std::string(24, 's'));
    const hid_t outside = H5Pcreate(H5P_DATASET_CREATE), composed = H5Pcreate(H5P_DATASET_CREATE);
    H5Pset_external(outside, (folder / "values.raw").c_str(), 0, 24);
    Hdf5(name).dataset<std::uint8_t>("d", {2, 3, 4}, {}, outside);
    expect_refused(name + ":/d", "in other files");
    expect_refused(name, "in other files");
    const hsize_t sizes[] = {2, 3, 4};
    const hid_t space = H5Screate_simple(3, sizes, nullptr);
    H5Pset_virtual(composed, space, secret.c_str(), "/d", space);
    Hdf5(name).dataset<std::uint8_t>("d", {2, 3, 4}, {}, composed);
    expect_refused(name + ":/d", "virtual");
    expect_refused((folder / "a.nrrd").string() + ":/d", "no such file");
    folder.write("a.nrrd", "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 1 1 1\nencoding: raw\n\nv");
    expect_refused((folder / "a.nrrd").string() + ":/d", "only HDF5");
}

TEST(Hdf5Volume, RefusesWhatLiesOrLacks) {
    const Folder folder;
    const std::string name = (folder / "a.h5").string();
    for (const bool chunked : {false, true}) {
        const std::string whole = hdf5_file(folder, chunked);
        EXPECT_EQ(voxels_of<std::uint16_t>(read(folder.write("a.h5", whole))), ramp<std::uint16_t>(24));
        for (const std::size_t size : {std::size_t(9), whole.size() / 3, whole.size() - 1})
            expect_refused(folder.write("cut.h5", whole.substr(0, size)), "HDF5");
    }
    Hdf5(name).dataset<std::uint8_t>("d", {2, 3, 4}, {});
    expect_refused(name, "never written");
    const hid_t made = H5Pcreate(H5P_DATASET_CREATE);
    const hsize_t chunk[] = {64, 64, 64};
    H5Pset_chunk(made, 3, chunk);
    Hdf5(name).dataset<std::uint8_t>("d", {60000, 60000, 60000}, {}, made);
    expect_refused(name, "never written");
    Hdf5(name).dataset<std::uint8_t>("d", {70000, 2, 2}, {});
    expect_refused(name, "1..65535");
    const hid_t text = H5Tcopy(H5T_C_S1);
    Hdf5(name).dataset<std::uint8_t>("d", {2, 3, 4}, {}, H5P_DEFAULT, text);
    expect_refused(name + ":/d", "no numbers");
}

namespace {

/// An attribute of an object: numbers, or a text.
void state(hid_t object, const char* name, const std::vector<double>& numbers) {
    const hsize_t size = numbers.size();
    const hid_t space = H5Screate_simple(1, &size, nullptr);
    const hid_t id = H5Acreate2(object, name, H5T_IEEE_F64LE, space, H5P_DEFAULT, H5P_DEFAULT);
    H5Awrite(id, H5T_NATIVE_DOUBLE, numbers.data());
}
void state(hid_t object, const char* name, const std::string& text) {
    const hid_t type = H5Tcopy(H5T_C_S1);
    H5Tset_size(type, text.size());
    const hid_t id = H5Acreate2(object, name, type, H5Screate(H5S_SCALAR), H5P_DEFAULT, H5P_DEFAULT);
    H5Awrite(id, type, text.data());
}

/// VTK's image data of 4 x 3 x 2 points with an array at its points, one at its cells, and an older one.
struct VtkHdf {
    std::string type = "ImageData", scalars = "density";
    std::vector<double> extent{2, 5, 0, 2, 0, 1};
    std::string write(const Folder& folder) const {
        Hdf5 file(folder / "a.vtkhdf");
        file.dataset<float>("VTKHDF/PointData/age", {2, 3, 4}, ramp<float>(24, 100));
        file.dataset<std::int16_t>("VTKHDF/PointData/density", {2, 3, 4}, ramp<std::int16_t>(24));
        file.dataset<float>("VTKHDF/CellData/heat", {1, 2, 3}, ramp<float>(6));
        const hid_t group = H5Oopen(file.file(), "/VTKHDF", H5P_DEFAULT);
        state(group, "Type", type);
        state(group, "WholeExtent", extent);
        state(group, "Origin", std::vector<double>{1, 2, 3});
        state(group, "Spacing", std::vector<double>{0.5, 2, 3});
        state(group, "Direction", std::vector<double>{0, 1, 0, -1, 0, 0, 0, 0, 1});
        if (!scalars.empty()) state(H5Oopen(file.file(), "/VTKHDF/PointData", H5P_DEFAULT), "Scalars", scalars);
        return file.path();
    }
};

}  // namespace

TEST(VtkHdf, IsImageDataWithItsPlace) {
    const Folder folder;
    const Volume volume = read(VtkHdf{}.write(folder));
    EXPECT_EQ(volume.dimensions, (std::array{4, 3, 2}));
    EXPECT_EQ(voxels_of<std::int16_t>(volume), ramp<std::int16_t>(24));
    expect_near(volume.geometry.spacing_mm, {0.5, 2, 3});
    expect_near(volume.geometry.direction[0], {0, -1, 0});
    expect_near(volume.geometry.origin_mm, {1, 1, 3});  // the extent begins at 2
    ASSERT_FALSE(volume.notes.empty());
    EXPECT_NE(volume.notes[0].find("'age', 'heat' (cells)"), std::string::npos) << volume.notes[0];
    EXPECT_EQ(voxels_of<float>(read(VtkHdf{.scalars = ""}.write(folder))), ramp<float>(24, 100));
    EXPECT_EQ(voxels_of<float>(read(VtkHdf{}.write(folder) + ":/VTKHDF/CellData/heat")), ramp<float>(6));
}

TEST(VtkHdf, RefusesWhatLies) {
    const Folder folder;
    expect_refused(VtkHdf{.type = "UnstructuredGrid"}.write(folder), "'UnstructuredGrid', not ImageData");
    expect_refused(VtkHdf{.extent = {0, 9, 0, 2, 0, 1}}.write(folder), "where its WholeExtent has 2 x 3 x 10");
    expect_refused(VtkHdf{.extent = {0, 3, 0, 2}}.write(folder), "WholeExtent is not 6 numbers");
    expect_refused(VtkHdf{.extent = {0, -3, 0, 2, 0, 1}}.write(folder), "makes no sense");
}

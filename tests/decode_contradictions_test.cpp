// Files that state things twice or contradict themselves: refused, or noted where one statement has precedence.
#include "hdf5_files.h"
#include "hostile_headers.h"
#include "places.h"
#include "tiff_files.h"
#include "vtk_files.h"

using namespace chiaro;
using namespace volume_files;

TEST(Contradictions, AreRefused) {
    const Folder folder;
    folder.write("v.raw", voxels);
    const std::string in_nrrd = "data file: v.raw\n", in_meta = "ElementDataFile = v.raw\n";
    expect_refused(folder.write("twice.nhdr", nrrd_good + "type: uint8\n" + in_nrrd));
    expect_refused(folder.write("lines.nhdr", nrrd_good + "line skip: -1\n" + in_nrrd));
    expect_refused(folder.write("twice.mhd", meta_good + "NDims = 3\n" + in_meta));
    expect_refused(folder.write("skip.mhd", meta_good + "HeaderSize = -5\n" + in_meta));
    expect_refused(folder.write("nul.nhdr", nrrd_good + "data file: v.raw" + '\0' + "x\n"));
    expect_refused(folder.write("nul.mhd", meta_good + "ElementDataFile = v.raw" + '\0' + "x\n"));
    expect_refused(folder.write("twice.vti", replaced(Vti{}.bytes(), "Origin=", "Origin=\"1 2 3\" Origin=")));
    expect_refused(folder.write("twice.vtk", replaced(vtk_file(), "SPACING", "SPACING 1 1 1\nSPACING")));
    Dicom slope_twice;
    slope_twice.functional_groups = Dicom::element(0x28, 0x1053, "DS", "2");
    expect_refused(folder.write("twice.dcm", slope_twice.bytes()));
    expect_refused(folder.write("syntax.dcm", replaced(Dicom{}.bytes(), "1.2.840.10008.1.2.1" + std::string(1, '\0'),
                                                       "1.2.840.10008.1.2.5" + std::string(1, '\0'))));
}

TEST(Contradictions, AreNotedWhereOneHasPrecedence) {
    const Folder folder;
    folder.write("v.raw", voxels);
    const std::string directions = "space: LPS\nspace directions: (1,0,0) (0,1,0) (0,0,1)\nspacings: 2 2 2\n";
    expect_noted(folder.write("both.nhdr", nrrd_good + directions + "data file: v.raw\n"), "spacings beside");
    expect_noted(folder.write("pixdim.nii", Nifti(2, 8).sform({1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 3, 0}).bytes() + voxels),
                 "pixdim states voxels of 0.5 x 2 x 3 mm");
    Nifti mirrored(2, 8);
    mirrored.qform(0, 0, 0, {0, 0, 0}).set<float>(80, -0.5f);
    expect_noted(folder.write("mirrored.nii", mirrored.bytes() + voxels), "pixdim states negative voxel sizes");
    for (const std::uint32_t size : {0, 1}) {
        std::string tiff = tiff_file({TiffImage{}, TiffImage{}});
        const std::string field =
            bytes_of(std::uint16_t(279)) + bytes_of(std::uint16_t(4)) + bytes_of(std::uint32_t(1));
        tiff.replace(tiff.rfind(field) + field.size(), 4, bytes_of(size));
        expect_noted(folder.write("strips.tif", tiff), "1 of 2 pages state wrong sizes");
    }
}

/// An array in chunks, with filters, whose index in the file can be edited.
class Chunks {
public:
    Chunks(const Folder& folder, bool with_checksum) {
        const hid_t made = H5Pcreate(H5P_DATASET_CREATE);
        const hsize_t chunk[] = {1, 2, 4};
        H5Pset_chunk(made, 3, chunk);
        H5Pset_shuffle(made);
        if (with_checksum) H5Pset_fletcher32(made);
        Hdf5(folder / "made.h5").dataset("density", {2, 3, 4}, ramp<std::uint16_t>(24), made);
        H5Pclose(made);
        bytes = content_of(folder / "made.h5");
        for (index = bytes.find("TREE"); bytes[index + 4] != 1; index = bytes.find("TREE", index + 1)) {
        }
    }
    /// Of the chunk: its size and filter mask (4 bytes each), its place (8 bytes an axis), its address.
    std::size_t entry(std::size_t chunk) const { return index + 24 + chunk * 48; }

    std::string bytes;
    std::size_t index = 0;  ///< of the B-tree
};

// The index of chunks has no checksum of its own; a lost chunk would be read as zeros.
TEST(Contradictions, BitsFlippedInTheIndexOfChunks) {
    const Folder folder;
    for (const bool with_checksum : {false, true}) {
        const Chunks good(folder, with_checksum);
        EXPECT_TRUE(read(folder.write("good.h5", good.bytes)).notes.size() < 2);
        Chunks moved = good, unchecked = good;
        moved.bytes[moved.entry(1) + 8 + 16 + 5] ^= 16;  // by 2^44 along y
        expect_refused(folder.write("moved.h5", moved.bytes));
        unchecked.bytes[unchecked.entry(1) + 4] ^= 2;  // the second filter was left out
        if (with_checksum) expect_refused(folder.write("unchecked.h5", unchecked.bytes));
    }
}

TEST(Contradictions, ChunksNeverWrittenAreNoted) {
    const Folder folder;
    const hid_t made = H5Pcreate(H5P_DATASET_CREATE);
    const hsize_t chunk[] = {1, 2, 4}, count[] = {1, 3, 4}, first[] = {1, 0, 0};
    const std::uint16_t fill = 1000;
    H5Pset_chunk(made, 3, chunk);
    H5Pset_fill_value(made, H5T_NATIVE_UINT16, &fill);
    {
        Hdf5 file(folder / "half.h5");
        file.dataset("density", {2, 3, 4}, std::vector<std::uint16_t>{}, made);
        const hid_t dataset = H5Dopen2(file.file(), "density", H5P_DEFAULT), in_file = H5Dget_space(dataset),
                    in_memory = H5Screate_simple(3, count, nullptr);
        H5Sselect_hyperslab(in_file, H5S_SELECT_SET, first, nullptr, count, nullptr);
        const auto values = ramp<std::uint16_t>(12);
        EXPECT_GE(H5Dwrite(dataset, H5T_NATIVE_UINT16, in_memory, in_file, H5P_DEFAULT, values.data()), 0);
    }
    H5Pclose(made);
    const Volume half = read(folder / "half.h5");
    expect_noted((folder / "half.h5").string(), "2 of 4 chunks were never written");
    for (int i = 0; i < 24; ++i)
        EXPECT_EQ(half.as<std::uint16_t>()[i], i < 12 ? fill : ramp<std::uint16_t>(12)[i - 12]);
}

// What a mutation script found (each file's name says what is wrong with it), and what becomes of it.
TEST(Contradictions, FilesOfAnAttack) {
    const std::string files = of_project("tests/hostile/files/");
    for (const char* name : {"cut-in-link.tif", "spacing-1e-300.nrrd", "pattern-overflow.nhdr", "sizes-twice.nrrd",
                             "transfer-syntax-lies.dcm", "quatern-2-2-2.nii", "headersize--5.mha",
                             "h_-8x6x5_uint16.raw", "h5z-flip-02815.h5"})
        expect_refused(files + name);
    expect_noted(files + "ascii-garbage-behind.nrrd", "are ignored");
    EXPECT_EQ(read(files + "double-max.nrrd").notes.size(), 0U);
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
    // A kilobyte each. Their decoder is the largest child of this process, or they are smaller.
    for (const char* name : {"pixels-of-4GiB.dcm", "fragment-of-4GiB.dcm"}) expect_refused(files + name);
    Dicom large;
    large.stated_rows = 65535, large.columns = 65535, large.frames = 100;
    const Folder folder;
    expect_refused(folder.write("large.dcm", large.bytes()));
    rusage usage{};
    getrusage(RUSAGE_CHILDREN, &usage);
    EXPECT_LT(usage.ru_maxrss, 128 << 10) << "KiB";
#endif
}

// VTK's files that name others: pieces of an image, and moments.
#include "vtk_files.h"

#include <chiaro/error.h>

using namespace chiaro;
using namespace volume_files;

namespace {

std::string refusal(const std::string& name, int time = 0) {
    try {
        read(name, {.time = time});
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::input);
        return error.what();
    }
    ADD_FAILURE() << name << " was accepted";
    return {};
}

/// Values of points (or of cells) of an extent, each its own place.
std::string values_in(const std::array<int, 6>& e, bool of_cells) {
    std::string values;
    const int less = of_cells ? 1 : 0;
    for (int z = e[4]; z <= e[5] - less; ++z)
        for (int y = e[2]; y <= e[3] - less; ++y)
            for (int x = e[0]; x <= e[1] - less; ++x) values += char(x + 10 * y + 50 * z);
    return values;
}
std::string text_of(const std::array<int, 6>& e) {
    std::string text;
    for (const int n : e) text += (text.empty() ? "" : " ") + std::to_string(n);
    return text;
}

struct Pieces {
    std::vector<std::array<int, 6>> extents{{2, 4, 0, 3, 0, 2}, {4, 7, 0, 1, 0, 2}, {4, 7, 1, 3, 0, 2}};
    bool of_cells = false;
    std::string whole = "2 7 0 3 0 2", source = "part/piece";

    /// Writes the pieces, and returns the name of the file that names them.
    std::string write(const Folder& folder) const {
        fs::create_directories(folder / "part");
        std::string xml = "<?xml version=\"1.0\"?>\n<VTKFile type=\"PImageData\">\n<PImageData WholeExtent=\"" + whole +
                          "\" GhostLevel=\"0\" Origin=\"1 2 3\" Spacing=\"0.5 2 3\">\n";
        for (std::size_t i = 0; i < extents.size(); ++i) {
            Vti piece{.arrays = {{.values = values_in(extents[i], of_cells), .of_cells = of_cells}}};
            piece.extent = text_of(extents[i]);
            const std::string name = source + std::to_string(i) + ".vti";
            if (source.find("..") == source.npos) folder.write(name, piece.bytes());
            xml += "<Piece Extent=\"" + piece.extent + "\" Source=\"" + name + "\"/>\n";
        }
        return folder.write("a.pvti", xml + "</PImageData>\n</VTKFile>");
    }
};

TEST(Pvti, PutsPiecesTogether) {
    for (const bool of_cells : {false, true}) {
        const Folder folder;
        const Volume volume = read(Pieces{.of_cells = of_cells}.write(folder));
        EXPECT_EQ(volume.dimensions, of_cells ? (std::array{5, 3, 2}) : (std::array{6, 4, 3}));
        const std::string wanted = values_in({2, 7, 0, 3, 0, 2}, of_cells);
        EXPECT_EQ(voxels_of<std::uint8_t>(volume), std::vector<std::uint8_t>(wanted.begin(), wanted.end()));
        const double half = of_cells ? 0.5 : 0;
        expect_near(volume.geometry.origin_mm, {1 + 0.5 * (2 + half), 2 + 2 * half, 3 + 3 * half});
        EXPECT_EQ(volume.format, "VTK");
    }
}

TEST(Pvti, RefusesWhatLies) {
    const auto expect = [](const Pieces& pieces, const std::string& part) {
        const Folder folder;
        const std::string sentence = refusal(pieces.write(folder));
        EXPECT_NE(sentence.find(part), std::string::npos) << sentence;
    };
    expect({.extents = {{2, 4, 0, 3, 0, 2}}}, "do not make up");
    expect({.extents = {{2, 6, 0, 3, 0, 2}, {2, 6, 0, 3, 0, 2}}}, "leave out 12 of 72 voxels");
    expect({.extents = {{2, 8, 0, 3, 0, 2}}}, "outside of its whole extent");
    expect({.extents = {}}, "names no piece");
    expect({.extents = {{2, 7, 0, 3, 0, 2}}, .whole = "-1000000000 1000000000 0 3 0 2"}, "do not make up");
    expect({.extents = {{2, 7, 0, 3, 0, 2}}, .whole = "2 99999999999 0 3 0 2"}, "thousand million");
    expect({.extents = {{2, 7, 0, 3, 0, 2}}, .whole = "7 2 0 3 0 2"}, "makes no sense");
    expect({.extents = {{7, 2, 0, 3, 0, 2}}}, "outside of its whole extent");
    expect({.whole = "2 7 0 3 0"}, "WholeExtent has 5");
    expect({.source = "../piece"}, "must lie in the folder");
    const Folder folder;
    const std::string name = Pieces{}.write(folder);
    const auto with_piece = [&](const std::string& bytes) {
        return folder.write("part/piece1.vti", bytes), refusal(name);
    };
    EXPECT_NE(with_piece(Vti{}.bytes()).find("another size"), std::string::npos);
    Vti other{.arrays = {{.type = "Int8", .values = values_in({4, 7, 0, 1, 0, 2}, false)}}};
    other.extent = "4 7 0 1 0 2";
    EXPECT_NE(with_piece(other.bytes()).find("another kind of values"), std::string::npos);
    const std::string itself = content_of(name);
    EXPECT_NE(with_piece(itself).find("'PImageData', not ImageData"), std::string::npos);
    EXPECT_NE(with_piece("<VTKFile type=\"PImageData\"/>").find("'PImageData', not ImageData"), std::string::npos);
    EXPECT_NE(with_piece("").find("VTKFile"), std::string::npos);
    fs::remove(folder / "part/piece1.vti");
    EXPECT_FALSE(refusal(name).empty());
}

std::string collection(const std::string& entries) {
    return "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\">\n<Collection>\n" + entries +
           "</Collection>\n</VTKFile>";
}
std::string entry(const std::string& time, const std::string& file) {
    return "<DataSet timestep=\"" + time + "\" group=\"\" part=\"0\" file=\"" + file + "\"/>\n";
}

// In the order of their times, whatever the file's is.
TEST(Pvd, HoldsMoments) {
    const Folder folder;
    Pieces{}.write(folder);
    Vti first;
    first.arrays[0].values = "ABCDEFGHIJKLMNOPQRSTUVWX";
    folder.write("first.vti", first.bytes());
    const std::string name = folder.write("a.pvd", collection(entry("2.5", "a.pvti") + entry("0.5", "first.vti")));
    const Volume volume = read(name);
    EXPECT_EQ(voxels_of<std::uint8_t>(volume).front(), 'A');
    EXPECT_EQ(volume.moments.count, 2);
    EXPECT_EQ(volume.moments.times, (std::vector<double>{0.5, 2.5}));
    ASSERT_FALSE(volume.notes.empty());
    EXPECT_NE(volume.notes.back().find("2 moments"), std::string::npos) << volume.notes.back();
    EXPECT_EQ(read(name, {.time = 1}).dimensions, (std::array{6, 4, 3}));
    EXPECT_NE(refusal(name, 2).find("none of number 2"), std::string::npos);
    EXPECT_EQ(read(folder.write("one.pvd", collection(entry("7", "first.vti")))).moments.count, 1);

    const auto refused = [&](const std::string& entries) {
        return refusal(folder.write("b.pvd", collection(entries)));
    };
    EXPECT_NE(refused("").find("names no data set"), std::string::npos);
    EXPECT_NE(refused(entry("1", "first.vti") + entry("1", "a.pvti")).find("several data sets at the time 1"),
              std::string::npos);
    EXPECT_NE(refused(entry("nan", "first.vti")).find("timestep"), std::string::npos);
    EXPECT_NE(refused(entry("0", "a.pvd")).find("'Collection', not ImageData"), std::string::npos);
    EXPECT_NE(refused(entry("0", "b.pvd")).find("'Collection', not ImageData"), std::string::npos);  // itself
    fs::create_symlink("/etc/passwd", folder / "elsewhere.vti");
    for (const std::string outside : {"../x.vti", "a/../../x.vti", "", ".", "elsewhere.vti"})
        EXPECT_FALSE(refused(entry("0", outside)).empty()) << outside;
    EXPECT_NE(refused(entry("0", "/etc/passwd")).find("must lie in the folder"), std::string::npos);
}

}  // namespace

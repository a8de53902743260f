// Anatomy in pictures: left, front and crown are where they must be, whatever the format and its order of axes.
#include "fixtures.h"
#include "volume_files.h"

#include <fmt/format.h>

using namespace chiaro;
using namespace volume_files;
using chiaro::testing::Shot;

namespace {

// All vectors here are LPS: x to the patient's left, y to the back, z to the crown.
constexpr Vec3 left{1, 0, 0}, posterior{0, 1, 0}, superior{0, 0, 1};

/// What a picture's right and up are, from first principles. Who stands before the patient (anterior) faces him: his
/// left hand is on the picture's right; behind him it is on the left. Who stands at his left sees a profile whose nose
/// points to the picture's left, so the back is on the right. Who looks down on the crown, front up, stands behind him:
/// left stays left. Who looks up at the soles, front up, sees it the other way round, as radiologists do.
struct Looking {
    View view;
    Vec3 right, up;
};
const Looking looking[] = {{View::anterior, left, superior},    {View::posterior, -left, superior},
                           {View::left, posterior, superior},   {View::right, -posterior, superior},
                           {View::superior, -left, -posterior}, {View::inferior, left, -posterior}};

/// Balls towards the left, the front and the crown, apart from each other in every view; mm from the centre.
constexpr Vec3 markers[] = {{14, 2, -6}, {-5, -13, 4}, {-6, 7, 14}};
constexpr double ball_mm = 4;
constexpr Vec3 centre{10, -20, 30};

double phantom(Vec3 p) {
    double value = 0;
    for (const Vec3 marker : markers) value = std::max(value, 100 + 40 * (ball_mm - length(p - centre - marker)));
    return std::clamp(value, 0.0, 200.0);
}

/// A lattice through the phantom: which way each index axis runs.
struct Grid {
    std::string name;
    std::array<Vec3, 3> direction;
    std::array<int, 3> n{41, 41, 41};
    Vec3 spacing{1, 1, 1};

    Vec3 at(double i, double j, double k) const {
        return centre + (i - 0.5 * (n[0] - 1)) * spacing.x * direction[0] +
               (j - 0.5 * (n[1] - 1)) * spacing.y * direction[1] + (k - 0.5 * (n[2] - 1)) * spacing.z * direction[2];
    }
    Vec3 step(int axis) const { return spacing[axis] * direction[std::size_t(axis)]; }
    template <class T>
    std::vector<T> voxels() const {
        std::vector<T> values;
        for (int k = 0; k < n[2]; ++k)
            for (int j = 0; j < n[1]; ++j)
                for (int i = 0; i < n[0]; ++i) values.push_back(T(std::lround(phantom(at(i, j, k)))));
        return values;
    }
};

/// The same anisotropic lattice (1 mm to the left, 1.5 to the back, 2 to the crown) in another order of axes.
Grid reordered(const std::string& name, std::array<Vec3, 3> direction) {
    Grid grid{name, direction};
    for (int axis = 0; axis < 3; ++axis) {
        const Vec3 d = direction[std::size_t(axis)];
        grid.n[std::size_t(axis)] = d.x != 0 ? 41 : d.y != 0 ? 31 : 21;
        grid.spacing[axis] = d.x != 0 ? 1 : d.y != 0 ? 1.5 : 2;
    }
    return grid;
}

/// Turned by 20 degrees about the crown, then by 15 about the new left.
Grid oblique() {
    const double a = 0.349, b = 0.262;
    const Vec3 x{std::cos(a), std::sin(a), 0}, back{-std::sin(a), std::cos(a), 0};
    return {"oblique", {x, std::cos(b) * back + std::sin(b) * superior, std::cos(b) * superior - std::sin(b) * back}};
}

const Grid grids[] = {
    reordered("axial", {left, posterior, superior}),     reordered("flipped", {-left, -posterior, -superior}),
    reordered("mirrored", {-left, posterior, superior}), reordered("sagittal", {posterior, -superior, left}),
    reordered("coronal", {-left, superior, posterior}),  oblique()};

std::string numbers(Vec3 v) { return fmt::format("{:.9g},{:.9g},{:.9g}", v.x, v.y, v.z); }
std::string words(Vec3 v) { return fmt::format("{:.9g} {:.9g} {:.9g}", v.x, v.y, v.z); }
Vec3 ras(Vec3 v) { return {-v.x, -v.y, v.z}; }

std::string nrrd(const Grid& g, const Folder& folder, const std::string& space, Vec3 (*world)(Vec3)) {
    return folder.write("a.nrrd",
                        fmt::format("NRRD0004\ntype: uint8\ndimension: 3\nspace: {}\nsizes: {} {} {}\nencoding: raw\n"
                                    "space directions: ({}) ({}) ({})\nspace origin: ({})\n\n",
                                    space, g.n[0], g.n[1], g.n[2], numbers(world(g.step(0))), numbers(world(g.step(1))),
                                    numbers(world(g.step(2))), numbers(world(g.at(0, 0, 0)))) +
                            bytes_of_all(g.voxels<std::uint8_t>()));
}
std::string nrrd_lps(const Grid& g, const Folder& folder) {
    return nrrd(g, folder, "left-posterior-superior", [](Vec3 v) { return v; });
}
std::string nrrd_ras(const Grid& g, const Folder& folder) { return nrrd(g, folder, "right-anterior-superior", ras); }

std::string nifti(const Grid& g, const Folder& folder) {
    Nifti header(2, 8);
    std::array<float, 12> rows{};
    for (int axis = 0; axis < 3; ++axis) {
        const auto a = std::size_t(axis);
        header.set<std::int16_t>(42 + 2 * a, std::int16_t(g.n[a])).set<float>(80 + 4 * a, float(g.spacing[axis]));
        for (int row = 0; row < 3; ++row) rows[4 * std::size_t(row) + a] = float(ras(g.step(axis))[row]);
        rows[4 * a + 3] = float(ras(g.at(0, 0, 0))[axis]);
    }
    return folder.write("a.nii", header.sform(rows).bytes() + bytes_of_all(g.voxels<std::uint8_t>()));
}

/// MetaImage names where each axis comes from: the patient's right for one that runs to the left.
std::string orientation(const Grid& g) {
    std::string letters;
    for (const Vec3 d : g.direction) {
        if (std::abs(d.x) > 0.7) letters += d.x > 0 ? 'R' : 'L';
        if (std::abs(d.y) > 0.7) letters += d.y > 0 ? 'A' : 'P';
        if (std::abs(d.z) > 0.7) letters += d.z > 0 ? 'I' : 'S';
    }
    return letters;
}

std::string meta_image(const Grid& g, const Folder& folder) {
    return folder.write(
        "a.mha",
        fmt::format("ObjectType = Image\nNDims = 3\nDimSize = {} {} {}\nElementType = MET_UCHAR\n"
                    "AnatomicalOrientation = {}\nElementSpacing = {}\nOffset = {}\nTransformMatrix = {} {} {}\n"
                    "ElementDataFile = LOCAL\n",
                    g.n[0], g.n[1], g.n[2], orientation(g), words(g.spacing), words(g.at(0, 0, 0)),
                    words(g.direction[0]), words(g.direction[1]), words(g.direction[2])) +
            bytes_of_all(g.voxels<std::uint8_t>()));
}

std::string dicom(const Grid& g, const Folder& folder) {
    const auto voxels = g.voxels<std::uint16_t>();
    const auto area = std::ptrdiff_t(g.n[0] * g.n[1]);
    for (int k = 0; k < g.n[2]; ++k) {
        const Vec3 p = g.at(0, 0, k), row = g.direction[0], column = g.direction[1];
        Dicom slice{.columns = g.n[0], .rows = g.n[1], .instance = k + 1, .intercept = 0};
        slice.position = {p.x, p.y, p.z};
        slice.orientation = {row.x, row.y, row.z, column.x, column.y, column.z};
        slice.column_spacing = g.spacing.x, slice.row_spacing = g.spacing.y;
        slice.pixels.assign(voxels.begin() + k * area, voxels.begin() + (k + 1) * area);
        folder.write(fmt::format("slices/{}", (k * 8) % g.n[2]), slice.bytes());
    }
    return (folder / "slices").string();
}

struct Format {
    const char* name;
    std::string (*write)(const Grid&, const Folder&);
};
void PrintTo(const Format& format, std::ostream* stream) { *stream << format.name; }
void PrintTo(const Grid& grid, std::ostream* stream) { *stream << grid.name; }
const Format formats[] = {
    {"NrrdLps", nrrd_lps}, {"NrrdRas", nrrd_ras}, {"Nifti", nifti}, {"MetaImage", meta_image}, {"Dicom", dicom}};

/// Orthographic, everything from 100 on opaque.
Frame image(const Volume& volume, View view) {
    Shot shot{.width = 150, .height = 120};
    shot.camera.view = view;
    shot.camera.projection = Projection::orthographic;
    shot.tf = {{{0, {1, 1, 1}, 0}, {100, {1, 1, 1}, 0}, {100, {1, 1, 1}, 1}}, RgbSpace::linear};
    return shot(volume);
}

/// Each ball shows where anatomy demands, and nothing else does.
void expect_markers(const Frame& frame, const Looking& from, const Grid& grid) {
    const Vec3 diagonal = grid.at(0, 0, 0) - grid.at(grid.n[0] - 1, grid.n[1] - 1, grid.n[2] - 1);
    const double pixels_per_mm = frame.height / length(diagonal);  // the height of the view is the diagonal
    for (const Vec3 marker : markers) {
        const auto x = std::lround((frame.width - 1) / 2.0 + pixels_per_mm * dot(marker, from.right));
        const auto y = std::lround((frame.height - 1) / 2.0 - pixels_per_mm * dot(marker, from.up));
        EXPECT_GT(frame.rgba[4 * std::size_t(y * frame.width + x) + 3], 0.9) << "ball at " << words(marker);
    }
    const double ball = 3.14159 * std::pow(ball_mm * pixels_per_mm, 2) / (frame.width * frame.height);
    EXPECT_NEAR(chiaro::testing::mean_alpha(frame) / (3 * ball), 1, 0.12);
}

class Views : public ::testing::TestWithParam<std::tuple<Format, Grid>> {};

}  // namespace

TEST_P(Views, ShowAnatomyUnmirrored) {
    const auto& [format, grid] = GetParam();
    const Folder folder;
    const Volume volume = read(format.write(grid, folder));
    const Folder other;
    const Volume plain = read(nrrd_lps(grids[0], other));
    for (const Looking& from : looking) {
        SCOPED_TRACE(to_text(from.view));
        const Frame frame = image(volume, from.view);
        expect_markers(frame, from, grid);
        if (grid.name == "oblique") continue;  // another lattice: other values between the balls' voxels
        EXPECT_LT(chiaro::testing::difference(frame, image(plain, from.view), 0.02).pixels_beyond, 40);
    }
}

INSTANTIATE_TEST_SUITE_P(Formats, Views, ::testing::Combine(::testing::ValuesIn(formats), ::testing::ValuesIn(grids)),
                         [](const auto& row) {
                             return std::get<0>(row.param).name + ("_" + std::get<1>(row.param).name);
                         });

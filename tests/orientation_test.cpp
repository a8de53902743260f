// One small asymmetric volume, stored with its axes in each of the 48 signed orders: whatever the format, the six named
// views show the same picture.
#include "fixtures.h"
#include "volume_files.h"

#include <fmt/format.h>

using namespace chiaro;
using namespace volume_files;
using chiaro::testing::difference;
using chiaro::testing::Shot;

namespace {

// World vectors are LPS here. The lattice has 13 voxels of 1 mm to the left, 10 of 1.5 mm to the back and 9 of 2 mm to
// the crown.
constexpr std::array<int, 3> patient_n{13, 10, 9};
constexpr std::array<double, 3> patient_mm{1, 1.5, 2};
constexpr Vec3 origin{-7, 11, 40};  ///< of the voxel furthest right, front and down

/// Smooth, and with no symmetry: three blobs of different size at odd places.
double value(const std::array<int, 3>& p) {
    const auto blob = [&](double x, double y, double z, double width) {
        const double dx = p[0] - x, dy = 1.5 * (p[1] - y), dz = 2 * (p[2] - z);
        return std::exp(-(dx * dx + dy * dy + dz * dz) / (2 * width * width));
    };
    return 200 * blob(9, 3, 6, 2.2) + 140 * blob(3, 7, 5, 1.8) + 170 * blob(6, 4, 1.5, 1.6);
}

/// How a file's axes run: axis a of the file is axis `of[a]` of the patient, backwards where `sign[a]` is -1.
struct Order {
    std::array<std::size_t, 3> of;
    std::array<int, 3> sign;

    int n(std::size_t axis) const { return patient_n[of[axis]]; }
    double mm(std::size_t axis) const { return patient_mm[of[axis]]; }
    Vec3 direction(std::size_t axis) const {
        Vec3 d;
        d[int(of[axis])] = sign[axis];
        return d;
    }
    Vec3 first() const {  ///< position of voxel (0, 0, 0)
        Vec3 p = origin;
        for (std::size_t a = 0; a < 3; ++a)
            if (sign[a] < 0) p[int(of[a])] += (n(a) - 1) * mm(a);
        return p;
    }
    bool is_proper() const { return dot(direction(0), cross(direction(1), direction(2))) > 0; }
    std::string voxels() const {
        std::vector<float> values;
        for (int k = 0; k < n(2); ++k)
            for (int j = 0; j < n(1); ++j)
                for (int i = 0; i < n(0); ++i) {
                    const std::array index{i, j, k};
                    std::array<int, 3> p{};
                    for (std::size_t a = 0; a < 3; ++a) p[of[a]] = sign[a] > 0 ? index[a] : n(a) - 1 - index[a];
                    values.push_back(float(value(p)));
                }
        return bytes_of_all(values);
    }
};

std::vector<Order> all_orders() {
    std::vector<Order> orders;
    std::array<std::size_t, 3> of{0, 1, 2};
    do
        for (int signs = 0; signs < 8; ++signs)
            orders.push_back({of, {signs & 1 ? -1 : 1, signs & 2 ? -1 : 1, signs & 4 ? -1 : 1}});
    while (std::next_permutation(of.begin(), of.end()));
    return orders;
}

Vec3 ras(Vec3 v) { return {-v.x, -v.y, v.z}; }
Vec3 lps(Vec3 v) { return v; }

std::string nrrd(const Order& order, const std::string& space, Vec3 (*world)(Vec3)) {
    const auto text = [](Vec3 v) { return fmt::format("({},{},{})", v.x, v.y, v.z); };
    std::string directions;
    for (std::size_t a = 0; a < 3; ++a) directions += " " + text(order.mm(a) * world(order.direction(a)));
    return fmt::format(
               "NRRD0004\ntype: float\ndimension: 3\nsizes: {} {} {}\nendian: little\nencoding: raw\nspace: {}\n"
               "space directions:{}\nspace origin: {}\n\n",
               order.n(0), order.n(1), order.n(2), space, directions, text(world(order.first()))) +
           order.voxels();
}

Nifti nifti_start(const Order& order) {
    Nifti header(16, 32);
    for (std::size_t a = 0; a < 3; ++a)
        header.set<std::int16_t>(42 + 2 * a, std::int16_t(order.n(a))).set<float>(80 + 4 * a, float(order.mm(a)));
    return header;
}

std::string nifti_sform(const Order& order) {
    std::array<float, 12> rows{};
    for (std::size_t a = 0; a < 3; ++a) {
        const Vec3 step = order.mm(a) * ras(order.direction(a));
        for (std::size_t row = 0; row < 3; ++row) rows[4 * row + a] = float(step[int(row)]);
        rows[4 * a + 3] = float(ras(order.first())[int(a)]);
    }
    return nifti_start(order).sform(rows).bytes() + order.voxels();
}

/// The quaternion (a, b, c, d) of the rotation whose columns are r, found by trying: with entries 0 and +-1 all its
/// components are 0, +-1/2, +-1/sqrt 2 or 1. A reflection is told by pixdim[0] = -1, which turns the third axis.
std::string nifti_qform(const Order& order) {
    std::array<Vec3, 3> r;
    for (std::size_t a = 0; a < 3; ++a) r[a] = ras(order.direction(a));
    const double qfac = order.is_proper() ? 1 : -1;  // RAS and LPS differ by a rotation
    r[2] = qfac * r[2];
    Nifti header = nifti_start(order);
    header.set<float>(76, float(qfac));
    const double steps[] = {-1, -std::sqrt(0.5), -0.5, 0, 0.5, std::sqrt(0.5), 1};
    for (const double b : steps)
        for (const double c : steps)
            for (const double d : steps) {
                const double rest = 1 - b * b - c * c - d * d;
                if (rest < -1e-9) continue;
                const double a = std::sqrt(std::max(0.0, rest));
                const Vec3 x{a * a + b * b - c * c - d * d, 2 * (b * c + a * d), 2 * (b * d - a * c)};
                const Vec3 y{2 * (b * c - a * d), a * a + c * c - b * b - d * d, 2 * (c * d + a * b)};
                if (length(x - r[0]) > 1e-6 || length(y - r[1]) > 1e-6) continue;
                const Vec3 o = ras(order.first());
                header.qform(float(b), float(c), float(d), {float(o.x), float(o.y), float(o.z)});
                return header.bytes() + order.voxels();
            }
    ADD_FAILURE() << "no quaternion";
    return {};
}

struct Format {
    const char* name;
    const char* file;
    std::string (*write)(const Order&);
};
void PrintTo(const Format& format, std::ostream* stream) { *stream << format.name; }
const Format formats[] = {
    {"NrrdLps", "a.nrrd", [](const Order& order) { return nrrd(order, "left-posterior-superior", lps); }},
    {"NrrdRas", "a.nrrd", [](const Order& order) { return nrrd(order, "RAS", ras); }},
    {"NiftiSform", "a.nii", nifti_sform},
    {"NiftiQform", "a.nii", nifti_qform}};

constexpr View views[] = {View::anterior, View::posterior, View::left, View::right, View::superior, View::inferior};

/// Shaded, through a smooth ramp of opacity.
Frame image(const Volume& volume, View view) {
    Shot shot{.width = 48, .height = 40};
    shot.camera.view = view;
    shot.lighting.shading = Shading::phong;
    shot.tf = {{{20, {0.2, 0.4, 0.9}, 0}, {200, {1, 0.5, 0.1}, 0.6}}, RgbSpace::linear};
    return shot(volume);
}

Frame mirrored(const Frame& frame) {
    Frame result(frame.width, frame.height);
    for (int y = 0; y < frame.height; ++y)
        for (int x = 0; x < frame.width; ++x)
            for (int c = 0; c < 4; ++c)
                result.rgba[std::size_t(4 * (y * frame.width + x) + c)] =
                    frame.rgba[std::size_t(4 * (y * frame.width + frame.width - 1 - x) + c)];
    return result;
}

std::vector<Frame> images_of(const Volume& volume) {
    std::vector<Frame> frames;
    for (const View view : views) frames.push_back(image(volume, view));
    return frames;
}

/// What the order of axes may change: the voxels and the ray's samples are the same, but positions in voxels, sums of
/// up to 70 voxels (the eye's distance) with some four roundings of 2^-24, and the three interpolations are rounded in
/// another order: 2e-5 voxels. Opacity and shading change by less than ten a voxel, and the weights of the samples sum
/// to at most 1, so no pixel changes by more than 2e-4: a twentieth of a level of 8 bits.
constexpr double tolerance = 2e-4;

class Orientation : public ::testing::TestWithParam<Format> {
protected:
    Volume volume_of(const Format& format, const Order& order) {
        return read(folder_.write(format.file, format.write(order)));
    }

private:
    Folder folder_;
};

}  // namespace

TEST_P(Orientation, AllOrdersOfAxesGiveTheSameSixViews) {
    const auto orders = all_orders();
    ASSERT_EQ(orders.size(), 48U);
    const auto ground_truth = images_of(volume_of(formats[0], orders[0]));
    double worst = 0;
    for (const Order& order : orders) {
        const auto frames = images_of(volume_of(GetParam(), order));
        for (std::size_t v = 0; v < std::size(views); ++v) {
            const auto d = difference(frames[v], ground_truth[v], tolerance);
            worst = std::max(worst, d.max);
            EXPECT_EQ(d.pixels_beyond, 0)
                << to_text(views[v]) << " by " << d.max << ", axes " << order.of[0] << order.of[1] << order.of[2]
                << " signs " << order.sign[0] << " " << order.sign[1] << " " << order.sign[2];
        }
    }
    RecordProperty("worst", fmt::format("{}", worst));
    if (std::getenv("CHIARO_SHOW")) fmt::print("{}: at most {}\n", GetParam().name, worst);
}

/// The test above can fail: no two views are alike, and none is like any other in the mirror.
TEST_P(Orientation, MirrorsAndOtherViewsWouldShow) {
    const auto frames = images_of(volume_of(GetParam(), all_orders()[0]));
    for (std::size_t a = 0; a < frames.size(); ++a)
        for (std::size_t b = 0; b < frames.size(); ++b) {
            if (a != b) EXPECT_GT(difference(frames[a], frames[b], 0.1).pixels_beyond, 40);
            const bool opposite = a / 2 == b / 2 && a != b;  // seen from the other side: almost the mirror image
            EXPECT_GT(difference(frames[a], mirrored(frames[b]), 0.02).pixels_beyond, opposite ? 20 : 40) << a << b;
        }
}

INSTANTIATE_TEST_SUITE_P(Formats, Orientation, ::testing::ValuesIn(formats),
                         [](const auto& row) { return std::string(row.param.name); });

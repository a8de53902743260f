// Differences that are known beforehand.
#include <chiaro/compare.h>
#include <sched.h>

#include <cmath>
#include <functional>
#include <random>

#include "fixtures.h"
#include "tool_case.h"

using namespace chiaro;
using namespace chiaro::testing;

namespace {

using Value = std::function<float(int x, int y)>;

Frame gray(int width, int height, const Value& value, float alpha = 1) {
    Frame frame(width, height);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            float* p = &frame.rgba[std::size_t(4) * (y * width + x)];
            p[0] = p[1] = p[2] = value(x, y), p[3] = alpha;
        }
    return frame;
}

float waves(int x, int y) { return 0.5f + 0.25f * std::sin(0.7f * x) * std::cos(0.4f * y); }

Image flat(int size, std::uint8_t code) {
    return {size, size, false, std::vector<std::uint8_t>(3 * size * size, code)};
}

double square(double x) { return x * x; }

}  // namespace

TEST(CompareImages, TheSameImageDoesNotDiffer) {
    const Frame image = gray(40, 30, waves);
    const ImageDifference d = compare(image, image);
    EXPECT_EQ(d.rmse, 0);
    EXPECT_EQ(d.max, 0);
    EXPECT_EQ(d.bias, 0);
    EXPECT_EQ(d.ssim, 1);
    EXPECT_TRUE(std::isinf(d.psnr) && d.psnr > 0);
}

TEST(CompareImages, AConstantOffsetIsEveryMeasure) {
    const Frame a = gray(40, 30, [](int, int) { return 0.25f; }), b = gray(40, 30, [](int, int) { return 0.375f; });
    const ImageDifference d = compare(a, b);
    EXPECT_DOUBLE_EQ(d.rmse, 0.125);
    EXPECT_DOUBLE_EQ(d.max, 0.125);
    EXPECT_DOUBLE_EQ(d.bias, 0.125);
    EXPECT_DOUBLE_EQ(compare(b, a).bias, -0.125);
    EXPECT_NEAR(d.psnr, 20 * std::log10(8), 1e-12);
    const double c1 = 1e-4;  // without variance the luminance term is left
    EXPECT_NEAR(d.ssim, (2 * 0.25 * 0.375 + c1) / (square(0.25) + square(0.375) + c1), 1e-12);
}

TEST(CompareImages, SsimIsThatOfItsDefinition) {  // the one window of 11 x 11, by its double sum
    const Frame a = gray(11, 11, waves), b = gray(11, 11, [](int x, int y) { return waves(x + 1, y) * 0.8f; });
    double sum = 0, ma = 0, mb = 0, aa = 0, bb = 0, ab = 0;
    for (int y = 0; y < 11; ++y)
        for (int x = 0; x < 11; ++x) {
            const double w = std::exp(-(square(x - 5) + square(y - 5)) / (2 * 1.5 * 1.5));
            const double p = a.rgba[4 * (11 * y + x)], q = b.rgba[4 * (11 * y + x)];
            sum += w, ma += w * p, mb += w * q, aa += w * p * p, bb += w * q * q, ab += w * p * q;
        }
    for (double* m : {&ma, &mb, &aa, &bb, &ab}) *m /= sum;
    const double c1 = square(0.01), c2 = square(0.03);
    const double expected = (2 * ma * mb + c1) * (2 * (ab - ma * mb) + c2) /
                            ((ma * ma + mb * mb + c1) * (aa - ma * ma + bb - mb * mb + c2));
    EXPECT_NEAR(compare(a, b).ssim, expected, 1e-7);
    EXPECT_TRUE(std::isnan(compare(gray(10, 40, waves), gray(10, 40, waves)).ssim));
}

TEST(CompareImages, NoiseHasItsDeviation) {
    std::mt19937 random(7);
    std::normal_distribution<float> noise(0, 0.05f);
    const Frame a = gray(300, 300, waves),
                b = gray(300, 300, [&](int x, int y) { return waves(x, y) + noise(random); });
    const ImageDifference d = compare(a, b);
    EXPECT_NEAR(d.rmse, 0.05, 0.05 * 4 / std::sqrt(2 * 9e4));  // four standard errors of a deviation
    EXPECT_NEAR(d.bias, 0, 4 * 0.05 / 300);
    EXPECT_GT(d.max, 3 * 0.05);
    EXPECT_LT(d.ssim, 1);
    const Frame worse = gray(300, 300, [&](int x, int y) { return waves(x, y) + 3 * noise(random); });
    EXPECT_LT(compare(a, worse).ssim, d.ssim);
}

TEST(CompareImages, AlphaCountsWhereThereIsAny) {
    const auto black = [](int, int) { return 0.0f; };
    const ImageDifference d = compare(gray(20, 20, black), gray(20, 20, black, 0.5f));
    EXPECT_DOUBLE_EQ(d.rmse, 0.25);  // one channel of four by a half
    EXPECT_DOUBLE_EQ(d.max, 0.5);
    const Image clear{1, 1, true, {255, 128, 0, 0}}, half{1, 1, true, {255, 0, 0, 51}};
    EXPECT_EQ(display_values(clear).rgba, (std::vector<float>{0, 0, 0, 0}));  // colour that nobody sees
    EXPECT_EQ(display_values(half).rgba, (std::vector<float>{0.2f, 0, 0, 0.2f}));
    EXPECT_EQ(display_values(flat(1, 51)).rgba, (std::vector<float>{0.2f, 0.2f, 0.2f, 1}));
}

TEST(CompareImages, RefusesWhatHasNoAnswer) {
    Frame broken = gray(12, 12, waves);
    broken.rgba[5] = NAN;
    EXPECT_THROW(compare(gray(12, 12, waves), broken), Error);
    EXPECT_THROW(compare(gray(12, 12, waves), gray(12, 13, waves)), Error);
    EXPECT_THROW(compare(Frame(), Frame()), Error);
}

TEST(Compare, DoesNotDependOnTheThreads) {
    cpu_set_t before, one;
    sched_getaffinity(0, sizeof before, &before);
    const Frame a = gray(333, 217, waves), b = gray(333, 217, [](int x, int y) { return waves(x + y, y); });
    const Field field = [](double x, double y, double z) { return std::sin(x) * std::cos(y) + z; };
    const Volume u = sampled<float>({50, 40, 30}, field), v = sampled<std::uint8_t>({50, 40, 30}, field);
    const ImageDifference images = compare(a, b);
    const FieldDifference fields = compare(u, v);
    CPU_ZERO(&one);
    for (int cpu = 0; cpu < CPU_SETSIZE && CPU_COUNT(&one) == 0; ++cpu)
        if (CPU_ISSET(cpu, &before)) CPU_SET(cpu, &one);
    sched_setaffinity(0, sizeof one, &one);
    const ImageDifference alone = compare(a, b);
    const FieldDifference fields_alone = compare(u, v);
    sched_setaffinity(0, sizeof before, &before);
    EXPECT_EQ(images.rmse, alone.rmse);
    EXPECT_EQ(images.ssim, alone.ssim);
    EXPECT_EQ(images.bias, alone.bias);
    EXPECT_EQ(fields.rmse, fields_alone.rmse);
    EXPECT_EQ(fields.correlation, fields_alone.correlation);
}

TEST(CompareFields, AffineFieldsCorrelate) {
    const Field f = [](double x, double y, double z) { return x + 3 * std::sin(y) - z; };
    const Volume a = sampled<float>({20, 21, 22}, f);
    const auto affine = [&](double slope, double offset) {
        return compare(a, sampled<double>({20, 21, 22}, [&](auto... p) { return slope * float(f(p...)) + offset; }));
    };
    EXPECT_NEAR(affine(2, 1000).correlation, 1, 1e-12);
    EXPECT_NEAR(affine(-0.5, 7).correlation, -1, 1e-12);
    EXPECT_NEAR(affine(1, 0.25).rmse, 0.25, 1e-12);
    EXPECT_NEAR(affine(1, 0.25).bias, 0.25, 1e-12);
    EXPECT_NEAR(affine(1, -0.25).max, 0.25, 1e-12);
    EXPECT_TRUE(std::isnan(affine(0, 3).correlation));
}

TEST(CompareFields, ValuesAreThoseAfterSlopeAndIntercept) {
    const Field f = [](double x, double y, double z) { return x + 10 * y + z; };
    Volume a = sampled<std::uint8_t>({5, 6, 7}, f);
    const Volume b = sampled<float>({5, 6, 7}, [&](auto... p) { return 2 * f(p...) - 1024; });
    a.slope = 2, a.intercept = -1024;
    EXPECT_EQ(compare(a, b).max, 0);
    EXPECT_EQ(compare(a, b).rmse, 0);
}

TEST(CompareFields, RefusesWhatHasNoAnswer) {
    const Field f = [](double x, double, double) { return x; };
    EXPECT_THROW(compare(sampled<float>({4, 5, 6}, f), sampled<float>({4, 6, 5}, f)), Error);
    EXPECT_THROW(compare(sampled<float>({4, 5, 6}, f), sampled<float>({4, 5, 6}, [](auto...) { return NAN; })), Error);
}

namespace {

class CompareTool : public ToolTest {
protected:
    void SetUp() override {
        ToolTest::SetUp();
        write_png(flat(16, 100), folder / "a.png");
        write_png(flat(16, 151), folder / "b.png");  // 51 / 255 = 0.2 more
        write_png(flat(20, 100), folder / "wide.png");
        const auto ramp = [](double sign) {
            return sampled<float>({4, 5, 6}, [sign](double x, double, double) { return sign * x; });
        };
        write_nrrd(ramp(1), folder / "a.nrrd", NrrdEncoding::raw);
        write_nrrd(ramp(-1), folder / "b.nrrd", NrrdEncoding::gzip);
    }
};

}  // namespace

TEST_F(CompareTool, GivesJson) {
    const auto images = nlohmann::json::parse(tool("compare a.png b.png --json").out);
    EXPECT_EQ(images.size(), 5u);
    EXPECT_NEAR(images["rmse"].get<double>(), 0.2, 1e-7);
    EXPECT_NEAR(images["max"].get<double>(), 0.2, 1e-7);
    EXPECT_NEAR(images["bias"].get<double>(), 0.2, 1e-7);
    EXPECT_NEAR(images["psnr"].get<double>(), 20 * std::log10(5), 1e-5);
    EXPECT_LT(images["ssim"], 1);
    const auto same = nlohmann::json::parse(tool("compare a.png a.png --json").out);
    EXPECT_TRUE(same["psnr"].is_null());
    EXPECT_EQ(same["ssim"], 1);
    const auto fields = nlohmann::json::parse(tool("compare a.nrrd b.nrrd --json").out);
    EXPECT_EQ(fields.size(), 4u);
    EXPECT_NEAR(fields["correlation"].get<double>(), -1, 1e-12);
    EXPECT_EQ(fields["max"], 6);
    EXPECT_EQ(fields["bias"], -3);
}

TEST_F(CompareTool, EndsAsTheLimitsSay) {
    write("broken.png", "not a picture");
    struct Case {
        const char* arguments;
        int code;
        const char* message;
    };
    const Case cases[] = {
        {"a.png b.png", 0, ""},
        {"a.png b.png --fail-above rmse=0.21 --fail-above max=.21 --fail-above bias=0.21", 0, ""},
        {"a.png a.png --fail-above rmse=0 --fail-below psnr=99 --fail-below ssim=1", 0, ""},
        {"a.png b.png --fail-above rmse=0.19", 5, "a.png and b.png: rmse 0.2 is above 0.19"},
        {"b.png a.png --fail-above bias=0.1", 5, "bias -0.2 is above 0.1"},
        {"a.png b.png --fail-below psnr=20", 5, "psnr 13.9794 is below 20"},
        {"a.nrrd b.nrrd --fail-below correlation=0.9 --fail-above max=1", 5,
         "max 6 is above 1, correlation -1 is below"},
        {"a.png", 2, "A or B is missing"},
        {"a.png a.nrrd", 2, "a picture and a field"},
        {"a.png b.png --fail-above rmse", 2, "--fail-above rmse: expected METRIC=V"},
        {"a.png b.png --fail-above rmse=low", 2, "expected METRIC=V"},
        {"a.png b.png --fail-above ssmi=1", 2, "did you mean 'ssim'?"},
        {"a.png b.png --fail-above ssim=1", 2, "for ssim more is better; use --fail-below"},
        {"a.png b.png --fail-below max=1", 2, "for max less is better; use --fail-above"},
        {"a.nrrd b.nrrd --fail-below psnr=1", 2, "must be one of rmse, max, bias, correlation"},
        {"a.png none.png", 3, "none.png"},
        {"a.png broken.png", 3, "broken.png: is not a PNG file"},
        {"a.png wide.png", 3, "pictures of 16 x 16 and 20 x 20 pixels cannot be compared"},
        {"a.nrrd sample:ball:8", 3, "fields of 4 x 5 x 6 voxels with 1 value and 8 x 8 x 8 voxels with 1 value"},
    };
    for (const auto& [arguments, code, message] : cases) {
        const Said said = tool(std::string("compare ") + arguments);
        EXPECT_EQ(said.code, code) << arguments << "\n" << said.err;
        EXPECT_NE(said.err.find(message), said.err.npos) << arguments << "\n" << said.err;
        EXPECT_EQ(std::count(said.err.begin(), said.err.end(), '\n'), code != 0) << arguments << "\n" << said.err;
        EXPECT_EQ(said.out.empty(), code != 0 && code != 5) << arguments;
    }
}

// Beside VTK's own mappers, for CPUs (fixed point) and for GPUs: functions of value and gradient, several components,
// lights. Unshaded but for the last; soft balls, whose gradients stay below a quarter of the range of values a voxel,
// beyond which VTK clamps them.
#include <malloc.h>

#include <algorithm>
#include <functional>

#include "case.h"
#include "vtkFixedPointVolumeRayCastMapper.h"
#include "vtkFloatArray.h"
#include "vtkLight.h"
#include "vtkOpenGLGPUVolumeRayCastMapper.h"

using namespace chiaro;
using namespace chiaro::testing;

namespace {

constexpr int edge = 40;
constexpr double step = 0.25;

// VTK 9.1's fixed-point mapper reads memory that was never set: pictures differed from run to run, by up to 17 of 255.
// In this program all that is allocated is 0.
[[maybe_unused]] const int zeroed = mallopt(M_PERTURB, 255);

/// A ball that fades out over its whole radius.
double ball(Vec3 p, Vec3 middle, double radius) {
    return std::clamp(255 * (1 - length(p - middle) / radius), 0.0, 255.0);
}

struct Beside {
    vtkNew<vtkImageData> image;
    vtkNew<vtkVolume> actor;
    vtkNew<vtkRenderer> renderer;
    vtkNew<vtkRenderWindow> window;
    vtkVolumeProperty& looks = *actor->GetProperty();
    std::vector<std::string> said;

    explicit Beside(const std::vector<std::function<double(Vec3)>>& values) {
        image->SetDimensions(edge, edge, edge);
        vtkNew<vtkUnsignedCharArray> scalars;
        const int count = int(values.size());
        scalars->SetNumberOfComponents(count), scalars->SetNumberOfTuples(edge * edge * edge);
        for (vtkIdType i = 0; i < edge * edge * edge; ++i)
            for (int c = 0; c < count; ++c) {
                const Vec3 p{double(i % edge), double(i / edge % edge), double(i / edge / edge)};
                scalars->SetTypedComponent(i, c, (unsigned char)(std::lround(values[std::size_t(c)](p))));
            }
        image->GetPointData()->SetScalars(scalars);
        looks.SetInterpolationTypeToLinear();
        renderer->AddVolume(actor);
        window->SetOffScreenRendering(1), window->SetMultiSamples(0), window->SetSize(120, 100);
        window->AddRenderer(renderer);
        vtkCamera& camera = *renderer->GetActiveCamera();
        camera.SetPosition(110, -70, 75), camera.SetFocalPoint(20, 20, 20), camera.SetViewUp(0, 0, 1);
        camera.SetViewAngle(20);
    }

    /// From one colour at 0 to another at 255, and as much opacity at 255 a unit.
    void set(int component, Rgb low, Rgb high, double opacity) {
        vtkNew<vtkColorTransferFunction> colors;
        colors->AddRGBPoint(0, low[0], low[1], low[2]), colors->AddRGBPoint(255, high[0], high[1], high[2]);
        vtkNew<vtkPiecewiseFunction> opacities;
        opacities->AddPoint(0, 0), opacities->AddPoint(255, opacity);
        looks.SetColor(component, colors), looks.SetScalarOpacity(component, opacities);
    }

    Picture drawn(vtkVolumeMapper& mapper) {
        mapper.SetInputData(image.Get());
        actor->SetMapper(&mapper);
        renderer->ResetCameraClippingRange();
        window->Render();
        Picture picture{120, 100, std::vector<unsigned char>(std::size_t(3) * 120 * 100)};
        vtkNew<vtkUnsignedCharArray> rows;
        window->GetPixelData(0, 0, 119, 99, 0, rows);
        std::copy_n(rows->GetPointer(0), picture.rgb.size(), picture.rgb.begin());
        return picture;
    }

    Picture ours(int blend) {
        vtkNew<vtkChiaroVolumeMapper> mapper;
        mapper->SetLighting("none"), mapper->SetSampleDistance(step), mapper->SetBlendMode(blend);
        listen_to(*mapper, said);
        return drawn(*mapper);
    }
    Picture on_gpu(int blend) {
        vtkNew<vtkOpenGLGPUVolumeRayCastMapper> mapper;
        mapper->AutoAdjustSampleDistancesOff(), mapper->UseJitteringOff(), mapper->SetSampleDistance(step);
        mapper->SetBlendMode(blend);
        return drawn(*mapper);
    }
    Picture fixed_point(int blend) {
        vtkNew<vtkFixedPointVolumeRayCastMapper> mapper;
        mapper->AutoAdjustSampleDistancesOff(), mapper->SetSampleDistance(step), mapper->SetBlendMode(blend);
        return drawn(*mapper);
    }
};

/// Root mean square over what one of them shows, of 255.
double rmse(const Picture& a, const Picture& b) {
    double sum = 0;
    int count = 0;
    for (std::size_t i = 0; i < a.rgb.size(); i += 3) {
        if (!(a.rgb[i] + a.rgb[i + 1] + a.rgb[i + 2] + b.rgb[i] + b.rgb[i + 1] + b.rgb[i + 2])) continue;
        for (std::size_t c = i; c < i + 3; ++c) sum += std::pow(double(a.rgb[c]) - b.rgb[c], 2), ++count;
    }
    return std::sqrt(sum / std::max(count, 1));
}

/// Near both, or the nearer where they are not near each other. `fixed_point`: whether that mapper knows what is asked.
void expect_near(const char* what, Beside& scene, bool fixed_point = true,
                 int blend = vtkVolumeMapper::COMPOSITE_BLEND) {
    constexpr double allowed = 3;
    const Picture ours = scene.ours(blend), gpu = scene.on_gpu(blend);
    const double from_gpu = rmse(ours, gpu);
    double from_cpu = from_gpu, apart = 0;
    if (fixed_point) {
        const Picture cpu = scene.fixed_point(blend);
        from_cpu = rmse(ours, cpu), apart = rmse(cpu, gpu);
    }
    const long lit = std::count_if(ours.rgb.begin(), ours.rgb.end(), [](unsigned char c) { return c > 30; });
    if (std::getenv("CHIARO_SHOW"))
        std::printf("%s: %.2f from the GPU's, %.2f from the fixed-point mapper; these two %.2f\n", what, from_gpu,
                    from_cpu, apart);
    EXPECT_LE(apart <= allowed ? std::max(from_gpu, from_cpu) : std::min(from_gpu, from_cpu), allowed) << what;
    EXPECT_GT(lit, 500) << what;
    EXPECT_TRUE(scene.said.empty()) << what << scene.said.front();
}

std::function<double(Vec3)> ball_at(Vec3 middle, double radius) {
    return [=](Vec3 p) { return ball(p, middle, radius); };
}
const auto left = ball_at({15, 18, 20}, 14), right = ball_at({25, 20, 18}, 13), whole = ball_at({20, 20, 20}, 19);
const Rgb red{0.9, 0.2, 0.1}, green{0.2, 0.8, 0.3}, blue{0.1, 0.3, 0.9}, white{1, 1, 1};

void set_four(Beside& scene, int count) {
    const Rgb colors[]{red, green, blue, white};
    for (int i = 0; i < count; ++i) scene.set(i, colors[i], colors[i], 0.1);
}

}  // namespace

TEST(BesideVtk, OpacityByGradient) {
    Beside scene({whole});
    scene.set(0, red, blue, 0.12);
    vtkNew<vtkPiecewiseFunction> opacity;
    opacity->AddPoint(0, 0), opacity->AddPoint(9, 0.3), opacity->AddPoint(16, 1);
    scene.looks.SetGradientOpacity(opacity);
    expect_near("gradient opacity", scene);
}

// Of VTK's mappers the one for GPUs has it. Its opacities are those of a sample: the unit is as long.
TEST(BesideVtk, FunctionsOfValueAndGradient) {
    const auto steeper = [](Vec3 p) { return std::max(ball(p, {14, 20, 20}, 12), 0.55 * ball(p, {27, 20, 20}, 12)); };
    Beside scene({steeper});
    scene.set(0, white, white, 0.5);
    scene.looks.SetScalarOpacityUnitDistance(step);
    for (const bool colors : {false, true}) {
        vtkNew<vtkImageData> function;
        function->SetDimensions(64, 48, 1);
        vtkNew<vtkFloatArray> rgba;
        rgba->SetNumberOfComponents(4), rgba->SetNumberOfTuples(64 * 48);
        for (int y = 0; y < 48; ++y)
            for (int x = 0; x < 64; ++x) {
                const double steep = y / 47.0, value = x / 63.0;
                const double opacity = 0.03 * value * std::exp(-std::pow((steep - (colors ? 0.25 : 0.33)) / 0.15, 2));
                const double blue_part = colors ? std::clamp(2.5 * steep, 0.0, 1.0) : value;
                const double tuple[4]{1 - blue_part, 0.4, blue_part, opacity};
                rgba->SetTuple(y * 64 + x, tuple);
            }
        function->GetPointData()->SetScalars(rgba);
        scene.looks.SetTransferFunction2D(0, function), scene.looks.SetTransferFunctionMode(vtkVolumeProperty::TF_2D);
        expect_near(colors ? "TF_2D with colours by gradient" : "TF_2D", scene, false);
    }
}

// Where they lie apart. Where they overlap both of VTK's mappers add up colours times opacities, but take the mean of
// the opacities weighted by themselves, which is less than any medium of these colours has; ours are media, which mix.
TEST(BesideVtk, IndependentComponents) {
    const std::function<double(Vec3)> all[]{ball_at({11, 11, 20}, 9), ball_at({29, 11, 20}, 9),
                                            ball_at({11, 29, 20}, 9), ball_at({29, 29, 20}, 9)};
    for (const int count : {2, 3, 4}) {
        Beside scene({all, all + count});
        set_four(scene, count);
        expect_near((std::to_string(count) + " components").c_str(), scene);
        scene.looks.SetComponentWeight(0, 0.4), scene.looks.SetComponentWeight(1, 0.8);
        scene.looks.SetScalarOpacityUnitDistance(1, 2);
        expect_near((std::to_string(count) + " components, weighted").c_str(), scene);
    }
    Beside scene({all[0], all[3]});
    set_four(scene, 2);
    vtkNew<vtkPiecewiseFunction> opacity;
    opacity->AddPoint(0, 0.1), opacity->AddPoint(8, 0.2), opacity->AddPoint(25, 1);
    scene.looks.SetGradientOpacity(1, opacity);
    expect_near("by the gradient of one", scene);
    if (!std::getenv("CHIARO_SHOW")) return;
    Beside mixed({left, right});
    set_four(mixed, 2);
    std::printf(
        "two that overlap: %.2f from the fixed-point mapper\n",
        rmse(mixed.ours(vtkVolumeMapper::COMPOSITE_BLEND), mixed.fixed_point(vtkVolumeMapper::COMPOSITE_BLEND)));
}

TEST(BesideVtk, MaximaOfComponents) {
    Beside scene({left, right});
    set_four(scene, 2);
    scene.set(0, red, red, 0.5), scene.set(1, blue, blue, 0.5);
    expect_near("maxima", scene, true, vtkVolumeMapper::MAXIMUM_INTENSITY_BLEND);
}

TEST(BesideVtk, DependentComponents) {
    Beside two({[](Vec3 p) { return 6 * p.x; }, whole});
    two.set(0, red, blue, 0.1);
    two.looks.IndependentComponentsOff();
    expect_near("colour by one, opacity by another", two);

    Beside four({[](Vec3 p) { return 6 * p.x; }, [](Vec3 p) { return 255 - 6 * p.z; }, right, whole});
    four.set(0, white, white, 0.1);
    four.looks.IndependentComponentsOff();
    expect_near("own colours", four);
}

// VTK's lights have black ambient light, and its rays another eye for highlights: matte, and with white.
TEST(BesideVtk, LightsOfEveryKind) {
    for (const bool positional : {false, true}) {
        Beside scene({whole});
        scene.set(0, white, white, 0.4);
        scene.looks.ShadeOn(), scene.looks.SetAmbient(0), scene.looks.SetDiffuse(0.9), scene.looks.SetSpecular(0);
        const struct {
            Vec3 at;
            Rgb color;
        } lights[]{{{90, -60, 20}, red}, {{20, 20, 140}, green}, {{110, 60, 60}, blue}};
        for (const auto& [at, color] : lights) {
            vtkNew<vtkLight> light;
            light->SetLightTypeToSceneLight();
            light->SetPosition(at.x, at.y, at.z), light->SetFocalPoint(20, 20, 20);
            light->SetColor(color[0], color[1], color[2]);
            light->SetPositional(positional), light->SetConeAngle(180);
            scene.renderer->AddLight(light);
        }
        expect_near(positional ? "three lights at points" : "three directional lights", scene, false);
    }
}

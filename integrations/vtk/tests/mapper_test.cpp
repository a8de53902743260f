// The mapper's picture is Chiaro's: looks, blend modes, cameras, clips, places, opaque geometry.
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "case.h"
#include "vtkActor.h"
#include "vtkCellData.h"
#include "vtkContourValues.h"
#include "vtkCullerCollection.h"
#include "vtkFloatArray.h"
#include "vtkFrustumCoverageCuller.h"
#include "vtkLight.h"
#include "vtkMatrix4x4.h"
#include "vtkPNGReader.h"
#include "vtkPlane.h"
#include "vtkPlaneSource.h"
#include "vtkPolyDataMapper.h"
#include "vtkProperty.h"
#include "vtkSphereSource.h"
#include "vtkTransform.h"

using namespace chiaro;
using namespace chiaro::testing;

TEST(Mapper, DrawsEachLightAsChiaroDoes) {
    for (const char* method : {"none", "spao", "visibility", "histogram", "transport"})
        for (const bool shade : {false, true}) {
            Case c;
            c.actor->GetProperty()->SetShade(shade);
            c.scene.lighting.shading = shade ? Shading::phong : Shading::none;
            from_text(method, c.scene.illumination.method);
            c.scene.illumination.histogram.cache = "none";
            c.mapper->SetLighting(method);
            c.scene.illumination.histogram.radius = 4, c.scene.illumination.histogram.clusters = 64;
            for (const auto& [name, value] :
                 {std::pair{"cache", "none"}, {"hist-radius", "4"}, {"hist-clusters", "64"}})
                c.mapper->SetSetting(name, value);
            if (c.scene.illumination.method == Method::visibility) {
                c.scene.lighting.probe.source = "sky";
                c.mapper->SetProbe("sky");
            }
            c.expect_same(method);
        }
}

TEST(Mapper, DrawsEachBlendModeAsChiaroDoes) {
    using Blend = vtkVolumeMapper;
    for (const auto& [blend, mode] : {std::pair{Blend::COMPOSITE_BLEND, Mode::dvr},
                                      {Blend::MAXIMUM_INTENSITY_BLEND, Mode::mip},
                                      {Blend::AVERAGE_INTENSITY_BLEND, Mode::mean},
                                      {Blend::ADDITIVE_BLEND, Mode::additive},
                                      {Blend::ISOSURFACE_BLEND, Mode::iso}}) {
        Case c;
        c.mapper->SetBlendMode(blend);
        c.scene.mode = mode;
        c.scene.illumination.method = Method::spao;
        if (mode == Mode::iso) {
            c.actor->GetProperty()->GetIsoSurfaceValues()->SetValue(0, 120);
            c.scene.iso = {{120, {}, 0.08 + (120 - 90) / 70.0 * 0.22}};
        }
        if (mode == Mode::mean) {  // of which much is low
            c.actor->GetProperty()->GetScalarOpacity()->AddPoint(0, 0.6);
            c.scene.transfer.points->points.insert(c.scene.transfer.points->points.begin(), {0, {0.2, 0.4, 0.9}, 0.6});
        }
        c.expect_same(std::string(to_text(mode)).c_str());
    }
    Case c;  // the smallest value along a ray of the shells is that of nothing: turned round
    for (std::size_t i = 0; i < c.volume.voxel_count(); ++i)
        c.image->GetPointData()->GetScalars()->SetTuple1(vtkIdType(i), 255 - int(c.volume.as<std::uint8_t>()[i]));
    Volume turned = make_volume(c.volume.dimensions, VoxelType::u8);
    turned.geometry = c.volume.geometry;
    for (std::size_t i = 0; i < c.volume.voxel_count(); ++i)
        turned.as<std::uint8_t>()[i] = std::uint8_t(255 - c.volume.as<std::uint8_t>()[i]);
    c.mapper->SetBlendModeToMinimumIntensity();
    c.scene.mode = Mode::minip;
    c.expect_same("minip", &turned);
}

// VTK's gradients are of a mean voxel edge, 31/30 mm here.
TEST(Mapper, TakesOpacityByGradient) {
    Case c;
    const Picture without = c.drawn();
    vtkNew<vtkPiecewiseFunction> opacity;
    opacity->AddPoint(-5, 0), opacity->AddPoint(4, 0.2), opacity->AddPoint(25, 1);
    c.actor->GetProperty()->SetGradientOpacity(opacity);
    const double edge = (1 + 0.9 + 1.2) / 3;
    c.scene.transfer.points->gradient = {{0, 0.2 * 5 / 9}, {4 / edge, 0.2}, {25 / edge, 1}};
    c.expect_same("gradient opacity");
    EXPECT_GT(distance(c.drawn(), without).mean, 0.5);
    c.actor->GetProperty()->DisableGradientOpacityOn();
    EXPECT_LE(distance(c.drawn(), without).max, 1);
}

// The tool itself, by files.
TEST(Mapper, DrawsWhatTheToolDraws) {
    Case c;
    c.actor->GetProperty()->ShadeOn();
    c.scene.lighting.shading = Shading::phong;
    const std::filesystem::path folder =
        std::filesystem::temp_directory_path() / ("vtk_mapper_test-" + std::to_string(getpid()));
    std::filesystem::create_directory(folder);
    chiaro::Progress progress;
    c.scene.volume = (folder / "v.nrrd").string();
    write_nrrd(c.volume, c.scene.volume, NrrdEncoding::raw, progress);
    std::ofstream(folder / "s.json") << to_json(c.scene);
    const std::string line = std::string(CHIARO_BIN) + "/chiaro render --quiet --scene " +
                             (folder / "s.json").string() + " -o " + (folder / "p.png").string();
    ASSERT_EQ(std::system(line.c_str()), 0);
    vtkNew<vtkPNGReader> reader;
    reader->SetFileName((folder / "p.png").c_str());
    reader->Update();
    Picture theirs{Case::width, Case::height, {}};
    for (int y = Case::height - 1; y >= 0; --y)
        for (int x = 0; x < Case::width; ++x)
            for (int k = 0; k < 3; ++k)
                theirs.rgb.push_back(static_cast<unsigned char*>(reader->GetOutput()->GetScalarPointer(x, y, 0))[k]);
    const Picture ours = c.drawn();
    EXPECT_LE(distance(ours, theirs).max, 2);
    EXPECT_GT(c.seen(ours), 1500);
    std::filesystem::remove_all(folder);
}

TEST(Mapper, SeesByParallelProjectionAndOffTheAxis) {
    Case c;
    c.renderer->GetActiveCamera()->ParallelProjectionOn();
    c.renderer->GetActiveCamera()->SetParallelScale(40);
    c.renderer->ResetCameraClippingRange();
    // Chiaro's is as wide as what it fits.
    c.scene.camera.projection = Projection::orthographic;
    c.scene.camera.fit = Fit::visible, c.scene.camera.fit_centre = c.target, c.scene.camera.fit_radius_mm = 40;
    c.expect_same("parallel");

    // A window of half the width whose centre is the left half's: the left half of the picture.
    Case half;
    const Picture whole = half.drawn();
    half.window->SetSize(Case::width / 2, Case::height);
    half.renderer->GetActiveCamera()->SetWindowCenter(-1, 0);
    half.renderer->ResetCameraClippingRange();
    const Picture left = half.drawn();
    int worst = 0;
    for (int y = 0; y < Case::height; ++y)
        for (int x = 0; x < Case::width / 2; ++x)
            for (int k = 0; k < 3; ++k) worst = std::max(worst, std::abs(left.at(x, y, k) - whole.at(x, y, k)));
    EXPECT_LE(worst, 2);
    EXPECT_TRUE(half.said.empty());
}

TEST(Mapper, DrawsIntoItsViewport) {
    Case c;
    c.window->SetSize(2 * Case::width, Case::height);
    c.renderer->SetViewport(0.5, 0, 1, 1);
    const Picture both = c.drawn(), expected = c.expected();
    int worst = 0;
    for (int y = 0; y < Case::height; ++y)
        for (int x = 0; x < Case::width; ++x)
            for (int k = 0; k < 3; ++k)
                worst = std::max(worst, std::abs(both.at(x + Case::width, y, k) - expected.at(x, y, k)));
    EXPECT_LE(worst, 2);
    EXPECT_EQ(both.at(20, 50, 1), 0);
}

TEST(Mapper, CropsAndClips) {
    Case crop;
    crop.mapper->CroppingOn();
    crop.mapper->SetCroppingRegionPlanes(20, 40, 0, 15, 10, 60);
    crop.mapper->SetCroppingRegionFlagsToSubVolume();
    const auto share = [&](double plane, int a) {
        return std::clamp((plane - crop.volume.geometry.origin_mm[a]) / crop.volume.geometry.spacing_mm[a] / 47, 0.0,
                          1.0);
    };
    crop.scene.clip.box = {share(20, 0), share(40, 0), share(0, 1), share(15, 1), share(10, 2), share(60, 2)};
    crop.expect_same("subvolume");
    crop.mapper->SetCroppingRegionFlags(1 | 2 | 1 << 9 | 2 << 9);  // x to 40, y to 0, z to 60
    crop.scene.clip.box = {0, share(40, 0), 0, share(0, 1), 0, share(60, 2)};
    const Distance d = distance(crop.drawn(), crop.expected());
    EXPECT_LE(d.max, 2);

    Case clip;
    vtkNew<vtkPlane> plane;
    plane->SetOrigin(28, 0, 0), plane->SetNormal(0.8, 0.6, 0);
    clip.mapper->AddClippingPlane(plane);
    clip.scene.clip.planes = {{{-0.8, -0.6, 0}, -0.8 * 28}};
    clip.expect_same("plane");
}

// A volume that is turned, moved and scaled, and one that is stretched: as if its voxels stood there.
TEST(Mapper, StandsWhereTheVolumeDoes) {
    for (const bool stretched : {false, true}) {
        Case c;
        vtkNew<vtkTransform> transform;
        transform->Translate(30, 5, 10);
        transform->RotateWXYZ(40, 0.3, 0.2, 0.9);
        transform->Scale(0.7, 0.7, stretched ? 0.9 : 0.7);
        c.actor->SetUserTransform(transform);
        vtkNew<vtkPlane> plane;  // of the world
        plane->SetOrigin(40, 10, 30), plane->SetNormal(0, 0.6, 0.8);
        c.mapper->AddClippingPlane(plane);
        c.scene.clip.planes = {{{0, -0.6, -0.8}, -(6 + 24.0)}};
        c.actor->GetProperty()->ShadeOn();
        c.scene.lighting.shading = Shading::phong;
        vtkNew<vtkLight> sun;
        sun->SetLightTypeToSceneLight();
        sun->SetPosition(1, 0.5, 2), sun->SetFocalPoint(0, 0, 0), sun->SetColor(1, 0.8, 0.6);
        c.renderer->AddLight(sun);
        vtkNew<vtkLight> lamp;
        lamp->SetLightTypeToSceneLight(), lamp->PositionalOn(), lamp->SetConeAngle(180);
        lamp->SetPosition(60, 40, 90), lamp->SetColor(0.2, 0.5, 0.7), lamp->SetIntensity(0.5);
        c.renderer->AddLight(lamp);
        c.scene.lighting.lights = {{.headlight = false,
                                    .azimuth_deg = std::atan2(0.5, 1) / radians(1),
                                    .elevation_deg = std::atan2(2, std::hypot(1, 0.5)) / radians(1),
                                    .color = {1, 0.8, 0.6}},
                                   {.color = {0.1, 0.25, 0.35}, .position_mm = Vec3{60, 40, 90}}};

        Volume moved = Case::placed(make_sample("shells", 48));
        const vtkMatrix4x4& m = *transform->GetMatrix();
        const auto turned = [&](Vec3 v) {
            return Vec3{m.GetElement(0, 0) * v.x + m.GetElement(0, 1) * v.y + m.GetElement(0, 2) * v.z,
                        m.GetElement(1, 0) * v.x + m.GetElement(1, 1) * v.y + m.GetElement(1, 2) * v.z,
                        m.GetElement(2, 0) * v.x + m.GetElement(2, 1) * v.y + m.GetElement(2, 2) * v.z};
        };
        Geometry& g = moved.geometry;
        g.origin_mm = turned(g.origin_mm) + Vec3{m.GetElement(0, 3), m.GetElement(1, 3), m.GetElement(2, 3)};
        for (int a = 0; a < 3; ++a) {
            const Vec3 step = turned(g.spacing_mm[a] * g.direction[std::size_t(a)]);
            g.spacing_mm[a] = length(step), g.direction[std::size_t(a)] = normalized(step);
        }
        const Picture ours = c.drawn(), theirs = c.expected(moved);
        const Distance d = distance(ours, theirs);
        // Rounding moves samples across steep edges.
        EXPECT_LE(d.beyond, 60u) << stretched << " max " << d.max;
        EXPECT_LT(d.mean, 0.1);
        EXPECT_TRUE(c.said.empty()) << c.said.front();
        EXPECT_GT(c.seen(ours), 1000);
    }
}

// A wall across the volume, square to the view: rays end there, and its colour shines through what lies before it.
TEST(Mapper, EndsAtOpaqueGeometry) {
    for (const auto& [parallel, samples] : {std::pair{false, 0}, {true, 0}, {false, 4}}) {
        Case c;
        c.window->SetMultiSamples(samples);
        if (parallel) {
            c.renderer->GetActiveCamera()->ParallelProjectionOn(), c.renderer->GetActiveCamera()->SetParallelScale(40);
            c.scene.camera.projection = Projection::orthographic;
            c.scene.camera.fit_centre = c.target, c.scene.camera.fit_radius_mm = 40;
        }
        const Vec3 forward = normalized(c.target - c.eye);
        vtkNew<vtkPlaneSource> wall;
        const Vec3 right = normalized(cross(forward, {0, 0, 1})), up = cross(right, forward);
        const auto corner = [&](double x, double y) { return c.target + x * right + y * up; };
        const Vec3 o = corner(-200, -200), a = corner(0, -200), b = corner(-200, 200);  // the left half of the picture
        wall->SetOrigin(o.x, o.y, o.z), wall->SetPoint1(a.x, a.y, a.z), wall->SetPoint2(b.x, b.y, b.z);
        vtkNew<vtkPolyDataMapper> polygons;
        polygons->SetInputConnection(wall->GetOutputPort());
        vtkNew<vtkActor> opaque;
        opaque->SetMapper(polygons);
        opaque->GetProperty()->SetColor(0.1, 0.8, 0.3), opaque->GetProperty()->LightingOff();
        c.renderer->AddActor(opaque);
        c.renderer->ResetCameraClippingRange();
        const Picture with = c.drawn();

        // The same by ends that are known: |target - eye| along the axis, in parallel from the near plane, where rays
        // begin.
        const Picture whole = c.expected();
        const double distance_mm = length(c.target - c.eye), half = std::tan(radians(12.5));
        RayEnds ends{Case::width, Case::height, {}};
        for (int y = 0; y < Case::height; ++y)
            for (int x = 0; x < Case::width; ++x) {
                const double px = ((x + 0.5) / Case::width * 2 - 1) * half * Case::width / Case::height,
                             py = (1 - (y + 0.5) / Case::height * 2) * half;
                ends.mm.push_back(float(
                    parallel ? dot(c.target - make_camera(c.scene.camera, c.volume.geometry, c.volume.dimensions).eye,
                                   forward)
                             : distance_mm * std::sqrt(1 + px * px + py * py)));
            }
        c.scene.sampling.ends = std::make_shared<const RayEnds>(ends);
        c.scene.output.background = {0.1, 0.8, 0.3};
        const Picture cut = c.expected();
        int worst = 0, hidden = 0;
        for (int y = 0; y < Case::height; ++y)
            for (int x = 0; x < Case::width; ++x) {
                if (std::abs(x - Case::width / 2) <= 1) continue;  // the wall's edge
                const Picture& right_one = x < Case::width / 2 ? cut : whole;
                for (int k = 0; k < 3; ++k) worst = std::max(worst, std::abs(with.at(x, y, k) - right_one.at(x, y, k)));
                hidden += x < Case::width / 2 && std::abs(cut.at(x, y, 0) - whole.at(x, y, 0)) > 10;
            }
        EXPECT_LE(worst, 2) << parallel;
        EXPECT_GT(hidden, 500);
        c.mapper->IntermixIntersectingGeometryOff();
        EXPECT_GT(distance(c.drawn(), with).beyond, 1000u);
        EXPECT_TRUE(c.said.empty()) << c.said.front();
    }
}

TEST(Mapper, SeesEditsOfDataAndLooks) {
    Case c;
    const Picture first = c.drawn();
    EXPECT_EQ(distance(c.drawn(), first).max, 0);
    c.actor->GetProperty()->GetScalarOpacity()->AddPoint(160, 0.02);
    const Picture thinner = c.drawn();
    EXPECT_GT(distance(thinner, first).beyond, 500u);
    c.mapper->SetStrength(0);
    EXPECT_GT(distance(c.drawn(), thinner).beyond, 500u);
    c.mapper->SetSetting("strength", "");
    EXPECT_EQ(distance(c.drawn(), thinner).max, 0);
    for (vtkIdType i = 0; i < 48 * 48 * 24; ++i) c.image->GetPointData()->GetScalars()->SetTuple1(i, 0);
    c.image->GetPointData()->GetScalars()->Modified();
    EXPECT_GT(distance(c.drawn(), thinner).beyond, 500u);
    EXPECT_TRUE(c.said.empty());
}

// Values of cells stand at their centres; an array by its name; any number type.
TEST(Mapper, TakesCellsNamesAndTypes) {
    Case c;
    Volume cells = make_volume({47, 47, 47}, VoxelType::f32);
    cells.geometry = c.volume.geometry;
    cells.geometry.origin_mm = c.volume.geometry.world_from_voxel({0.5, 0.5, 0.5});
    vtkNew<vtkFloatArray> values;
    values->SetName("density");
    values->SetNumberOfTuples(47 * 47 * 47);
    std::size_t i = 0;
    for (int z = 0; z < 47; ++z)
        for (int y = 0; y < 47; ++y)
            for (int x = 0; x < 47; ++x, ++i)
                values->SetValue(
                    vtkIdType(i),
                    cells.as<float>()[i] =
                        c.volume.as<std::uint8_t>()[(std::size_t(z) * 48 + std::size_t(y)) * 48 + std::size_t(x)]);
    c.image->GetCellData()->AddArray(values);
    c.mapper->SetScalarModeToUseCellFieldData();
    c.mapper->SelectScalarArray("density");
    c.expect_same("cells", &cells);
}

// One volume behind another, in whichever order they were added, where VTK is asked to draw from back to front.
TEST(Mapper, SeveralVolumesAreDrawnInTheirOrder) {
    const auto drawn = [](bool near_first) {
        Case c;
        vtkNew<vtkVolume> far_one;
        vtkNew<vtkChiaroVolumeMapper> other;
        other->SetInputData(c.image.Get());
        far_one->SetMapper(other), far_one->SetProperty(c.actor->GetProperty());
        const Vec3 away = 70 * normalized(c.target - c.eye);
        far_one->SetPosition(away.x, away.y, away.z);
        if (near_first)
            c.renderer->AddVolume(far_one);
        else {
            c.renderer->RemoveVolume(c.actor);
            c.renderer->AddVolume(far_one), c.renderer->AddVolume(c.actor);
        }
        c.renderer->ResetCameraClippingRange();
        c.renderer->GetCullers()->InitTraversal();
        vtkFrustumCoverageCuller::SafeDownCast(c.renderer->GetCullers()->GetNextItem())->SetSortingStyleToBackToFront();
        return c.drawn();
    };
    const Picture one = drawn(true), other = drawn(false);
    EXPECT_EQ(distance(one, other).max, 0);
    Case alone;
    EXPECT_GT(distance(one, alone.drawn()).beyond, 500u);
}

TEST(Mapper, DrawsFewerRaysWhereAsked) {
    Case c;
    const Picture all = c.drawn();
    c.mapper->SetImageSampleDistance(2);
    const Distance d = distance(c.drawn(), all);
    EXPECT_GT(d.max, 0);
    EXPECT_LT(d.mean, 4);
}

TEST(Mapper, LivesWithItsWindow) {
    Case c;
    const Picture first = c.drawn();
    c.window->Finalize();  // graphics resources go
    EXPECT_EQ(distance(c.drawn(), first).max, 0);
}

// What is not drawn is told by its name, once, and nothing is drawn in its place.
#include <functional>

#include "case.h"
#include "vtkContourValues.h"
#include "vtkLight.h"
#include "vtkPlane.h"
#include "vtkRectilinearGrid.h"

using namespace chiaro;
using namespace chiaro::testing;

namespace {

struct Refusal {
    const char* name;
    std::function<void(Case&)> ask;
    const char* told;
};

void PrintTo(const Refusal& r, std::ostream* out) { *out << r.name; }

void give_components(Case& c, int count) {
    vtkNew<vtkUnsignedCharArray> values;
    values->SetNumberOfComponents(count), values->SetNumberOfTuples(48 * 48 * 48), values->Fill(100);
    c.image->GetPointData()->SetScalars(values);
}

class NotDrawn : public ::testing::TestWithParam<Refusal> {};

}  // namespace

TEST_P(NotDrawn, IsToldByNameOnce) {
    Case c;
    GetParam().ask(c);
    EXPECT_EQ(c.seen(c.drawn()), 0);
    c.drawn();
    ASSERT_EQ(c.said.size(), 1u);
    EXPECT_NE(c.said[0].find(GetParam().told), std::string::npos) << c.said[0];
}

INSTANTIATE_TEST_SUITE_P(
    Each, NotDrawn,
    ::testing::Values(
        Refusal{"slice", [](Case& c) { c.mapper->SetBlendModeToSlice(); }, "not drawn: SLICE_BLEND"},
        Refusal{"nearest", [](Case& c) { c.actor->GetProperty()->SetInterpolationTypeToNearest(); },
                "interpolation of nearest voxels"},
        Refusal{"two_dimensional",
                [](Case& c) { c.actor->GetProperty()->SetTransferFunctionMode(vtkVolumeProperty::TF_2D); },
                "TF_2D without an image"},
        Refusal{"five_components", [](Case& c) { give_components(c, 5); }, "more than four components"},
        Refusal{"three_dependent",
                [](Case& c) { give_components(c, 3), c.actor->GetProperty()->IndependentComponentsOff(); },
                "three dependent components"},
        Refusal{"dependent_maxima",
                [](Case& c) {
                    give_components(c, 4), c.actor->GetProperty()->IndependentComponentsOff();
                    c.mapper->SetBlendModeToMaximumIntensity();
                },
                "blend modes of dependent components"},
        Refusal{"isosurfaces_of_several", [](Case& c) { give_components(c, 2), c.mapper->SetBlendModeToIsoSurface(); },
                "ISOSURFACE_BLEND of several components"},
        Refusal{"shading_of_each",
                [](Case& c) {
                    give_components(c, 2), c.actor->GetProperty()->ShadeOn(),
                        c.actor->GetProperty()->SetDiffuse(1, 0.1);
                },
                "shading that is another for each component"},
        Refusal{"fence", [](Case& c) { c.mapper->CroppingOn(), c.mapper->SetCroppingRegionFlagsToFence(); },
                "not one box"},
        Refusal{"planes",
                [](Case& c) {
                    for (int i = 0; i < 7; ++i) {
                        vtkNew<vtkPlane> plane;
                        plane->SetOrigin(i, 0, 0);
                        c.mapper->AddClippingPlane(plane);
                    }
                },
                "more than six clipping planes"},
        Refusal{"range",
                [](Case& c) { c.mapper->SetBlendModeToAverageIntensity(), c.mapper->SetAverageIPScalarRange(50, 200); },
                "AverageIPScalarRange"},
        Refusal{"no_values",
                [](Case& c) {
                    c.mapper->SetBlendModeToIsoSurface(),
                        c.actor->GetProperty()->GetIsoSurfaceValues()->SetNumberOfContours(0);
                },
                "ISOSURFACE_BLEND"},
        Refusal{"rectilinear",
                [](Case& c) {
                    vtkNew<vtkRectilinearGrid> grid;
                    grid->SetDimensions(2, 2, 2);
                    c.mapper->SetInputData(grid.Get());
                },
                "rectilinear grids"},
        Refusal{"no_scalars", [](Case& c) { c.image->GetPointData()->Initialize(); }, "without scalars"}),
    [](const auto& test) { return std::string(test.param.name); });

// What is left out of lights is told, too; the rest is drawn.
TEST(Lights, ArePointsWhereTheyAreSpots) {
    Case c;
    vtkNew<vtkLight> spot;
    spot->SetLightTypeToSceneLight(), spot->PositionalOn(), spot->SetConeAngle(30), spot->SetPosition(90, 50, 60);
    c.renderer->AddLight(spot);
    EXPECT_GT(c.seen(c.drawn()), 1500);
    c.drawn();
    ASSERT_EQ(c.said.size(), 1u);
    EXPECT_NE(c.said[0].find("a spotlight shines in all directions"), std::string::npos);
}

TEST(Lights, AreEightAtMost) {
    Case c;
    for (int i = 0; i < 9; ++i) {
        vtkNew<vtkLight> light;
        light->SetLightTypeToSceneLight();
        light->SetPosition(i, 1, 1), light->SetIntensity(0.2);
        c.renderer->AddLight(light);
    }
    EXPECT_GT(c.seen(c.drawn()), 1500);
    ASSERT_EQ(c.said.size(), 1u);
    EXPECT_NE(c.said[0].find("more than eight lights"), std::string::npos);
}

TEST(Settings, AreChecked) {
    Case c;
    EXPECT_TRUE(c.mapper->SetSetting("albedo-max", "0.95"));
    EXPECT_STREQ(c.mapper->GetSetting("albedo-max"), "0.95");
    EXPECT_TRUE(c.said.empty());
    for (const auto& [name, value, told] : {std::tuple{"albedo-max", "2", "must be 0 to 1"},
                                            {"lighting", "transprot", "did you mean 'transport'"},
                                            {"azimuth", "3", "the renderer's camera"},
                                            {"strenght", "1", "no setting has this name"},
                                            {"size", "3x4", "the renderer's camera"}}) {
        EXPECT_FALSE(c.mapper->SetSetting(name, value));
        ASSERT_FALSE(c.said.empty());
        EXPECT_NE(c.said.back().find(told), std::string::npos) << c.said.back();
    }
    EXPECT_STREQ(c.mapper->GetSetting("albedo-max"), "0.95");
    EXPECT_TRUE(c.mapper->SetSetting("albedo-max", ""));
    EXPECT_STREQ(c.mapper->GetSetting("albedo-max"), "");
}

// A small volume in a window, and the same in a scene of Chiaro's.
#pragma once
#include <chiaro/chiaro.h>
#include <chiaro/session.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <string>
#include <vector>

#include "vtkCallbackCommand.h"
#include "vtkCamera.h"
#include "vtkChiaroVolumeMapper.h"
#include "vtkColorTransferFunction.h"
#include "vtkImageData.h"
#include "vtkNew.h"
#include "vtkPiecewiseFunction.h"
#include "vtkPointData.h"
#include "vtkRenderWindow.h"
#include "vtkRenderer.h"
#include "vtkUnsignedCharArray.h"
#include "vtkVolume.h"
#include "vtkVolumeProperty.h"

namespace chiaro::testing {

/// Rows from the top, RGB.
struct Picture {
    int width = 0, height = 0;
    std::vector<unsigned char> rgb;
    int at(int x, int y, int c) const { return rgb[3 * (std::size_t(y) * width + x) + std::size_t(c)]; }
};

struct Distance {
    int max = 0;
    double mean = 0;
    std::size_t beyond = 0;  ///< values of pixels that differ by more than two
};
inline Distance distance(const Picture& a, const Picture& b) {
    EXPECT_EQ(a.rgb.size(), b.rgb.size());
    Distance d;
    for (std::size_t i = 0; i < a.rgb.size(); ++i) {
        const int off = std::abs(int(a.rgb[i]) - int(b.rgb[i]));
        d.max = std::max(d.max, off), d.mean += off, d.beyond += off > 2;
    }
    d.mean /= double(a.rgb.size());
    return d;
}

/// Keeps what the mapper warns of and refuses.
inline void listen_to(vtkChiaroVolumeMapper& mapper, std::vector<std::string>& said) {
    vtkNew<vtkCallbackCommand> listener;
    listener->SetClientData(&said);
    listener->SetCallback([](vtkObject*, unsigned long, void* to, void* text) {
        static_cast<std::vector<std::string>*>(to)->push_back(static_cast<const char*>(text));
    });
    mapper.AddObserver(vtkCommand::WarningEvent, listener);
    mapper.AddObserver(vtkCommand::ErrorEvent, listener);
}

struct Case {
    static constexpr int width = 150, height = 110;
    static constexpr double background[3] = {0.31, 0.2, 0.4};
    const Volume volume = placed(make_sample("shells", 48));
    const Vec3 eye{150, 95, 80}, target{28, 12, 30};
    vtkNew<vtkImageData> image;
    vtkNew<vtkChiaroVolumeMapper> mapper;
    vtkNew<vtkVolume> actor;
    vtkNew<vtkRenderer> renderer;
    vtkNew<vtkRenderWindow> window;
    std::vector<std::string> said;  ///< warnings and errors of the mapper
    Scene scene;

    static Volume placed(Volume volume) {
        volume.geometry.spacing_mm = {1, 0.9, 1.2};
        volume.geometry.origin_mm = {5, -10, 3};
        return volume;
    }

    Case() {
        const auto& n = volume.dimensions;
        image->SetDimensions(n[0], n[1], n[2]);
        image->SetSpacing(1, 0.9, 1.2), image->SetOrigin(5, -10, 3);
        vtkNew<vtkUnsignedCharArray> scalars;
        scalars->SetNumberOfTuples(vtkIdType(volume.voxel_count()));
        std::memcpy(scalars->GetPointer(0), volume.voxels.data(), volume.voxel_count());
        image->GetPointData()->SetScalars(scalars);
        mapper->SetInputData(image.Get());
        actor->SetMapper(mapper);
        set_look();
        renderer->SetBackground(background[0], background[1], background[2]);
        renderer->AddVolume(actor);
        window->SetOffScreenRendering(1), window->SetMultiSamples(0), window->SetSize(width, height);
        window->AddRenderer(renderer);
        vtkCamera& camera = *renderer->GetActiveCamera();
        camera.SetPosition(eye.x, eye.y, eye.z), camera.SetFocalPoint(target.x, target.y, target.z);
        camera.SetViewUp(0, 0, 1), camera.SetViewAngle(25);
        renderer->ResetCameraClippingRange();
        listen_to(*mapper, said);
        set_scene();
    }

    /// Colours that are straight lines in RGB, so that the scene's points say the same.
    void set_look() {
        vtkNew<vtkColorTransferFunction> colours;
        vtkNew<vtkPiecewiseFunction> opacity;
        for (const ControlPoint& p : points()) {
            colours->AddRGBPoint(p.value, p.rgb[0], p.rgb[1], p.rgb[2]);
            opacity->AddPoint(p.value, p.opacity);
        }
        vtkVolumeProperty& looks = *actor->GetProperty();
        looks.SetColor(colours), looks.SetScalarOpacity(opacity);
        looks.SetInterpolationTypeToLinear(), looks.SetScalarOpacityUnitDistance(1.5);
        looks.SetAmbient(0.25), looks.SetDiffuse(0.65), looks.SetSpecular(0.2), looks.SetSpecularPower(12);
    }
    static std::vector<ControlPoint> points() {
        return {
            {40, {0.2, 0.4, 0.9}, 0}, {90, {0.9, 0.5, 0.1}, 0.08}, {160, {0.3, 0.9, 0.4}, 0.3}, {255, {1, 1, 1}, 0.8}};
    }

    void set_scene() {
        scene.interpolation = Interpolation::linear;
        scene.width = width, scene.height = height;
        scene.camera.eye = eye, scene.camera.target = target, scene.camera.up = Vec3{0, 0, 1},
        scene.camera.fov_deg = 25;
        TransferFunction tf;
        tf.points = points(), tf.opacity_unit = 1.5, tf.opacity_unit_is_mm = true;
        scene.transfer.points = tf;
        scene.lighting.shading = Shading::none;
        scene.lighting.ambient = 0.25, scene.lighting.diffuse = 0.65, scene.lighting.specular = 0.2,
        scene.lighting.shininess = 12;
        scene.output.color = ColorMode::display;
        scene.output.background = {background[0], background[1], background[2]};
    }

    Picture drawn() {
        window->Render();
        const int* size = window->GetSize();
        Picture picture{size[0], size[1], std::vector<unsigned char>(std::size_t(3) * size[0] * size[1])};
        vtkNew<vtkUnsignedCharArray> rows;
        window->GetPixelData(0, 0, size[0] - 1, size[1] - 1, 0, rows);
        const std::size_t row = std::size_t(3) * size[0];
        for (int y = 0; y < size[1]; ++y)
            std::memcpy(&picture.rgb[std::size_t(y) * row],
                        rows->GetPointer(vtkIdType(std::size_t(size[1] - 1 - y) * row)), row);
        return picture;
    }

    /// What Chiaro itself makes of the scene.
    Picture expected(const Volume& shown) const {
        Session session(Device::cpu());
        chiaro::Progress progress;
        session.show(shown, progress);
        const Image& image = session.render(scene, progress);
        return {image.width, image.height, image.pixels};
    }
    Picture expected() const { return expected(volume); }

    /// The picture of the window is Chiaro's, and shows something.
    void expect_same(const char* what, const Volume* other = nullptr) {
        const Picture ours = drawn(), theirs = expected(other ? *other : volume);
        const Distance d = distance(ours, theirs);
        EXPECT_LE(d.max, 2) << what << ": mean " << d.mean << ", beyond " << d.beyond;
        EXPECT_TRUE(said.empty()) << said.front();
        EXPECT_GT(seen(ours), 1500) << what;
    }

    /// Pixels that are not the background.
    int seen(const Picture& p) const {
        int count = 0;
        for (int y = 0; y < p.height; ++y)
            for (int x = 0; x < p.width; ++x)
                for (int c = 0; c < 3; ++c)
                    if (std::abs(p.at(x, y, c) - int(std::lround(255 * background[c]))) > 2) {
                        ++count;
                        break;
                    }
        return count;
    }
};

}  // namespace chiaro::testing

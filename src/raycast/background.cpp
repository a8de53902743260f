#include "raycast/background.h"

#include "core/threads.h"
#include "cuda/device_cache.h"
#include "illumination/probe/data.h"
#include "illumination/probe/light.h"
#include "raycast/launch_background.h"
#include "raycast/views.h"

namespace chiaro {
namespace {

kernel::Vec3<double> components(Vec3 v) { return {v.x, v.y, v.z}; }

/// Without pixels; see CameraView::ray for the directions.
kernel::BackgroundKernel background(const Probe& probe, const Lighting& lighting, const Camera& camera, ColorMode color,
                                    int width, int height) {
    const ProbeImage& image = probe.data().image;
    const Axes axes = transposed(world_from_probe(lighting.probe.rotation_deg, camera.orbit_up));
    Vec3 first = turned(axes, camera.forward), right, down;
    if (camera.projection != Projection::orthographic) {
        right = 2 * half_width(camera, width, height) / width * turned(axes, camera.right);
        down = -2 * camera.half_height / height * turned(axes, camera.up);
        const Vec3 centre = camera.centre_x * turned(axes, camera.right) + camera.centre_y * turned(axes, camera.up);
        first = first + centre - (0.5 * width - 0.5) * right - (0.5 * height - 0.5) * down;
    }
    return {.pixels = nullptr,
            .width = width,
            .image = {image.rgb.data(), image.width, image.height},
            .first = components(first),
            .right = components(right),
            .down = components(down),
            .gain = float(probe_gain(lighting)),
            .linear = color == ColorMode::linear};
}

void put_there(cuda::Pixels& pixels, const Probe& probe, kernel::BackgroundKernel kernel, const Frame& frame) {
    kernel.pixels = pixels.data();
    HostArrays arrays;
    arrays.add(probe.data().weak_from_this(), probe.data().image.rgb);
    cuda::Views(pixels.stream(), std::move(arrays)).to_device_pointers(kernel.image.rgb);
    kernel::put_background(pixels.stream(), kernel, frame.width, frame.height);
    pixels.stream().wait();  // nobody else may hold the probe
}

}  // namespace

bool put_probe_behind(const Device& device, const Lighting& lighting, const Camera& camera, ColorMode color,
                      RenderTarget& target, Progress& progress) {
    Frame& frame = target.frame;
    const Probe probe = lighting_probe(lighting);
    auto kernel = background(probe, lighting, camera, color, frame.width, frame.height);
    const auto on_gpu = [&] { put_there(*target.pixels, probe, kernel, frame); };
    if (target.pixels && cuda::try_gpu(device, on_gpu)) return !progress.cancelled();
    target.bring();
    kernel.pixels = reinterpret_cast<kernel::Rgba*>(frame.rgba.data());
    const auto fill_row = [&](std::int64_t y, std::int64_t) {
        for (int x = 0; x < frame.width; ++x) kernel(x, int(y));
    };
    return parallel_for(device.threads, frame.height, 1, "background", progress, fill_row);
}

}  // namespace chiaro

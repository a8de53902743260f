#include <chiaro/render.h>

#include <limits>

#include "raycast/cast.h"
#include "raycast/depth_kernel.h"
#include "raycast/gpu.h"
#include "raycast/views.h"

namespace chiaro {
namespace {

/// Into pixels: on the GPU, or where it has none of it, here.
template <class Kernel>
bool cast_depth(const Device& device, Kernel kernel, const HostArrays& arrays, Frame& pixels, Progress& progress) {
    bool complete = false;
    const auto there = [&] {
        cuda::Pixels on_gpu(device.stream, pixels.rgba.size() / 4);
        complete = cast_on_gpu(kernel, arrays, pixels.width, pixels.height, on_gpu, progress, "depth").complete;
        if (complete) on_gpu.bring_to(pixels.rgba.data());
    };
    if (cuda::try_gpu(device, there)) return complete;
    arrays.fetch();
    return cast_tiles(device, kernel, nullptr, pixels, "depth", progress).complete;
}

}  // namespace

bool find_depth(const Device& device, const Medium& medium, const Camera& camera, const RaySettings& settings,
                Frame& frame, Progress& progress) {
    const Medium::Data& data = medium.data();
    check_ends(settings, frame);
    RaySettings rays = settings;
    rays.compositing = Compositing::front_to_back;
    rays.early_termination = 0.5;
    const RayTables tables = make_tables(data, rays, device.threads);
    HostArrays arrays;
    data.add_to(arrays);
    tables.add_to(arrays);
    if (settings.ends) arrays.add(settings.ends, settings.ends->mm);
    if (data.shape.mode == Mode::mean || data.shape.mode == Mode::additive) {
        frame.depth_mm.assign(std::size_t(frame.width) * frame.height, std::numeric_limits<float>::infinity());
        return true;
    }
    Frame pixels(frame.width, frame.height);
    const bool complete = with_stored_voxel(data.volume.data(), [&](auto voxel) {
        using Voxel = decltype(voxel);
        const kernel::DepthKernel<Voxel> kernel{make_kernel<Voxel>(
            data, tables, kernel::NoneView(), {.shading = Shading::none}, camera, rays, pixels, false)};
        return cast_depth(device_for(device, data), kernel, arrays, pixels, progress);
    });
    frame.depth_mm.clear();
    if (!complete) return false;
    frame.depth_mm.resize(pixels.rgba.size() / 4);
    for (std::size_t p = 0; p < frame.depth_mm.size(); ++p) frame.depth_mm[p] = pixels.rgba[4 * p];
    return true;
}

}  // namespace chiaro

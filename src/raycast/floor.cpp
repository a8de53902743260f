#include "raycast/floor.h"

#include <chiaro/error.h>

#include "core/threads.h"
#include "raycast/floor_kernel.h"
#include "raycast/views.h"

namespace chiaro {
namespace {

FloorQuestion question_of(const IlluminationField::Data& field) {
    FloorQuestion question;
    if (field.visibility || field.transport)
        question.shadow = FloorShadow::probe;
    else if (field.access || field.histogram)
        question.shadow = FloorShadow::white;
    if (field.is_coarse) question.quality = coarse_floor;
    if (field.transport) question.scattered = &field.transport->nodes();
    return question;
}

}  // namespace

bool put_floor_behind(const Device& device, const Medium::Data& medium, const IlluminationField& field,
                      const Lighting& lighting, const Camera& camera, int lens_rays, RenderTarget& target,
                      Progress& progress) try {
    const IlluminationField::Data& data = field.data();
    const std::shared_ptr<const LitFloor> lit =
        data.floor.light(device, medium, lighting, camera.orbit_up, question_of(data), progress);
    if (!lit) return !progress.cancelled();
    target.bring();
    Frame& frame = target.frame;
    const kernel::FloorKernel kernel{.pixels = reinterpret_cast<kernel::Rgba*>(frame.rgba.data()),
                                     .camera = camera_view(camera, medium.volume.geometry(), frame.width, frame.height),
                                     .floor = lit->view,
                                     .light = lit->light.empty() ? nullptr : lit->light.data(),
                                     .edge = lit->edge,
                                     .albedo = float(lighting.floor.albedo),
                                     .lens_rays = lens_rays,
                                     .linear = medium.shape.color == ColorMode::linear};
    return parallel_for(device.threads, frame.height, 1, "floor", progress, [&](std::int64_t y, std::int64_t) {
        for (int x = 0; x < frame.width; ++x) kernel(x, int(y));
    });
} catch (const Error& error) {
    if (error.code() == ErrorCode::interrupted) return false;
    throw;
}

}  // namespace chiaro

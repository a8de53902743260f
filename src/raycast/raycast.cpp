#include <chiaro/error.h>
#include <chiaro/render.h>

#include <optional>

#include "classify/labels/labelled.h"
#include "classify/mixture.h"
#include "core/ranks.h"
#include "illumination/lit_field.h"
#include "raycast/background.h"
#include "raycast/cast.h"
#include "raycast/floor.h"
#include "raycast/gpu.h"
#include "raycast/shared_values.h"
#include "raycast/texture.h"
#include "raycast/views.h"
#include "volume/level_pages.h"

namespace chiaro {
namespace {

/// Whether light shines where nothing is.
template <class View>
bool emits(const View& view) {
    if constexpr (View::adds_opacity) return view.emits;
    return false;
}

/// One call: what its kernels are made of, and where its pixels go.
struct Caster {
    const Device& device;
    const Medium::Data& medium;
    const LitField& lit;
    const Lighting& lighting;
    const Camera& camera;
    const RaySettings& settings;
    const RayTables& tables;
    const HostArrays& arrays;
    RenderTarget& target;
    Progress& progress;

    template <class View>
    RenderStatistics operator()(View view) const {
        if constexpr (View::adds_opacity) view.step_edges = float(settings.step_voxels);
        const DeviceVolume::Data& volume = medium.volume.data();
        RenderStatistics render_statistics;
        if (volume.pages) return cast_by_bricks(view);
        if (is_for_cpu(medium))
            return with_stored_voxel(volume, [&](auto voxel) { return cast_here(kernel_of(voxel, view)); });
        if (medium.shape.interpolation == Interpolation::texture && !volume.factor &&
            cast_by_texture(view, render_statistics))
            return render_statistics;
        return with_stored_voxel(volume, [&](auto voxel) {
            const auto kernel = kernel_of(voxel, view);
            return cast_there(kernel, render_statistics) ? render_statistics : cast_here(kernel);
        });
    }

private:
    /// By the CPU.
    template <class View>
    RenderStatistics cast_by_bricks(const View& view) const {
        if constexpr (View::adds_opacity)
            throw Error(ErrorCode::internal, "light by local histograms is not read by bricks");
        else
            return cast_here(kernel_of(kernel::Paged(), view));
    }

    /// False where the device has no GPU that does it; nor is there one where the GPU cannot have the texture.
    template <class View>
    bool cast_by_texture(const View& view, RenderStatistics& render_statistics) const {
        auto kernel = kernel_of(kernel::Texel(), view);
        bool found = false;
        const auto find = [&] { found = find_texture(medium.volume.data(), *device.stream, kernel.matter.volume); };
        return cuda::try_gpu(device, find) && found && cast_there(kernel, render_statistics);
    }

    template <class Voxel, class View>
    auto kernel_of(Voxel, const View& view) const {
        auto kernel = make_kernel<Voxel>(medium, tables, view, lighting, camera, settings, target.frame, lit.shows_cuts,
                                         lit.albedo_limit);
        if (lit.main) shine_from(*lit.main, lighting, camera, kernel.matter.shading);
        if constexpr (View::adds_opacity)
            if (view.emits) kernel.matter.occupancy.cells = view.occupancy;
        return kernel;
    }

    /// False where the device has no GPU that does it.
    template <class Kernel>
    bool cast_there(const Kernel& kernel, RenderStatistics& render_statistics) const {
        return cuda::try_gpu(device, [&] {
            const auto [width, height] = std::pair(target.frame.width, target.frame.height);
            const auto pixels = std::make_shared<cuda::Pixels>(device.stream, std::size_t(width) * height);
            render_statistics = cast_on_gpu(kernel, arrays, width, height, *pixels, progress);
            if (render_statistics.complete) target.pixels = pixels;
        });
    }

    template <class Kernel>
    RenderStatistics cast_here(const Kernel& kernel) const {
        arrays.fetch();
        std::optional<BoundingGeometry> geometry;  // a value of the whole ray is looked for everywhere
        const Frame& frame = target.frame;
        if (settings.ray_setup == RaySetup::raster && !medium.volume.data().pages && camera.aperture_mm == 0 &&
            kernel.mode <= kernel::March::surfaces && !emits(kernel.matter.field))
            geometry.emplace(medium, camera_view(camera, medium.volume.geometry(), frame.width, frame.height));
        return cast_tiles(device, kernel, geometry ? &*geometry : nullptr, frame, "raycast", progress);
    }
};

RenderStatistics fill(const Device& device, const Medium& medium, const IlluminationField& field,
                      const Lighting& lighting, const Camera& camera, const RaySettings& settings, RenderTarget& target,
                      Progress& progress);

/// A ray's value of each channel: their colours add up, and each hides as much of what lies behind.
RenderStatistics add_channels(const Device& device, const Medium::Data& mixture, const Lighting& lighting,
                              const Camera& camera, const RaySettings& settings, RenderTarget& target,
                              Progress& progress) {
    Lighting plain = lighting;
    plain.probe.background = false;
    Frame& sum = target.frame;
    std::fill(sum.rgba.begin(), sum.rgba.end(), 0.0f);
    RenderStatistics all;
    const auto& labels = mixture.volume.data().mixture->labels;
    for (const auto& channel : mixture.channels) {
        Frame one(sum.width, sum.height);
        RenderTarget its{one};
        const RenderStatistics found = fill(device, with_labels(device, Medium(channel), labels, progress),
                                            IlluminationField(), plain, camera, settings, its, progress);
        its.bring();
        all.samples += found.samples;
        if (!(all.complete = found.complete)) return all;
        for (std::size_t i = 0; i < sum.rgba.size(); i += 4) {
            for (std::size_t c = 0; c < 3; ++c) sum.rgba[i + c] += one.rgba[i + c];
            sum.rgba[i + 3] = 1 - (1 - sum.rgba[i + 3]) * (1 - one.rgba[i + 3]);
        }
    }
    if (lighting.probe.background)
        all.complete = put_probe_behind(device, lighting, camera, mixture.shape.color, target, progress);
    return all;
}

/// Collective: what each rank finds in its own block, made one picture, which all have.
RenderStatistics cast_together(const Device& device, const Caster& caster, const LitField& lit) {
    RenderStatistics mine;
    collectively(device, [&] {
        if (rays_per_pixel(caster.camera, caster.settings) > 1)
            throw Error(
                ErrorCode::usage,
                "a value of a whole ray that several ranks find is that of one ray a pixel: --samples-per-pixel "
                "1, without a lens");
        const bool adds = caster.medium.shape.mode == Mode::additive;
        mine = adds ? std::visit(caster, lit.view)
                    : cast_values(device, caster.medium, caster.tables, caster.camera, caster.settings,
                                  caster.target.frame, caster.progress);
        for (const int complete : gather_values(device, int(mine.complete))) mine.complete = mine.complete && complete;
        if (mine.complete) join_values(device, caster.medium, caster.tables, caster.target.frame);
    });
    return mine;
}

RenderStatistics fill(const Device& device, const Medium& medium, const IlluminationField& field,
                      const Lighting& lighting, const Camera& camera, const RaySettings& settings, RenderTarget& target,
                      Progress& progress) {
    target.frame.depth_mm.clear();  // of an older picture
    const Medium::Data& data = medium.data();
    check_ends(settings, target.frame);
    if (data.volume.data().placement && (lighting.floor.show || lighting.probe.background))
        throw Error(ErrorCode::usage, "a block of a volume is drawn without floor and background");
    if (is_mixed(data) && !is_labelled_channel(data) && march_of(data.shape.mode) != kernel::March::volume)
        return add_channels(device, data, lighting, camera, settings, target, progress);
    const IlluminationField& shown = is_lit(data.shape.mode) ? field : IlluminationField();
    LitField lit = lit_field(shown, lighting, camera, data.lit_as ? *data.lit_as : data);
    if (const auto& pages = data.volume.data().pages) read_from(lit, *pages);
    const RayTables tables = make_tables(data, settings, device.threads, &lit);
    HostArrays arrays = lit.arrays;
    data.add_to(arrays);
    tables.add_to(arrays);
    if (settings.ends) arrays.add(settings.ends, settings.ends->mm);
    const Caster cast{device, data, lit, lighting, camera, settings, tables, arrays, target, progress};
    RenderStatistics render_statistics =
        shares_values(data) ? cast_together(device, cast, lit) : std::visit(cast, lit.view);
    if (lighting.floor.show && is_lit(data.shape.mode) && render_statistics.complete)
        render_statistics.complete =
            put_floor_behind(device, data, field, lighting, camera, rays_per_pixel(camera, settings), target, progress);
    if (lighting.probe.background && render_statistics.complete)
        render_statistics.complete = put_probe_behind(device, lighting, camera, data.shape.color, target, progress);
    return render_statistics;
}

}  // namespace

RenderStatistics raycast(const Device& device, const Medium& medium, const IlluminationField& field,
                         const Lighting& lighting, const Camera& camera, const RaySettings& settings, Frame& frame,
                         Progress& progress) {
    RenderTarget target{frame};
    const RenderStatistics render_statistics =
        fill(device, medium, field, lighting, camera, settings, target, progress);
    target.bring();
    return render_statistics;
}

RenderStatistics raycast(const Device& device, const Medium& medium, const IlluminationField& field,
                         const Lighting& lighting, const Camera& camera, const RaySettings& settings,
                         DeviceFrame& frame, Progress& progress) {
    RenderTarget target{frame.write()};
    const RenderStatistics render_statistics =
        fill(device, medium, field, lighting, camera, settings, target, progress);
    frame.keep_on_gpu(std::move(target.pixels));
    return render_statistics;
}

}  // namespace chiaro

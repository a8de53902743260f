#include <chiaro/pick.h>

#include <algorithm>
#include <cmath>

#include "core/srgb.h"
#include "core/threads.h"
#include "illumination/none/field.h"
#include "raycast/views.h"

namespace chiaro {
namespace {

/// The sample with the largest weight so far, and what the ray lets through behind all of them.
struct Witness {
    float weight = 0, transmittance = 1, value = 0;
    kernel::Vec3<float> p{0, 0, 0};
    kernel::Rgba colour{0, 0, 0, 0};

    void see(kernel::Vec3<float> at, float stored, kernel::Rgba seen) {
        const float here = transmittance * seen.a;
        if (here > weight) weight = here, value = stored, p = at, colour = seen;
        transmittance -= here;
    }
};

/// Matter that remembers what is about to be lit: the marches themselves are the ray caster's.
template <class Voxel>
struct WitnessedMatter : kernel::Matter<Voxel, kernel::NoneView> {
    Witness* witness;

    template <class F>
    void light(const kernel::Location<F>&, const kernel::Cut<F>&, bool,
               const typename kernel::Matter<Voxel, kernel::NoneView>::template Place<F>&, kernel::MetSurface<F>&,
               kernel::SamplePoint<F> sample, kernel::RgbaLanes<F>& colour) const {
        witness->see(sample.p_voxel, sample.value, colour);
    }
};

/// The first of the largest or smallest values of a ray's samples.
template <class Matter>
void find_extreme(const Matter& matter, float sign, const kernel::Lattice<float>& lattice, Witness& witness) {
    float best = -3e38f;
    for (float k = 0; k < lattice.end; ++k) {
        const auto p = matter.volume.clamp(lattice.position(k));
        const float value = sign * matter.value_at(p);
        if (value > best) best = value, witness.p = p;
    }
    if (lattice.end > 0) witness.see(witness.p, sign * best, matter.table.at(sign * best));
}

/// One ray of a kernel, in front to back order.
template <class Kernel>
Witness cast(const Kernel& kernel, float column, float row) {
    using Voxel = std::remove_cv_t<std::remove_pointer_t<decltype(kernel.matter.volume.voxels)>>;
    Witness witness;
    const WitnessedMatter<Voxel> matter{kernel.matter, &witness};
    const auto ray = kernel.camera.ray(column, row);
    auto hit = kernel::intersect(ray, kernel.box_low, kernel.box_high);
    const auto cut = kernel::clip(kernel.clip_view, ray, hit);
    auto lattice = kernel::make_lattice(ray, hit, kernel.step_mm);
    const bool alive = lattice.end > 0;
    kernel::Composite<float> composite;
    if (kernel.mode == kernel::March::surfaces)
        kernel::march_to_surfaces(matter, kernel.surfaces, lattice, cut, alive, composite);
    else if (kernel.mode == kernel::March::extreme)
        find_extreme(matter, kernel.extreme.sign, lattice, witness);
    else if (kernel.mode == kernel::March::volume && !kernel.way.additive)
        kernel::march_apart(matter, kernel.way, lattice, cut, alive, composite);
    return witness;
}

double opacity_of(const Medium::Data& medium, float stored) {
    const OpticalTable& table = medium.table;
    return -std::expm1(-double(table.at(stored).extinction_per_mm) * table.unit_mm);
}

/// Of a mixture: the value of the channel that stops most light there, and the opacity of all.
void tell_channels(const Medium::Data& medium, const kernel::Vec3<float>& p, Pick& pick) {
    float most = -1, sum = 0;
    for (const auto& channel : medium.channels) {
        const DeviceVolume::Data& volume = channel->volume.data();
        const float stored = with_stored_voxel(volume, [&](auto voxel) {
            const auto view = view_of<decltype(voxel)>(volume);
            return view.value(view.locate(p, view.voxel(p)));
        });
        const float kappa = channel->table.at(double(stored)).extinction_per_mm;
        sum += kappa;
        if (kappa > most) most = kappa, pick.value = volume.scale * double(stored) + volume.offset;
    }
    pick.opacity = -std::expm1(-double(sum) * medium.table.unit_mm);
}

Pick told(const Witness& witness, const Medium::Data& medium, const Camera& camera) {
    const DeviceVolume::Data& volume = medium.volume.data();
    Pick pick;
    pick.value = volume.scale * witness.value + volume.offset;
    pick.p_voxel = {witness.p.x, witness.p.y, witness.p.z};
    pick.world_mm = volume.geometry.world_from_voxel(pick.p_voxel);
    const Vec3 from_eye = pick.world_mm - camera.eye;
    pick.depth_mm = camera.projection == Projection::orthographic ? dot(from_eye, camera.forward) : length(from_eye);
    const kernel::Rgba& c = witness.colour;
    pick.opacity = medium.shape.mode == Mode::iso ? double(c.a) : opacity_of(medium, witness.value);
    if (is_mixed(medium)) tell_channels(medium, witness.p, pick);
    const double straight[] = {double(c.r) / c.a, double(c.g) / c.a, double(c.b) / c.a};
    for (std::size_t i = 0; i < 3; ++i) {
        const double channel = std::clamp(straight[i], 0.0, 1.0);
        pick.rgb[i] = medium.shape.color == ColorMode::linear ? srgb_from_linear(channel) : channel;
    }
    pick.weight = witness.weight;
    pick.covered = 1 - witness.transmittance;
    return pick;
}

}  // namespace

std::vector<std::optional<Pick>> pick(const Medium& medium, const Camera& camera, const RaySettings& settings,
                                      int width, int height, std::span<const std::array<double, 2>> places) {
    const Medium::Data& data = medium.data();
    const int threads = data.volume.data().device.threads;
    RaySettings forwards = settings;
    forwards.compositing = Compositing::front_to_back;
    const RayTables tables = make_tables(data, forwards, threads);
    Frame no_pixels;
    no_pixels.width = width, no_pixels.height = height;
    std::vector<std::optional<Pick>> picks(places.size());
    with_stored_voxel(data.volume.data(), [&](auto voxel) {
        const auto kernel = make_kernel<decltype(voxel)>(data, tables, kernel::NoneView{}, Lighting{}, camera, forwards,
                                                         no_pixels, false);
        parallel_for(threads, std::int64_t(places.size()), 16, [&](std::int64_t first, std::int64_t end) {
            for (auto i = first; i < end; ++i) {
                const Witness witness = cast(kernel, float(places[i][0] - 0.5), float(places[i][1] - 0.5));
                if (witness.weight > 0) picks[i] = told(witness, data, camera);
            }
        });
    });
    return picks;
}

std::optional<Pick> pick(const Medium& medium, const Camera& camera, const RaySettings& settings, int width, int height,
                         double x, double y) {
    const std::array<double, 2> place{x, y};
    return pick(medium, camera, settings, width, height, std::span(&place, 1)).front();
}

}  // namespace chiaro

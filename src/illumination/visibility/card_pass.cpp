#include "illumination/visibility/card_pass.h"

#include "illumination/visibility/launch_card.h"

namespace chiaro {
namespace {

template <class T>
cuda::Array<T> copied(cuda::Stream& stream, const std::vector<T>& from) {
    cuda::Array<T> array(stream, from.size());
    stream.upload(array.data(), from.data(), from.size() * sizeof(T));
    return array;
}

/// A plane as it is on the host, copied to be written.
struct CardPlane {
    cuda::Array<float> density, light;
    cuda::Array<std::uint8_t> state;

    CardPlane(cuda::Stream& stream, const SweepPlanes::Plane& from)
        : density(copied(stream, from.density)), light(copied(stream, from.light)), state(copied(stream, from.state)) {}
};

}  // namespace

SweepPlanes::SweepPlanes(int nu, int nv, int directions) : row_(nu + 2), directions_(directions) {
    const std::size_t nodes = std::size_t(row_) * std::size_t(nv + 2);
    for (Plane& plane : planes_) {
        plane.density.assign(nodes, 0);
        plane.light.assign(nodes * std::size_t(directions), 1);
        plane.state.assign(nodes, kernel::clear | kernel::empty);
    }
}

kernel::SweepPlanes SweepPlanes::view(int k) {
    Plane &last = before(k), &next = here(k);
    return {last.density.data(),
            next.density.data(),
            last.light.data(),
            next.light.data(),
            last.state.data(),
            next.state.data(),
            row_,
            directions_};
}

void grid_pass_on_card(const CardField& field, const SweepPass& pass, const SweepAxes& axes,
                       std::span<const SweepDirection> batch, const std::function<void(double)>& tell) {
    cuda::Stream& stream = field.stream();
    const auto& n = pass.density.grid.count;
    const int nu = n[axes.u], nv = n[axes.v], steps = n[axes.major];
    const SweepPacks packs(batch, nu + 2, pass.start);
    const BatchHarmonics harmonics(pass.directions, batch, pass.field.coefficients);
    SweepPlanes planes(nu, nv, packs.lanes());
    std::vector<kernel::SweepPack> on_card(packs.data(), packs.data() + packs.lanes() / kernel::SweepPack::width);
    const cuda::Settled settled{stream};
    const CardPlane first(stream, planes.here(0)), second(stream, planes.here(1));
    const cuda::Array<float> scratch(stream, std::size_t(nu) * nv * packs.lanes());

    HostArrays arrays;
    packs.add_to(arrays);
    harmonics.add_to(arrays);
    cuda::Views views(stream, std::move(arrays));
    kernel::Harmonics of_batch = harmonics.view();
    views.swap(of_batch.of_direction, of_batch.sum);
    for (kernel::SweepPack& pack : on_card) views.swap(pack.weights, pack.before, pack.outer, pack.inner);
    const cuda::Array<kernel::SweepPack> its_packs = copied(stream, on_card);

    const auto node_stride = [&](int axis) { return std::int64_t(pass.stride(axis)); };
    for (int k = 0; k < steps; ++k) {
        const CardPlane &before = k & 1 ? first : second, &here = k & 1 ? second : first;
        const std::int64_t plane = (axes.sign > 0 ? steps - 1 - k : k) * node_stride(axes.major);
        const kernel::SweepPlanes view{before.density.data(), here.density.data(), before.light.data(),
                                       here.light.data(),     before.state.data(), here.state.data(),
                                       planes.row(),          packs.lanes()};
        kernel::sweep_plane(stream, {its_packs.data(), of_batch, view},
                            {nu, nv, node_stride(axes.u), node_stride(axes.v), field.density() + plane,
                             field.data() + plane * pass.field.coefficients, scratch.data()});
    }
    stream.wait();  // for what was copied from here
    tell(1);
}

/// All points of a plane at once: what arrives and what goes on are found from the plane before.
void sheared_pass_on_card(const CardField& field, const SweepPass& pass, const SweepAxes& axes,
                          std::span<const SweepDirection> batch, const std::function<void(double)>& tell) {
    cuda::Stream& stream = field.stream();
    const auto& n = pass.density.grid.count;
    const int nu = n[axes.u], nv = n[axes.v], steps = n[axes.major], directions = int(batch.size());
    const BatchHarmonics harmonics(pass.directions, batch, pass.field.coefficients);
    const ShearedPlanes planes(nu, nv, directions);
    const std::vector<kernel::ShearedDirection> rays = sheared_rays(batch, steps, planes.row(), pass.start);
    const cuda::Settled settled{stream};
    const auto density = copied(stream, planes.densities()), even = copied(stream, planes.light()),
               odd = copied(stream, planes.light());
    const auto its_rays = copied(stream, rays);
    const cuda::Array<float> seen(stream, std::size_t(nu) * nv * batch.size());
    HostArrays arrays;
    harmonics.add_to(arrays);
    cuda::Views views(stream, std::move(arrays));
    kernel::Harmonics of_batch = harmonics.view();
    views.swap(of_batch.of_direction, of_batch.sum);
    const auto node_stride = [&](int axis) { return std::int64_t(pass.stride(axis)); };
    for (int k = 0; k < steps; ++k) {
        const std::int64_t plane = (axes.sign > 0 ? steps - 1 - k : k) * node_stride(axes.major);
        const kernel::ShearedKernel kernel{its_rays.data() + std::ptrdiff_t(k) * directions, of_batch,
                                           planes.view(k, density.data(), even.data(), odd.data())};
        kernel::sweep_sheared_plane(stream, kernel,
                                    {nu, nv, node_stride(axes.u), node_stride(axes.v), field.density() + plane,
                                     field.data() + plane * pass.field.coefficients, seen.data()},
                                    density.data() + planes.density_row() + 1);
    }
    stream.wait();  // for what was copied from here
    tell(1);
}

}  // namespace chiaro

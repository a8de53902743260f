#include "illumination/visibility/card.h"

#include <utility>

#include "illumination/cells/card.h"
#include "illumination/visibility/launch_card.h"

namespace chiaro {
namespace {

/// A plane as it is on the host, copied to be written.
struct CardPlane {
    cuda::Array<float> density, light;
    cuda::Array<std::uint8_t> state;

    CardPlane(cuda::Stream& stream, const SweepPlanes::Plane& from)
        : density(copied(stream, from.density)), light(copied(stream, from.light)), state(copied(stream, from.state)) {}

    template <class T>
    static cuda::Array<T> copied(cuda::Stream& stream, const std::vector<T>& from) {
        cuda::Array<T> array(stream, from.size());
        stream.upload(array.data(), from.data(), from.size() * sizeof(T));
        return array;
    }
};

}  // namespace

void assemble_on_card(const Device& device, const BlockMap& blocks, int halvings, const BlockDepths& depths,
                      Density& out, Progress& progress) {
    cuda::Stream& stream = *device.stream;
    const std::size_t together = std::clamp<std::size_t>(blocks.held().size(), 1, blocks_together);
    const cuda::Array<float> tiles(stream, together * tile_size), halves(stream, halvings ? tiles.size() / 8 : 1);
    cuda::Array<float> made(stream, out.grid.size());
    made.zero();
    const FillBlocks fill = depths.on_card(stream);
    const auto [nx, ny, nz] = out.grid.count;
    for_blocks(stream, blocks, "density", progress, [&](const kernel::BlockPlace* places, std::int64_t count) {
        fill(places, count, tiles.data());
        float *from = tiles.data(), *to = halves.data();
        for (int i = 0; i < halvings; ++i, std::swap(from, to))
            kernel::run_on_card(stream, count * (tile_size >> 3 * (i + 1)),
                                kernel::HalveTiles{from, to, block_edge >> i});
        kernel::run_on_card(stream, count * (tile_size >> 3 * halvings),
                            kernel::KeepTiles{from, block_edge >> halvings, places, {nx, ny, nz}, made.data()});
    });
    out.buffer.keep(device.stream, made.data());
}

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

CardSweep::CardSweep(const Device& device, const Density& density, int coefficients)
    : stream_(device.stream),
      grid_(density.grid),
      coefficients_(coefficients),
      density_(density.on_card(*stream_)),
      field_(*stream_, density.grid.size() * std::size_t(coefficients)) {
    field_.zero();
}

void CardSweep::pass(const SweepPass& pass, const SweepAxes& axes, std::span<const SweepDirection> batch,
                     const std::function<void(double)>& tell) {
    const auto& n = pass.density.grid.count;
    const int nu = n[axes.u], nv = n[axes.v], steps = n[axes.major];
    const SweepPacks packs(batch, nu + 2, pass.start);
    const BatchHarmonics harmonics(pass.directions, batch, pass.field.coefficients);
    SweepPlanes planes(nu, nv, packs.lanes());
    std::vector<kernel::SweepPack> on_card(packs.data(), packs.data() + packs.lanes() / kernel::SweepPack::width);
    const cuda::Settled settled{*stream_};
    const CardPlane first(*stream_, planes.here(0)), second(*stream_, planes.here(1));
    const cuda::Array<float> scratch(*stream_, std::size_t(nu) * nv * packs.lanes());

    HostArrays arrays;
    packs.add_to(arrays);
    harmonics.add_to(arrays);
    cuda::Views views(*stream_, std::move(arrays));
    kernel::Harmonics of_batch = harmonics.view();
    views.swap(of_batch.of_direction, of_batch.sum);
    for (kernel::SweepPack& pack : on_card) views.swap(pack.weights, pack.before, pack.outer, pack.inner);
    const cuda::Array<kernel::SweepPack> its_packs = CardPlane::copied(*stream_, on_card);

    const auto node_stride = [&](int axis) { return std::int64_t(pass.stride(axis)); };
    for (int k = 0; k < steps; ++k) {
        const CardPlane &before = k & 1 ? first : second, &here = k & 1 ? second : first;
        const std::int64_t plane = (axes.sign > 0 ? steps - 1 - k : k) * node_stride(axes.major);
        const kernel::SweepPlanes view{before.density.data(), here.density.data(), before.light.data(),
                                       here.light.data(),     before.state.data(), here.state.data(),
                                       planes.row(),          packs.lanes()};
        kernel::sweep_plane(*stream_, {its_packs.data(), of_batch, view},
                            {nu, nv, node_stride(axes.u), node_stride(axes.v), density_ + plane,
                             field_.data() + plane * pass.field.coefficients, scratch.data()});
    }
    stream_->wait();  // for what was copied from here
    tell(1);
}

void CardSweep::fetch(ShField& field) {
    stream_->download(field.buffer.data(), field_.data(), field_.size() * sizeof(float));
    stream_->wait();
}

VisibilityNodes CardSweep::keep(const VisibilitySettings& settings) {
    VisibilityNodes nodes = make_nodes(grid_, coefficients_, settings);
    const bool lifted = nodes.surfaces.size() > 0;
    const cuda::Array<std::byte> harmonics(*stream_, nodes.harmonics.size());
    const cuda::Array<kernel::NodeSurface> surfaces(*stream_, lifted ? grid_.size() : 1);
    const cuda::Array<float> opacity(*stream_, lifted ? grid_.size() : 1);
    if (lifted) kernel::find_opacities(*stream_, {density_, opacity.data()}, std::int64_t(grid_.size()));
    kernel::KeepKernel keep = keep_kernel(nodes, field_.data(), lifted ? opacity.data() : nullptr);
    keep.harmonics = harmonics.data(), keep.surfaces = surfaces.data();
    kernel::keep_all_nodes(*stream_, keep);
    stream_->download(nodes.harmonics.data(), harmonics.data(), nodes.harmonics.size());
    if (lifted) stream_->download(nodes.surfaces.data(), surfaces.data(), nodes.surfaces.size());
    stream_->wait();
    return nodes;
}

void light_on_card(const Device& device, const kernel::LightKernel& kernel, const HostArrays& arrays,
                   std::size_t nodes) {
    cuda::Stream& stream = *device.stream;
    cuda::Views views(stream, arrays);
    const cuda::Array<kernel::Light16> light(stream, 4 * nodes);
    kernel::LightKernel on_card = kernel;
    views.swap(on_card.harmonics.nodes, on_card.surfaces, on_card.surface.entries);
    on_card.light = light.data();
    kernel::light_all_nodes(stream, on_card, std::int64_t(nodes));
    stream.download(kernel.light, light.data(), light.size() * sizeof(kernel::Light16));
    stream.wait();
}

}  // namespace chiaro

#include "illumination/transport/transport.h"

#include "classify/medium.h"
#include "illumination/transport/coarse_to_fine.h"

namespace chiaro {
namespace {

constexpr int first_iterations = 4;  ///< before a field is shown
constexpr int coarsest = 16;         ///< cells; what is as coarse as this comes at once

/// What is found, left behind even where finding more is interrupted.
class Found {
public:
    explicit Found(TransportMemory* memory) : memory_(memory) {}
    ~Found() {
        if (memory_ && now.fine && now.fine->iterations() > 0) *memory_ = std::move(now);
    }
    Found(const Found&) = delete;
    Found& operator=(const Found&) = delete;

    TransportMemory now;

private:
    TransportMemory* memory_;
};

/// Light from before, on this volume; `half` is empty where there was no coarse grid.
std::optional<LightBefore> light_before(const TransportMemory* memory, const Medium::Data& medium,
                                        SurfaceModel surfaces) {
    if (!memory || !memory->fine || memory->volume.lock().get() != &medium.volume.data()) return {};
    return LightBefore{memory->fine->nodes(surfaces), memory->half ? memory->half->nodes(surfaces) : TransportNodes{}};
}

}  // namespace

bool TransportMemory::is_of(const Medium::Data& other, const TransportSettings& settings, const ScatteringSettings& how,
                            SurfaceModel shown) const {
    return surfaces == shown && fine && medium.lock().get() == &other && grid == settings.grid && scattering == how;
}

void refine_transport(const Device& device, const Medium::Data& medium, const Lighting& lighting,
                      const TransportSettings& settings, const ScatteringSettings& scattering, SurfaceModel surfaces,
                      Vec3 orbit_up, const std::function<void(TransportNodes, bool is_coarse)>& keep, StageTimer& timer,
                      Progress& progress, TransportMemory* memory) {
    const bool is_known = memory && memory->is_of(medium, settings, scattering, surfaces);
    const std::optional<LightBefore> before = light_before(memory, medium, surfaces);
    Found found(memory);
    found.now = {{},         {},      medium.weak_from_this(), medium.volume.data().weak_from_this(), settings.grid,
                 scattering, surfaces};
    const auto start = [&](const SharedTransportMedium& matter, const TransportNodes* warm) {
        return timer("light", [&] {
            return std::make_shared<TransportSolver>(device, matter, lighting, settings, scattering, orbit_up, progress,
                                                     warm);
        });
    };
    const auto iterate = [&](TransportSolver& solver, int most) {
        return timer("scattering", [&] {
            int done = 0;
            while (done < most && solver.iterate(progress)) ++done;
            return done;
        });
    };
    const auto see = [&](const TransportMedium& matter, const std::shared_ptr<const TransportSolver>& last) {
        if (surfaces != SurfaceModel::none) matter.seen(device, timer, progress, last ? last->matter().get() : nullptr);
    };
    const auto light_of = [&](const TransportSolver& solver) {
        TransportNodes nodes = solver.nodes(surfaces);
        if (surfaces != SurfaceModel::none) nodes.seen = solver.matter()->seen(device, timer, progress);
        return nodes;
    };
    const TransportMemory last = before ? *memory : TransportMemory{};
    const SharedTransportMedium matter = is_known ? memory->fine->matter() : timer("light grid", [&] {
        return matter_of(device, medium, settings.grid, scattering, progress, surfaces);
    });
    std::optional<TransportNodes> first;
    if (settings.grid > coarsest) {
        const auto half = start(is_known && memory->half ? memory->half->matter() : halved(matter, device, progress),
                                before ? &before->fine : nullptr);
        iterate(*half, first_iterations);
        see(*half->matter(), last.half);
        first = light_of(*half);
        if (before && has_detail_for(*before, matter->grid.extinction.grid, first->grid))
            first = with_detail(*matter, *first, *before, device);
        keep(*first, true);
        found.now.half = half;
    }
    see(*matter, last.fine);  // before the solver takes its memory
    const auto fine = start(matter, first ? &*first : before ? &before->fine : nullptr);
    iterate(*fine, first_iterations);
    found.now.fine = fine;
    while (!fine->is_done()) {
        keep(light_of(*fine), true);
        iterate(*fine, 1);
    }
    keep(light_of(*fine), false);
}

}  // namespace chiaro

#include "illumination/transport/transport.h"

namespace chiaro {
namespace {

constexpr int first_iterations = 4;  ///< before a field is shown
constexpr int coarsest = 16;         ///< cells; what is as coarse as this comes at once

}  // namespace

void refine_transport(const Device& device, const Medium::Data& medium, const Lighting& lighting,
                      const TransportSettings& settings, const ScatteringSettings& scattering, Vec3 orbit_up,
                      const std::function<void(TransportNodes, bool is_coarse)>& keep, Steps& steps, Progress& progress,
                      TransportMemory* memory) {
    std::shared_ptr<TransportSolver> solver;
    const auto start = [&](int grid, const TransportSolver* warm) {
        TransportSettings on_grid = settings;
        on_grid.grid = grid;
        solver = steps("light", [&] {
            return std::make_shared<TransportSolver>(device, medium, lighting, on_grid, scattering, orbit_up, progress,
                                                     warm);
        });
    };
    const auto iterate = [&](int most) {
        return steps("scattering", [&] {
            int done = 0;
            while (done < most && solver->iterate(progress)) ++done;
            return done;
        });
    };
    const TransportMemory before = memory ? *memory : nullptr;
    if (settings.grid > coarsest) {
        start(settings.grid / 2, before.get());
        iterate(first_iterations);
        keep(solver->nodes(), true);
    }
    const std::shared_ptr<TransportSolver> coarse = std::move(solver);
    start(settings.grid, before ? before.get() : coarse.get());
    iterate(first_iterations);
    // The next is begun before this one is handed over, so that the last is known to be the last.
    for (TransportNodes nodes = solver->nodes();; nodes = solver->nodes()) {
        const bool more = iterate(1) > 0;
        keep(std::move(nodes), more);
        if (!more) break;
    }
    if (memory) *memory = std::move(solver);
}

}  // namespace chiaro

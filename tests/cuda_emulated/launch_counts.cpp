// How much of a GPU its work can keep busy, counted where there is none to measure it (docs/gpu.md: the census). The
// bounds are what was counted, and a little more: a launch or a wait that comes back is noticed.
#include <cstring>

#include "cuda_case.h"
#include "illumination/sh/directions.h"
#include "illumination/spao/spao.h"
#include "illumination/transport/solver.h"
#include "illumination/visibility/sweep.h"
#include "illumination/visibility/visibility.h"

using namespace chiaro;
using namespace chiaro::testing;

namespace {

using cuda_emulated::GpuCounts;

GpuCounts counts_of(const std::function<void()>& work) {
    const GpuCounts before = cuda_emulated::gpu();
    work();
    return cuda_emulated::gpu().since(before);
}

/// `bytes`: in both directions.
struct Bounds {
    std::size_t launches, threads_each, waits, uploads, bytes;
};

void expect_within(const GpuCounts& found, const Bounds& bounds, const std::string& what) {
    const std::size_t each = found.threads / found.launches, bytes = found.uploaded_bytes + found.downloaded_bytes;
    SCOPED_TRACE(fmt::format("{}: {} launches of {} threads, {} waits, {} uploads, {} bytes", what, found.launches,
                             each, found.waits, found.uploads, bytes));
    EXPECT_LE(found.launches, bounds.launches);
    EXPECT_GE(each, bounds.threads_each);
    EXPECT_LE(found.waits, bounds.waits);
    EXPECT_LE(found.uploads, bounds.uploads);
    EXPECT_LE(bytes, bounds.bytes);
}

Volume cube(int n) {
    return sampled<std::uint8_t>({n, n, n}, [&](double x, double y, double z) { return shells(x, y, z, n); });
}

void expect_equal(const ShField& found, const ShField& expected) {
    ASSERT_EQ(found.buffer.size(), expected.buffer.size());
    EXPECT_EQ(std::memcmp(found.buffer.data(), expected.buffer.data(), found.buffer.size()), 0);
}

}  // namespace

TEST_F(Gpus, AreKeptBusyByVisibility) {
    constexpr int n = 24;
    Progress progress;
    const Medium medium = classify(upload(gpu, cube(n)), two_materials(), {});
    const Density density = density_for(medium.data(), 1, gpu, progress);
    density.on_gpu(*gpu.stream);
    const auto swept = [&](SweepLattice lattice) {
        return counts_of([&] { sweep_on_gpu(gpu, density, fibonacci_directions(400), 16, 0.5, lattice, progress); });
    };
    expect_within(swept(SweepLattice::grid), {50, 170000, 1, 25, 53000}, "grid");
    expect_within(swept(SweepLattice::sheared), {52, 150000, 1, 19, 220000}, "sheared");
}

TEST_F(Gpus, SweepFewerDirectionsSideBySideWhereRoomIsLittle) {
    Progress progress;
    const Medium medium = classify(upload(gpu, cube(24)), two_materials(), {});
    const Density density = density_for(medium.data(), 1, gpu, progress);
    density.on_gpu(*gpu.stream);
    for (const SweepLattice lattice : {SweepLattice::grid, SweepLattice::sheared}) {
        const auto swept = [&](const Device& device) {
            return sweep_visibility(device, density, fibonacci_directions(520), 4, 0.5, lattice, progress);
        };
        const ShField expected = swept(cpu());
        const auto kept = [&](const Device& device) {  // added up in steps
            const VisibilitySettings settings{
                .bands = 2,
                .directions = 520,
                .traversal = lattice == SweepLattice::grid ? VisibilityTraversal::sweep : VisibilityTraversal::sheared};
            StageTimer timer;
            const auto lent = std::shared_ptr<const Density>(std::shared_ptr<const Density>(), &density);
            const VisibilityNodes nodes = visibility_nodes(device, lent, settings, timer, progress);
            return std::vector(nodes.harmonics.data(), nodes.harmonics.data() + nodes.harmonics.size());
        };
        const std::vector<std::byte> expected_bytes = kept(cpu());
        std::size_t most = 0, least = 1000;
        for (const std::size_t mib : {2, 5, 100}) {
            cuda_emulated::gpu().memory_bytes = cuda_emulated::gpu().held_bytes + (mib << 20);
            const GpuCounts found = counts_of([&] { expect_equal(swept(gpu), expected); });
            EXPECT_TRUE(kept(gpu) == expected_bytes) << mib;
            most = std::max(most, found.launches), least = std::min(least, found.launches);
            cuda_emulated::gpu().memory_bytes = std::size_t(4) << 30;
        }
        EXPECT_LT(least, 60u);
        EXPECT_GT(most, 6 * 48u);
    }
}

TEST_F(Gpus, EndASweepThatIsCancelledBetweenItsPlanes) {
    const Volume column = sampled<std::uint8_t>({5, 6, 150}, [](double, double, double z) { return z; });
    Progress progress;
    const Medium medium = classify(upload(gpu, column), two_materials(), {});
    const Density density = density_for(medium.data(), 1, gpu, progress);
    for (const SweepLattice lattice : {SweepLattice::grid, SweepLattice::sheared}) {
        int reports = 0;
        const auto swept = [&](Progress& watched) {
            sweep_on_gpu(gpu, density, fibonacci_directions(60), 4, 0.5, lattice, watched);
        };
        Progress cancelling([&](std::string_view, double share) {
            EXPECT_LT(share, 0.5);
            if (++reports == 1) cancelling.cancel();
        });
        const GpuCounts all = counts_of([&] { swept(progress); });
        const GpuCounts some = counts_of([&] { EXPECT_THROW(swept(cancelling), Error); });
        EXPECT_LT(some.launches, all.launches / 2);
        EXPECT_EQ(reports, 1);
    }
}

TEST_F(Gpus, AreKeptBusyByTransport) {
    Progress progress;
    const Medium medium = classify(upload(gpu, cube(24)), two_materials(), {});
    const SharedTransportMedium matter = matter_of(gpu, medium.data(), 24, {}, progress);
    std::optional<TransportSolver> solver;
    const GpuCounts first = counts_of([&] {
        solver.emplace(gpu, matter, Lighting(), TransportSettings{.grid = 24}, ScatteringSettings(), Vec3{0, 0, 1},
                       progress);
    });
    expect_within(first, {30, 17000, 3, 63, 139000}, "first");
    expect_within(counts_of([&] { solver->iterate(progress); }), {28, 9000, 1, 25, 18500}, "iteration");
}

TEST_F(Gpus, TransportFewerDirectionsAtOnceWhereRoomIsLittle) {
    Progress progress;
    const Medium medium = classify(upload(gpu, cube(24)), two_materials(), {});
    const SharedTransportMedium matter = matter_of(gpu, medium.data(), 24, {}, progress);
    const auto light = [&](const Device& device) {
        TransportSolver solver(device, matter, {}, {.grid = 24, .first_directions = 600}, {}, {0, 0, 1}, progress);
        return solver.nodes().moment;
    };
    const auto expected = light(cpu());
    std::size_t most = 0, least = 1000;
    for (const std::size_t mib : {8, 9, 10, 12, 100}) {
        cuda_emulated::gpu().memory_bytes = cuda_emulated::gpu().held_bytes + (mib << 20);
        const GpuCounts found = counts_of([&] { EXPECT_EQ(light(gpu), expected) << mib; });
        most = std::max(most, found.launches), least = std::min(least, found.launches);
        cuda_emulated::gpu().memory_bytes = std::size_t(4) << 30;
    }
    EXPECT_LT(least, 24 + 16u);
    EXPECT_GT(most, 3 * 24u);
}

TEST_F(Gpus, AreKeptBusyBySpao) {
    Progress progress;
    StageTimer timer;
    const Medium medium = classify(upload(gpu, cube(64)), two_materials(), {});
    const CellOpacity opacity = cell_opacity(medium.data(), progress);
    const GpuCounts found = counts_of(
        [&] { spao_accessibility(gpu, opacity, {}, BlockMap(opacity.values.grid.count, true), timer, progress); });
    expect_within(found, {29, 110000, 8, 6, 1600}, "spao");
}

// What a solver knows and does between its iterations.
#pragma once
#include <limits>

#include "illumination/transport/gpu.h"
#include "illumination/transport/matter.h"
#include "illumination/transport/solver.h"

namespace chiaro {

/// The light is on the GPU, or else here.
struct TransportSolver::State : LightFields {
    Device device;
    SharedTransportMedium matter;
    TransportSettings settings;
    ScatteringSettings scattering;
    const OpaqueCells& opaque = matter->opaque;
    const SweptMedium& medium = matter->swept;
    Colour source_across;  ///< the same source, rows along y
    using Sums = std::array<LatticeField, kernel::SourceSweepKernel::sums>;
    std::array<Sums, 6> sums;  ///< by the side that light comes from; those of x: rows along y
    LatticeField emission;
    std::unique_ptr<GpuTransport> gpu;
    int iterations = 0;
    double change = std::numeric_limits<double>::infinity();

    State(const Device& d, SharedTransportMedium m, const Lighting& lighting, const TransportSettings& s,
          const ScatteringSettings& sc, Vec3 orbit_up, Progress& progress);

    bool is_accelerated() const { return !matter->counts_bounces; }
    bool is_done() const;
    void start(const FirstDirections& directions, Progress& progress);
    void prepare();
    void fall_back_to_host();
    double iterate(const std::vector<Vec3>& directions, Progress& progress);
    void sweep(const std::vector<Vec3>& directions, const SweepGroup& group, const Progress& progress,
               std::span<float> arriving);
    LatticeField sweep(const std::vector<Vec3>& directions, Progress& progress);
    double update(const kernel::UpdateKernel& kernel);
    void update_faces(const LatticeField& arriving, float share);
    void start_from(const TransportNodes& warm);
    void turn_source();
    void gather(std::vector<float>& scattered) const;
    void gather(std::vector<float>& light, std::vector<float>& moments) const;
};

}  // namespace chiaro

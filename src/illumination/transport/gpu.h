// Transport on a GPU: all fields stay there from the first sweep to the last; an iteration brings back its change.
#pragma once
#include "cuda/device_cache.h"
#include "illumination/transport/gpu_kernel.h"
#include "illumination/transport/light_fields.h"
#include "illumination/transport/matter_kernel.h"

namespace chiaro {

/// Light on its way through a medium, on the device's GPU. What it must have room for it has from the start, but for
/// what the directions of a sweep need.
class GpuTransport {
public:
    using Faces = std::vector<OpaqueCells::Faces>;

    /// `medium` must outlive it.
    GpuTransport(const Device& device, const SweptMedium& medium);

    /// Light not yet scattered, from which iterations start. Throws Error{interrupted}.
    void start(const Device& device, const FirstDirections& first, Progress& progress);
    /// From other light, `arrays` being what the kernel's nodes and light point into, and that on faces. Throws
    /// cuda::OutOfMemory before anything has changed.
    void start_from(kernel::NearestKernel nearest, HostArrays arrays, const Faces& faces);
    /// One sweep of scattered light and what follows; [z][2][16] as relative_change takes them. Throws
    /// Error{interrupted} and cuda::OutOfMemory before anything has changed.
    std::vector<float> iterate(const std::vector<Vec3>& directions, const kernel::UpdateKernel& update,
                               Progress& progress);

    /// Light and moment of nodes.h.
    void nodes(std::vector<float>& light, std::vector<float>& moment) const;
    void scattered(std::vector<float>& scattered) const;
    Faces faces() const { return faces_of(faces_); }
    Faces mean_faces() const { return faces_of(mean_faces_); }
    /// Everything, where the CPU is to go on.
    void fetch(LightFields& fields) const;

private:
    using Numbers = cuda::Array<float>;
    /// What all groups of a sweep have in common.
    struct SweepTerms {
        int per_ray;    ///< numbers that travel
        float outside;  ///< what comes in there
        const char* stage;
    };
    struct Rounds {
        std::size_t all, together;
        std::size_t plane, planes;  ///< numbers: of a side, of a round
    };
    template <class Batch>
    Rounds rounds_of(const std::vector<SweepGroup>& groups, const std::vector<std::vector<Batch>>& batches,
                     int per_ray) const;
    template <class Batch, class MakeSide, class Then>
    void sweep(const std::vector<SweepGroup>& groups, const std::vector<std::vector<Batch>>& batches,
               const MakeSide& make_side, const SweepTerms& terms, const Then& then, Progress& progress);
    template <class Side>
    void pass_planes(const std::vector<Side>& sides);
    template <class Kernel>
    void run(std::size_t count, const Kernel& kernel) const;

    void find_first(const FirstDirections& first, Progress& progress);
    void add_dominant_light(const Device& device, const DominantLight& dominant, Progress& progress);
    /// then(groups) starts what follows. Waits once.
    template <class Then>
    void scatter(const std::vector<Vec3>& directions, const Then& then, Progress& progress);
    void meet_faces(std::size_t groups, const Numbers& faces, const Numbers* first, const Numbers* mean, float share);
    void turn_and_reflect();

    kernel::SweptCells cells_of(const SweepAxes& axes) const;
    std::size_t cells() const { return std::size_t(places_.count()); }
    float* field(const Numbers& fields, int i) const { return fields.data() + std::size_t(i) * field_; }
    Numbers fields(int count) const;
    Numbers of_faces() const;
    Faces faces_of(const Numbers& faces) const;
    void upload(const Numbers& to, const Faces& from);
    void download(LatticeField& to, const Numbers& from, int i) const;

    const std::shared_ptr<cuda::Stream> stream_;
    const SweptMedium& medium_;
    const kernel::CellPlaces places_;
    const std::size_t field_;  ///< numbers of the larger lattice
    Numbers extinction_;       ///< rows along x, rows along y
    Numbers albedo_, first_light_, first_moment_, source_, across_, mean_, moment_, sums_;
    Numbers arriving_, first_faces_, faces_, mean_faces_, emission_;
    Numbers change_, change_sums_;
    std::unique_ptr<cuda::Views> tables_;  ///< what these point into:
    const std::uint8_t* clear_ = nullptr;
    const std::uint32_t* around_ = nullptr;
    const std::int32_t* ids_ = nullptr;
    kernel::ReflectKernel reflect_;
    kernel::CoverKernel cover_;
};

}  // namespace chiaro

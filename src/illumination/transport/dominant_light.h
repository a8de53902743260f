// What a sun adds to the light that no one has scattered yet.
#pragma once
#include <algorithm>

#include "cuda/executor.h"
#include "illumination/transport/dominant_light_kernel.h"
#include "illumination/transport/uncollided_light.h"

namespace chiaro {

/// Coefficients of what each cell sees of the sun, and from where: its own border.
inline constexpr int dominant_coefficients = 4;
inline constexpr double dominant_start = 0.5;

/// As the medium and the sun have them; to be told where the light lies.
struct DominantLightKernels {
    kernel::DominantLightShareKernel share;
    kernel::DominantLightFacesKernel faces;
    kernel::DominantLightKernel shine;

    DominantLightKernels(const SweptMedium& medium, const DominantLight& dominant);
};

/// What the kernels read and write, in the executor's memory.
struct SunPlaces {
    const float *visibility, *depth;
    const std::uint8_t* clear;
    const std::int32_t* ids;
    const std::uint32_t* around;
    float* faces;
    float *light[3], *moment[3][3];
};

/// One after the other: the faces of the opaque cells, the share of each cell, and the light of each.
template <class Executor>
void shine(Executor& executor, const SweptMedium& medium, const DominantLight& dominant, const SunPlaces& places) {
    const std::size_t cells = medium.grid.extinction.grid.size();
    auto mean = executor.template array<double>(cells);
    DominantLightKernels kernels(medium, dominant);
    kernels.share.cells.visibility = kernels.faces.cells.visibility = places.visibility;
    kernels.share.clear = places.clear, kernels.faces.around = places.around;
    kernels.share.depth = kernels.faces.depth = places.depth, kernels.share.ids = places.ids;
    kernels.share.mean = mean.data(), kernels.shine.mean = mean.data();
    kernels.faces.nodes = executor.input(medium.opaque.nodes()), kernels.faces.faces = places.faces;
    for (int c = 0; c < 3; ++c) {
        kernels.shine.light[c] = places.light[c];
        std::copy_n(places.moment[c], 3, kernels.shine.moment[c]);
    }
    executor.for_each(std::int64_t(medium.opaque.count()), kernels.faces);
    executor.for_each(std::int64_t(cells), kernels.share);
    executor.for_each(std::int64_t(cells), kernels.shine);
}

/// Throws Error{interrupted}.
void add_dominant_light(const Device& device, const SweptMedium& medium, const DominantLight& dominant,
                        Progress& progress, UncollidedLight& light);

}  // namespace chiaro

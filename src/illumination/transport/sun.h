// What a sun adds to the light that no one has scattered yet.
#pragma once
#include <algorithm>

#include "cuda/executor.h"
#include "illumination/transport/first_light.h"
#include "illumination/transport/sun_kernel.h"

namespace chiaro {

/// Coefficients of what each cell sees of the sun, and from where: its own border.
inline constexpr int sun_coefficients = 4;
inline constexpr double sun_start = 0.5;

/// As the medium and the sun have them; to be told where the light lies.
struct SunKernels {
    kernel::SunShareKernel share;
    kernel::SunFacesKernel faces;
    kernel::SunKernel shine;

    SunKernels(const SweptMedium& medium, const Sun& sun);
};

/// What the kernels read and write, in the executor's memory.
struct SunPlaces {
    const float *visibility, *depth;
    const std::uint8_t* clear;
    const std::int32_t* ids;
    float* faces;
    float *light[3], *moment[3][3];
};

/// One after the other: the faces of the opaque cells, the share of each cell, and the light of each.
template <class Executor>
void shine(Executor& executor, const SweptMedium& medium, const Sun& sun, const SunPlaces& places) {
    const std::size_t cells = medium.grid.extinction.grid.size();
    auto mean = executor.template array<double>(cells);
    SunKernels kernels(medium, sun);
    kernels.share.cells.visibility = kernels.faces.cells.visibility = places.visibility;
    kernels.share.cells.clear = kernels.faces.cells.clear = places.clear;
    kernels.share.depth = places.depth, kernels.share.ids = places.ids;
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
void add_sun(const Device& device, const SweptMedium& medium, const Sun& sun, Progress& progress, FirstLight& light);

}  // namespace chiaro

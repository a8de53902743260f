// What a sun adds to the light that no one has scattered yet.
#pragma once
#include "illumination/transport/first_light.h"
#include "illumination/transport/sun_kernel.h"

namespace chiaro {

/// Coefficients of what each cell sees of the sun, and from where: its own border.
inline constexpr int sun_coefficients = 4;
inline constexpr double sun_start = 0.5;

/// One after the other: the share of each cell, the faces of the opaque ones, and the light of each cell.
struct SunKernels {
    kernel::SunShareKernel share;
    kernel::SunFacesKernel faces;
    kernel::SunKernel shine;  ///< to be told where the light lies

    SunKernels(const SweptMedium& medium, const Sun& sun);

    /// What they read and write, here or on a card.
    struct Numbers {
        const float *visibility, *depth;
        const std::uint8_t* clear;
        const std::int32_t* ids;
        const std::size_t* nodes;
        double* mean;
        float* faces;
    };
    void use(const Numbers& numbers);
};

/// Throws Error{interrupted}.
void add_sun(const Device& device, const SweptMedium& medium, const Sun& sun, Progress& progress, FirstLight& light);

}  // namespace chiaro

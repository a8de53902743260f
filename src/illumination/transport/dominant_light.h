// What a sun adds to the light that no one has scattered yet.
#pragma once
#include "illumination/transport/dominant_light_kernel.h"
#include "illumination/transport/uncollided_light.h"

namespace chiaro {

/// Coefficients of what each cell sees of the sun, and from where: its own border.
inline constexpr int dominant_coefficients = 4;
inline constexpr double dominant_start = 0.5;

/// One after the other: the share of each cell, the faces of the opaque ones, and the light of each cell.
struct DominantLightKernels {
    kernel::DominantLightShareKernel share;
    kernel::DominantLightFacesKernel faces;
    kernel::DominantLightKernel shine;  ///< to be told where the light lies

    DominantLightKernels(const SweptMedium& medium, const DominantLight& dominant);

    /// What they read and write, here or on a GPU.
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
void add_dominant_light(const Device& device, const SweptMedium& medium, const DominantLight& dominant,
                        Progress& progress, UncollidedLight& light);

}  // namespace chiaro

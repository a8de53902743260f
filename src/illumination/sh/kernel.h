// Spherical harmonics of a direction that differs from lane to lane (basis.h has the plain ones).
#pragma once
#include "kernel/vec.h"

namespace chiaro::kernel {

/// Y_lm of unit vectors, the first `count` of 16: 4 or 16.
template <class F>
CHIARO_INLINE void spherical_harmonics(Vec3<F> d, std::int32_t count, F* y) {
    y[0] = F(0.282094792f);
    y[1] = F(0.488602512f) * d.y;
    y[2] = F(0.488602512f) * d.z;
    y[3] = F(0.488602512f) * d.x;
    if (count < 16) return;
    const F xy = d.x * d.y, zz = d.z * d.z, xx_yy = d.x * d.x - d.y * d.y;
    const F three = F(3) * d.x * d.x;
    y[4] = F(1.092548431f) * xy;
    y[5] = F(1.092548431f) * d.y * d.z;
    y[6] = F(0.315391565f) * (F(3) * zz - F(1));
    y[7] = F(1.092548431f) * d.x * d.z;
    y[8] = F(0.546274215f) * xx_yy;
    y[9] = F(0.590043590f) * d.y * (three - d.y * d.y);
    y[10] = F(2.890611443f) * xy * d.z;
    y[11] = F(0.457045799f) * d.y * (F(5) * zz - F(1));
    y[12] = F(0.373176333f) * d.z * (F(5) * zz - F(3));
    y[13] = F(0.457045799f) * d.x * (F(5) * zz - F(1));
    y[14] = F(1.445305721f) * d.z * xx_yy;
    y[15] = F(0.590043590f) * d.x * (d.x * d.x - F(3) * d.y * d.y);
}

}  // namespace chiaro::kernel

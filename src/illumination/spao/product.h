// From means to accessibility: the matter in each shell, the product over shells, the sum over octants.
#pragma once
#include "kernel/math.h"
#include "kernel/vec.h"

namespace chiaro::kernel {

/// 1 - S_l, S_l = (8 O_(l+1) - O_l) / 7: the matter in the shell alone.
template <class F>
CHIARO_INLINE F open_share(F inner, F outer) {
    constexpr float seventh = 1 / (7 * 65535.0f);
    return min(max(F(1) + F(seventh) * inner - F(8 * seventh) * outer, F(0)), F(1));
}

enum class SpaoProduct : std::int32_t { paper, thick, corrected };

/// Π (1 - S_l)^(t_l), from the outermost shell inwards: each shell is 2 times as thick as the one inside it, so what is
/// there so far is squared (raised to 2^0.75, left alone) before the next one joins.
template <SpaoProduct product, class F>
CHIARO_INLINE F join(F outer_shells, F open) {
    if constexpr (product == SpaoProduct::corrected) return outer_shells * outer_shells * open;
    if constexpr (product == SpaoProduct::thick) return pow(outer_shells, F(1.681792831f)) * open;
    return outer_shells * open;
}
/// The innermost shell is half a cell thick.
template <SpaoProduct product, class F>
CHIARO_INLINE F finish(F shells) {
    if constexpr (product == SpaoProduct::corrected) return sqrt(shells);
    if constexpr (product == SpaoProduct::thick) return pow(shells, F(0.594603558f));
    return shells;
}

/// A = Σ w_s r_s, w_s = (1 - q)/8 + q max(0, n·s)/Σ max(0, n·s); the last sum is 2 max(2a, a + b + c) for the normal's
/// components a >= b, c by magnitude. `all` is Σ r_s, `outwards` Σ max(0, n·s) r_s.
template <class F>
CHIARO_INLINE F weigh_octants(F q, Vec3<F> n, F all, F outwards) {
    const F a = abs(n.x), b = abs(n.y), c = abs(n.z);
    const F total = F(2) * max(a + b + c, F(2) * max(a, max(b, c)));
    return (F(1) - q) * F(0.125f) * all + q * (outwards / max(total, F(1e-9f)));
}

}  // namespace chiaro::kernel

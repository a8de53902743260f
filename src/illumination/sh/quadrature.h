// Gauss-Legendre quadrature on [-1, 1] with four points: exact for polynomials up to degree 7.
#pragma once
#include <array>

namespace chiaro {

struct QuadraturePoint {
    double x, weight;
};
inline constexpr std::array<QuadraturePoint, 4> gauss_legendre{{{-0.86113631159405258, 0.34785484513745386},
                                                                {-0.33998104358485626, 0.65214515486254614},
                                                                {0.33998104358485626, 0.65214515486254614},
                                                                {0.86113631159405258, 0.34785484513745386}}};

}  // namespace chiaro

// The ball of cells around a cell, row by row.
#pragma once
#include <vector>

#include "illumination/histogram/ball_view.h"

namespace chiaro {

/// Cells 0 < d <= r at (dx, dy, dz), |dx| <= reach; they weigh 1/d², or all the same.
struct Ball {
    using Row = kernel::BallRow;
    int radius;
    std::vector<Row> rows;
    std::vector<float> weight;   ///< by d², of W = 1 (their sum over the ball); [0] is 0
    std::vector<float> weights;  ///< of every cell, row after row
    double inverse_squares;      ///< Σ 1/d²

    Ball(int radius_cells, bool by_distance) : radius(radius_cells), inverse_squares(0) {
        const int r = radius_cells;
        double cells = 0;
        for (int dz = -r; dz <= r; ++dz)
            for (int dy = -r; dy <= r; ++dy) {
                const int rest = r * r - dy * dy - dz * dz;
                if (rest < 0) continue;
                int reach = 0;
                while ((reach + 1) * (reach + 1) <= rest) ++reach;
                rows.push_back({dy, dz, reach});
                for (int dx = -reach; dx <= reach; ++dx)
                    if (const int square = dx * dx + dy * dy + dz * dz) inverse_squares += 1.0 / square, cells += 1;
            }
        weight.push_back(0);
        for (int square = 1; square <= r * r; ++square)
            weight.push_back(float(by_distance ? 1 / (square * inverse_squares) : 1 / cells));
        for (const Row& row : rows)
            for (int dx = -row.reach; dx <= row.reach; ++dx)
                weights.push_back(weight[std::size_t(row.dy * row.dy + row.dz * row.dz + dx * dx)]);
    }
    kernel::BallView view() const { return {rows.data(), std::int32_t(rows.size()), weights.data()}; }
};

}  // namespace chiaro

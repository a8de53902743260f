#include "illumination/histogram/filter_fit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <mutex>

#include "core/linear_system.h"
#include "illumination/histogram/ball.h"
#include "illumination/histogram/packing.h"

namespace chiaro {
namespace {

/// Normal equations of Σ weight (Σ c_h basis_h - target)² with Σ side (Σ c_h basis_h) = Σ side target held exactly.
class Fit {
public:
    explicit Fit(std::size_t unknowns)
        : a_(unknowns + 1, std::vector<double>(unknowns + 1)), b_(unknowns + 1), last_(unknowns) {}
    void add(const std::vector<double>& basis, double target, double weight, double side) {
        for (std::size_t i = 0; i < last_; ++i) {
            for (std::size_t j = 0; j < last_; ++j) a_[i][j] += weight * basis[i] * basis[j];
            b_[i] += weight * basis[i] * target;
            a_[i][last_] += side * basis[i], a_[last_][i] += side * basis[i];
        }
        b_[last_] += side * target;
    }
    std::vector<double> coefficients() const {
        auto a = a_;
        for (std::size_t i = 0; i < last_; ++i) a[i][i] *= 1 + 1e-9;  // neighbouring boxes differ little
        return solve(std::move(a), b_);
    }

private:
    std::vector<std::vector<double>> a_;
    std::vector<double> b_;
    std::size_t last_;
};

/// Half widths of a box; with two that are equal, all three boxes that the axes make of it are meant.
using Box = std::array<int, 3>;

/// Chosen for a radius of 8 coarse cells from all such boxes, so that little of the filters' error is left when it is
/// blurred by a cell: half of what as many cubes leave. Stretched for other radii.
std::vector<Box> chosen_boxes(int radius) {
    std::vector<Box> boxes;
    for (const Box& at_8 : {Box{0, 0, 0}, {1, 1, 1}, {4, 4, 4}, {3, 1, 1}, {6, 6, 2}, {7, 3, 3}}) {
        Box box = at_8;
        for (int& half : box) half = half <= 1 ? half : int(half * radius / 16.0 + 0.5);
        if (std::find(boxes.begin(), boxes.end(), box) == boxes.end()) boxes.push_back(box);
    }
    return boxes;
}

std::vector<Box> turned(Box box) {
    std::vector<Box> boxes;
    std::sort(box.begin(), box.end());
    do boxes.push_back(box);
    while (std::next_permutation(box.begin(), box.end()));
    return boxes;
}

/// How a fine cell at distance o from an even one takes part in a box of half width h, along one axis: interpolated
/// between the coarse cells -1 (¼) and 0 (¾); and in the difference of the next and the previous box.
struct Along {
    double sum, difference;
};
Along along(int o, int h) {
    const int coarse = o >= 0 ? o / 2 : -((1 - o) / 2);
    const auto in_box = [&](int centre) { return std::abs(coarse - centre) <= h ? 1.0 : 0.0; };
    return {0.25 * in_box(-1) + 0.75 * in_box(0), 0.25 * (in_box(0) - in_box(-2)) + 0.75 * (in_box(1) - in_box(-1))};
}

FilterFit fitted(int radius) {
    const std::vector<Box> boxes = chosen_boxes(radius);
    const Ball ball(radius, true);
    int reach = 0;
    for (const Box& box : boxes) reach = std::max(reach, *std::max_element(box.begin(), box.end()));
    const int far = 2 * reach + 6;
    std::vector<std::vector<Along>> lines;  // [half width][offset]
    for (int h = 0; h <= reach; ++h) {
        lines.emplace_back();
        for (int o = -far; o <= far; ++o) lines.back().push_back(along(o, h));
    }
    Fit mass(boxes.size()), moment(boxes.size());
    std::vector<double> of_mass(boxes.size()), of_moment(boxes.size());
    for (int z = -far; z <= far; ++z)
        for (int y = -far; y <= far; ++y)
            for (int x = -far; x <= far; ++x) {
                const int square = x * x + y * y + z * z;
                const double d = std::sqrt(square);
                const bool inside = square > near_square && square <= radius * radius;
                const double w = inside ? ball.weight[std::size_t(square)] : 0;
                for (std::size_t i = 0; i < boxes.size(); ++i) {
                    of_mass[i] = of_moment[i] = 0;
                    for (const Box& box : turned(boxes[i])) {
                        const Along ax = lines[box[0]][x + far], ay = lines[box[1]][y + far],
                                    az = lines[box[2]][z + far];
                        of_mass[i] += ax.sum * ay.sum * az.sum;
                        of_moment[i] += ax.difference * ay.sum * az.sum;
                    }
                }
                mass.add(of_mass, w, 1 + d, 1);
                moment.add(of_moment, inside ? w * x / d : 0, 1 + d, x > 0 ? 1 : x < 0 ? -1 : 0);
            }
    const auto m = mass.coefficients(), p = moment.coefficients();
    FilterFit fit;
    fit.reach = reach;
    for (std::size_t i = 0; i < boxes.size(); ++i)
        for (const Box& box : turned(boxes[i]))
            fit.boxes.push_back({box[0], box[1], box[2], float(m[i] / Packing::whole), float(p[i] / Packing::whole)});
    std::stable_sort(fit.boxes.begin(), fit.boxes.end(),
                     [](const auto& a, const auto& b) { return a.half_z < b.half_z; });
    return fit;
}

}  // namespace

FilterFit fit_filters(int radius) {
    static std::mutex mutex;
    static std::map<int, FilterFit> known;
    const std::lock_guard lock(mutex);
    const auto at = known.find(radius);
    return at != known.end() ? at->second : known.emplace(radius, fitted(radius)).first->second;
}

}  // namespace chiaro

#include "illumination/histogram/packing.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <queue>

namespace chiaro {
namespace {

/// Every bin to the interval that holds it; `ends` rise to the number of bins.
Packing from_intervals(const std::vector<int>& ends) {
    Packing packing{int(ends.size()), {}, {}};
    for (int p = 0, j = 0; p < packing.packed; ++p)
        for (; j < ends[p]; ++j) packing.low.push_back(std::uint16_t(p)), packing.share.push_back(Packing::whole);
    return packing;
}

Packing uniform(int packed, int bins) {
    std::vector<int> ends;
    for (int p = 1; p <= packed; ++p) ends.push_back(int(std::int64_t(p) * bins / packed));
    return from_intervals(ends);
}

/// A list of the bins that remain, from which the smallest is taken again and again.
class Removal {
public:
    explicit Removal(std::span<const std::uint64_t> counts)
        : bins_(int(counts.size())), mass_(counts.begin(), counts.end()), before_(bins_), behind_(bins_), to_(bins_) {
        for (int j = 0; j < bins_; ++j) {
            before_[j] = j - 1, behind_[j] = j + 1, to_[j] = {j, 1};
            smallest_.push({mass_[j], j});
        }
    }

    Packing until(int packed) {
        for (int left = bins_; left > packed; --left) remove(smallest());
        std::vector<std::uint16_t> index(bins_);
        int next = 0;
        for (int j = 0; j < bins_; ++j)
            if (is_left(j)) index[j] = std::uint16_t(next++);
        Packing packing{packed, {}, {}};
        for (int j = 0; j < bins_; ++j) {
            packing.low.push_back(index[to_[j].low]);
            packing.share.push_back(std::uint16_t(to_[j].share * Packing::whole + 0.5));
        }
        return packing;
    }

private:
    /// Where a bin's content lies: a share in `low`, the rest in what remains behind it.
    struct Place {
        int low;
        double share;
    };
    struct Entry {
        double mass;
        int bin;
        bool operator<(const Entry& o) const { return mass != o.mass ? mass > o.mass : bin > o.bin; }
    };

    bool is_left(int j) const { return to_[j].low == j && to_[j].share == 1; }

    int smallest() {
        for (;;) {
            const Entry e = smallest_.top();
            smallest_.pop();
            if (is_left(e.bin) && mass_[e.bin] == e.mass) return e.bin;
        }
    }

    void give(int to, double mass) {
        mass_[to] += mass;
        smallest_.push({mass_[to], to});
    }

    void remove(int j) {
        const int a = before_[j], b = behind_[j];
        const bool has_a = a >= 0, has_b = b < bins_;
        const double to_a = !has_b ? 1 : has_a ? 0.5 : 0;
        if (has_a) behind_[a] = b, give(a, to_a * mass_[j]);
        if (has_b) before_[b] = a, give(b, (1 - to_a) * mass_[j]);
        // What lies between a and j had shares in both, what lies between j and b in j and b.
        for (int k = std::max(a + 1, 0); k < std::min(b, bins_); ++k) {
            const double in_j = k < j ? 1 - to_[k].share : k > j ? to_[k].share : 1, in_a = k < j ? to_[k].share : 0;
            to_[k] = has_a && has_b ? Place{a, in_a + in_j * to_a} : Place{has_a ? a : b, 1};
        }
    }

    const int bins_;
    std::vector<double> mass_;
    std::vector<int> before_, behind_;
    std::vector<Place> to_;
    std::priority_queue<Entry> smallest_;
};

/// Σ over an interval of (C(k) - straight line between its ends)², from sums of C, C² and k C.
class Straightness {
public:
    Straightness(std::span<const std::uint64_t> counts, int group) : group_(group) {
        const double all = double(std::accumulate(counts.begin(), counts.end(), std::uint64_t(0)));
        double c = 0;
        sums_.push_back({0, 0, 0, 0});
        for (std::size_t j = 0; j < counts.size(); j += std::size_t(group)) {
            for (std::size_t i = j; i < std::min(j + std::size_t(group), counts.size()); ++i)
                c += double(counts[i]) / all;
            const Sums& s = sums_.back();
            const double k = double(sums_.size());
            sums_.push_back({c, s.of_c + c, s.of_square + c * c, s.of_product + k * c});
        }
    }
    int ends() const { return int(sums_.size()) - 1; }
    double error(int from, int to) const {
        const double n = to - from, first = sums_[from].c, slope = (sums_[to].c - first) / n;
        const double c = sums_[to].of_c - sums_[from].of_c, cc = sums_[to].of_square - sums_[from].of_square,
                     kc = sums_[to].of_product - sums_[from].of_product - from * c;
        const double k = n * (n + 1) / 2, kk = n * (n + 1) * (2 * n + 1) / 6;
        return cc - 2 * (first * c + slope * kc) + first * first * n + 2 * first * slope * k + slope * slope * kk;
    }
    int group() const { return group_; }

private:
    struct Sums {
        double c, of_c, of_square, of_product;
    };
    int group_;
    std::vector<Sums> sums_;  ///< up to each possible end
};

Packing cumulative(int packed, std::span<const std::uint64_t> counts) {
    const int bins = int(counts.size());
    const Straightness straight(counts, std::max(1, (bins + 511) / 512));
    const int ends = straight.ends(), wanted = std::min(packed, ends);
    std::vector<double> best(std::size_t(ends) + 1, std::numeric_limits<double>::max());
    std::vector<std::vector<int>> from(std::size_t(wanted), std::vector<int>(std::size_t(ends) + 1));
    best[0] = 0;
    for (int p = 0; p < wanted; ++p) {
        std::vector<double> next(best.size(), std::numeric_limits<double>::max());
        for (int to = p + 1; to <= ends; ++to)
            for (int at = p; at < to; ++at)
                if (const double error = best[at] + straight.error(at, to); best[at] < 1e300 && error < next[to])
                    next[to] = error, from[p][to] = at;
        best = std::move(next);
    }
    std::vector<int> list;
    for (int p = wanted - 1, to = ends; p >= 0; to = from[p--][to])
        list.insert(list.begin(), std::min(to * straight.group(), bins));
    return from_intervals(list);
}

}  // namespace

bool Packing::is_one_to_one() const {
    return std::all_of(share.begin(), share.end(), [](int s) { return s == whole; });
}

void Packing::pack(std::span<const float> histogram, std::span<float> packed_histogram) const {
    std::fill(packed_histogram.begin(), packed_histogram.end(), 0.0f);
    for (std::size_t j = 0; j < histogram.size(); ++j)
        view().add(std::int32_t(j), histogram[j], packed_histogram.data());
}

Packing make_packing(HistogramPacking kind, int packed_bins, std::span<const std::uint64_t> counts) {
    const int packed = std::min(packed_bins, int(counts.size()));
    switch (kind) {
        case HistogramPacking::paper:
            return Removal(counts).until(packed);
        case HistogramPacking::cumulative:
            return cumulative(packed, counts);
        default:
            return uniform(packed, int(counts.size()));
    }
}

}  // namespace chiaro

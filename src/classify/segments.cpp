#include "classify/segments.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "classify/albedo.h"
#include "core/threads.h"

namespace chiaro {
namespace {

using kernel::Rgba;
using Entry = OpticalTable::Entry;

Rgba over(const Rgba& near, const Rgba& far) {
    const float t = 1 - near.a;
    return {near.r + t * far.r, near.g + t * far.g, near.b + t * far.b, near.a + t * far.a};
}

/// α = 1 - exp(-κ h), the colour premultiplied.
Rgba piece(const Entry& e, double length_mm) {
    const float alpha = -std::expm1(-e.extinction_per_mm * float(length_mm));
    return {alpha * e.r, alpha * e.g, alpha * e.b, alpha};
}

/// The stored values that nodes cover. More than 8 bit may hold outliers: there nodes reach four times the width of the
/// changing values beyond these. A step that comes from farther off counts as coming from there.
std::pair<double, double> covered(const DeviceVolume::Data& volume, const OpticalTable& table) {
    if (volume.stored == VoxelType::u8) return {volume.stored_min, volume.stored_max};
    const auto stored = [&](double entry) { return (entry - table.index_offset) / table.index_scale; };
    const double low = stored(1), high = stored(double(table.entries.size()) - 2), reach = 4 * (high - low);
    return {std::max<double>(volume.stored_min, low - reach), std::min<double>(volume.stored_max, high + reach)};
}

/// The optical table, linear between its entries, on evenly spaced nodes.
class Nodes {
public:
    Nodes(const DeviceVolume::Data& volume, const OpticalTable& table) : table_(table) {
        const auto [low, high] = covered(volume, table);
        const double most = volume.stored == VoxelType::u8 ? byte_intervals : wide_intervals;
        per_unit_ = most / std::max(high - low, 1e-30);
        if (volume.whole_numbers) per_unit_ = std::exp2(std::floor(std::log2(most / std::max(1.0, high - low))));
        low_ = low;
        count_ = int(std::ceil((high - low) * per_unit_)) + 2;
        before_.resize(table.entries.size());
        for (std::size_t j = 1; j < before_.size(); ++j)
            for (int c = 0; c < 4; ++c) before_[j][c] = before_[j - 1][c] + 0.5 * (emission(j - 1)[c] + emission(j)[c]);
    }

    int count() const { return count_; }
    double scale() const { return per_unit_; }
    double offset() const { return -low_ * per_unit_; }
    const Entry& at(int node) const { return table_.entries[nearest(entry_of(node) + 0.5)]; }

    /// Mean extinction between a node and the next, and the mean colour of what it emits.
    Entry mean_behind(int node) const {
        const double a = entry_of(node), b = entry_of(node + 1);
        const Sums from = sums_before(a), to = sums_before(b);
        const double extinction = to[3] - from[3], scale = extinction > 0 ? 1 / extinction : 0;
        const auto mean = [&](int c) { return float(scale * (to[c] - from[c])); };
        return {mean(0), mean(1), mean(2), float(extinction / (b - a))};
    }

private:
    using Sums = std::array<double, 4>;  ///< of colour × extinction, and extinction

    double entry_of(int node) const { return table_.index_of(low_ + node / per_unit_); }
    std::size_t nearest(double index) const {
        return std::size_t(std::clamp(index, 0.0, double(table_.entries.size()) - 1));
    }
    Sums emission(std::size_t j) const {
        const Entry& e = table_.entries[j];
        const double k = e.extinction_per_mm;
        return {k * e.r, k * e.g, k * e.b, k};
    }
    /// The integral up to an index; the first and the last entry stand for all beyond.
    Sums sums_before(double index) const {
        const std::size_t j = nearest(index), next = nearest(double(j) + 1);
        const double t = index - double(j);
        Sums sums = before_[j];
        for (int c = 0; c < 4; ++c) {
            const double rise = t > 0 && t < 1 ? emission(next)[c] - emission(j)[c] : 0;
            sums[c] += t * (emission(j)[c] + 0.5 * t * rise);
        }
        return sums;
    }

    const OpticalTable& table_;
    std::vector<Sums> before_;
    double low_, per_unit_;
    int count_;
};

/// Composites every run of `length` neighbours among the pieces, the first of them nearest or farthest, in three steps
/// each: of the two blocks that a run touches it takes the tail of one and the head of the other (van Herk 1992).
class Runs {
public:
    explicit Runs(int pieces) : head_(std::size_t(pieces)), tail_(std::size_t(pieces)) {}

    /// Calls found(i, colour) for the run from piece i on.
    template <class Over, class Found>
    void composite(const std::vector<Rgba>& pieces, int length, const Over& join, const Found& found) {
        const int n = int(pieces.size());
        for (int i = 0; i < n; ++i) head_[i] = i % length == 0 ? pieces[i] : join(head_[i - 1], pieces[i]);
        for (int i = n - 1; i >= 0; --i)
            tail_[i] = (i + 1) % length == 0 || i == n - 1 ? pieces[i] : join(pieces[i], tail_[i + 1]);
        for (int i = 0; i + length <= n; ++i)
            found(i, i % length == 0 ? head_[i + length - 1] : join(tail_[i], head_[i + length - 1]));
    }

private:
    std::vector<Rgba> head_, tail_;
};

/// All steps whose values lie `length` nodes apart spend the same time between one node and the next.
void fill_diagonals(const std::vector<Entry>& means, int length, double step_mm, SegmentTable& table) {
    std::vector<Rgba> pieces(means.size());
    std::transform(means.begin(), means.end(), pieces.begin(),
                   [&](const Entry& mean) { return piece(mean, step_mm / length); });
    Runs runs(int(pieces.size()));
    const auto at = [&](int near, int far) -> Rgba& { return table.entries[std::size_t(near) * table.nodes + far]; };
    runs.composite(pieces, length, over, [&](int i, const Rgba& c) { at(i, i + length) = c; });
    const auto under = [](const Rgba& a, const Rgba& b) { return over(b, a); };
    runs.composite(pieces, length, under, [&](int i, const Rgba& c) { at(i + length, i) = c; });
}

}  // namespace

SegmentTable make_segment_table(const DeviceVolume::Data& volume, const OpticalTable& optical, double step_mm,
                                int threads) {
    const Nodes nodes(volume, optical);
    SegmentTable table;
    table.nodes = nodes.count();
    table.scale = nodes.scale();
    table.offset = nodes.offset();
    table.entries.resize(std::size_t(table.nodes) * table.nodes);
    table.visible_before.assign(1, 0);
    for (const Entry& e : optical.entries)
        table.visible_before.push_back(table.visible_before.back() + float(e.extinction_per_mm > 0));

    std::vector<Entry> means;
    for (int node = 0; node + 1 < table.nodes; ++node) means.push_back(nodes.mean_behind(node));
    for (int node = 0; node < table.nodes; ++node)
        table.entries[std::size_t(node) * (table.nodes + 1)] = piece(nodes.at(node), step_mm);
    parallel_for(threads, table.nodes - 1, 16, [&](std::int64_t first, std::int64_t last) {
        for (auto length = int(first) + 1; length <= int(last); ++length) fill_diagonals(means, length, step_mm, table);
    });
    return table;
}

std::shared_ptr<const SegmentTable> segment_table(const Medium::Data& medium, double step_mm,
                                                  std::optional<double> albedo_limit, int threads) {
    LastSegments& last = medium.last_segments;
    const std::lock_guard lock(last.mutex);
    if (last.table && last.step_mm == step_mm && last.albedo_limit == albedo_limit) return last.table;
    last.table = std::make_shared<const SegmentTable>(
        make_segment_table(medium.volume.data(), with_albedos(medium.table, albedo_limit), step_mm, threads));
    last.step_mm = step_mm, last.albedo_limit = albedo_limit;
    return last.table;
}

}  // namespace chiaro

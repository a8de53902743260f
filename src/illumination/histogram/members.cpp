#include "illumination/histogram/members.h"

#include <algorithm>
#include <limits>
#include <mutex>

#include "core/threads.h"
#include "illumination/histogram/exact.h"
#include "illumination/histogram/random.h"

namespace chiaro {
namespace {

constexpr std::int64_t piece = 1 << 16;  ///< nodes that a thread looks through at a time

/// One of the two histograms of a node.
struct Member {
    std::uint16_t word;
    std::uint32_t order;  ///< at random
    std::size_t histogram;
    bool operator<(const Member& o) const {
        return word != o.word ? word < o.word : order != o.order ? order < o.order : histogram < o.histogram;
    }
};

std::span<const std::uint16_t> words_of(const LocalHistograms& h) { return {&h.pairs()[0].forward, h.histograms}; }

/// Those of each word that come first in a random order, and some more: all whose number is below a limit that makes
/// about twice as many as are needed.
std::vector<Member> candidates(const Device& device, const LocalHistograms& h) {
    const auto words = words_of(h);
    std::vector<std::uint64_t> count(std::size_t(h.words));
    for (std::uint16_t w : words) ++count[w];
    std::vector<std::uint32_t> limit(count.size(), std::numeric_limits<std::uint32_t>::max());
    for (std::size_t w = 0; w < limit.size(); ++w)
        if (const double share = 2.0 * most_members / double(std::max<std::uint64_t>(count[w], 1)); share < 1)
            limit[w] = std::uint32_t(share * 4294967295.0);
    std::vector<Member> all;
    std::mutex joining;
    parallel_for(device.threads, std::int64_t(words.size()), piece, [&](std::int64_t first, std::int64_t end) {
        std::vector<Member> found;
        for (auto i = std::size_t(first); i < std::size_t(end); ++i)
            if (const auto order = std::uint32_t(mixed(i)); order <= limit[words[i]])
                found.push_back({words[i], order, i});
        const std::lock_guard lock(joining);
        all.insert(all.end(), found.begin(), found.end());
    });
    std::sort(all.begin(), all.end());
    return all;
}

/// The mean as 16-bit shares of the largest, scaled so that rounding does not change the sum.
void store(const std::vector<float>& histogram, int members, std::size_t word, LocalHistograms& to) {
    const float largest = *std::max_element(histogram.begin(), histogram.end());
    if (!(largest > 0)) return;
    double sum = 0, rounded = 0;
    for (std::size_t j = 0; j < histogram.size(); ++j) {
        std::uint16_t& share = to.shares[word * std::size_t(to.stride) + j];
        share = std::uint16_t(histogram[j] / largest * 65535 + 0.5f);
        sum += histogram[j], rounded += share;
    }
    to.scale[word] = float(sum / members / rounded);
}

}  // namespace

void find_words(const Device& device, const BinnedCells& cells, const Ball& ball, bool whole, LocalHistograms& h,
                Progress& progress) {
    const int bins = cells.binning.count;
    h.stride = (bins + 15) / 16 * 16;
    h.shares.assign(std::size_t(h.words) * std::size_t(h.stride), 0);
    h.scale.assign(std::size_t(h.words), 0);
    const ExactHistograms exact(device, cells, ball);
    const std::vector<Member> members = candidates(device, h);
    parallel_for(device.threads, h.words, 4, "histogram words", progress, [&](std::int64_t first, std::int64_t end) {
        std::vector<float> histogram;
        for (auto w = first; w < end; ++w) {
            auto member = std::lower_bound(members.begin(), members.end(), Member{std::uint16_t(w), 0, 0});
            histogram.assign(std::size_t(bins), 0);
            int taken = 0;
            for (; member != members.end() && member->word == w && taken < most_members; ++member, ++taken) {
                const std::size_t node = member->histogram / 2;
                const auto [nx, ny, nz] = h.nodes;
                const auto half = whole                        ? ExactHistograms::Half::whole
                                  : member->histogram % 2 == 0 ? ExactHistograms::Half::forward
                                                               : ExactHistograms::Half::backward;
                exact.add(int(node % std::size_t(nx)) * h.subsample,
                          int(node / std::size_t(nx) % std::size_t(ny)) * h.subsample,
                          int(node / std::size_t(nx) / std::size_t(ny)) * h.subsample, half, histogram.data());
            }
            if (taken > 0) store(histogram, taken, std::size_t(w), h);
        }
    });
    progress.check();
}

}  // namespace chiaro

#include "illumination/histogram/members.h"

#include <algorithm>
#include <limits>
#include <mutex>

#include "core/threads.h"
#include "illumination/histogram/exact.h"
#include "illumination/histogram/gpu.h"
#include "illumination/histogram/random.h"

namespace chiaro {
namespace {

constexpr std::int64_t piece = 1 << 16;  ///< nodes that a thread looks through at a time

/// One of the two histograms of a node.
struct Member {
    std::uint16_t codeword;
    std::uint32_t order;  ///< at random
    std::size_t histogram;
    bool operator<(const Member& o) const {
        return codeword != o.codeword ? codeword < o.codeword
               : order != o.order     ? order < o.order
                                      : histogram < o.histogram;
    }
};

std::span<const std::uint16_t> codewords_of(const LocalHistograms& h) { return {&h.pairs()[0].forward, h.histograms}; }

/// Those of each word that come first in a random order, and some more: all whose number is below a limit that makes
/// about twice as many as are needed.
std::vector<Member> candidates(const Device& device, const LocalHistograms& h) {
    const auto codewords = codewords_of(h);
    std::vector<std::uint64_t> count(std::size_t(h.codewords));
    std::mutex joining;
    parallel_for(device.threads, std::int64_t(codewords.size()), piece, [&](std::int64_t first, std::int64_t end) {
        std::vector<std::uint32_t> found(count.size());
        for (auto i = std::size_t(first); i < std::size_t(end); ++i) ++found[codewords[i]];
        const std::lock_guard lock(joining);
        for (std::size_t w = 0; w < count.size(); ++w) count[w] += found[w];
    });
    std::vector<std::uint32_t> limit(count.size(), std::numeric_limits<std::uint32_t>::max());
    for (std::size_t w = 0; w < limit.size(); ++w)
        if (const double share = 2.0 * max_members / double(std::max<std::uint64_t>(count[w], 1)); share < 1)
            limit[w] = std::uint32_t(share * 4294967295.0);
    std::vector<Member> all;
    parallel_for(device.threads, std::int64_t(codewords.size()), piece, [&](std::int64_t first, std::int64_t end) {
        std::vector<Member> found;
        for (auto i = std::size_t(first); i < std::size_t(end); ++i)
            if (const auto order = std::uint32_t(mixed(i)); order <= limit[codewords[i]])
                found.push_back({codewords[i], order, i});
        const std::lock_guard lock(joining);
        all.insert(all.end(), found.begin(), found.end());
    });
    std::sort(all.begin(), all.end());
    return all;
}

/// The first of each word.
CodewordMembers members_of(const Device& device, const LocalHistograms& h, bool whole) {
    const std::vector<Member> all = candidates(device, h);
    const auto [nx, ny, nz] = h.nodes;
    CodewordMembers taken{{0}, {}};
    auto member = all.begin();
    for (int w = 0; w < h.codewords; ++w) {
        for (int count = 0; member != all.end() && member->codeword == w; ++member, ++count) {
            if (count >= max_members) continue;
            const std::size_t node = member->histogram / 2;
            const int x = int(node % std::size_t(nx)), y = int(node / std::size_t(nx) % std::size_t(ny)),
                      z = int(node / std::size_t(nx) / std::size_t(ny));
            taken.members.push_back({x * h.subsample, y * h.subsample, z * h.subsample,
                                     whole ? kernel::BallPart::whole : kernel::BallPart(member->histogram % 2)});
        }
        taken.begin.push_back(std::int32_t(taken.members.size()));
    }
    return taken;
}

}  // namespace

void store_codeword(std::span<const float> histogram, int members, std::size_t codeword, LocalHistograms& to) {
    if (members == 0) return;
    const float largest = *std::max_element(histogram.begin(), histogram.end());
    if (!(largest > 0)) return;
    double sum = 0, rounded = 0;
    for (std::size_t j = 0; j < histogram.size(); ++j) {
        std::uint16_t& share = to.shares[codeword * std::size_t(to.stride) + j];
        share = std::uint16_t(histogram[j] / largest * 65535 + 0.5f);
        sum += histogram[j], rounded += share;
    }
    to.scale[codeword] = float(sum / members / rounded);
}

void find_codewords(const Device& device, const BinnedCells& cells, const Ball& ball, bool whole, LocalHistograms& h,
                    Progress& progress) {
    const int bins = cells.binning.count;
    h.stride = (bins + 15) / 16 * 16;
    h.shares.assign(std::size_t(h.codewords) * std::size_t(h.stride), 0);
    h.scale.assign(std::size_t(h.codewords), 0);
    const CodewordMembers taken = members_of(device, h, whole);
    if (cuda::try_gpu(device, [&] { find_codewords_on_gpu(device, cells, ball, taken, h, progress); })) return;
    const ExactHistograms exact(device, cells, ball);
    parallel_for(device.threads, h.codewords, 4, "histogram words", progress,
                 [&](std::int64_t first, std::int64_t end) {
                     std::vector<float> histogram;
                     for (auto w = std::size_t(first); w < std::size_t(end); ++w) {
                         histogram.assign(std::size_t(bins), 0);
                         for (const kernel::CodewordMember& member : taken.of(w))
                             exact.add(member.x, member.y, member.z, member.part, histogram.data());
                         store_codeword(histogram, int(taken.of(w).size()), w, h);
                     }
                 });
    progress.check();
}

}  // namespace chiaro

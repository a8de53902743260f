#include "illumination/histogram/codebook.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include "core/threads.h"
#include "illumination/histogram/gpu_vectors.h"
#include "illumination/histogram/launch.h"

namespace chiaro {
namespace {

/// Vectors and the words they belong to.
class Trainer {
public:
    Trainer(const Device& device, const PackedHistograms& vectors, int bins, Training& training, Progress& progress)
        : device_(device),
          kernels_(kernel::histogram_functions_for(device.isa)),
          vectors_(vectors),
          bins_(std::size_t(bins)),
          count_(vectors.size() / bins_),
          training_(training),
          progress_(progress),
          codeword_of_(count_, 0),
          difference_(count_, 0),
          summed_of_(count_, no_codeword) {
        cuda::try_gpu(device, [&] { gpu_.emplace(device, vectors, bins); });
    }

    Codebook train() {
        codewords_ = means({std::int64_t(count_)});
        assign();
        while (true) {
            refine();
            if (codewords() >= std::min(std::size_t(training_.codewords), count_) || distortion_ == 0) break;
            split();
            assign();
        }
        return make_codebook();
    }

private:
    std::size_t codewords() const { return codewords_.size() / bins_; }
    Codebook make_codebook() const { return {device_, int(bins_), training_.metric, codewords_}; }

    template <class Work>
    bool try_gpu(const Work& work) const {
        return gpu_ && cuda::try_gpu(device_, work);
    }

    /// Every vector to its nearest word.
    void assign() {
        const Codebook codebook = make_codebook();
        const auto here = [&](std::int64_t first, std::int64_t end) {
            kernels_.assign_each(codebook.view(), vectors_.data() + std::size_t(first) * bins_,
                                 std::int32_t(end - first), codeword_of_.data() + first, difference_.data() + first);
        };
        if (try_gpu([&] { gpu_->assign(codebook, codeword_of_, difference_); }))
            progress_.report("histogram training", 1);
        else
            parallel_for(device_.threads, std::int64_t(count_), 1024, "histogram training", progress_, here);
        progress_.check();
        distortion_ = double(std::accumulate(difference_.begin(), difference_.end(), std::int64_t(0))) / double(count_);
        training_.distortions.push_back(distortion_ / (training_.metric == HistogramMetric::l2
                                                           ? double(packed_one) * packed_one
                                                           : double(packed_one)));
    }

    /// How many vectors each word has.
    std::vector<std::int64_t> members() const {
        std::vector<std::int64_t> members(codewords());
        for (std::uint16_t w : codeword_of_) ++members[w];
        return members;
    }

    /// Rounded; a word without members keeps its place empty (see fill_empty).
    std::vector<PackedHistogram> means(const std::vector<std::int64_t>& members) {
        const std::size_t n = members.size();
        std::vector<std::int64_t> of_gpu(gpu_ ? n * bins_ : 0);
        const auto& sums = try_gpu([&] { gpu_->add_up(codeword_of_, of_gpu); }) ? of_gpu : moved_sums(n);
        std::vector<PackedHistogram> means(n * bins_);
        for (std::size_t w = 0; w < n; ++w)
            if (members[w] > 0)
                for (std::size_t k = w * bins_; k < (w + 1) * bins_; ++k)
                    means[k] = PackedHistogram((sums[k] + members[w] / 2) / members[w]);
        return means;
    }
    /// The sums of `n` words, from those before: only vectors of another word than then count. (Most stay: adding up
    /// all took a tenth of the whole preprocessing.)
    const std::vector<std::int64_t>& moved_sums(std::size_t n) {
        constexpr std::size_t part = 16;  // bins at a time
        sums_.resize(n * bins_);
        parallel_for(device_.threads, std::int64_t(bins_ / part), 1, [&](std::int64_t p, std::int64_t) {
            const std::size_t first = std::size_t(p) * part;
            const PackedHistogram* vector = vectors_.data() + first;
            for (std::size_t i = 0; i < count_; ++i, vector += bins_) {
                if (summed_of_[i] == codeword_of_[i]) continue;
                std::int64_t* const to = sums_.data() + codeword_of_[i] * bins_ + first;
                for (std::size_t k = 0; k < part; ++k) to[k] += vector[k];
                if (summed_of_[i] == no_codeword) continue;
                std::int64_t* const from = sums_.data() + summed_of_[i] * bins_ + first;
                for (std::size_t k = 0; k < part; ++k) from[k] -= vector[k];
            }
        });
        summed_of_ = codeword_of_;
        return sums_;
    }

    void refine() {
        for (int step = 0; step < max_steps && distortion_ > 0; ++step) {
            const double before = distortion_;
            kept_codewords_ = codewords_, kept_of_ = codeword_of_, kept_difference_ = difference_;
            const auto members = this->members();
            codewords_ = means(members);
            fill_empty(members);
            assign();
            if (distortion_ > before) {
                codewords_ = kept_codewords_, codeword_of_ = kept_of_, difference_ = kept_difference_,
                distortion_ = before;
                training_.distortions.pop_back();
                return;
            }
            if (before - distortion_ < training_.least_gain * before) return;
        }
    }

    /// A word without members takes the vector farthest from its own word that no other took.
    void fill_empty(const std::vector<std::int64_t>& members) {
        std::vector<std::size_t> empty;
        for (std::size_t w = 0; w < members.size(); ++w)
            if (members[w] == 0) empty.push_back(w);
        const auto farthest = picked(farthest_vectors(empty.size()));
        for (std::size_t i = 0; i < empty.size(); ++i)
            std::copy_n(farthest.data() + i * bins_, bins_, codewords_.data() + empty[i] * bins_);
    }
    std::vector<std::uint32_t> farthest_vectors(std::size_t n) const {
        if (n == 0) return {};
        std::vector<std::uint32_t> order(count_);
        std::iota(order.begin(), order.end(), 0u);
        const auto farther = [&](std::uint32_t a, std::uint32_t b) {
            return difference_[a] != difference_[b] ? difference_[a] > difference_[b] : a < b;
        };
        std::partial_sort(order.begin(), order.begin() + std::ptrdiff_t(n), order.end(), farther);
        order.resize(n);
        return order;
    }
    /// Some of the vectors.
    std::vector<PackedHistogram> picked(const std::vector<std::uint32_t>& which) const {
        std::vector<PackedHistogram> found(which.size() * bins_);
        if (which.empty() || try_gpu([&] { gpu_->pick(which, found); })) return found;
        for (std::size_t i = 0; i < which.size(); ++i)
            std::copy_n(vectors_.data() + which[i] * bins_, bins_, found.data() + i * bins_);
        return found;
    }

    void split() {
        std::vector<double> total(codewords());
        std::vector<std::uint32_t> farthest(codewords());
        std::vector<std::int32_t> most(codewords(), -1);
        for (std::size_t i = 0; i < count_; ++i) {
            const std::uint16_t w = codeword_of_[i];
            total[w] += difference_[i];
            if (difference_[i] > most[w]) most[w] = difference_[i], farthest[w] = std::uint32_t(i);
        }
        std::vector<std::size_t> order(codewords());
        std::iota(order.begin(), order.end(), std::size_t(0));
        std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return total[a] > total[b]; });
        order.resize(std::min(order.size(), std::size_t(training_.codewords) - codewords()));
        std::erase_if(order, [&](std::size_t w) { return total[w] == 0; });
        std::vector<std::uint32_t> far(order.size());
        std::transform(order.begin(), order.end(), far.begin(), [&](std::size_t w) { return farthest[w]; });
        const auto beside = picked(far);
        codewords_.reserve(codewords_.size() + beside.size());
        for (std::size_t i = 0; i < order.size(); ++i)
            for (std::size_t k = 0; k < bins_; ++k)
                codewords_.push_back(
                    PackedHistogram((int(codewords_[order[i] * bins_ + k]) + int(beside[i * bins_ + k]) + 1) / 2));
    }

    static constexpr int max_steps = 50;
    const Device& device_;
    const kernel::HistogramFunctions kernels_;
    const PackedHistograms& vectors_;
    const std::size_t bins_, count_;
    Training& training_;
    Progress& progress_;
    std::vector<PackedHistogram> codewords_;
    std::vector<std::uint16_t> codeword_of_;
    std::vector<std::int32_t> difference_;
    static constexpr std::uint16_t no_codeword = 65535;
    std::vector<std::int64_t> sums_;               ///< of the vectors of each word ...
    std::vector<std::uint16_t> summed_of_;         ///< ... as they were then
    std::vector<PackedHistogram> kept_codewords_;  ///< what they were before a step
    std::vector<std::uint16_t> kept_of_;
    std::vector<std::int32_t> kept_difference_;
    double distortion_ = 0;
    std::optional<GpuVectors> gpu_;
};

}  // namespace

Codebook train_codebook(const Device& device, const PackedHistograms& vectors, int bins, Training& training,
                        Progress& progress) {
    training.distortions.clear();
    return Trainer(device, vectors, bins, training, progress).train();
}

}  // namespace chiaro

#include "illumination/histogram/codebook.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <span>

#include "core/threads.h"
#include "illumination/histogram/card_vectors.h"
#include "illumination/histogram/launch.h"

namespace chiaro {
namespace {

/// Vectors and the words they belong to.
class Trainer {
public:
    Trainer(const Device& device, const std::vector<PackedHistogram>& vectors, int bins, Training& training,
            Progress& progress)
        : device_(device),
          kernels_(kernel::histogram_functions_for(device.isa)),
          vectors_(vectors),
          bins_(std::size_t(bins)),
          count_(vectors.size() / bins_),
          training_(training),
          progress_(progress),
          word_of_(count_, 0),
          difference_(count_, 0) {
        cuda::done_on_card(device, [&] { card_.emplace(device, vectors, bins); });
    }

    Codebook train() {
        words_ = means({0, count_}, iota());
        assign();
        while (true) {
            refine();
            if (words() >= std::min(std::size_t(training_.words), count_) || distortion_ == 0) break;
            split();
            assign();
        }
        return make_book();
    }

private:
    std::size_t words() const { return words_.size() / bins_; }
    Codebook make_book() const { return {device_, int(bins_), training_.metric, words_}; }
    std::vector<std::uint32_t> iota() const {
        std::vector<std::uint32_t> all(count_);
        std::iota(all.begin(), all.end(), 0u);
        return all;
    }

    template <class Work>
    bool done_on_card(const Work& work) const {
        return card_ && cuda::done_on_card(device_, work);
    }

    /// Every vector to its nearest word.
    void assign() {
        const Codebook book = make_book();
        const auto here = [&](std::int64_t first, std::int64_t end) {
            kernels_.assign_each(book.view(), vectors_.data() + std::size_t(first) * bins_, std::int32_t(end - first),
                                 word_of_.data() + first, difference_.data() + first);
        };
        if (done_on_card([&] { card_->assign(book, word_of_, difference_); }))
            progress_.report("histogram training", 1);
        else
            parallel_for(device_.threads, std::int64_t(count_), 1024, "histogram training", progress_, here);
        progress_.check();
        distortion_ = std::accumulate(difference_.begin(), difference_.end(), 0.0) / double(count_);
        training_.distortions.push_back(distortion_ / (training_.metric == HistogramMetric::l2
                                                           ? double(packed_one) * packed_one
                                                           : double(packed_one)));
    }

    /// Vectors in the order of their words: those of word w are [begin[w], begin[w + 1]).
    std::vector<std::uint32_t> members(std::vector<std::size_t>& begin) const {
        begin.assign(words() + 1, 0);
        for (std::uint16_t w : word_of_) ++begin[w + 1u];
        std::partial_sum(begin.begin(), begin.end(), begin.begin());
        std::vector<std::uint32_t> order(count_);
        std::vector<std::size_t> next = begin;
        for (std::size_t i = 0; i < count_; ++i) order[next[word_of_[i]]++] = std::uint32_t(i);
        return order;
    }

    /// Rounded; a word without members keeps its place empty (see fill_empty).
    std::vector<PackedHistogram> means(const std::vector<std::size_t>& begin,
                                       const std::vector<std::uint32_t>& order) const {
        const std::size_t n = begin.size() - 1;
        std::vector<std::int64_t> sums(n * bins_);
        if (!done_on_card([&] { card_->add_up(word_of_, sums); }))
            parallel_for(device_.threads, std::int64_t(n), 16, [&](std::int64_t first, std::int64_t end) {
                for (auto w = std::size_t(first); w < std::size_t(end); ++w)
                    add_up({order.begin() + std::ptrdiff_t(begin[w]), order.begin() + std::ptrdiff_t(begin[w + 1])},
                           sums.data() + w * bins_);
            });
        std::vector<PackedHistogram> means(n * bins_);
        for (std::size_t w = 0; w < n; ++w)
            if (const auto members = std::int64_t(begin[w + 1] - begin[w]))
                for (std::size_t k = w * bins_; k < (w + 1) * bins_; ++k)
                    means[k] = PackedHistogram((sums[k] + members / 2) / members);
        return means;
    }
    void add_up(std::span<const std::uint32_t> members, std::int64_t* sum) const {
        std::vector<std::int32_t> part(bins_);  // of as many members as fit
        for (std::size_t i = 0; i < members.size();) {
            std::fill(part.begin(), part.end(), 0);
            for (const std::size_t last = std::min(i + 65535, members.size()); i < last; ++i)
                for (std::size_t k = 0; k < bins_; ++k) part[k] += vectors_[members[i] * bins_ + k];
            for (std::size_t k = 0; k < bins_; ++k) sum[k] += part[k];
        }
    }

    void refine() {
        for (int step = 0; step < most_steps && distortion_ > 0; ++step) {
            const double before = distortion_;
            const auto kept_words = words_;
            const auto kept_of = word_of_;
            const auto kept_difference = difference_;
            std::vector<std::size_t> begin;
            const auto order = members(begin);
            words_ = means(begin, order);
            fill_empty(begin);
            assign();
            if (distortion_ > before) {
                words_ = kept_words, word_of_ = kept_of, difference_ = kept_difference, distortion_ = before;
                training_.distortions.pop_back();
                return;
            }
            if (before - distortion_ < training_.least_gain * before) return;
        }
    }

    /// A word without members takes the vector farthest from its own word that no other took.
    void fill_empty(const std::vector<std::size_t>& begin) {
        std::vector<std::size_t> empty;
        for (std::size_t w = 0; w + 1 < begin.size(); ++w)
            if (begin[w] == begin[w + 1]) empty.push_back(w);
        const auto farthest = farthest_vectors(empty.size());
        for (std::size_t i = 0; i < empty.size(); ++i) copy_vector(farthest[i], empty[i]);
    }
    std::vector<std::uint32_t> farthest_vectors(std::size_t n) const {
        auto order = iota();
        const auto farther = [&](std::uint32_t a, std::uint32_t b) {
            return difference_[a] != difference_[b] ? difference_[a] > difference_[b] : a < b;
        };
        std::partial_sort(order.begin(), order.begin() + std::ptrdiff_t(n), order.end(), farther);
        order.resize(n);
        return order;
    }
    void copy_vector(std::size_t vector, std::size_t word) {
        std::copy_n(vectors_.begin() + std::ptrdiff_t(vector * bins_), bins_,
                    words_.begin() + std::ptrdiff_t(word * bins_));
    }

    void split() {
        std::vector<double> total(words());
        std::vector<std::uint32_t> farthest(words());
        std::vector<std::int32_t> most(words(), -1);
        for (std::size_t i = 0; i < count_; ++i) {
            const std::uint16_t w = word_of_[i];
            total[w] += difference_[i];
            if (difference_[i] > most[w]) most[w] = difference_[i], farthest[w] = std::uint32_t(i);
        }
        std::vector<std::size_t> order(words());
        std::iota(order.begin(), order.end(), std::size_t(0));
        std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return total[a] > total[b]; });
        order.resize(std::min(order.size(), std::size_t(training_.words) - words()));
        for (const std::size_t w : order) {
            if (total[w] == 0) break;
            const std::size_t next = words();
            words_.resize(words_.size() + bins_);
            for (std::size_t k = 0; k < bins_; ++k)
                words_[next * bins_ + k] =
                    PackedHistogram((int(words_[w * bins_ + k]) + int(vectors_[farthest[w] * bins_ + k]) + 1) / 2);
        }
    }

    static constexpr int most_steps = 50;
    const Device& device_;
    const kernel::HistogramFunctions kernels_;
    const std::vector<PackedHistogram>& vectors_;
    const std::size_t bins_, count_;
    Training& training_;
    Progress& progress_;
    std::vector<PackedHistogram> words_;
    std::vector<std::uint16_t> word_of_;
    std::vector<std::int32_t> difference_;
    double distortion_ = 0;
    std::optional<CardVectors> card_;
};

}  // namespace

Codebook::Codebook(const Device& device, int bins, HistogramMetric metric, std::vector<PackedHistogram> words)
    : bins_(bins), metric_(metric), words_(std::move(words)) {
    listed_ = std::min(count() - 1, most_listed);
    neighbours_.resize(std::size_t(count()) * std::size_t(listed_)), distances_.resize(neighbours_.size());
    const auto kernels = kernel::histogram_functions_for(device.isa);
    parallel_for(device.threads, count(), 32, [&](std::int64_t first, std::int64_t end) {
        std::vector<std::int32_t> difference(std::size_t(count()), 0);
        std::vector<std::uint16_t> order;
        for (auto w = first; w < end; ++w) {
            kernels.differences_to(view(), words_.data() + w * bins_, difference.data());
            order.resize(std::size_t(count()));
            std::iota(order.begin(), order.end(), std::uint16_t(0));
            order.erase(order.begin() + w);
            const auto nearer = [&](std::uint16_t a, std::uint16_t b) {
                return difference[a] != difference[b] ? difference[a] < difference[b] : a < b;
            };
            std::nth_element(order.begin(), order.begin() + listed_, order.end(), nearer);
            std::sort(order.begin(), order.begin() + listed_, nearer);
            for (int i = 0; i < listed_; ++i) {
                const std::size_t at = std::size_t(w) * std::size_t(listed_) + std::size_t(i);
                neighbours_[at] = order[std::size_t(i)];
                const auto d = float(difference[order[std::size_t(i)]]);
                distances_[at] = metric_ == HistogramMetric::l2 ? std::sqrt(d) : d;
            }
        }
    });
}

kernel::CodebookView Codebook::view() const {
    return {
        words_.data(),        count(), bins_, kernel::CodebookMetric(metric_), neighbours_.data(), distances_.data(),
        std::int32_t(listed_)};
}

Codebook train_codebook(const Device& device, const std::vector<PackedHistogram>& vectors, int bins, Training& training,
                        Progress& progress) {
    training.distortions.clear();
    return Trainer(device, vectors, bins, training, progress).train();
}

}  // namespace chiaro

#include "io/labels/numbered.h"

#include <chiaro/error.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <mutex>
#include <unordered_map>
#include <unordered_set>

#include "core/text.h"
#include "core/threads.h"

namespace chiaro {
namespace {

constexpr std::int64_t grain = 1 << 18;

/// A stored number as a label.
template <class T>
class LabelOf {
public:
    explicit LabelOf(const Volume& volume) : volume_(volume) {}
    std::uint32_t operator()(T stored) const {
        const double value = volume_.slope * double(stored) + volume_.intercept;
        const auto label = value >= 0 && value <= 4294967295.0 ? std::uint32_t(value) : 0;
        if (double(label) != value)
            throw Error(ErrorCode::input,
                        fmt::format("{}: holds {}, which is no label: labels are whole numbers from 0 to 4294967295",
                                    one_line(volume_.source), to_text(value)));
        return label;
    }

private:
    const Volume& volume_;
};

template <class T>
Numbered number_all(const Volume& volume, int component) {
    const LabelOf<T> label_of(volume);
    const auto count = std::int64_t(volume.voxel_count());
    const T* const stored = volume.as<T>().data() + component;
    const std::int64_t stride = volume.components;
    std::mutex mutex;
    std::unordered_set<std::uint32_t> found{0};
    // Neighbours mostly are of one label.
    parallel_for(count, grain, [&](std::int64_t first, std::int64_t last) {
        std::unordered_set<std::uint32_t> here;
        for (std::int64_t i = first; i < last; ++i)
            if (i == first || stored[i * stride] != stored[(i - 1) * stride]) here.insert(label_of(stored[i * stride]));
        const std::lock_guard lock(mutex);
        found.insert(here.begin(), here.end());
        if (found.size() > max_labels + 1)
            throw Error(ErrorCode::input,
                        fmt::format("{}: holds more than {} labels", one_line(volume.source), max_labels));
    });
    Numbered made{VoxelBuffer(std::size_t(count) * 2), {found.begin(), found.end()}};
    std::sort(made.values.begin(), made.values.end());
    std::unordered_map<std::uint32_t, std::uint16_t> number_of;
    for (std::size_t i = 0; i < made.values.size(); ++i) number_of[made.values[i]] = std::uint16_t(i);
    auto* const numbers = reinterpret_cast<std::uint16_t*>(made.numbers.data());
    parallel_for(count, grain, [&](std::int64_t first, std::int64_t last) {
        for (std::int64_t i = first; i < last; ++i)
            numbers[i] = i > first && stored[i * stride] == stored[(i - 1) * stride]
                             ? numbers[i - 1]
                             : number_of.find(label_of(stored[i * stride]))->second;
    });
    return made;
}

}  // namespace

Numbered numbered(const Volume& volume, int component) {
    return with_voxel_type(volume.type, [&](auto type) { return number_all<decltype(type)>(volume, component); });
}

}  // namespace chiaro

#include "illumination/histogram/cache.h"

#include <chiaro/error.h>
#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <limits>

#include "core/atomic_file.h"
#include "core/file_contents.h"
#include "core/text.h"
#include "core/user_cache.h"
#include "illumination/histogram/hash.h"

namespace chiaro {
namespace {

constexpr std::string_view magic = "chiaro local histograms 1\n";

std::filesystem::path folder_of(const std::string& setting) {
    if (setting == "none") return {};
    if (!setting.empty()) return setting;
    return user_cache();
}

/// What the result depends on, in words. The method has a number of its own: what an older one found no longer serves.
std::string key_of(const DeviceVolume::Data& v, const HistogramSettings& s) {
    const std::span<const std::byte> bricks(v.bricks.data(), v.bricks.size());
    return fmt::format(
        "method 3, data {:016x}{:016x} of {} x {} x {} type {} spacing {} {} {} range {} {}; radius {} clusters {} "
        "packed {} {} metric {} path {} subsample {}\n",
        hash_of(bricks), hash_of(bricks, 0x5bd1e995), v.dimensions[0], v.dimensions[1], v.dimensions[2], int(v.stored),
        to_text(v.geometry.spacing_mm[0]), to_text(v.geometry.spacing_mm[1]), to_text(v.geometry.spacing_mm[2]),
        v.stored_min, v.stored_max, s.radius, s.clusters, s.packed_bins, int(s.packing), int(s.metric), int(s.path),
        s.subsample);
}

/// Everything behind the key that is of fixed size.
struct Sizes {
    std::uint64_t identifiers, shares, codewords;
    std::int32_t nodes[3], stride;
};

template <class T>
std::span<const std::byte> bytes_of(const std::vector<T>& list) {
    return std::as_bytes(std::span(list));
}

/// Reads a file piece by piece; whatever does not fit ends it.
class Reader {
public:
    explicit Reader(std::vector<std::byte> bytes) : bytes_(std::move(bytes)) {}
    bool read(void* to, std::size_t size) {
        if (size > bytes_.size() - at_) return false;
        std::memcpy(to, bytes_.data() + at_, size);
        at_ += size;
        return true;
    }
    bool has(std::string_view text) {
        const bool same =
            text.size() <= bytes_.size() - at_ && std::memcmp(bytes_.data() + at_, text.data(), text.size()) == 0;
        if (same) at_ += text.size();
        return same;
    }
    /// The last eight bytes are the checksum of all others.
    bool is_whole() const {
        if (bytes_.size() < 8) return false;
        std::uint64_t sum;
        std::memcpy(&sum, bytes_.data() + bytes_.size() - 8, 8);
        return sum == hash_of(std::span(bytes_).first(bytes_.size() - 8));
    }
    std::size_t left() const { return bytes_.size() - at_; }

private:
    std::vector<std::byte> bytes_;
    std::size_t at_ = 0;
};

std::vector<std::byte> contents_of(const std::filesystem::path& path) {
    try {
        return file_bytes(path, std::numeric_limits<std::uintmax_t>::max());
    } catch (const Error&) {
        return {};
    }
}

bool fill(Reader& in, LocalHistograms& h) {
    Sizes sizes;
    if (!in.read(&sizes, sizeof sizes)) return false;
    h.codewords = int(sizes.codewords), h.stride = sizes.stride;
    std::copy_n(sizes.nodes, 3, h.nodes.begin());
    // First what keeps the products below from overflowing.
    const auto is_within = [](auto value, auto most) { return value >= 1 && value <= most; };
    if (!is_within(sizes.codewords, std::uint64_t(65536)) || !is_within(sizes.stride, 65536) ||
        !std::all_of(sizes.nodes, sizes.nodes + 3, [&](std::int32_t n) { return is_within(n, 65536); }))
        return false;
    const std::uint64_t nodes = std::uint64_t(h.node_count());
    if (sizes.identifiers != (nodes + 1) * sizeof(CodewordPair) ||
        sizes.shares != sizes.codewords * std::uint64_t(h.stride) ||
        in.left() != sizes.identifiers + 2 * sizes.shares + 4 * sizes.codewords + 8)
        return false;
    h.identifiers = VoxelBuffer(sizes.identifiers);
    h.shares.resize(sizes.shares), h.scale.resize(sizes.codewords), h.histograms = 2 * nodes;
    if (!in.read(h.identifiers.data(), sizes.identifiers) || !in.read(h.shares.data(), 2 * sizes.shares) ||
        !in.read(h.scale.data(), 4 * sizes.codewords))
        return false;
    for (const CodewordPair& pair : h.pairs())
        if (pair.forward >= h.codewords || pair.backward >= h.codewords) return false;
    return true;
}

}  // namespace

std::optional<LocalHistograms> parse_local_histograms(std::span<const std::byte> body) {
    Reader in({body.begin(), body.end()});
    LocalHistograms found;
    return fill(in, found) ? std::optional(std::move(found)) : std::nullopt;
}

HistogramCache::HistogramCache(const std::string& folder, const DeviceVolume::Data& volume,
                               const HistogramSettings& settings) {
    path_ = folder_of(folder);
    if (path_.empty()) return;
    key_ = key_of(volume, settings);
    path_ /= fmt::format("{:016x}{}", hash_of(key_), histograms_ending);
}

std::optional<LocalHistograms> HistogramCache::read(std::vector<std::string>& notes) const {
    std::error_code ignored;
    if (path_.empty() || !std::filesystem::is_regular_file(path_, ignored)) return std::nullopt;
    Reader in(contents_of(path_));
    LocalHistograms found;
    if (in.is_whole() && in.has(magic) && in.has(key_) && fill(in, found)) return found;
    notes.push_back(fmt::format("'{}' is damaged: local histograms are found again", path_.string()));
    return std::nullopt;
}

void HistogramCache::write(const LocalHistograms& h, std::vector<std::string>& notes) const {
    if (path_.empty()) return;
    const Sizes sizes{h.identifiers.size(),
                      h.shares.size(),
                      std::uint64_t(h.codewords),
                      {h.nodes[0], h.nodes[1], h.nodes[2]},
                      h.stride};
    try {
        std::vector<std::byte> bytes;
        bytes.reserve(h.bytes() + 4096);
        const auto add = [&](std::span<const std::byte> part) { bytes.insert(bytes.end(), part.begin(), part.end()); };
        add(std::as_bytes(std::span(magic.data(), magic.size())));
        add(std::as_bytes(std::span(key_.data(), key_.size())));
        add(std::as_bytes(std::span(&sizes, 1))), add({h.identifiers.data(), h.identifiers.size()});
        add(bytes_of(h.shares)), add(bytes_of(h.scale));
        const std::uint64_t sum = hash_of(bytes);
        add(std::as_bytes(std::span(&sum, 1)));
        std::filesystem::create_directories(path_.parent_path());
        AtomicFile file(path_);
        file.write(bytes);
        file.commit();
    } catch (const std::exception& error) {
        notes.push_back(fmt::format("local histograms are not kept: {}", error.what()));
    }
}

}  // namespace chiaro

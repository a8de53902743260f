#include "decode/vti_data.h"

#include "decode/output.h"
#include "decode/payload.h"

#include <fmt/format.h>
#include <lz4.h>
#include <lzma.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <vector>

namespace chiaro::decode {
namespace {

class MemorySource final : public ByteSource {
public:
    explicit MemorySource(std::string_view text) : text_(text) {}
    std::size_t read(std::span<std::byte> to) override {
        const std::size_t n = std::min(to.size(), text_.size());
        std::memcpy(to.data(), text_.data(), n);
        text_.remove_prefix(n);
        return n;
    }

private:
    std::string_view text_;
};

class Base64Source final : public ByteSource {
public:
    explicit Base64Source(std::unique_ptr<ByteSource> text) : text_(std::move(text)), buffer_(1 << 16) {}

    std::size_t read(std::span<std::byte> to) override {
        std::size_t done = 0;
        while (done < to.size()) {
            if (ready_ == 0 && !decode_group()) break;
            to[done++] = group_[group_size_ - ready_--];
        }
        return done;
    }

private:
    /// The next character that is no blank; 0 at the end.
    char character() {
        for (;;) {
            if (at_ == end_) {
                end_ = text_->read(buffer_);
                at_ = 0;
                if (end_ == 0) return 0;
            }
            const char c = char(buffer_[at_]);
            if (c == '<') return 0;
            ++at_;
            if (c != ' ' && c != '\n' && c != '\r' && c != '\t') return c;
        }
    }

    static int value_of(char c) {
        if (c >= 'A' && c <= 'Z') return c - 'A';
        if (c >= 'a' && c <= 'z') return c - 'a' + 26;
        if (c >= '0' && c <= '9') return c - '0' + 52;
        if (c == '+') return 62;
        if (c == '/') return 63;
        refuse("holds base64 text with a character that is none of its alphabet");
    }

    /// Four characters are three bytes; two or one where '=' fills up.
    bool decode_group() {
        std::uint32_t bits = 0;
        int padding = 0;
        for (int i = 0; i < 4; ++i) {
            const char c = character();
            if (c == 0 && i == 0) return false;
            if (c == 0) refuse("ends within its base64 text: the file is truncated");
            if (c == '=' && i < 2) refuse("holds base64 text with padding where none can be");
            if (c != '=' && padding > 0) refuse("holds base64 text with padding where none can be");
            padding += c == '=';
            bits = bits << 6 | std::uint32_t(c == '=' ? 0 : value_of(c));
        }
        group_ = {std::byte(bits >> 16), std::byte(bits >> 8 & 255), std::byte(bits & 255)};
        group_size_ = ready_ = std::size_t(3 - padding);
        return true;
    }

    std::unique_ptr<ByteSource> text_;
    std::vector<std::byte> buffer_;
    std::size_t at_ = 0, end_ = 0;
    std::array<std::byte, 3> group_{};
    std::size_t group_size_ = 0, ready_ = 0;
};

/// A count in the file's byte order and width.
std::uint64_t read_count(ByteSource& source, const VtiCoding& coding) {
    std::array<std::byte, 8> raw{};
    const std::size_t size = coding.wide_header ? 8 : 4;
    if (source.read(std::span(raw).first(size)) < size) refuse("ends before the counts of its array: truncated");
    if (coding.big_endian) std::reverse(raw.begin(), raw.begin() + std::ptrdiff_t(size));
    std::uint64_t value = 0;
    std::memcpy(&value, raw.data(), 8);  // bytes beyond `size` are zero: little endian
    return value;
}

using Decompress = bool (*)(std::span<const std::byte> from, std::span<std::byte> to);

bool decompress_zlib(std::span<const std::byte> from, std::span<std::byte> to) {
    uLongf size = to.size();
    return uncompress(reinterpret_cast<Bytef*>(to.data()), &size, reinterpret_cast<const Bytef*>(from.data()),
                      from.size()) == Z_OK &&
           size == to.size();
}

bool decompress_lz4(std::span<const std::byte> from, std::span<std::byte> to) {
    if (from.size() > LZ4_MAX_INPUT_SIZE || to.size() > LZ4_MAX_INPUT_SIZE) return false;
    const int size = LZ4_decompress_safe(reinterpret_cast<const char*>(from.data()), reinterpret_cast<char*>(to.data()),
                                         int(from.size()), int(to.size()));
    return size >= 0 && std::size_t(size) == to.size();
}

bool decompress_lzma(std::span<const std::byte> from, std::span<std::byte> to) {
    std::uint64_t memory = std::uint64_t(256) << 20;
    std::size_t at = 0, size = 0;
    return lzma_stream_buffer_decode(&memory, 0, nullptr, reinterpret_cast<const std::uint8_t*>(from.data()), &at,
                                     from.size(), reinterpret_cast<std::uint8_t*>(to.data()), &size,
                                     to.size()) == LZMA_OK &&
           size == to.size();
}

Decompress decompress_of(const std::string& compressor) {
    if (compressor == "vtkZLibDataCompressor") return decompress_zlib;
    if (compressor == "vtkLZ4DataCompressor") return decompress_lz4;
    if (compressor == "vtkLZMADataCompressor") return decompress_lzma;
    refuse("is compressed by '" + compressor + "'; zlib, LZ4 and LZMA are read");
}

/// Blocks compressed one by one: their number, the size of each but the last, the size of a last smaller one (0: there
/// is none), their compressed sizes, then the blocks.
class BlockSource final : public ByteSource {
public:
    BlockSource(std::unique_ptr<ByteSource> stored, const VtiCoding& coding, std::uint64_t bytes,
                std::uint64_t available)
        : stored_(std::move(stored)), decompress_(decompress_of(coding.compressor)) {
        const std::uint64_t count = read_count(*stored_, coding);
        block_size_ = read_count(*stored_, coding);
        last_size_ = read_count(*stored_, coding);
        if (last_size_ == 0) last_size_ = block_size_;
        std::uint64_t total = 0;
        if (count == 0 || __builtin_mul_overflow(count - 1, block_size_, &total) ||
            __builtin_add_overflow(total, last_size_, &total) || total != bytes || count > available)
            refuse(fmt::format("has an array of {} compressed blocks that are not the {} bytes of its extent", count,
                               bytes));
        sizes_.resize(count);
        std::uint64_t sum = 0;
        for (auto& size : sizes_) {
            size = read_count(*stored_, coding);
            if (__builtin_add_overflow(sum, size, &sum) || sum > available)
                refuse("states compressed blocks larger than the file: truncated, or a wrong header");
        }
        constexpr std::uint64_t largest_ratio = 1 << 17;  // beyond what LZMA reaches
        check_capacity(bytes, sum * largest_ratio);
    }

    std::size_t read(std::span<std::byte> to) override {
        std::size_t done = 0;
        while (done < to.size() && (at_ < block_.size() || next_block())) {
            const std::size_t n = std::min(to.size() - done, block_.size() - at_);
            std::copy_n(block_.begin() + std::ptrdiff_t(at_), n, to.begin() + std::ptrdiff_t(done));
            done += n;
            at_ += n;
        }
        return done;
    }

private:
    bool next_block() {
        if (next_ == sizes_.size()) return false;
        packed_.resize(sizes_[next_++]);
        block_.resize(next_ == sizes_.size() ? last_size_ : block_size_);
        at_ = 0;
        if (stored_->read(packed_) < packed_.size()) refuse("ends within its compressed blocks: the file is truncated");
        if (!decompress_(packed_, block_)) refuse("holds a compressed block that is damaged");
        return true;
    }

    std::unique_ptr<ByteSource> stored_;
    Decompress decompress_;
    std::uint64_t block_size_ = 0, last_size_ = 0;
    std::vector<std::uint64_t> sizes_;
    std::size_t next_ = 0, at_ = 0;
    std::vector<std::byte> packed_, block_;
};

}  // namespace

std::unique_ptr<ByteSource> open_memory(std::string_view text) { return std::make_unique<MemorySource>(text); }

std::unique_ptr<ByteSource> open_base64(std::unique_ptr<ByteSource> text) {
    return std::make_unique<Base64Source>(std::move(text));
}

std::unique_ptr<ByteSource> open_vti_array(std::unique_ptr<ByteSource> stored, const VtiCoding& coding,
                                           std::uint64_t bytes, std::uint64_t available) {
    if (!coding.compressor.empty()) return std::make_unique<BlockSource>(std::move(stored), coding, bytes, available);
    const std::uint64_t stated = read_count(*stored, coding);
    if (stated != bytes)
        refuse(fmt::format("has an array of {} bytes where its extent needs {}: truncated, or a wrong header", stated,
                           bytes));
    check_capacity(bytes, available);
    return stored;
}

}  // namespace chiaro::decode

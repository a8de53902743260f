#include "decode/byte_source.h"

#include "core/truncated_file.h"
#include "decode/output.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <vector>

namespace chiaro::decode {
namespace {

class PlainSource final : public ByteSource {
public:
    PlainSource(const std::filesystem::path& path, std::uint64_t offset) : offset_(offset) {
        regular_file_size(path);
        descriptor_ = open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
        if (descriptor_ < 0) refuse(fmt::format("'{}' cannot be opened", path.filename().string()));
    }
    PlainSource(const PlainSource&) = delete;
    PlainSource& operator=(const PlainSource&) = delete;
    ~PlainSource() override { close(descriptor_); }

    std::size_t read(std::span<std::byte> to) override {
        std::size_t done = 0;
        while (done < to.size()) {
            const ssize_t n = pread(descriptor_, to.data() + done, to.size() - done, off_t(offset_));
            if (n < 0) refuse("reading it fails half-way");
            if (n == 0) break;
            done += std::size_t(n);
            offset_ += std::size_t(n);
        }
        if (done > 0 && is_cut(descriptor_, offset_)) refuse(was_cut);
        return done;
    }

private:
    int descriptor_;
    std::uint64_t offset_;
};

class InflateSource final : public ByteSource {
public:
    explicit InflateSource(std::unique_ptr<ByteSource> packed) : packed_(std::move(packed)), buffer_(1 << 18) {
        constexpr int zlib_or_gzip = 15 + 32;
        if (inflateInit2(&stream_, zlib_or_gzip) != Z_OK) refuse("no memory to inflate it");
        refill();
    }
    InflateSource(const InflateSource&) = delete;
    InflateSource& operator=(const InflateSource&) = delete;
    ~InflateSource() override { inflateEnd(&stream_); }

    std::size_t read(std::span<std::byte> to) override {
        std::size_t done = 0;
        while (done < to.size() && !ended_) {
            const auto room = uInt(std::min<std::size_t>(to.size() - done, 1u << 30));
            stream_.next_out = reinterpret_cast<Bytef*>(to.data() + done);
            stream_.avail_out = room;
            step();
            done += room - stream_.avail_out;
        }
        return done;
    }

private:
    void refill() {
        stream_.next_in = reinterpret_cast<Bytef*>(buffer_.data());
        stream_.avail_in = uInt(packed_->read(buffer_));
    }

    void step() {
        if (stream_.avail_in == 0) refill();
        if (stream_.avail_in == 0) refuse("its compressed data end too early: the file is truncated");
        const int status = inflate(&stream_, Z_NO_FLUSH);
        if (status == Z_STREAM_END) return next_member();
        if (status != Z_OK)
            refuse(fmt::format("its compressed data are damaged ({})", stream_.msg ? stream_.msg : "bad stream"));
    }

    /// gzip files may hold several members (bgzip, pigz); what else follows the end is padding.
    void next_member() {
        if (stream_.avail_in == 0) refill();
        if (stream_.avail_in == 0 || stream_.next_in[0] != 0x1f)
            ended_ = true;
        else
            inflateReset(&stream_);
    }

    std::unique_ptr<ByteSource> packed_;
    std::vector<std::byte> buffer_;
    z_stream stream_{};
    bool ended_ = false;
};

}  // namespace

std::uint64_t regular_file_size(const std::filesystem::path& path) {
    struct stat status {};
    if (stat(path.c_str(), &status) != 0) refuse(fmt::format("'{}' does not exist", path.filename().string()));
    if (!S_ISREG(status.st_mode)) refuse(fmt::format("'{}' is not a regular file", path.filename().string()));
    return std::uint64_t(status.st_size);
}

std::unique_ptr<ByteSource> open_plain(const std::filesystem::path& path, std::uint64_t offset) {
    return std::make_unique<PlainSource>(path, offset);
}

std::unique_ptr<ByteSource> open_deflated(const std::filesystem::path& path, std::uint64_t offset) {
    return std::make_unique<InflateSource>(open_plain(path, offset));
}

void skip(ByteSource& source, std::uint64_t bytes) {
    std::array<std::byte, 4096> ignored;
    while (bytes > 0) {
        const auto piece = std::min<std::uint64_t>(bytes, ignored.size());
        if (source.read(std::span(ignored).first(piece)) < piece) refuse("ends before its first voxel");
        bytes -= piece;
    }
}

}  // namespace chiaro::decode

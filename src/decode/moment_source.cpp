#include "decode/moment_source.h"

#include <algorithm>
#include <cstring>

namespace chiaro::decode {
namespace {

/// Gaps of plain files that are longer than this are jumped over, all others read: a guess, not tuned.
constexpr std::uint64_t longest_read_gap = 1 << 20;

/// The files of a payload as one stream, read through a buffer: runs may be as short as one voxel.
class AllFiles {
public:
    AllFiles(const Payload& payload, std::uint64_t share) : payload_(payload), share_(share) {}

    std::size_t read(std::span<std::byte> to) {
        std::size_t done = 0;
        while (done < to.size()) {
            if (at_ == end_ && !refill()) break;
            const std::size_t n = std::min(to.size() - done, end_ - at_);
            std::memcpy(to.data() + done, buffer_.data() + at_, n);
            at_ += n, done += n;
        }
        return done;
    }

    void skip(std::uint64_t bytes) {
        const std::uint64_t buffered = std::min<std::uint64_t>(bytes, end_ - at_);
        at_ += buffered, bytes -= buffered;
        if (bytes > longest_read_gap && (payload_.encoding == Encoding::raw || within_ + bytes >= share_)) {
            const std::uint64_t to = file_ * share_ + within_ + bytes;
            file_ = to / share_, within_ = 0;
            source_.reset();
            bytes = to % share_;
            if (payload_.encoding == Encoding::raw) within_ = bytes, bytes = 0;
        }
        while (bytes > 0 && refill()) {
            at_ = std::min<std::uint64_t>(bytes, end_);
            bytes -= at_;
        }
    }

private:
    bool refill() {
        if (within_ == share_) ++file_, within_ = 0, source_.reset();
        if (file_ >= payload_.files.size()) return false;
        const bool is_plain = payload_.encoding == Encoding::raw;
        if (!source_ && is_plain)
            source_ = open_plain(payload_.files[file_], payload_.offset + payload_.skip + within_);
        if (!source_) {
            source_ = open_deflated(payload_.files[file_], payload_.offset);
            decode::skip(*source_, payload_.skip);
        }
        const std::size_t n = std::min<std::uint64_t>(buffer_.size(), share_ - within_);
        at_ = 0, end_ = source_->read(std::span(buffer_).first(n));
        within_ += end_;
        return end_ > 0;
    }

    const Payload payload_;
    const std::uint64_t share_;
    std::unique_ptr<ByteSource> source_;
    std::uint64_t file_ = 0, within_ = 0;  // of its share, up to the buffer's end
    std::vector<std::byte> buffer_ = std::vector<std::byte>(1 << 18);
    std::size_t at_ = 0, end_ = 0;
};

class MomentSource : public ByteSource {
public:
    MomentSource(const Payload& payload, std::uint64_t share) : all_(payload, share), moments_(payload.moments) {
        all_.skip(moments_.wanted * moments_.run);
    }

    std::size_t read(std::span<std::byte> to) override {
        std::size_t done = 0;
        while (done < to.size()) {
            if (left_ == 0) {
                all_.skip((moments_.count - 1) * moments_.run);
                left_ = moments_.run;
            }
            const std::size_t n = std::min<std::uint64_t>(left_, to.size() - done);
            const std::size_t got = all_.read(to.subspan(done, n));
            done += got, left_ -= got;
            if (got < n) break;
        }
        return done;
    }

private:
    AllFiles all_;
    const MomentAxis moments_;
    std::uint64_t left_ = moments_.run;
};

}  // namespace

std::unique_ptr<ByteSource> open_moment(const Payload& payload, std::uint64_t share) {
    return std::make_unique<MomentSource>(payload, share);
}

}  // namespace chiaro::decode

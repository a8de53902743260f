#include "decode/vdb_stream.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstring>

#include "decode/byte_source.h"
#include "decode/output.h"

namespace chiaro::decode {
namespace {

constexpr const char* ends_too_early = "is cut short: it ends where more is to come";

}  // namespace

VdbBuffer::VdbBuffer(const std::filesystem::path& path) : size_(regular_file_size(path)) {
    file_ = open(path.c_str(), O_RDONLY | O_CLOEXEC);
    if (file_ < 0) refuse("cannot be opened");
}

VdbBuffer::~VdbBuffer() {
    if (file_ >= 0) close(file_);
}

VdbBuffer::int_type VdbBuffer::underflow() {
    const ssize_t count = pread(file_, buffer_.data(), buffer_.size(), off_t(buffered_end_));
    if (count < 0) refuse("reading it fails half-way");
    if (count == 0) refuse(ends_too_early);
    buffered_end_ += std::uint64_t(count);
    setg(buffer_.data(), buffer_.data(), buffer_.data() + count);
    return traits_type::to_int_type(*gptr());
}

std::streamsize VdbBuffer::xsgetn(char* to, std::streamsize count) {
    for (std::streamsize done = 0; done < count;) {
        if (gptr() == egptr()) underflow();
        const auto now = std::min<std::streamsize>(count - done, egptr() - gptr());
        std::memcpy(to + done, gptr(), std::size_t(now));
        gbump(int(now));
        done += now;
    }
    return count;
}

VdbBuffer::pos_type VdbBuffer::seekoff(off_type offset, std::ios_base::seekdir from, std::ios_base::openmode mode) {
    if (from == std::ios_base::beg) return seekpos(pos_type(offset), mode);
    std::int64_t to = 0;
    const std::uint64_t origin = from == std::ios_base::cur ? position() : size_;
    if (__builtin_add_overflow(std::int64_t(origin), std::int64_t(offset), &to)) refuse(ends_too_early);
    return seekpos(pos_type(to), mode);
}

VdbBuffer::pos_type VdbBuffer::seekpos(pos_type position, std::ios_base::openmode) {
    const off_type to = position;
    if (to < 0 || std::uint64_t(to) > size_) refuse(ends_too_early);
    const std::uint64_t at = std::uint64_t(to), begin = buffered_end_ - std::uint64_t(egptr() - eback());
    if (at >= begin && at <= buffered_end_) {
        setg(eback(), eback() + (at - begin), egptr());
    } else {
        setg(buffer_.data(), buffer_.data(), buffer_.data());
        buffered_end_ = at;
    }
    return position;
}

void VdbStream::go_to(std::uint64_t position) {
    clear();
    if (position > buffer_.size()) refuse(ends_too_early);
    seekg(pos_type(off_type(position)));
}

std::string VdbStream::text(std::uint32_t max_length) {
    const auto length = number<std::uint32_t>();
    if (length > max_length)
        refuse(fmt::format("has a name or a type of {} characters, more than {}", length, max_length));
    std::string text(length, '\0');
    if (length > 0) read(text.data(), length);
    return text;
}

}  // namespace chiaro::decode

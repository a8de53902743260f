// A .vdb file as the stream that libopenvdb reads from, which makes certain that there is what it reads.
#pragma once
#include <array>
#include <cstdint>
#include <filesystem>
#include <istream>
#include <streambuf>

namespace chiaro::decode {

/// The library does not look whether a read succeeded: here one that fails throws.
class VdbBuffer final : public std::streambuf {
public:
    /// Throws Error{input} for what is not a regular file.
    explicit VdbBuffer(const std::filesystem::path& path);
    VdbBuffer(const VdbBuffer&) = delete;
    VdbBuffer& operator=(const VdbBuffer&) = delete;
    ~VdbBuffer() override;

    std::uint64_t size() const { return size_; }

protected:
    /// Throw Error{input} at the end of the file.
    int_type underflow() override;
    std::streamsize xsgetn(char* to, std::streamsize count) override;
    pos_type seekoff(off_type offset, std::ios_base::seekdir from, std::ios_base::openmode) override;
    pos_type seekpos(pos_type position, std::ios_base::openmode) override;

private:
    std::uint64_t position() const { return buffered_end_ - std::uint64_t(egptr() - gptr()); }

    int file_ = -1;
    std::uint64_t size_ = 0, buffered_end_ = 0;
    std::array<char, 1 << 16> buffer_;
};

/// Throws what its buffer throws.
class VdbStream final : public std::istream {
public:
    explicit VdbStream(const std::filesystem::path& path) : std::istream(nullptr), buffer_(path) {
        rdbuf(&buffer_);
        exceptions(badbit | failbit | eofbit);
    }
    std::uint64_t size() const { return buffer_.size(); }
    std::uint64_t position() { return std::uint64_t(tellg()); }
    /// Throw Error{input} for places that lie outside of the file.
    void go_to(std::uint64_t position);
    void skip(std::uint64_t bytes) { go_to(position() + bytes); }

    template <class T>
    T number() {
        T value{};
        read(reinterpret_cast<char*>(&value), sizeof value);
        return value;
    }
    /// Its length in 32 bits, then its characters.
    std::string text(std::uint32_t max_length);

private:
    VdbBuffer buffer_;
};

}  // namespace chiaro::decode

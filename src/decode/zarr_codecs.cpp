#include "decode/zarr_codecs.h"

#include "core/crc32c.h"
#include "decode/output.h"

#include <blosc.h>
#include <fmt/format.h>
#include <lz4.h>
#include <zlib.h>
#include <zstd.h>

#include <algorithm>
#include <array>

namespace chiaro::decode {
namespace {

using Bytes = std::span<const std::byte>;

[[noreturn]] void refuse_damaged(const char* name) {
    refuse(fmt::format("holds a chunk whose {} data are damaged, or of another size than is stated", name));
}

/// zlib or gzip, of any number of members.
std::size_t inflate_all(Bytes from, std::span<std::byte> to) {
    constexpr int zlib_or_gzip = 15 + 32;
    z_stream stream{};
    if (inflateInit2(&stream, zlib_or_gzip) != Z_OK) throw std::bad_alloc();
    stream.next_in = reinterpret_cast<Bytef*>(const_cast<std::byte*>(from.data()));
    stream.avail_in = uInt(from.size());
    stream.next_out = reinterpret_cast<Bytef*>(to.data());
    stream.avail_out = uInt(to.size());
    int status = Z_OK;
    while ((status = inflate(&stream, Z_FINISH)) == Z_STREAM_END && stream.avail_in > 0 && *stream.next_in == 0x1f)
        inflateReset(&stream);
    const std::size_t size = to.size() - stream.avail_out;
    inflateEnd(&stream);
    if (status != Z_STREAM_END) refuse_damaged("deflated");
    return size;
}

std::size_t unpack_zstd(Bytes from, std::span<std::byte> to) {
    const std::size_t size = ZSTD_decompress(to.data(), to.size(), from.data(), from.size());
    if (ZSTD_isError(size)) refuse_damaged("zstd");
    return size;
}

/// As numcodecs writes it: the size in four bytes, then one block.
std::size_t unpack_lz4(Bytes from, std::span<std::byte> to) {
    constexpr std::size_t before = 4;
    if (from.size() < before || from.size() > LZ4_MAX_INPUT_SIZE) refuse_damaged("lz4");
    const std::uint64_t stated = number_at(from.data(), before);
    const int size =
        LZ4_decompress_safe(reinterpret_cast<const char*>(from.data() + before), reinterpret_cast<char*>(to.data()),
                            int(from.size() - before), int(std::min<std::size_t>(to.size(), LZ4_MAX_INPUT_SIZE)));
    if (size < 0 || std::uint64_t(size) != stated) refuse_damaged("lz4");
    return std::size_t(size);
}

std::size_t unpack_blosc(Bytes from, std::span<std::byte> to) {
    std::size_t size = 0;
    if (blosc_cbuffer_validate(from.data(), from.size(), &size) != 0 || size > to.size()) refuse_damaged("blosc");
    constexpr int threads = 1;
    const int got = size == 0 ? 0 : blosc_decompress_ctx(from.data(), to.data(), to.size(), threads);
    if (got < 0 || std::size_t(got) != size) refuse_damaged("blosc");
    return size;
}

std::size_t check_crc32c(Bytes from, std::span<std::byte> to) {
    constexpr std::size_t behind = 4;
    if (from.size() < behind || from.size() - behind > to.size()) refuse_damaged("crc32c");
    const Bytes kept = from.first(from.size() - behind);
    if (crc32c(kept) != number_at(from.data() + kept.size(), behind)) refuse("holds a chunk whose checksum is wrong");
    std::ranges::copy(kept, to.begin());
    return kept.size();
}

std::size_t unpack_one(Codec codec, Bytes from, std::span<std::byte> to) {
    switch (codec) {
        case Codec::deflate:
            return inflate_all(from, to);
        case Codec::zstd:
            return unpack_zstd(from, to);
        case Codec::lz4:
            return unpack_lz4(from, to);
        case Codec::blosc:
            return unpack_blosc(from, to);
        default:
            return check_crc32c(from, to);
    }
}

}  // namespace

Codec codec_named(const std::string& name) {
    if (name == "zlib" || name == "gzip") return Codec::deflate;
    if (name == "zstd") return Codec::zstd;
    if (name == "lz4") return Codec::lz4;
    if (name == "blosc") return Codec::blosc;
    if (name == "crc32c") return Codec::crc32c;
    refuse(fmt::format("is compressed by '{}'; blosc, zstd, lz4, gzip and zlib are read", name));
}

void unpack(const std::vector<Codec>& codecs, std::vector<std::byte>& from, std::span<std::byte> to,
            std::vector<std::byte>& spare) {
    for (std::size_t i = codecs.size(); i-- > 1;) {
        spare.resize(largest_packed(to.size()));
        spare.resize(unpack_one(codecs[i], from, spare));
        std::swap(spare, from);
    }
    std::size_t size = from.size();
    if (!codecs.empty())
        size = unpack_one(codecs[0], from, to);
    else if (size == to.size())
        std::ranges::copy(from, to.begin());
    if (size != to.size()) refuse(fmt::format("holds a chunk of {} bytes where {} are needed", size, to.size()));
}

std::uint64_t number_at(const std::byte* from, std::size_t bytes) {
    std::uint64_t number = 0;
    for (std::size_t i = bytes; i-- > 0;) number = number << 8 | std::uint64_t(from[i]);
    return number;
}

}  // namespace chiaro::decode

#include "decode/nifti_header.h"

#include "decode/byte_source.h"
#include "decode/output.h"
#include "decode/text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <span>

namespace chiaro::decode {
namespace {

/// Values at byte positions, in either byte order.
class HeaderBytes {
public:
    HeaderBytes(std::span<const std::byte> bytes, bool big_endian) : bytes_(bytes), big_endian_(big_endian) {}

    template <class T>
    T at(std::size_t position) const {
        std::array<std::byte, sizeof(T)> raw;
        std::copy_n(bytes_.begin() + std::ptrdiff_t(position), sizeof(T), raw.begin());
        if (big_endian_) std::reverse(raw.begin(), raw.end());
        T value;
        std::memcpy(&value, raw.data(), sizeof(T));
        return value;
    }
    template <class T, class Array>
    void copy(std::size_t position, Array& to) const {
        for (std::size_t i = 0; i < to.size(); ++i) to[i] = typename Array::value_type(at<T>(position + i * sizeof(T)));
    }
    std::string text(std::size_t position, std::size_t size) const {
        std::string all(reinterpret_cast<const char*>(bytes_.data()) + position, size);
        return trimmed(all.substr(0, all.find('\0')));
    }

private:
    std::span<const std::byte> bytes_;
    bool big_endian_;
};

/// Reads both versions: they differ in the order of the fields and in the width of the numbers.
template <class Integer, class Real>
void copy_transform(const HeaderBytes& f, std::size_t codes, std::size_t quatern, NiftiHeader& header) {
    header.qform_code = int(f.at<Integer>(codes));
    header.sform_code = int(f.at<Integer>(codes + sizeof(Integer)));
    f.copy<Real>(quatern, header.quatern);
    f.copy<Real>(quatern + 3 * sizeof(Real), header.qoffset);
    for (std::size_t row = 0; row < 3; ++row) f.copy<Real>(quatern + (6 + 4 * row) * sizeof(Real), header.srow[row]);
}

void copy_version_1(const HeaderBytes& f, NiftiHeader& header) {
    f.copy<std::int16_t>(40, header.dim);
    header.datatype = f.at<std::int16_t>(70);
    header.bitpix = f.at<std::int16_t>(72);
    f.copy<float>(76, header.pixdim);
    header.vox_offset = double(f.at<float>(108));
    header.scl_slope = double(f.at<float>(112));
    header.scl_inter = double(f.at<float>(116));
    header.xyzt_units = f.at<std::uint8_t>(123);
    header.toffset = double(f.at<float>(136));
    header.description = f.text(148, 80);
    copy_transform<std::int16_t, float>(f, 252, 256, header);
}

void copy_version_2(const HeaderBytes& f, NiftiHeader& header) {
    header.datatype = f.at<std::int16_t>(12);
    header.bitpix = f.at<std::int16_t>(14);
    f.copy<std::int64_t>(16, header.dim);
    f.copy<double>(104, header.pixdim);
    header.vox_offset = double(f.at<std::int64_t>(168));
    header.scl_slope = f.at<double>(176);
    header.scl_inter = f.at<double>(184);
    header.toffset = f.at<double>(224);
    header.description = f.text(240, 80);
    copy_transform<std::int32_t, double>(f, 344, 352, header);
    header.xyzt_units = f.at<std::int32_t>(500);
}

}  // namespace

bool is_gzip(const std::filesystem::path& path) {
    std::array<std::byte, 2> magic{};
    return open_plain(path)->read(magic) == 2 && magic[0] == std::byte(0x1f) && magic[1] == std::byte(0x8b);
}

NiftiHeader read_nifti_header(const std::filesystem::path& path) {
    std::array<std::byte, 540> bytes{};
    const auto source = is_gzip(path) ? open_deflated(path) : open_plain(path);
    if (source->read(std::span(bytes).first(348)) < 348)
        refuse("is no NIfTI: it has fewer than the 348 bytes of a header");
    const auto size_is = [&](int size, bool big) { return HeaderBytes(bytes, big).at<std::int32_t>(0) == size; };
    NiftiHeader header;
    header.size = size_is(348, false) || size_is(348, true) ? 348 : size_is(540, false) || size_is(540, true) ? 540 : 0;
    if (header.size == 0) refuse("is no NIfTI: its header states a size that is neither 348 nor 540");
    header.big_endian = size_is(header.size, true);
    if (header.size == 540 && source->read(std::span(bytes).subspan(348)) < 192)
        refuse("ends within its NIfTI-2 header");
    const HeaderBytes fields(bytes, header.big_endian);
    const std::string magic = fields.text(header.size == 348 ? 344 : 4, 4);
    const std::string version = header.size == 348 ? "1" : "2";
    if (magic != "n+" + version && magic != "ni" + version)
        refuse("is no NIfTI: it lacks the magic word (ANALYZE 7.5 is not read)");
    header.detached = magic.starts_with("ni");
    header.size == 348 ? copy_version_1(fields, header) : copy_version_2(fields, header);
    return header;
}

}  // namespace chiaro::decode

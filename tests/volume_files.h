// Small files of every volume format, written byte by byte, for the tests of reading.
#pragma once
#include <chiaro/io.h>
#include <gtest/gtest.h>
#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "places.h"

namespace volume_files {

namespace fs = std::filesystem;

/// A folder that goes away with the test.
class Folder {
public:
    Folder() {
        std::string name = (fs::temp_directory_path() / "chiaro-test-XXXXXX").string();
        path_ = mkdtemp(name.data());
    }
    Folder(const Folder&) = delete;
    Folder& operator=(const Folder&) = delete;
    ~Folder() { fs::remove_all(path_); }
    fs::path operator/(const std::string& name) const { return path_ / name; }
    std::string write(const std::string& name, const std::string& bytes) const {
        fs::create_directories((path_ / name).parent_path());
        std::ofstream(path_ / name, std::ios::binary) << bytes;
        return (path_ / name).string();
    }
    std::string name() const { return path_.string(); }

private:
    fs::path path_;
};

inline std::string content_of(const fs::path& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

template <class T>
std::string bytes_of(T value, bool big_endian = false) {
    std::string bytes(reinterpret_cast<const char*>(&value), sizeof value);
    return big_endian ? std::string(bytes.rbegin(), bytes.rend()) : bytes;
}

template <class T>
std::string bytes_of_all(const std::vector<T>& values, bool big_endian = false) {
    std::string bytes;
    for (const T value : values) bytes += bytes_of(value, big_endian);
    return bytes;
}

/// 0, 1, 2, ... through the values of T, so that every voxel knows its place.
template <class T>
std::vector<T> ramp(std::size_t count, T first = T(0)) {
    std::vector<T> values(count);
    for (std::size_t i = 0; i < count; ++i) values[i] = T(first + T(i));
    return values;
}

/// zlib (window 15) or gzip (31).
inline std::string deflated(const std::string& bytes, int window = 31) {
    z_stream stream{};
    deflateInit2(&stream, 6, Z_DEFLATED, window, 8, Z_DEFAULT_STRATEGY);
    std::string result(deflateBound(&stream, bytes.size()) + 64, '\0');
    stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
    stream.avail_in = uInt(bytes.size());
    stream.next_out = reinterpret_cast<Bytef*>(result.data());
    stream.avail_out = uInt(result.size());
    deflate(&stream, Z_FINISH);
    result.resize(stream.total_out);
    deflateEnd(&stream);
    return result;
}

/// A NIfTI-1 header (348 bytes and 4 of no extensions) of 4 x 3 x 2 voxels; fields are set by their offset in the
/// standard.
class Nifti {
public:
    explicit Nifti(std::int16_t datatype, std::int16_t bitpix, bool big_endian = false) : big_endian_(big_endian) {
        set<std::int32_t>(0, 348);
        const std::int16_t dim[] = {3, 4, 3, 2, 1, 1, 1, 1};
        for (std::size_t i = 0; i < 8; ++i) set<std::int16_t>(40 + 2 * i, dim[i]);
        set<std::int16_t>(70, datatype);
        set<std::int16_t>(72, bitpix);
        const float pixdim[] = {1, 0.5, 2, 3, 0, 0, 0, 0};
        for (std::size_t i = 0; i < 8; ++i) set<float>(76 + 4 * i, pixdim[i]);
        set<float>(108, 352);
        set<std::uint8_t>(123, 2);
        header_.replace(344, 3, "n+1");
    }
    template <class T>
    Nifti& set(std::size_t offset, T value) {
        const std::string bytes = bytes_of(value, big_endian_);
        std::copy(bytes.begin(), bytes.end(), header_.begin() + std::ptrdiff_t(offset));
        return *this;
    }
    Nifti& qform(float b, float c, float d, std::array<float, 3> offset) {
        set<std::int16_t>(252, 1).set<float>(256, b).set<float>(260, c).set<float>(264, d);
        for (std::size_t i = 0; i < 3; ++i) set<float>(268 + 4 * i, offset[i]);
        return *this;
    }
    Nifti& sform(const std::array<float, 12>& rows) {
        set<std::int16_t>(254, 1);
        for (std::size_t i = 0; i < 12; ++i) set<float>(280 + 4 * i, rows[i]);
        return *this;
    }
    const std::string& bytes() const { return header_; }

private:
    std::string header_ = std::string(352, '\0');
    bool big_endian_;
};

/// A slice as DICOM, explicit VR little endian, 16 bits a pixel.
struct Dicom {
    int columns = 4, rows = 3, instance = 1;
    std::string series = "1.2.3", modality = "CT";
    std::array<double, 3> position{0, 0, 0};
    std::array<double, 6> orientation{1, 0, 0, 0, 1, 0};
    double row_spacing = 2, column_spacing = 0.5, slope = 1, intercept = -1024;
    bool is_signed = false;
    std::vector<std::uint16_t> pixels = ramp<std::uint16_t>(12);
    int stated_rows = 0;  ///< other than there are, for lies
    int frames = 1;
    std::string functional_groups = {};  ///< elements of groups beyond 0028: of an enhanced image, of a dose
    double spacing_between_slices = 0;   ///< 0: not stated
    bool bytes_only = false;             ///< pixels of 8 bits, each the low byte of `pixels`

    std::string bytes() const {
        const std::string transfer_syntax = "1.2.840.10008.1.2.1";
        const std::string ct_image =
            functional_groups.empty() ? "1.2.840.10008.5.1.4.1.1.2" : "1.2.840.10008.5.1.4.1.1.2.1";
        std::string meta = element(2, 0x10, "UI", transfer_syntax);
        meta = element(2, 2, "UI", ct_image) + element(2, 3, "UI", series + "." + std::to_string(instance)) + meta;
        std::string body =
            element(8, 0x16, "UI", ct_image) + element(8, 0x18, "UI", series + "." + std::to_string(instance)) +
            element(8, 0x60, "CS", modality) +
            (spacing_between_slices != 0 ? element(0x18, 0x88, "DS", decimals(std::array{spacing_between_slices}))
                                         : "") +
            element(0x20, 0xd, "UI", "1.2") + element(0x20, 0xe, "UI", series) +
            element(0x20, 0x13, "IS", std::to_string(instance)) + element(0x20, 0x32, "DS", decimals(position)) +
            element(0x20, 0x37, "DS", decimals(orientation)) + us(0x28, 2, 1) + element(0x28, 4, "CS", "MONOCHROME2") +
            (frames > 1 ? element(0x28, 8, "IS", std::to_string(frames)) : "") +
            us(0x28, 0x10, stated_rows ? stated_rows : rows) + us(0x28, 0x11, columns) +
            element(0x28, 0x30, "DS", decimals(std::array{row_spacing, column_spacing})) + us(0x28, 0x100, bits()) +
            us(0x28, 0x101, bits()) + us(0x28, 0x102, bits() - 1) + us(0x28, 0x103, is_signed) +
            element(0x28, 0x1052, "DS", decimals(std::array{intercept})) +
            element(0x28, 0x1053, "DS", decimals(std::array{slope})) + functional_groups + pixel_data();
        return std::string(128, '\0') + "DICM" + element(2, 0, "UL", bytes_of(std::uint32_t(meta.size()))) + meta +
               body;
    }

    /// A sequence of items, each the bytes of its elements.
    static std::string sequence(int group, int number, const std::vector<std::string>& items) {
        std::string value;
        for (const auto& item : items)
            value += std::string("\xfe\xff\x00\xe0", 4) + bytes_of(std::uint32_t(item.size())) + item;
        return bytes_of(std::uint16_t(group)) + bytes_of(std::uint16_t(number)) + "SQ" + std::string(2, '\0') +
               bytes_of(std::uint32_t(value.size())) + value;
    }
    static std::string element(int group, int number, const std::string& vr, std::string value) {
        if (value.size() % 2) value += vr == "UI" ? '\0' : ' ';
        return bytes_of(std::uint16_t(group)) + bytes_of(std::uint16_t(number)) + vr +
               bytes_of(std::uint16_t(value.size())) + value;
    }

private:
    static std::string us(int group, int number, int value) {
        return element(group, number, "US", bytes_of(std::uint16_t(value)));
    }
    template <std::size_t n>
    static std::string decimals(const std::array<double, n>& values) {
        std::string text;
        for (const double value : values) {
            char word[32];
            std::snprintf(word, sizeof word, "%.9g", value);
            if (!text.empty()) text += '\\';
            text += word;
        }
        return text;
    }
    int bits() const { return bytes_only ? 8 : 16; }
    std::string pixel_data() const {
        std::string value = bytes_of_all(pixels);
        if (bytes_only) value.assign(pixels.begin(), pixels.end());
        return bytes_of(std::uint16_t(0x7fe0)) + bytes_of(std::uint16_t(0x10)) + (bytes_only ? "OB" : "OW") +
               std::string(2, '\0') + bytes_of(std::uint32_t(value.size())) + value;
    }
};

inline chiaro::Volume read(const std::string& name, const chiaro::ReadOptions& options = {}) {
    setenv("CHIARO_DECODE", built("chiaro-decode").c_str(), 1);
    chiaro::Progress progress;
    return chiaro::read_volume(name, options, progress);
}

template <class T>
std::vector<T> voxels_of(const chiaro::Volume& volume) {
    EXPECT_EQ(volume.type, chiaro::voxel_type_of<T>());
    const auto values = volume.as<T>();
    return {values.begin(), values.end()};
}

inline void expect_near(const chiaro::Vec3& a, const chiaro::Vec3& b, double tolerance = 1e-6) {
    for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(a[axis], b[axis], tolerance) << "axis " << axis;
}

inline bool has_note(const chiaro::Volume& volume, const std::string& part) {
    for (const auto& note : volume.notes)
        if (note.find(part) != std::string::npos) return true;
    return false;
}

}  // namespace volume_files

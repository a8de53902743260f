// A small OpenVDB file, written byte by byte: of any version that is read, and the same in every build, with the
// library or without.
#pragma once
#include "volume_files.h"

#include <cmath>

namespace volume_files {

/// One grid of floats: a leaf of 8³ voxels at (128, 8, 0), all active, of value 512 + number, z fastest; behind it
/// along z 8³ voxels of the value 3.5. The background is -1.
struct VdbBytes {
    std::uint32_t version = 224;
    bool is_packed = true;  ///< by zlib
    std::string name = "density", type = "Tree_float_5_4_3", map = "ScaleTranslateMap", grid_class = "fog volume";
    std::array<double, 3> voxel_size{0.5, 2, 3}, translation{1, -2, 3.5};
    std::array<std::int32_t, 3> node{0, 0, 0};  ///< origin of the root's

    /// What lies where, to be damaged: the names are those of the format's parts.
    std::vector<std::pair<std::string, std::size_t>> places() const {
        std::vector<std::pair<std::string, std::size_t>> found;
        make(&found);
        return found;
    }
    std::string bytes() const { return make(nullptr); }

private:
    static constexpr unsigned leaf_entry = 1 << 10, low_entry = 1 << 4;  // (1, 0, 0) of 32³, (0, 1, 0) of 16³

    static std::string text(const std::string& of) { return bytes_of(std::uint32_t(of.size())) + of; }
    static std::string mask(std::size_t size, const std::vector<unsigned>& on) {
        std::string bits(size / 8, '\0');
        for (const unsigned bit : on) bits[bit / 8] = char(bits[bit / 8] | 1 << bit % 8);
        return bits;
    }
    static std::string three(const std::array<double, 3>& numbers) {
        return bytes_of(numbers[0]) + bytes_of(numbers[1]) + bytes_of(numbers[2]);
    }
    /// Active ones only, where nodes tell that all others are the background.
    std::string values(const std::vector<float>& active, const std::vector<float>& all) const {
        const std::string raw = bytes_of_all(version < 222 ? all : active);
        std::string stored = raw;
        if (is_packed) {
            const std::string packed = deflated(raw, 15);
            stored = packed.size() < raw.size() ? bytes_of(std::int64_t(packed.size())) + packed
                                                : bytes_of(-std::int64_t(raw.size())) + raw;
        }
        return (version < 222 ? "" : std::string(1, '\0')) + stored;
    }

    std::string make(std::vector<std::pair<std::string, std::size_t>>* places) const {
        std::string file;
        const auto at = [&](const char* what) {
            if (places) places->emplace_back(what, file.size());
        };
        file = std::string(" BDV\0\0\0\0", 8);
        at("version"), file += bytes_of(version);
        file += bytes_of(std::uint32_t(10)) + bytes_of(std::uint32_t(0)) + std::string(1, '\1');
        if (version < 222) file += std::string(1, is_packed ? '\1' : '\0');
        file += "00000000-0000-0000-0000-000000000000";
        at("metadata"), file += bytes_of(std::uint32_t(1));
        file += text("creator") + text("string") + text("made for tests");
        at("grids"), file += bytes_of(std::int32_t(1));
        at("name"), file += text(name) + text(type) + text("");
        at("positions");
        const std::size_t positions = file.size();
        file += std::string(24, '\0');
        file.replace(positions, 8, bytes_of(std::uint64_t(file.size())));
        at("compression");
        if (version >= 222) file += bytes_of(std::uint32_t(2 | (is_packed ? 1 : 0)));
        file += bytes_of(std::uint32_t(2)) + text("class") + text("string") + text(grid_class);
        at("other"), file += text("other") + text("unheard of") + text("bytes");
        at("map"), file += text(map) + three(translation) + three(voxel_size);
        const auto of_each = [&](const auto& derived) {
            return three({derived(voxel_size[0]), derived(voxel_size[1]), derived(voxel_size[2])});
        };
        file += of_each([](double v) { return std::abs(v); }) + of_each([](double v) { return 1 / v; }) +
                of_each([](double v) { return 1 / (v * v); }) + of_each([](double v) { return 0.5 / v; });
        at("buffers"), file += bytes_of(std::int32_t(1));
        at("background"), file += bytes_of(-1.F);
        at("children"), file += bytes_of(std::uint32_t(0)) + bytes_of(std::uint32_t(1));
        at("origin");
        for (const std::int32_t along : node) file += bytes_of(along);
        at("node"), file += mask(32768, {leaf_entry}) + mask(32768, {});
        file += values({}, std::vector<float>(32767, -1.F));
        std::vector<float> low(4095, -1.F);
        low[low_entry] = 3.5;  // the entry behind the leaf, which has no value in the list
        at("low node"), file += mask(4096, {low_entry}) + mask(4096, {low_entry + 1});
        at("tiles"), file += values({3.5F}, low);
        std::vector<unsigned> everywhere(512);
        for (unsigned i = 0; i < 512; ++i) everywhere[i] = i;
        at("leaf mask"), file += mask(512, everywhere);
        file.replace(positions + 8, 8, bytes_of(std::uint64_t(file.size())));
        at("leaf"), file += mask(512, everywhere);
        if (version < 222)
            file += bytes_of(node[0] + 128) + bytes_of(node[1] + 8) + bytes_of(node[2]) + std::string(1, '\1');
        at("values"), file += values(ramp<float>(512, 512), ramp<float>(512, 512));
        file.replace(positions + 16, 8, bytes_of(std::uint64_t(file.size())));
        return file;
    }
};

}  // namespace volume_files

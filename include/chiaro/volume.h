// A volume in host memory: voxels as they were stored, their geometry and what their values mean.
#pragma once
#include <chiaro/export.h>
#include <chiaro/geometry.h>
#include <chiaro/progress.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace chiaro {

enum class VoxelType { u8, i8, u16, i16, u32, i32, u64, i64, f32, f64 };

CHIARO_EXPORT std::size_t size_of(VoxelType type);
/// "uint8", "int16", "float32", ...
CHIARO_EXPORT std::string_view name_of(VoxelType type);

template <class T>
constexpr VoxelType voxel_type_of();
template <>
constexpr VoxelType voxel_type_of<std::uint8_t>() {
    return VoxelType::u8;
}
template <>
constexpr VoxelType voxel_type_of<std::int8_t>() {
    return VoxelType::i8;
}
template <>
constexpr VoxelType voxel_type_of<std::uint16_t>() {
    return VoxelType::u16;
}
template <>
constexpr VoxelType voxel_type_of<std::int16_t>() {
    return VoxelType::i16;
}
template <>
constexpr VoxelType voxel_type_of<std::uint32_t>() {
    return VoxelType::u32;
}
template <>
constexpr VoxelType voxel_type_of<std::int32_t>() {
    return VoxelType::i32;
}
template <>
constexpr VoxelType voxel_type_of<std::uint64_t>() {
    return VoxelType::u64;
}
template <>
constexpr VoxelType voxel_type_of<std::int64_t>() {
    return VoxelType::i64;
}
template <>
constexpr VoxelType voxel_type_of<float>() {
    return VoxelType::f32;
}
template <>
constexpr VoxelType voxel_type_of<double>() {
    return VoxelType::f64;
}

/// Calls f(T{}) with the C++ type behind `type`.
template <class Function>
decltype(auto) with_voxel_type(VoxelType type, Function&& f) {
    switch (type) {
        case VoxelType::u8:
            return f(std::uint8_t{});
        case VoxelType::i8:
            return f(std::int8_t{});
        case VoxelType::u16:
            return f(std::uint16_t{});
        case VoxelType::i16:
            return f(std::int16_t{});
        case VoxelType::u32:
            return f(std::uint32_t{});
        case VoxelType::i32:
            return f(std::int32_t{});
        case VoxelType::u64:
            return f(std::uint64_t{});
        case VoxelType::i64:
            return f(std::int64_t{});
        case VoxelType::f32:
            return f(float{});
        default:
            return f(double{});
    }
}

/// Page-aligned bytes with one owner, zero at first, whose pages can be handed back to the system while the rest is in
/// use; or bytes that are borrowed, of which nothing is ever changed or handed back.
class VoxelBuffer {
public:
    VoxelBuffer() = default;
    /// Throws Error{output} when the memory cannot be had.
    CHIARO_EXPORT explicit VoxelBuffer(std::size_t bytes);
    /// Takes over a memory mapping (of a memfd, when `shared`) of exactly `bytes` bytes.
    CHIARO_EXPORT static VoxelBuffer adopt(void* mapping, std::size_t bytes, bool shared);
    /// Bytes that somebody else has, at an address that suits their type. `owner` is kept until the buffer goes: what
    /// it frees then is the lender's choice; without one they must outlive it. They are read only: what non-const
    /// data() points to may not be written.
    CHIARO_EXPORT static VoxelBuffer borrow(const void* data, std::size_t bytes, std::shared_ptr<const void> owner);
    CHIARO_EXPORT VoxelBuffer(VoxelBuffer&& other) noexcept;
    CHIARO_EXPORT VoxelBuffer& operator=(VoxelBuffer&& other) noexcept;
    CHIARO_EXPORT ~VoxelBuffer();

    std::byte* data() noexcept { return data_; }
    const std::byte* data() const noexcept { return data_; }
    std::size_t size() const noexcept { return bytes_; }
    bool is_borrowed() const noexcept { return borrowed_; }
    /// Gives the whole pages within [begin, end) back; what they held reads as zero from then on.
    /// Nothing happens to borrowed bytes, here and below.
    CHIARO_EXPORT void discard(std::size_t begin, std::size_t end) noexcept;
    /// The same of [0, end), where less went before.
    CHIARO_EXPORT void discard_before(std::size_t end) noexcept;
    /// For what will be written here and there, from the byte `begin` on: a write takes the smallest page, not a large
    /// one. Pages that were never written take no memory.
    CHIARO_EXPORT void use_small_pages(std::size_t begin = 0) noexcept;

private:
    std::byte* data_ = nullptr;
    std::size_t bytes_ = 0;
    std::size_t discarded_ = 0;
    bool shared_ = false, borrowed_ = false;
    std::shared_ptr<const void> owner_;  // of borrowed bytes
};

/// The moments of what changes with time; a Volume is one of them.
struct Moments {
    int count = 1;
    int shown = 0;              ///< which of them the voxels are, from 0
    std::vector<double> times;  ///< of each, in `unit`, where they are told; else empty
    std::string unit;           ///< "s", "ms", ..., or what else the file steps through, such as "ppm"
    bool operator==(const Moments&) const = default;
};

/// Where a block of voxels lies in a volume that several processes share (Exchange): blocks' own voxels make up the
/// whole, each once. What a block holds beside its own are ghosts: its neighbours' voxels.
struct Placement {
    std::array<int, 3> whole{0, 0, 0};                        ///< dimensions of the whole
    std::array<int, 3> first{0, 0, 0};                        ///< of the whole's voxels, the block's first
    std::array<int, 3> own_first{0, 0, 0}, own_end{0, 0, 0};  ///< the block's own, half-open
    bool owns_any() const {
        return own_first[0] < own_end[0] && own_first[1] < own_end[1] && own_first[2] < own_end[2];
    }
    bool operator==(const Placement&) const = default;
};

/// What a file says of one of the values of a voxel.
struct ComponentInfo {
    std::string name;                          ///< "DAPI"; empty: it says none
    std::optional<std::array<double, 3>> rgb;  ///< sRGB, [0, 1]: the colour that it is shown in
    bool operator==(const ComponentInfo&) const = default;
};

struct Volume {
    std::array<int, 3> dimensions{0, 0, 0};  ///< x, y, z; x is fastest in memory
    VoxelType type = VoxelType::u8;
    int components = 1;  ///< values per voxel, interleaved; rendered as channels (components_of)
    /// The values are red, green, blue and, of four, alpha: sRGB, alpha not multiplied in. Rendered as they are
    /// (components_of).
    bool has_own_colors = false;
    std::vector<ComponentInfo> component_infos = {};  ///< of each, or none
    /// What a stored number means: value = slope * stored + intercept (HU for CT, scl_slope of NIfTI).
    double slope = 1, intercept = 0;
    Geometry geometry;
    VoxelBuffer voxels;  ///< native byte order, (z, y, x, component)
    /// Of a block of a larger volume, whose geometry is then the whole's; its dimensions may be 0 on a rank without
    /// voxels. None: the volume is whole.
    std::optional<Placement> placement = {};

    std::string source;              ///< file, folder or "sample:NAME"
    std::string format;              ///< "NRRD", "NIfTI", "DICOM", "sample", ...
    std::string modality;            ///< "CT", "MR", ... where the file says so, else empty
    Moments moments;                 ///< that the file holds, or that a pattern names
    std::vector<std::string> notes;  ///< what a user should know: files skipped, values replaced, frames missing
    std::map<std::string, std::string> key_values;  ///< of the header, where the format has them

    std::size_t voxel_count() const { return std::size_t(dimensions[0]) * dimensions[1] * dimensions[2]; }
    template <class T>
    std::span<const T> as() const {
        return {reinterpret_cast<const T*>(voxels.data()), voxel_count() * components};
    }
    template <class T>
    std::span<T> as() {
        return {reinterpret_cast<T*>(voxels.data()), voxel_count() * components};
    }
};

/// An empty (zero) volume of the given shape with unit geometry. Throws Error{input} unless every dimension is
/// in 1..65535.
CHIARO_EXPORT Volume make_volume(std::array<int, 3> dimensions, VoxelType type);

/// A volume for each value of a voxel, in order. Of one that has its own colours first what its opacity is found by -
/// alpha, or, where there is none or it is the same everywhere, luminance .2126 R + .7152 G + .0722 B of the stored
/// values - then red, green and blue: each says that it belongs to such a volume, and the first is named "alpha" or
/// "luminance". Cost: a pass over the voxels for each; memory: them once more, or 4 / 3. Throws Error{input} for
/// colours of other than three or four values.
CHIARO_EXPORT std::vector<Volume> components_of(const Volume& volume);
/// Whether voxels lie where the other's do, to a hundredth of its smallest edge.
CHIARO_EXPORT bool has_grid_of(const Volume& volume, const Volume& other);
/// The scalar volume's values, interpolated linearly at the other's voxels, in its own type; the least of them where it
/// has none. Cost: some 30 ns a voxel and core.
CHIARO_EXPORT Volume resampled(const Volume& volume, const Volume& onto);

/// What the values of a volume are, after slope and intercept; non-finite voxels are counted and left out.
struct Statistics {
    double min = 0, max = 0;
    double p1 = 0, p50 = 0, p99 = 0, p999 = 0;   ///< percentiles; exact for 8 and 16 bit, from 65536 bins otherwise
    std::array<std::uint64_t, 256> histogram{};  ///< equal bins over [min, max]
    std::uint64_t nonfinite = 0;                 ///< NaN or infinite voxels
    /// The value of 0 HU where these are a CT's that was stored without its unit: 1000 or 1024, as the peak of its air
    /// tells, else 0. Looks that are in HU are moved by it.
    double hu_zero = 0;
    /// The standard deviation of noise over the range from `p1` to `p999`: of what matter's voxels and those beside
    /// them do not share with their neighbours, jagged borders of masks included (src/volume/noise.h).
    double noise = 0;
};

/// One or two passes over the voxels, all cores. Throws Error{input} if no voxel is finite.
CHIARO_EXPORT Statistics measure(const Volume& volume);
/// The same. Throws Error{interrupted} when cancelled.
CHIARO_EXPORT Statistics measure(const Volume& volume, const Progress& progress);

}  // namespace chiaro

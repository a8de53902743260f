// A volume on a device, and what the transfer function makes of it.
#pragma once
#include <chiaro/device.h>
#include <chiaro/export.h>
#include <chiaro/progress.h>
#include <chiaro/transfer_function.h>
#include <chiaro/volume.h>

#include <array>
#include <limits>
#include <memory>
#include <optional>
#include <vector>

namespace chiaro {

/// Bricked voxels with their value ranges. Cheap to copy; the voxels are shared and never change.
/// Stored as u8, u16 or f32: 8 and 16 bit integers keep their width, wider integers become u16 where their range
/// allows, else f32. NaN and -infinity become the smallest finite value, +infinity the largest.
class DeviceVolume {
public:
    struct Data;  // src/volume/device_volume.h
    struct Splines;
    DeviceVolume() = default;
    explicit DeviceVolume(std::shared_ptr<const Data> data) : data_(std::move(data)) {}
    const Data& data() const { return *data_; }
    explicit operator bool() const { return data_ != nullptr; }

    CHIARO_EXPORT std::array<int, 3> dimensions() const;
    CHIARO_EXPORT const Geometry& geometry() const;
    /// Whether every voxel is the file's number: not where floats stand for doubles, or a finite one for NaN.
    CHIARO_EXPORT bool is_exact() const;
    CHIARO_EXPORT std::size_t bytes() const;  ///< held on the device

private:
    std::shared_ptr<const Data> data_;
};

/// Cost: one pass over the voxels; memory 1.3 × the voxels (bricks of 32³ with their neighbours' border).
/// Throws Error{input} for volumes of several components, or of more voxels than the device can hold.
CHIARO_EXPORT DeviceVolume upload(const Device& device, const Volume& volume);
/// The same, handing the volume's pages back as they are copied: the peak is the bricks and one slab.
CHIARO_EXPORT DeviceVolume upload(const Device& device, Volume&& volume);
/// The same, reported as "upload". Throw Error{interrupted} when cancelled.
CHIARO_EXPORT DeviceVolume upload(const Device& device, const Volume& volume, Progress& progress);
CHIARO_EXPORT DeviceVolume upload(const Device& device, Volume&& volume, Progress& progress);

/// Whether colours are composited as linear light (sRGB colours decoded first) or as they are.
enum class ColorMode { linear, display };

/// What a picture shows: the volume itself; isosurfaces; along each ray the largest, smallest or mean value; or its
/// extinction times colour added up, where nothing hides what lies behind (emission without absorption, Max 1995): an
/// X-ray's picture. Its opacity is the integral of extinction, 1 at most.
enum class Mode { dvr, iso, mip, minip, mean, additive };
/// Whether samples are lit. A value of a whole ray has no place that could be, and light that adds up is emitted.
constexpr bool is_lit(Mode mode) { return mode == Mode::dvr || mode == Mode::iso; }

/// A surface of one value. At most `max_isosurfaces` at a time.
struct IsoSurface {
    double value = 0;          ///< in data units
    std::optional<Rgb> color;  ///< sRGB, as picked; missing: the transfer function's at `value`
    double opacity = 1;        ///< [0, 1], of the surface as a whole
    bool operator==(const IsoSurface&) const = default;
};
inline constexpr int max_isosurfaces = 8;

/// Removes what lies beyond the plane n · x = d, on the side that n points to.
struct ClipPlane {
    Vec3 normal{0, 0, 1};  ///< world; any length but 0
    double d = 0;          ///< of x in world mm, times the normal's length
    bool operator==(const ClipPlane&) const = default;
};
inline constexpr int max_clip_planes = 6;

/// What is cut away; it casts no shadow either.
struct Clip {
    std::optional<std::array<double, 6>> box;  ///< x0, x1, y0, y1, z0, z1: kept part, as fractions of [0, n - 1]
    std::vector<ClipPlane> planes;             ///< at most `max_clip_planes`
    bool largest =
        false;  ///< keeps only the largest piece of voxels of opacity >= .1, connected by faces, after clipping
    bool operator==(const Clip&) const = default;
};

/// How values are found between voxels: linearly; by a cubic B-spline that interpolates the voxels, or with the voxels
/// as its coefficients, so that it smooths them (Sigg and Hadwiger 2005; Ruijters et al. 2008). By texture: linearly,
/// where a GPU casts the rays by its texture units, whose weights have 8 fractional bits: each is off by up to 1/256, a
/// value by up to 3/256 of what the eight voxels around it span; a CPU is always exact, and so are paths. Automatic:
/// what interpolation_for finds; a shape that is classified with it is linear.
enum class Interpolation { automatic, linear, cubic, smooth, texture };
/// Noise above which it smooths, over the range (Statistics::noise).
inline constexpr double worth_smoothing = 0.015;

/// What of the classified volume is rendered, and how.
struct Shape {
    Mode mode = Mode::dvr;
    std::vector<IsoSurface> iso;  ///< for Mode::iso, at least one
    Clip clip;
    double threshold_low = -std::numeric_limits<double>::infinity();  ///< values outside are transparent
    double threshold_high = std::numeric_limits<double>::infinity();
    double opacity_scale = 1;  ///< multiplies the extinction
    ColorMode color = ColorMode::linear;
    Interpolation interpolation = Interpolation::linear;
    bool operator==(const Shape&) const = default;
};

/// The optical table of a transfer function over a volume, and which of its cells are occupied. Cheap to copy.
class Medium {
public:
    struct Data;  // src/classify/medium.h
    Medium() = default;
    explicit Medium(std::shared_ptr<const Data> data) : data_(std::move(data)) {}
    const Data& data() const { return *data_; }
    explicit operator bool() const { return data_ != nullptr; }

    /// Share of the 4³ occupied cells.
    CHIARO_EXPORT double occupied_fraction() const;

private:
    std::shared_ptr<const Data> data_;
};

/// Cost: the table (some thousand exponentials), one test and 26 comparisons per 4³ cell: some 20 core-ms at 512³.
/// `Clip::largest` costs some 30 core-ns a voxel more, and a copy of the bricks as long as the medium lives.
/// A spline costs some 20 core-ns a voxel when first asked for, and the bricks once more as long as the volume lives.
/// Throws Error{input} for a transfer function that `validate` refuses, Error{usage} for a shape that shows nothing (a
/// clip box without inside, no isosurface) or too much (more isosurfaces or planes than there is room for).
CHIARO_EXPORT Medium classify(const DeviceVolume& volume, const TransferFunction& tf, const Shape& shape);
/// The same by another device than the volume's: of sessions that share a volume each has its own
/// (Device::with_own_stream).
CHIARO_EXPORT Medium classify(const Device& device, const DeviceVolume& volume, const TransferFunction& tf,
                              const Shape& shape);
/// The same. Throws Error{interrupted} when cancelled.
CHIARO_EXPORT Medium classify(const Device& device, const DeviceVolume& volume, const TransferFunction& tf,
                              const Shape& shape, const Progress& progress);

inline constexpr int max_channels = 8;
/// One of several values of a voxel, and how it looks.
struct Channel {
    DeviceVolume volume;
    TransferFunction transfer;
    double gain = 1;  ///< >= 0: multiplies its extinction; in maxima, minima and means its colour. 0: hidden
};
/// Several channels as one medium: extinctions add, colours are means weighted by extinction (albedos are limited after
/// that), a ray that looks for one value finds one of each channel, and they add up. The order of channels does not
/// change a bit; those of gain 0 are as if they were not given, and one alone is as if it were given without channels
/// and `Shape::opacity_scale` times its gain. A threshold holds for every channel's values. All must be of one grid and
/// one stored type (`alike`). Cost: `classify` of each.
/// Throws Error{usage} for more than `max_channels`, and for what is of one value: isosurfaces, `Clip::largest`.
CHIARO_EXPORT Medium classify(const Device& device, const std::vector<Channel>& channels, const Shape& shape,
                              const Progress& progress = Progress());
/// A volume in its own colours: extinction by one value and a transfer function, whose colours are not looked at, and
/// colours as red, green and blue have them, which are sRGB from 0 to `white`. All on one grid, in one stored type.
struct OwnColors {
    DeviceVolume opacity;
    TransferFunction transfer;
    std::array<DeviceVolume, 3> rgb;
    double white = 255;  ///< data units
    /// In the place of rgb a value that has colours by a function of its own, whose opacities are not looked at.
    DeviceVolume value{};
    TransferFunction colors{};
};
/// Of whole rays (maxima, minima, means) that of red, of green and of blue, added up. Cost: `classify` of each.
/// Throws Error{usage} for isosurfaces and `Clip::largest`.
CHIARO_EXPORT Medium classify(const Device& device, const OwnColors& own, const Shape& shape,
                              const Progress& progress = Progress());
/// Volumes of one grid as channels: stored in the widest type that one of them is in. Cost: nothing where they are
/// alike, else a pass over the bricks. Throws Error{input} where their grids differ.
CHIARO_EXPORT std::vector<DeviceVolume> alike(const std::vector<DeviceVolume>& volumes);

/// The same medium with values found another way. Throws Error{interrupted} when cancelled.
CHIARO_EXPORT Medium with_interpolation(const Device& device, const Medium& medium, Interpolation interpolation,
                                        const Progress& progress = Progress());

/// What `Interpolation::automatic` stands for in a final picture of a medium: cubic; smooth where `noise` (Statistics)
/// is above `worth_smoothing` and thin structures survive it: of the lines of voxels along x and along z that hold
/// something of an opacity of .1 (of isosurfaces: inside one) at least 98 % still do. Cost: where there is noise, that
/// of smoothing, which is kept with the volume, and some 20 core-ns a voxel.
CHIARO_EXPORT Interpolation interpolation_for(const Medium& medium, double noise,
                                              const Progress& progress = Progress());

}  // namespace chiaro

// From a frame of radiance to an image file.
#pragma once
#include <chiaro/export.h>
#include <chiaro/medium.h>
#include <chiaro/progress.h>
#include <chiaro/settings.h>
#include <chiaro/slice.h>
#include <chiaro/transfer_function.h>

#include <cstdint>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace chiaro {

/// What the ray caster fills: float RGBA, premultiplied, row 0 on top; linear light unless ColorMode is display.
struct Frame {
    int width = 0, height = 0;
    std::vector<float> rgba;
    /// Of each pixel, where find_depth was asked for it, else empty: how far along the ray through its centre half of
    /// its opacity is reached; infinity where it never is.
    std::vector<float> depth_mm;

    Frame() = default;
    Frame(int width, int height) : width(width), height(height), rgba(std::size_t(4) * width * height) {}
};

namespace cuda {
class Pixels;  // src/cuda/pixels.h
}

/// A frame on the device that made it: a GPU keeps its pixels for `develop` until the host reads them. To move, not to
/// copy: copies would share what the GPU holds.
class DeviceFrame {
public:
    DeviceFrame() = default;
    DeviceFrame(int width, int height) : frame_(width, height) {}
    DeviceFrame(DeviceFrame&&) = default;
    DeviceFrame& operator=(DeviceFrame&&) = default;

    int width() const { return frame_.width; }
    int height() const { return frame_.height; }
    /// Nothing happens where it has that size.
    void resize(int width, int height) {
        if (width != frame_.width || height != frame_.height) *this = DeviceFrame(width, height);
    }
    /// The host's, brought from the GPU (16 bytes a pixel) when first asked for. Throws Error{output} for a GPU that
    /// was lost.
    CHIARO_EXPORT const Frame& read() const;
    /// The host's, to be filled: what a GPU holds is let go of.
    CHIARO_EXPORT Frame& write();

    const std::shared_ptr<cuda::Pixels>& on_gpu() const { return on_gpu_; }  ///< none: the host has them
    void keep_on_gpu(std::shared_ptr<cuda::Pixels> pixels) { on_gpu_ = std::move(pixels); }

private:
    mutable Frame frame_;
    mutable std::shared_ptr<cuda::Pixels> on_gpu_;
};

/// 8 bit sRGB, row 0 on top, straight alpha.
struct Image {
    int width = 0, height = 0;
    bool has_alpha = false;
    std::vector<std::uint8_t> pixels;  ///< RGBA, or RGB without alpha
};

enum class Tone { none, aces };

struct ToneMap {
    Rgb background{0, 0, 0};   ///< sRGB, as picked
    bool transparent = false;  ///< keep alpha instead of the background
    ColorMode color = ColorMode::linear;
    Tone tone = Tone::none;     ///< aces: the film curve of Narkowicz 2015
    double exposure_stops = 0;  ///< light is multiplied by 2^stops
    bool operator==(const ToneMap&) const = default;
};

/// Tone mapping: multiplies by the exposure, applies the tone curve, composites over the background, encodes to sRGB
/// (ColorMode::linear) and rounds to 8 bits. The curve bends the volume's straight colour: coverage stays as it is, the
/// background is shown as picked, and over any background a transparent picture looks as if made for it.
/// With ColorMode::display exposure and curve apply to the display values as they are.
CHIARO_EXPORT Image develop(const Frame& frame, const ToneMap& tone);
/// The same, on the GPU that holds the frame: 3 or 4 bytes a pixel come back.
CHIARO_EXPORT Image develop(const DeviceFrame& frame, const ToneMap& tone);

/// What a slice's values look like.
struct SliceTone {
    double low = 0, high = 255;                                   ///< black and white, in data units
    std::optional<TransferFunction> colors;                       ///< laid over the grey
    double shown_low = -std::numeric_limits<double>::infinity();  ///< values outside keep the grey alone
    double shown_high = std::numeric_limits<double>::infinity();
};

/// 8 bit: round(255 (value - low) / (high - low)), the grey levels as they are, without a tone curve. Colours lie over
/// it, each with the share that its opacity is of the function's largest one. Outside of the volume black. Throws
/// Error{usage} for a window without width, and as `validate`.
CHIARO_EXPORT Image develop(const Slice& slice, const SliceTone& tone);

/// One of several channels in a slice.
struct SliceChannel {
    Slice slice;
    double low = 0, high = 255;  ///< black, and the channel's full colour, in data units
    Rgb color{1, 1, 1};          ///< sRGB
};
/// 8 bit: Σ color (value - low) / (high - low), each share limited to [0, 1] before and the sum after, as fluorescence
/// is shown. Outside of the volume black. Throws Error{usage} for a window without width or slices of several sizes.
CHIARO_EXPORT Image develop(const std::vector<SliceChannel>& channels);
/// Lays the colours of labels over a slice's picture: each pixel's by `opacity` times its label's tint, and on the
/// borders between labels, one pixel wide, by the tint alone. Labels that are not shown leave the picture as it is.
/// `numbers` are those of slice(labels), `looks` the labels in their order. Throws Error{usage} for sizes that differ.
CHIARO_EXPORT void lay_over(Image& image, const std::vector<std::uint16_t>& numbers, const std::vector<Label>& looks,
                            double opacity);

/// The frame with its light multiplied by the exposure: what an .exr holds. Neither tone curve nor background. With
/// `progress`, Error{interrupted} when cancelled.
CHIARO_EXPORT Frame expose(const Frame& frame, const ToneMap& tone, const Progress* progress = nullptr);

/// Key and text pairs that go into a PNG (tEXt/iTXt) or an OpenEXR header (string attributes).
using Metadata = std::vector<std::pair<std::string, std::string>>;

/// A PNG file's bytes: 8 bit RGB or RGBA with an sRGB chunk; each text as tEXt where it is ASCII, else as iTXt. Throws
/// Error{output} for an image without pixels or a keyword that PNG does not allow (1..79 printable ASCII characters).
/// With `progress`, Error{interrupted} when cancelled.
CHIARO_EXPORT std::vector<std::byte> encode_png(const Image& image, const Metadata& metadata = {},
                                                const Progress* progress = nullptr);
/// Written whole or not at all. Throws Error{output}, and Error{interrupted} as encode_png.
CHIARO_EXPORT void write_png(const Image& image, const std::filesystem::path& path, const Metadata& metadata = {},
                             const Progress* progress = nullptr);
/// 8 bit RGB or RGBA from any PNG of at most 100 megapixels. Throws Error{input}.
CHIARO_EXPORT Image read_png(const std::filesystem::path& path);
/// The texts that a PNG carries. Throws Error{input}.
CHIARO_EXPORT Metadata read_png_metadata(const std::filesystem::path& path);

/// OpenEXR: float RGBA, premultiplied, linear light (Rec. 709 primaries), lossless. Written whole or not at all. Throws
/// Error{output}, and Error{interrupted} as encode_png.
CHIARO_EXPORT void write_exr(const Frame& frame, const std::filesystem::path& path, const Metadata& metadata = {},
                             const Progress* progress = nullptr);
/// The data window of an OpenEXR file of at most 100 megapixels with channels R, G and B, and A (else 1), half or
/// float. Throws Error{input}.
CHIARO_EXPORT Frame read_exr(const std::filesystem::path& path);
/// The texts in the header of an OpenEXR file. Throws Error{input}.
CHIARO_EXPORT Metadata read_exr_metadata(const std::filesystem::path& path);

}  // namespace chiaro

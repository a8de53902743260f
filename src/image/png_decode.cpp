#include <chiaro/error.h>
#include <png.h>

#include <algorithm>
#include <csetjmp>
#include <cstring>

#include "image/max_pixels.h"
#include "image/png.h"

namespace chiaro {
namespace {

/// See png_encode.cpp for why failures travel by libpng's own longjmp.
struct PngInput {
    std::span<const std::byte> left;
    char message[128] = "";
};

void take(png_structp png, png_bytep data, png_size_t size) {
    auto& left = static_cast<PngInput*>(png_get_io_ptr(png))->left;
    if (size > left.size()) png_error(png, "the file ends too early");
    std::memcpy(data, left.data(), size);
    left = left.subspan(size);
}

/// Whether every chunk ends within the file: libpng clears as much memory as a chunk states before it reads it.
bool chunks_fit(std::span<const std::byte> bytes) {
    constexpr std::size_t signature = 8, around = 12;  // length, name, checksum
    for (std::size_t at = signature; at + around <= bytes.size();) {
        const std::size_t length = png_get_uint_32(reinterpret_cast<png_const_bytep>(bytes.data() + at));
        if (length > bytes.size() - at - around) return false;
        if (std::memcmp(bytes.data() + at + 4, "IEND", 4) == 0) return true;  // what follows is nobody's
        at += length + around;
    }
    return true;
}

void on_read_error(png_structp png, png_const_charp message) {
    auto* input = static_cast<PngInput*>(png_get_error_ptr(png));
    std::snprintf(input->message, sizeof input->message, "%s", message);
    png_longjmp(png, 1);
}

void ignore_read_warning(png_structp, png_const_charp) {}

/// Everything becomes 8 bit RGB, or RGBA where there is transparency.
bool read_header(png_structp png, png_infop info, std::size_t file_bytes) {
    if (setjmp(png_jmpbuf(png))) return false;
    png_read_info(png, info);
    constexpr std::uint64_t largest_deflate_ratio = 1032;  // so that nothing is made room for in vain
    if (std::uint64_t(png_get_rowbytes(png, info)) * png_get_image_height(png, info) / largest_deflate_ratio >
        file_bytes)
        png_error(png, "the file is too short for its pixels");
    if (std::uint64_t(png_get_image_width(png, info)) * png_get_image_height(png, info) > std::uint64_t(max_pixels))
        png_error(png, "more than 100 megapixels");
    png_set_expand(png);
    png_set_scale_16(png);
    png_set_gray_to_rgb(png);
    png_set_interlace_handling(png);
    png_read_update_info(png, info);
    return true;
}

bool read_rows(png_structp png, png_infop info, png_bytepp rows) {
    if (setjmp(png_jmpbuf(png))) return false;
    png_read_image(png, rows);
    png_read_end(png, info);
    return true;
}

Metadata read_texts(png_structp png, png_infop info) {
    png_textp texts = nullptr;
    const int count = png_get_text(png, info, &texts, nullptr);
    Metadata metadata;
    for (int i = 0; i < count; ++i) {
        const bool international = texts[i].compression >= PNG_ITXT_COMPRESSION_NONE;
        const std::size_t length = international ? texts[i].itxt_length : texts[i].text_length;
        metadata.emplace_back(texts[i].key, texts[i].text ? std::string(texts[i].text, length) : "");
    }
    return metadata;
}

bool decode(png_structp png, png_infop info, std::size_t file_bytes, DecodedPng& result) {
    if (!read_header(png, info, file_bytes)) return false;
    Image& image = result.image;
    image.width = int(png_get_image_width(png, info));
    image.height = int(png_get_image_height(png, info));
    image.has_alpha = png_get_channels(png, info) == 4;
    const std::size_t stride = png_get_rowbytes(png, info);
    image.pixels.resize(stride * image.height);
    std::vector<png_bytep> rows(image.height);
    for (int y = 0; y < image.height; ++y) rows[y] = image.pixels.data() + y * stride;
    if (!read_rows(png, info, rows.data())) return false;
    result.metadata = read_texts(png, info);
    return true;
}

}  // namespace

DecodedPng decode_png(std::span<const std::byte> bytes, const std::string& origin) {
    if (png_sig_cmp(reinterpret_cast<png_const_bytep>(bytes.data()), 0, std::min<std::size_t>(8, bytes.size())) != 0 ||
        bytes.size() < 8)
        throw Error(ErrorCode::input, origin + ": is not a PNG file");
    if (!chunks_fit(bytes)) throw Error(ErrorCode::input, origin + ": is a broken PNG file: the file ends too early");
    PngInput input{bytes};
    png_structp png = png_create_read_struct(PNG_LIBPNG_VER_STRING, &input, on_read_error, ignore_read_warning);
    png_infop info = png ? png_create_info_struct(png) : nullptr;
    if (png) png_set_read_fn(png, &input, take);
    DecodedPng result;
    bool done = false;
    try {
        done = info && decode(png, info, bytes.size(), result);
    } catch (const std::bad_alloc&) {
    }
    png_destroy_read_struct(&png, &info, nullptr);
    if (!done)
        throw Error(ErrorCode::input,
                    origin + ": is a broken PNG file: " + (input.message[0] ? input.message : "not enough memory"));
    return result;
}

}  // namespace chiaro

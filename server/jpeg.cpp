#include "jpeg.h"

#include <chiaro/error.h>

#include <cstddef>
#include <cstdio>  // which jpeglib.h needs and does not include
#include <memory>
#include <stdexcept>
#include <vector>

#include <jpeglib.h>

namespace chiaro::server {
namespace {

[[noreturn]] void fail(j_common_ptr) { throw Error(ErrorCode::output, "the picture cannot be encoded as JPEG"); }

/// The library's object, ended whatever happens.
struct Encoder {
    jpeg_compress_struct state;
    jpeg_error_mgr errors;
    unsigned char* bytes = nullptr;
    unsigned long size = 0;

    Encoder() {
        state.err = jpeg_std_error(&errors);
        errors.error_exit = fail;
        jpeg_create_compress(&state);
        jpeg_mem_dest(&state, &bytes, &size);
    }
    ~Encoder() {
        jpeg_destroy_compress(&state);
        std::free(bytes);
    }
    Encoder(const Encoder&) = delete;
};

/// Straight RGBA over black.
void over_black(const std::uint8_t* rgba, int width, std::vector<std::uint8_t>& rgb) {
    for (int x = 0; x < width; ++x)
        for (int c = 0; c < 3; ++c)
            rgb[std::size_t(3 * x + c)] = std::uint8_t((rgba[4 * x + c] * rgba[4 * x + 3] + 127) / 255);
}

}  // namespace

std::string encode_jpeg(const Image& image, int quality) {
    Encoder encoder;
    jpeg_compress_struct& state = encoder.state;
    state.image_width = JDIMENSION(image.width), state.image_height = JDIMENSION(image.height);
    state.input_components = 3, state.in_color_space = JCS_RGB;
    jpeg_set_defaults(&state);
    jpeg_set_quality(&state, quality, TRUE);
    state.dct_method = JDCT_IFAST;
    jpeg_start_compress(&state, TRUE);
    const std::size_t channels = image.has_alpha ? 4 : 3;
    std::vector<std::uint8_t> row(std::size_t(3) * image.width);
    for (int y = 0; y < image.height; ++y) {
        const std::uint8_t* line = image.pixels.data() + channels * image.width * std::size_t(y);
        if (image.has_alpha) over_black(line, image.width, row);
        JSAMPROW samples = const_cast<JSAMPROW>(image.has_alpha ? row.data() : line);
        jpeg_write_scanlines(&state, &samples, 1);
    }
    jpeg_finish_compress(&state);
    return {reinterpret_cast<const char*>(encoder.bytes), encoder.size};
}

}  // namespace chiaro::server

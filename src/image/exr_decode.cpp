#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfInputPart.h>
#include <ImfMultiPartInputFile.h>
#include <ImfStringAttribute.h>
#include <ImfTileDescription.h>
#include <chiaro/error.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <stdexcept>

#include "core/text.h"
#include "image/exr.h"
#include "image/max_pixels.h"

namespace chiaro {
namespace {

constexpr int read_threads = 0;

class ExrInput : public Imf::IStream {
public:
    explicit ExrInput(std::span<const std::byte> bytes) : IStream("memory"), bytes_(bytes) {}

    bool read(char* data, int count) override {
        if (count < 0 || position_ > bytes_.size() || std::size_t(count) > bytes_.size() - position_)
            throw std::runtime_error("the file ends too early");
        std::memcpy(data, bytes_.data() + position_, std::size_t(count));
        position_ += std::size_t(count);
        return position_ < bytes_.size();
    }
    std::uint64_t tellg() override { return position_; }
    void seekg(std::uint64_t position) override { position_ = position; }

private:
    std::span<const std::byte> bytes_;
    std::uint64_t position_ = 0;
};

std::int64_t pixels_of(const Imath::Box2i& box) {
    return (std::int64_t(box.max.x) - box.min.x + 1) * (std::int64_t(box.max.y) - box.min.y + 1);
}

/// Before anything is allocated for what the header claims. No picture, not even a black one, is packed so densely.
void check_claims(const Imf::Header& header, std::size_t file_bytes) {
    constexpr std::int64_t densest = 4096;  // pixels to a byte
    const std::int64_t pixels = pixels_of(header.dataWindow());
    if (pixels > max_pixels) throw std::runtime_error("more than 100 megapixels");
    if (pixels / densest > std::int64_t(file_bytes)) throw std::runtime_error("the file is too short for its pixels");
    if (header.hasTileDescription()) {
        const Imf::TileDescription& tile = header.tileDescription();
        if (std::uint64_t(tile.xSize) * tile.ySize > std::uint64_t(max_pixels))
            throw std::runtime_error("tiles of more than 100 megapixels");
    }
    for (const char* name : {"R", "G", "B"})
        if (!header.channels().findChannel(name)) throw std::runtime_error(std::string("no channel ") + name);
}

/// What headers claim, before OpenEXR makes room for it: the bytes of each attribute, and for each chunk of pixels
/// eight bytes in the table of offsets. A header: name\0 type\0 bytes value, ..., \0; of several parts, until an empty
/// one.
class Claims {
public:
    explicit Claims(std::span<const std::byte> bytes) : bytes_(bytes) {}

    void check() {
        constexpr std::uint32_t of_parts = 0x1000;
        const bool has_parts = number(4) & of_parts;
        at_ = 8;
        std::uint64_t chunks = 0;
        for (bool more = true; more;) {
            const bool is_empty = at_ < bytes_.size() && bytes_[at_] == std::byte(0);
            has_window_ = is_empty;
            chunks += chunks_of_header();
            if (!has_window_) throw std::runtime_error("no data window");  // hidden in an attribute of a wrong size
            more = has_parts && !is_empty;
        }
        if (chunks > bytes_.size() / 8) end_too_early();
        constexpr std::uint32_t more_than_rows = 0x1a00;  // tiles, deep data or parts
        if ((number(4) & more_than_rows) == 0) check_rows();
    }

private:
    [[noreturn]] static void end_too_early() { throw std::runtime_error("the file ends too early"); }

    std::uint32_t number(std::size_t at) const {
        std::uint32_t number = 0;
        if (bytes_.size() < sizeof number || at > bytes_.size() - sizeof number) end_too_early();
        std::memcpy(&number, bytes_.data() + at, sizeof number);
        return number;
    }
    std::string text() {
        std::string text;
        while (at_ < bytes_.size() && bytes_[at_] != std::byte(0)) text += char(bytes_[at_++]);
        if (at_++ >= bytes_.size()) end_too_early();
        return text;
    }

    /// Behind the header of rows without tiles, the table of offsets; at each: the first row, the bytes, the pixels.
    void check_rows() const {
        constexpr std::array<std::uint64_t, 10> rows_by_compression{1, 1, 1, 16, 32, 16, 32, 32, 32, 256};
        if (compression_ >= rows_by_compression.size()) return;
        const std::uint64_t rows = rows_by_compression[compression_], chunks = (height_ + rows - 1) / rows;
        for (std::uint64_t i = 0; i < chunks; ++i) {
            const std::uint64_t chunk = number(at_ + 8 * i) + (std::uint64_t(number(at_ + 8 * i + 4)) << 32);
            if (chunk > bytes_.size() || number(chunk + 4) > bytes_.size() - chunk - 8) end_too_early();
        }
    }

    std::uint64_t chunks_of_header() {
        std::uint64_t width = 0, height = 0, chunk_width = 0, chunk_height = max_chunk_rows;
        for (std::string name; !(name = text()).empty();) {
            text();  // its type
            const std::uint32_t size = number(at_);
            at_ += sizeof size;
            if (size > bytes_.size() - at_) end_too_early();
            if (name == "dataWindow" && size == 16) {
                has_window_ = true;
                width = extent(number(at_), number(at_ + 8));
                height = extent(number(at_ + 4), number(at_ + 12));
            }
            if (name == "compression" && size == 1) compression_ = std::size_t(bytes_[at_]);
            if (name == "tiles" && size == 9) chunk_width = number(at_), chunk_height = number(at_ + 4);
            at_ += size;
        }
        height_ = height;
        if (chunk_width == 0) chunk_width = std::max<std::uint64_t>(width, 1);  // rows
        return width / chunk_width * (height / std::max<std::uint64_t>(chunk_height, 1));
    }
    static std::uint64_t extent(std::uint32_t first, std::uint32_t last) {
        return std::uint64_t(std::max<std::int64_t>(0, std::int64_t(std::int32_t(last)) - std::int32_t(first) + 1));
    }

    static constexpr std::uint64_t max_chunk_rows = 256;  ///< of a chunk, whatever the compression
    std::span<const std::byte> bytes_;
    std::size_t at_ = 0, compression_ = 0;
    std::uint64_t height_ = 0;  ///< of the part looked at last
    bool has_window_ = false;
};

Frame read_frame(Imf::MultiPartInputFile& file, std::size_t file_bytes) {
    const Imf::Header& header = file.header(0);
    check_claims(header, file_bytes);
    const Imath::Box2i window = header.dataWindow();
    Frame frame(window.max.x - window.min.x + 1, window.max.y - window.min.y + 1);
    const std::size_t pixel = 4 * sizeof(float), row = pixel * frame.width;
    Imf::FrameBuffer buffer;
    for (int c = 0; c < 4; ++c) {
        const char name[] = {"RGBA"[c], 0};
        char* first = reinterpret_cast<char*>(frame.rgba.data() + c);
        const double absent = c == 3 ? 1 : 0;
        buffer.insert(name, Imf::Slice::Make(Imf::FLOAT, first, window, pixel, row, 1, 1, absent));
    }
    Imf::InputPart part(file, 0);
    part.setFrameBuffer(buffer);
    part.readPixels(window.min.y, window.max.y);
    return frame;
}

Metadata read_texts(const Imf::Header& header) {
    Metadata metadata;
    for (auto attribute = header.begin(); attribute != header.end(); ++attribute)
        if (const auto* text = dynamic_cast<const Imf::StringAttribute*>(&attribute.attribute());
            text && std::strcmp(attribute.name(), "type") != 0)  // which OpenEXR adds: scanlineimage
            metadata.emplace_back(attribute.name(), text->value());
    return metadata;
}

/// Hands `use` the opened file, and makes one sentence of whatever OpenEXR throws.
template <class Use>
auto with_file(std::span<const std::byte> bytes, const std::string& origin, const Use& use) {
    if (!is_exr(bytes)) throw Error(ErrorCode::input, origin + ": is not an OpenEXR file");
    try {
        Claims(bytes).check();
        ExrInput memory(bytes);
        Imf::MultiPartInputFile file(memory, read_threads, false);  // false: a table of offsets that is cut is an error
        return use(file);
    } catch (const std::bad_alloc&) {
        throw Error(ErrorCode::input, origin + ": is a broken OpenEXR file: not enough memory");
    } catch (const std::exception& error) {
        throw Error(ErrorCode::input, origin + ": is a broken OpenEXR file: " + one_line(error.what()));
    }
}

}  // namespace

bool is_exr(std::span<const std::byte> bytes) {
    constexpr unsigned char magic[] = {0x76, 0x2f, 0x31, 0x01};
    return bytes.size() >= sizeof magic && std::memcmp(bytes.data(), magic, sizeof magic) == 0;
}

DecodedExr decode_exr(std::span<const std::byte> bytes, const std::string& origin) {
    return with_file(bytes, origin, [&](Imf::MultiPartInputFile& file) {
        return DecodedExr{read_frame(file, bytes.size()), read_texts(file.header(0))};
    });
}

Metadata decode_exr_metadata(std::span<const std::byte> bytes, const std::string& origin) {
    return with_file(bytes, origin, [](Imf::MultiPartInputFile& file) { return read_texts(file.header(0)); });
}

}  // namespace chiaro

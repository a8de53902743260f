#include <chiaro/error.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <string_view>

#include "image/hdr.h"
#include "image/max_pixels.h"

namespace chiaro {
namespace {

constexpr int longest_side = 65536;
using Rgbe = std::array<std::uint8_t, 4>;

/// Takes the file apart from its start; whatever is missing is an error.
class HdrInput {
public:
    HdrInput(std::span<const std::byte> bytes, const std::string& origin) : left_(bytes), origin_(origin) {}

    [[noreturn]] void refuse(const std::string& why) const {
        throw Error(ErrorCode::input, origin_ + ": is a broken Radiance picture: " + why);
    }
    void need(std::size_t count) const {
        if (left_.size() < count) refuse("the file ends too early");
    }
    void end() const {
        if (!left_.empty()) refuse("there are " + std::to_string(left_.size()) + " bytes behind its last row");
    }
    std::uint8_t byte() {
        need(1);
        const auto value = std::uint8_t(left_[0]);
        left_ = left_.subspan(1);
        return value;
    }
    Rgbe peek() const {
        need(4);
        return {std::uint8_t(left_[0]), std::uint8_t(left_[1]), std::uint8_t(left_[2]), std::uint8_t(left_[3])};
    }
    Rgbe pixel() {
        const Rgbe value = peek();
        left_ = left_.subspan(4);
        return value;
    }
    std::string_view line() {
        const std::string_view text(reinterpret_cast<const char*>(left_.data()), left_.size());
        const std::size_t end = text.find('\n');
        if (end == text.npos) refuse("the header does not end");
        left_ = left_.subspan(end + 1);
        return text.substr(0, end);
    }

private:
    std::span<const std::byte> left_;
    const std::string& origin_;
};

struct Size {
    int width = 0, height = 0;
};

/// "-Y 512 +X 1024"
Size read_size(HdrInput& in) {
    std::string_view line = in.line();
    if (!line.starts_with("-Y ") || line.find(" +X ") == line.npos)
        in.refuse("it does not begin at the top left, with -Y HEIGHT +X WIDTH");
    const auto number_behind = [&](std::string_view name) {
        int value = 0;
        const bool is_there = line.starts_with(name);
        line.remove_prefix(is_there ? name.size() : 0);
        const auto [end, error] = std::from_chars(line.data(), line.data() + line.size(), value);
        if (!is_there || error != std::errc() || value < 1) in.refuse("its size cannot be read");
        line.remove_prefix(std::size_t(end - line.data()));
        return value;
    };
    Size size;
    size.height = number_behind("-Y ");
    size.width = number_behind(" +X ");
    if (line.find_first_not_of(" \r") != line.npos) in.refuse("its size cannot be read");
    if (std::int64_t(size.width) * size.height > max_pixels) in.refuse("more than 100 megapixels");
    if (std::max(size.width, size.height) > longest_side) in.refuse("more than 65536 pixels a side");
    return size;
}

Size read_header(HdrInput& in) {
    in.line();  // #?RADIANCE
    for (std::string_view line = in.line(); !line.empty() && line != "\r"; line = in.line())
        if (line.starts_with("FORMAT=") && !line.starts_with("FORMAT=32-bit_rle_rgbe"))
            in.refuse("its format is not 32-bit_rle_rgbe");
    return read_size(in);
}

bool is_run_length_coded(const Rgbe& start, int width) {
    return width >= 8 && width < 32768 && start[0] == 2 && start[1] == 2 && start[2] * 256 + start[3] == width;
}

/// Each component by itself: a count above 128 is a run of one value, any other so many values.
void read_coded_row(HdrInput& in, std::vector<Rgbe>& row) {
    in.pixel();
    for (std::size_t component = 0; component < 4; ++component)
        for (std::size_t x = 0; x < row.size();) {
            const int code = in.byte(), count = code > 128 ? code - 128 : code;
            if (count == 0 || std::size_t(count) > row.size() - x) in.refuse("a run does not fit its row");
            const std::uint8_t repeated = code > 128 ? in.byte() : std::uint8_t(0);
            for (int k = 0; k < count; ++k) row[x++][component] = code > 128 ? repeated : in.byte();
        }
}

/// Pixels as they are; 1, 1, 1, n repeats the one before n times, and right after another repeat 256 times as often.
void read_plain_row(HdrInput& in, std::vector<Rgbe>& row) {
    int shift = 0;
    for (std::size_t x = 0; x < row.size();) {
        const Rgbe pixel = in.pixel();
        if (pixel[0] != 1 || pixel[1] != 1 || pixel[2] != 1) {
            row[x++] = pixel;
            shift = 0;
            continue;
        }
        const std::size_t count = shift < 24 ? std::size_t(pixel[3]) << shift : row.size();
        if (x == 0 || count > row.size() - x) in.refuse("a run does not fit its row");
        for (std::size_t k = 0; k < count; ++k, ++x) row[x] = row[x - 1];
        shift += 8;
    }
}

}  // namespace

bool is_hdr(std::span<const std::byte> bytes) {
    return bytes.size() > 2 && bytes[0] == std::byte{'#'} && bytes[1] == std::byte{'?'};
}

Probe decode_hdr(std::span<const std::byte> bytes, const std::string& origin) {
    HdrInput in(bytes, origin);
    const auto [width, height] = read_header(in);
    std::array<float, 256> scale{};
    for (int exponent = 1; exponent < 256; ++exponent) scale[exponent] = std::ldexp(1.0f, exponent - 136);
    std::vector<Rgbe> row(width);
    std::vector<float> rgb;  // grows with what the file really holds
    for (int y = 0; y < height; ++y) {
        is_run_length_coded(in.peek(), width) ? read_coded_row(in, row) : read_plain_row(in, row);
        for (const Rgbe& pixel : row)
            for (int c = 0; c < 3; ++c) rgb.push_back(float(pixel[c]) * scale[pixel[3]]);
    }
    in.end();
    return Probe(width, height, std::move(rgb));
}

}  // namespace chiaro

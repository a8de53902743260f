#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfOutputFile.h>
#include <ImfStringAttribute.h>
#include <chiaro/error.h>

#include <algorithm>
#include <cstring>

#include "image/exr.h"

namespace chiaro {
namespace {

/// OpenEXR comes back to fill in its table of offsets, so this is no mere list that grows.
class ExrOutput : public Imf::OStream {
public:
    ExrOutput() : OStream("memory") {}

    void write(const char* data, int count) override {
        bytes.resize(std::max(bytes.size(), position_ + count));
        std::memcpy(bytes.data() + position_, data, std::size_t(count));
        position_ += std::size_t(count);
    }
    std::uint64_t tellp() override { return position_; }
    void seekp(std::uint64_t position) override { position_ = position; }

    std::vector<std::byte> bytes;

private:
    std::size_t position_ = 0;
};

constexpr int write_threads = 0, rows_at_a_time = 64;

}  // namespace

std::vector<std::byte> encode_exr(const Frame& frame, const Metadata& metadata, const Progress* progress) {
    if (frame.width < 1 || frame.height < 1 || frame.rgba.size() != std::size_t(4) * frame.width * frame.height)
        throw Error(ErrorCode::output, "a picture of " + std::to_string(frame.width) + " x " +
                                           std::to_string(frame.height) + " pixels cannot be written as OpenEXR");
    try {
        Imf::Header header(frame.width, frame.height);
        Imf::FrameBuffer buffer;
        char* first = reinterpret_cast<char*>(const_cast<float*>(frame.rgba.data()));  // only read
        for (int c = 0; c < 4; ++c) {
            const char name[] = {"RGBA"[c], 0};
            header.channels().insert(name, Imf::Channel(Imf::FLOAT));
            buffer.insert(name, Imf::Slice(Imf::FLOAT, first + c * sizeof(float), 4 * sizeof(float),
                                           4 * sizeof(float) * frame.width));
        }
        for (const auto& [key, text] : metadata) header.insert(key, Imf::StringAttribute(text));
        ExrOutput memory;
        {
            Imf::OutputFile file(memory, header, write_threads);  // complete when it goes
            file.setFrameBuffer(buffer);
            for (int y = 0; y < frame.height && !(progress && progress->cancelled()); y += rows_at_a_time)
                file.writePixels(std::min(rows_at_a_time, frame.height - y));
        }
        if (!(progress && progress->cancelled())) return std::move(memory.bytes);
    } catch (const std::exception& error) {
        throw Error(ErrorCode::output, std::string("cannot encode OpenEXR: ") + error.what());
    }
    progress->check();
    return {};
}

}  // namespace chiaro

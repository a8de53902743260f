#include "decode/output.h"

#include "io/wire.h"
#include "volume/validate.h"

#include <fmt/format.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <nlohmann/json.hpp>

namespace chiaro::decode {
namespace {

void send(const nlohmann::json& message) {
    // Header texts may be in any encoding; JSON is UTF-8.
    const std::string line = message.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
    for (std::size_t sent = 0; sent < line.size();) {
        const ssize_t n = write(wire::messages_descriptor, line.data() + sent, line.size() - sent);
        if (n <= 0) _exit(1);  // nobody listens any more
        sent += std::size_t(n);
    }
}

}  // namespace

std::uint64_t Output::choose_moment(std::uint64_t count, Volume& volume) const {
    if (std::uint64_t(moment_) >= count)
        refuse(count == 1 ? fmt::format("holds one moment in time, so there is none of number {}", moment_)
                          : fmt::format("holds {} moments in time, 0 to {}: there is none of number {}", count,
                                        count - 1, moment_));
    volume.moments.count = int(std::min<std::uint64_t>(count, std::numeric_limits<int>::max()));
    volume.moments.shown = moment_;
    return std::uint64_t(moment_);
}

void set_even_times(Moments& moments, double first, double step, const std::string& unit) {
    constexpr int most = 10000;
    if (!(std::isfinite(step) && step > 0) || !std::isfinite(first) || moments.count > most) return;
    moments.unit = unit;
    for (int i = 0; i < moments.count; ++i) moments.times.push_back(first + i * step);
}

std::uint64_t Output::checked_room(const Volume& volume) const {
    const std::uint64_t bytes = check_header(volume);
    const auto& n = volume.dimensions;
    if (!asks_for_place() && bytes > max_bytes_)
        throw TooLarge(ErrorCode::input,
                       fmt::format("its {} x {} x {} voxels take {} MiB, but at most {} MiB may be used", n[0], n[1],
                                   n[2], bytes >> 20, max_bytes_ >> 20));
    return bytes;
}

void Output::lie_at(const Volume& volume, VoxelsInFile place) {
    checked_room(volume);
    place_ = std::move(place);
}

void Output::allocate(Volume& volume) {
    const std::uint64_t bytes = checked_room(volume);
    if (asks_for_place()) refuse(not_in_place);
    if (is_aside_) {
        volume.voxels = VoxelBuffer(bytes);
        return;
    }
    if (ftruncate(wire::voxels_descriptor, off_t(bytes)) != 0)
        refuse(fmt::format("no room for {} MiB of voxels", bytes >> 20));
    void* mapping = mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_SHARED, wire::voxels_descriptor, 0);
    if (mapping == MAP_FAILED) refuse(fmt::format("no room for {} MiB of voxels", bytes >> 20));
    volume.voxels = VoxelBuffer::adopt(mapping, bytes, true);
}

bool Output::may_report() {
    const auto now = std::chrono::steady_clock::now();
    if (is_aside_ || now - last_report_ < std::chrono::milliseconds(50)) return false;
    last_report_ = now;
    return true;
}

void Output::progress(double fraction) {
    if (may_report()) send({{"progress", fraction}});
}

void Output::go_on() {
    if (may_report()) send({{"goes_on", true}});
}

void Output::at(const std::string& file) { send({{"at", file}}); }

void Output::succeed(const Volume& volume) {
    nlohmann::json message{{"volume", wire::header_to_json(volume)}};
    if (place_) message["place"] = wire::to_json(*place_);
    send(message);
}

void Output::succeed(const Volume& header, const std::vector<ChunkedLevel>& levels) {
    send({{"volume", wire::header_to_json(header)}, {"levels", wire::to_json(levels)}});
}

void Output::chunk(bool was_written) { send({{"chunk", was_written}}); }

void Output::fail(const std::string& sentence, bool is_too_large) {
    send({{"error", sentence}, {"too_large", is_too_large}});
}

}  // namespace chiaro::decode

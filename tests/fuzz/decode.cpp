#include "decode/readers.h"
#include "fuzz.h"
#include "io/wire.h"
#include "volume/validate.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <nlohmann/json.hpp>

namespace fuzz {

using namespace chiaro;

namespace {

/// Makes `place` the only number of an open file.
void take_place(int descriptor, int place) {
    if (descriptor == place) return;
    dup2(descriptor, place);
    close(descriptor);
}

}  // namespace

void decode(const char* format, const std::uint8_t* data, std::size_t size, const char* ending) {
    const std::string path = file_with(data, size, ending);
    take_place(memfd_create("voxels", 0), wire::voxels_descriptor);
    take_place(open("/dev/null", O_WRONLY), wire::messages_descriptor);
    chiaro::decode::Output output(16 << 20);
    const Volume volume = chiaro::decode::find_reader(format)(path, "", output);
    const std::string line =
        wire::header_to_json(volume).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
    const std::uint64_t bytes = check_header(wire::header_from_json(nlohmann::json::parse(line)));
    const auto& place = output.place();
    const std::uint64_t there = place ? std::filesystem::file_size(place->path) - place->offset : volume.voxels.size();
    if (place ? there < bytes : there != bytes) std::abort();
}

}  // namespace fuzz

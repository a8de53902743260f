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

void decode(const char* format, const std::uint8_t* data, std::size_t size, const char* ending) {
    const std::string path = file_with(data, size, ending);
    const int memory = memfd_create("voxels", 0), nobody = open("/dev/null", O_WRONLY);
    dup2(memory, wire::voxels_descriptor), dup2(nobody, wire::messages_descriptor);
    if (memory != wire::voxels_descriptor) close(memory);
    if (nobody != wire::messages_descriptor) close(nobody);
    chiaro::decode::Output output(16 << 20);
    const Volume volume = chiaro::decode::find_reader(format)(path, "", output);
    const std::string line =
        wire::header_to_json(volume).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
    if (check_header(wire::header_from_json(nlohmann::json::parse(line))) != volume.voxels.size()) std::abort();
}

}  // namespace fuzz

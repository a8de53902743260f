#include "fuzz.h"

#include <fcntl.h>
#include <unistd.h>

namespace fuzz {

std::string file_with(const std::uint8_t* data, std::size_t size, const char* ending) {
    static const std::string name = "/dev/shm/chiaro-fuzz-" + std::to_string(getpid()) + ending;
    static const bool is_removed_at_the_end = std::atexit([] { unlink(name.c_str()); }) == 0;
    (void)is_removed_at_the_end;
    const int file = open(name.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
    if (file < 0 || write(file, data, size) != ssize_t(size)) std::abort();
    close(file);
    return name;
}

}  // namespace fuzz

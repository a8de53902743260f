#include "io/spill.h"

#include <chiaro/error.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cstdlib>

namespace chiaro {

Descriptor make_spill_file(const std::filesystem::path& folder) {
    std::error_code ignored;
    std::filesystem::create_directories(folder, ignored);
    std::string name = (folder / "voxels-XXXXXX").string();
    Descriptor file(mkostemp(name.data(), O_CLOEXEC));
    if (file.number() < 0)
        throw Error(ErrorCode::output,
                    fmt::format("'{}' takes no file for voxels that exceed the memory", folder.string()));
    unlink(name.c_str());
    return moved_up(std::move(file));
}

std::uint64_t free_disk_bytes(const std::filesystem::path& folder) {
    std::error_code error;
    std::filesystem::path there = folder;
    while (!there.empty() && !std::filesystem::exists(there, error) && there != there.parent_path())
        there = there.parent_path();
    const auto space = std::filesystem::space(there, error);
    return error ? 0 : space.available / 10 * 9;
}

VoxelBuffer make_spilled_voxels(const std::filesystem::path& folder, std::uint64_t bytes) {
    const Descriptor file = make_spill_file(folder);
    void* mapping = ftruncate(file.number(), off_t(bytes)) == 0
                        ? mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_SHARED, file.number(), 0)
                        : MAP_FAILED;
    if (mapping == MAP_FAILED)
        throw Error(ErrorCode::output,
                    fmt::format("'{}' has no room for {} MiB of voxels", folder.string(), bytes >> 20));
    return VoxelBuffer::adopt(mapping, bytes, true);
}

}  // namespace chiaro

#include <chiaro/error.h>
#include <chiaro/volume.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <utility>

namespace chiaro {

std::size_t size_of(VoxelType type) {
    return with_voxel_type(type, [](auto voxel) { return sizeof voxel; });
}

std::string_view name_of(VoxelType type) {
    constexpr std::string_view names[] = {"uint8", "int8",   "uint16", "int16",   "uint32",
                                          "int32", "uint64", "int64",  "float32", "float64"};
    return names[int(type)];
}

VoxelBuffer::VoxelBuffer(std::size_t bytes) {
    if (bytes == 0) return;
    void* mapping = mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (mapping == MAP_FAILED)
        throw Error(ErrorCode::output, "not enough memory for " + std::to_string(bytes >> 20) + " MiB of voxels");
    // Bricks are read along rays that cross many pages: large ones save a tenth of an oblique frame. A hint, no more.
    madvise(mapping, bytes, MADV_HUGEPAGE);
    *this = adopt(mapping, bytes, false);
}

VoxelBuffer VoxelBuffer::adopt(void* mapping, std::size_t bytes, bool shared) {
    VoxelBuffer buffer;
    buffer.data_ = static_cast<std::byte*>(mapping);
    buffer.bytes_ = bytes;
    buffer.shared_ = shared;
    return buffer;
}

VoxelBuffer VoxelBuffer::borrow(const void* data, std::size_t bytes, std::shared_ptr<const void> owner) {
    VoxelBuffer buffer;
    buffer.data_ = static_cast<std::byte*>(const_cast<void*>(data));
    buffer.bytes_ = bytes;
    buffer.borrowed_ = true;
    buffer.owner_ = std::move(owner);
    return buffer;
}

VoxelBuffer::VoxelBuffer(VoxelBuffer&& other) noexcept { *this = std::move(other); }

VoxelBuffer& VoxelBuffer::operator=(VoxelBuffer&& other) noexcept {
    std::swap(data_, other.data_);
    std::swap(bytes_, other.bytes_);
    std::swap(discarded_, other.discarded_);
    std::swap(shared_, other.shared_);
    std::swap(borrowed_, other.borrowed_);
    std::swap(owner_, other.owner_);
    return *this;
}

VoxelBuffer::~VoxelBuffer() {
    if (data_ && !borrowed_) munmap(data_, bytes_);
}

void VoxelBuffer::discard(std::size_t begin, std::size_t end) noexcept {
    const std::size_t page = std::size_t(sysconf(_SC_PAGESIZE));
    const std::size_t first = (begin + page - 1) / page * page, last = std::min(end, bytes_) / page * page;
    // Shared pages (of a memfd) live until they are punched out; private ones are simply forgotten.
    if (first < last && !borrowed_) madvise(data_ + first, last - first, shared_ ? MADV_REMOVE : MADV_DONTNEED);
}

void VoxelBuffer::discard_before(std::size_t end) noexcept {
    if (end <= discarded_) return;
    discard(discarded_, end);
    const std::size_t page = std::size_t(sysconf(_SC_PAGESIZE));
    discarded_ = end / page * page;
}

void VoxelBuffer::use_small_pages(std::size_t begin) noexcept {
    const std::size_t page = std::size_t(sysconf(_SC_PAGESIZE)), first = begin / page * page;
    if (first < bytes_ && !borrowed_) madvise(data_ + first, bytes_ - first, MADV_NOHUGEPAGE);
}

Volume make_volume(std::array<int, 3> dimensions, VoxelType type) {
    for (int n : dimensions)
        if (n < 1 || n > 65535)
            throw Error(ErrorCode::input, "a volume of " + std::to_string(dimensions[0]) + " x " +
                                              std::to_string(dimensions[1]) + " x " + std::to_string(dimensions[2]) +
                                              " voxels: every dimension must be in 1..65535");
    Volume volume;
    volume.dimensions = dimensions;
    volume.type = type;
    volume.voxels = VoxelBuffer(volume.voxel_count() * size_of(type));
    return volume;
}

}  // namespace chiaro

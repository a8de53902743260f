// OpenVDB: one grid of floats or doubles, as the box around what is active in it.
#include <dlfcn.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <memory>

#include "decode/byte_source.h"
#include "decode/chunked.h"
#include "decode/limits.h"
#include "decode/readers.h"
#include "decode/vdb_tree.h"
#include "volume/validate.h"

namespace chiaro::decode {
namespace {

/// libopenvdb logs by log4cplus, which starts threads as soon as it is loaded. The filter of system calls holds for the
/// thread that sets it, so the others have to end before. True where they have.
bool end_threads_of_libraries() {
    if (void* end = dlsym(RTLD_DEFAULT, "_ZN9log4cplus18shutdownThreadPoolEv")) reinterpret_cast<void (*)()>(end)();
#if defined(__SANITIZE_THREAD__)  // which has one of its own
    return true;
#else
    constexpr int tries = 1000, pause_us = 1000;
    for (int i = 0; i < tries; ++i) {
        const std::filesystem::directory_iterator tasks("/proc/self/task");
        if (std::distance(begin(tasks), end(tasks)) == 1) return true;
        usleep(pause_us);
    }
    return false;
#endif
}

bool is_alone() {
    static const bool is = end_threads_of_libraries();
    return is;
}

/// A file, open at the tree of the grid that was asked for.
struct OpenVdb {
    VdbStream stream;
    VdbContents contents;
    Volume header;
    VdbPlacement placement;
    VdbGrid grid, owner;            ///< `owner`: of the tree, which another grid may share
    std::uint32_t compression = 0;  ///< of the tree

    OpenVdb(const std::filesystem::path& path, const std::string& part) : stream(path) {
        constexpr std::uint64_t of_libraries = std::uint64_t(64) << 20, largest_ratio = 32;
        limit_own_memory(of_libraries + largest_ratio * stream.size());
        if (!is_alone()) refuse("is not read, as the library for it has started threads that do not end");
        contents = read_contents(stream);
        grid = chosen_grid(contents, part, header);
        placement = read_placement(stream, contents, grid);
        if (placement.is_level_set)
            refuse(
                fmt::format("holds in its grid '{}' a level set, distances to a surface; only grids of values in "
                            "space are read, such as fog volumes",
                            grid.name));
        owner = owner_of_tree(contents, grid);
        compression =
            owner.name == grid.name ? placement.compression : read_placement(stream, contents, owner).compression;
        header.type = grid.type == vdb_double_tree ? VoxelType::f64 : VoxelType::f32;
        header.notes.push_back("states no unit; mm are taken");
    }
};

template <class T>
class VdbVolume {
public:
    VdbVolume(OpenVdb& file) : tree_(file.stream, file.contents.version, file.owner, file.compression) {
        const VdbBox& box = tree_.box();
        if (box.is_empty()) refuse(fmt::format("has a grid '{}' in which no voxel is active", file.grid.name));
        std::array<std::int64_t, 3> size;
        for (std::size_t axis = 0; axis < 3; ++axis) size[axis] = box.last[axis] - box.first[axis] + 1;
        Volume& header = file.header;
        checked_bytes(size, 1, header.type);
        header.dimensions = {int(size[0]), int(size[1]), int(size[2])};
        set_steps(header.geometry, file.placement.steps);
        header.geometry.origin_mm = file.placement.origin;
        for (std::size_t axis = 0; axis < 3; ++axis)
            header.geometry.origin_mm =
                header.geometry.origin_mm + double(box.first[axis]) * file.placement.steps[axis];
        check_header(header);
    }

    VdbTree<T>& tree() { return tree_; }

    /// Part of the box that the volume is, from this voxel of it.
    VdbWindow<T> window(const std::array<std::int64_t, 3>& first, const std::array<int, 3>& size, std::byte* to) const {
        VdbWindow<T> window{tree_.box().first, size, reinterpret_cast<T*>(to)};
        for (std::size_t axis = 0; axis < 3; ++axis) window.first[axis] += first[axis];
        return window;
    }

private:
    VdbTree<T> tree_;
};

template <class T>
void read_all_voxels(OpenVdb& file, Output& output) {
    VdbVolume<T> volume(file);
    output.allocate(file.header);
    const auto window = volume.window({0, 0, 0}, file.header.dimensions, file.header.voxels.data());
    volume.tree().put_tiles(window);
    volume.tree().put_all_leaves(
        window, [&](std::uint64_t position) { output.progress(double(position) / double(file.stream.size())); });
}

/// By boxes: what lies in no node is the background, of which nothing is stored.
template <class T>
class VdbBoxes final : public ChunkedFile {
public:
    explicit VdbBoxes(std::unique_ptr<OpenVdb> file) : file_(std::move(file)), volume_(*file_) {
        constexpr int edge = 64;
        volume_.tree().find_leaves();
        header_ = std::move(file_->header);
        levels_ = {{header_.dimensions, {edge, edge, edge}, header_.geometry}};
    }

    bool read(int, const std::array<int, 3>& chunk, int, std::span<std::byte> to) override {
        const ChunkedLevel& level = levels_.front();
        std::array<std::int64_t, 3> first;
        for (std::size_t axis = 0; axis < 3; ++axis) first[axis] = std::int64_t(chunk[axis]) * level.chunk[axis];
        const auto window = volume_.window(first, level.chunk, to.data());
        const bool is_empty = volume_.tree().is_empty(window);
        if (!is_empty || background_at_ != to.data()) volume_.tree().put_tiles(window);
        if (!is_empty) volume_.tree().put_leaves(window);
        background_at_ = is_empty ? to.data() : nullptr;
        return !is_empty;
    }

private:
    std::unique_ptr<OpenVdb> file_;
    VdbVolume<T> volume_;
    const std::byte* background_at_ = nullptr;  ///< where a chunk of nothing else was put last
};

std::unique_ptr<ChunkedFile> open_vdb(const std::filesystem::path& path, const std::string& part, Output&) {
    auto file = std::make_unique<OpenVdb>(path, part);
    if (file->header.type == VoxelType::f64) return std::make_unique<VdbBoxes<double>>(std::move(file));
    return std::make_unique<VdbBoxes<float>>(std::move(file));
}

}  // namespace

Volume read_vdb(const std::filesystem::path& path, const std::string& part, Output& output) {
    OpenVdb file(path, part);
    if (file.header.type == VoxelType::f64)
        read_all_voxels<double>(file, output);
    else
        read_all_voxels<float>(file, output);
    return std::move(file.header);
}

/// main() asks before it limits this process.
Reader find_reader(std::string_view format) {
    if (format != "vdb") return nullptr;
    is_alone();
    return read_vdb;
}

ChunkedOpener find_chunked_opener(std::string_view format) { return format == "vdb" ? open_vdb : nullptr; }

}  // namespace chiaro::decode

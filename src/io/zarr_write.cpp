// OME-Zarr 0.5 of a source's bricks, level by level, which goes on where it was broken off.
#include <chiaro/error.h>
#include <chiaro/io.h>
#include <chiaro/zarr.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstring>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>

#include "core/atomic_file.h"
#include "core/file_contents.h"
#include "core/threads.h"
#include "io/file_queue.h"
#include "io/lattice.h"
#include "io/zarr_shard.h"

namespace chiaro {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr ChunkPlace largest_shard{1024, 256, 64};  // long rows are read at once
constexpr const char* unfinished = ".chiaro-unfinished.json";

json in_order(const ChunkPlace& xyz) { return {xyz[2], xyz[1], xyz[0]}; }

ChunkPlace shard_of(const ChunkPlace& dimensions) {
    ChunkPlace shard{};
    for (std::size_t axis = 0; axis < 3; ++axis)
        shard[axis] = std::min(largest_shard[axis], ((dimensions[axis] - 1) / zarr_chunk_edge + 1) * zarr_chunk_edge);
    return shard;
}

/// 8 bits are packed better by zstd (to two thirds of what blosc makes of an MRI of a brain). Numbers of 16 bits are
/// packed as well by blosc (a CT of a head), floats to four thirds (a fetal MRI), both in half the time.
ZarrEncoding usual_encoding(VoxelType type) { return size_of(type) == 1 ? ZarrEncoding::zstd : ZarrEncoding::blosc; }

void write_text(const fs::path& path, const std::string& text) {
    AtomicFile file(path);
    file.write(std::as_bytes(std::span(text)));
    file.commit();
}

class ZarrWriter {
public:
    ZarrWriter(const BrickSource& source, fs::path folder, const ZarrSettings& settings, Progress& progress)
        : source_(source),
          type_(source.header().type),
          folder_(std::move(folder)),
          encoding_(settings.encoding.value_or(usual_encoding(type_))),
          levels_by_(settings.levels_by),
          progress_(progress),
          levels_(pyramid_of({source.header().dimensions, source.header().geometry})),
          shard_(shard_of(levels_[0].dimensions)),
          encoder_(type_, encoding_, shard_),
          files_(encoder_.max_bytes()),
          blocks_(levels_.size()),
          done_(levels_.size()) {}

    void run() {
        begin();
        const std::size_t top = levels_.size() - 1;
        for_each_shard(top, {{0, 0, 0}, levels_[top].dimensions}, [&](const ChunkPlace& place) { shard(top, place); });
        files_.finish();
        write_text(folder_ / "zarr.json", group().dump(1) + "\n");
        fs::remove(folder_ / unfinished);
    }

private:
    /// What must be the same for a conversion to go on.
    json identity() const {
        const Volume& header = source_.header();
        json told{{"volume", header.source},
                  {"dimensions", header.dimensions},
                  {"type", int(type_)},
                  {"encoding", int(encoding_)},
                  {"levels_by", int(levels_by_)}};
        std::error_code none;
        const std::string file = split_volume_name(header.source).first;
        if (fs::is_regular_file(file, none)) {
            told["bytes"] = fs::file_size(file);
            told["written"] = std::int64_t(fs::last_write_time(file).time_since_epoch().count());
        }
        return told;
    }

    void begin() {
        const auto refuse = [&](const char* why) {
            throw Error(ErrorCode::output, fmt::format("{}: {}", folder_.string(), why));
        };
        const json told = identity();
        std::error_code error;
        if (fs::exists(folder_ / unfinished, error)) {
            if (json::parse(file_text(folder_ / unfinished, 1 << 20), nullptr, false) != told)
                refuse("holds the beginning of another conversion; remove it, or give another name");
        } else {
            const bool is_empty = fs::is_directory(folder_, error) && fs::is_empty(folder_, error);
            if (!is_empty && fs::exists(folder_, error)) refuse("is there already");
            fs::create_directory(folder_, error);
            if (error) refuse("cannot be made");
            write_text(folder_ / unfinished, told.dump() + "\n");
        }
        for (std::size_t level = 0; level < levels_.size(); ++level) {
            const fs::path header = folder_ / std::to_string(level) / "zarr.json";
            fs::create_directory(header.parent_path());
            if (!fs::exists(header)) write_text(header, array(level).dump(1) + "\n");
        }
    }

    json array(std::size_t level) const {
        static const std::map<VoxelType, const char*> names = {{VoxelType::u8, "uint8"},
                                                               {VoxelType::i8, "int8"},
                                                               {VoxelType::u16, "uint16"},
                                                               {VoxelType::i16, "int16"},
                                                               {VoxelType::f32, "float32"}};
        const json little{{"name", "bytes"}, {"configuration", {{"endian", "little"}}}}, sum{{"name", "crc32c"}};
        json codecs{little};
        if (encoding_ == ZarrEncoding::zstd)
            codecs.push_back(
                {{"name", "zstd"}, {"configuration", {{"level", ShardEncoder::zstd_level}, {"checksum", false}}}});
        else if (encoding_ == ZarrEncoding::blosc)
            codecs.push_back({{"name", "blosc"}, {"configuration", blosc()}});
        codecs.push_back(sum);
        const json sharding{{"chunk_shape", {zarr_chunk_edge, zarr_chunk_edge, zarr_chunk_edge}},
                            {"codecs", codecs},
                            {"index_codecs", {little, sum}},
                            {"index_location", "end"}};
        return {{"zarr_format", 3},
                {"node_type", "array"},
                {"shape", in_order(levels_[level].dimensions)},
                {"data_type", names.at(type_)},
                {"chunk_grid", {{"name", "regular"}, {"configuration", {{"chunk_shape", in_order(shard_)}}}}},
                {"chunk_key_encoding", {{"name", "default"}, {"configuration", {{"separator", "/"}}}}},
                {"fill_value", 0},
                {"codecs", {{{"name", "sharding_indexed"}, {"configuration", sharding}}}},
                {"dimension_names", {"z", "y", "x"}},
                {"attributes", json::object()}};
    }

    json blosc() const {
        const std::size_t bytes = size_of(type_);
        return {{"cname", ShardEncoder::blosc_compressor},
                {"clevel", ShardEncoder::blosc_level},
                {"shuffle", ShardEncoder::shuffle_of(bytes) == ShardEncoder::Shuffle::bits ? "bitshuffle" : "shuffle"},
                {"typesize", bytes},
                {"blocksize", ShardEncoder::blosc_block}};
    }

    json group() const {
        const auto numbers = [](const Vec3& v) { return json{v.z, v.y, v.x}; };
        json axes = json::array(), datasets = json::array();
        for (const char* name : {"z", "y", "x"})
            axes.push_back({{"name", name}, {"type", "space"}, {"unit", "millimeter"}});
        for (std::size_t level = 0; level < levels_.size(); ++level) {
            const Geometry& geometry = levels_[level].geometry;
            datasets.push_back(
                {{"path", std::to_string(level)},
                 {"coordinateTransformations",
                  {{{"type", "scale"}, {"scale", numbers(geometry.spacing_mm)}},
                   {{"type", "translation"},
                    {"translation", numbers(levels_[0].geometry.origin_mm + levels_[level].shift_mm)}}}}});
        }
        const Volume& header = source_.header();
        json direction = json::array();
        for (const Vec3& axis : header.geometry.direction) direction.push_back({axis.x, axis.y, axis.z});
        const json own{{"direction", direction},
                       {"world", int(header.geometry.world)},
                       {"slope", header.slope},
                       {"intercept", header.intercept},
                       {"modality", header.modality}};
        return {{"zarr_format", 3},
                {"node_type", "group"},
                {"attributes",
                 {{"ome",
                   {{"version", "0.5"},
                    {"multiscales",
                     {{{"name", header.source.substr(header.source.rfind('/') + 1)},
                       {"axes", axes},
                       {"type", levels_by_ == LevelsBy::mean ? "mean" : "max"},
                       {"datasets", datasets}}}}}},
                  {"chiaro", own}}}};
    }

    template <class Function>
    void for_each_shard(std::size_t level, const VoxelBox& box, const Function& f) const {
        const auto end = [&](std::size_t axis) {
            const int last = std::min(box.first[axis] + box.size[axis], levels_[level].dimensions[axis]) - 1;
            return last / shard_[axis];
        };
        for (int z = box.first[2] / shard_[2]; z <= end(2); ++z)
            for (int y = box.first[1] / shard_[1]; y <= end(1); ++y)
                for (int x = box.first[0] / shard_[0]; x <= end(0); ++x) f({x, y, z});
    }

    fs::path file_of(std::size_t level, const ChunkPlace& place) const {
        return folder_ / std::to_string(level) / "c" / std::to_string(place[2]) / std::to_string(place[1]) /
               std::to_string(place[0]);
    }

    /// Makes a shard of all finer ones that it stands for, and has it written after them; what is written already
    /// stays. The block is there until the next one of its level.
    const Block& shard(std::size_t level, const ChunkPlace& place) {
        progress_.check();
        Block& block = blocks_[level];
        for (std::size_t axis = 0; axis < 3; ++axis) {
            block.box.first[axis] = place[axis] * shard_[axis];
            block.box.size[axis] = std::min(shard_[axis], levels_[level].dimensions[axis] - block.box.first[axis]);
        }
        const fs::path file = file_of(level, place);
        const bool is_there = fs::exists(file);
        if (is_there && level + 1 == levels_.size()) return block;  // which nobody needs any more
        if (block.voxels.size() == 0)
            block.voxels = VoxelBuffer(std::size_t(shard_[0]) * shard_[1] * shard_[2] * size_of(type_));
        if (is_there) {
            if (!done_[level]) done_[level] = open_brick_source((folder_ / std::to_string(level)).string(), {});
            if (!done_[level]) throw Error(ErrorCode::input, folder_.string() + ": what is done of it cannot be read");
            read(*done_[level], block);
        } else {
            level == 0 ? read(source_, block) : combine_finer(level, block);
            VoxelBuffer bytes = files_.room();
            const std::size_t size = encoder_.encode(block, bytes.data());
            files_.write(file, std::move(bytes), size);
        }
        if (level == 0) tell(block);
        return block;
    }

    void combine_finer(std::size_t level, Block& block) {
        const auto& factor = levels_[level].factor;
        VoxelBox finer;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            finer.first[axis] = block.box.first[axis] * factor[axis];
            finer.size[axis] = block.box.size[axis] * factor[axis];
        }
        for_each_shard(level - 1, finer, [&](const ChunkPlace& child) {
            put_coarser(shard(level - 1, child), type_, factor, levels_by_, usable_threads(), block);
        });
    }

    void tell(const Block& block) {
        const auto volume = [](const ChunkPlace& n) { return double(n[0]) * n[1] * n[2]; };
        told_ += volume(block.box.size);
        progress_.report("write", told_ / volume(levels_[0].dimensions));
    }

    /// Plane by plane of chunks, on all threads.
    void read(const BrickSource& source, Block& block) const {
        const auto& [first, size] = block.box;
        const std::size_t plane = std::size_t(size[0]) * size[1] * size_of(type_);
        const int step = std::max(1, std::min(zarr_chunk_edge, (size[2] - 1) / usable_threads() + 1));
        const int count = (size[2] - 1) / step + 1;
        parallel_for(usable_threads(), count, 1, [&](std::int64_t i, std::int64_t) {
            const int z = int(i) * step;
            source.read(0, {{first[0], first[1], first[2] + z}, {size[0], size[1], std::min(step, size[2] - z)}},
                        block.voxels.data() + std::size_t(z) * plane);
        });
        progress_.check();
    }

    const BrickSource& source_;
    const VoxelType type_;
    const fs::path folder_;
    const ZarrEncoding encoding_;
    const LevelsBy levels_by_;
    Progress& progress_;
    const std::vector<PyramidLevel> levels_;
    const ChunkPlace shard_;
    const ShardEncoder encoder_;
    FileQueue files_;
    std::vector<Block> blocks_;                             ///< the one of each level that is worked on
    std::vector<std::shared_ptr<const BrickSource>> done_;  ///< levels of an earlier call, where they are needed
    double told_ = 0;
};

class MemorySource final : public BrickSource {
public:
    MemorySource(Volume header, const SourceLevel& level, VoxelBuffer voxels)
        : BrickSource(std::move(header), {level}), voxels_(std::move(voxels)) {}

    void read(int, const VoxelBox& box, std::byte* to) const override {
        const auto& n = header().dimensions;
        const std::size_t voxel = size_of(header().type), row = std::size_t(box.size[0]) * voxel;
        for (int z = 0; z < box.size[2]; ++z)
            for (int y = 0; y < box.size[1]; ++y, to += row) {
                const std::size_t line =
                    std::size_t(box.first[2] + z) * std::size_t(n[1]) + std::size_t(box.first[1] + y);
                std::memcpy(to, voxels_.data() + (line * std::size_t(n[0]) + std::size_t(box.first[0])) * voxel, row);
            }
    }

private:
    VoxelBuffer voxels_;
};

}  // namespace

void write_zarr(const BrickSource& source, const fs::path& folder, const ZarrSettings& settings, Progress& progress) {
    const CancelScope scope(progress);
    try {
        ZarrWriter(source, folder, settings, progress).run();
    } catch (const fs::filesystem_error& error) {
        throw Error(ErrorCode::output, fmt::format("{}: {}", folder.string(), error.code().message()));
    }
}

std::shared_ptr<const BrickSource> source_of(Volume volume) {
    if (volume.components > 1)
        throw Error(ErrorCode::input, fmt::format("{}: has {} values a voxel, where a store of bricks has one",
                                                  volume.source, volume.components));
    Volume header = kept_header(volume);
    const SourceLevel level{header.dimensions, header.geometry};
    if (header.type == volume.type)
        return std::make_shared<MemorySource>(std::move(header), level, std::move(volume.voxels));
    VoxelBuffer floats(volume.voxel_count() * sizeof(float));
    with_voxel_type(volume.type, [&](auto zero) {
        const auto values = volume.as<decltype(zero)>();
        std::ranges::transform(values, reinterpret_cast<float*>(floats.data()), [](auto v) { return float(v); });
    });
    return std::make_shared<MemorySource>(std::move(header), level, std::move(floats));
}

}  // namespace chiaro

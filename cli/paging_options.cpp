#include "paging_options.h"

#include <chiaro/error.h>
#include <chiaro/text.h>
#include <fmt/format.h>

#include <algorithm>

#include "core/byte_size.h"

namespace chiaro::cli {
namespace {

std::uint64_t memory_from(const std::string& text) {
    constexpr std::uint64_t least = 16 << 20;
    const auto bytes = bytes_from(text);
    if (!bytes || *bytes < least)
        throw Error(ErrorCode::usage,
                    fmt::format("--memory {}: must be a size such as 4G or 512M, 16M at least", text));
    return *bytes;
}

constexpr const char* group = "Memory";

}  // namespace

void add_memory_option(CLI::App& app, PagingOptions& o) {
    app.add_option("--memory", o.memory,
                   "memory that pictures may take, such as 4G: a volume that needs more is read by bricks where its "
                   "format allows [half of what is free]")
        ->type_name("SIZE")
        ->group(group);
}

void add_paging_options(CLI::App& app, PagingOptions& o) {
    add_memory_option(app, o);
    app.add_option("--level", o.level, "finest level that is drawn; each further one has half the voxels an axis [0]")
        ->type_name("N")
        ->group(group);
    app.add_flag("--exact", o.exact,
                 "reads all voxels of a volume that is read by bricks once, for the range of values and for what is "
                 "empty; else a coarse level tells")
        ->group(group);
}

PagingSettings paging_of(const PagingOptions& o) {
    if (o.level < 0 || o.level > 32) throw Error(ErrorCode::usage, fmt::format("--level {}: must be 0 to 32", o.level));
    return {.memory_bytes = o.memory.empty() ? 0 : memory_from(o.memory), .finest_level = o.level, .exact = o.exact};
}

}  // namespace chiaro::cli

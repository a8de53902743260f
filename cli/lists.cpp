#include "lists.h"

#include <chiaro/chiaro.h>
#include <fmt/format.h>

#include "setting_flags.h"

namespace chiaro::cli {

void list_methods() {
    for (const auto& method : chiaro::list_methods()) fmt::print("{:<12} {}\n", method.name, method.sentence);
}

void list_formats() {
    const auto tell = [](const char* title, const std::vector<FormatInfo>& formats) {
        fmt::print("{}:\n", title);
        for (const auto& format : formats)
            fmt::print("  {:<14} {:<26} {}\n", format.name, format.extensions, format.note);
    };
    tell("volumes", chiaro::list_formats());
    tell("transfer functions", list_transfer_formats());
}

void list_presets() {
    for (const auto& preset : chiaro::list_presets())
        fmt::print("{:<16} {:<12} {}{}\n", preset.name, preset.modality, preset.sentence,
                   preset.stretched ? "" : " (in HU, never stretched)");
}

void list_devices() {
    const Device device = Device::cpu();
    fmt::print("cpu          {} threads, {}\n", device.threads, name_of(device.isa));
    for (const GpuInfo& gpu : list_gpus())
        fmt::print("{:<12} {}, {} of {} MiB free\n", fmt::format("cuda:{}", gpu.index), gpu.name, gpu.free_bytes >> 20,
                   gpu.memory_bytes >> 20);
}

void list_options() {
    fmt::print(
        "# Options that describe a picture\n\nWritten by `chiaro --list-options`; see [scene.md](scene.md) for scene "
        "files.\n{}",
        options_table());
}

}  // namespace chiaro::cli

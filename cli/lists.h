// What --list-methods and its like print.
#pragma once

namespace chiaro::cli {

void list_methods();
void list_formats();
void list_presets();
void list_devices();
void list_options();  ///< docs/options.md

}  // namespace chiaro::cli

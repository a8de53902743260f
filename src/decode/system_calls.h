// What the helper may ask of the kernel.
#pragma once
#include <string>
#include <vector>

namespace chiaro::decode {

/// What a program may do beside reading what is open, mapping memory and ending.
struct Permissions {
    bool reads_all = true;              ///< any file that its user may read
    std::vector<std::string> readable;  ///< else these files and what is in these folders
    std::string writable;               ///< a folder in which files may be made, read and removed; empty: none
    bool network = false;               ///< sockets of the internet, and threads, which look up names
};

/// From here on this process does no more than it is permitted: it makes, opens for writing, renames or removes no
/// other file, opens no other socket, starts no program or thread, signals nobody else and maps no new code. Whatever
/// else is asked fails with EPERM or EACCES. Landlock (kernel 5.13) and a filter of system calls (x86-64) each hold
/// most of this; the one that the kernel lacks is left out.
void restrict_system_calls(const Permissions& permissions);

}  // namespace chiaro::decode

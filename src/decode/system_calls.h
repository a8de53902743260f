// What the helper may ask of the kernel.
#pragma once

namespace chiaro::decode {

/// From here on this process can read files, map memory and end: it makes, opens for writing, renames or removes no
/// file, opens no socket, starts no program or thread, signals nobody else and maps no new code. Whatever else is asked
/// fails with EPERM or EACCES. Landlock (kernel 5.13) and a filter of system calls (x86-64) each hold most of this; the
/// one that the kernel lacks is left out.
void restrict_system_calls();

}  // namespace chiaro::decode

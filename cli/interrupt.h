// Ctrl-C.
#pragma once
#include <chiaro/progress.h>

namespace chiaro::cli {

/// While it lives, the first SIGINT or SIGTERM cancels `progress`; the next one ends the program at once.
class Interrupt {
public:
    explicit Interrupt(Progress& progress);
    ~Interrupt();
    Interrupt(const Interrupt&) = delete;
    Interrupt& operator=(const Interrupt&) = delete;
};

}  // namespace chiaro::cli

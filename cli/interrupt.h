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

/// To be called first: where there is nothing to cancel, SIGINT and SIGTERM end the program with the code of an
/// interruption; a file larger than the shell permits is an error of writing, not the end.
void prepare_for_signals();

}  // namespace chiaro::cli

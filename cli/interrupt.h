// Ctrl-C.
#pragma once
#include <chiaro/progress.h>

namespace chiaro::cli {

/// While it lives, the first SIGINT or SIGTERM cancels `progress`, and ends the program within a second wherever it is;
/// the next one ends it at once.
class Interrupt {
public:
    explicit Interrupt(Progress& progress);
    ~Interrupt();
    Interrupt(const Interrupt&) = delete;
    Interrupt& operator=(const Interrupt&) = delete;
};

/// Ends the program within a second, with exit code 0, wherever it is. For what may be left undone.
void end_within_a_second();

/// To be called before anything: descriptors 0 to 2 that are closed become /dev/null, the wrong way round, so that
/// using them fails as before. Or the next file that is opened would be taken for standard output.
void open_standard_streams();

/// To be called next: where there is nothing to cancel, SIGINT and SIGTERM end the program with the code of an
/// interruption; a file larger than the shell permits is an error of writing, not the end.
void prepare_for_signals();

}  // namespace chiaro::cli

// What surrounds the work of a command.
#pragma once
#include "common.h"
#include "interrupt.h"
#include "progress_bar.h"

namespace chiaro::cli {

/// Progress that is shown on the terminal and cancelled by Ctrl-C.
struct Job {
    explicit Job(const CommonOptions& options) : bar(options.progress, options.quiet) {}

    ProgressBar bar;
    Progress progress{bar.report()};
    Interrupt interrupt{progress};
};

}  // namespace chiaro::cli

#include "interrupt.h"

#include <chiaro/error.h>
#include <unistd.h>

#include <atomic>
#include <csignal>

namespace chiaro::cli {
namespace {

std::atomic<Progress*> to_cancel{nullptr};  // a signal handler can be reached in no other way

void cancel(int) {
    if (Progress* progress = to_cancel) progress->cancel();
}

void end_at_once(int) { _exit(int(ErrorCode::interrupted)); }

void handle(void (*handler)(int)) {
    struct sigaction action = {};
    action.sa_handler = handler;
    action.sa_flags = SA_RESETHAND | SA_RESTART;  // handled once: then the default, which kills
    sigaction(SIGINT, &action, nullptr);
    sigaction(SIGTERM, &action, nullptr);
}

}  // namespace

Interrupt::Interrupt(Progress& progress) {
    to_cancel = &progress;
    handle(cancel);
}

Interrupt::~Interrupt() {
    handle(end_at_once);
    to_cancel = nullptr;
}

void prepare_for_signals() {
    handle(end_at_once);
    signal(SIGXFSZ, SIG_IGN);
}

}  // namespace chiaro::cli

#include "interrupt.h"

#include <atomic>
#include <csignal>

namespace chiaro::cli {
namespace {

std::atomic<Progress*> to_cancel{nullptr};  // a signal handler can be reached in no other way

void cancel(int) {
    if (Progress* progress = to_cancel) progress->cancel();
}

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
    handle(SIG_DFL);
    to_cancel = nullptr;
}

}  // namespace chiaro::cli

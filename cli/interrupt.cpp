#include "interrupt.h"

#include <chiaro/error.h>
#include <fcntl.h>
#include <poll.h>
#include <sys/time.h>
#include <unistd.h>

#include <atomic>
#include <csignal>
#include <string_view>

namespace chiaro::cli {
namespace {

std::atomic<Progress*> to_cancel{nullptr};  // a signal handler can be reached in no other way

void end_at_once(int) { _exit(int(ErrorCode::interrupted)); }

void end_late(int) {
    constexpr std::string_view sentence = "chiaro: interrupted\n";
    pollfd told{STDERR_FILENO, POLLOUT, 0};  // it may be what the program waits for
    if (poll(&told, 1, 0) == 1 && write(STDERR_FILENO, sentence.data(), sentence.size()) < 0) told.revents = 0;
    end_at_once(0);
}

void set_alarm(void (*handler)(int)) {
    signal(SIGALRM, handler);
    const itimerval patience{{}, {0, 500'000}};
    setitimer(ITIMER_REAL, &patience, nullptr);
}

/// The work ends by itself, or is ended: nothing of it is half-written, as files get their names whole.
void cancel(int) {
    if (Progress* progress = to_cancel) progress->cancel();
    set_alarm(end_late);
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
    handle(end_at_once);
    const itimerval never{};
    setitimer(ITIMER_REAL, &never, nullptr);
    to_cancel = nullptr;
}

void end_within_a_second() {
    set_alarm([](int) { _exit(0); });
}

void open_standard_streams() {
    for (int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})  // open takes the lowest number that is free
        if (fcntl(stream, F_GETFD) < 0 && open("/dev/null", stream == STDIN_FILENO ? O_WRONLY : O_RDONLY) != stream)
            _exit(int(ErrorCode::output));
}

void prepare_for_signals() {
    handle(end_at_once);
    signal(SIGXFSZ, SIG_IGN);
}

}  // namespace chiaro::cli

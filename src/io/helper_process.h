// Starting, watching and ending the helper program.
#pragma once
#include <sys/types.h>

#include <chrono>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace chiaro {

/// A file descriptor with one owner.
class Descriptor {
public:
    Descriptor() = default;
    explicit Descriptor(int number) : number_(number) {}
    Descriptor(Descriptor&& other) noexcept : number_(std::exchange(other.number_, -1)) {}
    Descriptor& operator=(Descriptor&& other) noexcept {
        std::swap(number_, other.number_);
        return *this;
    }
    ~Descriptor();
    int number() const { return number_; }

private:
    int number_ = -1;
};

/// The same file under a number beyond those that the helper's own descriptors take, so that handing over one does not
/// close another.
Descriptor moved_up(Descriptor descriptor);

/// A memory file; sealing makes sure that it can no longer shrink below a mapping. Throws Error{output}.
Descriptor make_memory_file(const char* name);

/// Two connected ends, to be handed over or kept. Throws Error{output}.
std::pair<Descriptor, Descriptor> make_connection();

/// Where chiaro-decode or chiaro-fetch is: the variable CHIARO_DECODE or CHIARO_FETCH, beside the running program,
/// ../libexec/chiaro, or where this build put it. Throws Error{internal} if nowhere.
std::filesystem::path find_helper(const std::string& name = "chiaro-decode");

/// What a program finds open, each by its number here; -1: nothing. io/wire.h has their numbers there.
struct HandedOver {
    int standard_input = -1, voxels = -1, fetch = -1;
};

/// A running helper. Destroyed, it is killed and waited for: no zombies.
class HelperProcess {
public:
    /// Throws Error{output} when it cannot be started.
    HelperProcess(const std::filesystem::path& program, const std::vector<std::string>& arguments,
                  const HandedOver& handed_over);
    HelperProcess(const HelperProcess&) = delete;
    HelperProcess& operator=(const HelperProcess&) = delete;
    ~HelperProcess();

    enum class Event { line, nothing, ended };
    /// Waits up to `patience` for one line from the helper.
    Event next(std::string& line, std::chrono::milliseconds patience);
    /// Waits for the end and returns the signal that ended it, or 0.
    int ending_signal();

private:
    bool take_line(std::string& line);

    Descriptor messages_;
    pid_t process_ = -1;
    std::string received_;
};

}  // namespace chiaro

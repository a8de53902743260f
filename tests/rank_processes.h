// Ranks as processes of their own, so that each one's memory and CPU time can be told: an Exchange among them, by
// files.
#pragma once
#include <chiaro/error.h>
#include <chiaro/exchange.h>
#include <fcntl.h>
#include <pthread.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstring>
#include <fstream>
#include <functional>
#include <string>

namespace chiaro::testing {

/// What one rank took.
struct RankCost {
    double cpu_seconds = 0;
    double peak_bytes = 0;                    ///< beyond what it had before
    double sent = 0, received = 0;            ///< bytes, by the numbers that it gave and got
    double block_bytes = 0, field_bytes = 0;  ///< as the work tells them
    bool is_done = false;
};

/// What the processes have in common. Pages of files count for none of them.
struct RankPage {
    static constexpr int most = 64;
    pthread_barrier_t meeting;
    std::uint64_t lengths[most];
    int files[most];
    RankCost costs[most];
};

class ProcessExchange : public Exchange {
public:
    ProcessExchange(RankPage& page, int rank, int size) : page_(page), rank_(rank), size_(size) {}
    int rank() const override { return rank_; }
    int size() const override { return size_; }
    std::vector<std::vector<std::byte>> gather(std::span<const std::byte> mine) override {
        for (std::size_t at = 0; at < mine.size();)
            if (const ssize_t wrote = ::pwrite(page_.files[rank_], mine.data() + at, mine.size() - at, off_t(at));
                wrote > 0)
                at += std::size_t(wrote);
            else
                throw Error(ErrorCode::internal, "a rank cannot write to its file");
        page_.lengths[rank_] = mine.size();
        ::pthread_barrier_wait(&page_.meeting);
        std::vector<std::vector<std::byte>> blocks(static_cast<std::size_t>(size_));
        for (int rank = 0; rank < size_; ++rank) {
            std::vector<std::byte>& block = blocks[std::size_t(rank)];
            block.resize(page_.lengths[rank]);
            for (std::size_t at = 0; at < block.size();)
                if (const ssize_t got = ::pread(page_.files[rank], block.data() + at, block.size() - at, off_t(at));
                    got > 0)
                    at += std::size_t(got);
                else
                    throw Error(ErrorCode::internal, "a rank cannot read from a file");
            if (rank != rank_) page_.costs[rank_].received += double(block.size());
        }
        page_.costs[rank_].sent += double(mine.size());
        ::pthread_barrier_wait(&page_.meeting);
        return blocks;
    }

private:
    RankPage& page_;
    int rank_, size_;
};

/// VmHWM or VmRSS in bytes.
inline double memory_of_process(const std::string& key) {
    std::ifstream status("/proc/self/status");
    for (std::string word; status >> word;)
        if (double kib = 0; word == key + ":" && status >> kib) return 1024 * kib;
    return 0;
}

/// What a rank's work is measured by: from `start` on.
class RankMeter {
public:
    explicit RankMeter(RankCost& cost) : cost_(cost) {}
    /// `block_bytes`: of the voxels that it holds by now.
    void start(double block_bytes) {
        cost_ = {.block_bytes = block_bytes};
        std::ofstream("/proc/self/clear_refs") << "5";  // the peak begins anew
        before_ = memory_of_process("VmRSS"), cpu_ = cpu();
    }
    void end(double field_bytes) {
        cost_.cpu_seconds = cpu() - cpu_, cost_.peak_bytes = memory_of_process("VmHWM") - before_;
        cost_.field_bytes = field_bytes, cost_.is_done = true;
    }

private:
    static double cpu() {
        rusage usage{};
        ::getrusage(RUSAGE_SELF, &usage);
        const auto seconds = [](const timeval& t) { return double(t.tv_sec) + 1e-6 * double(t.tv_usec); };
        return seconds(usage.ru_utime) + seconds(usage.ru_stime);
    }
    RankCost& cost_;
    double before_ = 0, cpu_ = 0;
};

/// work(exchange, meter) in so many processes; what each took. Call it where there is one thread. A rank that does not
/// come through leaves its cost not done; the others may wait for it, and are ended with the caller.
inline std::vector<RankCost> in_processes(
    int size, const std::function<void(std::shared_ptr<ProcessExchange>, RankMeter&)>& work) {
    void* shared = ::mmap(nullptr, sizeof(RankPage), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (shared == MAP_FAILED || size > RankPage::most) throw Error(ErrorCode::internal, "too many ranks");
    auto& page = *static_cast<RankPage*>(shared);
    pthread_barrierattr_t between_processes;
    ::pthread_barrierattr_init(&between_processes);
    ::pthread_barrierattr_setpshared(&between_processes, PTHREAD_PROCESS_SHARED);
    ::pthread_barrier_init(&page.meeting, &between_processes, unsigned(size));
    for (int rank = 0; rank < size; ++rank) {
        std::string name = "/tmp/chiaro-rank-XXXXXX";
        page.files[rank] = ::mkstemp(name.data());
        ::unlink(name.c_str());
    }
    std::vector<pid_t> children;
    for (int rank = 0; rank < size; ++rank)
        if (const pid_t child = ::fork(); child > 0) {
            children.push_back(child);
        } else {
            try {
                RankMeter meter(page.costs[rank]);
                work(std::make_shared<ProcessExchange>(page, rank, size), meter);
            } catch (const std::exception& error) {
                std::fprintf(stderr, "rank %d: %s\n", rank, error.what());
            }
            ::_exit(0);
        }
    for (const pid_t child : children) ::waitpid(child, nullptr, 0);
    std::vector<RankCost> costs(page.costs, page.costs + size);
    for (int rank = 0; rank < size; ++rank) ::close(page.files[rank]);
    ::munmap(shared, sizeof(RankPage));
    return costs;
}

}  // namespace chiaro::testing

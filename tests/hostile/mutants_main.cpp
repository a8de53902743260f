// chiaro-mutants [COUNT [SEED [PART-OF-A-NAME...]]]: damages files at random and watches what becomes of them.
//
// Workers, each a process of its own, read the mutants as the program does, volumes through the helper. Ends with a
// table, and with 1 after a crash or hang of a worker, a refusal that is no sentence, or a file cut short that was
// taken as whole. A mutant is made from SEED and its number alone: the one that is named can be looked at again.
#include "hostile/judgement.h"
#include "hostile/mutations.h"

#include <chiaro/io.h>
#include <fmt/format.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <csignal>
#include <fstream>
#include <new>
#include <set>
#include <thread>

namespace {

using namespace hostile;
namespace fs = std::filesystem;

constexpr std::size_t workers = 4, max_seeds = 128;
constexpr std::int64_t longest_seconds = 60;  // the helper has 15 without a sign

struct Counts {
    std::atomic<std::uint64_t> made, whole, other, doubted, refused, decoder_crashed, decoder_stopped, faults;
};

/// What all workers share.
struct Board {
    std::atomic<std::uint64_t> next{0};
    std::array<std::atomic<std::uint64_t>, workers> current{};  ///< 1 + the mutant that each works on; 0: none
    std::array<std::atomic<std::int64_t>, workers> since{};     ///< in seconds
    std::array<Counts, max_seeds> counts{};                     ///< of each seed
    std::atomic<std::uint64_t> crashes{0}, hangs{0};
};

std::int64_t now_seconds() {
    const auto now = std::chrono::steady_clock::now().time_since_epoch();
    return std::chrono::duration_cast<std::chrono::seconds>(now).count();
}

struct Plan {
    std::uint64_t count = 2000, seed = 1;
    std::vector<std::size_t> chosen = {};  ///< seeds in turn

    std::size_t seed_of(std::uint64_t number) const { return chosen[number % chosen.size()]; }
    Mutant mutant(std::uint64_t number) const {
        std::mt19937_64 random(seed * 0x9e3779b97f4a7c15 + number);
        const auto& all = seeds();
        const Seed& other = all[random() % all.size()];
        return random_mutant(all[seed_of(number)], other, random);
    }
};

chiaro::Volume read_through_helper(const std::string& path) {
    chiaro::Progress progress;
    chiaro::ReadOptions options;
    options.stall_seconds = 4;  // there are many
    return chiaro::read_volume(path, options, progress);
}

void count(const Seed& seed, const Mutant& mutant, const Judgement& found, std::uint64_t whole, std::uint64_t number,
           Counts& counts) {
    ++counts.made;
    const bool is_whole = found.is_read && found.contents == whole;
    const bool is_lost = found.is_read && !is_whole && !found.is_doubted && mutant.is_cut && !seed.is_open_ended;
    counts.whole += is_whole;
    counts.doubted += found.is_read && !is_whole && found.is_doubted;
    counts.other += found.is_read && !is_whole && !found.is_doubted;
    counts.refused += !found.is_read;
    counts.decoder_crashed += found.sentence.find("the decoder crashed") != std::string::npos;
    counts.decoder_stopped += found.sentence.find("took more") != std::string::npos ||
                              found.sentence.find("came to a halt") != std::string::npos;
    if (found.fault.empty() && !is_lost) return;
    ++counts.faults;
    fmt::print("{} {}, {}: {} ({})\n", seed.name, number, mutant.name, is_lost ? "taken as whole" : found.fault,
               found.sentence);
    std::fflush(stdout);
}

/// Contents of the seeds as they are.
std::vector<std::uint64_t> whole_contents(const fs::path& folder) {
    std::vector<std::uint64_t> contents;
    for (const Seed& seed : seeds()) {
        contents.push_back(judgement_of(seed, seed.bytes, folder / "whole", read_through_helper).contents);
        fs::remove_all(folder / "whole");
    }
    return contents;
}

void work(const Plan& plan, std::size_t worker, const fs::path& folder, const std::vector<std::uint64_t>& whole,
          Board& board) {
    const fs::path own = folder / std::to_string(worker);
    for (std::uint64_t number; (number = board.next++) < plan.count;) {
        board.since[worker] = now_seconds();
        board.current[worker] = number + 1;
        const std::size_t which = plan.seed_of(number);
        const Seed& seed = seeds()[which];
        const Mutant mutant = plan.mutant(number);
        const Judgement found = judgement_of(seed, mutant.bytes, own, read_through_helper);
        count(seed, mutant, found, whole[which], number, board.counts[which]);
        board.current[worker] = 0;
        fs::remove_all(own);
    }
}

/// Starts workers, and others in the place of those that die.
void watch(const Plan& plan, const fs::path& folder, Board& board) {
    const auto whole = whole_contents(folder);
    std::array<pid_t, workers> children{};
    const auto start = [&](std::size_t worker) {
        children[worker] = fork();
        if (children[worker] != 0) return;
        work(plan, worker, folder, whole, board);
        std::fflush(stdout);
        _exit(0);
    };
    for (std::size_t w = 0; w < workers; ++w) start(w);
    for (std::size_t left = workers; left > 0;) {
        std::this_thread::sleep_for(std::chrono::milliseconds(100));
        for (std::size_t w = 0; w < workers; ++w) {
            if (children[w] == 0) continue;
            const bool hangs = board.current[w] != 0 && now_seconds() - board.since[w] > longest_seconds;
            if (hangs) kill(children[w], SIGKILL);
            int status = 0;
            if (waitpid(children[w], &status, hangs ? 0 : WNOHANG) == 0) continue;
            children[w] = 0;
            if (WIFEXITED(status) && WEXITSTATUS(status) == 0) {
                --left;
                continue;
            }
            const std::uint64_t number = board.current[w] - 1;
            ++(hangs ? board.hangs : board.crashes);
            fmt::print("{} {}: {}\n", seeds()[plan.seed_of(number)].name, number, hangs ? "HANG" : "CRASH");
            board.current[w] = 0;
            start(w);
        }
    }
}

const char* kind_of(const Seed& seed) {
    constexpr const char* names[] = {"volume", "raw by its name", "probe", "scene", "transfer function",
                                     "glow",   "histogram cache"};
    return names[std::size_t(seed.kind)];
}

/// A row for each file, then all together. Returns whether all went well.
bool tell(const Plan& plan, const Board& board) {
    constexpr auto row = "| {} | {} | {} | {} | {} | {} | {} | {} | {} |\n";
    fmt::print(row, "file", "kind", "mutants", "as the whole", "other contents", "with a doubt", "refused",
               "decoder crashed", "decoder stopped");
    fmt::print("| --- | --- |{}\n", " ---: | ---: | ---: | ---: | ---: | ---: | ---: |");
    std::array<std::uint64_t, 8> sums{};
    for (std::size_t i : std::set(plan.chosen.begin(), plan.chosen.end())) {
        const Counts& c = board.counts[i];
        const std::array<std::uint64_t, 8> n{c.made,    c.whole,           c.other,           c.doubted,
                                             c.refused, c.decoder_crashed, c.decoder_stopped, c.faults};
        for (std::size_t k = 0; k < n.size(); ++k) sums[k] += n[k];
        fmt::print(row, seeds()[i].name, kind_of(seeds()[i]), n[0], n[1], n[2], n[3], n[4], n[5], n[6]);
    }
    fmt::print(row, "all", "", sums[0], sums[1], sums[2], sums[3], sums[4], sums[5], sums[6]);
    fmt::print("\n{} mutants of seed {}: {} crashes and {} hangs of the program, {} faults\n", sums[0], plan.seed,
               board.crashes.load(), board.hangs.load(), sums[7]);
    return board.crashes + board.hangs + sums[7] == 0 && sums[0] == plan.count;
}

/// Writes the mutant of that number beside the program's own name, to be looked at.
void keep(const Plan& plan, std::uint64_t number) {
    const std::string name = fmt::format("mutant-{}-{}", number, seeds()[plan.seed_of(number)].name);
    std::ofstream(name, std::ios::binary) << plan.mutant(number).bytes;
    fmt::print("{}\n", name);
}

}  // namespace

int main(int argc, char** argv) {
    Plan plan;
    if (argc > 1) plan.count = std::strtoull(argv[1], nullptr, 10);
    if (argc > 2) plan.seed = std::strtoull(argv[2], nullptr, 10);
    for (std::size_t i = 0; i < std::min(seeds().size(), max_seeds); ++i) {
        bool is_wanted = argc <= 3;
        for (int a = 3; a < argc; ++a) is_wanted |= seeds()[i].name.find(argv[a]) != std::string::npos;
        // What is read without a helper costs little.
        const std::size_t times = seeds()[i].kind == Kind::volume ? 1 : 3;
        if (is_wanted) plan.chosen.insert(plan.chosen.end(), times, i);
    }
    if (plan.chosen.empty()) return 2;
    if (const char* number = std::getenv("CHIARO_KEEP")) return keep(plan, std::strtoull(number, nullptr, 10)), 0;
    std::string name = (fs::temp_directory_path() / "chiaro-mutants-XXXXXX").string();
    const fs::path folder = mkdtemp(name.data());
    void* memory = mmap(nullptr, sizeof(Board), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    Board& board = *new (memory) Board;
    watch(plan, folder, board);
    fs::remove_all(folder);
    return tell(plan, board) ? 0 : 1;
}

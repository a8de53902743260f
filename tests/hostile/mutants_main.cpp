// chiaro-mutants [COUNT [SEED [FORMAT...]]] [--kind cut|bytes|header] [--read whole|bricks] [--jobs N] [--only NUMBER]
//
// Damages files of each format (all) COUNT times and watches what becomes of them: each is read, and a volume shown, as
// the program does it, in a process of its own. Ends with a table, and with 1 after a finding (hostile/trial.h).
// --read bricks: level 0 of the volumes that can be read so, each chunk by itself.
// A mutant is made from format, SEED and number alone: --only makes one, keeps its files and tells what became of it.
#include "hostile/series.h"
#include "hostile/show.h"
#include "hostile/trial.h"

#include <chiaro/brick_source.h>
#include <chiaro/io.h>
#include <fmt/format.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <map>
#include <memory>
#include <optional>
#include <thread>

namespace {

using namespace hostile;
namespace fs = std::filesystem;

struct Plan {
    std::uint64_t count = 1000, seed = 1;
    std::vector<Series> series = {};
    std::optional<Damage> damage = {};
    std::optional<std::uint64_t> only = {};
    std::size_t jobs = std::max(2u, 2 * std::thread::hardware_concurrency());  // half of the time a process waits
};

struct Counts {
    std::uint64_t made = 0, whole = 0, other = 0, doubted = 0, refused = 0, decoder_crashed = 0, decoder_stopped = 0;
    double cpu_seconds = 0;
    std::array<std::uint64_t, finding_names.size()> found{};

    void add(const Judgement& judgement, const Judgement& whole_file, double seconds, Finding finding) {
        const auto says = [&](const char* part) { return judgement.sentence.find(part) != std::string::npos; };
        const bool is_whole = judgement.is_read && judgement.contents == whole_file.contents;
        ++made;
        whole += is_whole;
        doubted += judgement.is_read && !is_whole && judgement.is_doubted;
        other += judgement.is_read && !is_whole && !judgement.is_doubted;
        refused += !judgement.is_read;
        decoder_crashed += says("the decoder crashed");
        decoder_stopped += says("took more") || says("came to a halt");
        cpu_seconds += seconds;
        ++found[std::size_t(finding)];
    }
    void add(const Counts& c) {
        made += c.made, whole += c.whole, other += c.other, doubted += c.doubted, refused += c.refused;
        decoder_crashed += c.decoder_crashed, decoder_stopped += c.decoder_stopped, cpu_seconds += c.cpu_seconds;
        for (std::size_t i = 0; i < found.size(); ++i) found[i] += c.found[i];
    }
};

bool by_bricks = false;  ///< what can be read so

chiaro::Volume read_through_helper(const std::string& path) {
    chiaro::Progress progress;
    chiaro::ReadOptions options;
    options.max_bytes = permitted_bytes(path, std::uint64_t(1) << 30);  // several run at a time
    if (by_bricks)
        if (const auto source = chiaro::open_brick_source(path, options))
            if (const auto [nx, ny, nz] = source->header().dimensions; 4. * nx * ny * nz <= double(options.max_bytes))
                return chiaro::read_level(*source, 0, progress);
    return chiaro::read_volume(path, options, progress);
}

Judgement judged(const Seed& seed, const std::string& bytes, const fs::path& folder) {
    return judgement_of(seed, bytes, folder, read_through_helper, show);
}

/// Runs the mutants of all formats, as many at a time as the plan says.
class Run {
public:
    Run(const Plan& plan, const fs::path& folder) : plan_(plan), folder_(folder), slots_(plan.jobs) {
        for (std::size_t i = 0; i < slots_.size(); ++i) slots_[i].folder = folder / std::to_string(i);
    }

    void run() {
        for (const Series& series : plan_.series) {
            const auto begin = std::chrono::steady_clock::now();
            for (std::uint64_t number = 0; number < plan_.count; ++number) {
                if (plan_.damage && series.damage_of(number) != *plan_.damage) continue;
                start(series, number);
            }
            while (running_ > 0) finish_one();
            const std::chrono::duration<double> passed = std::chrono::steady_clock::now() - begin;
            fmt::print(stderr, "{}: {} mutants in {:.0f} s\n", series.format(), counts_[series.format()].made,
                       passed.count());
        }
    }

    const Counts& counts(const std::string& format) { return counts_[format]; }

private:
    struct Slot {
        Trial trial{};
        pid_t process = 0;  ///< 0: free
        const Series* series = nullptr;
        std::uint64_t number = 0;
        Mutant mutant{};
        fs::path folder{};
    };

    const Judgement& whole(const Seed& seed) {
        const auto known = whole_.find(&seed);
        if (known != whole_.end()) return known->second;
        const fs::path own = folder_ / "whole";
        const Outcome outcome = outcome_of([&] { return judged(seed, seed.bytes, own); });
        fs::remove_all(own);
        const Finding finding = finding_of(seed, {"as it is", seed.bytes}, outcome, outcome.judgement);
        if (!outcome.judgement.is_read || finding != Finding::none)
            fmt::print("{}, as it is: {} ({})\n", seed.name, finding_names[std::size_t(finding)],
                       outcome.judgement.sentence);
        return whole_.emplace(&seed, outcome.judgement).first->second;
    }

    void start(const Series& series, std::uint64_t number) {
        const Seed& seed = series.file_of(number);
        whole(seed);
        if (running_ == slots_.size()) finish_one();
        Slot& slot = *std::find_if(slots_.begin(), slots_.end(), [](const Slot& s) { return s.process == 0; });
        slot.series = &series, slot.number = number, slot.mutant = series.mutant(number);
        slot.process = slot.trial.start([&] { return judged(seed, slot.mutant.bytes, slot.folder); });
        if (slot.process < 0) throw std::runtime_error("no process can be started");
        ++running_;
    }

    void finish_one() {
        int status = 0;
        rusage usage{};
        const pid_t ended = wait4(-1, &status, 0, &usage);
        const auto slot = std::find_if(slots_.begin(), slots_.end(), [&](const Slot& s) { return s.process == ended; });
        if (ended <= 0 || slot == slots_.end()) return;
        slot->process = 0;
        --running_;
        fs::remove_all(slot->folder);
        tell(*slot, slot->trial.outcome(status, usage));
    }

    void tell(const Slot& slot, const Outcome& outcome) {
        const Seed& seed = slot.series->file_of(slot.number);
        const Finding finding = finding_of(seed, slot.mutant, outcome, whole(seed));
        counts_[seed.format].add(outcome.judgement, whole(seed), outcome.cpu_seconds, finding);
        if (finding == Finding::none) return;
        fmt::print("{} {} {} ({}, {}): {}; {:.1f} s, {} MiB; {} {}\n", seed.format, slot.series->seed(), slot.number,
                   seed.name, slot.mutant.name, finding_names[std::size_t(finding)], outcome.cpu_seconds,
                   outcome.peak_bytes >> 20, outcome.judgement.fault, outcome.judgement.sentence);
        std::fflush(stdout);
    }

    const Plan& plan_;
    fs::path folder_;
    std::vector<Slot> slots_;
    std::size_t running_ = 0;
    std::map<const Seed*, Judgement> whole_;
    std::map<std::string, Counts> counts_;
};

void print_row(const std::string& name, const Counts& c) {
    std::string findings;
    for (std::size_t i = 1; i < c.found.size(); ++i) findings += fmt::format(" {} |", c.found[i]);
    fmt::print("| {} | {} | {} | {} | {} | {} | {} | {} | {:.0f} |{}\n", name, c.made, c.whole, c.other, c.doubted,
               c.refused, c.decoder_crashed, c.decoder_stopped, c.cpu_seconds, findings);
}

/// A row for each format, then all together; findings by kind. Returns whether there was none.
bool tell(const Plan& plan, Run& run, double seconds) {
    std::string titles, lines;
    for (std::size_t i = 1; i < finding_names.size(); ++i)
        titles += fmt::format(" {} |", finding_names[i]), lines += " ---: |";
    fmt::print(
        "\n| format | mutants | as the whole | other contents | with a doubt | refused | decoder crashed | decoder "
        "stopped | s of CPU |{}\n| --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: |{}\n",
        titles, lines);
    Counts all;
    for (const Series& series : plan.series) {
        print_row(series.format(), run.counts(series.format()));
        all.add(run.counts(series.format()));
    }
    print_row("all", all);
    const std::uint64_t findings = all.made - all.found[0];
    fmt::print("\n{} mutants of seed {} in {:.0f} s, {} at a time: {} findings\n", all.made, plan.seed, seconds,
               plan.jobs, findings);
    return findings == 0 && all.made > 0;
}

/// Judges one mutant and keeps its files in a folder here.
bool run_one(const Series& series, std::uint64_t number) {
    const Seed& seed = series.file_of(number);
    const Mutant mutant = series.mutant(number);
    const fs::path folder = fmt::format("mutant-{}-{}-{}", series.format(), series.seed(), number);
    const Outcome whole = outcome_of([&] { return judged(seed, seed.bytes, folder); });
    fs::remove_all(folder);
    const Outcome outcome = outcome_of([&] { return judged(seed, mutant.bytes, folder); });
    const Finding finding = finding_of(seed, mutant, outcome, whole.judgement);
    const Judgement& found = outcome.judgement;
    const char* became = !found.is_read                               ? "refused"
                         : found.contents != whole.judgement.contents ? "read with other contents"
                                                                      : "read as the whole";
    fmt::print("{}/ ({} of {}, {})\n{}, {} notes; {:.2f} s of CPU, {} MiB; {} {}\nfinding: {}\n", folder.string(),
               damage_names[std::size_t(series.damage_of(number))], seed.name, mutant.name, became,
               found.notes == whole.judgement.notes ? "the same" : "other", outcome.cpu_seconds,
               outcome.peak_bytes >> 20, found.fault, found.sentence, finding_names[std::size_t(finding)]);
    return finding == Finding::none;
}

bool take_option(Plan& plan, const std::string& name, const std::string& value) {
    if (name == "--jobs") return (plan.jobs = std::strtoull(value.c_str(), nullptr, 10)) > 0;
    if (name == "--read") return (by_bricks = value == "bricks") || value == "whole";
    if (name == "--only") return plan.only = std::strtoull(value.c_str(), nullptr, 10), true;
    const auto kind = std::find(std::begin(damage_names), std::end(damage_names), value);
    if (name != "--kind" || kind == std::end(damage_names)) return false;
    plan.damage = Damage(kind - std::begin(damage_names));
    return true;
}

/// False where nothing was asked that can be done.
bool take_arguments(Plan& plan, int argc, char** argv) {
    std::vector<std::string> words;
    for (int i = 1; i < argc; ++i) {
        const std::string word = argv[i];
        if (!word.starts_with("--"))
            words.push_back(word);
        else if (i + 1 == argc || !take_option(plan, word, argv[++i]))
            return false;
    }
    if (!words.empty()) plan.count = std::strtoull(words[0].c_str(), nullptr, 10);
    if (words.size() > 1) plan.seed = std::strtoull(words[1].c_str(), nullptr, 10);
    const std::vector<std::string> known = formats();
    std::vector<std::string> chosen(words.begin() + std::ptrdiff_t(std::min<std::size_t>(words.size(), 2)),
                                    words.end());
    for (const std::string& format : chosen.empty() ? known : chosen) {
        if (std::find(known.begin(), known.end(), format) == known.end()) return false;
        plan.series.emplace_back(format, plan.seed);
    }
    return !plan.only || plan.series.size() == 1;
}

}  // namespace

int main(int argc, char** argv) {
    Plan plan;
    if (!take_arguments(plan, argc, argv)) {
        fmt::print(
            stderr,
            "chiaro-mutants [COUNT [SEED [FORMAT...]]] [--kind cut|bytes|header] [--read whole|bricks] [--jobs N] "
            "[--only NUMBER]\n"
            "formats: {}; --only takes one of them\n",
            fmt::join(formats(), " "));
        return 2;
    }
    if (plan.only) return run_one(plan.series[0], *plan.only) ? 0 : 1;
    std::string name = (fs::temp_directory_path() / "chiaro-mutants-XXXXXX").string();
    const fs::path folder = mkdtemp(name.data());
    const auto begin = std::chrono::steady_clock::now();
    Run run(plan, folder);
    run.run();
    fs::remove_all(folder);
    const std::chrono::duration<double> passed = std::chrono::steady_clock::now() - begin;
    return tell(plan, run, passed.count()) ? 0 : 1;
}

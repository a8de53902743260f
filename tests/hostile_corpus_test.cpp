// Hundreds of damaged files of every format, made here from whole ones, and what becomes of each: hostile/corpus.txt
// tells. After a change that is meant, CHIARO_RENEW=1 writes the list anew.
#include "hostile/judgement.h"
#include "hostile/mutations.h"
#include "volume_files.h"

#include <chiaro/error.h>
#include <fmt/format.h>

#include <atomic>
#include <map>
#include <mutex>
#include <thread>

using chiaro::Volume;
using namespace hostile;

namespace {

const std::string list_file = of_project("tests/hostile/corpus.txt");

struct Case {
    const Seed* seed;
    Mutant mutant;
    std::string name() const { return seed->name + " " + mutant.name; }
};

std::vector<Case> all_cases() {
    std::vector<Case> cases;
    for (const Seed& seed : seeds())
        for (Mutant& mutant : named_mutants(seed)) cases.push_back({&seed, std::move(mutant)});
    return cases;
}

Volume read_through_helper(const std::string& path) {
    chiaro::ReadOptions options;
    options.max_bytes = permitted_bytes(path, 0);
    return volume_files::read(path, options);
}

/// Four at a time: most of the time passes in helper programs.
std::vector<Judgement> judgements_of(const std::vector<Case>& cases) {
    const volume_files::Folder folder;
    setenv("CHIARO_DECODE", built("chiaro-decode").c_str(), 1);
    std::vector<Judgement> outcomes(cases.size());
    std::atomic<std::size_t> next{0};
    std::vector<std::thread> workers;
    for (int w = 0; w < 4; ++w)
        workers.emplace_back([&, own = folder / std::to_string(w)] {
            for (std::size_t i; (i = next++) < cases.size();) {
                // Each in a folder of its own, with a name that says which: parts of it come up in sentences.
                outcomes[i] = judgement_of(*cases[i].seed, cases[i].mutant.bytes, own / "files", read_through_helper);
                std::filesystem::remove_all(own / "files");
            }
        });
    for (auto& worker : workers) worker.join();
    return outcomes;
}

/// "refused", "as whole": the contents of the seed, or the hash of other contents, exact to the bit.
std::string word_for(const Judgement& outcome, const Judgement& whole) {
    if (!outcome.is_read) return "refused";
    const std::string word = outcome.contents == whole.contents ? "as-whole" : fmt::format("{:016x}", outcome.contents);
    return outcome.is_doubted ? word + ",doubted" : word;
}

std::map<std::string, std::string> expected() {
    std::map<std::string, std::string> list;
    std::ifstream file(list_file);
    for (std::string seed, mutation, word; file >> seed >> mutation >> word;) list[seed + " " + mutation] = word;
    return list;
}

TEST(HostileCorpus, EveryFileIsReadExactlyOrRefusedInOneSentence) {
    const auto cases = all_cases();
    ASSERT_GE(cases.size(), 300u);
    const auto outcomes = judgements_of(cases);
    const bool renews = std::getenv("CHIARO_RENEW") != nullptr;
    auto list = expected();
    std::string renewed;
    const Judgement* whole = nullptr;
    for (std::size_t i = 0; i < cases.size(); ++i) {
        const Judgement& outcome = outcomes[i];
        const std::string name = cases[i].name();
        if (cases[i].mutant.name == "as-it-is") {
            whole = &outcome;
            EXPECT_TRUE(outcome.is_read) << name << ": " << outcome.sentence;
        }
        EXPECT_EQ(outcome.fault, "") << name << ": " << outcome.sentence;
        if (cases[i].mutant.is_cut && !cases[i].seed->is_open_ended)
            EXPECT_TRUE(!outcome.is_read || outcome.is_doubted || outcome.contents == whole->contents)
                << name << " was taken as whole";
        const std::string word = word_for(outcome, *whole);
        renewed += fmt::format("{} {}\n", name, word);
        if (std::getenv("CHIARO_SHOW")) fmt::print("{}: {} {}\n", name, word, outcome.sentence);
        if (!renews) EXPECT_EQ(word, list[name]) << name << ": " << outcome.sentence;
        list.erase(name);
    }
    for (const auto& [name, word] : list)
        if (!renews && (reads_vdb() || name.find(".vdb ") == name.npos))
            ADD_FAILURE() << name << " is listed but no longer made";
    if (renews) std::ofstream(list_file) << renewed;
}

}  // namespace

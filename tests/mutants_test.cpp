// The mutation tools: mutants are the same each time, cuts come at every byte, and every kind of finding is found where
// readers are bad on purpose.
#include "hostile/header_edits.h"
#include "hostile/series.h"
#include "hostile/trial.h"
#include "volume_files.h"

#include <set>

using namespace hostile;

namespace {

const Seed& seed_named(const std::string& name) {
    for (const Seed& seed : seeds())
        if (seed.name == name) return seed;
    throw std::runtime_error("no seed " + name);
}

chiaro::Volume slices(int count) { return chiaro::make_volume({4, 3, count}, chiaro::VoxelType::u8); }

/// What a bad reader's answer to `mutant` is found to be, where the whole file is read as three slices.
Finding finding_with(const Mutant& mutant, const VolumeReader& read, const Limits& limits = {},
                     const std::string& name = "links-behind.tif") {
    const volume_files::Folder folder;
    const Seed& seed = seed_named(name);
    const auto judged = [&](const std::string& bytes, const VolumeReader& reader) {
        return outcome_of([&] { return judgement_of(seed, bytes, folder / "files", reader); }, limits);
    };
    const Outcome whole = judged(seed.bytes, [](const std::string&) { return slices(3); });
    EXPECT_EQ(finding_of(seed, {"as it is", seed.bytes}, whole, whole.judgement), Finding::none);
    return finding_of(seed, mutant, judged(mutant.bytes, read), whole.judgement, limits);
}

/// Without the last link's last bytes.
Mutant cut_in_link() {
    const std::string& bytes = seed_named("links-behind.tif").bytes;
    return {"cut", bytes.substr(0, bytes.size() - 3), true};
}

TEST(Mutants, AreTheSameForFormatSeedAndNumberAndOtherForAnotherSeed) {
    for (const std::string& format : formats()) {
        const Series first(format, 3), again(format, 3), other(format, 4);
        int differing = 0;
        for (std::uint64_t number = 0; number < 60; ++number) {
            EXPECT_EQ(first.mutant(number).bytes, again.mutant(number).bytes) << format << " " << number;
            differing += first.mutant(number).bytes != other.mutant(number).bytes;
        }
        EXPECT_GT(differing, 30) << format;
    }
}

TEST(Mutants, CutEveryFileAtEveryByte) {
    const Series series("nrrd", 5);
    std::map<const Seed*, std::set<std::size_t>> cuts;
    for (std::uint64_t number = 0; number < 9000; ++number)
        if (series.damage_of(number) == Damage::cut) {
            const Mutant mutant = series.mutant(number);
            EXPECT_TRUE(mutant.is_cut);
            EXPECT_TRUE(cuts[&series.file_of(number)].insert(mutant.bytes.size()).second) << "twice";
        }
    ASSERT_EQ(cuts.size(), 8u);
    for (const auto& [seed, sizes] : cuts) EXPECT_EQ(sizes.size(), seed->bytes.size()) << seed->name;
}

TEST(Mutants, EditHeadersOfEveryFormat) {
    for (const char* name : {"attached.nrrd", "attached.mha", "binary.vtk", "appended.vti", "scene.json", "plain.hdr"})
        EXPECT_GE(text_fields(seed_named(name)).size(), 3u) << name;
    for (const char* name : {"one.nii", "pages.tif", "slice.dcm", "plain.h5", "scene.png", "scene.exr"})
        EXPECT_GE(binary_fields(seed_named(name)).size(), 6u) << name;
    std::mt19937_64 random(1);
    std::set<std::string> edits;
    const Seed& seed = seed_named("attached.nrrd");
    for (int i = 0; i < 3000; ++i) edits.insert(edited_header(seed, random).bytes);
    const auto made = [&](const std::string& part) {
        return std::any_of(edits.begin(), edits.end(), [&](const auto& e) { return e.find(part) != e.npos; });
    };
    EXPECT_TRUE(made("sizes: 9223372036854775807 3 2\n"));
    EXPECT_TRUE(made("(1.7976931348623157e308,0,0)"));
    EXPECT_TRUE(made("sizes: 7 3 2\nsizes: 4 3 2\n"));
    EXPECT_TRUE(made("sizes: 4 3 2\nsizes: 4 7 2\n"));
    EXPECT_TRUE(made("\nspacings: 9 9 9\n"));
}

TEST(Mutants, ACutThatLosesVoxelsWithoutANoteIsFound) {
    const auto one_slice = [](const std::string&) { return slices(1); };
    const auto with_a_note = [](const std::string&) {
        chiaro::Volume volume = slices(1);
        volume.notes = {"two slices are missing"};
        return volume;
    };
    EXPECT_EQ(finding_with(cut_in_link(), one_slice), Finding::lost);
    EXPECT_EQ(finding_with(cut_in_link(), with_a_note), Finding::none);
    EXPECT_EQ(finding_with(cut_in_link(), [](const std::string&) { return slices(3); }), Finding::none);
}

TEST(Mutants, ACutPictureThatIsTakenAsASceneIsFound) {
    for (const char* name : {"scene.png", "scene.exr"}) {
        const Seed& seed = seed_named(name);
        const Mutant cut{"cut", seed.bytes.substr(0, seed.bytes.size() - 1), true};
        Outcome same;
        same.judgement.is_read = true;
        EXPECT_EQ(finding_of(seed, cut, same, same.judgement), Finding::lost);
        EXPECT_EQ(finding_of(seed, {"as it is", seed.bytes}, same, same.judgement), Finding::none);
    }
}

TEST(Mutants, AContradictionWithoutANoteIsFound) {
    const Seed& seed = seed_named("attached.nrrd");
    std::string twice = seed.bytes;
    twice.insert(twice.find("sizes:"), "sizes: 4 3 1\n");
    const auto takes_all = [](const std::string&) { return slices(3); };
    EXPECT_EQ(finding_with({"twice", twice, false, true}, takes_all, {}, seed.name), Finding::untold);
    const auto refuses = [](const std::string& path) -> chiaro::Volume {
        throw chiaro::Error(chiaro::ErrorCode::input, path + " has two sizes");
    };
    EXPECT_EQ(finding_with({"twice", twice, false, true}, refuses, {}, seed.name), Finding::none);
}

TEST(Mutants, TimeIsFound) {
    const auto never_ends = [](const std::string&) -> chiaro::Volume {
        for (volatile bool again = true; again;) {
        }
        return slices(3);
    };
    EXPECT_EQ(finding_with(cut_in_link(), never_ends, {.cpu_seconds = 0.5}), Finding::time);
    const auto sleeps = [](const std::string&) -> chiaro::Volume {
        for (;;) pause();
    };
    EXPECT_EQ(finding_with(cut_in_link(), sleeps, {.patience_seconds = 1}), Finding::hang);
}

TEST(Mutants, MemoryIsFoundHereAndInADecoder) {
    const auto takes_much = [](const std::string&) {
        const std::vector<char> much(200 << 20, 'm');
        return slices(int(much[5000] - 'm') + 3);
    };
    const auto starts_what_takes_much = [](const std::string&) {
        // The shell's variable holds what the pipe brings.
        EXPECT_EQ(std::system("x=$(head -c 200000000 /dev/zero | tr '\\0' x); test ${#x} -eq 200000000"), 0);
        return slices(3);
    };
    EXPECT_EQ(finding_with(cut_in_link(), takes_much), Finding::memory);
    EXPECT_EQ(finding_with(cut_in_link(), starts_what_takes_much), Finding::memory);
}

TEST(Mutants, ACrashAndARefusalThatIsNoSentenceAreFound) {
    const auto crashes = [](const std::string&) -> chiaro::Volume { std::abort(); };
    const auto says_nothing = [](const std::string&) -> chiaro::Volume { throw std::length_error("vector::reserve"); };
    EXPECT_EQ(finding_with(cut_in_link(), crashes), Finding::crash);
    EXPECT_EQ(finding_with(cut_in_link(), says_nothing), Finding::sentence);
}

TEST(Mutants, WhatFailsWhenAVolumeIsShownIsFound) {
    const volume_files::Folder folder;
    const Seed& seed = seed_named("attached.nrrd");
    const auto read = [](const std::string&) { return slices(3); };
    const auto shown = [&](const VolumeUser& use) {
        return judgement_of(seed, seed.bytes, folder / "files", read, use).fault;
    };
    EXPECT_EQ(shown([](chiaro::Volume&&) {}), "");
    EXPECT_EQ(shown([](chiaro::Volume&&) { throw std::length_error("vector::reserve"); }), "shown: it is no Error");
}

}  // namespace

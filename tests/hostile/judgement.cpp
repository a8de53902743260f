#include "hostile/judgement.h"

#include "core/text.h"
#include "illumination/histogram/cache.h"
#include "illumination/histogram/emission.h"
#include "illumination/histogram/hash.h"

#include <chiaro/chiaro.h>

#include <fstream>

namespace hostile {
namespace {

using namespace chiaro;
namespace fs = std::filesystem;

void write(const fs::path& path, const std::string& bytes) { std::ofstream(path, std::ios::binary) << bytes; }

std::string printable_name(std::string name) {
    for (char& c : name)
        if (c == '/' || c == '\0') c = '_';
    name = name.substr(0, 200);
    return name.empty() || name == "." || name == ".." ? "empty" : name;
}

template <class T>
std::uint64_t hash_of_values(std::span<const T> values, std::uint64_t seed = 0) {
    return hash_of(std::as_bytes(values), seed);
}

bool has_doubt(const std::vector<std::string>& notes) {
    for (const std::string& note : notes)
        for (const char* doubt : {"may be cut", "were skipped"})
            if (note.find(doubt) != note.npos) return true;
    return false;
}

void take_notes(const std::vector<std::string>& notes, Judgement& outcome) {
    outcome.is_doubted = has_doubt(notes);
    for (const std::string& note : notes) outcome.notes = hash_of(note, outcome.notes);
}

std::uint64_t contents_of(const Volume& v, Judgement& outcome) {
    take_notes(v.notes, outcome);
    const auto& g = v.geometry;
    std::vector<double> numbers{double(v.type), double(v.components), v.slope, v.intercept, double(g.world)};
    for (int axis = 0; axis < 3; ++axis) {
        numbers.insert(numbers.end(), {double(v.dimensions[axis]), g.spacing_mm[axis], g.origin_mm[axis]});
        for (int i = 0; i < 3; ++i) numbers.push_back(g.direction[axis][i]);
    }
    for (double& number : numbers) number += 0.0;  // -0 is 0
    return hash_of({v.voxels.data(), v.voxels.size()}, hash_of_values(std::span<const double>(numbers)));
}

std::uint64_t read_cache(const fs::path& folder) {
    std::vector<std::string> notes;
    const auto found = HistogramCache(folder, cached_volume().data(), {}).read(notes);
    if (!found) throw Error(ErrorCode::input, notes.empty() ? "" : notes[0]);
    return hash_of_values(std::span<const std::uint16_t>(found->shares),
                          hash_of({found->identifiers.data(), found->identifiers.size()}));
}

/// The file is good; what fails now must still be the file's doing, or the program is at fault.
void use_volume(Volume volume, const VolumeUser& use, Judgement& outcome) {
    if (!use) return;
    try {
        use(std::move(volume));
    } catch (const Error& error) {
        outcome.sentence = error.what();
        if (error.code() != ErrorCode::input) outcome.fault = "shown: its code is " + std::to_string(int(error.code()));
    } catch (const std::exception& error) {
        outcome.sentence = error.what();
        outcome.fault = "shown: it is no Error";
    }
}

std::uint64_t contents_at(const Seed& seed, const fs::path& path, const VolumeReader& read_volume,
                          const VolumeUser& use, Judgement& outcome) {
    switch (seed.kind) {
        case Kind::volume:
        case Kind::raw_name: {
            Volume volume = read_volume(path);
            const std::uint64_t contents = contents_of(volume, outcome);
            use_volume(std::move(volume), use, outcome);
            return contents;
        }
        case Kind::probe:
            return hash_of_values(load_probe(path).rgb());
        case Kind::scene: {
            std::vector<std::string> unknown;
            const std::uint64_t contents = hash_of(to_json(read_scene(path, "", unknown)));
            take_notes(unknown, outcome);
            return contents;
        }
        case Kind::transfer: {
            Statistics unit;
            unit.max = unit.p99 = unit.p999 = 1;
            const TransferFile file = read_transfer_file(path, unit);
            take_notes(file.notes, outcome);
            return hash_of(to_json(file.function));
        }
        case Kind::emission: {
            const EmissionMapping emission{path.string()};
            std::vector<double> values;
            for (double v = 0; v < 256; v += 0.5) values.push_back(emission.at(v));
            return hash_of_values(std::span<const double>(values));
        }
        case Kind::cache:
            return read_cache(path.parent_path());
    }
    return 0;
}

std::string fault_of(const Error& error, const fs::path& opened) {
    const std::string sentence = error.what();
    if (error.code() != ErrorCode::input) return "its code is " + std::to_string(int(error.code()));
    if (sentence.empty() || sentence.size() > 1500) return "it is no sentence";
    if (one_line(sentence, sentence.size()) != sentence) return "it is not one line of text";
    const std::string name = one_line(opened.filename().string());
    return sentence.find(name) == sentence.npos ? "it does not name the file" : "";
}

}  // namespace

std::uint64_t permitted_bytes(const std::string& path, std::uint64_t others) {
    constexpr std::uint64_t of_sparse = std::uint64_t(16) << 20;
    return path.ends_with(".vdb") ? of_sparse : others;
}

Judgement judgement_of(const Seed& seed, const std::string& bytes, const fs::path& folder,
                       const VolumeReader& read_volume, const VolumeUser& use) {
    fs::create_directories(folder);
    for (const auto& [name, beside] : seed.beside) write(folder / name, beside);
    const bool is_name = seed.kind == Kind::raw_name;
    const fs::path file = folder / (is_name ? printable_name(bytes) : seed.name);
    write(file, is_name ? std::string(24, 'v') : seed.packed ? seed.packed(bytes) : bytes);
    const fs::path opened = seed.opened.empty() ? file : seed.opened == "." ? folder : folder / seed.opened;
    Judgement outcome;
    try {
        outcome.contents = contents_at(seed, opened, read_volume, use, outcome);
        outcome.is_read = true;
    } catch (const Error& error) {
        outcome.sentence = error.what();
        outcome.fault = fault_of(error, opened);
    } catch (const std::exception& error) {
        outcome.sentence = error.what();
        outcome.fault = "it is no Error";
    }
    return outcome;
}

}  // namespace hostile

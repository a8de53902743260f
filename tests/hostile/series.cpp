#include "hostile/series.h"

#include "hostile/header_edits.h"
#include "illumination/histogram/hash.h"

#include <algorithm>

namespace hostile {
namespace {

constexpr std::uint64_t kinds = 3;

}  // namespace

std::vector<std::string> formats() {
    std::vector<std::string> names;
    for (const Seed& seed : seeds())
        if (std::find(names.begin(), names.end(), seed.format) == names.end()) names.push_back(seed.format);
    return names;
}

Series::Series(const std::string& format, std::uint64_t seed) : format_(format), seed_(seed) {
    for (const Seed& file : seeds())
        if (file.format == format) files_.push_back(&file);
}

const Seed& Series::file_of(std::uint64_t number) const { return *files_[number / kinds % files_.size()]; }

Damage Series::damage_of(std::uint64_t number) const {
    const std::uint64_t turn = number / kinds / files_.size();
    const auto damage = Damage(number % kinds);
    if (damage != Damage::cut || turn < file_of(number).bytes.size()) return damage;
    return turn % 2 ? Damage::bytes : Damage::header;
}

Mutant Series::mutant(std::uint64_t number) const {
    const Seed& file = file_of(number);
    std::mt19937_64 random(chiaro::hash_of(format_, seed_ * 0x9e3779b97f4a7c15 + number));
    switch (damage_of(number)) {
        case Damage::cut:
            return cut_mutant(file, seed_ + number / kinds / files_.size());
        case Damage::header:
            return edited_header(file, random);
        case Damage::bytes:
            break;
    }
    return random_mutant(file, seeds()[random() % seeds().size()], random);
}

}  // namespace hostile

// Mutants by number: format, seed and number are enough to make one again.
#pragma once
#include "hostile/mutations.h"

#include <string_view>

namespace hostile {

enum class Damage { cut, bytes, header };
constexpr std::string_view damage_names[] = {"cut", "bytes", "header"};

/// In the order of seeds().
std::vector<std::string> formats();

/// What is done to the files of one format: by turns cut, changed anywhere, and edited as a header. Once every file was
/// cut at every byte, the turns of cuts go to the other two.
class Series {
public:
    Series(const std::string& format, std::uint64_t seed);
    const std::string& format() const { return format_; }
    std::uint64_t seed() const { return seed_; }
    const Seed& file_of(std::uint64_t number) const;
    Damage damage_of(std::uint64_t number) const;
    Mutant mutant(std::uint64_t number) const;

private:
    std::string format_;
    std::uint64_t seed_;
    std::vector<const Seed*> files_;
};

}  // namespace hostile

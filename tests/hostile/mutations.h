// Ways to damage a file, told by name so that a case can be found again.
#pragma once
#include "hostile/seeds.h"

#include <cstdint>
#include <random>

namespace hostile {

struct Mutant {
    std::string name, bytes;
    bool is_cut = false;            ///< nothing but the end is missing
    bool is_contradiction = false;  ///< two parts of it cannot both be true: to be refused, or told
};

/// The corpus of one seed: always the same.
std::vector<Mutant> named_mutants(const Seed& seed);

/// Cut at a place that is another one for each `turn` below the size of the seed.
Mutant cut_mutant(const Seed& seed, std::uint64_t turn);

/// One to four random changes: bits, bytes, numbers of 1, 2, 4 and 8 bytes or of text set to the awkward, pieces left
/// out, doubled, moved or taken from `other`; every second one repaired where the seed can be. The same
/// for the same state of `random`.
Mutant random_mutant(const Seed& seed, const Seed& other, std::mt19937_64& random);

}  // namespace hostile

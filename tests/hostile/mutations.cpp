#include "hostile/mutations.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cctype>
#include <cstring>

namespace hostile {
namespace {

using Random = std::mt19937_64;

/// Where the numbers of a text stand: position and length.
std::vector<std::pair<std::size_t, std::size_t>> numbers_of(const std::string& text) {
    std::vector<std::pair<std::size_t, std::size_t>> found;
    for (std::size_t i = 0; i < text.size();) {
        std::size_t end = i;
        while (end < text.size() && std::isdigit(static_cast<unsigned char>(text[end]))) ++end;
        if (end > i) found.emplace_back(i, end - i);
        i = std::max(end, i + 1);
    }
    return found;
}

constexpr const char* awkward_texts[] = {"0",      "-1",  "65536", "2147483648", "99999999999999999999",
                                         "nan",    "inf", "1e308", "-3e38",      "0x10",
                                         "1e-320", "",    "4,5",   "%d",         "\"x\""};
constexpr std::uint64_t awkward_numbers[] = {0,
                                             1,
                                             0x7f,
                                             0x80,
                                             0xff,
                                             0x7fff,
                                             0x8000,
                                             0xffff,
                                             0x7fffffff,
                                             0x80000000,
                                             0xffffffff,
                                             0x7f800000,
                                             0x7fc00000,
                                             0x7fffffffffffffff,
                                             ~std::uint64_t(0)};

std::string replaced(const std::string& text, std::pair<std::size_t, std::size_t> where, std::string_view by) {
    return text.substr(0, where.first) + std::string(by) + text.substr(where.first + where.second);
}

std::string with_line_ends(const std::string& text, const std::string& end) {
    std::string result;
    for (char c : text) result += c == '\n' ? end : std::string(1, c);
    return result;
}

void put(std::string& bytes, std::size_t at, std::uint64_t value, std::size_t size, bool big_endian) {
    for (std::size_t i = 0; i < size && at + i < bytes.size(); ++i)
        bytes[at + i] = char(value >> 8 * (big_endian ? size - 1 - i : i));
}

std::size_t below(Random& random, std::size_t end) { return end ? std::size_t(random() % end) : 0; }

/// More often near the start, where headers are.
std::size_t place(Random& random, std::size_t size) {
    return below(random, random() % 2 ? std::min<std::size_t>(size, 400) : size);
}

std::string change(std::string bytes, const Seed& seed, const Seed& other, Random& random) {
    const std::size_t size = bytes.size(), at = place(random, size);
    const std::size_t count = 1 + below(random, std::min<std::size_t>(size - std::min(at, size) + 1, 64));
    if (bytes.empty()) return "x";
    switch (below(random, seed.is_text ? 12 : 9)) {
        case 0:
            bytes[at] = char(bytes[at] ^ 1 << below(random, 8));
            break;
        case 1:
            bytes[at] = char(random());
            break;
        case 2:
        case 3: {
            constexpr std::array<std::size_t, 4> sizes{1, 2, 4, 8};
            const std::uint64_t value = awkward_numbers[below(random, std::size(awkward_numbers))];
            put(bytes, at, value, sizes[below(random, 4)], random() % 4 == 0);
            break;
        }
        case 4:
            bytes.erase(at, count);
            break;
        case 5:
            bytes.insert(at, bytes.substr(at, count));
            break;
        case 6: {
            const std::size_t from = below(random, other.bytes.size());
            bytes.insert(at, other.bytes.substr(from, count));
            break;
        }
        case 7:
            for (std::size_t i = at; i < std::min(size, at + count); ++i) bytes[i] = char(random());
            break;
        case 8:
            std::rotate(bytes.begin() + std::ptrdiff_t(at), bytes.begin() + std::ptrdiff_t(at + (size - at) / 2),
                        bytes.end());
            break;
        default:
            if (const auto numbers = numbers_of(bytes); !numbers.empty())
                bytes = replaced(bytes, numbers[below(random, numbers.size())],
                                 awkward_texts[below(random, std::size(awkward_texts))]);
    }
    return bytes;
}

void add_numbers(const Seed& seed, std::vector<Mutant>& all) {
    const auto numbers = numbers_of(seed.bytes);
    for (const char* text : {"2147483648", "-1", "99999999999999999999", "nan", "0"})
        for (std::size_t k = 1; k <= 3; ++k) {
            const std::size_t which = numbers.size() * k / 4;
            if (which < numbers.size())
                all.push_back(
                    {"number-" + std::to_string(which) + "=" + text, replaced(seed.bytes, numbers[which], text)});
        }
}

void add_fields(const Seed& seed, std::vector<Mutant>& all) {
    for (const std::size_t at : {std::size_t(4), std::size_t(16), std::size_t(42), std::size_t(70), std::size_t(108)})
        for (const auto& [name, value] : {std::pair("2^31", 0x80000000u), std::pair("2^32-1", 0xffffffffu)}) {
            if (at + 4 > seed.bytes.size()) continue;
            std::string bytes = seed.bytes;
            put(bytes, at, value, 4, false);
            all.push_back({"field-at-" + std::to_string(at) + "=" + name, bytes});
        }
}

}  // namespace

std::vector<Mutant> named_mutants(const Seed& seed) {
    const std::string& b = seed.bytes;
    const std::size_t n = b.size();
    const auto with = [&](std::size_t at, char value) {
        std::string bytes = b;
        bytes[std::min(at, n - 1)] = char(bytes[std::min(at, n - 1)] ^ value);
        return bytes;
    };
    const auto spread = [&](std::size_t at, std::size_t count, char value) {
        std::string bytes = b;
        for (std::size_t i = at; i < std::min(n, at + count); ++i) bytes[i] = value;
        return bytes;
    };
    std::vector<Mutant> all{{"as-it-is", b}};
    for (const auto& [name, size] :
         {std::pair("cut-to-nothing", std::size_t(0)), std::pair("cut-to-a-byte", std::size_t(1)),
          std::pair("cut-at-a-quarter", n / 4), std::pair("cut-at-half", n / 2),
          std::pair("cut-at-nine-tenths", n * 9 / 10), std::pair("cut-by-a-byte", n - 1)})
        all.push_back({name, b.substr(0, size), true});
    all.push_back({"twice", b + b});
    all.push_back({"64-KiB-of-zeros-behind", b + std::string(65536, '\0')});
    all.push_back({"first-byte-flipped", with(0, 1)});
    all.push_back({"byte-at-a-third-flipped", with(n / 3, 0x20)});
    all.push_back({"byte-at-two-thirds-flipped", with(2 * n / 3, 0x10)});
    all.push_back({"last-byte-flipped", with(n - 1, 0x40)});
    all.push_back({"ones-at-a-quarter", spread(n / 4, 16, '\xff')});
    all.push_back({"zeros-from-half", spread(n / 2, n, '\0')});
    all.push_back({"halves-swapped", b.substr(n / 2) + b.substr(0, n / 2)});
    all.push_back({"line-ends-of-Windows", with_line_ends(b, "\r\n")});
    all.push_back({"no-line-ends", with_line_ends(b, "")});
    seed.is_text ? add_numbers(seed, all) : add_fields(seed, all);
    if (seed.repair)
        for (std::size_t i = 1, count = all.size(); i < count; ++i)
            if (!all[i].is_cut) all.push_back({all[i].name + "-repaired", seed.repair(all[i].bytes)});
    return all;
}

Mutant cut_mutant(const Seed& seed, std::uint64_t turn) {
    constexpr std::uint64_t stride = 1000003;  // a prime beyond the sizes of seeds: every place once
    const std::size_t size = std::size_t(turn % seed.bytes.size() * stride % seed.bytes.size());
    return {"cut at " + std::to_string(size), seed.bytes.substr(0, size), true};
}

Mutant random_mutant(const Seed& seed, const Seed& other, Random& random) {
    std::string bytes = seed.bytes;
    for (std::size_t i = 0, count = 1 + below(random, 4); i < count; ++i) bytes = change(bytes, seed, other, random);
    if (seed.repair && random() % 2) bytes = seed.repair(bytes);
    return {"changed", bytes};
}

}  // namespace hostile

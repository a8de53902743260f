#include "hostile/header_edits.h"

#include <algorithm>
#include <bit>
#include <cctype>
#include <cmath>
#include <limits>
#include <string_view>

namespace hostile {
namespace {

using Random = std::mt19937_64;

constexpr const char* extreme_texts[] = {"1.7976931348623157e308",
                                         "-1.7976931348623157e308",
                                         "1e300",
                                         "1e50",
                                         "1e13",
                                         "1e-13",
                                         "1e-50",
                                         "1e-300",
                                         "5e-324",
                                         "1e309",
                                         "9223372036854775807",
                                         "-9223372036854775808",
                                         "9223372036854775808",
                                         "18446744073709551615",
                                         "18446744073709551616",
                                         "4294967295",
                                         "4294967296",
                                         "2147483647",
                                         "-2147483648",
                                         "65535",
                                         "65536",
                                         "-1",
                                         "-5",
                                         "0",
                                         "-0",
                                         "1.5",
                                         "nan",
                                         "-nan",
                                         "inf",
                                         "-inf"};
constexpr double extreme_reals[] = {0,
                                    -0.0,
                                    -1,
                                    1e-13,
                                    1e13,
                                    1e-30,
                                    1e30,
                                    1e-300,
                                    1e300,
                                    3e38,
                                    -3e38,
                                    std::numeric_limits<double>::max(),
                                    std::numeric_limits<double>::lowest(),
                                    std::numeric_limits<double>::denorm_min(),
                                    std::numeric_limits<double>::infinity(),
                                    -std::numeric_limits<double>::infinity(),
                                    std::numeric_limits<double>::quiet_NaN()};

template <class List>
const auto& one_of(const List& list, Random& random) {
    return list[std::size_t(random() % std::size(list))];
}

struct Range {
    std::size_t begin, end;
};

bool is_in_number(char c) { return std::isdigit(static_cast<unsigned char>(c)) || c == '.' || c == '-' || c == '+'; }

std::vector<Range> numbers_in(const std::string& text, std::size_t begin, std::size_t end) {
    std::vector<Range> found;
    for (std::size_t i = begin; i < end;) {
        std::size_t stop = i;
        while (stop < end && (is_in_number(text[stop]) || (stop > i && (text[stop] == 'e' || text[stop] == 'E'))))
            ++stop;
        if (stop > i) found.push_back({i, stop});
        i = std::max(stop, i + 1);
    }
    return found;
}

std::string replaced(const std::string& text, Range where, std::string_view by) {
    return std::string(text).replace(where.begin, where.end - where.begin, by);
}

std::string field_name(const std::string& text, const TextField& field) {
    std::string name = text.substr(field.begin, std::min<std::size_t>(field.value_begin - field.begin, 24));
    for (char& c : name)
        if (c < ' ') c = ' ';
    return name;
}

Mutant with_extremes(const std::string& text, const TextField& field, Random& random) {
    const auto numbers = numbers_in(text, field.value_begin, field.value_end);
    const std::string extreme = one_of(extreme_texts, random);
    const std::string name = field_name(text, field) + extreme;
    if (numbers.empty()) return {name, replaced(text, {field.value_begin, field.value_end}, extreme)};
    if (random() % 3) return {name, replaced(text, one_of(numbers, random), extreme)};
    std::string all = text;
    for (auto number = numbers.rbegin(); number != numbers.rend(); ++number) all = replaced(all, *number, extreme);
    return {"all of " + name, all};
}

/// Given twice, once with another number.
Mutant given_twice(const std::string& text, const TextField& field, Random& random) {
    const auto numbers = numbers_in(text, field.value_begin, field.value_end);
    const std::string whole = text.substr(field.begin, field.end - field.begin);
    std::string other = whole;
    if (!numbers.empty()) {
        const Range number = one_of(numbers, random);
        const std::string was = text.substr(number.begin, number.end - number.begin);
        other = replaced(whole, {number.begin - field.begin, number.end - field.begin}, was == "7" ? "6" : "7");
    }
    const bool is_first = random() % 2;
    const bool is_contradiction = field.is_single && other != whole;
    return {"twice: " + field_name(text, field),
            replaced(text, {field.begin, field.end}, is_first ? other + whole : whole + other), false,
            is_contradiction};
}

Mutant exchanged(const std::string& text, const std::vector<TextField>& fields, Random& random) {
    const TextField *a = &one_of(fields, random), *b = &one_of(fields, random);
    if (a->value_begin > b->value_begin) std::swap(a, b);
    if (a->value_end > b->value_begin) return {"as it is", text};
    const auto value = [&](const TextField& f) { return text.substr(f.value_begin, f.value_end - f.value_begin); };
    const std::string behind = replaced(text, {b->value_begin, b->value_end}, value(*a));
    return {"exchanged: " + field_name(text, *a) + field_name(text, *b),
            replaced(behind, {a->value_begin, a->value_end}, value(*b))};
}

Mutant edited_text(const std::string& text, const std::vector<TextField>& fields, Random& random) {
    const TextField& field = one_of(fields, random);
    switch (random() % 10) {
        case 0:
        case 1:
            return given_twice(text, field, random);
        case 2:
            return {"without " + field_name(text, field), replaced(text, {field.begin, field.end}, "")};
        case 3:
            return exchanged(text, fields, random);
        case 4:
            return {"one more: " + field_name(text, field), replaced(text, {field.value_end, field.value_end},
                                                                     std::string(" ") + one_of(extreme_texts, random))};
        default:
            return with_extremes(text, field, random);
    }
}

void put(std::string& bytes, const BinaryField& field, std::uint64_t value) {
    for (std::size_t i = 0; i < field.size && field.at + i < bytes.size(); ++i)
        bytes[field.at + i] = char(value >> 8 * (field.is_big_endian ? field.size - 1 - i : i));
}

std::uint64_t extreme_integer(const BinaryField& field, std::size_t file_size, Random& random) {
    const std::uint64_t sign = std::uint64_t(1) << (8 * field.size - 1);
    const std::uint64_t values[] = {0,
                                    1,
                                    2,
                                    sign,
                                    sign - 1,
                                    sign + 1,
                                    ~std::uint64_t(0),
                                    file_size,
                                    file_size - 1,
                                    file_size + 1,
                                    0x7fffffff,
                                    0x80000000,
                                    0xfffffffe,
                                    0xff};
    return one_of(values, random);
}

Mutant edited_bytes(const Seed& seed, const std::vector<BinaryField>& fields, Random& random) {
    Mutant mutant{"", seed.bytes};
    for (std::uint64_t i = 0, count = 1 + random() % 2; i < count; ++i) {
        const BinaryField& field = one_of(fields, random);
        std::uint64_t value = extreme_integer(field, seed.bytes.size(), random);
        if (field.is_real) value = std::bit_cast<std::uint32_t>(float(one_of(extreme_reals, random)));
        put(mutant.bytes, field, value);
        mutant.name += "at " + std::to_string(field.at) + ": " + std::to_string(value) + " ";
    }
    if (seed.repair) mutant.bytes = seed.repair(mutant.bytes);
    return mutant;
}

/// An element of DICOM, its length as its value: with extremes, or twice, once with another digit.
Mutant edited_element(const std::string& bytes, const TextField& element, Random& random) {
    const auto digit = bytes.find_first_of("0123456789", element.value_begin);
    const std::string at = " at " + std::to_string(element.begin);
    if (random() % 4 == 0 && digit < element.value_end) {
        std::string other = bytes.substr(element.begin, element.end - element.begin);
        char& changed = other[digit - element.begin];
        changed = changed == '7' ? '6' : '7';
        return {"twice: element" + at, replaced(bytes, {element.begin, element.begin}, other), false, true};
    }
    Mutant mutant = with_extremes(bytes, element, random);
    mutant.name = "extremes in the element" + at;
    std::size_t length = element.value_end - element.value_begin + mutant.bytes.size() - bytes.size();
    if (length % 2) mutant.bytes.insert(element.value_begin + length++, " ");
    put(mutant.bytes, {element.value_begin - 2, 2}, length);
    return mutant;
}

struct Lie {
    const char *seed, *name;
    std::string_view find, replacement;
};

using namespace std::literals;
constexpr Lie lies[] = {
    {"attached.nrrd", "spacings beside directions", "encoding: raw\n"sv, "encoding: raw\nspacings: 9 9 9\n"sv},
    {"attached.nrrd", "line skip of -1", "encoding: raw\n"sv, "encoding: raw\nline skip: -1\n"sv},
    {"attached.nrrd", "byte skip of -2", "encoding: raw\n"sv, "encoding: raw\nbyte skip: -2\n"sv},
    {"numbers.nrrd", "words behind the values", "250\n"sv, "250\nand more\n"sv},
    {"detached.nhdr", "NUL in a name", "beside.raw"sv, "beside.raw\0x"sv},
    {"attached.mha", "HeaderSize of -5", "NDims = 3\n"sv, "NDims = 3\nHeaderSize = -5\n"sv},
    {"detached.mhd", "NUL in a name", "beside.bin"sv, "beside.bin\0x"sv},
    {"numbers.vtk", "words behind the values", " 250\n"sv, " 250\nand more\n"sv},
    {"numbers.vti", "words behind the values", "24\n</DataArray>"sv, "24 and more\n</DataArray>"sv},
    {"numbers.vti", "a piece that is less", "Piece Extent=\"0 3 0 2 0 1\""sv, "Piece Extent=\"0 3 0 2 0 0\""sv},
    {"slice.dcm", "a syntax of compression over plain pixels", "1.2.840.10008.1.2.1\0"sv, "1.2.840.10008.1.2.5\0"sv},
    {"plain.hdr", "half a row", "-Y 3 "sv, "-Y 3.5 "sv},
    {"coded.hdr", "half a row", "-Y 3 "sv, "-Y 3.5 "sv},
    {"head_4x3x2_uint8.raw", "a minus", "_4x3"sv, "_-4x3"sv},
};

}  // namespace

std::vector<Mutant> contradictions(const Seed& seed) {
    std::vector<Mutant> all;
    for (const Lie& lie : lies)
        if (const std::size_t at = seed.bytes.find(lie.find); seed.name == lie.seed && at != std::string::npos)
            all.push_back({lie.name, replaced(seed.bytes, {at, at + lie.find.size()}, lie.replacement), false, true});
    if (seed.name == "one.nii" || seed.name == "inside.nii.gz") {  // each component of a unit quaternion is 1 at most
        Mutant mutant{"a quaternion that is none", seed.bytes, false, true};
        for (const std::size_t at : {256u, 260u, 264u}) put(mutant.bytes, {at, 4}, std::bit_cast<std::uint32_t>(2.0F));
        all.push_back(mutant);
    }
    return all;
}

Mutant edited_header(const Seed& seed, Random& random) {
    if (const auto known = contradictions(seed); !known.empty() && random() % 20 == 0) return one_of(known, random);
    const bool is_dicom = seed.format == "dicom";  // it has both
    if (const auto fields = text_fields(seed); !fields.empty() && !(is_dicom && random() % 2))
        return is_dicom ? edited_element(seed.bytes, one_of(fields, random), random)
                        : edited_text(seed.bytes, fields, random);
    const auto fields = binary_fields(seed);
    return fields.empty() ? random_mutant(seed, seed, random) : edited_bytes(seed, fields, random);
}

}  // namespace hostile

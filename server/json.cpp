#include "json.h"

#include <fmt/format.h>

#include <cmath>
#include <new>

#include "core/text.h"
#include "memory_budget.h"

namespace chiaro::server {
namespace {

constexpr std::size_t longest_sentence = 2000;

[[noreturn]] void refuse(const char* name, const char* what) {
    throw Error(ErrorCode::usage, fmt::format("{}: must be {}", name, what));
}

std::string_view word_for(ErrorCode code) {
    switch (code) {
        case ErrorCode::usage:
            return "usage";
        case ErrorCode::input:
            return "input";
        case ErrorCode::output:
            return "output";
        case ErrorCode::interrupted:
            return "interrupted";
        default:
            return "internal";
    }
}

/// The scene key that a sentence begins with: "sampling.step 0: must be ...".
Json field_of(const std::string& sentence) {
    constexpr std::string_view plain[] = {"transfer_function", "window", "threshold", "iso", "mode", "probe", "camera",
                                          "background",        "clip"};
    const std::string word = sentence.substr(0, sentence.find_first_of(" :"));
    for (const std::string_view key : plain)
        if (word == key) return word;
    const std::size_t dot = word.find('.');
    const bool is_key = dot != word.npos && dot > 0 && dot + 1 < word.size() &&
                        word.find_first_not_of("abcdefghijklmnopqrstuvwxyz_.0123456789") == word.npos;
    return is_key ? Json(word) : Json();
}

}  // namespace

std::string text_of(const Json& json) { return json.dump(-1, ' ', false, Json::error_handler_t::replace); }

Json parse_message(std::string_view text) {
    if (is_deeper_than(40, text)) throw Error(ErrorCode::usage, "nested too deeply");
    try {
        Json message = Json::parse(text);
        if (message.is_object()) return message;
    } catch (const Json::exception&) {
    }
    throw Error(ErrorCode::usage, "a message must be a JSON object");
}

std::string text_in(const Json& request, const char* name, const std::string& otherwise) {
    const auto found = request.find(name);
    if (found == request.end() || found->is_null()) return otherwise;
    if (!found->is_string()) refuse(name, "text");
    return found->get<std::string>();
}

std::string text_in(const Json& request, const char* name) {
    if (!request.contains(name) || !request[name].is_string()) refuse(name, "text");
    return request[name].get<std::string>();
}

double number_in(const Json& request, const char* name, double lowest, double highest) {
    const double value = request.contains(name) && request[name].is_number() ? request[name].get<double>() : NAN;
    if (!(value >= lowest && value <= highest))
        throw Error(ErrorCode::usage, fmt::format("{}: must be a number from {} to {}", name, lowest, highest));
    return value;
}

int whole_in(const Json& request, const char* name, int lowest, int highest) {
    const double value = number_in(request, name, lowest, highest);
    if (value != std::floor(value)) refuse(name, "a whole number");
    return int(value);
}

bool flag_in(const Json& request, const char* name, bool otherwise) {
    const auto found = request.find(name);
    if (found == request.end() || found->is_null()) return otherwise;
    if (!found->is_boolean()) refuse(name, "true or false");
    return found->get<bool>();
}

std::pair<int, int> size_in(const Json& request, const char* name, int most) {
    const auto found = request.find(name);
    if (found == request.end() || !found->is_array() || found->size() != 2) refuse(name, "[width, height]");
    const auto side = [&](std::size_t i) {
        const double value = (*found)[i].is_number() ? (*found)[i].get<double>() : 0;
        if (!(value >= 1 && value <= most) || value != std::floor(value))
            throw Error(ErrorCode::usage, fmt::format("{}: width and height must be 1 to {} pixels", name, most));
        return int(value);
    };
    return {side(0), side(1)};
}

const Json& object_in(const Json& request, const char* name) {
    const auto found = request.find(name);
    if (found == request.end() || !found->is_object()) refuse(name, "an object");
    return *found;
}

Json error_message(const Json& re, std::string_view code, const std::string& sentence) {
    return {{"type", "error"},
            {"re", re},
            {"code", code},
            {"sentence", one_line(sentence, longest_sentence)},
            {"field", field_of(sentence)}};
}

Json current_error(const Json& re) {
    try {
        throw;
    } catch (const OutOfMemory& error) {
        return error_message(re, "memory", error.what());
    } catch (const Error& error) {
        return error_message(re, word_for(error.code()), error.what());
    } catch (const std::bad_alloc&) {
        return error_message(re, "memory",
                             "Not enough memory is free: a smaller picture or a coarser light needs less.");
    } catch (const std::exception& error) {
        return error_message(re, "internal", fmt::format("internal error: {}", error.what()));
    }
}

std::string frame_message(const Json& header, std::string_view image) {
    const std::string text = text_of(header);
    std::string message = "CHF1";
    for (int shift = 0; shift < 32; shift += 8) message += char(text.size() >> shift & 255);
    message.reserve(8 + text.size() + image.size());
    return message.append(text).append(image);
}

}  // namespace chiaro::server

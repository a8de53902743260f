#include "core/text.h"

#include <fmt/format.h>

namespace chiaro {

std::string to_text(double number) { return fmt::format("{}", number); }

std::string one_line(std::string text, std::size_t longest) {
    for (char& c : text)
        if (static_cast<unsigned char>(c) < 32 || c == 127) c = ' ';
    if (text.size() > longest) text = text.substr(0, longest) + "...";
    return text;
}

}  // namespace chiaro

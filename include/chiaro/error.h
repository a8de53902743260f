// The one exception the library throws.
#pragma once
#include <chiaro/export.h>

#include <stdexcept>
#include <string>

namespace chiaro {

/// What kind of thing went wrong; the value is the exit code of the tool.
enum class ErrorCode { internal = 1, usage = 2, input = 3, output = 4, difference = 5, interrupted = 130 };

/// One sentence that names the thing, the value and the allowed range. The library never prints and never exits.
class CHIARO_EXPORT Error : public std::runtime_error {
public:
    Error(ErrorCode code, const std::string& sentence) : std::runtime_error(sentence), code_(code) {}
    ErrorCode code() const noexcept { return code_; }

private:
    ErrorCode code_;
};

}  // namespace chiaro

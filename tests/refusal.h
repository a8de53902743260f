// Files that must be refused: which sentence says so.
#pragma once
#include <chiaro/error.h>

#include "volume_files.h"

namespace volume_files {

/// The sentence, which is of bad input and of no crash.
inline std::string refusal(const std::string& name) {
    try {
        read(name);
    } catch (const chiaro::Error& error) {
        EXPECT_EQ(error.code(), chiaro::ErrorCode::input);
        EXPECT_EQ(std::string(error.what()).find("crashed"), std::string::npos) << error.what();
        return error.what();
    }
    ADD_FAILURE() << name << " was accepted";
    return {};
}

inline void expect_refused(const std::string& name, const std::string& part) {
    const std::string sentence = refusal(name);
    EXPECT_NE(sentence.find(part), std::string::npos) << sentence;
}

}  // namespace volume_files

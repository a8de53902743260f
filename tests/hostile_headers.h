// Headers to be spoiled, and what must become of a file that is refused or noted.
#pragma once
#include "volume_files.h"

#include <chiaro/error.h>
#include <fmt/format.h>
#include <sys/resource.h>

#include <algorithm>

namespace volume_files {

inline const std::string voxels(24, 'v');
inline const std::string nrrd_start = "NRRD0004\ntype: uchar\ndimension: 3\n";
inline const std::string nrrd_good = nrrd_start + "sizes: 4 3 2\nencoding: raw\n";
inline const std::string meta_start = "ObjectType = Image\nNDims = 3\nElementType = MET_UCHAR\nBinaryData = True\n";
inline const std::string meta_good = meta_start + "DimSize = 4 3 2\n";

/// Libraries of others may crash, in their own process.
inline bool may_crash(const std::string& name) {
    return name.ends_with(".dcm") || name.ends_with(".tif") || name.ends_with(".h5");
}

/// Processor time of this process and of the helpers that ended: it does not count what else the machine does.
inline double seconds_of_work() {
    double seconds = 0;
    for (const auto who : {RUSAGE_SELF, RUSAGE_CHILDREN}) {
        rusage usage{};
        getrusage(who, &usage);
        for (const timeval& time : {usage.ru_utime, usage.ru_stime})
            seconds += double(time.tv_sec) + 1e-6 * double(time.tv_usec);
    }
    return seconds;
}

/// Reads and expects refusal in one line that names the file.
inline void expect_refused(const std::string& name, const chiaro::ReadOptions& options = {}) {
    const double before = seconds_of_work();
    try {
        read(name, options);
        ADD_FAILURE() << name << " was accepted";
    } catch (const chiaro::Error& error) {
        const std::string sentence = error.what();
        EXPECT_EQ(error.code(), chiaro::ErrorCode::input) << sentence;
        EXPECT_EQ(sentence.find('\n'), std::string::npos) << sentence;
        EXPECT_NE(sentence.find(fs::path(name).filename().string()), std::string::npos) << sentence;
        EXPECT_TRUE(may_crash(name) || sentence.find("crashed") == std::string::npos) << sentence;
        if (std::getenv("CHIARO_SHOW")) std::puts(sentence.c_str());
    }
    EXPECT_LT(seconds_of_work() - before, 20) << name;
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    EXPECT_LT(usage.ru_maxrss, 1 << 20) << "KiB after " << name;
}

/// Reads and expects a note with this text in it.
inline void expect_noted(const std::string& name, const std::string& text) {
    const auto notes = read(name).notes;
    EXPECT_TRUE(std::any_of(notes.begin(), notes.end(), [&](auto& note) { return note.find(text) != note.npos; }))
        << name << ": " << fmt::format("{}", fmt::join(notes, "; "));
}

inline std::string replaced(std::string text, const std::string& from, const std::string& to) {
    const auto at = text.find(from);
    EXPECT_NE(at, text.npos) << from;
    return at == text.npos ? text : text.replace(at, from.size(), to);
}

}  // namespace volume_files

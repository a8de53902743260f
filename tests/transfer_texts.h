// Reading a text as a transfer function, and what it takes to judge the result.
#pragma once
#include <chiaro/chiaro.h>
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>

namespace chiaro::testing {

inline Statistics range(double min, double max) {
    Statistics data;
    data.min = data.p1 = min, data.max = data.p99 = data.p999 = max;
    return data;
}
inline const Statistics bytes = range(0, 200);

inline TransferFile parsed(const std::string& text, const std::string& name) {
    return parse_transfer_file(text, name, bytes);
}

inline std::string refusal(const std::string& text, const std::string& name, ErrorCode code = ErrorCode::input) {
    try {
        parsed(text, name);
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), code);
        return error.what();
    }
    return "no error";
}

/// Largest distance of a function's colours from another way of saying them.
template <class Wanted>
double worst(const TransferFunction& tf, double low, double high, const Wanted& wanted) {
    double most = 0;
    for (int i = 0; i <= 20000; ++i) {
        const double t = i / 20000.0;
        const Rgb is = evaluate(tf, std::lerp(low, high, t)).rgb, should = wanted(t);
        for (int c = 0; c < 3; ++c) most = std::max(most, std::abs(is[c] - should[c]));
    }
    return most;
}

inline std::string notes(const TransferFile& file) {
    std::string all;
    for (const auto& note : file.notes) all += note + "\n";
    return all;
}

inline std::string paraview(const std::string& space, const std::string& colors, const std::string& more = "") {
    return R"([{"Name": "a", "ColorSpace": ")" + space + R"(", "RGBPoints": [)" + colors + "]" + more + "}]";
}

}  // namespace chiaro::testing

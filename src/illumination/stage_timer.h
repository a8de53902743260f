// What an illumination method consists of, step by step, with the time that each took.
#pragma once
#include <chiaro/progress.h>

#include <chrono>
#include <string>
#include <utility>
#include <vector>

namespace chiaro {

class StageTimer {
public:
    /// Runs one step and keeps its time; returns what it returns.
    template <class Step>
    auto operator()(std::string name, Step&& step) {
        const Clock clock(*this, std::move(name));
        return step();
    }
    const std::vector<Stage>& stages() const { return stages_; }
    std::vector<Stage> take() { return std::move(stages_); }

private:
    struct Clock {
        StageTimer& timer;
        std::string name;
        std::chrono::steady_clock::time_point start = std::chrono::steady_clock::now();
        Clock(StageTimer& s, std::string n) : timer(s), name(std::move(n)) {}
        ~Clock() {
            const std::chrono::duration<double> time = std::chrono::steady_clock::now() - start;
            timer.stages_.push_back({std::move(name), time.count()});
        }
    };
    std::vector<Stage> stages_;
};

}  // namespace chiaro

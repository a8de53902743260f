// What an illumination method consists of, step by step, with the time that each took.
#pragma once
#include <chiaro/progress.h>

#include <algorithm>
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
    /// The same for a step that is done in parts: the time of parts of one name is added.
    template <class Step>
    auto part(const std::string& name, Step&& step) {
        const Clock clock(*this, name, true);
        return step();
    }
    const std::vector<Stage>& stages() const { return stages_; }
    std::vector<Stage> take() { return std::move(stages_); }

private:
    struct Clock {
        StageTimer& timer;
        std::string name;
        bool is_part;
        std::chrono::steady_clock::time_point start = std::chrono::steady_clock::now();
        Clock(StageTimer& s, std::string n, bool part = false) : timer(s), name(std::move(n)), is_part(part) {}
        ~Clock() {
            const std::chrono::duration<double> time = std::chrono::steady_clock::now() - start;
            const auto same = std::find_if(timer.stages_.begin(), timer.stages_.end(),
                                           [&](const Stage& stage) { return is_part && stage.name == name; });
            if (same != timer.stages_.end())
                same->seconds += time.count();
            else
                timer.stages_.push_back({std::move(name), time.count()});
        }
    };
    std::vector<Stage> stages_;
};

}  // namespace chiaro

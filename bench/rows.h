// What `chiaro bench` measures, and what it finds.
#pragma once
#include <chiaro/device.h>
#include <chiaro/progress.h>

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "measure.h"
#include "published_figures.h"

namespace chiaro::bench {

/// One line of the table.
struct Row {
    std::string name, unit;
    Spread value;
    std::optional<double> ratio = {};  ///< to what `to` names, measured in turns with it
    std::string to = {};
    std::string note = {};  ///< "skipped: no data", "same picture", ...
    Beside beside = {};
};

struct Setup {
    Device device;
    bool quick = false;  ///< small volumes and pictures, to see that all works
    int runs = 5;
    std::filesystem::path tool;  ///< the program itself, for what is measured from outside
    std::filesystem::path data;  ///< folder of real volumes; may be empty
    Progress& progress;
};

/// Rows that are measured together, in turns. Their names are known before, so that what is not asked for costs
/// nothing.
struct Case {
    std::vector<std::string> names;
    std::function<std::vector<Row>()> measure;
};

struct Suite {
    std::string_view name, sentence;
    std::vector<Case> (*cases)(const Setup&);
};

std::vector<Case> memory_cases(const Setup& setup);
std::vector<Case> sampling_cases(const Setup& setup);
std::vector<Case> skipping_cases(const Setup& setup);
std::vector<Case> channel_cases(const Setup& setup);
std::vector<Case> label_cases(const Setup& setup);
std::vector<Case> lit_cases(const Setup& setup);
std::vector<Case> paging_cases(const Setup& setup);
std::vector<Case> scene_cases(const Setup& setup);
std::vector<Case> way_cases(const Setup& setup);
std::vector<Case> pipeline_cases(const Setup& setup);
std::vector<Case> moment_cases(const Setup& setup);
std::vector<Case> spao_cases(const Setup& setup);
std::vector<Case> spao_error_cases(const Setup& setup);
std::vector<Case> visibility_cases(const Setup& setup);
std::vector<Case> visibility_error_cases(const Setup& setup);
std::vector<Case> transport_error_cases(const Setup& setup);
std::vector<Case> transport_strip_cases(const Setup& setup);
std::vector<Case> transport_cases(const Setup& setup);
std::vector<Case> path_cases(const Setup& setup);
std::vector<Case> path_noise_cases(const Setup& setup);
std::vector<Case> histogram_cases(const Setup& setup);
std::vector<Case> gpu_cases(const Setup& setup);
std::vector<Case> cancel_cases(const Setup& setup);
std::vector<Case> tool_cases(const Setup& setup);

/// Something costly that several cases share: made for the first, gone with the last.
template <class T>
class Shared {
public:
    explicit Shared(std::function<T()> make) : state_(std::make_shared<State>(State{std::move(make), {}})) {}
    T& operator*() const {
        if (!state_->value) state_->value.emplace(state_->make());
        return *state_->value;
    }

private:
    struct State {
        std::function<T()> make;
        std::optional<T> value;
    };
    std::shared_ptr<State> state_;
};

}  // namespace chiaro::bench

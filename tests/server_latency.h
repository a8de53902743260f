// What somebody in front of the viewer waits for: times from an edit to its frames, for scripts/latency.
#pragma once
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <random>
#include <vector>

#include "web_client.h"

namespace chiaro::testing {

using Clock = std::chrono::steady_clock;

inline double seconds_since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

inline bool tells_scene(const Message& m) {
    return !m.is_frame && m.json.contains("scene") && m.json["scene"].is_object();
}

/// That of [0, 1] of all values are at most.
inline double quantile(std::vector<double> values, double share) {
    if (values.empty()) return 0;
    std::sort(values.begin(), values.end());
    return values[std::min(values.size() - 1, std::size_t(share * double(values.size())))];
}

/// A row of a table: what, median, 95th percentile and largest in milliseconds, and what is asked of one of them.
inline void print_row(const std::string& what, const std::vector<double>& seconds, const std::string& asked = "") {
    fmt::print("| {:<44} | {:>6.0f} | {:>6.0f} | {:>7.0f} | {:>5} | {:<14} |\n", what, 1e3 * quantile(seconds, 0.5),
               1e3 * quantile(seconds, 0.95), 1e3 * quantile(seconds, 1), seconds.size(), asked);
    std::fflush(stdout);
}

/// CPU time that a process has taken, all threads: /proc/PID/task/*/schedstat; 0 where that cannot be read.
inline double cpu_seconds(int process) {
    double nanoseconds = 0, of_one;
    std::error_code error;
    const std::filesystem::path tasks = fmt::format("/proc/{}/task", process);
    for (const auto& task : std::filesystem::directory_iterator(tasks, error))
        if (std::ifstream(task.path() / "schedstat") >> of_one) nanoseconds += of_one;
    return 1e-9 * nanoseconds;
}

/// What an interactive viewer owes, in milliseconds.
inline constexpr const char *camera_target = "median <= 60", *edit_target = "median <= 100",
                            *final_target = "95 % <= 1000", *age_target = "all <= 300";

class Latency {
public:
    Latency(int port, const std::string& token, int process, const std::string& method)
        : process_(process),
          page_(port, token, fmt::format("latency-{:08x}", std::random_device()())) {  // one that never saw a volume
        const auto told = page_.find(tells_scene, 120);
        if (!told) throw std::runtime_error("no scene");
        scene_ = told->json["scene"];
        scene_["lighting"]["method"] = method;
        if (method == "transport") scene_["lighting"]["grid"] = 64;
        settle();
        fmt::print("| {:<44} | {:>6} | {:>6} | {:>7} | {:>5} | {:<14} |\n", "milliseconds at the client", "median",
                   "95 %", "largest", "times", "asked");
        fmt::print("|---|---|---|---|---|---|\n");
    }

    /// One edit from rest: to the first frame, to the first one in its own light, the first in that light at its
    /// finest, the first of the canvas's size in that, and to the last; and the CPU time that it took the server.
    void edits(const std::string& name, const char* first_target, int count,
               const std::function<void(Json&, int)>& edit) {
        std::vector<double> first, coarse, fine, whole, last, first_work, work;
        std::map<std::string, std::vector<double>> verbs;
        for (int i = 0; i < count; ++i) {
            edit(scene_, i);
            const double before = cpu_seconds(process_);
            const auto start = Clock::now();
            send(true);
            const auto shown = page_.find([&](const Message& m) { return m.is_frame && m.json["n"] == n_; });
            first.push_back(seconds_since(start));
            first_work.push_back(cpu_seconds(process_) - before);
            if (!shown) throw std::runtime_error("no frame");
            for (const Json& verb : shown->json["verbs"])
                if (verb["seconds"] > 0) verbs[verb["name"]].push_back(verb["seconds"]);
            bool is_lit = false, is_fine = false, is_whole = false;
            const auto note = [&](const Message& frame) {
                const auto once = [&](bool& known, bool now, std::vector<double>& times) {
                    if (now && !known) times.push_back(seconds_since(start));
                    known = known || now;
                };
                once(is_lit, has_own_light(frame.json), coarse);
                once(is_fine, has_own_light(frame.json) && !frame.json["light"]["coarse"], fine);
                once(is_whole, is_fine && frame.json["size"] == frame.json["canvas"], whole);
                return frame.json["stage"] == "final";
            };
            if (!note(*shown))
                page_.find([&](const Message& m) { return m.is_frame && m.json["n"] == n_ && note(m); }, 60);
            last.push_back(seconds_since(start));
            work.push_back(cpu_seconds(process_) - before);
        }
        print_row(name + ": first frame", first, first_target);
        for (const auto& [verb, seconds] : verbs) print_row("  of it " + verb, seconds);
        if (process_) print_row("  CPU time", first_work);
        if (scene_["lighting"]["method"] != "none" && name != "camera") {
            print_row(name + ": first in its own light", coarse);
            print_row(name + ": first in light at its finest", fine);
            print_row(name + ": whole, light at its finest", whole);
        }
        print_row(name + ": final", last, final_target);
        if (process_) print_row("  CPU time", work);
    }

    /// States at 60 a second; ages of the frames that answer them.
    void drag(const std::string& name, double seconds, const std::function<void(Json&, int)>& edit) {
        std::vector<double> ages, sides;
        std::map<std::int64_t, Clock::time_point> sent;
        const auto start = Clock::now();
        auto next = start;
        for (int i = 0; seconds_since(start) < seconds; ++i) {
            edit(scene_, i);
            send(true);
            sent[n_] = Clock::now();
            next += std::chrono::microseconds(16667);
            for (double left; (left = -seconds_since(next)) > 0;) {
                const auto message = page_.next(left);
                if (!message || !message->is_frame) continue;
                const auto found = sent.find(message->json["n"].get<std::int64_t>());
                if (found == sent.end()) continue;  // of the picture before
                ages.push_back(seconds_since(found->second));
                sides.push_back(message->json["size"][0].get<double>() / message->json["canvas"][0].get<double>());
            }
        }
        print_row(fmt::format("{}: age of frames", name), ages, age_target);
        fmt::print("| {:<44} | {:.1f} frames a second, at {:.2f} of the side |||||\n", "",
                   double(ages.size()) / seconds, quantile(sides, 0.5));
        settle();
    }

private:
    /// Whether a frame's light is of the very state that it answers.
    static bool has_own_light(const Json& frame) {
        const std::string stage = frame["stage"];
        if (stage == "light" || stage == "accumulate" || stage == "final" || frame["light"]["coarse"]) return true;
        return std::any_of(frame["verbs"].begin(), frame["verbs"].end(),
                           [](const Json& verb) { return verb["name"] == "illuminate" && verb["seconds"] > 0; });
    }
    void send(bool moving) {
        page_.send({{"type", "state"}, {"n", ++n_}, {"scene", scene_}, {"canvas", {1024, 768}}, {"moving", moving}});
    }
    /// As pages do, it keeps the ball that the camera fits from the first picture on.
    void settle() {
        send(false);
        const auto final = page_.find(
            [&](const Message& m) {
                if (!m.is_frame) return m.json.value("type", "") == "error";
                return m.json["n"] == n_ && m.json["stage"] == "final";
            },
            300);
        if (!final) throw std::runtime_error("no final picture");
        if (!final->is_frame) throw std::runtime_error(final->json["sentence"].get<std::string>());
        if (!final->json.contains("fit")) return;
        const Json &ball = final->json["fit"], &radius = ball["radius"];
        scene_["camera"].update({{"fit_centre", ball["centre"]}, {"fit_radius", radius}});
    }

    int process_;
    Page page_;
    Json scene_;
    std::int64_t n_ = 0;
};

inline int latency(int port, const std::string& token, double seconds, int process, const std::string& method,
                   int times) {
    Latency bench(port, token, process, method);
    const auto turn = [](Json& scene, int i) { scene["camera"]["azimuth_deg"] = 35 + 3 * (i % 100 + 1); };
    const auto edit = [](Json& scene, int i) {
        scene["transfer_function"]["opacity_scale"] = 1 + 0.005 * (i % 200 + 1);
    };
    const int turns = std::clamp(int(seconds), 5, 40);
    bench.edits("camera", camera_target, turns, turn);
    bench.edits("transfer function", edit_target, times > 0 ? times : turns, edit);
    bench.drag("camera drag", seconds / 2, turn);
    bench.drag("transfer function drag", seconds / 2, edit);
    return 0;
}

}  // namespace chiaro::testing

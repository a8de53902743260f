// Loads a running server as scripts/soak and scripts/latency ask: server_load soak PORT TOKEN SECONDS [SEED], or
// server_load latency PORT TOKEN SECONDS [PROCESS [METHOD [EDITS]]], which reads the CPU time of that process.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <optional>
#include <random>
#include <vector>

#include "web_client.h"

using chiaro::testing::http;
using chiaro::testing::Json;
using chiaro::testing::Message;
using chiaro::testing::Page;
using chiaro::testing::red_half_clear_png;
using Clock = std::chrono::steady_clock;

namespace {

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

bool tells_scene(const Message& m) { return !m.is_frame && m.json.contains("scene") && m.json["scene"].is_object(); }

/// That of [0, 1] of all values are at most.
double quantile(std::vector<double> values, double share) {
    if (values.empty()) return 0;
    std::sort(values.begin(), values.end());
    return values[std::min(values.size() - 1, std::size_t(share * double(values.size())))];
}

/// A row of a table: what, median, 95th percentile and largest in milliseconds, and what is asked of one of them.
void print_row(const std::string& what, const std::vector<double>& seconds, const std::string& asked = "") {
    fmt::print("| {:<44} | {:>6.0f} | {:>6.0f} | {:>7.0f} | {:>5} | {:<14} |\n", what, 1e3 * quantile(seconds, 0.5),
               1e3 * quantile(seconds, 0.95), 1e3 * quantile(seconds, 1), seconds.size(), asked);
    std::fflush(stdout);
}

/// CPU time that a process has taken, all threads: /proc/PID/task/*/schedstat; 0 where that cannot be read.
double cpu_seconds(int process) {
    double nanoseconds = 0, of_one;
    std::error_code error;
    const std::filesystem::path tasks = fmt::format("/proc/{}/task", process);
    for (const auto& task : std::filesystem::directory_iterator(tasks, error))
        if (std::ifstream(task.path() / "schedstat") >> of_one) nanoseconds += of_one;
    return 1e-9 * nanoseconds;
}

/// What an interactive viewer owes, in milliseconds.
constexpr const char *camera_target = "median <= 60", *edit_target = "median <= 100", *final_target = "95 % <= 1000",
                     *age_target = "all <= 300";

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
                const auto once = [&](bool& before, bool now, std::vector<double>& times) {
                    if (now && !before) times.push_back(seconds_since(start));
                    before = before || now;
                };
                once(is_lit, has_own_light(frame.json), coarse);
                once(is_fine, is_lit && !frame.json["light"]["coarse"], fine);
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
        if (stage == "light" || stage == "accumulate" || stage == "final") return true;
        return std::any_of(frame["verbs"].begin(), frame["verbs"].end(),
                           [](const Json& verb) { return verb["name"] == "illuminate" && verb["seconds"] > 0; });
    }
    void send(bool moving) {
        page_.send({{"type", "state"}, {"n", ++n_}, {"scene", scene_}, {"canvas", {1024, 768}}, {"moving", moving}});
    }
    void settle() {
        send(false);
        if (!page_.of_stage(n_, "final", 300)) throw std::runtime_error("no final picture");
    }

    int process_;
    Page page_;
    Json scene_;
    std::int64_t n_ = 0;
};

int latency(int port, const std::string& token, double seconds, int process, const std::string& method, int times) {
    Latency bench(port, token, process, method);
    const auto turn = [](Json& scene, int i) { scene["camera"]["azimuth_deg"] = 35 + 3 * (i % 100 + 1); };
    const auto edit = [](Json& scene, int i) {
        scene["transfer_function"]["opacity_scale"] = 1 + 0.01 * (i % 100 + 1);
    };
    const int turns = std::clamp(int(seconds), 5, 40);
    bench.edits("camera", camera_target, turns, turn);
    bench.edits("transfer function", edit_target, times > 0 ? times : turns, edit);
    bench.drag("camera drag", seconds / 2, turn);
    bench.drag("transfer function drag", seconds / 2, edit);
    return 0;
}

/// Random things that pages and others say.
class Soak {
public:
    Soak(int port, const std::string& token, std::uint32_t seed) : port_(port), token_(token), random_(seed) {}

    int run(double seconds) {
        const auto start = Clock::now();
        while (seconds_since(start) < seconds) {
            connect();
            const int steps = pick(5, 60);
            for (int i = 0; i < steps && page_ && seconds_since(start) < seconds; ++i) step();
            if (page_) settle();
            if (pick(0, 3) == 0) by_http();
        }
        // Whatever was done to it, the server serves.
        page_.emplace(port_, token_, "soak-last-view", "&take=1");
        const auto told = page_->find(tells_scene, 120);
        if (told) page_->send(state(1, told->json["scene"]));
        const bool lives = told && page_->of_stage(1, "final", 120);
        fmt::print(
            "{} connections, {} messages ({} not valid), {} requests: {} answered, {} refused in a sentence, {} "
            "without answer; "
            "{} frames; {} closed by the server; a picture at the end: {}\n",
            connections_, messages_, invalid_, requests_, answered_, refused_, unanswered_, frames_, closed_,
            lives ? "yes" : "no");
        return lives && unanswered_ == 0 ? 0 : 1;
    }

private:
    int pick(int low, int high) { return std::uniform_int_distribution(low, high)(random_); }
    double real(double low, double high) { return std::uniform_real_distribution(low, high)(random_); }

    void connect() {
        page_.reset();
        n_ = 0;
        open_.clear();
        page_.emplace(port_, token_, fmt::format("soak-view-{}", pick(0, 9)), "&take=1");
        ++connections_;
        const auto told = page_->find(tells_scene, 60);
        if (told) scene_ = told->json["scene"];
    }

    Json state(std::int64_t n, const Json& scene) {
        return {{"type", "state"},
                {"n", n},
                {"scene", scene},
                {"canvas", {pick(1, 200), pick(1, 150)}},
                {"moving", pick(0, 1) == 1}};
    }

    Json changed_scene() {
        Json scene = scene_;
        constexpr const char* methods[] = {"none", "spao", "visibility", "histogram", "reference", "transport"};
        scene["camera"]["azimuth_deg"] = real(-400, 400);
        scene["camera"]["fit_scale"] = real(0.01, 3);
        scene["transfer_function"]["opacity_scale"] = real(0, 5);
        if (pick(0, 4) == 0) scene["lighting"] = {{"method", methods[pick(0, 5)]}};
        if (scene["lighting"]["method"] == "transport") scene["lighting"]["grid"] = 16;
        if (scene["lighting"]["method"] == "reference") scene["lighting"]["rays"] = pick(1, 8);
        if (pick(0, 9) == 0) scene["mode"] = pick(0, 1) ? "mip" : "iso";
        if (pick(0, 9) == 0) scene["clip"]["box"] = {real(0, 1), real(0, 1), 0, 1, 0, 1};
        if (pick(0, 9) == 0) scene["sampling"]["step"] = pick(0, 1) ? real(-1, 0) : real(0.1, 3);
        if (pick(0, 9) == 0)
            scene["transfer_function"]["points"] =
                Json::array({{{"value", real(-9, 300)}, {"rgb", {1, 1, 1}}, {"opacity", real(-1, 2)}}});
        if (pick(0, 19) == 0) scene["probe"] = {{"file", "../../etc/passwd"}};
        return scene;
    }

    Json request() {
        const Json scene = changed_scene();
        switch (pick(0, 11)) {
            case 0:
                return {{"type", "pick"}, {"x", real(-10, 200)}, {"y", real(-10, 200)}};
            case 1:
                return {{"type", "folder"}, {"path", pick(0, 1) ? "" : "../../.."}};
            case 2:
                return {{"type", "save"},
                        {"scene", scene},
                        {"size", {pick(0, 300), pick(1, 200)}},
                        {"format", pick(0, 3) ? "png" : "exr"},
                        {"overlays", Json::array({{{"at", {pick(-1, 50), 0}}, {"png", garbled(red_half_clear_png)}}})}};
            case 3:
                return {{"type", "command"}, {"scene", scene}};
            case 4:
                return {{"type", "resolve"}, {"transfer_function", {{"preset", pick(0, 2) ? "viridis" : "no-such"}}}};
            case 5:
                return {{"type", "export"}, {"what", pick(0, 1) ? "scene" : "transfer"}, {"scene", scene}};
            case 6:
                return {{"type", "import"}, {"name", "scene.json"}, {"text", garbled(scene.dump())}};
            case 7:
                return {{"type", "look"}, {"scene", scene}, {"size", {64, 48}}};
            case 8:
                return {{"type", "compare"}, {"scene", scene}, {"size", {16, 12}}, {"method", "spao"}};
            case 9:
                return {{"type", "open"}, {"volume", pick(0, 1) ? "sample:ball:24" : "sample:shells:32"}};
            case 10:
                return {{"type", "cancel"}, {"re", id_ - pick(0, 5)}};
            default:
                return {{"type", "measure"}, {"scene", scene}};
        }
    }

    std::string garbled(std::string text) {
        for (int i = pick(0, 4); i > 0 && !text.empty(); --i) {
            const auto at = std::size_t(pick(0, int(text.size()) - 1));
            if (pick(0, 1))
                text[at] = char(pick(32, 126));
            else
                text.erase(at, std::size_t(pick(1, 20)));
        }
        return text;
    }

    void step() {
        try {
            ++messages_;
            const int kind = pick(0, 99);
            if (kind < 40) {
                page_->send(state(++n_, changed_scene()));
            } else if (kind < 80) {
                Json asked = request();
                asked["id"] = ++id_;
                open_.insert({id_, asked["type"]});
                ++requests_;
                page_->send(asked);
            } else if (kind < 97) {
                ++invalid_;
                page_->send_raw(1, garbled(state(n_, changed_scene()).dump()));
            } else {
                ++invalid_;
                break_rules(kind);
            }
            read(0.001);
        } catch (const std::exception&) {
            lost();
        }
    }

    void break_rules(int kind) {
        std::string noise(std::size_t(pick(1, 3000)), '\0');
        for (char& c : noise) c = char(pick(0, 255));
        if (kind == 97)
            page_->send_raw(2, noise);
        else if (kind == 98)
            page_->write(noise);
        else
            page_->send_raw(1, std::string(2 << 20, '['));
    }

    void read(double seconds) {
        while (const auto message = page_->next(seconds)) hear(*message);
        if (page_->is_over()) lost();
    }

    void hear(const Message& message) {
        if (message.is_frame) {
            ++frames_;
            return;
        }
        const std::string type = message.json["type"];
        if ((type != "answer" && type != "error") || !message.json["re"].is_number_integer()) return;
        if (open_.erase(message.json["re"].get<std::int64_t>()) == 0) return;
        type == "answer" ? ++answered_ : ++refused_;
    }

    /// The server closed it: what was asked is not answered any more.
    void lost() {
        ++closed_;
        page_.reset();
        open_.clear();
    }

    void settle() {
        const auto start = Clock::now();
        try {
            while (page_ && !open_.empty() && seconds_since(start) < 600) read(0.05);  // on a busy machine
        } catch (const std::exception&) {
            lost();
        }
        for (const auto& [id, type] : open_) fmt::print("no answer to {} {}\n", type, id);
        unanswered_ += open_.size();
    }

    void by_http() {
        try {
            std::string path = "/";
            for (int i = pick(0, 30); i > 0; --i) path += char(pick(33, 126));
            http(port_, pick(0, 1) ? "GET" : "POST", path, "", std::string(std::size_t(pick(0, 2000)), 'x'));
        } catch (const std::exception&) {
        }
    }

    const int port_;
    const std::string token_;
    std::mt19937 random_;
    std::optional<Page> page_;
    Json scene_;
    std::int64_t n_ = 0, id_ = 0;
    std::map<std::int64_t, std::string> open_;
    std::size_t connections_ = 0, messages_ = 0, invalid_ = 0, requests_ = 0, answered_ = 0, refused_ = 0,
                unanswered_ = 0, frames_ = 0, closed_ = 0;
};

}  // namespace

int main(int argc, char** argv) {
    if (argc < 5) return 2;
    try {
        const std::string what = argv[1];
        const int port = std::stoi(argv[2]);
        const double seconds = std::stod(argv[4]);
        if (what == "latency")
            return latency(port, argv[3], seconds, argc > 5 ? std::stoi(argv[5]) : 0, argc > 6 ? argv[6] : "spao",
                           argc > 7 ? std::stoi(argv[7]) : 0);
        return Soak(port, argv[3], argc > 5 ? std::uint32_t(std::stoul(argv[5])) : 1).run(seconds);
    } catch (const std::exception& error) {
        fmt::print("{}\n", error.what());
        return 1;
    }
}

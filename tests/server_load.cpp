// Loads a running server as scripts/soak and scripts/latency ask: server_load soak PORT TOKEN SECONDS [SEED], or
// server_load latency PORT TOKEN SECONDS [PROCESS [METHOD [EDITS]]], which reads the CPU time of that process.
#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <random>
#include <vector>

#include "server_latency.h"

using namespace chiaro::testing;

namespace {

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

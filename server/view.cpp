#include "view.h"

#include <fmt/format.h>

namespace chiaro::server {
namespace {

using Clock = std::chrono::steady_clock;

constexpr int largest_canvas = 8192;
constexpr double max_canvas_pixels = 36e6;
constexpr std::size_t max_running = 64;

Json id_of(const Json& request) {
    const auto found = request.find("id");
    if (found == request.end() || !found->is_number_integer())
        throw Error(ErrorCode::usage, "id: must be a whole number");
    return *found;
}

/// The one that a message answers.
std::optional<std::int64_t> request_of(const Json& message) {
    const auto found = message.find("re");
    if (found == message.end() || !found->is_number_integer()) return {};
    return found->get<std::int64_t>();
}

}  // namespace

View::View(ServerContext& context, std::string id)
    : context_(context),
      id_(std::move(id)),
      frames_([this] { render_worker_.look_at_link(); }),
      render_worker_({[this](int connection, std::string frame) {
                          const std::lock_guard lock(mutex_);
                          if (socket_ && connection == connection_) frames_.post_newest(std::move(frame));
                      },
                      [this](int connection, const Json& message) { tell(connection, message); },
                      [this] { return frames_.link(); }}) {}

View::~View() { cancel_all(); }

void View::cancel_all() {
    const std::lock_guard lock(mutex_);
    for (const auto& [id, progress] : running_) progress->cancel();
}

bool View::attach(std::shared_ptr<Socket> socket, bool take, bool paced) {
    const std::string taken = text_of({{"type", "taken"}});
    int connection = 0;
    {
        const std::lock_guard lock(mutex_);
        if (socket_ && !take) {
            socket->send(taken);
            socket->close(4001, "open elsewhere");
            return false;
        }
        if (socket_) {
            socket_->send(taken);
            socket_->close(4001, "taken over");
            for (const auto& [id, progress] : running_) progress->cancel();  // nobody hears the answers
        }
        socket_ = std::move(socket);
        frames_.attach(socket_, paced);
        connection = ++connection_;
        newest_ = -1;
        left_.reset();
    }
    const auto work = [this, connection] {
        heard_ = connection;
        try {
            greet();
        } catch (...) {
            tell(connection, current_error(nullptr));
        }
    };
    if (!hearing_.post(work)) throw Error(ErrorCode::usage, "too much is asked for at once");
    return true;
}

void View::gone(const Socket& from) {
    {
        const std::lock_guard lock(mutex_);
        if (socket_.get() != &from) return;
        socket_.reset();
        frames_.detach();
        left_ = Clock::now();
    }
    cancel_all();
    render_worker_.show(nullptr);  // light is found again when somebody looks
}

std::optional<Clock::duration> View::alone() const {
    const std::lock_guard lock(mutex_);
    if (!left_) return {};
    return Clock::now() - *left_;
}

void View::put(const Scene& scene) {
    const auto loaded = shown();
    const Json json = loaded ? scene_json(scene, loaded->session) : Json::parse(to_json(scene));
    {
        const std::lock_guard lock(mutex_);
        state_ = json;
    }
    tell({{"type", "put"}, {"scene", json}});
}

void View::say_goodbye() {
    tell({{"type", "bye"}});
    cancel_all();
}

bool View::is_there(const std::string& volume) const {
    try {
        const std::string whole = context_.folders.allowed_volume(volume);
        std::error_code error;
        return whole.starts_with("sample:") || std::filesystem::exists(split_volume_name(whole).first, error);
    } catch (const Error&) {
        return false;
    }
}

/// Says hello, and sees that there is something to show.
void View::greet() {
    Json hello = context_.lists;
    hello["type"] = "hello";
    hello["version"] = CHIARO_VERSION;
    hello["protocol"] = 1;
    hello["view"] = id_;
    hello["volume"] = nullptr, hello["scene"] = nullptr, hello["error"] = nullptr;
    auto loaded = shown();
    Scene scene = loaded ? loaded->source : Scene();
    if (!loaded && context_.initial && (loaded = context_.volumes.find(*context_.initial))) scene = *context_.initial;
    const bool is_first = !shown_before_;
    shown_before_ = true;
    std::optional<KeptView> kept = is_first ? context_.kept.find(id_) : std::nullopt;
    const std::string name = context_.initial ? context_.initial->volume : "";
    Json state;
    {
        const std::lock_guard lock(mutex_);
        shown_ = loaded;
        if (kept && state_.is_null() && (name == kept->volume)) state_ = kept->scene, undo_ = kept->undo;
        state = state_;
        hello["undo"] = undo_;
    }
    // The view had gone on to another volume: that one, if it still is there.
    if (kept && kept->volume != name && is_there(kept->volume)) {
        kept_ = kept;
        hello["reading"] = kept->volume;
        hello["restored"] = false;
        tell(hello);
        return run(opening_, {{"id", "open"}}, &View::open_kept);
    }
    if (is_first && state.is_null() && !name.empty())
        if (const auto other = context_.kept.newest_of(name, id_))
            hello["earlier"] = {{"view", other->view}, {"seconds", other->seconds}};
    hello["restored"] = loaded && !state.is_null();
    if (loaded) {
        hello["volume"] = loaded->told;
        if (!state.is_null()) scene = scene_of(state);
        hello["scene"] = scene_json(scene, loaded->session);
        render_worker_.show(loaded);
    } else if (context_.initial) {
        hello["reading"] = context_.initial->volume;
    }
    tell(hello);
    if (!loaded && context_.initial) run(opening_, {{"id", "open"}}, &View::open_initial);
}

void View::hear(const Socket& from, std::string text, std::function<void()> done) {
    int connection = 0;
    {
        const std::lock_guard lock(mutex_);
        if (socket_.get() == &from) connection = connection_;  // else it was taken over
    }
    const auto work = [this, connection, text = std::move(text), done] {
        understand(connection, text);
        done();
    };
    if (connection == 0 || !hearing_.post(work)) done();
}

bool View::bring(const std::string& name, std::string bytes, std::function<void(const Json&)> reply) {
    return hearing_.post([this, name, bytes = std::move(bytes), reply = std::move(reply)] {
        Json told;
        try {
            told = take_file(name, bytes);
        } catch (...) {
            told = current_error(nullptr);
        }
        reply(told);
    });
}

void View::understand(int connection, std::string_view text) {
    {
        const std::lock_guard lock(mutex_);
        if (!socket_ || connection != connection_) return;
    }
    heard_ = connection;
    Json request;
    try {
        request = parse_message(text);
        const std::string type = text_in(request, "type");
        if (type == "got")
            hear_got(request);
        else
            type == "state" ? hear_state(request) : dispatch(request);
    } catch (...) {
        const bool has_id = request.is_object() && request.contains("id") && request["id"].is_number_integer();
        Json error = current_error(has_id ? request["id"] : Json());
        if (!has_id && error["code"] == "usage") error["code"] = "protocol";
        tell(heard_, error);
    }
}

void View::dispatch(const Json& request) {
    static const std::map<std::string, Quick> quick{
        {"pick", &View::pick},          {"command", &View::command},    {"resolve", &View::resolve},
        {"export", &View::export_text}, {"import", &View::import_text}, {"cancel", &View::cancel},
        {"ping", &View::ping},          {"cache", &View::cache},        {"keep", &View::keep},
        {"discard", &View::discard},    {"earlier", &View::earlier},    {"film_frame", &View::film_frame},
        {"room", &View::room}};
    static const std::map<std::string, std::pair<SerialQueue View::*, Handler>> slow{
        {"folder", {&View::side_queue_, &View::folder}},
        {"open", {&View::opening_, &View::open}},
        {"save", {&View::saving_, &View::save}},
        {"look", {&View::side_queue_, &View::look}},
        {"compare", {&View::comparing_, &View::compare}},
        {"measure", {&View::comparing_, &View::measure}},
        {"probe", {&View::side_queue_, &View::probe}},
        {"slice", {&View::slicing_, &View::slice}},
        {"labels", {&View::side_queue_, &View::labels}},
        {"label", {&View::slicing_, &View::label}},
        {"snap", {&View::slicing_, &View::snap}},
        {"region", {&View::side_queue_, &View::region}},
        {"gradients", {&View::side_queue_, &View::gradients}},
        {"export_film", {&View::filming_, &View::export_film}}};
    const std::string type = text_in(request, "type");
    id_of(request);
    if (const auto found = quick.find(type); found != quick.end()) return answer(request, found->second);
    if (const auto found = slow.find(type); found != slow.end())
        return run(this->*found->second.first, request, found->second.second);
    Json error =
        error_message(request["id"], "protocol", fmt::format("'{}': no such type of message", type.substr(0, 40)));
    tell(error);
}

void View::answer(const Json& request, Quick quick) {
    Json reply = (this->*quick)(request);
    reply["type"] = "answer", reply["re"] = request["id"];
    tell(heard_, reply);
}

/// Requests of a connection that is gone may still be ending.
std::string View::key_of(const Json& id) const { return fmt::format("{} of {}", id.dump(), connection_); }

/// In a queue, under an id by which it can be cancelled.
void View::run(SerialQueue& queue, const Json& request, Handler handler) {
    const Json id = request["id"];
    std::string key;
    const auto progress = std::make_shared<Progress>(report_for(id));
    {
        const std::lock_guard lock(mutex_);
        key = key_of(id);
        if (running_.size() >= max_running) throw Error(ErrorCode::usage, "too much is asked for at once");
        if (!running_.emplace(key, progress).second)
            throw Error(ErrorCode::usage, fmt::format("id {}: is still being answered", id.dump()));
    }
    const auto work = [this, request, id, key, progress, handler] {
        Json reply;
        try {
            progress->check();
            reply = (this->*handler)(request, *progress);
            if (!reply.contains("type")) reply["type"] = "answer";
            if (reply["type"] == "answer") reply["re"] = id;
        } catch (...) {
            reply = current_error(id);
        }
        {
            const std::lock_guard lock(mutex_);
            running_.erase(key);
        }
        tell(reply);
    };
    if (queue.post(work)) return;
    const std::lock_guard lock(mutex_);
    running_.erase(key);
    throw Error(ErrorCode::usage, "too much is asked for at once");
}

/// The page tells how many bytes of pictures it has.
void View::hear_got(const Json& message) {
    if (!message.contains("bytes") || !message["bytes"].is_number_unsigned())
        throw Error(ErrorCode::usage, "bytes: must be a whole number");
    frames_.got(message["bytes"].get<std::uint64_t>());
}

void View::hear_state(const Json& message) {
    if (!message.contains("n") || !message["n"].is_number_integer())
        throw Error(ErrorCode::usage, "n: must be a whole number");
    FrameRequest wanted;
    wanted.n = message["n"].get<std::int64_t>();
    try {
        const auto [width, height] = size_in(message, "canvas", largest_canvas);
        if (double(width) * height > max_canvas_pixels) throw Error(ErrorCode::usage, "canvas: has too many pixels");
        std::vector<std::string> unknown;
        wanted.scene = scene_of(object_in(message, "scene"), &unknown);
        wanted.scene.width = width, wanted.scene.height = height;
        if (message.contains("next")) wanted.next = int(number_in(message, "next", 0, shown()->moments() - 1));
        wanted.moving = flag_in(message, "moving", false), wanted.preview = flag_in(message, "preview", false);
        for (const std::string& key : unknown) wanted.notes.push_back(fmt::format("unknown key {}", key));
    } catch (...) {
        Json error = current_error(nullptr);
        error["n"] = wanted.n;
        return tell(heard_, error);
    }
    {
        const std::lock_guard lock(mutex_);
        if (wanted.n <= newest_ || heard_ != connection_) return;  // came late
        newest_ = wanted.n;
        wanted.connection = connection_;
        if (!wanted.preview) state_ = message["scene"];
    }
    if (!wanted.preview) note_state();
    if (!wanted.preview && context_.changed) context_.changed(wanted.scene);
    render_worker_.request(std::move(wanted));
}

/// For a server after this one.
void View::note_state() {
    const std::lock_guard lock(mutex_);
    if (shown_ && !state_.is_null()) context_.kept.note({id_, shown_->source.volume, state_, undo_, 0});
}

std::shared_ptr<const Loaded> View::shown() const {
    const std::lock_guard lock(mutex_);
    return shown_;
}

/// The volume that is shown, at the moment of a page's scene.
Json View::volume_of(const Loaded& loaded, const Json& scene) {
    Json volume = Json::parse(to_json(loaded.source))["volume"];
    const Json time = scene.value(Json::json_pointer("/volume/time"), Json());
    if (time.is_number_integer() && time >= 0 && time < loaded.moments()) volume["time"] = time;
    return volume;
}

/// A session of the scene's moment, with the voxels that are in memory where these are.
Session View::session_of(const Scene& scene, Progress& progress) {
    const auto loaded = shown();
    if (auto session = render_worker_.share(*loaded, scene.read.time)) return std::move(*session);
    return session_at(*loaded, scene, progress);
}

/// A page's scene: always of the volume that is shown, and of no file that it may not see.
Scene View::scene_of(const Json& json, std::vector<std::string>* unknown) const {
    const auto loaded = shown();
    if (!loaded) throw Error(ErrorCode::usage, "no volume is open");
    Json own = json;
    own["volume"] = volume_of(*loaded, json);
    std::vector<std::string> ignored;
    Scene scene = parse_scene(text_of(own), context_.folders.first(), {}, unknown ? *unknown : ignored);
    context_.folders.confine(scene);
    return scene;
}

void View::tell(const Json& message) const {
    const std::lock_guard lock(mutex_);
    frames_.tell(text_of(message), request_of(message));
}

void View::tell(int connection, const Json& message) const {
    const std::lock_guard lock(mutex_);
    if (connection == connection_) frames_.tell(text_of(message), request_of(message));
}

/// At most ten times a second.
Progress::Report View::report_for(const Json& id) const {
    const auto start = Clock::now();
    return [this, id, start, last = start](std::string_view stage, double fraction) mutable {
        const auto now = Clock::now();
        if (now - last < std::chrono::milliseconds(100)) return;
        last = now;
        const double seconds = std::chrono::duration<double>(now - start).count();
        const Json remaining = fraction > 0.02 ? Json(seconds * (1 - fraction) / fraction) : Json();
        tell({{"type", "progress"},
              {"re", id},
              {"stage", stage},
              {"fraction", fraction},
              {"seconds", seconds},
              {"remaining_s", remaining}});
    };
}

}  // namespace chiaro::server

#include "serve.h"

#include <chiaro/error.h>
#include <fmt/format.h>

#include <algorithm>
#include <deque>
#include <map>
#include <mutex>

#include "core/user_cache.h"
#include "lists.h"
#include "pages.h"
#include "token.h"
#include "view.h"

namespace chiaro::server {
namespace {

constexpr std::size_t max_views = 128, max_alone = 16;
constexpr auto kept_alone = std::chrono::minutes(10);
constexpr auto good_for = std::chrono::seconds(60);

bool is_view_id(const std::string& id) {
    return id.size() >= 8 && id.size() <= 64 &&
           id.find_first_not_of("ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_-") == id.npos;
}

/// Beside what else is the user's own.
std::filesystem::path views_folder() {
    const std::filesystem::path cache = user_cache();
    return cache.empty() ? cache : cache / "views";
}

std::string member(const std::map<std::string, std::string>& query, const std::string& name) {
    const auto found = query.find(name);
    return found == query.end() ? "" : found->second;
}

Response refusal(int status, const std::string& sentence) {
    Response response;
    response.status = status;
    response.body = sentence + "\n";
    return response;
}

Response json_response(const Json& json, int status = 200) {
    Response response;
    response.status = status;
    response.type = "application/json";
    response.body = text_of(json);
    return response;
}

class ViewerSite : public Site {
public:
    ViewerSite(const ViewerOptions& options)
        : kept_(options.keep_views ? views_folder() : std::filesystem::path()),
          uploads_(options.max_upload, kept_.volumes()),
          films_(options.keep_views && !views_folder().empty() ? user_cache() / "films" : store_.fresh("")),
          context_{Volumes(options.device, {options.volume, options.source}, options.paging),
                   Folders(options.folders, hidden_folders()),
                   store_,
                   uploads_,
                   kept_,
                   films_,
                   lists(options.device),
                   options.scene,
                   options.data,
                   Progress(options.report),
                   options.changed},
          base_path_(options.base_path),
          read_in_(options.read_in),
          unreadable_(options.unreadable) {
        context_.lists["embed_from"] = options.embed_from;
        if (context_.initial) reading_.post([this] { read_first(); });
    }
    ~ViewerSite() override { context_.first.cancel(); }

    void expect(const std::string& token) { token_ = token; }
    const std::string& token() const { return token_; }

    /// A page that asks for it, so that links need not carry it.
    static Response ask_for_token() {
        const auto file = page_file("ask.html");
        if (!file)
            return refusal(403, "This page opens with the whole address that chiaro view printed, token and all.");
        Response response;
        response.status = 403, response.type = file->type, response.body = file->bytes;
        return response;
    }

    /// Good for one visit.
    std::string fresh_key() {
        const std::lock_guard lock(keys_mutex_);
        const auto now = std::chrono::steady_clock::now();
        std::erase_if(keys_, [&](const auto& entry) { return entry.second < now; });
        std::string key = random_key();
        keys_[key] = now + good_for;
        return key;
    }

    void put(const Scene& scene) {
        for (const auto& [id, view] : views_) view->put(scene);
        given_ = scene;
    }

    std::optional<Response> answer(Request request, std::function<void(Response)> later) override {
        request.path = within_base(request.path);
        if (request.method == "POST" && request.path == "/volume") return json_response({{"bytes", request.bytes}});
        if (request.method == "POST") return upload(std::move(request), std::move(later));
        if (request.path.starts_with("/download/")) return store_.fetch(request.path.substr(10));
        const bool is_page = request.path == "/" || request.path == "/index.html";
        if (is_page && request.query.contains("key")) return visit(member(request.query, "key"));
        if (is_page && !has_token(request)) return ask_for_token();
        const auto file = page_file(is_page ? "index.html" : std::string_view(request.path).substr(1));
        if (!file) return refusal(404, "There is nothing at this address.");
        Response response;
        response.type = file->type, response.body = file->bytes;
        return response;
    }

    bool is_known(const Request& request) const override {
        const std::string path = within_base(request.path);
        return has_token(request) || (path.starts_with("/download/") && store_.has(path.substr(10)));
    }

    Response admit(const Request& request) override {
        const std::string path = within_base(request.path);
        const bool is_known = request.method == "POST" ? path == "/upload" || path == "/volume" : path == "/socket";
        if (!is_known) return refusal(404, "There is nothing at this address.");
        if (!has_token(request)) return refusal(403, "The token is not this server's.");
        if (!is_view_id(member(request.query, "view")))
            return refusal(400, "view: must be 8 to 64 of A-Z, a-z, 0-9, _ and -.");
        if (path == "/volume" && !is_view_id(member(request.query, "volume")))
            return refusal(400, "volume: must be 8 to 64 of A-Z, a-z, 0-9, _ and -.");
        if (!make_space(member(request.query, "view"))) return refusal(503, "Too many views are open.");
        return {};
    }

    std::filesystem::path destination(const Request& request) override {
        if (within_base(request.path) != "/volume") return {};
        return uploads_.begin(sent_name(request), member(request.query, "name"), request.bytes);
    }
    void abandon(const Request& request) override { uploads_.abandon(sent_name(request), request.bytes); }

    std::shared_ptr<Listener> welcome(const Request& request, std::shared_ptr<Socket> socket) override {
        const std::string id = member(request.query, "view");
        std::shared_ptr<View>& view = views_[id];
        if (!view) {
            view = std::make_shared<View>(context_, id);
            if (given_) view->put(*given_);
        }
        try {
            view->attach(socket, member(request.query, "take") == "1", member(request.query, "paced") == "1");
        } catch (...) {
            socket->send(text_of(current_error(nullptr)));
            socket->close(1011, "");
        }
        return view;
    }

    void tick() override {
        store_.tick();
        std::erase_if(views_, [&](auto& entry) {
            const auto alone = entry.second->alone();
            if (alone && *alone > kept_alone) part_from(std::move(entry.second));
            return !entry.second;
        });
    }

    void end() override {
        context_.first.cancel();
        for (const auto& [id, view] : views_) view->say_goodbye();
        store_.remove();
        for (const auto& folder : uploads_.folders()) kept_.forget_below(folder);
        uploads_.remove();
        films_.clear();
    }

private:
    bool has_token(const Request& request) const {
        const std::string token = member(request.query, "token");
        if (is_same_key(token, token_)) return true;
        return std::any_of(visits_.begin(), visits_.end(),
                           [&](const auto& visit) { return is_same_key(token, visit); });
    }

    /// A volume that a page sends is its own.
    static std::string sent_name(const Request& request) {
        return member(request.query, "view") + "/" + member(request.query, "volume");
    }

    /// A proxy may take the base path away, or leave it.
    std::string within_base(const std::string& path) const {
        return path.starts_with(base_path_) ? "/" + path.substr(base_path_.size()) : path;
    }

    /// The page for whoever has a key, which is worth nothing after that; it speaks on by a token of its own.
    Response visit(const std::string& key) {
        {
            const std::lock_guard lock(keys_mutex_);
            const auto found = keys_.find(key);
            const bool is_good = found != keys_.end() && found->second >= std::chrono::steady_clock::now();
            if (found != keys_.end()) keys_.erase(found);
            if (!is_good) return refusal(403, "This address was good for one visit within a minute: ask for another.");
        }
        visits_.push_back(random_key());
        if (visits_.size() > max_views) visits_.pop_front();
        const auto file = page_file("index.html");
        if (!file) return refusal(404, "There is nothing at this address.");
        Response response;
        response.type = file->type, response.body = file->bytes;
        const std::string head = "<head>";
        if (const std::size_t at = response.body.find(head); at != response.body.npos)
            response.body.insert(at + head.size(),
                                 fmt::format("\n<meta name=\"chiaro-visit\" content=\"{}\">", visits_.back()));
        return response;
    }

    /// Begins before the first page asks, and keeps the volume while nobody looks.
    void read_first() {
        try {
            const auto start = std::chrono::steady_clock::now();
            first_ = context_.volumes.load(*context_.initial, context_.first);
            const std::chrono::duration<double> passed = std::chrono::steady_clock::now() - start;
            if (read_in_) read_in_(passed.count());
        } catch (const std::exception& error) {  // told to each page that asks for it
            if (unreadable_ && !context_.first.cancelled()) unreadable_(error.what());
        }
    }

    /// Elsewhere: what a view was doing may take a moment to end.
    void part_from(std::shared_ptr<View> view) {
        leaving_.post([view = std::move(view)]() mutable { view.reset(); });
    }

    /// Those that have been alone for the longest go first.
    bool make_space(const std::string& id) {
        if (views_.contains(id)) return true;
        using Row = std::pair<std::chrono::steady_clock::duration, std::string>;
        std::vector<Row> alone;
        for (const auto& [name, view] : views_)
            if (const auto since = view->alone()) alone.emplace_back(*since, name);
        std::sort(alone.begin(), alone.end());
        while (!alone.empty() && (alone.size() >= max_alone || views_.size() >= max_views)) {
            part_from(views_.extract(alone.back().second).mapped());
            alone.pop_back();
        }
        return views_.size() < max_views;
    }

    std::optional<Response> upload(Request request, std::function<void(Response)> later) {
        const auto found = views_.find(member(request.query, "view"));
        if (found == views_.end()) return refusal(404, "This view is not open.");
        const auto reply = [later](const Json& told) {
            const bool is_error = told.contains("type") && told["type"] == "error";
            later(json_response(told, is_error ? 422 : 200));
        };
        if (found->second->bring(member(request.query, "name"), std::move(request.body), reply)) return {};
        return refusal(503, "Too much is asked for at once.");
    }

    std::vector<std::filesystem::path> hidden_folders() const {
        std::vector<std::filesystem::path> all = uploads_.folders();
        all.push_back(store_.uploads());
        return all;
    }

    Store store_;
    KeptViews kept_;
    Uploads uploads_;
    FilmStore films_;
    ServerContext context_;
    const std::string base_path_;
    std::string token_;
    std::mutex keys_mutex_;
    std::map<std::string, std::chrono::steady_clock::time_point> keys_;  // and until when they are good
    std::deque<std::string> visits_;                                     // tokens of pages that came with a key
    std::optional<Scene> given_;                                         // what was put last
    std::map<std::string, std::shared_ptr<View>> views_;                 // of the network's thread alone
    std::shared_ptr<const Loaded> first_;
    std::function<void(double)> read_in_;
    std::function<void(const std::string&)> unreadable_;
    SerialQueue reading_, leaving_;  // the last members: their work uses the others
};

Address address_of(const ViewerOptions& options) {
    return {options.host, options.port.value_or(Viewer::default_port), !options.port, options.embed_from};
}

}  // namespace

struct Viewer::State {
    explicit State(const ViewerOptions& options)
        : host(options.host), base_path(options.base_path), site(options), net(address_of(options), site) {
        site.expect(options.token.empty() ? token_for(net.port()) : options.token);
    }

    std::string host, base_path;
    ViewerSite site;
    Net net;
};

namespace {

bool is_origin(const std::string& text) {
    const bool has_scheme = text.starts_with("http://") || text.starts_with("https://");
    const std::size_t begin = text.find("://") + 3;
    return has_scheme && text.size() > begin && text.find_first_of("/ ;,'\"", begin) == text.npos;
}

/// What goes into headers and addresses is checked before.
const ViewerOptions& checked(const ViewerOptions& options) {
    for (const std::string& origin : options.embed_from)
        if (!is_origin(origin))
            throw Error(
                ErrorCode::usage,
                fmt::format("--embed-from {}: must be an origin such as https://hub.org or http://localhost:8888",
                            origin));
    const std::string& base = options.base_path;
    constexpr std::string_view plain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-./~@";
    if (base.empty() || base.front() != '/' || base.back() != '/' || base.find_first_not_of(plain) != base.npos)
        throw Error(ErrorCode::usage,
                    fmt::format("--base-path {}: must begin and end with /, such as /proxy/8480/", base));
    return options;
}

}  // namespace

Viewer::Viewer(const ViewerOptions& options) : state_(std::make_unique<State>(checked(options))) {}
Viewer::~Viewer() = default;
int Viewer::port() const { return state_->net.port(); }
const std::string& Viewer::token() const { return state_->site.token(); }
std::string Viewer::url() const {
    const bool is_anywhere = state_->host == "0.0.0.0" || state_->host == "::";
    const bool is_v6 = state_->host.find(':') != std::string::npos;
    const std::string host = is_anywhere || state_->host == "127.0.0.1" ? "localhost"
                             : is_v6                                    ? "[" + state_->host + "]"
                                                                        : state_->host;
    return fmt::format("http://{}:{}{}?token={}", host, port(), state_->base_path, token());
}
std::string Viewer::path_of_one_visit() {
    return fmt::format("{}?key={}", state_->base_path, state_->site.fresh_key());
}
void Viewer::put(const Scene& scene) {
    state_->net.post([site = &state_->site, scene] { site->put(scene); });
}
void Viewer::run(bool signals) { state_->net.run(signals); }
void Viewer::stop() { state_->net.stop(); }

}  // namespace chiaro::server

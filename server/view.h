// One page's state on this side, and the answers to what it asks.
#pragma once
#include <chiaro/film.h>

#include <chrono>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "downloads.h"
#include "film_store.h"
#include "folders.h"
#include "frame_sender.h"
#include "json.h"
#include "kept_views.h"
#include "moments.h"
#include "net.h"
#include "render_worker.h"
#include "serial_queue.h"
#include "uploads.h"
#include "volumes.h"

namespace chiaro::server {

/// What all views share.
struct ServerContext {
    Volumes volumes;
    Folders folders;
    Store& store;
    Uploads& uploads;
    KeptViews& kept;
    FilmStore& films;
    Json lists;                                 ///< of hello
    std::optional<Scene> initial;               ///< what the program was started with
    std::filesystem::path data;                 ///< where volumes of scenes are looked up too
    Progress first;                             ///< of reading the initial volume, begun before a page asks
    std::function<void(const Scene&)> changed;  ///< hears of each state of a page
};

/// How values and gradients of a volume come together.
struct GradientsTold {
    std::weak_ptr<const Loaded> of;
    Json answer;
    Image counts;
};

class View : public Listener {
public:
    View(ServerContext& context, std::string id);
    ~View() override;

    /// Speaks to this page from now on; false (and the page is told) where another has the view and `take` is not said.
    bool attach(std::shared_ptr<Socket> socket, bool take, bool paced);
    void hear(const Socket& from, std::string text, std::function<void()> done) override;
    void gone(const Socket& from) override;
    /// What a file that the page brought is, or an error, to `reply`, after what the page said before; false where too
    /// much waits.
    bool bring(const std::string& name, std::string bytes, std::function<void(const Json&)> reply);
    void say_goodbye();
    /// Another scene of the shown volume: the page takes it over as its own.
    void put(const Scene& scene);
    /// How long no page has been there.
    std::optional<std::chrono::steady_clock::duration> alone() const;

private:
    using Handler = Json (View::*)(const Json& request, Progress& progress);
    using Quick = Json (View::*)(const Json& request);

    void understand(int connection, std::string_view text);
    void dispatch(const Json& request);
    void answer(const Json& request, Quick quick);
    void run(SerialQueue& queue, const Json& request, Handler handler);
    std::string key_of(const Json& id) const;  ///< while locked
    void hear_state(const Json& message);
    void hear_got(const Json& message);
    void greet();
    void note_state();
    bool is_there(const std::string& volume) const;

    // Answered at once.
    Json pick(const Json& request);
    Json command(const Json& request);
    Json resolve(const Json& request);
    Json export_text(const Json& request);
    Json import_text(const Json& request);
    Json cancel(const Json& request);
    Json ping(const Json& request);
    Json cache(const Json& request);
    Json keep(const Json& request);
    Json discard(const Json& request);
    Json room(const Json& request);
    Json earlier(const Json& request);
    Json film_frame(const Json& request);
    // What takes time.
    Json folder(const Json& request, Progress& progress);
    Json open(const Json& request, Progress& progress);
    Json open_initial(const Json& request, Progress& progress);
    Json open_kept(const Json& request, Progress& progress);
    Json save(const Json& request, Progress& progress);
    Json look(const Json& request, Progress& progress);
    Json compare(const Json& request, Progress& progress);
    Json probe(const Json& request, Progress& progress);
    Json measure(const Json& request, Progress& progress);
    Json slice(const Json& request, Progress& progress);
    Json labels(const Json& request, Progress& progress);
    Json label(const Json& request, Progress& progress);
    Json snap(const Json& request, Progress& progress);
    Json region(const Json& request, Progress& progress);
    Json gradients(const Json& request, Progress& progress);
    Json export_film(const Json& request, Progress& progress);

    Json show(const Scene& scene, Progress& progress, int halvings = 0, bool goes_on = false);
    Json take_file(const std::string& name, const std::string& bytes);
    Json file_as_scene(const std::string& text, const std::string& name);
    Json file_as_transfer(const std::filesystem::path& file);
    std::shared_ptr<const Loaded> shown() const;
    Film film_of(const Json& request) const;
    static Json volume_of(const Loaded& loaded, const Json& scene);
    Session session_of(const Scene& scene, Progress& progress);
    std::string film_text(const Film& film) const;
    void render_film(const Film& film, const std::filesystem::path& folder, Progress& progress);
    bool is_connected(int connection) const;
    Scene slice_scene(const Json& request) const;
    Scene scene_of(const Json& json, std::vector<std::string>* unknown = nullptr) const;
    void tell(const Json& message) const;
    void tell(int connection, const Json& message) const;
    void send_frame(const Json& header, const Image& image, bool lossless = false, PictureKind kind = {});
    /// Of a picture that is encoded: "png" or "jpeg".
    void send_encoded(Json header, const Image& image, const char* type, const std::string& encoded, PictureKind kind);
    int jpeg_quality() const;
    Progress::Report report_for(const Json& id) const;
    void cancel_all();

    ServerContext& context_;
    const std::string id_;
    mutable std::mutex mutex_;
    std::shared_ptr<Socket> socket_;
    int connection_ = 0;        ///< counts the sockets
    std::int64_t newest_ = -1;  ///< state of this connection
    std::optional<std::chrono::steady_clock::time_point> left_;
    std::shared_ptr<const Loaded> shown_;
    Json state_;                    ///< the scene of the last state that was no preview
    Json undo_;                     ///< the page's steps
    std::optional<KeptView> kept_;  ///< of a server before this one, until its volume is open
    std::map<std::string, std::shared_ptr<Progress>> running_;

    bool shown_before_ = false;    ///< a page was greeted; the hearing queue's own
    int heard_ = 0;                ///< the connection whose message is being understood; the hearing queue's own
    std::optional<Session> side_;  ///< of looks; the side queue's own
    std::shared_ptr<const Loaded> side_shown_;
    int side_moment_ = 0;
    GradientsTold gradients_;  ///< the side queue's own
    mutable FrameSender frames_;
    RenderWorker render_worker_;
    SerialQueue opening_, side_queue_, saving_, comparing_, slicing_, filming_;
    SerialQueue hearing_;  // the last member, as its work uses the others, and theirs those before
};

}  // namespace chiaro::server

#include "kept_views.h"

#include <sys/stat.h>

#include <algorithm>
#include <chrono>
#include <fstream>
#include <iterator>

#include "core/atomic_file.h"

namespace chiaro::server {
namespace fs = std::filesystem;
namespace {

constexpr auto kept_for = std::chrono::hours(24 * 30);
constexpr auto between_writes = std::chrono::milliseconds(500);
constexpr std::size_t max_kept = 200, max_bytes = 4 << 20;
constexpr std::string_view ending = ".view.json";

std::chrono::duration<double> age_of(const fs::path& file) {
    std::error_code error;
    const auto written = fs::last_write_time(file, error);
    return error ? std::chrono::duration<double>(kept_for) : fs::file_time_type::clock::now() - written;
}

std::optional<KeptView> read_kept(const fs::path& file) {
    std::error_code error;
    if (fs::file_size(file, error) > max_bytes || error) return {};
    std::ifstream stream(file, std::ios::binary);
    const std::string text{std::istreambuf_iterator<char>(stream), {}};
    try {
        const Json json = parse_message(text);
        const std::string name = file.filename().string();
        return KeptView{name.substr(0, name.size() - ending.size()), text_in(json, "volume"), object_in(json, "scene"),
                        json.value("undo", Json()), age_of(file).count()};
    } catch (const std::exception&) {  // another version's, or damaged: it is as if there were none
        return {};
    }
}

}  // namespace

KeptViews::KeptViews(fs::path folder) : folder_(std::move(folder)) {
    if (folder_.empty()) return;
    std::error_code error;
    fs::create_directories(folder_.parent_path(), error);
    mkdir(folder_.c_str(), 0700);
    std::vector<std::pair<std::chrono::duration<double>, fs::path>> files;
    for (const auto& entry : fs::directory_iterator(folder_, error))
        if (entry.path().filename().string().ends_with(ending)) files.emplace_back(age_of(entry.path()), entry.path());
    std::sort(files.begin(), files.end());
    for (std::size_t i = 0; i < files.size(); ++i)
        if (i >= max_kept || files[i].first >= kept_for) fs::remove(files[i].second, error);
    thread_ = std::thread([this] { run(); });
}

KeptViews::~KeptViews() {
    {
        const std::lock_guard lock(mutex_);
        ending_ = true;
    }
    changed_.notify_all();
    if (thread_.joinable()) thread_.join();
}

fs::path KeptViews::file_of(const std::string& view) const { return folder_ / (view + std::string(ending)); }

void KeptViews::note(const KeptView& kept) {
    if (folder_.empty()) return;
    const std::lock_guard lock(mutex_);
    if (is_gone(kept)) return;
    waiting_[kept.view] = kept;
    changed_.notify_all();
}

void KeptViews::run() {
    for (bool is_last = false; !is_last;) {
        {
            std::unique_lock lock(mutex_);
            changed_.wait(lock, [&] { return ending_ || !waiting_.empty(); });
        }
        {
            const std::lock_guard writing(writing_);
            std::unique_lock lock(mutex_);
            being_written_ = std::exchange(waiting_, {});
            is_last = ending_;
            lock.unlock();
            for (const auto& [view, kept] : being_written_) write(kept);
            lock.lock();
            being_written_.clear();
        }
        std::unique_lock lock(mutex_);
        changed_.wait_for(lock, between_writes, [&] { return ending_; });
    }
}

bool KeptViews::is_gone(const KeptView& kept) const {
    return std::any_of(gone_.begin(), gone_.end(),
                       [&](const fs::path& folder) { return kept.volume.starts_with(folder.string() + "/"); });
}

/// What cannot be written is not kept: nobody waits for it.
void KeptViews::write(const KeptView& kept) const {
    try {
        const std::string text = text_of({{"volume", kept.volume}, {"scene", kept.scene}, {"undo", kept.undo}});
        if (text.size() > max_bytes) return;
        AtomicFile file(file_of(kept.view), 0600);
        file.write(std::as_bytes(std::span(text)));
        file.commit();
    } catch (const std::exception&) {
    }
}

std::optional<KeptView> KeptViews::find(const std::string& view) const {
    if (folder_.empty()) return {};
    {
        const std::lock_guard lock(mutex_);
        for (const auto* later : {&waiting_, &being_written_})
            if (const auto found = later->find(view); found != later->end()) return found->second;
    }
    return read_kept(file_of(view));
}

std::vector<KeptView> KeptViews::on_disk() const {
    std::vector<KeptView> kept;
    std::error_code error;
    if (folder_.empty()) return kept;
    for (const auto& entry : fs::directory_iterator(folder_, error))
        if (entry.path().filename().string().ends_with(ending))
            if (auto one = read_kept(entry.path())) kept.push_back(std::move(*one));
    return kept;
}

std::map<std::string, KeptView> KeptViews::all() const {
    std::map<std::string, KeptView> by_view;
    {
        const std::lock_guard lock(mutex_);  // before the disk is read: what is written meanwhile is found here
        by_view = waiting_;
        by_view.insert(being_written_.begin(), being_written_.end());
    }
    for (const KeptView& one : on_disk()) by_view.try_emplace(one.view, one);
    return by_view;
}

std::optional<KeptView> KeptViews::newest_of(const std::string& volume, const std::string& except) const {
    std::optional<KeptView> newest;
    for (auto& [view, one] : all())
        if (one.volume == volume && one.view != except && (!newest || one.seconds < newest->seconds))
            newest = std::move(one);
    return newest;
}

std::vector<fs::path> KeptViews::volumes() const {
    std::vector<fs::path> named;
    for (const auto& [view, one] : all()) named.emplace_back(one.volume);
    return named;
}

void KeptViews::forget_below(const fs::path& folder) {
    const std::lock_guard writing(writing_);
    const std::lock_guard lock(mutex_);
    gone_.push_back(folder);
    std::erase_if(waiting_, [&](const auto& entry) { return is_gone(entry.second); });
    std::error_code error;
    for (const KeptView& one : on_disk())
        if (is_gone(one)) fs::remove(file_of(one.view), error);
}

}  // namespace chiaro::server

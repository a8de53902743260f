#include "downloads.h"

#include <chiaro/error.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <tuple>

#include "own_folder.h"
#include "token.h"

namespace chiaro::server {
namespace fs = std::filesystem;

constexpr auto lifetime = std::chrono::minutes(5);
constexpr std::size_t max_offers = 64, max_uploads = 64;

Store::Store() {
    remove_left_behind(fs::temp_directory_path());
    std::tie(folder_, lock_) = make_own_folder(fs::temp_directory_path());
    uploads_ = folder_ / "uploads";
    fs::create_directory(uploads_);
}

Store::~Store() {
    remove();
    if (lock_ >= 0) close(lock_);
}

void Store::remove() {
    std::error_code ignored;
    fs::remove_all(folder_, ignored);
}

fs::path Store::keep(const std::string& name, const std::string& bytes) {
    const std::lock_guard lock(mutex_);
    std::vector<fs::path> kept;
    for (const auto& entry : fs::directory_iterator(uploads_)) kept.push_back(entry.path());
    if (kept.size() >= max_uploads)
        fs::remove(*std::min_element(kept.begin(), kept.end(), [](const fs::path& a, const fs::path& b) {
            return fs::last_write_time(a) < fs::last_write_time(b);
        }));
    std::string ending = fs::path(name).extension().string();
    if (ending.size() > 12 ||
        ending.find_first_not_of(".abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789") != ending.npos)
        ending.clear();
    const fs::path file = uploads_ / (random_key() + ending);
    std::ofstream stream(file, std::ios::binary);
    stream.write(bytes.data(), std::streamsize(bytes.size()));
    if (!stream.flush()) throw Error(ErrorCode::output, fmt::format("{}: cannot be kept", name));
    return file;
}

fs::path Store::fresh(const std::string& ending) const { return folder_ / (random_key() + ending); }

std::string Store::offer(const fs::path& file, const std::string& type, const std::string& save_as) {
    const std::lock_guard lock(mutex_);
    const std::string key = random_key();
    if (offers_.size() >= max_offers) throw Error(ErrorCode::usage, "too many pictures wait to be fetched");
    offers_[key] = {file, type, save_as, std::chrono::steady_clock::now() + lifetime};
    return "/download/" + key;
}

bool Store::has(const std::string& key) const {
    const std::lock_guard lock(mutex_);
    return offers_.contains(key);
}

Response Store::fetch(const std::string& key) {
    const std::lock_guard lock(mutex_);
    const auto found = offers_.find(key);
    Response response;
    if (found == offers_.end()) {
        response.status = 404;
        response.body = "This picture was fetched already, or waited too long.\n";
        return response;
    }
    response.type = found->second.type;
    response.file = found->second.file;
    response.save_as = found->second.save_as;
    offers_.erase(found);
    return response;
}

void Store::tick() {
    const std::lock_guard lock(mutex_);
    const auto now = std::chrono::steady_clock::now();
    std::erase_if(offers_, [&](const auto& entry) {
        if (entry.second.until > now) return false;
        std::error_code ignored;
        fs::remove(entry.second.file, ignored);
        return true;
    });
}

}  // namespace chiaro::server

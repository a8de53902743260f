// Pictures that wait to be fetched, and files that were brought.
#pragma once
#include <chrono>
#include <filesystem>
#include <map>
#include <mutex>
#include <string>

#include "net.h"

namespace chiaro::server {

/// A folder of the user's own that goes with the program; and those go that programs left behind which were killed.
class Store {
public:
    Store();
    ~Store();
    Store(const Store&) = delete;
    Store& operator=(const Store&) = delete;

    /// Removes the folder with all in it, at once; nothing can be kept any more.
    void remove();

    const std::filesystem::path& uploads() const { return uploads_; }
    /// Keeps a brought file under a name of its own, with the ending it had. Throws Error{output}.
    std::filesystem::path keep(const std::string& name, const std::string& bytes);
    /// A new file's name, with this ending.
    std::filesystem::path fresh(const std::string& ending) const;
    /// Offers a file once, for five minutes; its address.
    std::string offer(const std::filesystem::path& file, const std::string& type, const std::string& save_as);
    bool has(const std::string& key) const;
    Response fetch(const std::string& key);
    void tick();

private:
    struct Offer {
        std::filesystem::path file;
        std::string type, save_as;
        std::chrono::steady_clock::time_point until;
    };

    std::filesystem::path folder_, uploads_;
    int lock_ = -1;  ///< the folder, locked: whoever holds that lives
    mutable std::mutex mutex_;
    std::map<std::string, Offer> offers_;
};

}  // namespace chiaro::server

#include "io/chunk_server.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <future>
#include <nlohmann/json.hpp>
#include <thread>

#include "core/text.h"
#include "core/threads.h"
#include "volume/validate.h"

namespace chiaro {
namespace {

constexpr int max_helpers = 8;

void check(const Volume& header, const std::vector<ChunkedLevel>& levels) {
    const auto refuse = [](const char* sentence) { throw Error(ErrorCode::input, sentence); };
    if (levels.empty() || levels.front().dimensions != header.dimensions) refuse("the decoder stated no levels");
    for (const ChunkedLevel& level : levels) {
        check_geometry(level.geometry);
        const auto& [dimensions, chunk, geometry] = level;
        checked_bytes({dimensions[0], dimensions[1], dimensions[2]}, 1, header.type);
        std::uint64_t bytes = size_of(header.type);
        for (const int edge : chunk)
            if (edge < 1 || (bytes *= std::uint64_t(edge)) > largest_chunk_bytes)
                refuse("the decoder stated chunks that are too large");
    }
}

}  // namespace

/// A thread that starts programs and lives as long as they may: they end with the thread that started them.
class ChunkServer::Starter {
public:
    Starter() : thread_([this] { run(); }) {}
    ~Starter() {
        {
            const std::lock_guard lock(mutex_);
            is_over_ = true;
        }
        changed_.notify_all();
        thread_.join();
    }
    /// Calls `start` there, and returns or throws what it does.
    void call(const std::function<void()>& start) {
        std::packaged_task<void()> task(start);
        auto made = task.get_future();
        {
            std::unique_lock lock(mutex_);
            changed_.wait(lock, [&] { return !task_; });
            task_ = &task;
        }
        changed_.notify_all();
        made.get();
    }

private:
    void run() {
        std::unique_lock lock(mutex_);
        for (;;) {
            changed_.wait(lock, [&] { return task_ || is_over_; });
            if (!task_) return;
            auto task = std::move(*task_);
            task();
            task_ = nullptr;
            changed_.notify_all();
        }
    }

    std::mutex mutex_;
    std::condition_variable changed_;
    std::packaged_task<void()>* task_ = nullptr;
    bool is_over_ = false;
    std::thread thread_;
};

/// One program, the connection that it is asked by, and the memory that both see.
class ChunkServer::Helper {
public:
    /// `fetch`: a connection to the program that fetches, if any. The helper cannot send on that which it is asked by.
    Helper(const std::vector<std::string>& arguments, const Descriptor& fetch, int fetcher)
        : fetcher_(fetcher), window_(make_memory_file("chiaro chunk")) {
        auto [ours, theirs] = make_connection();
        shutdown(theirs.number(), SHUT_WR);
        requests_ = std::move(ours);
        process_ = std::make_unique<HelperProcess>(
            find_helper(), arguments,
            HandedOver{.standard_input = theirs.number(), .voxels = window_.number(), .fetch = fetch.number()});
    }
    Helper(const Helper&) = delete;
    Helper& operator=(const Helper&) = delete;
    ~Helper() {
        if (!mapped_.empty()) munmap(const_cast<std::byte*>(mapped_.data()), mapped_.size());
    }

    HelperProcess& process() { return *process_; }
    int fetcher() const { return fetcher_; }  ///< the number of that which it asks; 0: none
    std::span<const std::byte> window() const { return mapped_; }

    /// From now on it can neither shrink nor grow.
    void map(std::size_t bytes) {
        struct stat status {};
        if (ftruncate(window_.number(), off_t(bytes)) != 0 ||
            fcntl(window_.number(), F_ADD_SEALS, F_SEAL_SHRINK | F_SEAL_GROW) != 0 ||
            fstat(window_.number(), &status) != 0 || std::size_t(status.st_size) != bytes)
            throw Error(ErrorCode::output, "cannot make a memory file for a chunk");
        void* mapping = mmap(nullptr, bytes, PROT_READ, MAP_SHARED, window_.number(), 0);
        if (mapping == MAP_FAILED)
            throw Error(ErrorCode::output, fmt::format("there is no room for a chunk of {} MiB", bytes >> 20));
        mapped_ = {static_cast<const std::byte*>(mapping), bytes};
    }

    /// One that is gone gives no answer.
    void ask(const std::string& line) const {
        [[maybe_unused]] const auto sent = send(requests_.number(), line.data(), line.size(), MSG_NOSIGNAL);
    }

private:
    int fetcher_;
    Descriptor window_, requests_;
    std::unique_ptr<HelperProcess> process_;
    std::span<const std::byte> mapped_;
};

ChunkServer::ChunkServer(DecodeRequest request, ReadOptions options)
    : request_(std::move(request)), options_(std::move(options)), starter_(std::make_unique<Starter>()) {
    std::unique_ptr<Helper> first = started();
    try {
        header_ = wire::header_from_json(answer_->at("volume"));
        levels_ = wire::levels_from_json(answer_->at("levels"));
        check_header(header_);
        check(header_, levels_);
    } catch (const std::exception& error) {
        throw Error(ErrorCode::input, sentence_about(request_, error.what()));
    }
    for (auto& note : header_.notes) note = one_line(note);
    for (const ChunkedLevel& level : levels_)
        window_bytes_ = std::max<std::size_t>(window_bytes_, level.chunk_voxels() * size_of(header_.type));
    first->map(window_bytes_);
    free_.resize(std::size_t(std::clamp(usable_threads(), 1, max_helpers)));
    free_.back() = std::move(first);
}

ChunkServer::~ChunkServer() = default;

/// It has told what it serves; the same as the first one.
std::unique_ptr<ChunkServer::Helper> ChunkServer::started() {
    auto arguments = helper_arguments(request_, options_, 3 * largest_chunk_bytes);
    arguments.push_back("serve");
    std::unique_ptr<Helper> helper;
    starter_->call([&] {
        int fetcher = 0;
        const Descriptor fetch = fetch_connection(fetcher);
        helper = std::make_unique<Helper>(arguments, fetch, fetcher);
    });
    Progress progress;
    auto answer = next_answer(helper->process(), request_, options_, progress);
    if (!answer_) {
        answer_ = std::make_unique<nlohmann::json>(std::move(answer));
    } else {
        if (answer != *answer_) throw Error(ErrorCode::input, sentence_about(request_, "it changed while it was read"));
        helper->map(window_bytes_);
    }
    return helper;
}

std::unique_ptr<ChunkServer::Helper> ChunkServer::take_free() {
    std::unique_lock lock(mutex_);
    one_is_free_.wait(lock, [&] { return !free_.empty() || losses_ > max_restarts; });
    if (losses_ > max_restarts) throw Error(ErrorCode::input, last_loss_);
    auto helper = std::move(free_.back());
    free_.pop_back();
    return helper;
}

void ChunkServer::give_back(std::unique_ptr<Helper> helper) {
    {
        const std::lock_guard lock(mutex_);
        free_.push_back(std::move(helper));
    }
    one_is_free_.notify_one();
}

void ChunkServer::count_loss(const char* sentence) {
    {
        const std::lock_guard lock(mutex_);
        last_loss_ = sentence;
        ++losses_;
    }
    one_is_free_.notify_all();
}

/// Starts the program that fetches where there is none any more.
Descriptor ChunkServer::fetch_connection(int& number) {
    if (!request_.is_on_server()) return {};
    const std::lock_guard lock(mutex_);
    if (!fetcher_ || fetcher_->has_ended()) {
        if (fetchers_ > max_restarts)
            throw Error(ErrorCode::input, sentence_about(request_, "the program that fetches it ends again and again"));
        fetcher_.reset();
        fetcher_ = std::make_unique<Fetcher>(request_.path, request_.may_be_private);
        ++fetchers_;
    }
    number = fetchers_;
    return fetcher_->connection();
}

bool ChunkServer::is_fetcher_lost(int number) {
    const std::lock_guard lock(mutex_);
    return number > 0 && (number != fetchers_ || fetcher_->has_ended());
}

void ChunkServer::decode(int level, const std::array<int, 3>& chunk,
                         const std::function<void(std::span<const std::byte>, bool)>& use) {
    std::unique_ptr<Helper> helper = take_free();
    ReadOptions options = options_;
    if (!request_.is_on_server()) options.seconds = options.stall_seconds;  // for one chunk
    try {
        if (!helper) helper = started();
        helper->ask(fmt::format("{} {} {} {}\n", level, chunk[0], chunk[1], chunk[2]));
        Progress progress;
        const auto answer = next_answer(helper->process(), request_, options, progress);
        const std::size_t bytes = levels_[std::size_t(level)].chunk_voxels() * size_of(header_.type);
        use(helper->window().first(bytes), answer.value("chunk", nlohmann::json(true)) != false);
    } catch (const HelperLost& error) {
        helper.reset();
        count_loss(error.what());
        give_back(nullptr);
        throw;
    } catch (const Error& error) {
        const bool is_busy = error.code() == ErrorCode::interrupted;  // it will answer when nobody asks any more
        if (helper && (is_busy || is_fetcher_lost(helper->fetcher()))) helper.reset();
        give_back(std::move(helper));
        throw;
    } catch (...) {
        give_back(std::move(helper));
        throw;
    }
    give_back(std::move(helper));
}

}  // namespace chiaro

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

/// A pair of connected ends. The helper's cannot send; to write to one that is gone is no signal.
std::pair<Descriptor, Descriptor> make_connection() {
    int ends[2];
    if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0)
        throw Error(ErrorCode::output, "cannot start the decoder: no more files can be opened");
    shutdown(ends[1], SHUT_WR);
    return {Descriptor(ends[0]), moved_up(Descriptor(ends[1]))};
}

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
    std::unique_ptr<HelperProcess> start(const std::vector<std::string>& arguments, int requests, int window) {
        std::packaged_task<std::unique_ptr<HelperProcess>()> task(
            [&] { return std::make_unique<HelperProcess>(find_helper(), arguments, requests, window); });
        auto made = task.get_future();
        {
            std::unique_lock lock(mutex_);
            changed_.wait(lock, [&] { return !task_; });
            task_ = &task;
        }
        changed_.notify_all();
        return made.get();
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
    std::packaged_task<std::unique_ptr<HelperProcess>()>* task_ = nullptr;
    bool is_over_ = false;
    std::thread thread_;
};

/// One program, the connection that it is asked by, and the memory that both see.
class ChunkServer::Helper {
public:
    Helper(Starter& starter, const std::vector<std::string>& arguments) : window_(make_memory_file("chiaro chunk")) {
        auto [ours, theirs] = make_connection();
        requests_ = std::move(ours);
        process_ = starter.start(arguments, theirs.number(), window_.number());
    }
    Helper(const Helper&) = delete;
    Helper& operator=(const Helper&) = delete;
    ~Helper() {
        if (!mapped_.empty()) munmap(const_cast<std::byte*>(mapped_.data()), mapped_.size());
    }

    HelperProcess& process() { return *process_; }
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
    auto helper = std::make_unique<Helper>(*starter_, arguments);
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

void ChunkServer::decode(int level, const std::array<int, 3>& chunk,
                         const std::function<void(std::span<const std::byte>)>& use) {
    std::unique_ptr<Helper> helper = take_free();
    ReadOptions options = options_;
    options.seconds = options.stall_seconds;  // for one chunk
    try {
        if (!helper) helper = started();
        helper->ask(fmt::format("{} {} {} {}\n", level, chunk[0], chunk[1], chunk[2]));
        Progress progress;
        next_answer(helper->process(), request_, options, progress);
        use(helper->window().first(levels_[std::size_t(level)].chunk_voxels() * size_of(header_.type)));
    } catch (const HelperLost& error) {
        helper.reset();
        count_loss(error.what());
        give_back(nullptr);
        throw;
    } catch (...) {
        give_back(std::move(helper));
        throw;
    }
    give_back(std::move(helper));
}

}  // namespace chiaro

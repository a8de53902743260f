// Programs that decode a file's chunks, as many at a time as there are threads.
#pragma once
#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <span>

#include "io/fetcher.h"
#include "io/helper.h"

namespace chiaro {

class ChunkServer final : public ChunkReader {
public:
    /// Starts the first program. Throws as decode_isolated, for what is not kept in chunks, too.
    ChunkServer(DecodeRequest request, ReadOptions options);
    ChunkServer(const ChunkServer&) = delete;
    ChunkServer& operator=(const ChunkServer&) = delete;
    ~ChunkServer() override;

    const Volume& header() const override { return header_; }  ///< of the file's own type
    const std::vector<ChunkedLevel>& levels() const override { return levels_; }
    bool is_far() const override { return request_.is_on_server(); }

    /// Each thread waits for a program that has nothing else to do. One that crashed or hung is started again for
    /// whoever asks next, `max_restarts` times in all.
    void decode(int level, const std::array<int, 3>& chunk, const Use& use) override;
    static constexpr int max_restarts = 4;

private:
    class Helper;
    class Starter;
    std::unique_ptr<Helper> started();
    std::unique_ptr<Helper> take_free();
    void give_back(std::unique_ptr<Helper> helper);
    void count_loss(const char* sentence);
    Descriptor fetch_connection(int& number);
    bool is_fetcher_lost(int number);

    DecodeRequest request_;
    ReadOptions options_;
    std::unique_ptr<Starter> starter_;
    std::unique_ptr<Fetcher> fetcher_;        ///< of what lies on a server; the starter's
    int fetchers_ = 0;                        ///< that were started
    std::unique_ptr<nlohmann::json> answer_;  ///< the first program's, which each later one must give
    Volume header_;
    std::vector<ChunkedLevel> levels_;
    std::size_t window_bytes_ = 0;
    std::mutex mutex_;
    std::condition_variable one_is_free_;
    std::vector<std::unique_ptr<Helper>> free_;  ///< null: not started
    int losses_ = 0;
    std::string last_loss_;
};

}  // namespace chiaro

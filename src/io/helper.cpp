#include "io/helper.h"

#include "core/cancel.h"
#include "core/text.h"
#include "io/fetcher.h"
#include "io/helper_process.h"
#include "io/memory.h"
#include "io/raw.h"
#include "io/spill.h"
#include "io/wire.h"
#include "volume/spare_memory.h"
#include "volume/validate.h"

#include <chiaro/error.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <sys/mman.h>
#include <sys/stat.h>

#include <algorithm>
#include <csignal>
#include <nlohmann/json.hpp>
#include <optional>
#include <tuple>

namespace chiaro {
namespace {

using Clock = std::chrono::steady_clock;

/// The voxels exceed what is permitted.
struct TooLarge : Error {
    using Error::Error;
};

[[noreturn]] void refuse(const DecodeRequest& request, const std::string& sentence) {
    throw Error(ErrorCode::input, sentence_about(request, sentence));
}

[[noreturn]] void lose(const DecodeRequest& request, const std::string& sentence) {
    throw HelperLost(ErrorCode::input, sentence_about(request, sentence));
}

std::string text_of_end(int signal, const std::string& at) {
    const std::string what = at.empty() ? "it" : "'" + at + "'";
    if (signal == SIGXCPU || signal == SIGKILL)
        return "decoding " + what + " took more CPU time or memory than is permitted";
    if (signal != 0)
        return fmt::format("the decoder crashed on {} (signal {}), so the file is damaged or of an unknown kind", what,
                           signal);
    return "the decoder ended without an answer";
}

/// Reads messages until one arrives that is an answer.
class Conversation {
public:
    Conversation(const DecodeRequest& request, const ReadOptions& options, Progress& progress)
        : request_(request), options_(options), progress_(progress) {}

    nlohmann::json answer_of(HelperProcess& helper) {
        const auto start = Clock::now();
        auto last_sign = start;
        const auto seconds_since = [](auto then) { return std::chrono::duration<double>(Clock::now() - then).count(); };
        std::string line;
        for (;;) {
            progress_.check();
            check_cancelled();
            const auto event = helper.next(line, std::chrono::milliseconds(20));
            if (event == HelperProcess::Event::ended) {
                const int signal = helper.ending_signal();
                progress_.check();  // what interrupted us may have ended the helper too
                lose(request_, text_of_end(signal, at_));
            }
            if (event == HelperProcess::Event::line) {
                last_sign = Clock::now();
                if (auto answer = take(line); !answer.is_null()) return answer;
            }
            if (seconds_since(start) > options_.seconds)
                lose(request_, fmt::format("decoding it took more than {} seconds", options_.seconds));
            if (seconds_since(last_sign) > options_.stall_seconds)
                lose(request_,
                     fmt::format("decoding it came to a halt for more than {} seconds", options_.stall_seconds));
        }
    }

private:
    nlohmann::json take(const std::string& line) {
        const auto message = nlohmann::json::parse(line, nullptr, false);
        if (!message.is_object()) lose(request_, "the decoder answered with garbage");
        if (const auto error = message.find("error"); error != message.end() && error->is_string()) {
            if (message.value("too_large", false))
                throw TooLarge(ErrorCode::input, sentence_about(request_, error->get<std::string>()));
            refuse(request_, error->get<std::string>());
        }
        if (const auto fraction = message.find("progress"); fraction != message.end() && fraction->is_number())
            progress_.report("read", std::clamp(fraction->get<double>(), 0.0, 1.0));
        if (const auto at = message.find("at"); at != message.end() && at->is_string()) at_ = at->get<std::string>();
        return message.contains("volume") || message.contains("chunk") ? message : nlohmann::json();
    }

    const DecodeRequest& request_;
    const ReadOptions& options_;
    Progress& progress_;
    std::string at_;  ///< the file last named by the helper
};

/// Takes over the voxels, once their file is proved to be as large as the header says and can no longer shrink: a
/// memory file by its seals, a file on disk because it has no name and the helper is gone.
VoxelBuffer map_voxels(const Descriptor& file, bool in_memory, std::uint64_t bytes) {
    struct stat status {};
    if ((in_memory && fcntl(file.number(), F_ADD_SEALS, F_SEAL_SHRINK | F_SEAL_GROW) != 0) ||
        fstat(file.number(), &status) != 0 || std::uint64_t(status.st_size) != bytes)
        throw Error(ErrorCode::input, "the decoder returned another number of voxels than it stated");
    void* mapping = mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_SHARED, file.number(), 0);
    if (mapping == MAP_FAILED)
        throw Error(ErrorCode::input, fmt::format("there is no room for its {} MiB of voxels", bytes >> 20));
    return VoxelBuffer::adopt(mapping, bytes, true);
}

/// Where the helper puts the voxels, and how many bytes of them.
struct Place {
    Descriptor file;
    bool in_memory;
    std::uint64_t max_bytes;
};

/// With the bytes of its voxels, which are not there yet.
std::pair<Volume, std::uint64_t> checked_header(const nlohmann::json& answer) {
    Volume volume = wire::header_from_json(answer.at("volume"));
    for (auto& note : volume.notes) note = one_line(note);
    const std::uint64_t bytes = check_header(volume);
    return {std::move(volume), bytes};
}

/// What the helper answers. It is gone then, so that nobody else writes into the voxels any more.
nlohmann::json ask(const Place& place, const DecodeRequest& request, const ReadOptions& options, Progress& progress) {
    std::optional<Fetcher> fetcher;
    HandedOver handed_over{.standard_input = request.standard_input, .voxels = place.file.number()};
    Descriptor fetch;
    if (request.is_on_server()) {
        fetcher.emplace(request.path, request.may_be_private);
        fetch = fetcher->connection();
        handed_over.fetch = fetch.number();
    }
    HelperProcess helper(find_helper(), helper_arguments(request, options, place.max_bytes), handed_over);
    return next_answer(helper, request, options, progress);
}

/// Whatever the helper says, no other file is opened than the user's and those that it may name: in its folder or
/// below.
void check_folder(const std::filesystem::path& named, const std::filesystem::path& path) {
    const auto folder = std::filesystem::canonical(named.has_parent_path() ? named.parent_path() : ".");
    const auto file = std::filesystem::canonical(path);
    const bool is_inside = std::mismatch(folder.begin(), folder.end(), file.begin(), file.end()).first == folder.end();
    if (!(is_inside || file == std::filesystem::canonical(named)) || !std::filesystem::is_regular_file(file))
        throw Error(ErrorCode::input, "the decoder named a file that is none of its");
}

VoxelsInFile checked_place(const nlohmann::json& answer, const DecodeRequest& request, std::uint64_t bytes) {
    VoxelsInFile place = wire::place_from_json(answer.at("place"));
    check_folder(request.path, place.path);
    const auto size = std::filesystem::file_size(place.path);
    if (size < place.offset || size - place.offset < bytes)
        throw Error(ErrorCode::input, "the decoder stated more voxels than there are");
    return place;
}

Volume decode_into(const Place& place, const DecodeRequest& request, const ReadOptions& options, Progress& progress) {
    const nlohmann::json answer = ask(place, request, options, progress);
    Volume volume;
    std::uint64_t bytes = 0;
    std::optional<VoxelsInFile> in_file;
    try {
        std::tie(volume, bytes) = checked_header(answer);
        if (!answer.contains("place")) {
            volume.voxels = map_voxels(place.file, place.in_memory, bytes);
            return volume;
        }
        in_file = checked_place(answer, request, bytes);
        if (bytes > place.max_bytes) throw Error(ErrorCode::input, "the decoder stated more voxels than are permitted");
        volume.voxels = place.in_memory ? unspecified_bytes(bytes) : make_spilled_voxels(options.spill, bytes);
    } catch (const std::exception& error) {
        refuse(request, error.what());
    }
    read_in_place(*in_file, volume, progress);
    return volume;
}

}  // namespace

std::string sentence_about(const DecodeRequest& request, const std::string& sentence) {
    return "cannot read '" + one_line(request.name) + "': " + one_line(sentence);
}

nlohmann::json next_answer(HelperProcess& helper, const DecodeRequest& request, const ReadOptions& options,
                           Progress& progress) {
    return Conversation(request, options, progress).answer_of(helper);
}

std::vector<std::string> helper_arguments(const DecodeRequest& request, const ReadOptions& options,
                                          std::uint64_t max_bytes) {
    const auto cpu_seconds = std::uint64_t(std::clamp(options.seconds, 1.0, 1e6)) + 1;
    return {request.format,
            request.path,
            request.part,
            std::to_string(max_bytes),
            std::to_string(cpu_seconds),
            std::to_string(options.time)};
}

std::pair<Volume, VoxelsInFile> locate_isolated(const DecodeRequest& request, const ReadOptions& options,
                                                Progress& progress) {
    const nlohmann::json answer = ask({make_memory_file("no voxels"), true, 0}, request, options, progress);
    try {
        auto [volume, bytes] = checked_header(answer);
        return {std::move(volume), checked_place(answer, request, bytes)};
    } catch (const std::exception& error) {
        refuse(request, error.what());
    }
}

Volume decode_isolated(const DecodeRequest& request, const ReadOptions& options, Progress& progress) {
    const std::uint64_t max_bytes = memory_within(options.max_bytes);
    try {
        return decode_into({make_memory_file("chiaro voxels"), true, max_bytes}, request, options, progress);
    } catch (const TooLarge&) {
        const std::uint64_t on_disk = free_disk_bytes(options.spill);
        if (on_disk <= max_bytes || request.standard_input >= 0) throw;
        return decode_into({make_spill_file(options.spill), false, on_disk}, request, options, progress);
    }
}

}  // namespace chiaro

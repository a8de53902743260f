// A series through time is played: each moment is read and classified while the one before is lit and drawn, as
// `chiaro view` does it. Each is measured nine times over, played and at once again alone: its median counts.
#include <chiaro/io.h>
#include <chiaro/samples.h>
#include <fmt/format.h>

#include <algorithm>
#include <future>

#include "child.h"
#include "turntable.h"

namespace chiaro::bench {
namespace {

constexpr int moments = 20;
constexpr const char* asked = "more than classify + light + frame; asked: p95 at most 20 ms";

double percentile_95(Series values) {
    std::sort(values.begin(), values.end());
    return values[std::min(values.size() - 1, values.size() * 95 / 100)];
}

/// A row of the clock, with its 95th percentile.
Row row_of(const std::string& name, const Series& ms, const std::string& note = "") {
    return {name, "ms", spread_of(ms),
            {},   {},   fmt::format("p95 {:.1f}{}{}", percentile_95(ms), note.empty() ? "" : "; ", note)};
}

/// Nested shells that grow, in a file for each moment.
std::string write_series(const TemporaryFolder& folder, int size) {
    const Volume shells = make_sample("shells", size);
    Volume moment = make_volume(shells.dimensions, VoxelType::u8);
    const auto from = shells.as<std::uint8_t>();
    const auto to = moment.as<std::uint8_t>();
    for (int t = 0; t < moments; ++t) {
        for (std::size_t i = 0; i < from.size(); ++i) to[i] = std::uint8_t(from[i] * (60 + 2 * t) / 100);
        write_nrrd(moment, folder / fmt::format("beat_{:03}.nrrd", t), NrrdEncoding::raw);
    }
    return folder / "beat_{t:03}.nrrd";
}

/// What each moment takes, in milliseconds of the clock. Nothing is played while the first is read: it is left out.
struct Times {
    Series read, classify, light, frame;  ///< one after the other, each alone
    Series wait;                          ///< played: for the moment to be ready
    Series shown;                         ///< played: from when it is wanted until its picture is there
    Series beyond;                        ///< shown, less what the same moment took alone right after
};

/// Of each moment the median of all passes.
Series medians(const std::vector<Times>& passes, Series Times::*series) {
    Series of_moments;
    for (std::size_t t = 0; t < (passes[0].*series).size(); ++t) {
        Series one;
        for (const Times& pass : passes) one.push_back((pass.*series)[t]);
        of_moments.push_back(spread_of(one).median);
    }
    return of_moments;
}

class Player {
public:
    explicit Player(const Setup& setup) : progress_(setup.progress), first_(setup.device) {
        scene_.volume = write_series(folder_, setup.quick ? 48 : 256);
        scene_.transfer.points = sample_transfer_function("shells");
        scene_.width = setup.quick ? 64 : 640, scene_.height = setup.quick ? 48 : 480;
        scene_.interpolation = Interpolation::linear;
        first_.show(read_volume(scene_, progress_), progress_);
        scene_.camera = first_.fit(scene_, progress_);
        first_.render(scene_, progress_);
    }

    /// All are played; each is shown again alone before the next is wanted, when that is ready.
    Times pass() {
        Times times;
        std::optional<Session> shown;
        std::future<Session> next = prepare(1);
        for (int t = 1; t < moments; ++t) {
            const Clock clock = Clock::wall();
            shown.emplace(next.get());
            const double waited = clock.ms();
            if (t + 1 < moments) next = prepare(t + 1);
            shown->render(at(t), progress_);
            const double took = clock.ms();
            if (next.valid()) next.wait();
            if (t == 1) continue;
            times.wait.push_back(waited), times.shown.push_back(took);
            alone(t, times);
            times.beyond.push_back(took - times.classify.back() - times.light.back() - times.frame.back());
        }
        return times;
    }

private:
    Scene at(int t) const {
        Scene moment = scene_;
        moment.read.time = t;
        return moment;
    }

    Session classified(int t) {
        Progress own;  // of a thread of its own
        Session session = first_.share_volume();
        session.show_moment(read_volume(at(t), own), own);
        session.fit(at(t), own);  // which classifies
        return session;
    }
    std::future<Session> prepare(int t) {
        return std::async(std::launch::async, [this, t] { return classified(t); });
    }

    void alone(int t, Times& times) {
        Session session = first_.share_volume();
        Volume volume;
        times.read.push_back(1e3 * wall_seconds([&] { volume = read_volume(at(t), progress_); }));
        times.classify.push_back(1e3 * wall_seconds([&] {
                                     session.show_moment(std::move(volume), progress_);
                                     session.fit(at(t), progress_);
                                 }));
        times.light.push_back(1e3 * wall_seconds([&] { session.find_light(at(t), progress_); }));
        times.frame.push_back(1e3 * wall_seconds([&] { session.render(at(t), progress_); }));
    }

    Progress& progress_;
    const TemporaryFolder folder_;
    Session first_;
    Scene scene_;
};

std::vector<Row> measure(const Setup& setup) {
    Player player(setup);
    std::vector<Times> passes;
    for (int i = 0; i < (setup.quick ? 1 : 9); ++i) passes.push_back(player.pass());
    const auto found = [&](Series Times::*series) { return medians(passes, series); };
    return {row_of("moments/read", found(&Times::read)),           row_of("moments/classify", found(&Times::classify)),
            row_of("moments/light", found(&Times::light)),         row_of("moments/frame", found(&Times::frame)),
            row_of("moments/wait", found(&Times::wait)),           row_of("moments/shown", found(&Times::shown)),
            row_of("moments/beyond", found(&Times::beyond), asked)};
}

}  // namespace

std::vector<Case> moment_cases(const Setup& setup) {
    const std::vector<std::string> names{"moments/read", "moments/classify", "moments/light", "moments/frame",
                                         "moments/wait", "moments/shown",    "moments/beyond"};
    return {{names, [&setup] { return measure(setup); }}};
}

}  // namespace chiaro::bench

// How long a call goes on after it was cancelled: at twenty moments, spread over all that it does.
#include <chiaro/error.h>
#include <chiaro/samples.h>
#include <chiaro/session.h>
#include <chiaro/text.h>
#include <fmt/format.h>

#include <atomic>
#include <chrono>
#include <thread>

#include "rows.h"

namespace chiaro::bench {
namespace {

using Time = std::chrono::steady_clock;

/// Milliseconds from the cancellation, after `wait`, to the end of the work; 0 where that ended before.
double cancelled_after(std::chrono::duration<double> wait, const std::function<void(Progress&)>& work) {
    Progress progress;
    std::atomic<bool> is_over{false};
    Time::time_point cancelled = Time::time_point::max();
    std::thread canceller([&] {
        std::this_thread::sleep_for(wait);
        if (is_over) return;
        cancelled = Time::now();
        progress.cancel();
    });
    try {
        work(progress);
    } catch (const Error&) {
    }
    const auto end = Time::now();
    is_over = true;
    canceller.join();
    return std::max(0.0, std::chrono::duration<double, std::milli>(end - cancelled).count());
}

/// `prepare()` gives the work of one try, so that nothing is kept from the one before.
Row measure_cancelling(const Setup& setup, const std::string& name,
                       const std::function<std::function<void(Progress&)>()>& prepare) {
    const auto whole = prepare();
    Progress progress;
    const double seconds = wall_seconds([&] { whole(progress); });
    const int moments = setup.quick ? 5 : 20;
    Series series;
    for (int i = 0; i < moments; ++i) {
        const auto work = prepare();
        series.push_back(cancelled_after(std::chrono::duration<double>(seconds * (i + 0.5) / moments), work));
    }
    const Spread spread = spread_of(series);
    return {.name = name,
            .unit = "ms",
            .value = spread,
            .note = fmt::format("of {:.2f} s; at most {:.0f} ms", seconds, spread.max)};
}

Row cancel_show(const Setup& setup, const std::string& name, VoxelType type) {
    const auto volume = std::make_shared<Volume>(make_sample("shells", setup.quick ? 128 : 512));
    if (type != VoxelType::u8) {
        Volume wide = make_volume(volume->dimensions, type);
        const auto from = std::as_const(*volume).as<std::uint8_t>();
        const auto to = wide.as<float>();
        for (std::size_t i = 0; i < from.size(); ++i) to[i] = from[i];
        *volume = std::move(wide);
    }
    return measure_cancelling(setup, name, [&setup, volume] {
        const auto session = std::make_shared<Session>(setup.device);
        return [session, volume](Progress& progress) { session->show(std::as_const(*volume), progress); };
    });
}

Row cancel_render(const Setup& setup, const std::string& name, Method method) {
    const Volume volume = make_sample("shells", setup.quick ? 64 : 256);
    Scene scene;
    scene.volume = "sample:shells";
    scene.illumination.method = method;
    scene.illumination.histogram.cache = "none";
    scene.illumination.reference.rays = 4;
    Session shown(setup.device);
    Progress progress;
    shown.show(volume, progress);
    return measure_cancelling(setup, name, [&shown, scene] {
        const auto session = std::make_shared<Session>(shown.share_volume());
        return [session, scene](Progress& p) { session->render(scene, p); };
    });
}

}  // namespace

std::vector<Case> cancel_cases(const Setup& setup) {
    std::vector<Case> cases;
    for (const VoxelType type : {VoxelType::u8, VoxelType::f32}) {
        const std::string name = fmt::format("cancel/show/{}", name_of(type));
        cases.push_back({{name}, [=, &setup] { return std::vector{cancel_show(setup, name, type)}; }});
    }
    for (const auto& [method, about] : list_methods()) {
        const std::string name = fmt::format("cancel/render/{}", method);
        Method which{};
        from_text(method, which);
        cases.push_back({{name}, [=, &setup] { return std::vector{cancel_render(setup, name, which)}; }});
    }
    return cases;
}

}  // namespace chiaro::bench

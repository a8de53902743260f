#include "measure.h"

#include <algorithm>
#include <chrono>
#include <ctime>

namespace chiaro::bench {
namespace {

double cpu_now() { return double(std::clock()) / CLOCKS_PER_SEC; }

double wall_now() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

double measure(const Clock& clock, const std::function<void()>& work) {
    work();
    return std::max(1e-3 * clock.ms(), 1e-6);  // the resolution; rates are divided by it
}

}  // namespace

double cpu_seconds(const std::function<void()>& work) { return measure(Clock::cpu(), work); }
double wall_seconds(const std::function<void()>& work) { return measure(Clock::wall(), work); }

Clock Clock::cpu() { return Clock(cpu_now); }
Clock Clock::wall() { return Clock(wall_now); }

Spread spread_of(std::vector<double> values) {
    if (values.empty()) return {};
    std::sort(values.begin(), values.end());
    const std::size_t half = values.size() / 2;
    const double median = values.size() % 2 ? values[half] : (values[half - 1] + values[half]) / 2;
    return {median, values.front(), values.back(), int(values.size())};
}

std::vector<Series> in_turns(int runs, const std::vector<Measure>& measures) {
    std::vector<Series> series(measures.size());
    for (int run = -1; run < runs; ++run)
        for (std::size_t m = 0; m < measures.size(); ++m) {
            const double value = measures[m]();
            if (run >= 0) series[m].push_back(value);
        }
    return series;
}

double median_ratio(const Series& a, const Series& b) {
    Series ratios;
    for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) ratios.push_back(a[i] / b[i]);
    return spread_of(ratios).median;
}

}  // namespace chiaro::bench

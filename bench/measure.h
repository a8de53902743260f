// Time, and what repeated measurements say. Machines are shared: CPU time rather than wall time, and everything
// that is compared is measured in turns, so that a noisy minute meets both.
#pragma once
#include <functional>
#include <vector>

namespace chiaro::bench {

struct Spread {
    double median = 0, min = 0, max = 0;
    int runs = 0;
};

Spread spread_of(std::vector<double> values);

/// Seconds that a call took: of all the process's threads, or of the clock on the wall.
double cpu_seconds(const std::function<void()>& work);
double wall_seconds(const std::function<void()>& work);

/// What has passed since it was made.
class Clock {
public:
    static Clock cpu();   ///< of all the process's threads
    static Clock wall();  ///< on the wall
    double ms() const { return 1e3 * (now_() - start_); }

private:
    explicit Clock(double (*now)()) : now_(now), start_(now()) {}
    double (*now_)();
    double start_;
};

/// One number per call: a time, a rate.
using Measure = std::function<double()>;
using Series = std::vector<double>;

/// Calls every measure once a round, after a round that only warms up; one series for each measure.
std::vector<Series> in_turns(int runs, const std::vector<Measure>& measures);

/// The median of a[i] / b[i].
double median_ratio(const Series& a, const Series& b);

}  // namespace chiaro::bench

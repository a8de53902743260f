// What src/core/threads.h promises, of whichever back end was built.
#include "core/threads.h"

#include <chiaro/error.h>
#include <gtest/gtest.h>

#include <atomic>
#include <fstream>
#include <set>
#include <thread>
#include <vector>

#include "core/lazy.h"

using namespace chiaro;

TEST(Threads, EveryPieceIsDoneOnceAndNoneIsLongerThanTheGrain) {
    for (const int threads : {1, 2, 7})
        for (const std::int64_t count : {0, 1, 5, 64, 1001})
            for (const std::int64_t grain : {1, 3, 64, 5000}) {
                std::vector<int> times(std::size_t(count), 0);  // pieces are disjoint: no locks
                parallel_for(threads, count, grain, [&](std::int64_t first, std::int64_t last) {
                    EXPECT_LT(first, last);
                    EXPECT_LE(last - first, grain);
                    for (auto i = first; i < last; ++i) ++times[std::size_t(i)];
                });
                EXPECT_EQ(times, std::vector<int>(std::size_t(count), 1)) << threads << " " << count << " " << grain;
            }
}

TEST(Threads, OneThreadIsTheCallersOwn) {
    std::set<std::thread::id> seen;
    parallel_for(1, 100, 1, [&](std::int64_t, std::int64_t) { seen.insert(std::this_thread::get_id()); });
    EXPECT_EQ(seen, std::set{std::this_thread::get_id()});
}

TEST(Threads, SeveralWorkAtOnceAndNeverMoreThanAskedFor) {
    for (const int threads : {2, 3, usable_threads() + 1}) {
        std::atomic<int> working{0}, most{0};
        const auto until = std::chrono::steady_clock::now() + std::chrono::seconds(60);
        parallel_for(threads, 200, 1, [&](std::int64_t, std::int64_t) {
            const int now = ++working;
            for (int before = most; before < now && !most.compare_exchange_weak(before, now);) {
            }
            while (most < 2 && std::chrono::steady_clock::now() < until) std::this_thread::yield();
            --working;
        });
        EXPECT_GE(most, 2);
        EXPECT_LE(most, threads);
    }
}

TEST(Threads, CallsMayBeNested) {
    std::vector<std::int64_t> sums(16, 0);
    parallel_for(3, 16, 1, [&](std::int64_t outer, std::int64_t) {
        std::vector<std::int64_t> squares(100);
        parallel_for(2, 100, 7, [&](std::int64_t first, std::int64_t last) {
            for (auto i = first; i < last; ++i) squares[std::size_t(i)] = i * i;
        });
        for (const auto square : squares) sums[std::size_t(outer)] += square;
    });
    EXPECT_EQ(sums, std::vector<std::int64_t>(16, 328350));
}

TEST(Threads, ExceptionsReachTheCallerAndEndTheWork) {
    for (const int threads : {1, 4}) {
        std::atomic<int> begun{0};
        try {
            parallel_for(threads, 100000, 1, [&](std::int64_t, std::int64_t) {
                ++begun;
                throw Error(ErrorCode::input, "of a piece");
            });
            ADD_FAILURE() << "nothing was thrown";
        } catch (const Error& error) {
            EXPECT_STREQ(error.what(), "of a piece");
            EXPECT_EQ(error.code(), ErrorCode::input);
        }
        EXPECT_GE(begun, 1);
        EXPECT_LE(begun, threads);
    }
    const auto nested = [] {
        parallel_for(2, 4, 1, [](std::int64_t, std::int64_t) {
            parallel_for(2, 4, 1, [](std::int64_t, std::int64_t) { throw std::length_error("within"); });
        });
    };
    EXPECT_THROW(nested(), std::length_error);
}

TEST(Threads, CancellationEndsTheWorkEarly) {
    Progress progress;
    int done = 0;
    EXPECT_FALSE(parallel_for(1, 100, 1, "count", progress, [&](std::int64_t, std::int64_t) {
        if (++done == 10) progress.cancel();
    }));
    EXPECT_EQ(done, 10);

    Progress other;
    std::atomic<int> begun{0};
    const std::jthread canceller([&] { other.cancel(); });
    const bool all = parallel_for(3, 100000, 1, "count", other, [&](std::int64_t, std::int64_t) {
        ++begun;
        std::this_thread::yield();
    });
    EXPECT_TRUE(all ? begun == 100000 : begun < 100000) << begun;
}

TEST(Threads, ReportsComeOneAtATime) {
    int reports = 0;  // plain: the sanitizer sees two at once
    double largest = 0;
    Progress progress([&](std::string_view stage, double fraction) {
        EXPECT_EQ(stage, "count");
        EXPECT_GT(fraction, 0);
        EXPECT_LE(fraction, 1);
        ++reports;
        largest = std::max(largest, fraction);
    });
    EXPECT_TRUE(parallel_for(4, 1000, 3, "count", progress, [](std::int64_t, std::int64_t) {
        std::this_thread::sleep_for(std::chrono::microseconds(50));  // so that others begin
    }));
    EXPECT_GE(reports, 1);
    EXPECT_LE(reports, 334);
    EXPECT_GT(largest, 0);
}

TEST(Threads, WhatIsLazyIsMadeOnceThoughManyAsk) {
    for (int round = 0; round < 20; ++round) {
        const Lazy<std::vector<int>> lazy;
        std::atomic<int> made{0};
        parallel_for(4, 16, 1, [&](std::int64_t, std::int64_t) {
            const auto& numbers = lazy([&] {
                ++made;
                return std::vector<int>(1000, 7);
            });
            EXPECT_EQ(numbers[999], 7);
        });
        EXPECT_EQ(made, 1);
    }
}

TEST(Threads, WhatIsLazyIsMadeByTheNextWhereMakingItFailed) {
    const Lazy<int> lazy;
    const auto fail = [&] { lazy([]() -> int { throw Error(ErrorCode::output, "no room"); }); };
    EXPECT_THROW(fail(), Error);
    EXPECT_EQ(lazy([] { return 5; }), 5);
}

// An arena of oneTBB that ends leaves memory behind; a server makes thousands of passes.
TEST(Threads, PassesLeaveNoMemory) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
    GTEST_SKIP() << "sanitizers keep memory of their own";
#endif
    const auto resident = [] {
        std::ifstream status("/proc/self/statm");
        std::size_t total = 0, pages = 0;
        status >> total >> pages;
        return double(pages) * 4096;
    };
    const auto passes = [](int count) {
        for (int i = 0; i < count; ++i)
            for (const int threads : {1, 2}) parallel_for(threads, 8, 1, [](std::int64_t, std::int64_t) {});
    };
    passes(500);
    const double before = resident();
    passes(4000);
    EXPECT_LT(resident() - before, 8e6);  // 50 MB with an arena for each
}

TEST(Threads, SilentPassesEndWithTheCallThatTheyAreOf) {
    Progress outer, inner;
    std::atomic<int> done{0};
    const auto count = [&] { parallel_for(2, 100, 1, [&](std::int64_t, std::int64_t) { ++done; }); };
    {
        const CancelScope scope(outer);
        count();
        EXPECT_EQ(done, 100);
        outer.cancel();
        {
            const CancelScope within(inner);
            count();
            EXPECT_EQ(done, 200) << "the inner call goes on";
        }
        EXPECT_THROW(count(), Error);
        EXPECT_EQ(done, 200);
        std::thread([&] { count(); }).join();
        EXPECT_EQ(done, 300) << "another thread's call is another";
    }
    count();
    EXPECT_EQ(done, 400);
}

// The device that tests of truth run on: CHIARO_TEST_DEVICE, "cpu" (by itself) or "cuda".
#pragma once
#include <chiaro/device.h>
#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>
#include <string_view>

namespace chiaro::testing {

/// Two threads of the CPU, and the GPU beside them that was asked for. Ends the program with 77, "skipped",
/// where there is none.
inline Device find_tested_device() {
    const Device cpu = Device::cpu(2);
    const char* const asked = std::getenv("CHIARO_TEST_DEVICE");
    const std::string_view name = asked ? asked : "cpu";
    if (name == "cpu") return cpu;
    if (list_gpus().empty()) {
        std::puts("skipped: no CUDA device");
        std::exit(77);
    }
    return Device::cuda(0, cpu);
}

/// The same at every call. Never destroyed: the driver may be gone by then.
inline const Device& tested_device() {
    static const Device& device = *new Device(find_tested_device());
    return device;
}

/// A missing GPU is told before the first test.
struct TestedDevice : ::testing::Environment {
    void SetUp() override { tested_device(); }
};
inline const auto* const device_is_found_first = ::testing::AddGlobalTestEnvironment(new TestedDevice);

}  // namespace chiaro::testing

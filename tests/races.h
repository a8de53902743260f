// What tests of races share: chance that can be repeated, and rounds for as long as is asked for.
#pragma once
#include <chiaro/chiaro.h>

#include <chrono>
#include <cstdlib>
#include <random>
#include <thread>

namespace chiaro::testing {

/// Counts the rounds of a test: one, or as many as begin within CHIARO_RACES_SECONDS. CHIARO_RACES_SEED starts the
/// count elsewhere.
class Rounds {
public:
    bool next() {
        ++round_;
        return round_ == 1 || std::chrono::steady_clock::now() < until_;
    }
    std::uint32_t seed() const { return first_ + std::uint32_t(round_); }

private:
    static double number(const char* name) {
        const char* const text = std::getenv(name);
        return text ? std::atof(text) : 0;
    }
    const std::chrono::steady_clock::time_point until_ =
        std::chrono::steady_clock::now() +
        std::chrono::milliseconds(std::int64_t(1000 * number("CHIARO_RACES_SECONDS")));
    const std::uint32_t first_ = std::uint32_t(number("CHIARO_RACES_SEED"));
    int round_ = 0;
};

class Chance {
public:
    explicit Chance(std::uint32_t seed) : random_(seed) {}
    int pick(int low, int high) { return std::uniform_int_distribution(low, high)(random_); }
    double real(double low, double high) { return std::uniform_real_distribution(low, high)(random_); }
    /// Sleeps for up to so many milliseconds: often a tenth of them, for what happens early happens fast.
    void wait(double max_ms) {
        const double ms = pick(0, 1) ? real(0, max_ms) : real(0, max_ms / 10);
        std::this_thread::sleep_for(std::chrono::microseconds(std::int64_t(1000 * ms)));
    }

private:
    std::mt19937 random_;
};

inline constexpr int race_edge = 20;

/// Light that is soon found in a volume of race_edge voxels a side.
inline Scene small_scene(Method method) {
    Scene scene;
    scene.volume = "sample:ball:" + std::to_string(race_edge);
    scene.width = 24, scene.height = 18;
    scene.transfer.opacity_scale = 0.4;
    scene.illumination.method = method;
    scene.illumination.spao.levels = 3;
    scene.illumination.visibility.directions = 40;
    scene.illumination.histogram.radius = 4, scene.illumination.histogram.clusters = 32;
    scene.illumination.transport = {.grid = 12, .directions = 24, .first_directions = 48, .error = 0.01};
    scene.illumination.reference.rays = 4;
    return scene;
}

/// One edit, as a hand makes it: of the transfer function, the camera, the light or the way of showing.
inline void edit(Scene& scene, Chance& chance) {
    constexpr const char* probes[] = {"sky", "studio", ""};
    switch (chance.pick(0, 7)) {
        case 0:
            scene.transfer.opacity_scale = chance.real(0.1, 2);
            break;
        case 1:
            scene.transfer.source = chance.pick(0, 1) ? "gray" : "";
            break;
        case 2:
        case 3:
            scene.camera.azimuth_deg = chance.real(0, 360);
            break;
        case 4:
            scene.lighting.probe.source = probes[chance.pick(0, 2)];
            break;
        case 5:
            scene.lighting.probe.rotation_deg = chance.real(0, 360);
            break;
        case 6:
            scene.lighting.strength = chance.real(0.2, 1);
            break;
        default:
            scene.sampling.classification = chance.pick(0, 1) ? Classification::preintegrated : Classification::post;
    }
}

}  // namespace chiaro::testing

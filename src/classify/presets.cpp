// The looks that Chiaro brings along, chosen by eye; docs/transfer-functions.md says what stretching is.
#include "classify/presets.h"

namespace chiaro {
namespace {

constexpr Rgb dark_red{0.45, 0.10, 0.08}, flesh{0.80, 0.48, 0.38}, skin{0.90, 0.70, 0.58}, bone{0.93, 0.88, 0.76},
    ivory{0.98, 0.96, 0.90}, blood{0.78, 0.12, 0.10}, lung_blue{0.45, 0.60, 0.80}, lung_rose{0.86, 0.62, 0.58};

}  // namespace

std::span<const PresetRow> preset_rows() {
    static const std::vector<PresetRow> rows = {
        // Opacity per millimetre: bone reads as solid within a few millimetres whatever the spacing.
        {{"ct-bone", "CT", "bone in ivory, soft tissue left out", false},
         1,
         true,
         {{130, dark_red, 0}, {200, flesh, 0.06}, {300, bone, 0.8}, {700, bone, 0.97}, {1600, ivory, 0.99}}},
        {{"ct-soft-tissue", "CT", "skin and muscle, bone shining through", false},
         1,
         true,
         {{-300, skin, 0},
          {-150, skin, 0.10},
          {-60, skin, 0.08},
          {20, flesh, 0.12},
          {90, dark_red, 0.2},
          {250, bone, 0.6},
          {1200, ivory, 0.95}}},
        {{"ct-vessels", "CT", "contrast-filled vessels in red before bone", false},
         1,
         true,
         {{120, blood, 0}, {160, blood, 0.15}, {280, blood, 0.7}, {420, bone, 0.75}, {1200, ivory, 0.95}}},
        {{"ct-lung", "CT", "airways and lung tissue", false},
         1,
         true,
         {{-980, lung_blue, 0},
          {-900, lung_blue, 0.004},
          {-780, lung_rose, 0.012},
          {-620, lung_rose, 0.03},
          {-400, blood, 0.08},
          {-250, blood, 0.01},
          {150, bone, 0.02},
          {400, ivory, 0.3}}},
        {{"mr-brain", "MR", "the surface of the brain or head", true},
         1,
         false,
         {{0.22, {0.62, 0.30, 0.25}, 0},
          {0.42, {0.88, 0.64, 0.55}, 0.12},
          {0.60, {0.92, 0.76, 0.68}, 0.5},
          {0.85, {0.98, 0.91, 0.84}, 0.85},
          {1, ivory, 0.95}}},
        {{"micro-ct", "micro-CT", "8 bit and industrial CT: thin matter glassy, dense matter solid", true},
         1,
         false,
         {{0.12, {0.45, 0.68, 0.85}, 0},
          {0.25, {0.55, 0.75, 0.82}, 0.03},
          {0.40, {0.88, 0.72, 0.52}, 0.3},
          {0.65, {0.96, 0.85, 0.66}, 0.95},
          {1, {1.00, 0.97, 0.92}, 0.99}}},
        {{"simulation", "simulation", "smoke, flames and densities: soft, cold to hot", true},
         1,
         false,
         {{0.03, {0.25, 0.45, 0.85}, 0},
          {0.20, {0.30, 0.62, 0.92}, 0.03},
          {0.45, {0.65, 0.88, 0.80}, 0.07},
          {0.70, {1.00, 0.82, 0.38}, 0.18},
          {1, {0.96, 0.36, 0.18}, 0.4}}},
    };
    return rows;
}

}  // namespace chiaro

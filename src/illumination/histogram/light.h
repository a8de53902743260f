// What a picture looks up of local histograms: the table of words in the light of a transfer function.
#pragma once
#include <memory>

#include "classify/medium.h"
#include "illumination/histogram/field.h"
#include "illumination/histogram/histograms.h"

namespace chiaro {

/// What a picture looks up: everything that a HistogramView points to.
struct HistogramLight {
    std::shared_ptr<const LocalHistograms> histograms;
    std::vector<kernel::Rgba> codewords;
    std::vector<float> side;              ///< by entry of the medium's table
    std::vector<kernel::Rgba> emission;   ///< of what glows; else empty
    std::vector<std::uint8_t> occupancy;  ///< likewise
    std::vector<kernel::Rgba> albedo;     ///< by entry of the medium's table
    kernel::HistogramView view{};

    /// Those of `owner`, which is this.
    void add_to(HostArrays& arrays, const std::shared_ptr<const HistogramLight>& owner) const {
        for (const auto* colours : {&codewords, &emission, &albedo}) arrays.add(owner, *colours);
        arrays.add(owner, side);
        arrays.add(owner, occupancy);
        arrays.add(histograms->life, histograms->identifiers);
        arrays.add(histograms->displaced.array());
    }
    std::size_t bytes() const {
        return (codewords.size() + emission.size() + albedo.size()) * sizeof codewords[0] +
               side.size() * sizeof side[0] + occupancy.size();
    }
};

/// Cost: one pass over the words, some milliseconds for 2048 of 4096 bins. `in_mixture`: it lights several channels, of
/// whose samples no value is known.
std::shared_ptr<const HistogramLight> make_histogram_light(const Device& device, const Medium::Data& medium,
                                                           std::shared_ptr<const LocalHistograms> histograms,
                                                           const HistogramSettings& settings, bool in_mixture = false);

/// v of every node as light on particles, which face nowhere: the mean of both halves, at no normal offset.
struct ParticleLight {
    CellValues open;
    kernel::GridView nodes;
};
ParticleLight light_on_particles(const Device& device, const Medium::Data& medium, const LocalHistograms& histograms,
                                 const HistogramSettings& settings);

/// O_env of every voxel (one component), or with colour bleeding E_env (RGB), on the volume's grid: of the half ball
/// that faces outwards there, unlifted and between nodes interpolated.
Volume histogram_field(const Device& device, const Medium::Data& medium, const LocalHistograms& histograms,
                       const HistogramSettings& settings, Progress& progress);

}  // namespace chiaro

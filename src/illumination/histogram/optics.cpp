#include "illumination/histogram/optics.h"

#include "core/srgb.h"
#include "core/threads.h"
#include "cuda/device_cache.h"
#include "illumination/histogram/emission.h"
#include "illumination/histogram/launch.h"
#include "illumination/histogram/launch_gpu.h"

namespace chiaro {
namespace {

/// The material behind isosurfaces, at one value.
void add_material(const Medium::Data& medium, double value, const OpticalTable::Entry& entry, BinOptics& optics) {
    double clear = 1;
    const IsoSurface* highest = nullptr;
    for (const IsoSurface& s : medium.shape.iso) {
        if (value < s.value) continue;
        clear *= 1 - s.opacity;
        if (!highest || s.value > highest->value) highest = &s;
    }
    std::array<float, 3> rgb{entry.r, entry.g, entry.b};
    if (highest && highest->color)
        for (std::size_t c = 0; c < 3; ++c)
            rgb[c] = float(medium.shape.color == ColorMode::linear ? linear_from_srgb((*highest->color)[c])
                                                                   : (*highest->color)[c]);
    optics.alpha.push_back(float(1 - clear)), optics.rgb.push_back(rgb);
}

/// The words of the bins [first, end) on the device's GPU, which keeps the histograms.
void sum_codewords_on_gpu(const Device& device, const LocalHistograms& h, std::pair<std::size_t, std::size_t> bins,
                          const std::vector<float>& weights, std::vector<std::array<float, 4>>& sums) {
    cuda::Stream& stream = *device.stream;
    HostArrays arrays;
    arrays.add(h.weak_from_this(), h.shares);
    arrays.add(weights);
    cuda::Views views(stream, std::move(arrays));
    const cuda::Array<float> parts(stream, 4 * sums.size() * kernel::codeword_parts), out(stream, 4 * sums.size());
    kernel::CodewordTable table{
        h.shares.data(),           weights.data(), h.codewords, h.stride, std::int32_t(bins.first),
        std::int32_t(bins.second), parts.data(),   out.data()};
    views.to_device_pointers(table.shares, table.weights);
    kernel::find_codeword_sums(stream, table);
    stream.download(sums.data(), out.data(), sums.size() * sizeof sums[0]);
    stream.wait();
}

}  // namespace

BinOptics optics_of_bins(const Medium::Data& medium, const LocalHistograms& h, const std::string& emission) {
    const DeviceVolume::Data& volume = medium.volume.data();
    const double edge_mm = h.grid.edge_mm;
    BinOptics optics;
    const auto emissive = emission.empty() ? EmissionMapping() : EmissionMapping(emission);
    for (int j = 0; j < h.binning.count; ++j) {
        const double stored = h.binning.stored_of(j), value = volume.scale * stored + volume.offset;
        const OpticalTable::Entry& entry = medium.table.at(stored);
        if (medium.shape.mode == Mode::iso) {
            add_material(medium, value, entry, optics);
        } else {
            optics.alpha.push_back(float(-std::expm1(-entry.extinction_per_mm * edge_mm)));
            optics.rgb.push_back({entry.r, entry.g, entry.b});
        }
        if (!emission.empty()) optics.emission.push_back(float(emissive.at(value)));
    }
    return optics;
}

std::vector<std::array<float, 4>> codeword_sums(const Device& device, const LocalHistograms& h,
                                                const BinOptics& optics) {
    const auto stride = std::size_t(h.stride);
    std::vector<float> weights(4 * stride);
    std::size_t first = stride, end = 0;
    for (std::size_t j = 0; j < optics.alpha.size(); ++j) {
        const float alpha = optics.alpha[j], emission = optics.emission.empty() ? 1 : optics.emission[j];
        for (std::size_t c = 0; c < 3; ++c) weights[c * stride + j] = alpha * emission * optics.rgb[j][c];
        weights[3 * stride + j] = alpha;
        if (alpha > 0) first = std::min(first, j / 16 * 16), end = j + 1;
    }
    std::vector<std::array<float, 4>> sums(std::size_t(h.codewords), {0, 0, 0, 0});
    if (end == 0) return sums;
    const auto here = [&](std::int64_t from, std::int64_t to) {
        const auto run = kernel::histogram_functions_for(device.isa).codeword_sums;
        run(h.shares.data() + std::size_t(from) * stride, std::int32_t(to - from), h.stride, std::int32_t(first),
            std::int32_t(end), weights.data(), sums[std::size_t(from)].data());
    };
    const auto on_gpu = [&] { sum_codewords_on_gpu(device, h, {first, end}, weights, sums); };
    if (!cuda::try_gpu(device, on_gpu)) parallel_for(device.threads, h.codewords, 64, here);
    for (std::size_t w = 0; w < sums.size(); ++w)
        for (float& sum : sums[w]) sum *= h.scale[w];
    return sums;
}

}  // namespace chiaro

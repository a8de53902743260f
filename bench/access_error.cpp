#include "access_error.h"

#include <chiaro/compare.h>
#include <chiaro/samples.h>
#include <chiaro/scene.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "classify/medium.h"
#include "illumination/access.h"
#include "illumination/reference/outward.h"
#include "turntable.h"

namespace chiaro::bench {
namespace {

struct Crop {
    const char *name, *file;
    std::array<int, 3> first;  ///< lowest voxel of the crop, where there is structure
};
constexpr Crop all_crops[] = {{"engine", "engine.nrrd", {104, 104, 40}},
                              {"bonsai", "bonsai.nrrd", {104, 130, 104}},
                              {"cthead", "cthead.nrrd", {104, 30, 32}}};

Volume cropped(const Volume& volume, const std::array<int, 3>& first, int edge) {
    Volume crop = make_volume({edge, edge, edge}, volume.type);
    crop.slope = volume.slope, crop.intercept = volume.intercept, crop.geometry = volume.geometry;
    const std::size_t bytes = size_of(volume.type), row = std::size_t(edge) * bytes;
    const auto [nx, ny, nz] = volume.dimensions;
    for (int k = 0; k < edge; ++k)
        for (int j = 0; j < edge; ++j) {
            const std::size_t from = (std::size_t(first[2] + k) * ny + first[1] + j) * nx + first[0];
            std::memcpy(crop.voxels.data() + (std::size_t(k) * edge + j) * row, volume.voxels.data() + from * bytes,
                        row);
        }
    return crop;
}

/// Bone: opacity 0 to 1 over stored 1150 to 1350.
TransferFunction bone() {
    TransferFunction tf;
    tf.points = {{1150, {1, 1, 1}, 0}, {1350, {1, 1, 1}, 1}};
    return tf;
}

TransferFunction transfer_of(const std::string& name) {
    if (name == "cthead") return bone();
    if (const auto of_scene = scene_function(name)) return *of_scene;
    return sample_transfer_function(name);
}

LitSubject lit(const Device& device, const Volume& volume, const std::string& name, Progress& progress) {
    const Medium medium = classify(upload(device, volume), transfer_of(name), Shape{});
    return {device, medium, cell_opacity(medium.data(), progress)};
}

template <class Counts>
CellMask mask_of(const CellValues& opacity, const Counts& counts) {
    const auto [nx, ny, nz] = opacity.grid.count;
    CellMask mask(opacity.grid.size());
    for (int z = 0; z < nz; ++z)
        for (int y = 0; y < ny; ++y)
            for (int x = 0; x < nx; ++x) mask[opacity.grid.index(x, y, z)] = counts(x, y, z);
    return mask;
}

Frame slice_of(const CellValues& values, int z) {
    const auto [nx, ny, nz] = values.grid.count;
    Frame frame(nx, ny);
    for (std::size_t i = 0; i < std::size_t(nx) * ny; ++i) {
        std::fill_n(&frame.rgba[4 * i], 3, float(values.data()[values.grid.index(0, 0, z) + i] / cell_one));
        frame.rgba[4 * i + 3] = 1;
    }
    return frame;
}

}  // namespace

CellValues LitSubject::field(const IlluminationSettings& settings, Progress& progress) const {
    StageTimer timer;
    const BlockMap all(opacity.values.grid.count, true);
    return accessibility(device, medium.data(), opacity, settings, all, timer, progress);
}

CellValues LitSubject::ground_truth(ReferenceQuantity quantity, int rays, Progress& progress) const {
    IlluminationSettings settings{.method = Method::reference};
    settings.reference.rays = rays, settings.reference.quantity = quantity;
    return field(settings, progress);
}

const std::vector<std::string>& lit_subjects() {
    static const std::vector<std::string> names{"cornell", "fog", "engine", "bonsai", "cthead"};
    return names;
}

std::optional<LitSubject> find_lit_subject(const Device& device, const std::filesystem::path& data,
                                           const std::string& name, int samples, int crops, Progress& progress) {
    for (const Crop& crop : all_crops) {
        if (name != crop.name) continue;
        const auto file = real_file(data, crop.file);
        if (!file) return std::nullopt;
        const Volume whole = read_volume(file->string(), ReadOptions{}, progress);
        return lit(device, cropped(whole, crop.first, crops), name, progress);
    }
    return lit(device, make_sample(name, samples), name, progress);
}

CellMask visible_cells(const CellValues& opacity) {
    const auto [nx, ny, nz] = opacity.grid.count;
    return mask_of(opacity, [&, nx = nx, ny = ny, nz = nz](int x, int y, int z) {
        for (int k = std::max(z - 1, 0); k <= std::min(z + 1, nz - 1); ++k)
            for (int j = std::max(y - 1, 0); j <= std::min(y + 1, ny - 1); ++j)
                for (int i = std::max(x - 1, 0); i <= std::min(x + 1, nx - 1); ++i)
                    if (opacity.data()[opacity.grid.index(i, j, k)] > 0) return true;
        return false;
    });
}

CellMask cells_with_normal(const CellValues& opacity, double least) {
    // share = min(1, F |n|) reaches 1 at |n| = 1 / F.
    return mask_of(opacity, [&](int x, int y, int z) { return outward_at(opacity, x, y, z, 0.25 / least).share >= 1; });
}

AccessError error_of(const CellValues& found, const CellValues& ground_truth, const CellMask& counts) {
    double n = 0, sum_a = 0, sum_b = 0, aa = 0, bb = 0, ab = 0, squares = 0;
    for (std::size_t i = 0; i < counts.size(); ++i) {
        if (!counts[i]) continue;
        const double a = found.data()[i] / double(cell_one), b = ground_truth.data()[i] / double(cell_one);
        n += 1, sum_a += a, sum_b += b, aa += a * a, bb += b * b, ab += a * b, squares += (a - b) * (a - b);
    }
    const double covariance = ab - sum_a * sum_b / n, variances = (aa - sum_a * sum_a / n) * (bb - sum_b * sum_b / n);
    return {std::sqrt(squares / n), (sum_a - sum_b) / n, covariance / std::sqrt(variances)};
}

double mean_ssim(const CellValues& a, const CellValues& b) {
    double sum = 0;
    const int slices = a.grid.count[2];
    for (int z = 0; z < slices; ++z) sum += compare(slice_of(a, z), slice_of(b, z)).ssim;
    return sum / slices;
}

}  // namespace chiaro::bench

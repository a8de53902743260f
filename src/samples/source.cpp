// A sample of any size: voxels are found where they are asked for.
#include <algorithm>

#include "samples/sample.h"

namespace chiaro {
namespace {

/// Level l is the sample at size / 2^l. Its voxels fill the cube that those of level 0 fill: formulas on the span of
/// the voxels' centres (shells, marschner-lobb) are up to half a coarse voxel off at the border.
class SampleSource final : public BrickSource {
public:
    SampleSource(const Sample& sample, Volume header, std::vector<SourceLevel> levels)
        : BrickSource(std::move(header), std::move(levels)) {
        for (const SourceLevel& level : this->levels()) voxels_.push_back(sample.voxels(level.dimensions[0]));
    }

    void read(int level, const VoxelBox& box, std::byte* to) const override {
        voxels_[std::size_t(level)].fill(box, to);
    }

private:
    std::vector<SampleVoxels> voxels_;
};

std::vector<SourceLevel> levels_of(const Volume& header) {
    const int size = header.dimensions[0];
    std::vector<SourceLevel> levels{{header.dimensions, header.geometry}};
    for (int n = size / 2; n >= least_level_edge; n /= 2) {
        const double stride = double(size) / n, first = (stride - 1) / 2;
        levels.push_back({{n, n, n}, every(header.geometry, {stride, stride, stride}, {first, first, first})});
    }
    return levels;
}

}  // namespace

std::shared_ptr<const BrickSource> open_sample(const std::string& name, int size) {
    const Sample sample = sample_named(name);
    Volume header = sample_header(sample, size, 16384);
    if (size > 0) header.source += ":" + std::to_string(size);
    std::vector<SourceLevel> levels = levels_of(header);
    return std::make_shared<SampleSource>(sample, std::move(header), std::move(levels));
}

}  // namespace chiaro

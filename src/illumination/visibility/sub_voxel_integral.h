// The numbers that sub_voxel_integral_kernel.h looks up.
#pragma once
#include <algorithm>
#include <vector>

#include "classify/medium.h"
#include "illumination/cells/opacity.h"
#include "illumination/visibility/sub_voxel_integral_kernel.h"

namespace chiaro {

/// ∫ κ df of the optical table, so that a step from one value to another meets all that lies between them.
class ExtinctionIntegral {
public:
    ExtinctionIntegral(const Medium::Data& medium, const CellGrid& grid)
        : extinction_(extinction_per_edge(medium, grid)),
          scale_(medium.table.index_scale),
          offset_(medium.table.index_offset + 0.5) {
        for (float kappa : extinction_) before_.push_back(before_.back() + double(kappa));
    }
    kernel::IntegralView integral() const {
        return {extinction_.data(), before_.data(), scale_, offset_, double(extinction_.size() - 1)};
    }

    kernel::SubVoxelIntegralOfAny view() const { return {integral()}; }
    void add_to(HostArrays& arrays) const { arrays.add(extinction_), arrays.add(before_); }

private:
    std::vector<float> extinction_;
    std::vector<double> before_{0};
    double scale_, offset_;
};

class LevelIntegrals {
public:
    LevelIntegrals(const ExtinctionIntegral& of, const DeviceVolume::Data& volume, int per_unit)
        : per_unit_(per_unit), low_(volume.stored_min), last_(int((volume.stored_max - low_) * float(per_unit))) {
        const kernel::IntegralView integral = of.integral();
        const double index_per_level = integral.place(low_ + 1.0 / per_unit).index - integral.place(low_).index;
        for (int half = 0; half <= 2 * last_; ++half) {
            const auto place = integral.place(low_ + 0.5 * half / per_unit);
            integral_.push_back(place.integral / (3 * index_per_level));
            if (half % 2 == 0) sixth_.push_back(integral.at(place) / 6);
        }
        for (int way = -last_; way <= last_; ++way) inverse_.push_back(way == 0 ? 0 : 1.0 / way);
    }

    kernel::SubVoxelIntegralOfLevels view() const {
        return {integral_.data(), inverse_.data(), sixth_.data(), per_unit_, low_, last_, 0};
    }
    void add_to(HostArrays& arrays) const { arrays.add(integral_), arrays.add(inverse_), arrays.add(sixth_); }

private:
    int per_unit_;
    float low_;
    int last_;
    std::vector<double> integral_, inverse_;
    std::vector<float> sixth_;
};

/// Of stored whole numbers.
template <class Voxel>
class VoxelIntegrals {
public:
    VoxelIntegrals(const ExtinctionIntegral& of, const DeviceVolume::Data& volume)
        : low_(int(volume.stored_min)), levels_(of, volume, 1) {}
    kernel::SubVoxelIntegralOfVoxels<Voxel> view() const { return {levels_.view(), low_, 0}; }
    void add_to(HostArrays& arrays) const { levels_.add_to(arrays); }

private:
    int low_;
    LevelIntegrals levels_;
};

/// Of 8 bits.
template <>
class VoxelIntegrals<std::uint8_t> {
public:
    VoxelIntegrals(const ExtinctionIntegral& of, const DeviceVolume::Data& volume) : pairs_(256 * 256) {
        const kernel::SubVoxelIntegralOfAny any = of.view();
        for (int value = int(volume.stored_min); value <= int(volume.stored_max); ++value)
            for (int other = int(volume.stored_min); other <= int(volume.stored_max); ++other)
                pairs_[std::size_t(256 * value + other)] = any.from(float(value)).to(float(other));
    }
    kernel::SubVoxelIntegralOfVoxels<std::uint8_t> view() const { return {pairs_.data()}; }
    void add_to(HostArrays& arrays) const { arrays.add(pairs_); }

private:
    std::vector<float> pairs_;
};

}  // namespace chiaro

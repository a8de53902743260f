// Samples on a lattice: where one lies in memory is a sum over the axes, found once for each coordinate.
#pragma once
#include <array>
#include <vector>

#include "volume/device_view.h"

namespace chiaro {

/// Value and voxel at each point of a lattice, the same bits as VolumeView gives.
template <class Voxel>
class AxisPlaces {
public:
    /// `coordinates`: of each axis, voxels.
    AxisPlaces(const kernel::VolumeView<Voxel>& view, const std::array<std::vector<double>, 3>& coordinates)
        : view_(view), origin_(address({})) {
        for (int axis = 0; axis < 3; ++axis)
            for (const double coordinate : coordinates[axis]) {
                const float c = float(coordinate);
                Point p{axis == 0 ? c : 0, axis == 1 ? c : 0, axis == 2 ? c : 0};
                p = view.clamp(p);
                const auto at = view.locate(p, view.voxel(p));
                const float t = axis == 0 ? at.t.x : axis == 1 ? at.t.y : at.t.z;
                places_[axis].push_back({std::uint32_t(at.index) - origin_, t,
                                         axis == 0   ? at.p.x
                                         : axis == 1 ? at.p.y
                                                     : at.p.z});
            }
    }

    /// Trilinear, in stored units.
    float value(std::size_t x, std::size_t y, std::size_t z) const {
        const Place &i = places_[0][x], &j = places_[1][y], &k = places_[2][z];
        return view_.value(kernel::Location<float>{std::int32_t(origin_ + i.at + j.at + k.at), {i.t, j.t, k.t}});
    }
    /// Of a mixture.
    kernel::Rgba matter(std::size_t x, std::size_t y, std::size_t z) const {
        const Place &i = places_[0][x], &j = places_[1][y], &k = places_[2][z];
        return view_.matter_at(kernel::Location<float>{
            std::int32_t(origin_ + i.at + j.at + k.at), {i.t, j.t, k.t}, {i.voxel, j.voxel, k.voxel}});
    }
    bool is_mixed() const { return view_.is_mixed(); }
    /// Of whole coordinates. The last voxel of an axis lies behind its last interval, a whole step from its first end.
    Voxel voxel(std::size_t x, std::size_t y, std::size_t z) const {
        const Place &i = places_[0][x], &j = places_[1][y], &k = places_[2][z];
        return view_.voxels[origin_ + i.at + j.at + k.at + std::uint32_t(i.t) + std::uint32_t(j.t) * brick_row +
                            std::uint32_t(k.t) * brick_slice];
    }

private:
    using Point = kernel::Vec3<float>;
    struct Place {
        std::uint32_t at;
        float t, voxel;
    };
    std::uint32_t address(Point p) const { return std::uint32_t(view_.locate(p, view_.voxel(p)).index); }

    kernel::VolumeView<Voxel> view_;
    std::uint32_t origin_;
    std::array<std::vector<Place>, 3> places_;
};

}  // namespace chiaro

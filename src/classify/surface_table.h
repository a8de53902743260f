// The opacity that surfaces are told by (surface_view.h), of a classified volume.
#pragma once
#include <vector>

#include "classify/medium.h"
#include "classify/surface_view.h"

namespace chiaro {

class SurfaceTable {
public:
    explicit SurfaceTable(const Medium::Data& medium);

    kernel::SurfaceView view() const {
        kernel::SurfaceView view = view_;
        view.opacity = opacity_.data();
        return view;
    }
    /// What the view reads.
    const std::vector<float>& opacity() const { return opacity_; }

private:
    std::vector<float> opacity_;
    kernel::SurfaceView view_;
};

/// What the ray caster reads at each sample, where opacity is the optical table's alone.
class ShareTable {
public:
    ShareTable(const OpticalTable& table, const SurfaceTable& surface);

    kernel::ShareTableView view() const {
        kernel::ShareTableView view = view_;
        view.shares = shares_.data(), view.depths = depths_.data();
        return view;
    }
    /// What the view reads.
    const std::vector<std::uint32_t>& shares() const { return shares_; }
    const std::vector<std::uint32_t>& depths() const { return depths_; }

private:
    std::vector<std::uint32_t> shares_, depths_;
    kernel::ShareTableView view_;
};

/// The medium's own, made when it is first asked for (some .6 ms for 65536 values).
std::shared_ptr<const SurfaceTable> surface_table_of(const Medium::Data& medium);
/// The same; null where opacity is not the optical table's alone.
std::shared_ptr<const ShareTable> share_table_of(const Medium::Data& medium);

}  // namespace chiaro

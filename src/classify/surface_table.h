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

/// The medium's own, made when it is first asked for (some .6 ms for 65536 values).
std::shared_ptr<const SurfaceTable> surface_table_of(const Medium::Data& medium);

}  // namespace chiaro

// Where the pointers of the ray caster's views are: all in which a GPU's kernel differs from the CPU's.
#pragma once
#include "illumination/cells/field.h"
#include "illumination/histogram/field.h"
#include "illumination/none/field.h"
#include "illumination/visibility/field.h"
#include "raycast/kernel.h"
#include "volume/device_view.h"
#include "volume/texture_view.h"

namespace chiaro {

template <class Views>
void swap_pointers(Views&, kernel::NoneView&) {}
template <class Views>
void swap_pointers(Views& views, kernel::AccessView& view) {
    views.to_device_pointers(view.cells);
}
template <class Views>
void swap_pointers(Views& views, kernel::VisibilityView& view) {
    views.to_device_pointers(view.light.nodes);
    if (!view.surface.entries) view.harmonics.nodes = nullptr;  // not read
    views.to_device_pointers(view.harmonics.nodes, view.surface.entries, view.crowded.depth, view.scattered.around,
                             view.scattered.boundary_cells, view.highlight.radiance, view.highlight.reflected);
    for (kernel::SunLight& sun : view.suns) views.to_device_pointers(sun.nodes);
}
template <class Views>
void swap_pointers(Views& views, kernel::HistogramView& view) {
    views.to_device_pointers(view.identifiers, view.codewords, view.side, view.albedo, view.emission_codewords,
                             view.occupancy);
}

template <class Views>
void swap_pointers(Views&, kernel::VolumeView<kernel::Texel>&) {}

/// But for the frame, which is written.
template <class Views, class Voxel, class Field>
void swap_pointers(Views& views, kernel::RaycastKernel<Voxel, Field>& kernel) {
    swap_pointers(views, kernel.matter.volume);
    views.to_device_pointers(kernel.matter.occupancy.cells, kernel.matter.table.entries, kernel.matter.onsets.onsets,
                             kernel.matter.segments.entries, kernel.matter.segments.visible_before,
                             kernel.matter.surface.opacity, kernel.matter.shares.shares, kernel.matter.shares.depths);
    if (kernel.mode != kernel::March::extreme) kernel.extreme.cell_bound = nullptr;  // not read
    views.to_device_pointers(kernel.extreme.cell_bound, kernel.bounds.near_mm, kernel.bounds.far_mm,
                             kernel.frame.ends_mm);
    swap_pointers(views, kernel.matter.field);
}

}  // namespace chiaro

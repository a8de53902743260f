// A field under a light: what the ray caster looks up.
#pragma once
#include <chiaro/camera.h>

#include "classify/medium.h"
#include "illumination/field.h"
#include "volume/level_pages.h"

namespace chiaro {

struct LitField {
    FieldView view;
    std::optional<MainLight> main;       ///< missing: the lighting's own light
    std::shared_ptr<const void> keeps;   ///< what the view reads
    std::optional<double> albedo_limit;  ///< of the colours that are seen; none: as they are
    bool shows_cuts;                     ///< cuts and borders in solid matter are surfaces
    HostArrays arrays;                   ///< what the view points into

    /// Whether the view asks where surfaces are.
    bool by_surface() const {
        return std::visit(
            [](const auto& field) {
                if constexpr (std::decay_t<decltype(field)>::by_surface) return field.asks_surfaces();
                return false;
            },
            view);
    }
    /// Whether a table may tell it of them. What histograms hold on either side of a hard edge differs so much that
    /// rounded shares show.
    bool by_share_table() const { return by_surface() && !std::holds_alternative<kernel::HistogramView>(view); }
};

/// Joins field and lighting; a probe is projected on the field where that holds no light of its own.
LitField lit_field(const IlluminationField& field, const Lighting& lighting, const Camera& camera,
                   const Medium::Data& medium);

/// From now on it is read from places of a level by bricks, where it was found for the coarse volume; none of
/// local histograms is.
void read_from(LitField& lit, const LevelPages& pages);

}  // namespace chiaro
